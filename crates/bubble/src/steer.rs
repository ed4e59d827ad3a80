//! Normals that their faces can bear.
//!
//! At a corner the patch is a graph over the plane across the normal: a face whose normal makes an obtuse angle with it folds over, and an
//! edge along it has no tangent. Noise and needles make such normals, on every estimator; most vertices have others nearby that see all
//! their faces from the front. Only normals below the limit are turned, and no further than needed.

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use crate::{network::Edges, poly_mesh::PolyMesh};

/// A normal whose clearance was too small.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Turned {
    /// The vertex.
    pub vertex: u32,
    /// By how much, in radians; 0 where no other direction is better by much.
    pub angle: f64,
    /// Smallest cosine with the normals of faces and sine with the edges before and after.
    pub clearance: [f64; 2],
}

/// Turns the normals of `mesh` whose clearance (the smallest cosine with the normals of the faces and sine with the edges there) is below
/// `least` towards the direction of largest clearance, until they reach `least` or nine tenths of the best. The lengths stay.
///
/// ```
/// use glam::DVec3;
/// use suture_bubble::{PolyMesh, steer_normals};
///
/// // A tetrahedron with one normal along the base.
/// let mesh = suture_mesh::shapes::sphere(0);
/// let mut normals = mesh.positions.clone();
/// normals[0] = (normals[1] - normals[0]).normalize();
/// let mut poly = PolyMesh::from_triangles(&mesh, &normals)?;
/// let turned = steer_normals(&mut poly, 0.3);
/// assert!(turned.len() == 1 && turned[0].vertex == 0 && poly.normals[0].dot(mesh.positions[0]) > 0.3);
/// # Ok::<(), suture_bubble::BubbleError>(())
/// ```
pub fn steer_normals(mesh: &mut PolyMesh, least: f64) -> Vec<Turned> {
    if !(least > 0.0 && least.is_finite()) || mesh.check().is_err() {
        return Vec::new();
    }
    let stars = Stars::of(mesh);
    let turned: Vec<Option<(DVec3, Turned)>> =
        (0..mesh.positions.len()).into_par_iter().map(|v| turn(&stars, mesh.normals[v], v, least)).collect();
    let mut out = Vec::new();
    for (v, turned) in turned.into_iter().enumerate() {
        if let Some((n, t)) = turned {
            mesh.normals[v] = n;
            out.push(t);
        }
    }
    out
}

/// Unit normals of the faces and unit edges around every vertex.
struct Stars {
    starts: Vec<u32>,
    faces: Vec<DVec3>,
    edge_starts: Vec<u32>,
    edges: Vec<DVec3>,
}

impl Stars {
    fn of(mesh: &PolyMesh) -> Self {
        let count = mesh.positions.len();
        // The normal of every corner: quads need not be plane.
        let mut corners: Vec<(u32, DVec3)> = Vec::with_capacity(3 * mesh.faces.len());
        for face in &mesh.faces {
            let v = face.vertices();
            let p = |k: usize| mesh.positions[v[k % v.len()] as usize];
            for k in 0..v.len() {
                let n = (p(k + 1) - p(k)).cross(p(k + v.len() - 1) - p(k));
                corners.extend(n.try_normalize().map(|n| (v[k], n)));
            }
        }
        let mut spokes: Vec<(u32, DVec3)> = Vec::new();
        for e in Edges::of(mesh).edges {
            let [a, b] = e.vertices;
            let d = (mesh.positions[b as usize] - mesh.positions[a as usize]).try_normalize();
            spokes.extend(d.into_iter().flat_map(|d| [(a, d), (b, -d)]));
        }
        let (starts, faces) = bucket(count, &corners);
        let (edge_starts, edges) = bucket(count, &spokes);
        Self { starts, faces, edge_starts, edges }
    }

    fn at(&self, v: usize) -> (&[DVec3], &[DVec3]) {
        (
            &self.faces[self.starts[v] as usize..self.starts[v + 1] as usize],
            &self.edges[self.edge_starts[v] as usize..self.edge_starts[v + 1] as usize],
        )
    }
}

fn bucket(count: usize, items: &[(u32, DVec3)]) -> (Vec<u32>, Vec<DVec3>) {
    let mut starts = vec![0u32; count + 1];
    items.iter().for_each(|i| starts[i.0 as usize + 1] += 1);
    for v in 0..count {
        starts[v + 1] += starts[v];
    }
    let mut fill = starts.clone();
    let mut out = vec![DVec3::ZERO; items.len()];
    for &(v, d) in items {
        out[fill[v as usize] as usize] = d;
        fill[v as usize] += 1;
    }
    (starts, out)
}

fn clearance((faces, edges): (&[DVec3], &[DVec3]), n: DVec3) -> f64 {
    let seen = faces.iter().fold(f64::INFINITY, |m, f| m.min(f.dot(n)));
    edges.iter().fold(seen, |m, e| m.min(e.cross(n).length()))
}

fn turn(stars: &Stars, normal: DVec3, v: usize, least: f64) -> Option<(DVec3, Turned)> {
    let star = stars.at(v);
    let n = normal.try_normalize()?;
    let before = clearance(star, n);
    // Vertices without faces or edges have an infinite clearance.
    if before >= least {
        return None;
    }
    let best = clearest(star, n);
    let after = clearance(star, best);
    let goal = least.min(0.9 * after);
    if !(goal > before) {
        // As good as it gets.
        return Some((normal, Turned { vertex: v as u32, angle: 0.0, clearance: [before; 2] }));
    }
    // The first step on the way that is good enough: clearance need not grow all the way.
    const STEPS: u32 = 64;
    let whole = DQuat::from_rotation_arc(n, best);
    let at = |s: u32| DQuat::IDENTITY.slerp(whole, f64::from(s) / f64::from(STEPS)) * n;
    let m = (1..STEPS).map(at).find(|m| clearance(star, *m) >= goal).unwrap_or(best);
    let turned =
        Turned { vertex: v as u32, angle: n.angle_between(m), clearance: [before, clearance(star, m)] };
    Some((m * normal.length(), turned))
}

/// The direction of largest clearance, found on a grid of the sphere and by steps of falling length around the best.
fn clearest(star: (&[DVec3], &[DVec3]), n: DVec3) -> DVec3 {
    const GRID: u32 = 500;
    let mut best = (clearance(star, n), n);
    let offer = |m: DVec3, best: &mut (f64, DVec3)| {
        let c = clearance(star, m);
        if c > best.0 {
            *best = (c, m);
        }
    };
    let golden = std::f64::consts::PI * (1.0 + 5f64.sqrt());
    for k in 0..GRID {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(GRID);
        let (sin, cos) = (golden * f64::from(k)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        offer(DVec3::new(r * cos, r * sin, z), &mut best);
    }
    let mut step = 0.1;
    while step > 1e-3 {
        let (centre, (a, b)) = (best.1, best.1.any_orthonormal_pair());
        for k in 0..12 {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 12.0).sin_cos();
            offer((centre + step * (cos * a + sin * b)).normalize(), &mut best);
        }
        if best.1 == centre {
            step *= 0.5;
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Face;

    #[test]
    fn good_normals_stay_and_bad_ones_see_their_faces() {
        let mesh = suture_mesh::shapes::sphere(1);
        let mut poly = PolyMesh::from_triangles(&mesh, &mesh.positions).unwrap();
        assert!(steer_normals(&mut poly, 0.3).is_empty());
        poly.normals[3] = -2.0 * poly.normals[3];
        let turned = steer_normals(&mut poly, 0.3);
        assert!(turned.len() == 1 && turned[0].clearance[0] < 0.0 && turned[0].clearance[1] >= 0.3);
        assert!((poly.normals[3].length() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_vertex_that_no_normal_suits_keeps_the_best() {
        // Two faces back to back.
        let mut poly = PolyMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: vec![DVec3::Z; 3],
            faces: vec![Face::Triangle([0, 1, 2]), Face::Triangle([0, 2, 1])],
        };
        for t in steer_normals(&mut poly, 0.3) {
            assert!(t.clearance[1] > t.clearance[0] && t.clearance[1] <= 1e-9, "{t:?}");
        }
    }
}
