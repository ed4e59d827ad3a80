//! Tetrahedra of the hull that intersect although they are not neighbours.

use glam::DVec3;
use rayon::prelude::*;
use suture_mesh::TriMesh;

use crate::edge::EdgeForm;
use crate::face::FaceForm;
use crate::query::{bounds, tree};
use crate::report::Intersections;

/// Largest number of pairs that the report names.
const NAMED: usize = 20;

struct Tetrahedron {
    v: [DVec3; 4],
    /// Vertices of the mesh that it touches; the last one doubled for edges.
    touches: [u32; 3],
    face: u32,
}

/// Counts pairs of tetrahedra that share no vertex of the mesh and overlap in more than rounding.
pub(crate) fn count(
    mesh: &TriMesh,
    faces: &[Option<FaceForm>],
    edges: &[EdgeForm],
    beside: impl Fn(usize) -> [Option<u32>; 2],
) -> Intersections {
    let mut all = Vec::new();
    for (f, form) in faces.iter().enumerate() {
        let Some(form) = form else { continue };
        let [a, b, c] = form.p;
        for side in form.sides.iter().flatten() {
            all.push(Tetrahedron { v: [a, b, c, side.apex], touches: mesh.faces[f], face: f as u32 });
        }
    }
    for (e, form) in edges.iter().enumerate() {
        let [Some(f), _] = beside(e) else { continue };
        let Some(k) = ends(mesh, f, form) else { continue };
        for side in form.sides.iter().flatten() {
            let v = [side.apex[0], form.p[0], form.p[1], side.apex[1]];
            all.push(Tetrahedron { v, touches: [k[0], k[1], k[1]], face: f });
        }
    }
    if all.is_empty() {
        return Intersections::default();
    }
    let boxes: Vec<_> = all.iter().map(|t| bounds(&t.v)).collect();
    let tree = tree(&boxes);
    let pairs: Vec<Vec<[u32; 2]>> = (0..all.len())
        .into_par_iter()
        .map(|i| {
            let one = &all[i];
            let mut hits: Vec<u32> = tree
                .intersect_aabb(&boxes[i])
                .filter(|&j| j as usize > i)
                .filter(|&j| !all[j as usize].touches.iter().any(|v| one.touches.contains(v)))
                .filter(|&j| overlap(&one.v, &all[j as usize].v))
                .collect();
            hits.sort_unstable();
            hits.into_iter().map(|j| [one.face, all[j as usize].face]).collect()
        })
        .collect();
    let total = pairs.iter().map(Vec::len).sum();
    Intersections { pairs: total, first: pairs.into_iter().flatten().take(NAMED).collect() }
}

/// The ends of an edge in the numbers of the mesh.
fn ends(mesh: &TriMesh, face: u32, form: &EdgeForm) -> Option<[u32; 2]> {
    let corners = mesh.faces.get(face as usize)?;
    let find = |p: DVec3| corners.iter().copied().find(|&v| mesh.positions[v as usize] == p);
    Some([find(form.p[0])?, find(form.p[1])?])
}

/// Whether two tetrahedra overlap: no axis of the 44 candidates separates them.
fn overlap(a: &[DVec3; 4], b: &[DVec3; 4]) -> bool {
    const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
    let separated = |axis: DVec3| {
        let range = |t: &[DVec3; 4]| {
            // From one origin, so that far from zero nothing is lost.
            let x = t.map(|p| (p - a[0]).dot(axis));
            (x[0].min(x[1]).min(x[2].min(x[3])), x[0].max(x[1]).max(x[2].max(x[3])))
        };
        let ((alo, ahi), (blo, bhi)) = (range(a), range(b));
        let slack = 1e-9 * ((ahi - alo) + (bhi - blo));
        ahi <= blo + slack || bhi <= alo + slack
    };
    let normal = |t: &[DVec3; 4], [i, j, k]: [usize; 3]| (t[j] - t[i]).cross(t[k] - t[i]);
    if FACES.iter().any(|&f| separated(normal(a, f)) || separated(normal(b, f))) {
        return false;
    }
    !EDGES.iter().any(|&[i, j]| {
        EDGES.iter().any(|&[k, l]| {
            let (d, e) = (a[j] - a[i], b[l] - b[k]);
            let axis = d.cross(e);
            // Parallel edges span no axis.
            axis.length_squared() > 1e-24 * d.length_squared() * e.length_squared() && separated(axis)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlapping_touching_and_distant_tetrahedra_are_told_apart() {
        let a = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let moved = |d: DVec3| a.map(|p| p + d);
        assert!(overlap(&a, &moved(DVec3::splat(0.1))));
        assert!(overlap(&a, &moved(DVec3::new(0.9, 0.0, 0.0))));
        assert!(!overlap(&a, &moved(DVec3::new(1.0, 0.0, 0.0))));
        assert!(!overlap(&a, &moved(DVec3::splat(0.4))));
        assert!(!overlap(&a, &moved(DVec3::splat(5.0))));
        // Two edges that cross at a distance: only a product of edges separates them.
        let [x, y] = [DVec3::X, DVec3::Y];
        let low = [-x, x, DVec3::new(0.0, -0.1, -1.0), DVec3::new(0.0, 0.1, -1.0)];
        let high =
            |z: f64| [-y, y, DVec3::new(-0.1, 0.0, 1.0), DVec3::new(0.1, 0.0, 1.0)].map(|p| p + DVec3::Z * z);
        assert!(!overlap(&low, &high(0.01)));
        assert!(overlap(&low, &high(-0.01)));
    }
}
