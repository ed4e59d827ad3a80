//! Products of Bézier nets: a bilinear map of two polynomials is a polynomial, of the sum of their degrees.
//!
//! # References
//! R. T. Farouki, V. T. Rajan, *Algorithms for polynomials in Bernstein form*, Computer Aided Geometric Design 5 (1988).

use crate::bernstein::binomial;
use crate::triangle::index;
use crate::{BezierCurve, BezierPatch, BezierTriangle, MAX_DEGREE, NetError, Vector};

impl<T: Vector> BezierCurve<T> {
    /// The curve `f(self, other)` for a bilinear `f`: a scalar multiple, a dot or a cross product.
    ///
    /// # Errors
    /// [`NetError::Degree`] beyond [`MAX_DEGREE`], [`NetError::NotFinite`] when a product overflows.
    pub fn product<S: Vector, R: Vector>(
        &self,
        other: &BezierCurve<S>,
        f: impl Fn(T, S) -> R,
    ) -> Result<BezierCurve<R>, NetError> {
        let (m, n) = (self.degree(), other.degree());
        check(m + n)?;
        let mut net = vec![R::default(); m + n + 1];
        for (i, &a) in self.net().iter().enumerate() {
            for (j, &b) in other.net().iter().enumerate() {
                net[i + j] = net[i + j] + f(a, b) * weight(m, i, n, j);
            }
        }
        BezierCurve::new(net)
    }
}

impl<T: Vector> BezierPatch<T> {
    /// The patch `f(self, other)` for a bilinear `f`: a scalar multiple, a dot or a cross product.
    ///
    /// ```
    /// use glam::{DVec2, DVec3};
    /// use suture_bernstein::{Axis, BezierPatch};
    ///
    /// // The normal field of the saddle (u, v, u v) is (−v, −u, 1).
    /// let net = vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::ONE];
    /// let saddle = BezierPatch::new([1, 1], net)?;
    /// let (du, dv) = (saddle.derivative(Axis::U)?, saddle.derivative(Axis::V)?);
    /// let normal = du.product(&dv, DVec3::cross)?;
    /// assert_eq!(normal.point(DVec2::new(0.5, 0.25)), DVec3::new(-0.25, -0.5, 1.0));
    /// # Ok::<(), suture_bernstein::NetError>(())
    /// ```
    ///
    /// # Errors
    /// [`NetError::Degree`] beyond [`MAX_DEGREE`], [`NetError::NotFinite`] when a product overflows.
    pub fn product<S: Vector, R: Vector>(
        &self,
        other: &BezierPatch<S>,
        f: impl Fn(T, S) -> R,
    ) -> Result<BezierPatch<R>, NetError> {
        let (a, b) = (self.degree(), other.degree());
        let degree = [a[0] + b[0], a[1] + b[1]];
        degree.into_iter().try_for_each(check)?;
        let columns = degree[1] + 1;
        let mut net = vec![R::default(); (degree[0] + 1) * columns];
        for (s, &p) in self.net().iter().enumerate() {
            let (i, j) = (s / (a[1] + 1), s % (a[1] + 1));
            for (t, &q) in other.net().iter().enumerate() {
                let (k, l) = (t / (b[1] + 1), t % (b[1] + 1));
                let entry = &mut net[(i + k) * columns + j + l];
                *entry = *entry + f(p, q) * (weight(a[0], i, b[0], k) * weight(a[1], j, b[1], l));
            }
        }
        BezierPatch::new(degree, net)
    }
}

impl<T: Vector> BezierTriangle<T> {
    /// The triangle `f(self, other)` for a bilinear `f`: a scalar multiple, a dot or a cross product.
    ///
    /// # Errors
    /// [`NetError::Degree`] beyond [`MAX_DEGREE`], [`NetError::NotFinite`] when a product overflows.
    pub fn product<S: Vector, R: Vector>(
        &self,
        other: &BezierTriangle<S>,
        f: impl Fn(T, S) -> R,
    ) -> Result<BezierTriangle<R>, NetError> {
        let (m, n) = (self.degree(), other.degree());
        check(m + n)?;
        let mut net = vec![R::default(); (m + n + 1) * (m + n + 2) / 2];
        for (j, k) in entries(m) {
            for (s, t) in entries(n) {
                let ways = multinomial(m, j, k) * multinomial(n, s, t) / multinomial(m + n, j + s, k + t);
                let entry = &mut net[index(m + n, j + s, k + t)];
                *entry = *entry + f(self.net()[index(m, j, k)], other.net()[index(n, s, t)]) * ways;
            }
        }
        BezierTriangle::new(m + n, net)
    }
}

/// The pairs `(j, k)` of a triangle net, in the order of the net.
fn entries(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=n).flat_map(move |k| (0..=n - k).map(move |j| (j, k)))
}

/// `n!/(i! j! k!)` with `i = n − j − k`.
pub(crate) fn multinomial(n: usize, j: usize, k: usize) -> f64 {
    binomial(n, k) * binomial(n - k, j)
}

fn weight(m: usize, i: usize, n: usize, j: usize) -> f64 {
    binomial(m, i) * binomial(n, j) / binomial(m + n, i + j)
}

fn check(degree: usize) -> Result<(), NetError> {
    if degree > MAX_DEGREE { Err(NetError::Degree { degree }) } else { Ok(()) }
}
