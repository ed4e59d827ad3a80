//! Nets of Bézier triangles over a [`Field`]: indices, derivatives, restriction to an edge.

use suture_bernstein::BezierTriangle;

use super::field::{Elem, Field};

/// Degree of the N-blends.
pub(crate) const DEGREE: usize = 7;

/// Number of coefficients of one triangle.
pub(crate) const COUNT: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// Position of `b_ijk` in a net of degree `i + j + k`.
pub(crate) fn at([i, j, k]: [usize; 3]) -> usize {
    BezierTriangle::<f64>::index(i + j + k, j, k)
}

/// All `(i, j, k)` of a degree, in storage order.
pub(crate) fn indices(degree: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..=degree).flat_map(move |k| (0..=degree - k).map(move |j| [degree - j - k, j, k]))
}

/// `q` with entry `d` raised by one.
pub(crate) fn raise(mut q: [usize; 3], d: usize) -> [usize; 3] {
    q[d] += 1;
    q
}

/// The net, of degree `degree − 1`, of the derivative along the vector with the barycentric coordinates `along`.
pub(crate) fn derivative(field: &'static Field, degree: usize, net: &[Elem], along: &[Elem; 3]) -> Vec<Elem> {
    let factor = field.int(degree as i64);
    indices(degree - 1)
        .map(|q| {
            let sum = (0..3).fold(field.int(0), |sum, d| &sum + &(&along[d] * &net[at(raise(q, d))]));
            &factor * &sum
        })
        .collect()
}

/// The coefficients, in storage order, of the edge on which barycentric coordinate `opposite` is zero.
pub(crate) fn edge(degree: usize, net: &[Elem], opposite: usize) -> Vec<Elem> {
    indices(degree).filter(|q| q[opposite] == 0).map(|q| net[at(q)].clone()).collect()
}
