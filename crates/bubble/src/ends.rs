//! What the implicits at the ends of an edge say along its boundary curve.

use glam::DVec3;

use crate::{
    MAX_ORDER,
    implicit::Implicit,
    monomial::{self, TABLE},
    series::Series,
    strip::MOST,
};

/// `t e` as a series.
pub(crate) fn line_base<const L: usize>(e: DVec3) -> [Series<L>; 3] {
    std::array::from_fn(|axis| {
        let mut out = [0.0; L];
        if L > 1 {
            out[1] = e[axis];
        }
        out
    })
}

/// Solves `f(base(t) + h(t) (n + t Δ)) = 0` for `h` order by order and writes the tensors of `f` along that curve.
///
/// With the powers of the curve kept, the coefficient of order `k` of every term of degree two or more depends on lower orders of
/// `h` only: `h_k = −[t^k] f(…)/|n|²`, linear in every step.
pub(crate) fn end_taylor<const L: usize>(
    order: usize,
    f: &Implicit,
    base: &[Series<L>; 3],
    n: DVec3,
    delta: DVec3,
    tensors: &mut [[Series<L>; MOST]; MAX_ORDER],
    scratch: &mut Vec<f64>,
) -> Series<L> {
    let c = f.coefficients();
    // Powers above t^(L−1) do not matter, and a monomial of degree d begins with t^d.
    let used = monomial::count(f.degree().min(L - 1)).min(c.len());
    scratch.clear();
    scratch.resize(used * L, 0.0);
    let (powers, _) = scratch.as_chunks_mut::<L>();
    powers[0][0] = 1.0;
    let gradient = f.gradient();
    let inverse = -1.0 / gradient.dot(n);
    let mut h = [0.0; L];
    for k in 1..L {
        let mut p = [0.0; 3];
        for axis in 0..3 {
            p[axis] = base[axis][k] + h[k - 1] * delta[axis];
        }
        let mut value = gradient.dot(DVec3::from_array(p));
        for i in 4..used {
            let m = TABLE[i];
            let [parent, variable] = [m.parent as usize, 1 + m.variable as usize];
            let mut sum = 0.0;
            for j in 1..k {
                sum += powers[parent][k - j] * powers[variable][j];
            }
            powers[i][k] = sum;
            value += c[i] * sum;
        }
        h[k] = value * inverse;
        for axis in 0..3 {
            powers[1 + axis][k] = p[axis] + h[k] * n[axis];
        }
    }
    expand(order, c, powers, tensors);
    h
}

/// The coefficients of `z^β` in `f(p(t) + z)`, `1 ≤ |β| ≤ order`, from the powers of `p`.
pub(crate) fn expand<const L: usize>(
    order: usize,
    c: &[f64],
    powers: &[[f64; L]],
    tensors: &mut [[Series<L>; MOST]; MAX_ORDER],
) {
    for (alpha, &c) in c.iter().enumerate().skip(1) {
        if c == 0.0 {
            continue;
        }
        let exponents = TABLE[alpha].exponents.map(usize::from);
        let total: usize = exponents.iter().sum();
        for beta in 1..monomial::count(order.min(total)) {
            let b = TABLE[beta].exponents.map(usize::from);
            if (0..3).any(|s| b[s] > exponents[s]) {
                continue;
            }
            let rest = monomial::index(exponents[0] - b[0], exponents[1] - b[1], exponents[2] - b[2]);
            let Some(power) = powers.get(rest) else { continue };
            let choose = CHOOSE[exponents[0]][b[0]] * CHOOSE[exponents[1]][b[1]] * CHOOSE[exponents[2]][b[2]];
            let degree = b[0] + b[1] + b[2];
            let entry = &mut tensors[degree - 1][beta - monomial::first(degree)];
            for k in 0..L {
                entry[k] += c * choose * power[k];
            }
        }
    }
}

/// Binomial coefficients up to the largest degree of an implicit.
pub(crate) const CHOOSE: [[f64; 9]; 9] = {
    let mut out = [[0.0; 9]; 9];
    let mut n = 0;
    while n < 9 {
        out[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            out[n][k] = out[n - 1][k - 1] + out[n - 1][k];
            k += 1;
        }
        n += 1;
    }
    out
};
