//! Constituents and border curves prepared for many evaluations over one gap.
//!
//! A fill asks for a constituent's jet at `(u, v)` and for its derivatives across the gap at `(0, v)` and `(1, v)`. On a B-spline whose parameter
//! lines are those of the gap all three share the basis in `v`, and the two side curves have nets of their own. Basis functions are kept as
//! Taylor series at both ends of every knot interval, evaluated from the nearer one: no quotient is left to compute, and at knots they are
//! those of Cox and de Boor's recursion to the bit.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_bernstein::{BSplineSurface, BezierCurve, Jet2, bspline};

use crate::constituent::Map;
use crate::curve::CurveData;

/// A constituent prepared for many evaluations over one gap.
pub trait Prepared: Send + Sync + std::fmt::Debug {
    /// The jet at `at`, and value, first and second derivative in `v` at `(0, at.y)` and `(1, at.y)`.
    fn jet_and_sides(&self, at: DVec2) -> (Jet2, [[DVec3; 3]; 2]);
}

/// A B-spline of degrees up to 5 after `maps`, the first one applied first; `None` unless they all map parameter lines to parameter lines.
pub(crate) fn prepare_spline(surface: &BSplineSurface<DVec3>, maps: &[Map]) -> Option<Arc<dyn Prepared>> {
    let lanes = lanes(maps)?;
    match surface.degree().into_iter().max()? {
        ..=3 => Some(Arc::new(PreparedSpline::<4>::new(surface, lanes))),
        4 | 5 => Some(Arc::new(PreparedSpline::<6>::new(surface, lanes))),
        _ => None,
    }
}

/// What becomes of one parameter of the gap: `x ↦ origin + scale x`, step by step, then the parameter `axis` of the surface.
#[derive(Clone, Debug, Default)]
struct Lane {
    axis: usize,
    steps: Vec<(f64, f64)>,
}

fn lanes(maps: &[Map]) -> Option<[Lane; 2]> {
    let mut lanes = [Lane { axis: 0, steps: Vec::new() }, Lane { axis: 1, steps: Vec::new() }];
    for map in maps {
        let Map::Affine { origin, u, v } = *map else { return None };
        let straight = u.y == 0.0 && v.x == 0.0;
        let images = if straight { [(0, u.x), (1, v.y)] } else { [(1, u.y), (0, v.x)] };
        let along = straight || (u.x == 0.0 && v.y == 0.0);
        if !along || images.iter().any(|(_, scale)| *scale == 0.0 || !scale.is_finite()) {
            return None;
        }
        for lane in &mut lanes {
            let (axis, scale) = images[lane.axis];
            lane.axis = axis;
            lane.steps.push((origin[axis], scale));
        }
    }
    Some(lanes)
}

/// A point with a fourth number that is zero: two registers of two numbers.
type Quad = [f64; 4];

fn quad(p: DVec3) -> Quad {
    [p.x, p.y, p.z, 0.0]
}

#[inline(always)]
fn add(sum: &mut Quad, p: &Quad, w: f64) {
    for k in 0..4 {
        sum[k] += p[k] * w;
    }
}

#[inline(always)]
fn point(q: Quad) -> DVec3 {
    DVec3::new(q[0], q[1], q[2])
}

/// A B-spline over a gap; its degrees are less than `N`, and functions of a lower degree are followed by zeros.
#[derive(Debug)]
struct PreparedSpline<const N: usize> {
    axes: [Axis<N>; 2],
    /// Control points, the index along `v` fastest, with rows and columns of zeros behind the last ones.
    net: Vec<Quad>,
    columns: usize,
    /// The nets of the curves at `u = 0` and `u = 1`.
    sides: [Vec<Quad>; 2],
}

impl<const N: usize> PreparedSpline<N> {
    fn new(surface: &BSplineSurface<DVec3>, [first, second]: [Lane; 2]) -> Self {
        let turned = first.axis == 1;
        let axis =
            |lane: Lane| Axis::new(surface.degree()[lane.axis], surface.knots()[lane.axis], lane.steps);
        let axes = [axis(first), axis(second)];
        let [rows, columns] = surface.count();
        let (across, along) = if turned { (columns, rows) } else { (rows, columns) };
        let width = along + N;
        let mut net = vec![[0.0; 4]; (across + N) * width];
        for i in 0..across {
            for j in 0..along {
                let from = if turned { j * columns + i } else { i * columns + j };
                net[i * width + j] = quad(surface.net()[from]);
            }
        }
        let sides = [0.0, 1.0].map(|u| {
            let (start, basis) = axes[0].basis(u);
            let mut side = vec![[0.0; 4]; width];
            for (i, w) in basis[0].iter().enumerate() {
                let row = &net[(start + i) * width..][..width];
                side.iter_mut().zip(row).for_each(|(s, p)| add(s, p, *w));
            }
            side
        });
        Self { axes, net, columns: width, sides }
    }
}

/// Sums `N` control points against the basis and its derivatives.
#[inline(always)]
fn row<const N: usize>(net: &[Quad], basis: &[[f64; N]; 3]) -> [Quad; 3] {
    let mut sum = [[0.0; 4]; 3];
    for (j, p) in net[..N].iter().enumerate() {
        for d in 0..3 {
            add(&mut sum[d], p, basis[d][j]);
        }
    }
    sum
}

impl<const N: usize> Prepared for PreparedSpline<N> {
    fn jet_and_sides(&self, at: DVec2) -> (Jet2, [[DVec3; 3]; 2]) {
        let (i, bu) = self.axes[0].basis(at.x);
        let (j, bv) = self.axes[1].basis(at.y);
        let mut sum = [[0.0; 4]; 6];
        for k in 0..N {
            let [p, d, dd] = row(&self.net[(i + k) * self.columns + j..], &bv);
            add(&mut sum[0], &p, bu[0][k]);
            add(&mut sum[1], &p, bu[1][k]);
            add(&mut sum[2], &d, bu[0][k]);
            add(&mut sum[3], &p, bu[2][k]);
            add(&mut sum[4], &d, bu[1][k]);
            add(&mut sum[5], &dd, bu[0][k]);
        }
        let [p, du, dv, duu, duv, dvv] = sum.map(point);
        let sides = [0, 1].map(|s| row(&self.sides[s][j..], &bv).map(point));
        (Jet2 { p, du, dv, duu, duv, dvv }, sides)
    }
}

/// The basis in one parameter of the gap.
#[derive(Debug)]
struct Axis<const N: usize> {
    steps: Vec<(f64, f64)>,
    /// Product of the scales.
    scale: f64,
    /// The ends of the knot intervals, strictly rising.
    breaks: Vec<f64>,
    /// Number of intervals over their length.
    density: f64,
    pieces: Vec<Piece<N>>,
}

#[derive(Debug)]
struct Piece<const N: usize> {
    /// Number of the first basis function.
    start: usize,
    middle: f64,
    /// At the lower and the upper end: the point, and the Taylor coefficients of all functions there, by power.
    ends: [(f64, [[f64; N]; N]); 2],
}

impl<const N: usize> Axis<N> {
    fn new(degree: usize, knots: &[f64], steps: Vec<(f64, f64)>) -> Self {
        let mut breaks = knots[degree..knots.len() - degree].to_vec();
        breaks.dedup();
        let pieces: Vec<Piece<N>> = breaks
            .windows(2)
            .map(|w| {
                let span = bspline::span(degree, knots, w[0]);
                let ends = [w[0], w[1]].map(|t| {
                    let mut jets = [[0.0; N]; N];
                    bspline::jets(degree, knots, span, t, &mut jets);
                    let mut series = [[0.0; N]; N];
                    let mut factorial = 1.0;
                    for k in 0..N {
                        (0..N).for_each(|i| series[k][i] = jets[i][k] / factorial);
                        factorial *= (k + 1) as f64;
                    }
                    (t, series)
                });
                Piece { start: span - degree, middle: w[0] + 0.5 * (w[1] - w[0]), ends }
            })
            .collect();
        let density = pieces.len() as f64 / (breaks[pieces.len()] - breaks[0]);
        let scale = steps.iter().map(|s| s.1).product();
        Self { steps, scale, breaks, density, pieces }
    }

    /// Number of the first basis function, and the functions with two derivatives at parameter `t` of the gap.
    #[inline(always)]
    fn basis(&self, t: f64) -> (usize, [[f64; N]; 3]) {
        let x = self.steps.iter().fold(t, |x, (origin, scale)| origin + scale * x);
        let piece = &self.pieces[self.piece(x)];
        let (at, series) = &piece.ends[usize::from(x > piece.middle)];
        let h = x - at;
        // Horner's rule with its derivatives, all functions side by side.
        let mut b = [series[N - 1], [0.0; N], [0.0; N]];
        for c in series[..N - 1].iter().rev() {
            for i in 0..N {
                b[2][i] = b[2][i] * h + b[1][i];
                b[1][i] = b[1][i] * h + b[0][i];
                b[0][i] = b[0][i] * h + c[i];
            }
        }
        let (first, second) = (self.scale, 2.0 * self.scale * self.scale);
        for i in 0..N {
            b[1][i] *= first;
            b[2][i] *= second;
        }
        (piece.start, b)
    }

    /// The interval of `x`; beyond the domain the first or last one, NaN in the first.
    #[inline(always)]
    fn piece(&self, x: f64) -> usize {
        let last = self.pieces.len() - 1;
        // On uniform knots this guess fails only within rounding of a knot. The conversion saturates, NaN becomes 0.
        let guess = (((x - self.breaks[0]) * self.density) as usize).min(last);
        if (self.breaks[guess] <= x || guess == 0) && (x < self.breaks[guess + 1] || guess == last) {
            return guess;
        }
        self.breaks[1..=last].partition_point(|b| *b <= x)
    }
}

/// Bézier curves up to this degree are prepared.
const DEGREE: usize = 7;

/// A Bézier curve, or a sum of some, as Taylor series at both ends.
#[derive(Debug)]
pub(crate) struct EndSeries {
    ends: [[Quad; DEGREE + 1]; 2],
    degree: usize,
}

impl EndSeries {
    /// `None` for other curves and for higher degrees.
    pub(crate) fn new(curve: &CurveData) -> Option<Self> {
        match curve {
            CurveData::Bezier { net } => {
                let curve = BezierCurve::new(net.clone()).ok().filter(|c| c.degree() <= DEGREE)?;
                let ends = [0.0, 1.0].map(|t| {
                    let jets: [DVec3; DEGREE + 1] = curve.jet(t);
                    let mut factorial = 1.0;
                    std::array::from_fn(|k| {
                        factorial *= k.max(1) as f64;
                        quad(jets[k] / factorial)
                    })
                });
                Some(Self { ends, degree: curve.degree() })
            }
            CurveData::Sum { of } => {
                let (mut a, b) = (Self::new(&of[0])?, Self::new(&of[1])?);
                for (x, y) in a.ends.as_flattened_mut().iter_mut().zip(b.ends.as_flattened()) {
                    add(x, y, 1.0);
                }
                a.degree = a.degree.max(b.degree);
                Some(a)
            }
            _ => None,
        }
    }

    /// Value, first and second derivative at `t`.
    #[inline]
    pub(crate) fn jet(&self, t: f64) -> [DVec3; 3] {
        let (series, h) = if t > 0.5 { (&self.ends[1], t - 1.0) } else { (&self.ends[0], t) };
        let mut b = [series[self.degree], [0.0; 4], [0.0; 4]];
        for c in series[..self.degree].iter().rev() {
            for i in 0..4 {
                b[2][i] = b[2][i] * h + b[1][i];
                b[1][i] = b[1][i] * h + b[0][i];
                b[0][i] = b[0][i] * h + c[i];
            }
        }
        [point(b[0]), point(b[1]), point(b[2]) * 2.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constituent::{Constituent, Mapped, Spline};
    use crate::curve::BorderCurve;

    fn near(a: DVec3, b: DVec3, scale: f64) {
        assert!(a.distance(b) <= 1e-14 * scale, "{a} ≠ {b} by {:e}", a.distance(b) / scale);
    }

    /// A surface of degree `p`, `q` over uneven knots, one of them repeated.
    fn surface(p: usize, q: usize) -> Arc<BSplineSurface<DVec3>> {
        let knots = |d: usize| {
            let inner = [0.3, 0.5, 0.5, 1.1];
            let mut k = vec![-0.2; d + 1];
            k.extend(&inner[..if d == 1 { 2 } else { 4 }]);
            k.extend(vec![1.4; d + 1]);
            k
        };
        let (ku, kv) = (knots(p), knots(q));
        let count = (ku.len() - p - 1) * (kv.len() - q - 1);
        let net = (0..count).map(|i| {
            let x = i as f64;
            DVec3::new((x * 0.7).sin() + x / 9.0, (x * 1.3).cos(), (x * 2.9).sin())
        });
        Arc::new(BSplineSurface::new([p, q], [ku, kv], net.collect()).unwrap())
    }

    #[test]
    fn prepared_splines_are_the_splines() {
        let straight = Map::Affine { origin: DVec2::new(-0.1, 1.4), u: DVec2::X * 1.3, v: DVec2::Y * -0.9 };
        let turned = Map::Affine { origin: DVec2::new(0.4, 1.2), u: DVec2::Y * -1.1, v: DVec2::X * 0.8 };
        let back = Map::Affine { origin: DVec2::ONE, u: -DVec2::X, v: -DVec2::Y };
        for (p, q) in [(1, 1), (2, 3), (3, 3), (3, 1), (4, 2), (5, 5)] {
            for maps in [vec![], vec![straight], vec![turned], vec![back, straight], vec![back, turned]] {
                let spline: Arc<dyn Constituent> = Arc::new(Spline(surface(p, q)));
                // `maps[0]` is applied first: the outermost.
                let whole = maps.iter().rev().fold(spline, |inner, &map| Arc::new(Mapped { inner, map }));
                let fast = whole.prepare(&[]).unwrap();
                for i in 0..=30 {
                    for j in -4..=34 {
                        let at = DVec2::new(f64::from(i), f64::from(j)) / 30.0;
                        let (jet, sides) = fast.jet_and_sides(at);
                        let plain = whole.jet(at);
                        // Pieces are continued beyond the domain, where their terms grow.
                        let p = maps.iter().fold(at, |p, map| map.jet(p).p);
                        let inside = p.min_element() >= -0.2 && p.max_element() <= 1.4;
                        let scale = if inside { 1.0 } else { 1e3 };
                        near(jet.p, plain.p, 40.0 * scale);
                        near(jet.du, plain.du, 1e3 * scale);
                        near(jet.dv, plain.dv, 1e3 * scale);
                        near(jet.duu, plain.duu, 4e4 * scale);
                        near(jet.duv, plain.duv, 4e4 * scale);
                        near(jet.dvv, plain.dvv, 4e4 * scale);
                        for (side, u) in sides.iter().zip([0.0, 1.0]) {
                            let plain = whole.jet(DVec2::new(u, at.y));
                            near(side[0], plain.p, 40.0 * scale);
                            near(side[1], plain.dv, 1e3 * scale);
                            near(side[2], plain.dvv, 4e4 * scale);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_does_not_keep_parameter_lines_is_not_prepared() {
        let spline: Arc<dyn Constituent> = Arc::new(Spline(surface(3, 3)));
        let aslant = Map::Affine { origin: DVec2::ZERO, u: DVec2::X, v: DVec2::ONE };
        assert!(spline.prepare(&[aslant]).is_none());
        let flat = Map::Affine { origin: DVec2::ZERO, u: DVec2::X, v: DVec2::ZERO };
        assert!(spline.prepare(&[flat]).is_none());
        assert!((Spline(surface(6, 2))).prepare(&[]).is_none());
        let fast = spline.prepare(&[]).unwrap();
        assert!(!fast.jet_and_sides(DVec2::NAN).0.finite());
    }

    #[test]
    fn end_series_are_the_curves() {
        let net = |n: usize| (0..=n).map(|i| DVec3::new(i as f64, (i * i % 5) as f64, 1.0)).collect();
        for n in 0..=7 {
            let one = CurveData::Bezier { net: net(n) };
            let sum = CurveData::Sum { of: Box::new([one.clone(), CurveData::Bezier { net: net(7 - n) }]) };
            for data in [one, sum] {
                let (series, curve) = (EndSeries::new(&data).unwrap(), data.build().unwrap());
                for i in 0..=40 {
                    let t = f64::from(i) / 40.0;
                    let (a, b) = (series.jet(t), BorderCurve::jet(curve.as_ref(), t));
                    let ends = i % 40 == 0;
                    for (k, scale) in [10.0, 100.0, 1000.0].into_iter().enumerate() {
                        near(a[k], b[k], if ends && k == 0 { 0.0 } else { scale });
                    }
                }
            }
        }
        assert!(EndSeries::new(&CurveData::Bezier { net: net(8) }).is_none());
    }
}
