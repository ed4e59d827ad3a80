//! Border curves.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_bernstein::{BSplineCurve, BezierCurve, NetError};

use crate::real::Real;
use crate::spline;
use crate::taylor::{Enclosure, Expansion};

/// A curve over `[0, 1]` that bounds a fill: one method to write.
pub trait BorderCurve: Send + Sync + std::fmt::Debug {
    /// Position, first and second derivative at `t`. Exact derivatives, no differences.
    fn jet(&self, t: f64) -> [DVec3; 3];

    /// The coordinates at an expanded parameter; `None` when only [`jet`](Self::jet) is known, which is enough up to C².
    fn expand(&self, _t: &Expansion) -> Option<[Expansion; 3]> {
        None
    }

    /// As [`expand`](Self::expand), enclosed in intervals; `None` leaves the corner certificate without proof.
    fn enclose(&self, _t: &Enclosure) -> Option<[Enclosure; 3]> {
        None
    }

    /// The curve as data; `None` when it cannot be saved.
    fn data(&self) -> Option<CurveData> {
        None
    }
}

/// A border curve as data, in scenes and saved surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
#[non_exhaustive]
pub enum CurveData {
    /// A Bézier curve.
    Bezier {
        /// Its control points.
        net: Vec<DVec3>,
    },
    /// A B-spline curve, its domain scaled to `[0, 1]`.
    BSpline {
        /// Polynomial degree.
        degree: usize,
        /// Knot vector.
        knots: Vec<f64>,
        /// Control points.
        net: Vec<DVec3>,
    },
    /// An arc of an ellipse, `center + cos(a) x + sin(a) y` for `a` from `from` to `to` (radians).
    Arc {
        /// Centre.
        center: DVec3,
        /// Half axis of angle 0.
        x: DVec3,
        /// Half axis of angle π/2.
        y: DVec3,
        /// First angle.
        from: f64,
        /// Last angle.
        to: f64,
    },
    /// Sum of two curves.
    Sum {
        /// The summands.
        of: Box<[CurveData; 2]>,
    },
}

impl CurveData {
    /// The curve.
    ///
    /// # Errors
    /// [`NetError`] of a net that is not one.
    pub fn build(&self) -> Result<Arc<dyn BorderCurve>, NetError> {
        Ok(match self {
            Self::Bezier { net } => Arc::new(BezierCurve::new(net.clone())?),
            Self::BSpline { degree, knots, net } => {
                if *degree > suture_bernstein::MAX_DEGREE {
                    return Err(NetError::Degree { degree: *degree });
                }
                Arc::new(SplineCurve::new(BSplineCurve::new(*degree, knots.clone(), net.clone())?))
            }
            Self::Arc { center, x, y, from, to } => {
                let given = [*center, *x, *y, DVec3::new(*from, *to, 0.0)];
                if let Some(index) = given.iter().position(|p| !p.is_finite()) {
                    return Err(NetError::NotFinite { index });
                }
                Arc::new(EllipseArc { center: *center, x: *x, y: *y, from: *from, to: *to })
            }
            Self::Sum { of } => Arc::new(SumCurve(of[0].build()?, of[1].build()?)),
        })
    }
}

impl BorderCurve for BezierCurve<DVec3> {
    fn jet(&self, t: f64) -> [DVec3; 3] {
        BezierCurve::jet(self, t)
    }

    fn expand(&self, t: &Expansion) -> Option<[Expansion; 3]> {
        Some(spline::bezier_curve(self.net(), *t))
    }

    fn enclose(&self, t: &Enclosure) -> Option<[Enclosure; 3]> {
        Some(spline::bezier_curve(self.net(), *t))
    }

    fn data(&self) -> Option<CurveData> {
        Some(CurveData::Bezier { net: self.net().to_vec() })
    }
}

/// A B-spline curve over a part of its domain, scaled to `[0, 1]`.
#[derive(Clone, Debug)]
pub struct SplineCurve {
    curve: BSplineCurve<DVec3>,
    from: f64,
    scale: f64,
}

impl SplineCurve {
    /// The whole of `curve`.
    pub fn new(curve: BSplineCurve<DVec3>) -> Self {
        let [a, b] = curve.domain();
        Self { curve, from: a, scale: b - a }
    }
}

impl BorderCurve for SplineCurve {
    #[inline]
    fn jet(&self, t: f64) -> [DVec3; 3] {
        let [p, d, dd] = self.curve.jet(self.from + self.scale * t);
        [p, d * self.scale, dd * (self.scale * self.scale)]
    }

    fn expand(&self, t: &Expansion) -> Option<[Expansion; 3]> {
        Some(spline::spline_curve(&self.curve, t.scale(self.scale) + Expansion::of(self.from)))
    }

    fn enclose(&self, t: &Enclosure) -> Option<[Enclosure; 3]> {
        Some(spline::spline_curve(&self.curve, t.scale(Real::of(self.scale)) + Enclosure::of(self.from)))
    }

    fn data(&self) -> Option<CurveData> {
        let [a, b] = self.curve.domain();
        let c = &self.curve;
        (self.from == a && self.scale == b - a).then(|| CurveData::BSpline {
            degree: c.degree(),
            knots: c.knots().to_vec(),
            net: c.net().to_vec(),
        })
    }
}

#[derive(Clone, Debug)]
struct EllipseArc {
    center: DVec3,
    x: DVec3,
    y: DVec3,
    from: f64,
    to: f64,
}

impl EllipseArc {
    fn at<R: Real>(&self, t: R) -> [R; 3] {
        let (s, c) = (R::of(self.from) * (R::of(1.0) - t) + R::of(self.to) * t).sin_cos();
        [0, 1, 2].map(|i| R::of(self.center[i]) + R::of(self.x[i]) * c + R::of(self.y[i]) * s)
    }
}

impl BorderCurve for EllipseArc {
    fn jet(&self, t: f64) -> [DVec3; 3] {
        curve_jet(&self.at(Expansion::v(t)))
    }

    fn expand(&self, t: &Expansion) -> Option<[Expansion; 3]> {
        Some(self.at(*t))
    }

    fn enclose(&self, t: &Enclosure) -> Option<[Enclosure; 3]> {
        Some(self.at(*t))
    }

    fn data(&self) -> Option<CurveData> {
        let Self { center, x, y, from, to } = *self;
        Some(CurveData::Arc { center, x, y, from, to })
    }
}

pub(crate) fn curve_jet(p: &[Expansion; 3]) -> [DVec3; 3] {
    [0, 1, 2].map(|j| crate::taylor::partial(p, 0, j))
}

/// Sum of two curves: a given one and its repair.
#[derive(Clone, Debug)]
pub(crate) struct SumCurve(pub(crate) Arc<dyn BorderCurve>, pub(crate) Arc<dyn BorderCurve>);

impl BorderCurve for SumCurve {
    fn jet(&self, t: f64) -> [DVec3; 3] {
        let (a, b) = (self.0.jet(t), self.1.jet(t));
        [0, 1, 2].map(|i| a[i] + b[i])
    }

    fn expand(&self, t: &Expansion) -> Option<[Expansion; 3]> {
        let (a, b) = (self.0.expand(t)?, self.1.expand(t)?);
        Some([0, 1, 2].map(|i| a[i] + b[i]))
    }

    fn enclose(&self, t: &Enclosure) -> Option<[Enclosure; 3]> {
        let (a, b) = (self.0.enclose(t)?, self.1.enclose(t)?);
        Some([0, 1, 2].map(|i| a[i] + b[i]))
    }

    fn data(&self) -> Option<CurveData> {
        Some(CurveData::Sum { of: Box::new([self.0.data()?, self.1.data()?]) })
    }
}

/// A curve from a function that returns position, first and second derivative.
pub fn curve_fn(f: impl Fn(f64) -> [DVec3; 3] + Send + Sync + 'static) -> Arc<dyn BorderCurve> {
    Arc::new(FnCurve(f))
}

struct FnCurve<F>(F);

impl<F> std::fmt::Debug for FnCurve<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FnCurve")
    }
}

impl<F: Fn(f64) -> [DVec3; 3] + Send + Sync> BorderCurve for FnCurve<F> {
    fn jet(&self, t: f64) -> [DVec3; 3] {
        (self.0)(t)
    }
}

/// The Bézier curve of degree `2k + 1` with the given value and derivatives at its ends, `k + 1 ≤ 4` of them each.
///
/// # Errors
/// [`NetError::NotFinite`]; [`NetError::Count`] when the ends have no or different numbers of derivatives.
pub fn hermite(start: &[DVec3], end: &[DVec3]) -> Result<BezierCurve<DVec3>, NetError> {
    let k = start.len();
    if k == 0 || end.len() != k || k > 4 {
        return Err(NetError::Count { given: end.len(), needed: k.clamp(1, 4) });
    }
    let n = 2 * k - 1;
    // b_i = Σ_j C(i, j) (n − j)!/n! d_j, and the same from the other end with odd derivatives reversed.
    let net = |d: &[DVec3], sign: f64| -> Vec<DVec3> {
        (0..k)
            .map(|i| {
                let (mut binomial, mut falling, mut odd) = (1.0, 1.0, 1.0);
                let mut sum = DVec3::ZERO;
                for j in 0..=i {
                    sum += d[j] * (binomial / falling * odd);
                    binomial *= (i - j) as f64 / (j + 1) as f64;
                    falling *= (n - j) as f64;
                    odd *= sign;
                }
                sum
            })
            .collect()
    };
    let mut points = net(start, 1.0);
    points.extend(net(end, -1.0).into_iter().rev());
    BezierCurve::new(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hermite_curves_have_the_jets_asked_for() {
        let d = [DVec3::X, DVec3::new(1.0, -2.0, 3.0), DVec3::new(0.5, 4.0, -1.0), DVec3::new(7.0, 1.0, 2.0)];
        let e = [DVec3::Y, DVec3::new(2.0, 1.0, -3.0), DVec3::new(-0.5, 2.0, 1.0), DVec3::new(3.0, 5.0, 1.0)];
        for k in 1..=4 {
            let c = hermite(&d[..k], &e[..k]).unwrap();
            assert_eq!(c.degree(), 2 * k - 1);
            let (a, b): ([DVec3; 4], [DVec3; 4]) = (c.jet(0.0), c.jet(1.0));
            for j in 0..k {
                assert!(a[j].distance(d[j]) < 1e-12 && b[j].distance(e[j]) < 1e-12, "{k} {j}");
            }
        }
        assert!(hermite(&d[..2], &e[..3]).is_err());
    }

    #[test]
    fn expansions_agree_with_jets() {
        let net = vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::new(3.0, 1.0, 2.0)];
        let data = [
            CurveData::Bezier { net: net.clone() },
            CurveData::BSpline { degree: 2, knots: vec![0.0, 0.0, 0.0, 0.4, 2.0, 2.0, 2.0], net },
            CurveData::Arc { center: DVec3::ONE, x: DVec3::X, y: DVec3::Z * 2.0, from: 0.3, to: 1.9 },
        ];
        for data in data {
            let curve = data.build().unwrap();
            assert_eq!(curve.data(), Some(data));
            for t in [0.0, 0.1, 0.7, 1.0] {
                let (a, b) = (curve.jet(t), curve_jet(&curve.expand(&Expansion::v(t)).unwrap()));
                (0..3).for_each(|i| assert!(a[i].distance(b[i]) < 1e-12, "{t} {i}"));
                let c = curve.enclose(&Enclosure::v(t)).unwrap();
                for x in 0..3 {
                    for j in 0..3 {
                        let i = c[x].partial(0, j);
                        assert!(i.lo <= a[j][x] + 1e-13 && a[j][x] <= i.hi + 1e-13 && i.hi - i.lo < 1e-11);
                    }
                }
            }
        }
    }
}
