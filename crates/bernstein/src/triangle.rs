//! Bézier triangles.

use glam::DVec2;

use crate::bernstein::binomial_row;
use crate::curve::check_finite;
use crate::{Jet2, MAX_DEGREE, NetError, SMALL, Vector};

/// A Bézier triangle `Σ B_ijk^n(ρ, σ, τ) b_ijk`, `B_ijk^n = n!/(i! j! k!) ρⁱ σʲ τᵏ`, over barycentric coordinates.
///
/// The net is stored by rows of constant `k`, `j` rising within a row: `b_{n,0,0}, b_{n−1,1,0}, …, b_{0,n,0}, b_{n−1,0,1}, …, b_{0,0,n}`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "RawTriangle<T>", bound(deserialize = "T: Vector + serde::Deserialize<'de>"))
)]
pub struct BezierTriangle<T> {
    degree: usize,
    net: Vec<T>,
}

impl<T: Vector> BezierTriangle<T> {
    /// A triangle of `degree` `n` from its `(n + 1)(n + 2)/2` control points.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::NotFinite`].
    pub fn new(degree: usize, net: Vec<T>) -> Result<Self, NetError> {
        if degree > MAX_DEGREE {
            return Err(NetError::Degree { degree });
        }
        let needed = (degree + 1) * (degree + 2) / 2;
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        check_finite(&net)?;
        Ok(Self { degree, net })
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The control points, in the order of the type's documentation.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Position of `b_ijk` in the net, `i = n − j − k`.
    pub fn index(degree: usize, j: usize, k: usize) -> usize {
        index(degree, j, k)
    }

    /// Value at barycentric coordinates `at` (of sum 1). The corners of the net are interpolated to the bit.
    pub fn point(&self, at: [f64; 3]) -> T {
        let n = self.degree;
        let basis = Basis::<LARGE>::new(n, at);
        let (mut p, mut net) = (T::default(), self.net.as_slice());
        for k in 0..=n {
            let (row, tail) = net.split_at(n + 1 - k);
            p = row.iter().zip(basis.row(k)).fold(p, |p, (&c, w)| p + c * w);
            net = tail;
        }
        p
    }

    /// Value and partials to second order with respect to plane coordinates `(U, V)` in which the corners of the triangle
    /// (`i`, `j`, `k` = `n` in this order) lie at `corners`. Not finite when the corners lie on a line.
    pub fn jet(&self, corners: [DVec2; 3], at: DVec2) -> Jet2<T> {
        // Gradients of the barycentric coordinates in (U, V).
        let [r, s, t] = corners;
        let area = (s - r).perp_dot(t - r);
        let inverse = 1.0 / area;
        let gradient = |a: DVec2, b: DVec2| DVec2::new(a.y - b.y, b.x - a.x) * inverse;
        let g = [gradient(s, t), gradient(t, r), gradient(r, s)];
        // Quotients: exactly 0 and 1 at the corners.
        let w = [
            (s - at).perp_dot(t - at) / area,
            (t - at).perp_dot(r - at) / area,
            (r - at).perp_dot(s - at) / area,
        ];
        let (gu, gv) = (g.map(|g| g.x), g.map(|g| g.y));
        match self.degree {
            0 => Jet2::constant(self.net[0]),
            1 => {
                let c = [self.net[0], self.net[1], self.net[2]];
                Jet2 { p: along(c, w), du: along(c, gu), dv: along(c, gv), ..Jet2::default() }
            }
            n if n < SMALL + 2 => quadratic(n, self.last_but_two::<SMALL>(w), w, gu, gv),
            n => quadratic(n, self.last_but_two::<LARGE>(w), w, gu, gv),
        }
    }

    /// The six control points that remain two steps before the end of de Casteljau's algorithm, `n ≥ 2`.
    ///
    /// By the basis of degree `m = n − 2` rather than step by step: `O(n²)`, and exact where a coordinate is 0 or 1.
    fn last_but_two<const N: usize>(&self, w: [f64; 3]) -> [T; 6] {
        let n = self.degree;
        let basis = Basis::<N>::new(n - 2, w);
        let mut q = [T::default(); 6];
        let (mut a, tail) = self.net.split_at(n + 1);
        let (mut b, mut net) = tail.split_at(n);
        for k in 0..=n - 2 {
            let (c, tail) = net.split_at(n - 1 - k);
            let points = a.windows(3).zip(b.windows(2)).zip(c);
            for (((a, b), &c), w) in points.zip(basis.row(k)) {
                for (q, p) in q.iter_mut().zip([a[0], a[1], a[2], b[0], b[1], c]) {
                    *q = *q + p * w;
                }
            }
            (a, b, net) = (b, c, tail);
        }
        q
    }
}

const LARGE: usize = MAX_DEGREE + 1;

/// Position of `b_ijk` in a net of `degree`.
pub(crate) fn index(degree: usize, j: usize, k: usize) -> usize {
    k * (degree + 1) - k * k.saturating_sub(1) / 2 + j
}

/// The basis of degree `m ≤ N − 1` at one point, row by row: `B_ijk = C(m, k) τᵏ · C(m − k, j) σʲ ρⁱ`.
struct Basis<const N: usize> {
    m: usize,
    powers: [[f64; N]; 3],
}

impl<const N: usize> Basis<N> {
    #[inline]
    fn new(m: usize, w: [f64; 3]) -> Self {
        let mut powers = [[1.0; N]; 3];
        for e in 1..=m {
            for c in 0..3 {
                powers[c][e] = powers[c][e - 1] * w[c];
            }
        }
        Self { m, powers }
    }

    /// The functions of row `k`, in order of `j`.
    #[inline]
    fn row(&self, k: usize) -> impl Iterator<Item = f64> {
        let d = self.m - k;
        let [rho, sigma, tau] = &self.powers;
        let factor = binomial_row(self.m)[k] * tau[k];
        let choose = binomial_row(d).iter();
        choose.zip(sigma).zip(rho[..=d].iter().rev()).map(move |((c, s), r)| factor * c * (s * r))
    }
}

fn along<T: Vector>(c: [T; 3], d: [f64; 3]) -> T {
    c[0] * d[0] + c[1] * d[1] + c[2] * d[2]
}

/// The jet of a triangle of degree `n` from the six control points that remain two steps before the end of de Casteljau's
/// algorithm: their polar forms along the gradients are its derivatives.
fn quadratic<T: Vector>(n: usize, q: [T; 6], w: [f64; 3], gu: [f64; 3], gv: [f64; 3]) -> Jet2<T> {
    // Net of degree 2: b200, b110, b020, b101, b011, b002.
    let row = |d: [f64; 3]| {
        [along([q[0], q[1], q[3]], d), along([q[1], q[2], q[4]], d), along([q[3], q[4], q[5]], d)]
    };
    let (line, ru, rv) = (row(w), row(gu), row(gv));
    let (first, second) = (n as f64, (n * (n - 1)) as f64);
    Jet2 {
        p: along(line, w),
        du: along(line, gu) * first,
        dv: along(line, gv) * first,
        duu: along(ru, gu) * second,
        duv: along(ru, gv) * second,
        dvv: along(rv, gv) * second,
    }
}

/// What is read before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawTriangle<T> {
    degree: usize,
    net: Vec<T>,
}

#[cfg(feature = "serde")]
impl<T: Vector> TryFrom<RawTriangle<T>> for BezierTriangle<T> {
    type Error = NetError;

    fn try_from(raw: RawTriangle<T>) -> Result<Self, NetError> {
        Self::new(raw.degree, raw.net)
    }
}
