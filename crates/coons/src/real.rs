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
/// Every operation is rounded outwards by one unit in the last place. Sine and cosine trust the platform's to `2⁻⁵⁰`.
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

impl Add for Interval {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        // Sums with zero are exact: without this, sparse expansions would widen for nothing.
        if o == ZERO {
            self
        } else if self == ZERO {
            o
        } else {
            Self::outward(self.lo + o.lo, self.hi + o.hi)
        }
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
        if o == ONE {
            return self;
        }
        if self == ONE {
            return o;
        }
        let p = [self.lo * o.lo, self.lo * o.hi, self.hi * o.lo, self.hi * o.hi];
        if p.iter().any(|x| x.is_nan()) {
            return EVERYTHING;
        }
        Self::outward(
            p.iter().copied().fold(f64::INFINITY, f64::min),
            p.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
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
        if self == ONE {
            return ONE;
        }
        if self.lo > 0.0 || self.hi < 0.0 { Self::outward(1.0 / self.hi, 1.0 / self.lo) } else { EVERYTHING }
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
        assert_eq!(Interval { lo: -1.0, hi: 1.0 }.recip().magnitude(), f64::INFINITY);
        assert_eq!(Interval::of(f64::NAN).magnitude(), f64::INFINITY);
    }
}
