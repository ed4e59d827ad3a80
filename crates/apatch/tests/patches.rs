//! The surface as parametric patches and as triangles.

mod common;

use common::figure;
use glam::{DVec2, DVec3};
use suture_apatch::{ApatchOptions, ApatchSurface, RECORDS, apatch, load};
use suture_mesh::{TriMesh, check, shapes, vertex_normals_area_weighted};
use suture_surface::{Patch, PatchKind, SplinePool};

fn built(mesh: &TriMesh) -> ApatchSurface {
    apatch(mesh, &vertex_normals_area_weighted(mesh), &ApatchOptions::default()).unwrap()
}

fn all() -> Vec<ApatchSurface> {
    let mut all: Vec<ApatchSurface> = [6, 7, 9, 10]
        .into_iter()
        .map(|n| {
            let (mesh, normals) = figure(n);
            apatch(&mesh, &normals, &ApatchOptions::default()).unwrap()
        })
        .collect();
    all.extend([shapes::sphere(0), shapes::torus(2.0, 0.7, 8, 6), shapes::double_torus(2)].iter().map(built));
    all
}

fn inside(patch: &dyn Patch) -> Vec<DVec2> {
    match patch.kind() {
        PatchKind::Face | PatchKind::Planar => {
            [(0.31, 0.23), (0.11, 0.72), (0.67, 0.12)].map(|(x, y)| DVec2::new(x, y)).to_vec()
        }
        _ => [(0.5, 0.1), (0.3, -0.15), (0.9, 0.02), (0.05, 0.01)].map(|(x, y)| DVec2::new(x, y)).to_vec(),
    }
}

#[test]
fn derivatives_match_differences() {
    for s in all() {
        let size = s.mesh().diagonal();
        let surface = s.surface().unwrap();
        for patch in surface.patches().iter().take(400) {
            for at in inside(patch.as_ref()) {
                let j = patch.jet(at);
                let h = 1e-4;
                let p = |x: f64, y: f64| patch.jet(at + DVec2::new(x, y) * h);
                let near = |got: DVec3, want: DVec3, what: &str| {
                    let scale = size + want.length();
                    assert!(
                        got.distance(want) < 2e-4 * scale,
                        "{what} of {:?} at {at}: {got} ≠ {want}",
                        patch.kind()
                    );
                };
                near((p(1.0, 0.0).p - p(-1.0, 0.0).p) / (2.0 * h), j.du, "du");
                near((p(0.0, 1.0).p - p(0.0, -1.0).p) / (2.0 * h), j.dv, "dv");
                near((p(1.0, 0.0).du - p(-1.0, 0.0).du) / (2.0 * h), j.duu, "duu");
                near((p(0.0, 1.0).du - p(0.0, -1.0).du) / (2.0 * h), j.duv, "duv");
                near((p(0.0, 1.0).dv - p(0.0, -1.0).dv) / (2.0 * h), j.dvv, "dvv");
                let (n, m) = (j.normal().unwrap(), patch.normal(at).unwrap());
                assert!(n.distance(m) < 1e-9, "{n} ≠ {m}");
            }
        }
    }
}

#[test]
fn seams_close_and_have_one_normal_up_to_their_ends() {
    for s in all() {
        let surface = s.surface().unwrap();
        for seam in surface.seams() {
            for i in 0..=8 {
                let t = f64::from(i) / 8.0;
                let [a, b] = [(seam.a, t), (seam.b, seam.opposite(t))].map(|(e, t)| {
                    let patch = surface.patch(e.patch).unwrap();
                    patch.jet(patch.domain().edge(e.edge as usize).unwrap().point(t))
                });
                assert!(a.finite() && b.finite());
                assert!(a.p.distance(b.p) < 1e-14 * s.mesh().diagonal());
                let (m, n) = (a.normal().unwrap(), b.normal().unwrap());
                assert!(m.distance(n) < 1e-9, "{m} ≠ {n} at {t} of {seam:?}");
            }
        }
    }
}

#[test]
fn records_load_to_the_same_bits() {
    for s in all() {
        let surface = s.surface().unwrap();
        for patch in surface.patches().iter().take(60) {
            let mut pool = SplinePool::default();
            let record = patch.record(&mut pool);
            assert!(RECORDS.contains(&record.kind.as_str()));
            let text = serde_json::to_string(&record).unwrap();
            let loaded = load(&serde_json::from_str(&text).unwrap(), &pool).unwrap();
            for at in inside(patch.as_ref()) {
                assert_eq!(loaded.jet(at), patch.jet(at));
            }
        }
    }
}

#[test]
fn triangles_are_watertight_and_know_their_patches() {
    for s in all() {
        let surface = s.surface().unwrap();
        for (n, m) in [(1, 1), (2, 1), (5, 2), (8, 3)] {
            let t = s.tessellate(n, m).unwrap();
            assert_eq!(t.missed, 0);
            let (coarse, fine) = (check(s.mesh()), check(&t.mesh));
            assert!(fine.oriented && fine.manifold, "{n} {m}: {fine:?}");
            assert_eq!((coarse.closed, coarse.genus), (fine.closed, fine.genus));
            assert!(fine.repeated_vertices.first.is_empty() && fine.isolated.first.is_empty());
            let diagonal = s.mesh().diagonal();
            for (i, face) in t.mesh.faces.iter().enumerate() {
                let patch = surface.patch(t.triangle_patch[i]).unwrap();
                for c in 0..3 {
                    let p = patch.jet(t.corner_parameters[i][c]).p;
                    let q = t.mesh.positions[face[c] as usize];
                    assert!(p.distance(q) < 1e-13 * diagonal, "{p} ≠ {q} on {:?}", patch.kind());
                }
            }
            for (v, p) in t.mesh.positions.iter().enumerate() {
                let q = surface.patch(t.vertex_patch[v]).unwrap().jet(t.vertex_parameter[v]).p;
                assert!(p.distance(q) < 1e-13 * diagonal);
            }
        }
    }
}

#[test]
fn figure_10_has_a_plane_face() {
    let (mesh, normals) = figure(10);
    let s = apatch(&mesh, &normals, &ApatchOptions::default()).unwrap();
    let surface = s.surface().unwrap();
    let kinds: Vec<PatchKind> = surface.patches().iter().map(|p| p.kind()).collect();
    assert_eq!(kinds, [PatchKind::Face, PatchKind::Planar]);
    assert_eq!(surface.seams().len(), 1);
}

/// What a saved surface knows of its hull is the hull.
#[test]
fn records_know_their_tetrahedra() {
    let (mesh, normals) = figure(9);
    let s = apatch(&mesh, &normals, &ApatchOptions::default()).unwrap();
    let mut pool = suture_surface::SplinePool::default();
    let surface = s.surface().unwrap();
    let mut got: Vec<[DVec3; 4]> = surface
        .patches()
        .iter()
        .flat_map(|p| suture_apatch::tetrahedra(&p.record(&mut pool)).unwrap())
        .collect();
    let mut want: Vec<[DVec3; 4]> = s.cells().into_iter().filter_map(|cell| s.cell_vertices(cell)).collect();
    let key = |v: &[DVec3; 4]| v.map(|p| p.to_array().map(f64::to_bits));
    got.sort_by_key(key);
    want.sort_by_key(key);
    assert_eq!(got, want);
}
