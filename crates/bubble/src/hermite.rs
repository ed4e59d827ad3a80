//! Hermite polynomials of degree `2n + 1`, and the operators on them that the Gordon–Coons construction needs.

use crate::{MAX_ORDER, ends::CHOOSE};

/// Number of coefficients of the polynomials of the largest order.
pub(crate) const LENGTH: usize = 2 * MAX_ORDER + 2;

/// Coefficients of `1, t, t², …`.
pub(crate) type Polynomial = [f64; LENGTH];

/// `H_{k,i}` of one order as polynomials: the `i`-th derivative is 1 at `t = k`, all others up to `n` vanish at both ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hermite {
    /// By end, then by `i`.
    pub(crate) basis: [[Polynomial; MAX_ORDER + 1]; 2],
    /// `∂_u^l [(1 − u)^i H(v/(1 − u))]` at `u = 0` as polynomials in `v`, by `l`, then as `basis`.
    pub(crate) phi: [[[Polynomial; MAX_ORDER + 1]; 2]; MAX_ORDER + 1],
}

impl Hermite {
    pub(crate) fn new(order: usize) -> Self {
        let n = order.min(MAX_ORDER);
        let mut basis = [[[0.0; LENGTH]; MAX_ORDER + 1]; 2];
        for i in 0..n + 1 {
            // H_{0,i} = (1 − t)^{n+1} tⁱ/i! Σ_{k ≤ n−i} C(n+k, k) tᵏ, and H_{1,i}(t) = (−1)ⁱ H_{0,i}(1 − t).
            let mut at0 = [0.0; LENGTH];
            for k in 0..n - i + 1 {
                for l in 0..n + 2 {
                    let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
                    at0[i + k + l] += sign * CHOOSE[n + k][k] * CHOOSE[n + 1][l] / factorial(i);
                }
            }
            let mut at1 = [0.0; LENGTH];
            for (p, &c) in at0.iter().enumerate() {
                for q in 0..p + 1 {
                    let sign = if (q + i) % 2 == 0 { 1.0 } else { -1.0 };
                    at1[q] += sign * c * binomial(p, q);
                }
            }
            basis[0][i] = at0;
            basis[1][i] = at1;
        }
        // On v^q the operator multiplies by (−1)^l (i − q)(i − q − 1) … (i − q − l + 1).
        let mut phi = [basis; MAX_ORDER + 1];
        for l in 1..MAX_ORDER + 1 {
            phi[l] = phi[l - 1];
            for at_end in &mut phi[l] {
                for (i, p) in at_end.iter_mut().enumerate() {
                    for (q, c) in p.iter_mut().enumerate() {
                        *c *= (q + l - 1) as f64 - i as f64;
                    }
                }
            }
        }
        Self { basis, phi }
    }
}

pub(crate) fn factorial(k: usize) -> f64 {
    (1..k + 1).map(|i| i as f64).product()
}

pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    suture_bernstein::bernstein::binomial(n, k)
}

/// Value and first two derivatives of `H_{0,i}` at `r`, `i = 0..=N`; `q = 1 − r` is passed in for its digits near 0.
#[inline(always)]
pub(crate) fn rising<const N: usize>(r: f64, q: f64) -> [[f64; 3]; MAX_ORDER + 1] {
    let mut out = [[0.0; 3]; MAX_ORDER + 1];
    for (i, out) in out.iter_mut().enumerate().take(N + 1) {
        // P = rⁱ/i! Σ_k C(N+k, k) rᵏ times q^{N+1}.
        let mut p = [0.0; 3];
        for k in (0..N - i + 1).rev() {
            p = [p[0] * r + CHOOSE[N + k][k], p[1] * r + p[0], p[2] * r + 2.0 * p[1]];
        }
        for l in 1..i + 1 {
            p = [p[0] * r, p[1] * r + p[0], p[2] * r + 2.0 * p[1]].map(|x| x / l as f64);
        }
        // q^{N+1} and its derivatives; no negative power where N = 0.
        let low = if N == 0 { 0.0 } else { q.powi(N as i32 - 1) };
        let (d0, d1, d2) =
            (q.powi(N as i32 + 1), -((N + 1) as f64) * q.powi(N as i32), ((N + 1) * N) as f64 * low);
        *out = [p[0] * d0, p[1] * d0 + p[0] * d1, p[2] * d0 + 2.0 * p[1] * d1 + p[0] * d2];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn derivatives(p: &Polynomial, t: f64) -> Vec<f64> {
        // By repeated differentiation of the coefficients.
        let mut c = p.to_vec();
        let mut out = Vec::new();
        for _ in 0..LENGTH {
            out.push(c.iter().rev().fold(0.0, |sum, &c| sum * t + c));
            c = c.iter().enumerate().skip(1).map(|(k, &c)| k as f64 * c).collect();
        }
        out
    }

    #[test]
    fn the_basis_is_dual_to_end_derivatives() {
        for n in 0..=MAX_ORDER {
            let h = Hermite::new(n);
            for end in 0..2 {
                for i in 0..=n {
                    for at in 0..2 {
                        let d = derivatives(&h.basis[end][i], at as f64);
                        for j in 0..=n {
                            let want = f64::from(u8::from(i == j && end == at));
                            assert!((d[j] - want).abs() < 1e-9, "n {n} H_{end},{i} at {at}, {j}: {}", d[j]);
                        }
                    }
                }
            }
        }
    }

    fn check_rising<const N: usize>() {
        let h = Hermite::new(N);
        for r in [0.0, 0.1, 0.45, 0.8, 1.0] {
            let got = rising::<N>(r, 1.0 - r);
            for i in 0..=N {
                let want = derivatives(&h.basis[0][i], r);
                for d in 0..3 {
                    assert!((got[i][d] - want[d]).abs() < 1e-10, "n {N} H_0,{i} at {r}, {d}");
                }
            }
        }
    }

    #[test]
    fn closed_forms_agree_with_the_polynomials() {
        check_rising::<0>();
        check_rising::<1>();
        check_rising::<2>();
        check_rising::<3>();
        check_rising::<4>();
    }
}
