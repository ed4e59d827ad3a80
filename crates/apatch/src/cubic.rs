//! Homogeneous cubics in three variables, with gradient and second derivatives, and their lower bounds on triangles.

use serde::{Deserialize, Serialize};

/// Value, gradient and second derivatives (order 00, 11, 22, 01, 02, 12) of a function of three variables.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Form2 {
    pub(crate) v: f64,
    pub(crate) g: [f64; 3],
    pub(crate) h: [f64; 6],
}

impl Form2 {
    /// The Hessian applied to two vectors.
    pub(crate) fn along(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let h = &self.h;
        a[0] * (h[0] * b[0] + h[3] * b[1] + h[4] * b[2])
            + a[1] * (h[3] * b[0] + h[1] * b[1] + h[5] * b[2])
            + a[2] * (h[4] * b[0] + h[5] * b[1] + h[2] * b[2])
    }
}

/// A cubic by its Bernstein coefficients `000, 111, 222, 001, 002, 110, 112, 220, 221, 012` (`001` belongs to `3 x₀² x₁`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cubic(pub(crate) [f64; 10]);

impl Cubic {
    /// The cubic that vanishes at the corners, with coefficients `e[a][b]` of `3 x_a² x_b` and `inner` of `6 x₀ x₁ x₂`.
    pub(crate) fn of_edges(e: &[[f64; 3]; 3], inner: f64) -> Self {
        Self([0.0, 0.0, 0.0, e[0][1], e[0][2], e[1][0], e[1][2], e[2][0], e[2][1], inner])
    }

    /// The polar form with one argument filled: coefficients 00, 11, 22, 01, 02, 12 of a quadratic form.
    #[inline]
    fn polar(&self, x: [f64; 3]) -> [f64; 6] {
        let c = &self.0;
        [
            c[0] * x[0] + c[3] * x[1] + c[4] * x[2],
            c[5] * x[0] + c[1] * x[1] + c[6] * x[2],
            c[7] * x[0] + c[8] * x[1] + c[2] * x[2],
            c[3] * x[0] + c[5] * x[1] + c[9] * x[2],
            c[4] * x[0] + c[9] * x[1] + c[7] * x[2],
            c[9] * x[0] + c[6] * x[1] + c[8] * x[2],
        ]
    }

    /// Value and gradient.
    #[inline]
    pub(crate) fn gradient(&self, x: [f64; 3]) -> (f64, [f64; 3]) {
        let line = apply(&self.polar(x), x);
        (dot(line, x), line.map(|g| 3.0 * g))
    }

    /// Value, gradient and second derivatives.
    pub(crate) fn second(&self, x: [f64; 3]) -> Form2 {
        let polar = self.polar(x);
        let line = apply(&polar, x);
        Form2 { v: dot(line, x), g: line.map(|g| 3.0 * g), h: polar.map(|s| 6.0 * s) }
    }

    /// Smallest Bernstein coefficient on the triangle with the given corners, after multiplication by `sign`.
    pub(crate) fn lower(&self, corners: &[[f64; 3]; 3], sign: f64) -> f64 {
        let mut least = f64::INFINITY;
        for (i, &p) in corners.iter().enumerate() {
            let polar = self.polar(p);
            for (j, &q) in corners.iter().enumerate().skip(i) {
                let line = apply(&polar, q);
                for &r in &corners[j..] {
                    least = least.min(sign * dot(line, r));
                }
            }
        }
        least
    }
}

/// The quadratic form with coefficients 00, 11, 22, 01, 02, 12 applied to one vector.
#[inline]
pub(crate) fn apply(s: &[f64; 6], x: [f64; 3]) -> [f64; 3] {
    [
        s[0] * x[0] + s[3] * x[1] + s[4] * x[2],
        s[3] * x[0] + s[1] * x[1] + s[5] * x[2],
        s[4] * x[0] + s[5] * x[1] + s[2] * x[2],
    ]
}

#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The quadratic form `Σ h_a x_a² + 2 (m₀ x₁x₂ + m₁ x₂x₀ + m₂ x₀x₁)` in the order of [`apply`].
#[inline]
pub(crate) fn quadratic(h: &[f64; 3], m: &[f64; 3]) -> [f64; 6] {
    [h[0], h[1], h[2], m[2], m[1], m[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn derivatives_match_differences(c in prop::array::uniform10(-1.0..1.0f64), x in prop::array::uniform3(-1.0..1.0f64)) {
            let cubic = Cubic(c);
            let form = cubic.second(x);
            prop_assert_eq!((form.v, form.g), cubic.gradient(x));
            let d = 1e-4;
            for i in 0..3 {
                let at = |s: f64| { let mut y = x; y[i] += s * d; cubic.second(y) };
                prop_assert!(((at(1.0).v - at(-1.0).v) / (2.0 * d) - form.g[i]).abs() < 1e-6);
                let mut unit = [0.0; 3];
                unit[i] = 1.0;
                for j in 0..3 {
                    let mut other = [0.0; 3];
                    other[j] = 1.0;
                    prop_assert!(((at(1.0).g[j] - at(-1.0).g[j]) / (2.0 * d) - form.along(unit, other)).abs() < 1e-6);
                }
            }
        }

        #[test]
        fn no_value_lies_below_the_smallest_coefficient(
            c in prop::array::uniform10(-1.0..1.0f64), w in prop::array::uniform3(0.0..1.0f64),
            corners in prop::array::uniform3(prop::array::uniform3(0.0..1.0f64)),
        ) {
            let cubic = Cubic(c);
            let sum = w[0] + w[1] + w[2] + 1e-9;
            let x = [0, 1, 2].map(|i| (0..3).map(|k| w[k] / sum * corners[k][i]).sum());
            prop_assert!(cubic.gradient(x).0 >= cubic.lower(&corners, 1.0) - 1e-12);
            prop_assert!(-cubic.gradient(x).0 >= cubic.lower(&corners, -1.0) - 1e-12);
        }
    }
}
