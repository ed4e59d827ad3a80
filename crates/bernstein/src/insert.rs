//! Knot insertion: the same spline over more knots.
//!
//! # References
//! W. Boehm, *Inserting new knots into B-spline curves*, Computer-Aided Design 12 (1980); Farin 2002, section 8.4.

use crate::axis::map_lines;
use crate::{Axis, BSplineCurve, BSplineSurface, NetError, Vector, bspline};

impl<T: Vector> BSplineCurve<T> {
    /// The same curve with the knots `new` (in any order, repeated at will) added.
    ///
    /// # Errors
    /// [`NetError::Insertion`] for a knot outside the domain or beyond multiplicity `degree + 1`.
    pub fn insert(&self, new: &[f64]) -> Result<Self, NetError> {
        let (mut knots, mut net) = (self.knots().to_vec(), self.net().to_vec());
        for &t in new {
            let span = place(self.degree(), &knots, t)?;
            net = insert_line(self.degree(), &knots, span, t, &net);
            knots.insert(span + 1, t);
        }
        Self::new(self.degree(), knots, net)
    }
}

impl<T: Vector> BSplineSurface<T> {
    /// The same surface with the knots `new` (in any order, repeated at will) added along `axis`.
    ///
    /// # Errors
    /// [`NetError::Insertion`] for a knot outside the domain or beyond multiplicity `degree + 1`.
    pub fn insert(&self, axis: Axis, new: &[f64]) -> Result<Self, NetError> {
        let (d, mut count) = (axis.index(), self.count());
        let degree = self.degree()[d];
        let (mut knots, mut net) = (self.knots().map(<[f64]>::to_vec), self.net().to_vec());
        for &t in new {
            let span = place(degree, &knots[d], t)?;
            net = map_lines(&net, count, axis, |line| insert_line(degree, &knots[d], span, t, line));
            knots[d].insert(span + 1, t);
            count[d] += 1;
        }
        Self::new(self.degree(), knots, net)
    }
}

/// The span that `t` is inserted into.
fn place(degree: usize, knots: &[f64], t: f64) -> Result<usize, NetError> {
    let domain = [knots[degree], knots[knots.len() - degree - 1]];
    let multiplicity = knots.partition_point(|&k| k <= t) - knots.partition_point(|&k| k < t);
    if !(domain[0] <= t && t <= domain[1]) || multiplicity > degree {
        return Err(NetError::Insertion { knot: t, domain, multiplicity });
    }
    Ok(bspline::span(degree, knots, t))
}

/// Boehm's step. At the upper end of the domain `t` is the upper knot of its span and comes before its equals.
fn insert_line<T: Vector>(degree: usize, knots: &[f64], span: usize, t: f64, line: &[T]) -> Vec<T> {
    let mut out = Vec::with_capacity(line.len() + 1);
    out.extend_from_slice(&line[..=span - degree]);
    for i in span - degree + 1..=span {
        let (a, b) = (knots[i], knots[i + degree]);
        let r = (t - a) / (b - a);
        out.push(line[i - 1] * (1.0 - r) + line[i] * r);
    }
    out.extend_from_slice(&line[span..]);
    out
}
