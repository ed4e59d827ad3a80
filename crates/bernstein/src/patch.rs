//! Tensor-product nets: Bézier patches and B-spline surfaces.

use glam::DVec2;

use crate::curve::check_finite;
use crate::{Jet2, MAX_DEGREE, NetError, Vector, bernstein, bspline};

/// A tensor-product Bézier patch on `[0, 1]²`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BezierPatch<T> {
    degree: [usize; 2],
    net: Vec<T>,
}

impl<T: Vector> BezierPatch<T> {
    /// A patch of `degree` `[m, n]` from its `(m + 1)(n + 1)` control points, second index fastest.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::NotFinite`].
    pub fn new(degree: [usize; 2], net: Vec<T>) -> Result<Self, NetError> {
        if let Some(&degree) = degree.iter().find(|&&d| d > MAX_DEGREE) {
            return Err(NetError::Degree { degree });
        }
        let needed = (degree[0] + 1) * (degree[1] + 1);
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        check_finite(&net)?;
        Ok(Self { degree, net })
    }

    /// Degrees in `u` and `v`.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// The control points, second index fastest.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Value and partials to second order.
    pub fn jet(&self, at: DVec2) -> Jet2<T> {
        let (mut bu, mut bv) = ([[0.0; 3]; MAX_DEGREE + 1], [[0.0; 3]; MAX_DEGREE + 1]);
        bernstein::jets(self.degree[0], at.x, &mut bu);
        bernstein::jets(self.degree[1], at.y, &mut bv);
        combine(&self.net, self.degree[1] + 1, &bu[..=self.degree[0]], &bv[..=self.degree[1]])
    }
}

/// A tensor-product B-spline surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BSplineSurface<T> {
    degree: [usize; 2],
    knots: [Vec<f64>; 2],
    net: Vec<T>,
}

impl<T: Vector> BSplineSurface<T> {
    /// A surface of `degree` over two knot vectors; `net` holds `count_u × count_v` control points, second index fastest,
    /// with `count = knots.len() − degree − 1` in either direction.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::Knots`], [`NetError::NotFinite`].
    pub fn new(degree: [usize; 2], knots: [Vec<f64>; 2], net: Vec<T>) -> Result<Self, NetError> {
        let count = |d: usize| knots[d].len().saturating_sub(degree[d] + 1);
        for d in 0..2 {
            bspline::check(degree[d], count(d), &knots[d])?;
        }
        let needed = count(0) * count(1);
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        check_finite(&net)?;
        Ok(Self { degree, knots, net })
    }

    /// Degrees in `u` and `v`.
    pub fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// Knot vectors in `u` and `v`.
    pub fn knots(&self) -> [&[f64]; 2] {
        [&self.knots[0], &self.knots[1]]
    }

    /// Number of control points in `u` and `v`.
    pub fn count(&self) -> [usize; 2] {
        [0, 1].map(|d| self.knots[d].len() - self.degree[d] - 1)
    }

    /// The control points, second index fastest.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Lower and upper corner of the parameter rectangle.
    pub fn domain(&self) -> [DVec2; 2] {
        let count = self.count();
        let end = |d: usize, i: usize| self.knots[d][i];
        [
            DVec2::new(end(0, self.degree[0]), end(1, self.degree[1])),
            DVec2::new(end(0, count[0]), end(1, count[1])),
        ]
    }

    /// Value and partials to second order.
    pub fn jet(&self, at: DVec2) -> Jet2<T> {
        let (mut bu, mut bv) = ([[0.0; 3]; MAX_DEGREE + 1], [[0.0; 3]; MAX_DEGREE + 1]);
        let [p, q] = self.degree;
        let i = bspline::span(p, &self.knots[0], at.x);
        let j = bspline::span(q, &self.knots[1], at.y);
        bspline::jets(p, &self.knots[0], i, at.x, &mut bu);
        bspline::jets(q, &self.knots[1], j, at.y, &mut bv);
        let columns = self.count()[1];
        combine(&self.net[(i - p) * columns + j - q..], columns, &bu[..=p], &bv[..=q])
    }
}

/// Sums the net (rows `columns` apart) against both bases.
fn combine<T: Vector>(net: &[T], columns: usize, bu: &[[f64; 3]], bv: &[[f64; 3]]) -> Jet2<T> {
    let mut jet = Jet2::default();
    for (i, u) in bu.iter().enumerate() {
        let row = &net[i * columns..i * columns + bv.len()];
        let (mut r, mut rv, mut rvv) = (T::default(), T::default(), T::default());
        for (&p, v) in row.iter().zip(bv) {
            r = r + p * v[0];
            rv = rv + p * v[1];
            rvv = rvv + p * v[2];
        }
        jet.p = jet.p + r * u[0];
        jet.du = jet.du + r * u[1];
        jet.duu = jet.duu + r * u[2];
        jet.dv = jet.dv + rv * u[0];
        jet.duv = jet.duv + rv * u[1];
        jet.dvv = jet.dvv + rvv * u[0];
    }
    jet
}
