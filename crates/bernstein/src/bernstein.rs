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
    for n in 1..degree + 1 {
        let mut carry = 0.0;
        for b in &mut out[..n] {
            let next = t * *b;
            *b = carry + s * *b;
            carry = next;
        }
        out[n] = carry;
    }
}

/// Writes value and derivatives to order `D − 1` of every `B_i^n` at `t` into `out[0..=degree]`.
///
/// Values are the bits of [`values`].
///
/// # Panics
/// When `out` is shorter than `degree + 1`.
pub fn jets<const D: usize>(degree: usize, t: f64, out: &mut [[f64; D]]) {
    unrolled(degree, t, out);
}

/// [`jets`], to be inlined where the degree is a constant.
#[inline(always)]
pub(crate) fn unrolled<const D: usize>(degree: usize, t: f64, out: &mut [[f64; D]]) {
    if D == 0 {
        return;
    }
    let out = &mut out[..=degree];
    let top = (D - 1).min(degree);
    let s = 1.0 - t;
    out[0] = [0.0; D];
    out[0][0] = 1.0;
    // Column 0 climbs to degree n by convex combinations. Column d leaves it at degree n − d and climbs the rest by
    // differences, (B_i^n)′ = n (B_{i−1}^{n−1} − B_i^{n−1}); the factors n wait for the end, so that nothing is rounded twice.
    // (A half-open range unrolls, a closed one does not.)
    for n in 1..degree + 1 {
        let branch = degree + 1 - n;
        if branch <= top {
            out[..n].iter_mut().for_each(|b| b[branch] = b[0]);
        }
        let mut carry = [0.0; D];
        for b in &mut out[..n] {
            let next = t * b[0];
            b[0] = carry[0] + s * b[0];
            carry[0] = next;
            for d in 1..D {
                if d >= branch {
                    let next = b[d];
                    b[d] = carry[d] - next;
                    carry[d] = next;
                }
            }
        }
        out[n] = carry;
    }
    let mut factor = 1.0;
    for d in 1..D {
        factor *= (degree + 1).saturating_sub(d) as f64;
        for b in out.iter_mut() {
            b[d] = if d <= top { b[d] * factor } else { 0.0 };
        }
    }
}

/// The binomial coefficient `C(n, k)`, zero for `k > n`; exact below 2⁵³, correctly rounded to `n = 2 MAX_DEGREE`.
pub fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        0.0
    } else if n < ROWS {
        BINOMIAL[n][k]
    } else {
        (0..k.min(n - k)).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64)
    }
}

/// `C(n, 0) … C(n, n)`, `n ≤ 2 MAX_DEGREE`.
#[inline]
pub(crate) fn binomial_row(n: usize) -> &'static [f64] {
    &BINOMIAL[n][..=n]
}

/// `∫₀¹ B_i^m B_j^n dt = C(m, i) C(n, j) / (C(m + n, i + j) (m + n + 1))`; zero for `i > m` or `j > n`.
///
/// # References
/// R. T. Farouki, *The Bernstein polynomial basis: a centennial retrospective*, 2012, section 3.
pub fn product_integral(m: usize, i: usize, n: usize, j: usize) -> f64 {
    if i > m || j > n {
        return 0.0;
    }
    binomial(m, i) * binomial(n, j) / (binomial(m + n, i + j) * (m + n + 1) as f64)
}

const ROWS: usize = 2 * MAX_DEGREE + 1;

/// Pascal's triangle, as far as products of two bases reach; 64 bits hold `C(62, 31) ≈ 4.7e17` exactly.
static BINOMIAL: [[f64; ROWS]; ROWS] = {
    let mut exact = [[0_u64; ROWS]; ROWS];
    let mut rounded = [[0.0; ROWS]; ROWS];
    let mut n = 0;
    while n < ROWS {
        let mut k = 0;
        while k <= n {
            exact[n][k] = if k == 0 || k == n { 1 } else { exact[n - 1][k - 1] + exact[n - 1][k] };
            rounded[n][k] = exact[n][k] as f64;
            k += 1;
        }
        n += 1;
    }
    rounded
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_binomial_table_meets_known_values() {
        assert_eq!(binomial(0, 0), 1.0);
        assert_eq!(binomial(5, 2), 10.0);
        assert_eq!(binomial(31, 15), 300_540_195.0);
        assert_eq!(binomial(62, 31), 465_428_353_255_261_088.0);
        assert_eq!(binomial(3, 4), 0.0);
        assert_eq!(binomial(70, 2), 2415.0);
    }

    #[test]
    fn values_are_exact_at_both_ends() {
        for degree in 0..=MAX_DEGREE {
            let mut out = [0.0; MAX_DEGREE + 1];
            for (t, one) in [(0.0, 0), (1.0, degree)] {
                values(degree, t, &mut out);
                assert!((0..=degree).all(|i| out[i] == f64::from(u8::from(i == one))));
            }
        }
    }

    #[test]
    fn jets_carry_the_bits_of_values() {
        for degree in 0..=MAX_DEGREE {
            let (mut row, mut jet) = ([0.0; MAX_DEGREE + 1], [[f64::NAN; 4]; MAX_DEGREE + 1]);
            values(degree, 0.3, &mut row);
            jets(degree, 0.3, &mut jet);
            assert!((0..=degree).all(|i| row[i] == jet[i][0] && jet[i].iter().all(|x| x.is_finite())));
        }
    }

    #[test]
    fn integrals_of_products_are_the_known_rationals() {
        assert_eq!(product_integral(0, 0, 0, 0), 1.0);
        assert_eq!(product_integral(1, 0, 1, 0), 1.0 / 3.0);
        assert_eq!(product_integral(1, 0, 1, 1), 1.0 / 6.0);
        assert_eq!(product_integral(3, 1, 3, 2), 9.0 / 140.0);
        assert_eq!(product_integral(3, 4, 3, 2), 0.0);
    }
}
