//! One apex weight changed: the same as building everything anew.

mod common;

use common::sides;
use glam::DVec3;
use suture_apatch::{ApatchOptions, ApatchSurface, ApexWeight, Class, Side, apatch};
use suture_mesh::{TriMesh, shapes};

fn bumpy() -> (TriMesh, Vec<DVec3>) {
    let mut mesh = shapes::sphere(2);
    for p in &mut mesh.positions {
        *p *= 1.0 + 0.3 * (3.0 * p.x).sin() * (2.0 * p.y + p.z).cos();
    }
    let normals = suture_mesh::vertex_normals_area_weighted(&mesh);
    (mesh, normals)
}

/// Every point of a grid over all faces and along all edges.
fn points(s: &ApatchSurface) -> Vec<DVec3> {
    let mut all = Vec::new();
    for f in 0..s.mesh().faces.len() {
        for q in [[0.5, 0.3, 0.2], [0.1, 0.2, 0.7], [0.0, 0.4, 0.6]] {
            all.push(s.face_point(f, q).unwrap().position);
        }
    }
    for e in 0..s.edge_count() {
        for (xi, y) in [(0.3, 0.2), (0.5, 0.5), (0.8, 1.0)] {
            all.extend(s.edge_point(e, xi, y).map(|p| p.position));
        }
    }
    all
}

#[test]
fn a_changed_weight_is_a_rebuilt_surface_to_the_bit() {
    // Convex: one side, so that given weights say all.
    let mut mesh = shapes::sphere(1);
    for p in &mut mesh.positions {
        *p *= DVec3::new(1.0, 1.3, 0.8);
    }
    let normals: Vec<DVec3> = mesh.positions.iter().map(|p| *p / DVec3::new(1.0, 1.69, 0.64)).collect();
    let mut changed = apatch(&mesh, &normals, &ApatchOptions::default()).unwrap();
    let mut weights: Vec<f64> = (0..80).map(|f| changed.apex(f, Side::Positive).unwrap().1).collect();
    let before = points(&changed);
    weights[7] *= 1.5;
    changed.set_weight(7, Side::Positive, weights[7]).unwrap();
    let options = ApatchOptions { weight: ApexWeight::Given(weights), ..ApatchOptions::default() };
    let built = apatch(&mesh, &normals, &options).unwrap();
    let (a, b) = (points(&changed), points(&built));
    assert_eq!(a, b);
    let moved = a.iter().zip(&before).filter(|(a, b)| a != b).count();
    // Three points of the face (the one on its edge included) and at most three on each of its edges.
    assert!((3..=15).contains(&moved), "{moved}");
}

#[test]
fn rays_give_the_points_of_the_changed_surface() {
    let (mesh, normals) = bumpy();
    let mut s = apatch(&mesh, &normals, &ApatchOptions::default()).unwrap();
    assert_eq!(s.mesh().faces.len(), mesh.faces.len());
    let (n, m) = (6, 2);
    let (mut convex, mut split) = (0, 0);
    for face in 0..mesh.faces.len() {
        for side in sides() {
            let Some(rays) = s.weight_rays(face, side, n, m) else { continue };
            let (_, weight) = s.apex(face, side).unwrap();
            for more in [0.0, 0.1, 0.4] {
                s.set_weight(face, side, weight + more).unwrap();
                let got: Vec<(DVec3, bool)> = rays.points(weight + more).collect();
                let mut want = Vec::new();
                for j in 0..=n {
                    for i in 0..=n - j {
                        let q = [n - i - j, i, j].map(|x| x as f64 / n as f64);
                        want.push(s.face_point(face, q).unwrap().position);
                    }
                }
                let v = mesh.faces[face];
                for k in 0..3 {
                    let ends = [v[k], v[(k + 1) % 3]];
                    let at = (0..s.edge_count()).find(|&e| {
                        let [a, b] = s.edge_vertices(e).unwrap();
                        ends == [a, b] || ends == [b, a]
                    });
                    for i in 0..=n {
                        for j in 0..=m {
                            let (xi, y) = (i as f64 / n as f64, j as f64 / m as f64);
                            want.extend(s.edge_point(at.unwrap(), xi, y).map(|p| p.position));
                        }
                    }
                }
                if matches!(s.face_classes()[face], Class::Positive | Class::Negative) {
                    assert_eq!(got.len(), want.len());
                    for ((p, simple), q) in got.iter().zip(&want) {
                        assert!(*simple && p.distance(*q) < 1e-13, "face {face}: {p} ≠ {q}");
                    }
                    convex += 1;
                } else {
                    // Rays of the other side are left out: the others come in the same order.
                    let mut rest = want.iter();
                    assert!(got.iter().all(|g| rest.any(|w| w.distance(g.0) < 1e-13)), "face {face}");
                    split += usize::from(!got.is_empty());
                }
            }
            s.set_weight(face, side, weight).unwrap();
        }
    }
    assert!(convex > 30 && split > 30, "{convex} {split}");
}
