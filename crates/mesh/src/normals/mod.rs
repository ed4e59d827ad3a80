//! Normals of vertices, estimated from the mesh alone.

mod cap;
mod error;
mod loop_limit;
mod quadric_fit;
mod weighted;

use glam::DVec3;

use crate::{Topology, TriMesh};

pub use cap::smallest_cap;
pub use error::NormalsError;
pub use loop_limit::LoopLimit;
pub use quadric_fit::QuadricFit;
pub use weighted::{AngleWeighted, AreaWeighted};

/// Estimates one normal per vertex.
pub trait EstimateNormals {
    /// Normals of all vertices, towards the side from which faces are counter-clockwise; zero at vertices without faces. Of unit
    /// length, unless the method says otherwise.
    ///
    /// # Errors
    /// [`NormalsError`]: a vertex whose faces determine no normal, or an adjacency that is not that of the mesh.
    fn estimate(&self, mesh: &TriMesh, topology: &Topology) -> Result<Vec<DVec3>, NormalsError>;
}

/// Refuses an adjacency of another mesh and vertices that are not finite.
fn check(mesh: &TriMesh, topology: &Topology) -> Result<(), NormalsError> {
    if mesh.faces.len() != topology.face_count() || mesh.positions.len() != topology.vertex_count() {
        return Err(NormalsError::Topology { faces: mesh.faces.len(), expected: topology.face_count() });
    }
    match mesh.positions.iter().position(|p| !p.is_finite()) {
        Some(vertex) => Err(NormalsError::NotFinite { vertex }),
        None => Ok(()),
    }
}

/// The heads of the half-edges around `v`, counter-clockwise; on the boundary also the last neighbour, which no half-edge leads to.
fn ring(topology: &Topology, v: u32) -> Vec<u32> {
    let mut ring: Vec<u32> = topology.outgoing(v).map(|h| topology.head(h)).collect();
    if topology.is_boundary_vertex(v) {
        let last = topology.outgoing(v).last();
        ring.extend(last.map(|h| topology.tail(topology.prev(h))));
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    fn estimators() -> [(&'static str, Box<dyn EstimateNormals>); 4] {
        [
            ("loop", Box::new(LoopLimit)),
            ("area", Box::new(AreaWeighted)),
            ("angle", Box::new(AngleWeighted)),
            ("quadric", Box::new(QuadricFit::default())),
        ]
    }

    fn topology(mesh: &TriMesh) -> Topology {
        Topology::build(mesh).unwrap()
    }

    /// A graph over the unit square, open all around.
    fn sheet(n: u32, height: impl Fn(f64, f64) -> f64) -> TriMesh {
        let mut mesh = TriMesh::default();
        for j in 0..=n {
            for i in 0..=n {
                let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                mesh.positions.push(DVec3::new(x, y, height(x, y)));
            }
        }
        for j in 0..n {
            for i in 0..n {
                let v = |i: u32, j: u32| j * (n + 1) + i;
                mesh.faces.extend([
                    [v(i, j), v(i + 1, j), v(i + 1, j + 1)],
                    [v(i, j), v(i + 1, j + 1), v(i, j + 1)],
                ]);
            }
        }
        mesh
    }

    #[test]
    fn normals_of_a_sphere_point_outwards_and_those_of_a_plane_are_exact() {
        let sphere = shapes::sphere(2);
        let plane = sheet(5, |x, y| 0.25 * x - 0.5 * y);
        let up = DVec3::new(-0.25, 0.5, 1.0).normalize();
        for (name, e) in estimators() {
            for (p, n) in sphere.positions.iter().zip(e.estimate(&sphere, &topology(&sphere)).unwrap()) {
                assert!(n.normalize().dot(*p) > 0.999, "{name}: {n} at {p}");
            }
            for n in e.estimate(&plane, &topology(&plane)).unwrap() {
                assert!(n.distance(up) < 1e-13, "{name}: {n}");
            }
        }
    }

    #[test]
    fn boundaries_are_no_worse_than_twice_the_spacing() {
        let mesh = sheet(12, |x, y| 0.3 * (2.0 * x).sin() + 0.2 * y * y * x);
        for (name, e) in estimators() {
            for (p, n) in mesh.positions.iter().zip(e.estimate(&mesh, &topology(&mesh)).unwrap()) {
                let exact =
                    DVec3::new(-0.6 * (2.0 * p.x).cos() - 0.2 * p.y * p.y, -0.4 * p.x * p.y, 1.0).normalize();
                assert!(n.normalize().dot(exact) > 0.995, "{name}: {n} for {exact} at {p}");
            }
        }
    }

    #[test]
    fn units_and_the_order_of_vertices_do_not_matter() {
        let mesh = shapes::pebble();
        for (name, e) in estimators() {
            let normals = e.estimate(&mesh, &topology(&mesh)).unwrap();
            for k in [-20, 20] {
                let mut scaled = mesh.clone();
                scaled.positions.iter_mut().for_each(|p| *p *= 2f64.powi(k));
                let other = e.estimate(&scaled, &topology(&scaled)).unwrap();
                for (a, b) in normals.iter().zip(&other) {
                    assert!(a.distance(*b) < 1e-9, "{name}: {a} ≠ {b}");
                }
            }
            let mut turned = mesh.clone();
            turned.positions.reverse();
            let last = turned.positions.len() as u32 - 1;
            turned.faces.iter_mut().flatten().for_each(|v| *v = last - *v);
            turned.faces.reverse();
            let other = e.estimate(&turned, &topology(&turned)).unwrap();
            for (a, b) in normals.iter().zip(other.iter().rev()) {
                assert!(a.distance(*b) < 1e-6, "{name}: {a} ≠ {b}");
            }
        }
    }

    #[test]
    fn quadric_fits_give_gradients_of_one_scale() {
        let radii = DVec3::new(1.0, 1.3, 0.7);
        let mut mesh = shapes::sphere(2);
        mesh.positions.iter_mut().for_each(|p| *p *= radii);
        let gradients = QuadricFit::default().estimate(&mesh, &topology(&mesh)).unwrap();
        let exact = mesh.positions.iter().map(|p| *p / (radii * radii));
        let ratios: Vec<f64> =
            gradients.iter().zip(exact.clone()).map(|(g, e)| g.length() / e.length()).collect();
        for ((g, e), r) in gradients.iter().zip(exact).zip(&ratios) {
            assert!((r / ratios[0] - 1.0).abs() < 1e-10, "{r} {}", ratios[0]);
            assert!(g.normalize().distance(e.normalize()) < 1e-11);
        }
        // The control: unit normals have no such ratio.
        let unit = LoopLimit.estimate(&mesh, &topology(&mesh)).unwrap();
        let spread =
            unit.iter().zip(&mesh.positions).map(|(n, p)| n.length() / (*p / (radii * radii)).length());
        assert!(spread.clone().fold(0.0, f64::max) > 1.5 * spread.fold(f64::INFINITY, f64::min));
    }

    #[test]
    fn what_has_no_normal_is_named() {
        let mut mesh = shapes::sphere(0);
        let t = topology(&mesh);
        mesh.positions[4].x = f64::NAN;
        for (_, e) in estimators() {
            assert_eq!(e.estimate(&mesh, &t), Err(NormalsError::NotFinite { vertex: 4 }));
            assert!(matches!(e.estimate(&shapes::sphere(1), &t), Err(NormalsError::Topology { .. })));
            let flat = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], vec![[0, 1, 2]]);
            let t = topology(&flat);
            assert!(matches!(e.estimate(&flat, &t), Err(NormalsError::NoNormal { vertex: 0 })));
        }
    }
}
