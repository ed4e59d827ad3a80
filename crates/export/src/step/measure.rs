//! How far the faces lie from the patches, and how they join along edges.

use glam::{DMat2, DVec3};
use suture_bernstein::{BSplineSurface, Jet2};
use suture_surface::Surface;

use super::brep::{Brep, Geometry};
use super::layout::{Block, Layout};

/// Curvatures below which a jump is not related to the curvature itself, times the diagonal: for the report and for refinement.
const FLAT: [f64; 2] = [0.1, 1.0];

/// Places within an interval between nodes where errors are taken: nodes themselves have none.
const PLACES: [f64; 4] = [0.12, 0.38, 0.62, 0.88];

/// Samples of edges on which no node is known.
const SAMPLES: usize = 32;

/// Errors along an edge.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jump {
    /// Largest distance between the points that the faces and the curve have for one parameter.
    pub(crate) gap: f64,
    /// Largest angle between the normals in radians.
    pub(crate) angle: f64,
    /// Largest jump of the shape operator relative to the largest curvature beside it.
    pub(crate) curvature: f64,
    /// The same where parts bent less than a circle of the size of the whole count as flat: worth more nodes.
    pub(crate) bend: f64,
}

impl Jump {
    /// The larger of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            gap: self.gap.max(other.gap),
            angle: self.angle.max(other.angle),
            curvature: self.curvature.max(other.curvature),
            bend: self.bend.max(other.bend),
        }
    }
}

/// The errors along edge `number`, part by part between its joints.
pub(crate) fn edge(
    brep: &Brep,
    layout: &Layout,
    number: usize,
    diagonal: f64,
    uses: &[(usize, usize)],
) -> Vec<Jump> {
    let (edge, plan) = (&brep.edges[number], &layout.edges[number]);
    let coedges: Vec<_> = uses
        .iter()
        .filter_map(|&(face, at)| {
            let face = &brep.faces[face];
            let pcurve = face.loops.iter().flatten().nth(at)?.pcurve.as_ref()?;
            match &face.geometry {
                Geometry::Spline(surface) => Some((surface, pcurve, if face.flipped { -1.0 } else { 1.0 })),
                _ => None,
            }
        })
        .collect();
    let ends = [plan.joints[0], plan.joints[plan.joints.len() - 1]];
    plan.joints
        .windows(2)
        .zip(&plan.classes)
        .map(|(span, class)| {
            let length = span[1] - span[0];
            let intervals = class.map_or(SAMPLES / PLACES.len(), |c| layout.classes[c].intervals).max(8);
            let inner = (0..intervals).flat_map(|i| PLACES.map(|p| (i as f64 + p) / intervals as f64));
            // Where knot lines end on corners, the worst may be close to them.
            let near = [1e-6, 1e-4, 1e-3, 1e-2].into_iter().flat_map(|x| [x, 1.0 - x]);
            inner.chain(near).fold(Jump::default(), |worst, x| {
                let t = (span[0] + length * x).clamp(ends[0], ends[1]);
                let on_curve = edge.curve.point(t);
                let jets: Vec<(Jet2, f64)> =
                    coedges.iter().map(|(s, p, sign)| (s.jet(p.point(t)), *sign)).collect();
                let gap = jets.iter().map(|(j, _)| j.p.distance(on_curve)).fold(0.0, f64::max);
                let mut jump = Jump { gap, ..Jump::default() };
                if let [(a, s), (b, r)] = &jets[..] {
                    jump.gap = jump.gap.max(a.p.distance(b.p));
                    if let Some((angle, jumps)) = across(a, b, s * r, diagonal) {
                        (jump.angle, [jump.curvature, jump.bend]) = (angle, jumps);
                    }
                }
                worst.max(jump)
            })
        })
        .collect()
}

/// Angle and relative jumps of curvature, by both sorts of flatness, between two surfaces at one point; `sign` is −1 where their orientations disagree.
fn across(a: &Jet2, b: &Jet2, sign: f64, diagonal: f64) -> Option<(f64, [f64; 2])> {
    let (m, n) = (a.normal()?, b.normal()? * sign);
    let angle = m.cross(n).length().atan2(m.dot(n));
    let x = m.any_orthonormal_vector();
    let y = m.cross(x);
    let (s, t) = (shape(a, m, x, y)?, shape(b, n, x, y)?);
    let (jump, size) = (largest(s - t), largest(s).max(largest(t)));
    Some((angle, FLAT.map(|flat| jump / size.max(flat / diagonal))))
}

/// The shape operator as a matrix in the directions `x` and `y`, which are tangent, or nearly so.
fn shape(jet: &Jet2, normal: DVec3, x: DVec3, y: DVec3) -> Option<DMat2> {
    let second = DMat2::from_cols_array(&[
        jet.duu.dot(normal),
        jet.duv.dot(normal),
        jet.duv.dot(normal),
        jet.dvv.dot(normal),
    ]);
    // (u, v) of x and y: the inverse of the projections of S_u and S_v.
    let map = DMat2::from_cols_array(&[jet.du.dot(x), jet.du.dot(y), jet.dv.dot(x), jet.dv.dot(y)]);
    let inverse = map.inverse();
    let shape = inverse.transpose() * second * inverse;
    shape.is_finite().then_some(shape)
}

/// Largest absolute eigenvalue of a symmetric matrix.
fn largest(m: DMat2) -> f64 {
    let (a, b, c) = (m.x_axis.x, 0.5 * (m.x_axis.y + m.y_axis.x), m.y_axis.y);
    (0.5 * (a + c)).abs() + (0.25 * (a - c) * (a - c) + b * b).sqrt()
}

/// Distances of a fitted block from its patches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Deviation {
    /// Between nodes of `a` on nodes of `b`, by piece: what nodes of `a` can cure.
    pub(crate) along_a: Vec<f64>,
    /// The other way round, by piece.
    pub(crate) along_b: Vec<f64>,
    /// Between nodes of both, by piece.
    pub(crate) inside: Vec<f64>,
}

/// Measures a fitted block.
pub(crate) fn block(
    surface: &Surface,
    layout: &Layout,
    block: &Block,
    fitted: &BSplineSurface<DVec3>,
) -> Deviation {
    let nodes = layout.nodes(block).map(|parts| {
        let mut all: Vec<f64> = parts.into_iter().flatten().collect();
        all.dedup();
        all
    });
    let count = block.pieces.len();
    let mut found =
        Deviation { along_a: vec![0.0; count], along_b: vec![0.0; count], inside: vec![0.0; count] };
    let distance = |k: usize, a: f64, b: f64| {
        let exact = block.jet(surface, k, a, b).p;
        exact.distance(fitted.point(glam::DVec2::new(a, b)))
    };
    let raise = |x: &mut f64, to: f64| *x = if to > *x || to.is_nan() { to } else { *x };
    // Halves rather than the places nearer to the nodes: splines err most there. One place beside them meets kinks.
    let places = [0.5, 0.21];
    for a in nodes[0].windows(2) {
        let k = block.piece(a[0]);
        for b in nodes[1].windows(2) {
            for place in places {
                let (x, y) = (a[0] + (a[1] - a[0]) * place, b[0] + (b[1] - b[0]) * (1.0 - place));
                raise(&mut found.along_a[k], distance(k, x, b[0]));
                raise(&mut found.along_b[k], distance(k, a[0], y));
                raise(&mut found.inside[k], distance(k, x, y));
            }
        }
    }
    found
}
