//! Where a line meets a chart's surface: the correspondence itself.

use glam::{DMat2, DVec2, DVec3};
use suture_bernstein::BSplineSurface;

/// Steps of Newton's method: it needs 3 to 6 from a first-order guess.
const STEPS: usize = 20;
/// Longest step and largest distance from the start, in widths.
const LONGEST_STEP: f64 = 0.375;
const FARTHEST: f64 = 1.5;
/// Residual, in widths, from which the next quadratic step ends in rounding.
const CLOSE: f64 = 1e-7;
/// Steps of the foot point that replaces a missed line.
const FOOT_STEPS: usize = 12;

/// A line `y + λ n` with two directions across it.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) point: DVec3,
    across: [DVec3; 2],
}

impl Line {
    pub(super) fn new(point: DVec3, direction: DVec3) -> Self {
        let n = direction.normalize_or(DVec3::Z);
        let p = n.any_orthonormal_vector();
        Self { point, across: [p, n.cross(p)] }
    }
}

/// The parameter of the point where `line` meets `surface` near the parameter `start`; `None` when Newton's method does not converge,
/// strays, or arrives where the surface turns away from the line.
pub(super) fn meet(surface: &BSplineSurface<DVec3>, line: &Line, start: DVec2, width: f64) -> Option<DVec2> {
    let [p, q] = line.across;
    let mut at = start;
    let mut origin = None;
    for _ in 0..STEPS {
        let jet = surface.jet(at);
        let gap = line.point - jet.p;
        let origin = *origin.get_or_insert(jet.p);
        let matrix = DMat2::from_cols(
            DVec2::new(p.dot(jet.du), q.dot(jet.du)),
            DVec2::new(p.dot(jet.dv), q.dot(jet.dv)),
        );
        let determinant = matrix.determinant();
        if !(determinant > 1e-3 * jet.du.length() * jet.dv.length())
            || jet.p.distance(origin) > FARTHEST * width
        {
            return None;
        }
        let residual = DVec2::new(p.dot(gap), q.dot(gap));
        let step = matrix.inverse() * residual;
        let length = (jet.du * step.x + jet.dv * step.y).length();
        at += step * (LONGEST_STEP * width / length).min(1.0);
        if residual.length() <= CLOSE * width {
            return Some(at);
        }
    }
    None
}

/// The parameter of the surface point nearest to `x` near `start`, by damped Gauss–Newton steps: what stands in for a missed line.
pub(super) fn nearest(surface: &BSplineSurface<DVec3>, x: DVec3, start: DVec2) -> DVec2 {
    let mut at = start;
    let mut jet = surface.jet(at);
    for _ in 0..FOOT_STEPS {
        let gap = x - jet.p;
        let (e, f, g) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        let determinant = e * g - f * f;
        if !(determinant > 1e-9 * e * g) {
            break;
        }
        let (a, b) = (gap.dot(jet.du), gap.dot(jet.dv));
        let step = DVec2::new(g * a - f * b, e * b - f * a) / determinant;
        // Halving a step that does not approach ends at the point itself.
        let closer = (0..8).map(|k| at + step * 0.5f64.powi(k)).find_map(|next| {
            let there = surface.jet(next);
            (there.p.distance_squared(x) < jet.p.distance_squared(x)).then_some((next, there))
        });
        let Some(next) = closer else { break };
        (at, jet) = next;
    }
    at
}
