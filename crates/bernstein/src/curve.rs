//! Curves: Bézier and B-spline.

use crate::{MAX_DEGREE, NetError, Vector, bernstein, bspline};

/// A Bézier curve on `[0, 1]`; its degree is the number of its control points less one.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BezierCurve<T> {
    net: Vec<T>,
}

impl<T: Vector> BezierCurve<T> {
    /// A curve from its control points.
    ///
    /// # Errors
    /// [`NetError::Count`] without control points, [`NetError::Degree`] beyond [`MAX_DEGREE`], [`NetError::NotFinite`].
    pub fn new(net: Vec<T>) -> Result<Self, NetError> {
        if net.is_empty() {
            return Err(NetError::Count { given: 0, needed: 1 });
        }
        if net.len() > MAX_DEGREE + 1 {
            return Err(NetError::Degree { degree: net.len() - 1 });
        }
        check_finite(&net)?;
        Ok(Self { net })
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.net.len() - 1
    }

    /// The control points.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Value and derivatives to order `D − 1` at `t`.
    pub fn jet<const D: usize>(&self, t: f64) -> [T; D] {
        let mut basis = [[0.0; D]; MAX_DEGREE + 1];
        bernstein::jets(self.degree(), t, &mut basis);
        combine(&self.net, &basis)
    }
}

/// A B-spline curve.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BSplineCurve<T> {
    degree: usize,
    knots: Vec<f64>,
    net: Vec<T>,
}

impl<T: Vector> BSplineCurve<T> {
    /// A curve of `degree` over `knots` (`net.len() + degree + 1` of them).
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::Knots`], [`NetError::NotFinite`].
    pub fn new(degree: usize, knots: Vec<f64>, net: Vec<T>) -> Result<Self, NetError> {
        bspline::check(degree, net.len(), &knots)?;
        check_finite(&net)?;
        Ok(Self { degree, knots, net })
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knot vector.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The control points.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.net.len()]]
    }

    /// Value and derivatives to order `D − 1` at `t`.
    pub fn jet<const D: usize>(&self, t: f64) -> [T; D] {
        let mut basis = [[0.0; D]; MAX_DEGREE + 1];
        let span = bspline::span(self.degree, &self.knots, t);
        bspline::jets(self.degree, &self.knots, span, t, &mut basis);
        combine(&self.net[span - self.degree..=span], &basis)
    }
}

pub(crate) fn check_finite<T: Vector>(net: &[T]) -> Result<(), NetError> {
    match net.iter().position(|p| !p.finite()) {
        Some(index) => Err(NetError::NotFinite { index }),
        None => Ok(()),
    }
}

fn combine<T: Vector, const D: usize>(net: &[T], basis: &[[f64; D]]) -> [T; D] {
    let mut out = [T::default(); D];
    for (&p, b) in net.iter().zip(basis) {
        for d in 0..D {
            out[d] = out[d] + p * b[d];
        }
    }
    out
}
