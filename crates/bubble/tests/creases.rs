//! Creases, normals that are turned, and tangents that are laid out anew.

mod common;

use common::{deformed, near_ends, parameters, patch_jumps, torus, with_normals};
use glam::{DVec2, DVec3};
use suture_bubble::{
    BubbleOptions, BubbleSurface, BubbleWarning, Face, PolyMesh, bubble, bubble_creased, load, sharp_edges,
};
use suture_mesh::shapes;
use suture_surface::{Continuity, Patch, SplinePool};

/// Creases keep positions, all other seams their order.
#[track_caller]
fn check(s: &BubbleSurface, order: usize, creases: usize) {
    assert_eq!(s.report().creases, creases);
    let (smooth, sharp) = s.seams().split_at(s.seams().len() - creases);
    assert!(sharp.iter().all(|s| s.claimed == Continuity::C0));
    let j = patch_jumps(s.patches(), sharp, 3.0, &parameters(21));
    assert!(j.position < 1e-13, "creases, order {order}: {j:?}");
    let j = patch_jumps(s.patches(), smooth, 3.0, &[parameters(21), near_ends()].concat());
    assert!(j.position < 1e-13, "order {order}: {j:?}");
    assert!(order < 1 || j.normal < 1e-11, "order {order}: {j:?}");
    assert!(order < 2 || j.shape < 1e-9, "order {order}: {j:?}");
    let t = s.tessellate(3).unwrap();
    let report = suture_mesh::check(&t.mesh);
    assert!(report.manifold && report.oriented && report.boundary_loops.total == 0);
}

/// Two caps joined at an angle along the equator, each of them curved.
fn lens() -> (PolyMesh, Vec<[u32; 2]>) {
    let mut mesh = shapes::sphere(1);
    for p in &mut mesh.positions {
        p.z *= if p.z > 0.0 { 0.5 } else { 0.8 };
        p.x *= 1.0 + 0.1 * p.y;
    }
    // The edges whose faces see different halves: those in the plane z = 0.
    let flat = |v: u32| mesh.positions[v as usize].z.abs() < 1e-9;
    let mut edges: Vec<[u32; 2]> = mesh
        .faces
        .iter()
        .flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]])
        .filter(|e| e[0] < e[1] && flat(e[0]) && flat(e[1]))
        .collect();
    edges.sort_unstable();
    (with_normals(&mesh), edges)
}

#[test]
fn curved_creases_join_with_order_0_and_all_else_as_claimed() {
    let (mesh, ring) = lens();
    assert!(ring.len() >= 4, "{ring:?}");
    let cube = with_normals(&shapes::cuboid(DVec3::ONE, 1));
    let sharp = sharp_edges(&cube, 1.0).unwrap();
    for order in 0..3 {
        let options = BubbleOptions { order, ..Default::default() };
        check(&bubble_creased(&mesh, &ring, &options).unwrap(), order, ring.len());
        check(&bubble_creased(&cube, &sharp, &options).unwrap(), order, 12);
        // A part of the edges: creases that end in smooth vertices.
        for some in [&sharp[..2], &sharp[3..8], &ring[..3]] {
            let mesh = if some.len() == 3 { &mesh } else { &cube };
            let s = bubble_creased(mesh, some, &options).unwrap();
            check(&s, order, s.report().creases);
        }
    }
    let s = bubble_creased(&mesh, &ring, &BubbleOptions { order: 3, ..Default::default() }).unwrap();
    check(&s, 2, ring.len());
}

#[test]
fn quads_have_creases_too() {
    let mesh = torus(10, 6, 4);
    // A ring around the tube's outside.
    let outside = |v: u32| mesh.positions[v as usize].truncate().length() > 2.79;
    let mut ring: Vec<[u32; 2]> = Vec::new();
    for face in &mesh.faces {
        let v = face.vertices();
        for k in 0..v.len() {
            let e = [v[k].min(v[(k + 1) % v.len()]), v[k].max(v[(k + 1) % v.len()])];
            if outside(e[0]) && outside(e[1]) && !ring.contains(&e) {
                ring.push(e);
            }
        }
    }
    assert_eq!(ring.len(), 10);
    for order in 0..3 {
        let s = bubble_creased(&mesh, &ring, &BubbleOptions { order, ..Default::default() }).unwrap();
        check(&s, order, 10);
        for patch in s.patches() {
            let record = patch.record(&mut SplinePool::default());
            let text = serde_json::to_string(&record).unwrap();
            let loaded = load(&serde_json::from_str(&text).unwrap(), &SplinePool::default()).unwrap();
            for at in [DVec2::new(0.21, 0.34), DVec2::new(0.5, 0.0), DVec2::X] {
                assert_eq!(loaded.jet(at), patch.jet(at));
            }
        }
    }
}

#[test]
fn normals_along_edges_are_turned_and_seams_stay() {
    let base = with_normals(&deformed(0));
    let mut mesh = base.clone();
    let e = mesh.positions[base.faces[0].vertices()[1] as usize]
        - mesh.positions[base.faces[0].vertices()[0] as usize];
    mesh.normals[base.faces[0].vertices()[0] as usize] = e.normalize();
    for order in 0..3 {
        let options = BubbleOptions { order, ..Default::default() };
        let s = bubble(&mesh, &options).unwrap();
        check(&s, order, 0);
        assert!(s.report().turned == 1 && s.report().fold > 0.0);
        assert!(s.report().warnings.iter().any(|w| matches!(w, BubbleWarning::Turned { count: 1, .. })));
        assert!(bubble(&mesh, &BubbleOptions { steer: 0.0, ..options }).is_err());
    }
}

#[test]
fn vertices_that_no_normal_suits_keep_their_seams() {
    // A ring of six around the pole, two of whose members lie on the wrong side: the faces there wind back.
    let mut mesh = shapes::sphere(1);
    let pole = (0..mesh.positions.len())
        .max_by(|&a, &b| mesh.positions[a].z.total_cmp(&mesh.positions[b].z))
        .unwrap();
    let ring: Vec<usize> = mesh
        .faces
        .iter()
        .filter(|f| f.contains(&(pole as u32)))
        .flat_map(|f| f.map(|v| v as usize))
        .filter(|&v| v != pole)
        .collect();
    let towards = mesh.positions[ring[0]] - mesh.positions[pole];
    mesh.positions[pole] += 1.4 * towards - 0.6 * DVec3::Z;
    let mesh = with_normals(&mesh);
    for order in 0..3 {
        let options = BubbleOptions { order, refuse: 0.0, ..Default::default() };
        let s = bubble(&mesh, &options).unwrap();
        let unrolled = s.report().warnings.iter().any(|w| matches!(w, BubbleWarning::Unrolled { .. }));
        assert!(unrolled, "{:?}", s.report());
        let j = patch_jumps(s.patches(), s.seams(), 3.0, &parameters(21));
        assert!(j.position < 1e-13, "order {order}: {j:?}");
        assert!(order < 1 || j.normal < 1e-10, "order {order}: {j:?}");
        let text = serde_json::to_string(&s.patches()[3].record(&mut SplinePool::default())).unwrap();
        assert!(load(&serde_json::from_str(&text).unwrap(), &SplinePool::default()).is_ok());
    }
    assert!(matches!(mesh.faces[0], Face::Triangle(_)));
}
