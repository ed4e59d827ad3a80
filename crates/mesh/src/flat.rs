//! Better triangles in planes: edges of the same plane turned until the triangulation is that of Delaunay.
//!
//! CAD systems triangulate planes with slivers from hole to rim. Whatever walks over faces or weighs them sees such a plane through a
//! grating; the shape is the same with any other edges.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::{Topology, TopologyError, TriMesh};

/// Edges are turned once or more often until all are Delaunay's; this many times as many turns are too many, which only rounding can ask for.
const TURNS: usize = 20;
/// Sine of the angle from which two triangles do not lie in one plane whatever their size.
const BENT: f64 = 0.1;

/// Turns edges between triangles of one plane where the angles opposite of them sum to more than π (Lawson 1977, *Software for C¹ surface
/// interpolation*). Vertices stay; the faces of both triangles keep their numbers.
///
/// Four vertices lie in a plane up to `tolerance`, in the units of the mesh.
///
/// # Errors
/// As [`Topology::build`].
pub fn turn_flat_edges(mesh: &TriMesh, tolerance: f64) -> Result<TriMesh, TopologyError> {
    let topology = Topology::build(mesh)?;
    let opposite = (0..topology.half_edge_count() as u32).map(|h| topology.opposite(h)).collect();
    let edge = |h: u32| key(topology.tail(h), topology.head(h));
    let edges = (0..topology.half_edge_count() as u32).map(edge).collect();
    let mut work = Work { positions: &mesh.positions, faces: mesh.faces.clone(), opposite, edges, tolerance };
    let mut open: Vec<u32> = (0..topology.half_edge_count() as u32).rev().collect();
    let mut turns = TURNS * open.len();
    while let Some(h) = open.pop() {
        if turns > 0 && work.should_turn(h) {
            turns -= 1;
            open.extend(work.turn(h));
        }
    }
    Ok(TriMesh::new(mesh.positions.clone(), work.faces))
}

fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

struct Work<'a> {
    positions: &'a [DVec3],
    faces: Vec<[u32; 3]>,
    opposite: Vec<Option<u32>>,
    edges: BTreeSet<(u32, u32)>,
    tolerance: f64,
}

impl Work<'_> {
    fn tail(&self, h: u32) -> u32 {
        self.faces[h as usize / 3][h as usize % 3]
    }

    /// The edge from a to b with c on its left and d on its right.
    fn around(&self, h: u32) -> Option<[u32; 4]> {
        let o = self.opposite[h as usize]?;
        Some([self.tail(h), self.tail(o), self.tail(next(next(h))), self.tail(next(next(o)))])
    }

    fn should_turn(&self, h: u32) -> bool {
        let Some(around) = self.around(h) else { return false };
        let [_, _, c, d] = around;
        if c == d || self.edges.contains(&key(c, d)) {
            return false;
        }
        let [a, b, c, d] = around.map(|v| self.positions[v as usize]);
        let (m, n) = ((b - a).cross(c - a), (d - a).cross(b - a));
        let Some(normal) = (m + n).try_normalize() else { return false };
        // The diagonals are as far apart as the tetrahedron is high.
        let apart = (c - a).dot(normal).abs().max((d - a).dot(normal).abs()).max((b - a).dot(normal).abs());
        let bent = |n: DVec3| {
            n.cross(normal).length() > BENT * n.length() && n.length() > self.tolerance * (b - a).length()
        };
        if apart > self.tolerance || bent(m) || bent(n) {
            return false;
        }
        // Both new triangles must turn the same way.
        let (p, q) = ((d - a).cross(c - a).dot(normal), (b - d).cross(c - d).dot(normal));
        if p.min(q) <= 1e-9 * (m + n).length() {
            return false;
        }
        let cotangent = |apex: DVec3| {
            (a - apex).dot(b - apex) / (a - apex).cross(b - apex).length().max(f64::MIN_POSITIVE)
        };
        cotangent(c) + cotangent(d) < -1e-6
    }

    /// The half-edges around, which may have to turn now.
    fn turn(&mut self, h: u32) -> [u32; 4] {
        let (Some([a, b, c, d]), Some(o)) = (self.around(h), self.opposite[h as usize]) else {
            return [h; 4];
        };
        let outer = [next(h), next(next(h)), next(o), next(next(o))].map(|x| self.opposite[x as usize]);
        let (f, g) = (h / 3, o / 3);
        self.faces[f as usize] = [a, d, c];
        self.faces[g as usize] = [d, b, c];
        self.edges.remove(&key(a, b));
        self.edges.insert(key(c, d));
        let [bc, ca, ad, db] = outer;
        let new = [(3 * f, ad), (3 * f + 2, ca), (3 * g, db), (3 * g + 1, bc)];
        for (x, y) in new {
            self.opposite[x as usize] = y;
            if let Some(y) = y {
                self.opposite[y as usize] = Some(x);
            }
        }
        self.opposite[3 * f as usize + 1] = Some(3 * g + 2);
        self.opposite[3 * g as usize + 2] = Some(3 * f + 1);
        new.map(|(x, _)| x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, shapes};

    fn least_angle(mesh: &TriMesh) -> f64 {
        let angle = |a: DVec3, b: DVec3, c: DVec3| (b - a).angle_between(c - a);
        (0..mesh.faces.len())
            .flat_map(|f| {
                let [a, b, c] = mesh.corners(f);
                [angle(a, b, c), angle(b, c, a), angle(c, a, b)]
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// A drum whose lid is a fan from one vertex of its rim.
    fn drum(n: u32) -> TriMesh {
        let at = |i: u32, z: f64| {
            let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
            DVec3::new(c, s, z)
        };
        let points = (0..n).map(|i| at(i, 0.0)).chain((0..n).map(|i| at(i, 1.0))).collect();
        let mut faces = Vec::new();
        for i in 0..n {
            let j = (i + 1) % n;
            faces.extend([[i, j, n + j], [i, n + j, n + i]]);
        }
        for i in 1..n - 1 {
            faces.extend([[0, i + 1, i], [n, n + i, n + i + 1]]);
        }
        TriMesh::new(points, faces)
    }

    #[test]
    fn a_drum_keeps_its_shape() {
        let mesh = drum(24);
        let turned = turn_flat_edges(&mesh, 1e-9).unwrap();
        let report = check(&turned);
        assert!(report.is_sound() && report.closed && report.genus == Some(0));
        assert_eq!((&turned.positions, turned.faces.len()), (&mesh.positions, mesh.faces.len()));
        let area = |m: &TriMesh| (0..m.faces.len()).map(|f| m.area_vector(f).length()).sum::<f64>();
        assert!((area(&turned) / area(&mesh) - 1.0).abs() < 1e-14);
        // All vertices of a lid lie on one circle: any triangulation is Delaunay's. The sides are planes of two triangles.
        assert_eq!(turned.faces, mesh.faces);
    }

    #[test]
    fn slivers_in_a_plane_go() {
        let mesh = shapes::cuboid(DVec3::new(4.0, 1.0, 1.0), 6);
        let mut skew = mesh.clone();
        // Shear the vertices inside the planes: the edges no longer suit them.
        for p in &mut skew.positions {
            if p.z.abs() > 0.49 && p.x.abs() < 1.99 {
                p.y += 0.3 * (0.25 - p.y * p.y);
                p.x += 0.4 * p.y * (4.0 - p.x * p.x);
            }
        }
        let turned = turn_flat_edges(&skew, 1e-9).unwrap();
        assert!(check(&turned).is_sound() && check(&turned).closed);
        assert!(turned.faces != skew.faces && least_angle(&turned) > least_angle(&skew));
        assert_eq!(turn_flat_edges(&turned, 1e-9).unwrap(), turned, "once is enough");
    }

    #[test]
    fn curved_meshes_stay() {
        for mesh in [shapes::sphere(3), shapes::torus(1.0, 0.4, 48, 24)] {
            assert_eq!(turn_flat_edges(&mesh, 1e-6).unwrap().faces, mesh.faces);
        }
    }
}
