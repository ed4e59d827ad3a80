//! Numbers that surfaces can be evaluated in: machine numbers and intervals that enclose the exact result.

use std::ops::{Add, Mul, Neg, Sub};

/// A number that the analytic surfaces and the splines of this crate can be evaluated in.
pub trait Real:
    Copy + std::fmt::Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The number `x`, exactly.
    fn of(x: f64) -> Self;
    /// `1 / self`.
    fn recip(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// A machine number inside or next to it: chooses the piece of a spline.
    fn mid(self) -> f64;
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }

    fn recip(self) -> Self {
        1.0 / self
    }

    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }

    fn mid(self) -> f64 {
        self
    }
}

/// A closed interval that contains the exact result of the operations that made it (R. E. Moore, *Interval Analysis*, 1966).
///
/// An end is moved outwards by one unit in the last place where the operation was not exact in its favour, which error-free transformations
/// tell (T. J. Dekker, *A floating-point technique for extending the available precision*, 1971). Sine and cosine trust the platform's to `2⁻⁵⁰`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Interval {
    /// Largest absolute value of its members; infinite when an end is not a number.
    pub fn magnitude(self) -> f64 {
        let m = self.lo.abs().max(self.hi.abs());
        if self.lo.is_nan() || self.hi.is_nan() { f64::INFINITY } else { m }
    }

    fn outward(lo: f64, hi: f64) -> Self {
        Self { lo: lo.next_down(), hi: hi.next_up() }
    }
}

/// The rounded result and the sign of what it lacks; NaN where that is not known.
type Rounded = (f64, f64);

fn down((x, lack): Rounded) -> f64 {
    if lack >= 0.0 { x } else { x.next_down() }
}

fn up((x, lack): Rounded) -> f64 {
    if lack <= 0.0 { x } else { x.next_up() }
}

fn sum(a: f64, b: f64) -> Rounded {
    let s = a + b;
    let t = s - a;
    // Exact unless something overflows, which makes it NaN.
    (s, (a - (s - t)) + (b - t))
}

/// Between these, remainders of products and quotients neither under- nor overflow.
fn safe(x: f64) -> bool {
    (1e-250..1e250).contains(&x.abs())
}

fn product(a: f64, b: f64) -> Rounded {
    let p = a * b;
    let exact = a == 0.0 || b == 0.0;
    let lack = if exact { 0.0 } else { a.mul_add(b, -p) };
    (p, if exact || safe(p) { lack } else { f64::NAN })
}

fn reciprocal(x: f64) -> Rounded {
    let q = 1.0 / x;
    // 1/x − q = (1 − q x)/x.
    (q, if safe(q) { (-q).mul_add(x, 1.0) * x.signum() } else { f64::NAN })
}

impl Add for Interval {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self { lo: down(sum(self.lo, o.lo)), hi: up(sum(self.hi, o.hi)) }
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        if self == ZERO || o == ZERO {
            return ZERO;
        }
        let p =
            [product(self.lo, o.lo), product(self.lo, o.hi), product(self.hi, o.lo), product(self.hi, o.hi)];
        if p.iter().any(|(x, _)| x.is_nan()) {
            return EVERYTHING;
        }
        Self {
            lo: p.into_iter().map(down).fold(f64::INFINITY, f64::min),
            hi: p.into_iter().map(up).fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };
const EVERYTHING: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

impl Real for Interval {
    fn of(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    fn recip(self) -> Self {
        if self.lo > 0.0 || self.hi < 0.0 {
            Self { lo: down(reciprocal(self.hi)), hi: up(reciprocal(self.lo)) }
        } else {
            EVERYTHING
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        let c = self.mid();
        // Both functions change by no more than their argument does.
        let r = (self.hi - c).max(c - self.lo).next_up() + f64::EPSILON * 4.0;
        let (s, k) = c.sin_cos();
        if c == 0.0 && self == ZERO {
            return (ZERO, ONE);
        }
        let around = |x: f64| Self::outward(x - r, x + r);
        (around(s), around(k))
    }

    fn mid(self) -> f64 {
        0.5 * (self.lo + self.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_contain_the_exact_result() {
        let third = Interval::of(3.0).recip();
        assert!(third.lo < third.hi && third.lo <= 1.0 / 3.0 && 1.0 / 3.0 <= third.hi);
        let one = third * Interval::of(3.0);
        assert!(one.lo <= 1.0 && 1.0 <= one.hi && one.hi - one.lo < 1e-14);
        let (s, c) = Interval::of(0.7).sin_cos();
        let unit = s * s + c * c;
        assert!(unit.lo <= 1.0 && 1.0 <= unit.hi && unit.hi - unit.lo < 1e-14);
        // What is exact stays a number.
        let (x, y) = (Interval::of(0.375), Interval::of(-1.5));
        assert_eq!((x + y, x * y), (Interval::of(-1.125), Interval::of(-0.5625)));
        assert_eq!(Interval::of(-0.25).recip(), Interval::of(-4.0));
        // What is not is enclosed in one unit, on the right side: 0.1 + 0.2 lies below the number it is rounded to.
        let s = Interval::of(0.1) + Interval::of(0.2);
        assert_eq!((s.lo, s.hi), ((0.1 + 0.2f64).next_down(), 0.1 + 0.2));
        for (a, b) in [(0.1, 0.7), (-3.3, 0.7), (1e-300, 1e-200), (1e300, -1e200), (f64::MIN_POSITIVE, 0.1)] {
            let p = Interval::of(a) * Interval::of(b);
            assert!(p.lo <= a * b && a * b <= p.hi && p.lo < p.hi, "{a} {b} {p:?}");
        }
        let huge = Interval::of(f64::MAX) + Interval::of(f64::MAX);
        assert!(huge.lo == f64::MAX && huge.hi == f64::INFINITY);
        let tiny = Interval::of(1e-320).recip();
        assert!(tiny.lo <= f64::MAX && tiny.hi == f64::INFINITY);
        assert_eq!(Interval { lo: -1.0, hi: 1.0 }.recip().magnitude(), f64::INFINITY);
        assert_eq!(Interval::of(f64::NAN).magnitude(), f64::INFINITY);
    }
}
