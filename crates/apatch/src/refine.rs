//! Local refinement by modified Butterfly: finer faces where the hull could not be built, the old vertices kept.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

/// A refined mesh; its normals are gradients, interpolated like the positions.
pub(crate) struct Finer {
    pub(crate) mesh: TriMesh,
    /// The face that each face is a part of.
    pub(crate) parents: Vec<u32>,
}

/// Where new vertices lie.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Rule {
    /// By the stencils of modified Butterfly: what the vertices around suggest.
    Butterfly,
    /// On the cubics that leave the ends of their edges in the tangent planes: what the normals suggest. Edges half as long leave their
    /// tangent planes half as steeply.
    Tangents,
}

/// Divides the edges of the given faces, and the faces beside them as far as it takes to stay watertight. Edges for which
/// `straight` holds are divided at their midpoint: what is plane stays plane. `None` without anything to divide.
///
/// # References
/// D. Zorin, P. Schröder, W. Sweldens, *Interpolating subdivision for meshes with arbitrary topology*, 1996.
pub(crate) fn butterfly(
    mesh: &TriMesh,
    topology: &Topology,
    faces: &[usize],
    straight: impl Fn(u32) -> bool,
    rule: Rule,
) -> Option<Finer> {
    let normals = mesh.normals.as_ref()?;
    if mesh.positions.len() + 3 * faces.len() >= u32::MAX as usize / 4 {
        return None;
    }
    let mut fine = TriMesh { faces: Vec::with_capacity(mesh.faces.len() + 3 * faces.len()), ..mesh.clone() };
    let mut gradients = normals.clone();
    // Only looked up, never walked through.
    let mut middle: HashMap<u32, u32> = HashMap::new();
    let mut push = |p: DVec3, g: DVec3, h: u32, middle: &mut HashMap<u32, u32>| {
        if !(g.length_squared().is_normal() && p.is_finite()) {
            return None;
        }
        let id = fine.positions.len() as u32;
        fine.positions.push(p);
        gradients.push(g);
        middle.insert(h, id);
        if let Some(o) = topology.opposite(h) {
            middle.insert(o, id);
        }
        Some(())
    };
    for &f in faces {
        for h in (3 * f as u32)..(3 * f as u32 + 3) {
            if middle.contains_key(&h) {
                continue;
            }
            let ends = [topology.tail(h), topology.head(h)];
            if rule == Rule::Tangents && !straight(h) {
                let at = |of: &[DVec3]| ends.map(|v| of[v as usize]);
                let (p, g) = between(at(&mesh.positions), at(normals));
                push(p, g, h, &mut middle)?;
                continue;
            }
            let weights = if straight(h) { midpoint(topology, h) } else { stencil(topology, h) };
            let sum = |of: &[DVec3]| weights.iter().map(|&(v, w)| of[v as usize] * w).sum::<DVec3>();
            let (mut p, mut g) = (sum(&mesh.positions), sum(normals));
            let [a, b] = ends.map(|v| normals[v as usize]);
            let even = 0.5 * (a + b);
            if !(g.dot(a) > 0.0 && g.dot(b) > 0.0) {
                // The stencil overshoots where normals turn fast; so does it then for the position.
                g = even;
                p = midpoint(topology, h).iter().map(|&(v, w)| mesh.positions[v as usize] * w).sum();
            }
            push(p, g, h, &mut middle)?;
        }
    }
    if middle.is_empty() {
        return None;
    }
    fine.faces.clear();
    let mut parents = Vec::new();
    for (f, face) in mesh.faces.iter().enumerate() {
        let m = [0, 1, 2].map(|j| middle.get(&(3 * f as u32 + j)).copied());
        let before = fine.faces.len();
        divide(*face, m, &fine.positions, &mut fine.faces);
        parents.extend(std::iter::repeat_n(f as u32, fine.faces.len() - before));
    }
    fine.normals = Some(gradients);
    Some(Finer { mesh: fine, parents })
}

/// The parts of a face whose edges `j` (from corner `j`) have the given midpoints.
fn divide(v: [u32; 3], m: [Option<u32>; 3], positions: &[DVec3], out: &mut Vec<[u32; 3]>) {
    // Turned so that the odd edge out is the last one.
    let turned = |r: usize| ([0, 1, 2].map(|i| v[(i + r) % 3]), [0, 1, 2].map(|i| m[(i + r) % 3]));
    match m.iter().flatten().count() {
        0 => out.push(v),
        1 => {
            let r = m.iter().position(Option::is_some).unwrap_or(0);
            if let ([a, b, c], [Some(x), _, _]) = turned(r) {
                out.extend([[a, x, c], [x, b, c]]);
            }
        }
        2 => {
            let r = (m.iter().position(Option::is_none).unwrap_or(0) + 1) % 3;
            if let ([a, b, c], [Some(x), Some(y), _]) = turned(r) {
                out.push([x, b, y]);
                let p = |i: u32| positions[i as usize];
                if p(a).distance_squared(p(y)) <= p(x).distance_squared(p(c)) {
                    out.extend([[a, x, y], [a, y, c]]);
                } else {
                    out.extend([[a, x, c], [x, y, c]]);
                }
            }
        }
        _ => {
            if let ([a, b, c], [Some(x), Some(y), Some(z)]) = (v, m) {
                out.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
            }
        }
    }
}

/// The middle of the cubic between two points with their tangent planes, and the normal there: that of the ends, mirrored at the plane
/// across the edge by as much as the edge leaves it.
///
/// # References
/// A. Vlachos, J. Peters, C. Boyd, J. Mitchell, *Curved PN triangles*, 2001.
fn between([a, b]: [DVec3; 2], [g, h]: [DVec3; 2]) -> (DVec3, DVec3) {
    let d = b - a;
    let (m, n) = (g.normalize_or_zero(), h.normalize_or_zero());
    let p = 0.5 * (a + b) + 0.125 * (n * d.dot(n) - m * d.dot(m));
    let sum = m + n;
    let across = sum - d * (2.0 * d.dot(sum) / d.length_squared());
    let normal = if across.dot(sum) > 0.0 { across } else { sum };
    (p, normal.normalize_or_zero() * (0.5 * (g.length() + h.length())))
}

type Weights = Vec<(u32, f64)>;

fn midpoint(topology: &Topology, h: u32) -> Weights {
    vec![(topology.tail(h), 0.5), (topology.head(h), 0.5)]
}

fn stencil(topology: &Topology, h: u32) -> Weights {
    let Some(o) = topology.opposite(h) else { return boundary(topology, h) };
    let [a, b] = [topology.tail(h), topology.head(h)];
    let inner = [a, b].map(|v| !topology.is_boundary_vertex(v));
    let regular = |v: u32| topology.outgoing(v).count() == 6;
    match inner {
        [true, true] => match (regular(a), regular(b)) {
            (true, true) => regular_stencil(topology, h, o),
            (false, true) => around(topology, h),
            (true, false) => around(topology, o),
            (false, false) => {
                let halved = |w: Weights| w.into_iter().map(|(v, w)| (v, 0.5 * w));
                halved(around(topology, h)).chain(halved(around(topology, o))).collect()
            }
        },
        [true, false] => around(topology, h),
        [false, true] => around(topology, o),
        [false, false] => midpoint(topology, h),
    }
}

/// The eight points around an edge between two regular vertices.
fn regular_stencil(topology: &Topology, h: u32, o: u32) -> Weights {
    let mut all = midpoint(topology, h);
    for h in [h, o] {
        let (n, p) = (topology.next(h), topology.prev(h));
        all.push((topology.tail(p), 0.125));
        for wing in [n, p] {
            match topology.opposite(wing) {
                Some(w) => all.push((topology.tail(topology.prev(w)), -0.0625)),
                // Reflection of the corner at the missing wing.
                None => return midpoint(topology, h),
            }
        }
    }
    all
}

/// The rule of an extraordinary inner vertex, the tail of `h`, for the edge `h`.
fn around(topology: &Topology, h: u32) -> Weights {
    let v = topology.tail(h);
    let ring: Vec<u32> = topology.outgoing(v).collect();
    let k = ring.len();
    let first = ring.iter().position(|&r| r == h).unwrap_or(0);
    let weight = |j: usize| match k {
        3 => [5.0 / 12.0, -1.0 / 12.0, -1.0 / 12.0][j],
        4 => [0.375, 0.0, -0.125, 0.0][j],
        _ => {
            let angle = TAU * j as f64 / k as f64;
            (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / k as f64
        }
    };
    let mut all: Weights = (0..k).map(|j| (topology.head(ring[(first + j) % k]), weight(j))).collect();
    all.push((v, 1.0 - all.iter().map(|w| w.1).sum::<f64>()));
    all
}

/// The four-point rule along the boundary.
fn boundary(topology: &Topology, h: u32) -> Weights {
    let [a, b] = [topology.tail(h), topology.head(h)];
    let after = topology.outgoing(b).find(|&n| topology.opposite(n).is_none()).map(|n| topology.head(n));
    // The last of the fan enters along the boundary.
    let before = topology.outgoing(a).last().map(|n| topology.tail(topology.prev(n)));
    match (before, after) {
        (Some(p), Some(q)) => vec![(a, 0.5625), (b, 0.5625), (p, -0.0625), (q, -0.0625)],
        _ => midpoint(topology, h),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use suture_mesh::{check, shapes};

    fn with_normals(mut mesh: TriMesh) -> TriMesh {
        mesh.normals = Some(suture_mesh::vertex_normals_area_weighted(&mesh));
        mesh
    }

    #[test]
    fn any_set_of_faces_leaves_the_mesh_watertight() {
        let mesh = with_normals(shapes::sphere(1));
        let topology = Topology::build(&mesh).unwrap();
        for (step, rule) in
            [1, 2, 3, 7, 40].into_iter().flat_map(|s| [(s, Rule::Butterfly), (s, Rule::Tangents)])
        {
            let faces: Vec<usize> = (0..80).step_by(step).collect();
            let fine = butterfly(&mesh, &topology, &faces, |_| false, rule).unwrap();
            let report = check(&fine.mesh);
            assert!(report.is_sound() && report.closed && report.genus == Some(0), "{step}");
            assert_eq!(fine.parents.len(), fine.mesh.faces.len());
            assert_eq!(&fine.mesh.positions[..42], &mesh.positions[..]);
            for p in &fine.mesh.positions {
                assert!((p.length() - 1.0).abs() < 0.02, "{}", p.length());
            }
        }
    }

    #[test]
    fn stencils_sum_to_one() {
        let mut open = shapes::torus(2.0, 0.5, 12, 8);
        open.faces.truncate(100);
        for mesh in [shapes::sphere(2), open, shapes::cuboid(DVec3::ONE, 1)] {
            let mut mesh = mesh;
            let used: std::collections::BTreeSet<u32> = mesh.faces.iter().flatten().copied().collect();
            mesh.positions.truncate(used.len().max(mesh.positions.len()));
            let topology = Topology::build(&mesh).unwrap();
            for h in 0..topology.half_edge_count() as u32 {
                let sum: f64 = stencil(&topology, h).iter().map(|w| w.1).sum();
                assert!((sum - 1.0).abs() < 1e-14);
            }
        }
    }
}
