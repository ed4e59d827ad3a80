//! Arcs as fair curves on the mesh instead of chains of its edges.
//!
//! A chain of mesh edges zigzags by half an edge, and blends that follow it inherit every bend. Here each arc is
//! resampled by arc length, smoothed (least squares against the chain plus the energy of its second differences) and pulled back
//! to the nearest points of the mesh.

use glam::DVec3;
use suture_mesh::{Topology, TriMesh, median_edge_length};

use crate::Segmentation;

/// A point of the mesh: a face and barycentric coordinates in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPoint {
    /// The face.
    pub face: u32,
    /// Weights of the face's three vertices, in `[0, 1]`, of sum 1.
    pub barycentric: [f64; 3],
    /// The position that they stand for.
    pub position: DVec3,
}

/// How fair arcs are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FairOptions {
    /// Bends shorter than this are smoothed away, in median edge lengths. Default 6: the zigzag of an edge chain has a wave length
    /// of two to four edges, and what a scan means to say is longer than six.
    pub cutoff: f64,
    /// Dihedral angle in radians from which an edge is a crease that its arc must not leave. Default 30°.
    pub crease: f64,
}

impl Default for FairOptions {
    fn default() -> Self {
        Self { cutoff: 6.0, crease: 30f64.to_radians() }
    }
}

/// Every arc of the segmentation as a fair polyline of mesh points, from corner to corner, about half a median edge apart; the ends
/// are the corner vertices.
///
/// # Panics
/// When the segmentation does not belong to the mesh.
pub fn fair_arcs(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    options: &FairOptions,
) -> Vec<Vec<MeshPoint>> {
    let fairing = Fairing::new(mesh, topology);
    segmentation.arcs.iter().map(|arc| fairing.arc(&arc.vertices, options)).collect()
}

/// How strongly a point on a crease holds to it, against 1 elsewhere.
const HOLD: f64 = 1e4;
/// Rounds of smoothing and pulling back. The second round starts from points on the mesh and moves them little.
const ROUNDS: usize = 3;

/// Draws fair arcs on one mesh, one at a time.
#[derive(Clone, Copy, Debug)]
pub struct Fairing<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    edge: f64,
}

impl<'a> Fairing<'a> {
    /// Measures the mesh.
    pub fn new(mesh: &'a TriMesh, topology: &'a Topology) -> Self {
        Self { mesh, topology, edge: median_edge_length(mesh) }
    }

    /// The median length of the mesh's edges.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// One chain of mesh edges as [`fair_arcs`] draws it.
    ///
    /// # Panics
    /// When the chain has fewer than two vertices or does not belong to the mesh.
    pub fn arc(&self, chain: &[u32], options: &FairOptions) -> Vec<MeshPoint> {
        let Self { mesh, topology, edge } = *self;
        let position = |v: u32| mesh.positions[v as usize];
        let mut lengths = vec![0.0];
        for w in chain.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + position(w[0]).distance(position(w[1])));
        }
        let total = lengths[lengths.len() - 1];
        let count = if edge > 0.0 { ((2.0 * total / edge).ceil() as usize).clamp(8, 100_000) } else { 8 };
        let step = total / count as f64;

        let creased = creased(mesh, topology, chain, options.crease);

        let mut start: Vec<(DVec3, u32, f64)> = Vec::with_capacity(count + 1);
        for i in 0..=count {
            let at = total * i as f64 / count as f64;
            let k = lengths.partition_point(|&l| l <= at).clamp(1, chain.len() - 1);
            let w = ((at - lengths[k - 1]) / (lengths[k] - lengths[k - 1])).clamp(0.0, 1.0);
            let p = position(chain[k - 1]) * (1.0 - w) + position(chain[k]) * w;
            let face = topology.half_edge(chain[k - 1], chain[k]).map_or(0, |h| h / 3);
            start.push((p, face, if creased[k - 1] { HOLD } else { 1.0 }));
        }
        // The ends stay: the two outermost unknowns are fixed by their weight.
        start[0].2 = 1e12;
        start[count].2 = 1e12;

        // |p − q|² + μ |D²p|² damps a wave of length λ by 1/(1 + μ (2π h/λ)⁴): one half at the cutoff.
        let cutoff = options.cutoff * edge.max(step);
        let mu = (cutoff / (std::f64::consts::TAU * step)).powi(4);
        let weights: Vec<f64> = start.iter().map(|s| s.2).collect();
        let mut points: Vec<MeshPoint> =
            start.iter().map(|&(p, face, _)| nearest(mesh, topology, face, p)).collect();
        for round in 0..ROUNDS {
            let targets: Vec<DVec3> = if round == 0 {
                start.iter().map(|s| s.0).collect()
            } else {
                points.iter().map(|p| p.position).collect()
            };
            // Later rounds only remove what the pulling back added.
            let mu = if round == 0 { mu } else { mu / 16.0 };
            let smooth = smooth_line(&targets, &weights, mu);
            for (point, p) in points.iter_mut().zip(smooth) {
                *point = nearest(mesh, topology, point.face, p);
            }
        }
        let end = |v: u32, near: u32| -> MeshPoint {
            let face = topology
                .outgoing(v)
                .map(|h| topology.face(h))
                .min_by_key(|&f| (f != near, f))
                .unwrap_or(near);
            let barycentric = mesh.faces[face as usize].map(|w| if w == v { 1.0 } else { 0.0 });
            MeshPoint { face, barycentric, position: position(v) }
        };
        points[0] = end(chain[0], points[0].face);
        points[count] = end(chain[chain.len() - 1], points[count].face);
        points.dedup_by(|b, a| a.position == b.position);
        points
    }
}

/// Which edges of a chain are part of a crease that it follows: bent by more than `angle`, and the chain runs straight through
/// both of their ends. On coarse and rough meshes many edges are bent, but a chain over them turns at every vertex.
fn creased(mesh: &TriMesh, topology: &Topology, chain: &[u32], angle: f64) -> Vec<bool> {
    let between = |a: DVec3, b: DVec3| a.cross(b).length().atan2(a.dot(b));
    let along = |k: usize| mesh.positions[chain[k + 1] as usize] - mesh.positions[chain[k] as usize];
    let last = chain.len() - 2;
    (0..=last)
        .map(|k| {
            let straight = |a: usize, b: usize| between(along(a), along(b)) < STRAIGHT;
            if (k > 0 && !straight(k - 1, k)) || (k < last && !straight(k, k + 1)) {
                return false;
            }
            let sides =
                topology.half_edge(chain[k], chain[k + 1]).and_then(|h| Some((h, topology.opposite(h)?)));
            sides.is_some_and(|(h, o)| {
                between(mesh.area_vector(h as usize / 3), mesh.area_vector(o as usize / 3)) > angle
            })
        })
        .collect()
}

/// Largest turn, in radians, between consecutive edges of a crease: 40°.
const STRAIGHT: f64 = 0.7;

/// Minimises `Σ w |p − q|² + μ Σ |p_{i−1} − 2 p_i + p_{i+1}|²` over the points `p` of an open polyline, by a Cholesky factorisation
/// of its pentadiagonal matrix. Weights are positive; `targets` and `weights` have the same length.
pub fn smooth_line(targets: &[DVec3], weights: &[f64], mu: f64) -> Vec<DVec3> {
    let n = targets.len();
    // a[i] = [diagonal, first, second superdiagonal]
    let mut a: Vec<[f64; 3]> = weights.iter().map(|&w| [w, 0.0, 0.0]).collect();
    for i in 1..n.saturating_sub(1) {
        let row = [1.0, -2.0, 1.0];
        for r in 0..3 {
            for c in r..3 {
                a[i - 1 + r][c - r] += mu * row[r] * row[c];
            }
        }
    }
    let mut x: Vec<DVec3> = targets.iter().zip(weights).map(|(&q, &w)| q * w).collect();
    // LDLᵀ in place; the matrix is positive definite because all weights are positive.
    for i in 0..n {
        let [d, e, f] = a[i];
        if i + 1 < n {
            let l = e / d;
            a[i + 1][0] -= l * e;
            a[i + 1][1] -= l * f;
            a[i][1] = l;
            let t = x[i];
            x[i + 1] -= t * l;
        }
        if i + 2 < n {
            let l = f / d;
            a[i + 2][0] -= l * f;
            a[i][2] = l;
            let t = x[i];
            x[i + 2] -= t * l;
        }
    }
    for i in (0..n).rev() {
        let mut t = x[i] / a[i][0];
        if i + 1 < n {
            t -= x[i + 1] * a[i][1];
        }
        if i + 2 < n {
            t -= x[i + 2] * a[i][2];
        }
        x[i] = t;
    }
    x
}

/// The point of the mesh nearest to `p` that a descent over neighbouring faces finds from `face`: the nearest one of the same sheet.
pub(crate) fn nearest(mesh: &TriMesh, topology: &Topology, face: u32, p: DVec3) -> MeshPoint {
    let on = |face: u32| {
        let barycentric = project(mesh.corners(face as usize), p);
        let [a, b, c] = mesh.corners(face as usize);
        let position = a * barycentric[0] + b * barycentric[1] + c * barycentric[2];
        MeshPoint { face, barycentric, position }
    };
    let mut best = on(face);
    // Every step lowers the distance, so no face comes twice and the loop ends.
    loop {
        let from = best;
        for v in mesh.faces[from.face as usize] {
            for h in topology.outgoing(v) {
                let candidate = on(topology.face(h));
                if candidate.position.distance_squared(p) < best.position.distance_squared(p) {
                    best = candidate;
                }
            }
        }
        if best.face == from.face {
            return best;
        }
    }
}

/// Barycentric coordinates of the point of a triangle nearest to `p` (Ericson, *Real-Time Collision Detection*, 2005, 5.1.5).
fn project([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = if d1 > d3 { d1 / (d1 - d3) } else { 0.0 };
        return [1.0 - t, t, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = if d2 > d6 { d2 / (d2 - d6) } else { 0.0 };
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    let (v, w) = (vb / sum, vc / sum);
    [1.0 - v - w, v, w]
}
