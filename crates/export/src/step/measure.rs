//! How far the faces lie from the patches, and how they join along edges.

use glam::{DMat2, DVec3};
use suture_bernstein::{BSplineSurface, Jet2};
use suture_surface::Surface;

use super::brep::{Brep, Geometry};
use super::layout::{Block, Interval, Layout};

/// Curvature below which a jump is not related to the curvature itself, times the diagonal.
const FLAT: f64 = 0.1;

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
}

impl Jump {
    /// The larger of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            gap: self.gap.max(other.gap),
            angle: self.angle.max(other.angle),
            curvature: self.curvature.max(other.curvature),
        }
    }
}

/// The errors along edge `number`, by interval between nodes where there are any, in the order of its parameter.
pub(crate) fn edge(
    brep: &Brep,
    layout: &Layout,
    number: usize,
    diagonal: f64,
    uses: &[(usize, usize)],
) -> Vec<(Option<Interval>, Jump)> {
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
    let first = plan.joints[0];
    let last = plan.joints[plan.joints.len() - 1];
    let at = |t: f64| {
        let t = t.clamp(first, last);
        let on_curve = edge.curve.point(t);
        let jets: Vec<(Jet2, f64)> = coedges.iter().map(|(s, p, sign)| (s.jet(p.point(t)), *sign)).collect();
        let gap = jets.iter().map(|(j, _)| j.p.distance(on_curve)).fold(0.0, f64::max);
        let mut jump = Jump { gap, ..Jump::default() };
        if let [(a, s), (b, r)] = &jets[..] {
            jump.gap = jump.gap.max(a.p.distance(b.p));
            if let Some((angle, relative)) = across(a, b, s * r, diagonal) {
                (jump.angle, jump.curvature) = (angle, relative);
            }
        }
        jump
    };
    let mut found = Vec::new();
    for (span, ruler) in plan.joints.windows(2).zip(&plan.rulers) {
        let span = [span[0], span[1]];
        match ruler {
            Some(ruler) => found.extend(ruler.intervals(&layout.classes, span).into_iter().map(|i| {
                let [a, b] = i.ends;
                let jump = PLACES.map(|p| at(a + (b - a) * p)).into_iter().fold(Jump::default(), Jump::max);
                (Some(i), jump)
            })),
            None => {
                let inner = (0..SAMPLES).map(|i| (i as f64 + 0.5) / SAMPLES as f64);
                let jumps = inner.map(|x| at(span[0] + (span[1] - span[0]) * x));
                found.push((None, jumps.fold(Jump::default(), Jump::max)));
            }
        }
        // Where knot lines end on corners, the worst may be close to them.
        for x in [1e-6, 1e-4, 1e-3, 1e-2] {
            for x in [x, 1.0 - x] {
                let t = span[0] + (span[1] - span[0]) * x;
                let jump = at(t);
                let owner =
                    found.iter_mut().rev().find(|(i, _)| i.is_none_or(|i| i.ends[0] <= t && t <= i.ends[1]));
                if let Some((_, worst)) = owner {
                    *worst = worst.max(jump);
                }
            }
        }
    }
    found
}

/// Angle and relative jump of curvature between two surfaces at one point; `sign` is −1 where their orientations disagree.
fn across(a: &Jet2, b: &Jet2, sign: f64, diagonal: f64) -> Option<(f64, f64)> {
    let (m, n) = (a.normal()?, b.normal()? * sign);
    let angle = m.cross(n).length().atan2(m.dot(n));
    let x = m.any_orthonormal_vector();
    let y = m.cross(x);
    let (s, t) = (shape(a, m, x, y)?, shape(b, n, x, y)?);
    let (jump, size) = (largest(s - t), largest(s).max(largest(t)));
    Some((angle, jump / size.max(FLAT / diagonal)))
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

/// Distances of a fitted block from its patches, by intervals between nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Deviation {
    /// Intervals of `a`, and the largest distance between their nodes on nodes of `b`: what nodes of `a` can cure.
    pub(crate) along_a: Vec<(Interval, f64)>,
    /// The other way round.
    pub(crate) along_b: Vec<(Interval, f64)>,
    /// Between nodes of both, cell by cell, `b` running faster.
    pub(crate) inside: Vec<f64>,
}

/// Measures a fitted block.
pub(crate) fn block(
    surface: &Surface,
    layout: &Layout,
    block: &Block,
    fitted: &BSplineSurface<DVec3>,
) -> Deviation {
    let [along_a, along_b] = layout.intervals(block);
    let start = |all: &[(usize, Interval)]| all.iter().map(|&(_, i)| (i, 0.0)).collect();
    let mut found = Deviation { along_a: start(&along_a), along_b: start(&along_b), inside: Vec::new() };
    let distance = |k: usize, a: f64, b: f64| {
        let exact = block.jet(surface, k, a, b).p;
        exact.distance(fitted.point(glam::DVec2::new(a, b)))
    };
    let raise = |x: &mut f64, to: f64| *x = if to > *x || to.is_nan() { to } else { *x };
    // Halves rather than the places nearer to the nodes: splines err most there. One place beside them meets kinks.
    let places = [0.5, 0.21];
    for (i, &(k, Interval { ends: [a0, a1], .. })) in along_a.iter().enumerate() {
        for (j, &(_, Interval { ends: [b0, b1], .. })) in along_b.iter().enumerate() {
            let mut inside = 0.0;
            for place in places {
                let (x, y) = (a0 + (a1 - a0) * place, b0 + (b1 - b0) * (1.0 - place));
                raise(&mut found.along_a[i].1, distance(k, x, b0));
                raise(&mut found.along_b[j].1, distance(k, a0, y));
                raise(&mut inside, distance(k, x, y));
            }
            found.inside.push(inside);
        }
    }
    found
}
