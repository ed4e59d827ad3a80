//! Bounds, queries, and input that is not fit.

mod common;

use common::{figure, sides};
use glam::DVec3;
use suture_apatch::{ApatchError, ApatchOptions, ApexWeight, Locator, apatch};
use suture_mesh::normals::{EstimateNormals, LoopLimit};
use suture_mesh::{TriMesh, shapes};

/// Below the bound the minimal root is lost on some ray; above it on none.
#[test]
fn bounds_are_sharp() {
    for number in [6, 7, 9] {
        let (mesh, normals) = figure(number);
        let mut s =
            apatch(&mesh, &normals, &ApatchOptions { refinements: 0, ..ApatchOptions::default() }).unwrap();
        let mut tested = 0;
        for face in 0..2 {
            for side in sides() {
                let Some((_, weight)) = s.apex(face, side) else { continue };
                let bound = s.face_bound(face, side, 1e-4, 100_000).unwrap();
                assert!(bound.attained <= bound.proven && bound.attained < weight, "{bound:?} {weight}");
                let mut missed = |w: f64| {
                    s.set_weight(face, side, w).unwrap();
                    let n = 60;
                    let rays = (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j)));
                    rays.filter(|&(i, j)| {
                        let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                        !s.face_point(face, [1.0 - x - y, x, y]).unwrap().simple
                    })
                    .count()
                };
                assert_eq!(missed(bound.proven + 0.02), 0, "figure {number}, face {face}");
                assert!(missed(bound.attained - 0.02) > 0, "figure {number}, face {face}");
                missed(weight);
                tested += 1;
            }
        }
        assert!(tested >= 2);
    }
}

#[test]
fn weights_below_the_bound_are_raised() {
    let (mesh, normals) = figure(6);
    let low = ApatchOptions { weight: ApexWeight::Given(vec![-5.0; 2]), ..ApatchOptions::default() };
    let s = apatch(&mesh, &normals, &low).unwrap();
    assert_eq!(s.report().raised_faces, 2);
    assert!(s.report().unproven_faces.is_empty() && s.report().unproven_edges.is_empty());
    let (_, weight) = s.apex(0, suture_apatch::Side::Positive).unwrap();
    assert!(weight > -1.0);
}

#[test]
fn the_hull_knows_inside_from_outside() {
    let mesh = shapes::sphere(1);
    let s = apatch(&mesh, &mesh.positions, &ApatchOptions::default()).unwrap();
    let locator = Locator::new(&s);
    let mut found = 0;
    for i in 0..2000 {
        let f = f64::from(i);
        let direction = DVec3::new((f * 0.61).sin(), (f * 0.37).cos(), (f * 0.23).sin() - 0.2).normalize();
        for r in [0.999, 1.001] {
            for at in locator.locate(direction * r) {
                found += 1;
                assert_eq!(s.inside(at), Some(r < 1.0));
                let (value, gradient) = s.value(at).unwrap();
                assert_eq!(value < 0.0, r < 1.0);
                assert!(gradient.normalize().dot(direction) > 0.99);
            }
        }
    }
    assert!(found > 3000, "{found}");
    assert!(locator.locate(DVec3::ZERO).is_empty() && locator.locate(DVec3::NAN).is_empty());
}

/// Powers of two scale the surface to the bit; flipping the mesh and its normals gives the same surface.
#[test]
fn units_and_orientation_do_not_matter() {
    let (mesh, normals) = figure(7);
    let options = ApatchOptions::default();
    let s = apatch(&mesh, &normals, &options).unwrap();
    let q = [0.3, 0.45, 0.25];
    let p = s.face_point(0, q).unwrap();
    for k in [-20, 20] {
        let mut scaled = mesh.clone();
        scaled.positions.iter_mut().for_each(|p| *p *= 2f64.powi(k));
        let t = apatch(&scaled, &normals, &options).unwrap();
        assert!(
            t.face_point(0, q).unwrap().position.distance(p.position * 2f64.powi(k)) < 1e-14 * 2f64.powi(k)
        );
    }
    let mut flipped = mesh.clone();
    flipped.faces.iter_mut().for_each(|f| f.swap(0, 1));
    let back: Vec<DVec3> = normals.iter().map(|n| -*n).collect();
    let t = apatch(&flipped, &back, &options).unwrap();
    assert!(t.face_point(0, [q[1], q[0], q[2]]).unwrap().position.distance(p.position) < 1e-14);
}

#[test]
fn bad_input_is_named() {
    let options = ApatchOptions::default();
    let mesh = shapes::sphere(0);
    let good = mesh.positions.clone();
    let error = |mesh: &TriMesh, normals: &[DVec3]| apatch(mesh, normals, &options).unwrap_err();
    let mut normals = good.clone();
    normals[5] = DVec3::ZERO;
    assert!(matches!(error(&mesh, &normals), ApatchError::Normal { vertex: 5, .. }));
    normals[5] = DVec3::NAN;
    assert!(matches!(error(&mesh, &normals), ApatchError::Normal { vertex: 5, .. }));
    normals[5] = -good[5];
    assert!(matches!(error(&mesh, &normals), ApatchError::NormalAgainstFace { vertex: 5, .. }));
    assert!(matches!(error(&mesh, &good[..7]), ApatchError::NormalCount { normals: 7, vertices: 12 }));
    let mut bad = mesh.clone();
    bad.positions[3].x = f64::INFINITY;
    assert!(matches!(error(&bad, &good), ApatchError::NotFinite { vertex: 3 }));
    let mut bad = mesh.clone();
    bad.positions[bad.faces[4][0] as usize] =
        0.5 * (bad.positions[bad.faces[4][1] as usize] + bad.positions[bad.faces[4][2] as usize]);
    assert!(matches!(error(&bad, &good), ApatchError::DegenerateFace { face: 4, .. }));
    let mut bad = mesh.clone();
    bad.faces.push(bad.faces[0]);
    assert!(matches!(error(&bad, &good), ApatchError::Topology(_)));
    assert!(matches!(error(&TriMesh::default(), &[]), ApatchError::Topology(_)));
    let options = ApatchOptions { weight: ApexWeight::Given(vec![1.0; 3]), ..ApatchOptions::default() };
    assert!(matches!(apatch(&mesh, &good, &options), Err(ApatchError::WeightCount { given: 3, faces: 20 })));
}

/// A triangle turned over by moving one vertex of a plane grid beyond a neighbour: no normal sees both sides of the fold.
fn folded() -> TriMesh {
    let mut mesh = TriMesh::default();
    let n = 6;
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            mesh.positions.push(DVec3::new(x, y, 0.3 * (x * x + 0.5 * y * y)));
        }
    }
    for j in 0..n as u32 {
        for i in 0..n as u32 {
            let v = |i: u32, j: u32| j * 7 + i;
            mesh.faces
                .extend([[v(i, j), v(i + 1, j), v(i + 1, j + 1)], [v(i, j), v(i + 1, j + 1), v(i, j + 1)]]);
        }
    }
    // The middle vertex beyond the diagonal of its neighbour's face.
    let step = 1.0 / 6.0;
    let [x, y] = [0.5 + 0.8 * step, 0.5 - 0.7 * step];
    mesh.positions[24] = DVec3::new(x, y, 0.3 * (x * x + 0.5 * y * y));
    mesh
}

#[test]
fn folds_are_turned_away_and_named() {
    let mesh = folded();
    let topology = suture_mesh::Topology::build(&mesh).unwrap();
    let normals = LoopLimit.estimate(&mesh, &topology).unwrap();
    let options = ApatchOptions { estimated: true, ..ApatchOptions::default() };
    let s = apatch(&mesh, &normals, &options).unwrap();
    let r = s.report();
    assert!(
        !r.turned_edges.is_empty() && r.turned_edges.iter().flatten().any(|&v| v == 24 || v == 17 || v == 25),
        "{r:?}"
    );
    assert!(r.bad_edges.is_empty() && r.steep_faces.is_empty(), "{r:?}");
    assert!(r.unproven_faces.is_empty() && r.unproven_edges.is_empty(), "{r:?}");
    // Vertices stay; those that were no corner of a turned edge keep their normals.
    assert_eq!(&s.mesh().positions[..49], &mesh.positions[..]);
    let changed = (0..49).filter(|&v| s.mesh().normals.as_ref().unwrap()[v] != normals[v]);
    assert!(changed.clone().count() > 0);
    for v in changed {
        assert!(r.estimated_again.contains(&(v as u32)), "{v}");
    }
    let before = suture_mesh::check(&mesh);
    let after = suture_mesh::check(&s.tessellate(4, 2).unwrap().mesh);
    assert!(after.manifold && after.oriented && after.boundary_loops.total == before.boundary_loops.total);
    let jumps = common::wall_jumps(&s);
    assert!(jumps.value < 1e-12 && jumps.gradient < 1e-11, "{jumps:?}");
    // Given normals are never touched.
    if let Ok(s) = apatch(&mesh, &normals, &ApatchOptions::default()) {
        assert_eq!(&s.mesh().normals.as_ref().unwrap()[..49], &normals[..]);
        assert!(s.report().estimated_again.is_empty());
    }
}
