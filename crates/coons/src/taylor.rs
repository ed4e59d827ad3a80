//! Truncated Taylor expansions in two variables: exact derivatives of whatever is computed with them.

use std::ops::{Add, Mul, Neg, Sub};

use glam::DVec3;
use suture_bernstein::Jet2;

use crate::real::{Interval, Real};

/// `Σ c[i][j] hⁱ kʲ`, `i, j < N`: the expansion of a function of two variables about a point, `c[i][j]` its partial derivative
/// `∂ⁱᵤ ∂ʲᵥ` over `i! j!`. Arithmetic drops higher powers and is exact below them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor<R, const N: usize>(pub [[R; N]; N]);

/// Expansions to third order in either variable, in machine numbers.
pub type Expansion = Taylor<f64, 4>;
/// Expansions to third order in either variable, in intervals.
pub type Enclosure = Taylor<Interval, 4>;

impl<R: Real, const N: usize> Taylor<R, N> {
    /// A constant.
    pub fn constant(x: R) -> Self {
        let mut c = [[R::of(0.0); N]; N];
        c[0][0] = x;
        Self(c)
    }

    /// The first variable at `u`.
    pub fn u(u: f64) -> Self {
        let mut t = Self::constant(R::of(u));
        t.0[1][0] = R::of(1.0);
        t
    }

    /// The second variable at `v`.
    pub fn v(v: f64) -> Self {
        let mut t = Self::constant(R::of(v));
        t.0[0][1] = R::of(1.0);
        t
    }

    /// Partial derivative `∂ⁱᵤ ∂ʲᵥ`; `i, j < N`.
    pub fn partial(&self, i: usize, j: usize) -> R {
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        self.0[i][j] * R::of(factorial(i) * factorial(j))
    }

    /// Multiplied by a number.
    pub fn scale(self, s: R) -> Self {
        Self(self.0.map(|row| row.map(|c| c * s)))
    }

    /// Every coefficient through `f`.
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Taylor<S, N> {
        Taylor(self.0.map(|row| row.map(&f)))
    }

    /// The function without its value at the point.
    fn rest(mut self) -> Self {
        self.0[0][0] = R::of(0.0);
        self
    }

    /// `f(self)` for a function of one variable with the given Taylor coefficients about the constant term.
    pub fn apply(self, coefficients: &[R]) -> Self {
        let h = self.rest();
        coefficients.iter().rev().fold(Self::constant(R::of(0.0)), |sum, &c| sum * h + Self::constant(c))
    }
}

impl<R: Real, const N: usize> Add for Taylor<R, N> {
    type Output = Self;

    fn add(mut self, o: Self) -> Self {
        for i in 0..N {
            for j in 0..N {
                self.0[i][j] = self.0[i][j] + o.0[i][j];
            }
        }
        self
    }
}

impl<R: Real, const N: usize> Neg for Taylor<R, N> {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|row| row.map(|c| -c)))
    }
}

impl<R: Real, const N: usize> Sub for Taylor<R, N> {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<R: Real, const N: usize> Mul for Taylor<R, N> {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        let mut c = [[R::of(0.0); N]; N];
        for i in 0..N {
            for j in 0..N {
                for k in 0..N - i {
                    for l in 0..N - j {
                        c[i + k][j + l] = c[i + k][j + l] + self.0[i][j] * o.0[k][l];
                    }
                }
            }
        }
        Self(c)
    }
}

impl<R: Real, const N: usize> Real for Taylor<R, N> {
    fn of(x: f64) -> Self {
        Self::constant(R::of(x))
    }

    fn recip(self) -> Self {
        // 1/(c + h) = Σ (−1)ᵏ hᵏ / cᵏ⁺¹; the power 2N − 1 of h vanishes.
        let r = self.0[0][0].recip();
        let mut powers = vec![r];
        for k in 1..2 * N - 1 {
            powers.push(-(powers[k - 1] * r));
        }
        self.apply(&powers)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.0[0][0].sin_cos();
        let cycle = [s, c, -s, -c];
        let mut inverse = R::of(1.0);
        let (mut sine, mut cosine) = (Vec::new(), Vec::new());
        for k in 0..2 * N - 1 {
            sine.push(cycle[k % 4] * inverse);
            cosine.push(cycle[(k + 1) % 4] * inverse);
            inverse = inverse * R::of((k + 1) as f64).recip();
        }
        (self.apply(&sine), self.apply(&cosine))
    }

    fn mid(self) -> f64 {
        self.0[0][0].mid()
    }
}

/// The jet to second order of a point with expanded coordinates.
pub(crate) fn jet2<const N: usize>(p: &[Taylor<f64, N>; 3]) -> Jet2 {
    let d = |i, j| partial(p, i, j);
    Jet2 { p: d(0, 0), du: d(1, 0), dv: d(0, 1), duu: d(2, 0), duv: d(1, 1), dvv: d(0, 2) }
}

/// Partial derivative of a point with expanded coordinates.
pub(crate) fn partial<const N: usize>(p: &[Taylor<f64, N>; 3], i: usize, j: usize) -> DVec3 {
    DVec3::new(p[0].partial(i, j), p[1].partial(i, j), p[2].partial(i, j))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_quotients_and_sines_have_their_derivatives() {
        let (u, v) = (Expansion::u(0.3), Expansion::v(0.7));
        let (s, c) = (u * v + u).sin_cos();
        let x = 0.3 * 0.7 + 0.3;
        assert!((s.partial(1, 0) - 1.7 * f64::cos(x)).abs() < 1e-15);
        // ∂u∂v sin(uv + u) = cos − (v + 1) u sin
        assert!((s.partial(1, 1) - (x.cos() - 1.7 * 0.3 * x.sin())).abs() < 1e-15);
        assert!((s.partial(0, 3) + 0.027 * x.cos()).abs() < 1e-15);
        let one = s * s + c * c;
        for i in 0..4 {
            for j in 0..4 {
                let want = if i + j == 0 { 1.0 } else { 0.0 };
                assert!((one.0[i][j] - want).abs() < 1e-14, "{i} {j} {}", one.0[i][j]);
            }
        }
        let q = (u * v).recip() * u * v;
        assert!((q.partial(0, 0) - 1.0).abs() < 1e-15 && q.partial(3, 3).abs() < 1e-9);
    }
}
