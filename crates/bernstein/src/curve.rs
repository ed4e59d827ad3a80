//! Curves: Bézier and B-spline.

use crate::{MAX_DEGREE, NetError, SMALL, Vector, bernstein, bspline};

/// A Bézier curve on `[0, 1]`; its degree is the number of its control points less one.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "RawBezier<T>", bound(deserialize = "T: Vector + serde::Deserialize<'de>"))
)]
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

    /// A curve from a net that is known to be good: finite, of an allowed degree.
    pub(crate) fn from_checked(net: Vec<T>) -> Self {
        Self { net }
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.net.len() - 1
    }

    /// The control points.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Value and derivatives to order `D − 1` at `t`. The ends of the net are interpolated to the bit.
    pub fn jet<const D: usize>(&self, t: f64) -> [T; D] {
        if self.degree() < SMALL { self.jet_sized::<D, SMALL>(t) } else { self.jet_sized::<D, LARGE>(t) }
    }

    /// Value at `t`, to the bit the one of [`jet`](Self::jet).
    pub fn point(&self, t: f64) -> T {
        let [p] = self.jet(t);
        p
    }

    #[inline]
    fn jet_sized<const D: usize, const N: usize>(&self, t: f64) -> [T; D] {
        let mut basis = [[0.0; D]; N];
        bernstein::jets(self.degree(), t, &mut basis);
        combine(&self.net, &basis)
    }
}

/// A B-spline curve.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "RawSpline<T>", bound(deserialize = "T: Vector + serde::Deserialize<'de>"))
)]
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

    /// Value and derivatives to order `D − 1` at `t`; at a knot those of the piece above it, at the end of the domain of the
    /// piece below. Clamped ends are interpolated to the bit.
    pub fn jet<const D: usize>(&self, t: f64) -> [T; D] {
        if self.degree < SMALL { self.jet_sized::<D, SMALL>(t) } else { self.jet_sized::<D, LARGE>(t) }
    }

    /// Value at `t`, to the bit the one of [`jet`](Self::jet).
    pub fn point(&self, t: f64) -> T {
        let [p] = self.jet(t);
        p
    }

    #[inline]
    fn jet_sized<const D: usize, const N: usize>(&self, t: f64) -> [T; D] {
        let mut basis = [[0.0; D]; N];
        let span = bspline::span(self.degree, &self.knots, t);
        bspline::jets(self.degree, &self.knots, span, t, &mut basis);
        combine(&self.net[span - self.degree..=span], &basis)
    }
}

const LARGE: usize = MAX_DEGREE + 1;

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

/// What is read before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawBezier<T> {
    net: Vec<T>,
}

#[cfg(feature = "serde")]
impl<T: Vector> TryFrom<RawBezier<T>> for BezierCurve<T> {
    type Error = NetError;

    fn try_from(raw: RawBezier<T>) -> Result<Self, NetError> {
        Self::new(raw.net)
    }
}

/// What is read before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawSpline<T> {
    degree: usize,
    knots: Vec<f64>,
    net: Vec<T>,
}

#[cfg(feature = "serde")]
impl<T: Vector> TryFrom<RawSpline<T>> for BSplineCurve<T> {
    type Error = NetError;

    fn try_from(raw: RawSpline<T>) -> Result<Self, NetError> {
        Self::new(raw.degree, raw.knots, raw.net)
    }
}
