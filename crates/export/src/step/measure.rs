//! How far the faces lie from the patches, and how they join along edges.

use glam::{DMat2, DVec3};
use suture_bernstein::{BSplineSurface, Jet2};
use suture_surface::Surface;

use super::brep::{Brep, Geometry};
use super::layout::{Block, Interval, Layout, LayoutEdge, Use};

/// Curvature below which a jump is not related to the curvature itself, times the diagonal.
const FLAT: f64 = 0.1;

/// Places within an interval between nodes where errors are taken: nodes themselves have none.
const PLACES: [f64; 4] = [0.12, 0.38, 0.62, 0.88];

/// Samples of edges on which no node is known.
const SAMPLES: usize = 32;

/// Steps towards a place where the curvature along an edge changes its sign.
const STEPS: usize = 4;

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
    // The errors at a parameter, and the larger curvature there with its sign.
    let at = |t: f64| {
        let t = t.clamp(first, last);
        let on_curve = edge.curve.point(t);
        let jets: Vec<(Jet2, f64)> = coedges.iter().map(|(s, p, sign)| (s.jet(p.point(t)), *sign)).collect();
        let gap = jets.iter().map(|(j, _)| j.p.distance(on_curve)).fold(0.0, f64::max);
        let (mut jump, mut bend) = (Jump { gap, ..Jump::default() }, f64::NAN);
        if let [(a, s), (b, r)] = &jets[..] {
            jump.gap = jump.gap.max(a.p.distance(b.p));
            if let Some((angle, relative, larger)) = across(a, b, s * r, diagonal) {
                (jump.angle, jump.curvature, bend) = (angle, relative, larger);
            }
        }
        (jump, bend)
    };
    let mut found: Vec<(Option<Interval>, Jump)> = Vec::new();
    let mut bends: Vec<(f64, f64)> = Vec::new();
    for (span, ruler) in plan.joints.windows(2).zip(&plan.rulers) {
        let span = [span[0], span[1]];
        match ruler {
            Some(ruler) => found.extend(ruler.intervals(&layout.classes, span).into_iter().map(|i| {
                let [a, b] = i.ends;
                let jumps = PLACES.map(|p| {
                    let t = a + (b - a) * p;
                    let (jump, bend) = at(t);
                    bends.push((t, bend));
                    jump
                });
                (Some(i), jumps.into_iter().fold(Jump::default(), Jump::max))
            })),
            None => {
                let inner = (0..SAMPLES).map(|i| (i as f64 + 0.5) / SAMPLES as f64);
                let jumps = inner.map(|x| at(span[0] + (span[1] - span[0]) * x).0);
                found.push((None, jumps.fold(Jump::default(), Jump::max)));
            }
        }
        let mut add = |t: f64, jump: Jump| {
            let mut owners = found.iter_mut().rev();
            let owner = owners.find(|(i, _)| i.is_none_or(|i| i.ends[0] <= t && t <= i.ends[1]));
            if let Some((_, worst)) = owner {
                *worst = worst.max(jump);
            }
        };
        // Where knot lines end on corners, the worst may be close to them.
        for x in [1e-6, 1e-4, 1e-3, 1e-2] {
            for x in [x, 1.0 - x] {
                let t = span[0] + (span[1] - span[0]) * x;
                add(t, at(t).0);
            }
        }
        // Relative to a curvature that is about to vanish, jumps are largest.
        for pair in bends.windows(2) {
            let [mut low, mut high] = [pair[0], pair[1]];
            for _ in 0..STEPS {
                // Not so for curvatures that are not known.
                if !(low.1 * high.1 < 0.0) {
                    break;
                }
                let t = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
                let (jump, bend) = at(t);
                add(t, jump);
                if bend * low.1 > 0.0 {
                    low = (t, bend);
                } else {
                    high = (t, bend);
                }
            }
        }
        bends.clear();
    }
    found
}

/// How the patches themselves join along an edge between two blocks; no jumps elsewhere.
pub(crate) fn natural(surface: &Surface, layout: &Layout, edge: &LayoutEdge, diagonal: f64) -> Jump {
    let [Use::Block { .. }, Use::Block { .. }] = &edge.uses[..] else { return Jump::default() };
    let at = |x: f64| {
        let mut sides = edge.uses.iter().filter_map(|one| {
            let Use::Block { block, side, ends } = one else { return None };
            let (block, s) = (&layout.blocks[*block], ends[0] + (ends[1] - ends[0]) * x);
            let at = block.on_side(*side, s);
            let (_, flipped) = layout.shells[block.pieces[0].patch];
            Some((block.jet(surface, block.piece(at.x), at.x, at.y), if flipped { -1.0 } else { 1.0 }))
        });
        let ((a, s), (b, r)) = (sides.next()?, sides.next()?);
        let (angle, curvature, _) = across(&a, &b, s * r, diagonal)?;
        Some(Jump { gap: a.p.distance(b.p), angle, curvature })
    };
    PLACES.into_iter().filter_map(at).fold(Jump::default(), Jump::max)
}

/// Angle and relative jump of curvature between two surfaces at one point, and the larger curvature of the first with its sign; `sign` is
/// −1 where their orientations disagree.
fn across(a: &Jet2, b: &Jet2, sign: f64, diagonal: f64) -> Option<(f64, f64, f64)> {
    let (m, n) = (a.normal()?, b.normal()? * sign);
    let angle = m.cross(n).length().atan2(m.dot(n));
    let x = m.any_orthonormal_vector();
    let y = m.cross(x);
    let (s, t) = (shape(a, m, x, y)?, shape(b, n, x, y)?);
    let (jump, size) = (largest(s - t), largest(s).max(largest(t)));
    let bend = largest(s) * (s.x_axis.x + s.y_axis.y).signum();
    Some((angle, jump / size.max(FLAT / diagonal), bend))
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
