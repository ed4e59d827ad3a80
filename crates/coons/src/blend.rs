//! Blend functions: what carries a surface from one constituent to the other.

use serde::{Deserialize, Serialize};

/// A function on `[0, 1]` with value 0 at 0 and 1 at 1.
///
/// It is *flat of order `k`* when its derivatives `1..=k` vanish at both ends; a fill joins as smoothly as its blend is flat.
pub trait Blend: Send + Sync + std::fmt::Debug {
    /// Value and derivatives to third order at `t ∈ [0, 1]`. The value and the flat derivatives must be exact, not only
    /// accurate, at both ends.
    fn jet(&self, t: f64) -> [f64; 4];

    /// Order to which it is flat.
    fn flat(&self) -> usize;

    /// The blend as data, when it is one of this crate: what cannot be told cannot be saved.
    fn function(&self) -> Option<BlendFunction> {
        None
    }
}

/// The blend functions of the specification's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BlendFunction {
    /// Polynomial of degree `2k + 1`, flat of order `k ≤ 3`: exact rational end jets and the smallest derivatives; the default.
    Polynomial(u8),
    /// `sin²(πt/2)` (order 1), with the correction of Theorem 3 (order 2), and `x²(3 − 2x)` of it (order 3). Order 0 is the line.
    Trigonometric(u8),
    /// `4t²/(1 + t²)²` (order 1, Equation 3), with a correction of its own (order 2), and `x²(3 − 2x)` of it (order 3).
    Rational(u8),
    /// `tᵏ⁺¹/(tᵏ⁺¹ + (1 − t)ᵏ⁺¹)`, flat of order `k ≤ 3`.
    SymmetricRational(u8),
    /// Rational form with the correction printed for the trigonometric one: the paper's Section 4 taken at its word. Flat of order 1
    /// only, and it overshoots 1 (erratum E2). For comparison.
    RationalAsPrinted,
    /// Trigonometric form with the printed correction scaled to `s″(0) = 1`: the paper's proof of Theorem 3 taken at its word.
    /// Flat of order 1 only (erratum E1). For comparison.
    TrigonometricScaled,
}

/// A family of blend functions; the order is chosen by the smoothness asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// [`BlendFunction::Polynomial`].
    #[default]
    Polynomial,
    /// [`BlendFunction::Trigonometric`].
    Trigonometric,
    /// [`BlendFunction::Rational`].
    Rational,
    /// [`BlendFunction::SymmetricRational`].
    SymmetricRational,
}

impl Family {
    /// The member that is flat of order `order`, at most 3.
    pub fn flat(self, order: usize) -> BlendFunction {
        let k = order.min(3) as u8;
        match self {
            Self::Polynomial => BlendFunction::Polynomial(k),
            Self::Trigonometric => BlendFunction::Trigonometric(k),
            Self::Rational => BlendFunction::Rational(k),
            Self::SymmetricRational => BlendFunction::SymmetricRational(k),
        }
    }
}

impl Blend for BlendFunction {
    fn jet(&self, t: f64) -> [f64; 4] {
        let mut jet = match *self {
            Self::Polynomial(k) => polynomial(k, t),
            Self::Trigonometric(0) | Self::Rational(0) => polynomial(0, t),
            Self::Trigonometric(1) => sine_squared(t),
            Self::Trigonometric(2) => sub(sine_squared(t), printed_correction(t)),
            Self::Trigonometric(_) => smooth(sine_squared(t)),
            Self::Rational(1) => rational(t),
            Self::Rational(2) => sub(rational(t), rational_correction(t)),
            Self::Rational(_) => smooth(rational(t)),
            Self::SymmetricRational(k) => symmetric(k.min(3) as usize, t),
            Self::RationalAsPrinted => sub(rational(t), printed_correction(t)),
            Self::TrigonometricScaled => {
                let scale = 2.0 / std::f64::consts::PI.powi(2);
                sub(sine_squared(t), printed_correction(t).map(|s| s * scale))
            }
        };
        // The cosine of π/2 is 6e-17 in machine numbers: the ends are set, not computed.
        if t == 0.0 || t == 1.0 {
            jet[0] = t;
            for d in &mut jet[1..=self.flat()] {
                *d = 0.0;
            }
        }
        jet
    }

    fn flat(&self) -> usize {
        match *self {
            Self::Polynomial(k) | Self::Trigonometric(k) | Self::Rational(k) | Self::SymmetricRational(k) => {
                usize::from(k.min(3))
            }
            Self::RationalAsPrinted | Self::TrigonometricScaled => 1,
        }
    }

    fn function(&self) -> Option<BlendFunction> {
        Some(*self)
    }
}

/// The correction `s(t) = (1 − 2t)³ sin²(2πt) / 16` printed in Theorem 3, with its derivatives: `s″(0) = π²/2`, not 1 (erratum E1).
pub fn printed_correction(t: f64) -> [f64; 4] {
    let two_pi = 2.0 * std::f64::consts::PI;
    let (s, c) = (two_pi * t).sin_cos();
    let sine = [s, two_pi * c, -two_pi * two_pi * s, -two_pi.powi(3) * c];
    let line = [1.0 - 2.0 * t, -2.0, 0.0, 0.0];
    mul(mul(line, mul(line, line)), mul(sine, sine)).map(|x| x / 16.0)
}

/// The correction `t²(1 − t)²(4 − 5t)` of the rational form, with its derivatives.
pub fn rational_correction(t: f64) -> [f64; 4] {
    let (a, b) = ([t, 1.0, 0.0, 0.0], [1.0 - t, -1.0, 0.0, 0.0]);
    let ab = mul(a, b);
    mul(mul(ab, ab), [4.0 - 5.0 * t, -5.0, 0.0, 0.0])
}

fn polynomial(k: u8, t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    // Derivatives are multiples of (t s)ᵏ⁻ʲ. The value is summed from the nearer end, so that it is exact at both.
    let value = |f: fn(f64) -> f64| if t <= 0.5 { f(t) } else { 1.0 - f(s) };
    let w = t * s;
    let q = 1.0 - 2.0 * t;
    match k {
        0 => [t, 1.0, 0.0, 0.0],
        1 => [value(|t| t * t * (3.0 - 2.0 * t)), 6.0 * w, 6.0 * q, -12.0],
        2 => [
            value(|t| t * t * t * (10.0 + t * (6.0 * t - 15.0))),
            30.0 * w * w,
            60.0 * w * q,
            60.0 * (q * q - 2.0 * w),
        ],
        _ => [
            value(|t| (t * t) * (t * t) * (35.0 + t * (t * (70.0 - 20.0 * t) - 84.0))),
            140.0 * w * w * w,
            420.0 * w * w * q,
            840.0 * w * (q * q - w),
        ],
    }
}

fn sine_squared(t: f64) -> [f64; 4] {
    let pi = std::f64::consts::PI;
    let (s, c) = (pi * t).sin_cos();
    let h = (0.5 * pi * t).sin();
    [h * h, 0.5 * pi * s, 0.5 * pi * pi * c, -0.5 * pi.powi(3) * s]
}

fn rational(t: f64) -> [f64; 4] {
    let d = recip([1.0 + t * t, 2.0 * t, 2.0, 0.0]);
    let x = mul([2.0 * t, 2.0, 0.0, 0.0], d);
    mul(x, x)
}

fn symmetric(k: usize, t: f64) -> [f64; 4] {
    let power = |x: [f64; 4]| (0..k).fold(x, |p, _| mul(p, x));
    let (a, b) = (power([t, 1.0, 0.0, 0.0]), power([1.0 - t, -1.0, 0.0, 0.0]));
    mul(a, recip([0, 1, 2, 3].map(|i| a[i] + b[i])))
}

/// `x² (3 − 2x)`: turns a blend that is flat of order 1 into one of order 3.
fn smooth(x: [f64; 4]) -> [f64; 4] {
    mul(mul(x, x), [3.0 - 2.0 * x[0], -2.0 * x[1], -2.0 * x[2], -2.0 * x[3]])
}

fn sub(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [0, 1, 2, 3].map(|i| a[i] - b[i])
}

/// Leibniz's rule.
fn mul(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0],
        a[1] * b[0] + a[0] * b[1],
        a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2],
        a[3] * b[0] + 3.0 * (a[2] * b[1] + a[1] * b[2]) + a[0] * b[3],
    ]
}

fn recip(a: [f64; 4]) -> [f64; 4] {
    let r = 1.0 / a[0];
    let d = -a[1] * r * r;
    let dd = -(a[2] * r + 2.0 * a[1] * d) * r;
    [r, d, dd, -(a[3] * r + 3.0 * (a[2] * d + a[1] * dd)) * r]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    use BlendFunction::*;

    #[track_caller]
    fn check(got: f64, want: f64) {
        assert!((got - want).abs() <= 1e-11 * (1.0 + want.abs()), "{got} ≠ {want}");
    }

    /// Specification §2.3, values at t = 0.3.
    #[test]
    fn the_table_at_three_tenths() {
        let table: [(BlendFunction, [f64; 4]); 6] = [
            (Polynomial(2), [0.16308, 1.323, 5.04, -15.6]),
            (Trigonometric(2), [0.202489339865014, 1.33984408755399, 2.17022890485406, -17.0118222896944]),
            (Rational(2), [0.192754797575962, 1.48694872045336, 4.70459033381711, -24.9645530781538]),
            (Trigonometric(3), [0.109929763317037, 1.24762500358315, 8.54311471415582, 2.05863441348298]),
            (Rational(3), [0.219796825256395, 2.13699587690155, 8.90863791812472, -73.8873054887882]),
            (
                SymmetricRational(2),
                [0.072972972972973, 0.966398831263696, 9.95005231674333, 66.0135388581877],
            ),
        ];
        for (blend, want) in table {
            let got = blend.jet(0.3);
            for i in 0..4 {
                check(got[i], want[i]);
            }
        }
        let s = printed_correction(0.3);
        let want = [0.00361803398874989, -0.0690431644751721, 0.730375051606544, 4.46951990636726];
        (0..4).for_each(|i| check(s[i], want[i]));
    }

    #[test]
    fn ends_are_exact_and_flat() {
        let families =
            [Family::Polynomial, Family::Trigonometric, Family::Rational, Family::SymmetricRational];
        for family in families {
            for k in 0..4 {
                let blend = family.flat(k);
                assert_eq!(blend.flat(), k);
                for t in [0.0, 1.0] {
                    let jet = blend.jet(t);
                    assert_eq!(jet[0], t);
                    assert!(jet[1..=k].iter().all(|&d| d == 0.0), "{blend:?} {jet:?}");
                    // What is set at the ends is what the formula tends to.
                    let near = blend.jet((t - 1e-9f64).abs());
                    (0..=k).for_each(|i| assert!((near[i] - jet[i]).abs() < 1e-5, "{blend:?} {i}"));
                }
                let values: Vec<f64> = (0..=2000).map(|i| blend.jet(f64::from(i) / 2000.0)[0]).collect();
                assert!(values.windows(2).all(|w| w[0] <= w[1]), "{blend:?} decreases");
            }
        }
    }

    /// Specification §2.3, end derivatives of the orders that are not flat.
    #[test]
    fn end_derivatives_of_the_table() {
        let second: [(BlendFunction, f64, f64); 3] = [
            (Polynomial(1), 6.0, -6.0),
            (Trigonometric(1), PI * PI / 2.0, -PI * PI / 2.0),
            (Rational(1), 8.0, -2.0),
        ];
        for (blend, a, b) in second {
            check(blend.jet(0.0)[2], a);
            check(blend.jet(1.0)[2], b);
        }
        let third: [(BlendFunction, f64, f64); 4] = [
            (Polynomial(2), 60.0, 60.0),
            (Trigonometric(2), 9.0 * PI * PI, 9.0 * PI * PI),
            (Rational(2), 78.0, 48.0),
            (Rational(1), 0.0, 6.0),
        ];
        for (blend, a, b) in third {
            check(blend.jet(0.0)[3], a);
            check(blend.jet(1.0)[3], b);
        }
    }

    /// Errata E1 and E2: the printed correction has `s″ = ±π²/2`; on the rational form it overshoots.
    #[test]
    fn printed_corrections() {
        check(printed_correction(0.0)[2], PI * PI / 2.0);
        check(printed_correction(1.0)[2], -PI * PI / 2.0);
        check(RationalAsPrinted.jet(0.934675)[0], 1.001988146591);
        check(RationalAsPrinted.jet(0.0)[2], 8.0 - PI * PI / 2.0);
        check(RationalAsPrinted.jet(1.0)[2], PI * PI / 2.0 - 2.0);
        check(TrigonometricScaled.jet(0.0)[2], PI * PI / 2.0 - 1.0);
        // E3: the rational form is not symmetric.
        check(Rational(1).jet(0.5)[0], 0.64);
    }
}
