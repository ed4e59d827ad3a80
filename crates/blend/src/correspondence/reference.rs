//! The reference map of an arc: cross lines of the strip in space, common to both charts.

use glam::DVec3;
use nalgebra::{DMatrix, DVector};
use suture_bernstein::{BSplineCurve, bspline};

use crate::network::sample_at;
use crate::{ArcCurve, BlendError, Network};

/// Degree of the centre curve and of the normals along it: their third derivatives enter the nodes.
const DEGREE: usize = 5;
/// Knot distance of the centre curve, in widths.
const KNOTS: f64 = 1.5;
/// Data per knot interval: the polyline is resampled, so that short edges weigh no more than long ones.
const DATA: usize = 12;
/// Weight of the penalty on third differences of the net, relative to the data: settles what few data leave open.
const PENALTY: f64 = 1e-6;
/// Most knot intervals: a bound for dense solves, far above any arc that has room for its strips.
const MOST_INTERVALS: usize = 400;

/// Value and first two derivatives by arc length.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jet {
    pub(super) value: DVec3,
    pub(super) d: DVec3,
    pub(super) dd: DVec3,
}

impl Jet {
    /// Linear combination with constant weights.
    pub(super) fn mix(self, a: f64, other: Self, b: f64) -> Self {
        Self {
            value: self.value * a + other.value * b,
            d: self.d * a + other.d * b,
            dd: self.dd * a + other.dd * b,
        }
    }
}

/// Centre curve and normals of an arc as quintic splines over its arc length.
pub(super) struct Centre {
    curve: BSplineCurve<DVec3>,
    normal: BSplineCurve<DVec3>,
}

impl Centre {
    /// Least-squares splines of the arc and of the summed normals of the two surfaces along it.
    pub(super) fn new(
        network: &Network,
        arc: &ArcCurve,
        lengths: &[f64],
        width: f64,
    ) -> Result<Self, BlendError> {
        let total = lengths.last().copied().unwrap_or(0.0);
        let spacing = total / (arc.samples.len() - 1) as f64;
        let knots = (KNOTS * width).max(2.0 * spacing);
        let intervals = ((total / knots).round() as usize).clamp(1, MOST_INTERVALS);
        let normals: Vec<DVec3> = arc
            .samples
            .iter()
            .map(|s| {
                let one = |segment: usize, at| network.surfaces[segment].jet(at).normal().unwrap_or_default();
                one(arc.left, s.left) + one(arc.right, s.right)
            })
            .collect();
        let count = DATA * intervals;
        let stations: Vec<f64> = (0..=count).map(|k| total * k as f64 / count as f64).collect();
        let positions = stations.iter().map(|&t| sample_at(arc, lengths, t).position);
        let directions = stations.iter().map(|&t| {
            let k = lengths.partition_point(|&l| l <= t).clamp(1, lengths.len() - 1);
            let step = lengths[k] - lengths[k - 1];
            let w = if step > 0.0 { ((t - lengths[k - 1]) / step).clamp(0.0, 1.0) } else { 0.0 };
            normals[k - 1].lerp(normals[k], w)
        });
        let data = positions.zip(directions).collect::<Vec<_>>();
        let [curve, normal] = splines(&stations, &data, total, intervals)?;
        Ok(Self { curve, normal })
    }

    /// Jets of the centre and of the unit vector to the left at arc length `t`, and the normal; `None` where the curve stops or runs
    /// along the normal.
    pub(super) fn at(&self, t: f64) -> Option<(Jet, Jet, Jet)> {
        let [c, c1, c2, c3] = self.curve.jet::<4>(t);
        let [n, n1, n2] = self.normal.jet::<3>(t);
        let m = n.cross(c1);
        let m1 = n1.cross(c1) + n.cross(c2);
        let m2 = n2.cross(c1) + 2.0 * n1.cross(c2) + n.cross(c3);
        let r = m.length();
        if !(r > 1e-6 * n.length() * c1.length() && r > 0.0) {
            return None;
        }
        let b = m / r;
        let r1 = b.dot(m1);
        let b1 = (m1 - r1 * b) / r;
        let r2 = b1.dot(m1) + b.dot(m2);
        let b2 = (m2 - r2 * b - 2.0 * r1 * b1) / r;
        Some((
            Jet { value: c, d: c1, dd: c2 },
            Jet { value: b, d: b1, dd: b2 },
            Jet { value: n, d: n1, dd: n2 },
        ))
    }
}

/// Two quintic splines on one knot vector by penalised least squares.
fn splines(
    stations: &[f64],
    data: &[(DVec3, DVec3)],
    total: f64,
    intervals: usize,
) -> Result<[BSplineCurve<DVec3>; 2], BlendError> {
    let wrong = |what: &str| BlendError::Inconsistent { what: format!("the centre curve of an arc: {what}") };
    let count = intervals + DEGREE;
    let knots: Vec<f64> = (0..count + DEGREE + 1)
        .map(|k| k.saturating_sub(DEGREE).min(intervals) as f64 * total / intervals as f64)
        .collect();
    bspline::check(DEGREE, count, &knots).map_err(|e| wrong(&e.to_string()))?;
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    let mut right = DMatrix::<f64>::zeros(count, 6);
    let mut basis = [[0.0; 1]; DEGREE + 1];
    // About the first point: offsets far from the origin would cost digits.
    let origin = data[0].0;
    for (&t, &(x, n)) in stations.iter().zip(data) {
        let span = bspline::span(DEGREE, &knots, t);
        bspline::jets(DEGREE, &knots, span, t, &mut basis);
        let x = x - origin;
        for i in 0..=DEGREE {
            let row = span - DEGREE + i;
            for j in 0..=DEGREE {
                matrix[(row, span - DEGREE + j)] += basis[i][0] * basis[j][0];
            }
            for (k, value) in [x.x, x.y, x.z, n.x, n.y, n.z].into_iter().enumerate() {
                right[(row, k)] += basis[i][0] * value;
            }
        }
    }
    let weight = PENALTY * DATA as f64;
    const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    for k in 0..count - 3 {
        for i in 0..4 {
            for j in 0..4 {
                matrix[(k + i, k + j)] += weight * THIRD[i] * THIRD[j];
            }
        }
    }
    let solution = matrix.cholesky().ok_or_else(|| wrong("too few data"))?.solve(&right);
    let net = |first: usize, origin: DVec3| -> Vec<DVec3> {
        let column = |k: usize| -> DVector<f64> { solution.column(first + k).into() };
        let (x, y, z) = (column(0), column(1), column(2));
        (0..count).map(|i| DVec3::new(x[i], y[i], z[i]) + origin).collect()
    };
    let curve = |net| BSplineCurve::new(DEGREE, knots.clone(), net).map_err(|e| wrong(&e.to_string()));
    Ok([curve(net(0, origin))?, curve(net(3, DVec3::ZERO))?])
}
