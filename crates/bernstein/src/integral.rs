//! Exact integrals: of nets, of products of basis functions, Gram matrices of B-spline bases.

use glam::DVec2;

use crate::extract::spans;
use crate::product::multinomial;
use crate::{
    BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle, MAX_DEGREE, NetError, Vector,
    bspline, gauss_legendre,
};

impl<T: Vector> BezierCurve<T> {
    /// `∫₀¹`: the mean of the control points.
    pub fn integral(&self) -> T {
        mean(self.net())
    }
}

impl<T: Vector> BezierPatch<T> {
    /// The integral over `[0, 1]²`: the mean of the control points.
    pub fn integral(&self) -> T {
        mean(self.net())
    }
}

impl<T: Vector> BezierTriangle<T> {
    /// The integral over the triangle with `corners` in the plane: its area (not negative) times the mean of the control points.
    pub fn integral(&self, corners: [DVec2; 3]) -> T {
        let [r, s, t] = corners;
        mean(self.net()) * (0.5 * (s - r).perp_dot(t - r).abs())
    }
}

impl<T: Vector> BSplineCurve<T> {
    /// The integral over the domain.
    pub fn integral(&self) -> T {
        let weights = basis_integrals(self.degree(), self.knots());
        self.net().iter().zip(weights).fold(T::default(), |sum, (&p, w)| sum + p * w)
    }
}

impl<T: Vector> BSplineSurface<T> {
    /// The integral over the domain.
    pub fn integral(&self) -> T {
        let [p, q] = self.degree();
        let [u, v] = self.knots();
        let (wu, wv) = (basis_integrals(p, u), basis_integrals(q, v));
        self.net().chunks_exact(wv.len()).zip(wu).fold(T::default(), |sum, (row, u)| {
            sum + row.iter().zip(&wv).fold(T::default(), |sum, (&p, &v)| sum + p * v) * u
        })
    }
}

/// `∫ B_a^m B_b^n` over a triangle of area 1, `a = [i, j, k]` of sum `m`, `b` of sum `n`:
/// `2 (m; a)(n; b) / ((m + n; a + b) (m + n + 1)(m + n + 2))` with the multinomials `(n; i j k) = n!/(i! j! k!)`.
pub fn triangle_product_integral(a: [usize; 3], b: [usize; 3]) -> f64 {
    let (m, n): (usize, usize) = (a.iter().sum(), b.iter().sum());
    let ways = multinomial(m, a[1], a[2]) * multinomial(n, b[1], b[2])
        / multinomial(m + n, a[1] + b[1], a[2] + b[2]);
    2.0 * ways / ((m + n + 1) as f64 * (m + n + 2) as f64)
}

/// A banded matrix `G_ij = ∫ N_i^(a) N_j^(b)` over the domain of a B-spline basis; zero for `|i − j| > degree`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gram {
    degree: usize,
    count: usize,
    entries: Vec<f64>,
}

impl Gram {
    /// The matrix for the derivatives of `orders` `[a, b]` of the basis of `degree` over `knots`; symmetric to the bit when `a = b`.
    ///
    /// By Gauss quadrature of sufficient order on every span: exact up to rounding.
    ///
    /// ```
    /// use suture_bernstein::Gram;
    ///
    /// // Hat functions over three unit cells: their mass matrix has 1/3, 2/3 on the diagonal and 1/6 beside it.
    /// let mass = Gram::new(1, &[-1.0, 0.0, 1.0, 2.0, 3.0, 4.0], [0, 0])?;
    /// assert!((mass.get(0, 0) - 1.0 / 3.0).abs() < 1e-15 && (mass.get(1, 2) - 1.0 / 6.0).abs() < 1e-15);
    /// # Ok::<(), suture_bernstein::NetError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`bspline::check`].
    pub fn new(degree: usize, knots: &[f64], orders: [usize; 2]) -> Result<Self, NetError> {
        let count = knots.len().saturating_sub(degree).saturating_sub(1);
        bspline::check(degree, count, knots)?;
        let band = 2 * degree + 1;
        let mut entries = vec![0.0; count * band];
        let mut block = [0.0; (MAX_DEGREE + 1) * (MAX_DEGREE + 1)];
        let order = degree + 1;
        for span in spans(degree, knots) {
            span_gram(degree, knots, span, orders, &mut block);
            for i in 0..order {
                for j in 0..order {
                    entries[(span - degree + i) * band + degree + j - i] += block[i * order + j];
                }
            }
        }
        Ok(Self { degree, count, entries })
    }

    /// Number of rows, and of columns: the number of basis functions.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of diagonals on either side of the main one: the degree.
    pub fn bandwidth(&self) -> usize {
        self.degree
    }

    /// Entry `(i, j)`; zero outside the band and outside the matrix.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        if i >= self.count || j >= self.count || i.abs_diff(j) > self.degree {
            return 0.0;
        }
        self.entries[i * (2 * self.degree + 1) + self.degree + j - i]
    }

    /// The entries `(j, G_ij)` of row `i` within the band, in order of `j`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let last = i.saturating_add(self.degree + 1).min(self.count);
        (i.saturating_sub(self.degree)..last).map(move |j| (j, self.get(i, j)))
    }
}

/// Writes the contribution of one span to [`Gram`], row by row: the `(degree + 1)²` integrals over
/// `[knots[span], knots[span + 1]]` of products of the functions `span − degree ..= span`.
///
/// # Panics
/// When `out` is shorter than `(degree + 1)²`, `degree > MAX_DEGREE` or `span` is not one that [`bspline::span`] returns.
pub fn span_gram(degree: usize, knots: &[f64], span: usize, orders: [usize; 2], out: &mut [f64]) {
    let order = degree + 1;
    let out = &mut out[..order * order];
    out.fill(0.0);
    let Some(total) = (2 * degree).checked_sub(orders[0].saturating_add(orders[1])) else {
        return;
    };
    if orders[0].max(orders[1]) > degree {
        return;
    }
    let (a, b) = (knots[span], knots[span + 1]);
    for [x, w] in gauss_legendre(total / 2 + 1) {
        let t = a + (b - a) * x;
        let (f, g) =
            (derivative(degree, knots, span, t, orders[0]), derivative(degree, knots, span, t, orders[1]));
        for i in 0..order {
            for j in 0..order {
                // Grouped so that exchanging the orders transposes the matrix to the bit.
                out[i * order + j] += (b - a) * w * (f[i] * g[j]);
            }
        }
    }
}

/// The derivatives of one order of the functions that live on `span`.
fn derivative(degree: usize, knots: &[f64], span: usize, t: f64, order: usize) -> [f64; MAX_DEGREE + 1] {
    // The basis of degree p − d, raised by d differences.
    let mut row = [[0.0]; MAX_DEGREE + 1];
    bspline::jets(degree - order, knots, span, t, &mut row);
    let mut row = row.map(|[x]| x);
    for n in degree - order + 1..=degree {
        let mut carry = 0.0;
        for i in 0..n {
            let w = n as f64 * row[i] / (knots[span + 1 + i] - knots[span + 1 + i - n]);
            row[i] = carry - w;
            carry = w;
        }
        row[n] = carry;
    }
    row
}

/// `∫ N_i` over the domain, for every function of the basis.
fn basis_integrals(degree: usize, knots: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; knots.len() - degree - 1];
    for span in spans(degree, knots) {
        let (a, b) = (knots[span], knots[span + 1]);
        for [x, w] in gauss_legendre(degree / 2 + 1) {
            let values = derivative(degree, knots, span, a + (b - a) * x, 0);
            for i in 0..=degree {
                sums[span - degree + i] += (b - a) * w * values[i];
            }
        }
    }
    sums
}

/// Weighted before it is summed: no overflow of a finite net.
fn mean<T: Vector>(net: &[T]) -> T {
    let w = 1.0 / net.len() as f64;
    net.iter().fold(T::default(), |sum, &p| sum + p * w)
}
