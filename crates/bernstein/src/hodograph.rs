//! Hodographs: derivatives as nets of one degree less.
//!
//! Exact up to rounding; where only a few derivatives at a few points are wanted, `jet` is cheaper.

use crate::axis::map_lines;
use crate::triangle::index;
use crate::{Axis, BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle, NetError, Vector};

impl<T: Vector> BezierCurve<T> {
    /// The derivative; of degree 0 for a constant.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when a difference overflows.
    pub fn derivative(&self) -> Result<Self, NetError> {
        Self::new(derive_line(self.net()))
    }
}

impl<T: Vector> BezierPatch<T> {
    /// The partial derivative along `axis`; of degree 0 there for a patch that is constant along it.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when a difference overflows.
    pub fn derivative(&self, axis: Axis) -> Result<Self, NetError> {
        let mut degree = self.degree();
        degree[axis.index()] = degree[axis.index()].saturating_sub(1);
        Self::new(degree, map_lines(self.net(), self.count(), axis, derive_line))
    }
}

impl<T: Vector> BezierTriangle<T> {
    /// The derivative along `direction`, given by barycentric coordinates of sum 0; of degree 0 for a constant.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when the direction is not finite or the net overflows.
    pub fn derivative(&self, direction: [f64; 3]) -> Result<Self, NetError> {
        let n = self.degree();
        let Some(m) = n.checked_sub(1) else {
            return Self::new(0, vec![self.net()[0] * 0.0]);
        };
        let [a, b, c] = direction.map(|d| d * n as f64);
        let at = |j, k| self.net()[index(n, j, k)];
        let entry = |(j, k)| at(j, k) * a + at(j + 1, k) * b + at(j, k + 1) * c;
        Self::new(m, (0..=m).flat_map(|k| (0..=m - k).map(move |j| (j, k))).map(entry).collect())
    }
}

impl<T: Vector> BSplineCurve<T> {
    /// The derivative, over the same knots less one at either end (a constant keeps them all). Piece by piece where the curve
    /// jumps: jumps of the curve leave no trace.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when a difference quotient overflows.
    pub fn derivative(&self) -> Result<Self, NetError> {
        let (degree, knots) = derive_knots(self.degree(), self.knots());
        Self::new(degree, knots, derive_spline(self.degree(), self.knots(), self.net()))
    }
}

impl<T: Vector> BSplineSurface<T> {
    /// The partial derivative along `axis`, over the same knots less one at either end of that direction.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when a difference quotient overflows.
    pub fn derivative(&self, axis: Axis) -> Result<Self, NetError> {
        let (mut degree, d) = (self.degree(), axis.index());
        let (p, along) = (degree[d], self.knots()[d]);
        let net = map_lines(self.net(), self.count(), axis, |line| derive_spline(p, along, line));
        let mut knots = self.knots().map(<[f64]>::to_vec);
        (degree[d], knots[d]) = derive_knots(p, along);
        Self::new(degree, knots, net)
    }
}

fn derive_line<T: Vector>(line: &[T]) -> Vec<T> {
    if line.len() == 1 {
        return vec![T::default()];
    }
    let n = (line.len() - 1) as f64;
    line.windows(2).map(|w| (w[1] - w[0]) * n).collect()
}

fn derive_knots(degree: usize, knots: &[f64]) -> (usize, Vec<f64>) {
    match degree.checked_sub(1) {
        None => (0, knots.to_vec()),
        Some(lower) => (lower, knots[1..knots.len() - 1].to_vec()),
    }
}

fn derive_spline<T: Vector>(degree: usize, knots: &[f64], line: &[T]) -> Vec<T> {
    if degree == 0 {
        return vec![T::default(); line.len()];
    }
    let quotient = |i: usize| {
        let width = knots[i + degree + 1] - knots[i + 1];
        // A function of the lower degree without support: its coefficient is never read.
        if width > 0.0 { (line[i + 1] - line[i]) * (degree as f64 / width) } else { T::default() }
    };
    (0..line.len() - 1).map(quotient).collect()
}
