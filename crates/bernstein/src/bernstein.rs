//! The Bernstein basis `B_i^n(t) = C(n, i) tⁱ (1 − t)ⁿ⁻ⁱ` on `[0, 1]`.

use crate::MAX_DEGREE;

/// Writes `B_0^n(t) … B_n^n(t)` into `out[0..=degree]`.
///
/// By the triangle of convex combinations: stable for `t` in `[0, 1]`, exact at both ends.
///
/// # Panics
/// When `out` is shorter than `degree + 1`.
pub fn values(degree: usize, t: f64, out: &mut [f64]) {
    let s = 1.0 - t;
    out[0] = 1.0;
    for n in 1..=degree {
        let mut carry = 0.0;
        for i in 0..n {
            let b = out[i];
            out[i] = carry + s * b;
            carry = t * b;
        }
        out[n] = carry;
    }
}

/// Writes value and derivatives to order `D − 1` of every `B_i^n` at `t` into `out[0..=degree]`.
///
/// # Panics
/// When `degree > MAX_DEGREE` or `out` is shorter than `degree + 1`.
pub fn jets<const D: usize>(degree: usize, t: f64, out: &mut [[f64; D]]) {
    let mut row = [0.0; MAX_DEGREE + 1];
    for d in 0..D {
        if d > degree {
            out[..=degree].iter_mut().for_each(|b| b[d] = 0.0);
            continue;
        }
        // d-th derivative = n!/(n−d)! × d-fold backward difference of the basis of degree n − d.
        values(degree - d, t, &mut row);
        let mut factor = 1.0;
        for k in 0..d {
            let n = degree - d + k + 1;
            factor *= n as f64;
            row[n] = row[n - 1];
            for i in (1..n).rev() {
                row[i] = row[i - 1] - row[i];
            }
            row[0] = -row[0];
        }
        for i in 0..=degree {
            out[i][d] = factor * row[i];
        }
    }
}
