//! Bézier triangles.

use glam::DVec2;

use crate::bernstein::binomial;
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
        let [p] = if self.degree < SMALL {
            self.polar::<SMALL, 1>(0, at)
        } else {
            self.polar::<{ MAX_DEGREE + 1 }, 1>(0, at)
        };
        p
    }

    /// Value and partials to second order with respect to plane coordinates `(U, V)` in which the corners of the triangle
    /// (`i`, `j`, `k` = `n` in this order) lie at `corners`. Not finite when the corners lie on a line.
    pub fn jet(&self, corners: [DVec2; 3], at: DVec2) -> Jet2<T> {
        // Gradients of the barycentric coordinates in (U, V).
        let [r, s, t] = corners;
        let area = (s - r).perp_dot(t - r);
        let gradient = |a: DVec2, b: DVec2| DVec2::new(a.y - b.y, b.x - a.x) / area;
        let g = [gradient(s, t), gradient(t, r), gradient(r, s)];
        let w = [
            (s - at).perp_dot(t - at) / area,
            (t - at).perp_dot(r - at) / area,
            (r - at).perp_dot(s - at) / area,
        ];
        let (gu, gv) = (g.map(|g| g.x), g.map(|g| g.y));
        let n = self.degree;
        match n {
            0 => Jet2::constant(self.net[0]),
            1 => {
                let c = [self.net[0], self.net[1], self.net[2]];
                Jet2 { p: along(c, w), du: along(c, gu), dv: along(c, gv), ..Jet2::default() }
            }
            _ => {
                let q = match n {
                    // Constant degrees unroll; this is the one that the weights of N-blends have.
                    7 => self.polar_of::<SMALL, 6>(7, 2, w),
                    _ if n < SMALL => self.polar::<SMALL, 6>(2, w),
                    _ => self.polar::<{ MAX_DEGREE + 1 }, 6>(2, w),
                };
                quadratic(n, q, w, gu, gv)
            }
        }
    }

    /// The net of `rest` degrees (`M` control points) that remains after `degree − rest` steps of de Casteljau's algorithm.
    #[inline]
    fn polar<const N: usize, const M: usize>(&self, rest: usize, w: [f64; 3]) -> [T; M] {
        self.polar_of::<N, M>(self.degree, rest, w)
    }

    /// By the basis of degree `m = n − rest`, `C(m, k) τᵏ · C(m − k, j) σʲ ρⁱ`, rather than step by step: `O(n²)`, and exact
    /// where a coordinate is 0 or 1.
    #[inline(always)]
    fn polar_of<const N: usize, const M: usize>(&self, n: usize, rest: usize, w: [f64; 3]) -> [T; M] {
        let m = n - rest;
        let powers = w.map(|x| {
            let mut powers = [1.0; N];
            for e in 1..=m {
                powers[e] = powers[e - 1] * x;
            }
            powers
        });
        let mut out = [T::default(); M];
        for k in 0..=m {
            let ck = binomial(m, k) * powers[2][k];
            for j in 0..=m - k {
                let b = ck * binomial(m - k, j) * (powers[1][j] * powers[0][m - k - j]);
                let mut entry = 0;
                for dk in 0..=rest {
                    for dj in 0..=rest - dk {
                        out[entry] = out[entry] + self.net[index(n, j + dj, k + dk)] * b;
                        entry += 1;
                    }
                }
            }
        }
        out
    }
}

/// Position of `b_ijk` in a net of `degree`.
pub(crate) fn index(degree: usize, j: usize, k: usize) -> usize {
    k * (degree + 1) - k * k.saturating_sub(1) / 2 + j
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
