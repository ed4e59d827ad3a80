//! What is measured of a bubble surface when it is built.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde::Serialize;
use suture_surface::Patch;

use crate::{
    BubbleError, cross, error::Measure, lean::Beside, network::Network, patch::BubblePatch,
    poly_mesh::PolyMesh, steer::Turned, strip::Strip,
};

/// A number with the place where it is taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// The edge, lower index first, or the first two vertices of the face.
    pub edge: [u32; 2],
    /// Parameter on the edge, or 0.
    pub t: f64,
}

/// A named doubt about the surface.
#[derive(Clone, Debug, PartialEq, Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BubbleWarning {
    /// Strips come near degeneration.
    #[error("{count} strips come near degeneration: {what} falls to {:.3} on edge {} → {}, below {limit}", worst.value, worst.edge[0], worst.edge[1])]
    Weak {
        /// The quantity.
        what: Measure,
        /// Number of strips below the limit.
        count: usize,
        /// The worst one.
        worst: Extreme,
        /// The limit.
        limit: f64,
    },
    /// Patches fold over: their normal turns against the interpolated one.
    #[error("{count} patches fold over (the first is {first}); refine the mesh there, or smooth the normals")]
    Folds {
        /// Number of patches.
        count: usize,
        /// The first one.
        first: usize,
    },
    /// Normals were turned, so that they see their faces from the front and no edge runs along them.
    #[error("{count} normals were turned, so that they see the faces there from the front; the most by {:.1}° at vertex {}", most.angle.to_degrees(), most.vertex)]
    Turned {
        /// Number of normals.
        count: usize,
        /// The one that was turned most.
        most: Turned,
    },
    /// No normal sees all faces of a vertex from the front: the tangents of its edges were laid out anew.
    #[error(
        "the faces at {count} vertices (the first is {first}) cannot be seen from any one side; their edges leave in other directions, and patches may fold there"
    )]
    Unrolled {
        /// Number of vertices.
        count: usize,
        /// The first one.
        first: u32,
    },
    /// Patches that would turn back over a side of theirs are bent to leave it to the inside.
    #[error(
        "{count} patches (the first is {first}) would turn back over their own sides, as needles do; they are bent to leave them to the inside"
    )]
    Leaned {
        /// Number of patches.
        count: usize,
        /// The first one.
        first: usize,
    },
    /// Edges with more than two faces have strips but no seams.
    #[error("{count} edges have more than two faces (the first is {} → {}); no seam is claimed there", first[0], first[1])]
    NonManifold {
        /// Number of edges.
        count: usize,
        /// The first one.
        first: [u32; 2],
    },
}

/// Measurements of a bubble surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BubbleReport {
    /// The order `n`.
    pub order: usize,
    /// Number of triangular patches.
    pub triangles: usize,
    /// Number of quadrilateral patches.
    pub quads: usize,
    /// Number of strips.
    pub strips: usize,
    /// Number of strips on the boundary.
    pub boundary: usize,
    /// Number of creases.
    pub creases: usize,
    /// Smallest cosine between gradient and interpolated normal over all strips: the denominator of every cross derivative. `None` for order 0.
    pub cosine: Option<Extreme>,
    /// Smallest length of the interpolated normal relative to the longer one at the ends.
    pub normal: Extreme,
    /// Smallest speed of a boundary curve relative to the length of the edge.
    pub speed: Extreme,
    /// Smallest `|S_u × S_v| / (|S_u| |S_v|)` over the samples.
    pub regularity: f64,
    /// Smallest cosine between surface normal and interpolated normal over the samples; negative where the surface folds over.
    pub fold: f64,
    /// Number of normals that were turned.
    pub turned: usize,
    /// Doubts.
    pub warnings: Vec<BubbleWarning>,
}

/// Samples per strip.
const STRIP_SAMPLES: usize = 9;

/// Weighs a strip; NaN counts as the smallest. `visit` sees parameter, N and curve of every sample.
pub(crate) fn weigh(strip: &Strip, mut visit: impl FnMut(f64, DVec3, &[DVec3; 3])) -> Weights {
    let mut worst = [(f64::INFINITY, 0.0); 3];
    let [a, b] = strip.ends();
    let edge = (b - a).length();
    let longest = strip.normals().map(DVec3::length);
    let longest = longest[0].max(longest[1]);
    for i in 0..STRIP_SAMPLES {
        let t = i as f64 / (STRIP_SAMPLES - 1) as f64;
        let n = strip.normal(t);
        let p = strip.curve(t);
        visit(t, n, &p);
        let mut values = [1.0, n.length() / longest, p[1].length() / edge];
        if strip.order() > 0 {
            let [x, y, z] = gradient(strip, t);
            let g = DVec3::new(x, y, z);
            values[0] = g.dot(n) / (g.length() * n.length());
        }
        for (worst, value) in worst.iter_mut().zip(values) {
            if !(value >= worst.0) {
                *worst = (if value.is_nan() { f64::NEG_INFINITY } else { value }, t);
            }
        }
    }
    worst
}

/// The gradient of a strip; it does not depend on the levels above.
fn gradient(strip: &Strip, t: f64) -> [f64; 3] {
    let psi = cross::tensors::<1, 2>(strip, t);
    [psi[0][0][0], psi[0][1][0], psi[0][2][0]]
}

/// Limits of the measures of strips.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) refuse: [f64; 3],
    pub(crate) warn: [f64; 3],
}

const MEASURES: [Measure; 3] = [Measure::Cosine, Measure::Normal, Measure::Speed];

/// Smallest cosine, normal and speed of a strip, with their parameters.
type Weights = [(f64, f64); 3];

/// What the strips weigh.
pub(crate) struct Weighed {
    pub(crate) extremes: [Extreme; 3],
    pub(crate) warnings: Vec<BubbleWarning>,
    /// The faces that may need leans.
    pub(crate) doubtful: Vec<bool>,
}

/// Weighs all strips.
///
/// # Errors
/// [`BubbleError::Degenerate`], the first in the order of edges.
pub(crate) fn weigh_all(mesh: &PolyMesh, network: &Network, limits: &Limits) -> Result<Weighed, BubbleError> {
    let weighed = network.strips.par_iter().zip(&network.edges.edges).map(|(strip, e)| {
        let mut beside = Beside::of(mesh, network, e, strip);
        let weights = weigh(strip, |t, n, p| beside.look(t, n, p));
        (weights, [0, 1].map(|i| beside.doubtful(i)))
    });
    let (weights, doubts): (Vec<Weights>, Vec<[bool; 2]>) = weighed.unzip();
    let mut doubtful = vec![false; mesh.faces.len()];
    for (e, d) in network.edges.edges.iter().zip(&doubts) {
        for (i, u) in e.faces.iter().enumerate() {
            doubtful[u.face as usize] |= d[i.min(1)];
        }
    }
    let none = Extreme { value: f64::INFINITY, edge: [0; 2], t: 0.0 };
    let (mut worst, mut counts) = ([none; 3], [0; 3]);
    for (e, weights) in network.edges.edges.iter().zip(&weights) {
        for (m, &(value, t)) in weights.iter().enumerate() {
            if value < limits.refuse[m] {
                let (what, limit) = (MEASURES[m], limits.refuse[m]);
                return Err(BubbleError::Degenerate { edge: e.vertices, t, what, value, limit });
            }
            counts[m] += usize::from(value < limits.warn[m]);
            if value < worst[m].value {
                worst[m] = Extreme { value, edge: e.vertices, t };
            }
        }
    }
    let warnings = (0..3).filter(|&m| counts[m] > 0).map(|m| {
        let (what, count, worst, limit) = (MEASURES[m], counts[m], worst[m], limits.warn[m]);
        BubbleWarning::Weak { what, count, worst, limit }
    });
    Ok(Weighed { extremes: worst, warnings: warnings.collect(), doubtful })
}

/// Smallest regularity and smallest cosine between surface normal and interpolated normal at sample points inside and at the corners,
/// where a face that is seen from behind along the normal folds first.
pub(crate) fn regularity(patch: &BubblePatch) -> [f64; 2] {
    const TRIANGLE: [[f64; 2]; 7] =
        [[1.0 / 3.0, 1.0 / 3.0], [0.45, 0.1], [0.45, 0.45], [0.1, 0.45], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    const QUAD: [[f64; 2]; 9] = [
        [0.5, 0.5],
        [0.15, 0.15],
        [0.85, 0.15],
        [0.85, 0.85],
        [0.15, 0.85],
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
    ];
    let samples: &[[f64; 2]] = if patch.count == 3 { &TRIANGLE } else { &QUAD };
    let mut worst = [f64::INFINITY; 2];
    for &[u, v] in samples {
        let at = DVec2::new(u, v);
        let jet = patch.jet(at);
        let n = patch.interpolate(&patch.normals, at).p;
        let cross = jet.du.cross(jet.dv);
        let sine = cross.length() / (jet.du.length() * jet.dv.length());
        let cosine = cross.dot(n) / (cross.length() * n.length());
        for (worst, value) in worst.iter_mut().zip([sine, cosine]) {
            if !(value >= *worst) {
                *worst = if value.is_nan() { -1.0 } else { value };
            }
        }
    }
    worst
}
