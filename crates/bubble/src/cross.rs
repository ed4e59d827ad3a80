//! Hermite boundary data: cross derivatives of the height along an edge, of any order.
//!
//! First the tensors of a strip are projected onto the compatibility conditions, degree by degree: with `a = p′`,
//! `g = ĝ − (ĝ·a)/(a·a) a`, and `ψ_{k+1}` is the nearest form (in the norm of its symmetric tensor) to `ψ̂_{k+1}` with
//! `∂_a ψ_{k+1} = ∂ψ_k/∂t`. With the residual `R = ∂ψ_k/∂t − ∂_a ψ̂_{k+1}` and the linear form `ℓ(z) = z·a/(a·a)` the correction is
//!
//! `C = Σ_{i=0}^{k} (−1)^i/(i+1)! ℓ^{i+1} ∂_a^i R`,
//!
//! for `k = 1` the closed form of the specification's section 4. Then `F(z(s)) = 0` is solved for the height along
//! `z(s) = base(s) + h(s) N(s) − p`, order by order in the cross parameter `s`. docs/tensors.md has the derivation.

use crate::{
    MAX_ORDER,
    monomial::{self, TABLE},
    newton::horner,
    series::{self, Series},
    strip::{MOST, Strip, components},
};

/// Cross derivatives of orders 0 to `n`, as series along the edge.
pub(crate) type CrossData<const L: usize> = [Series<L>; MAX_ORDER + 1];

/// How a patch leaves an edge: coefficients of `s^j`, `j ≥ 1`, of its base and of N along the edge.
pub(crate) struct Leaving<const L: usize> {
    /// Base, by `j − 1`.
    pub(crate) base: [[Series<L>; 3]; MAX_ORDER],
    /// N, linear in `s`.
    pub(crate) normal: [Series<L>; 3],
}

/// Tensors of degree 1 to `MAX_ORDER` as series.
pub(crate) type Tensors<const L: usize> = [[Series<L>; MOST]; MAX_ORDER];

/// The projected tensors of `strip` about `t`; coefficients up to order `L − 1 − k` of degree `k` are good.
pub(crate) fn tensors<const N: usize, const L: usize>(strip: &Strip, t: f64) -> Tensors<L> {
    let mut psi: Tensors<L> = [[[0.0; L]; MOST]; MAX_ORDER];
    if N == 0 {
        return psi;
    }
    let a = strip.curve_series::<L>(t).map(|p| series::derivative(&p));
    let inverse = series::recip(&series::dot(&a, &a));
    let form = a.map(|a| series::mul(&a, &inverse));
    let raw = horner::<L, 3>(strip.level(1), t);
    let alpha = series::mul(&series::dot(&raw, &a), &inverse);
    for axis in 0..3 {
        psi[0][axis] = series::sub(&raw[axis], &series::mul(&alpha, &a[axis]));
    }
    for k in 1..N {
        let mut raw = [[0.0; L]; MOST];
        match k + 1 {
            2 => raw[..6].copy_from_slice(&horner::<L, 6>(strip.level(2), t)),
            3 => raw[..10].copy_from_slice(&horner::<L, 10>(strip.level(3), t)),
            _ => raw[..15].copy_from_slice(&horner::<L, 15>(strip.level(4), t)),
        }
        let mut residual = along(k + 1, &raw, &a);
        for entry in 0..components(k) {
            residual[entry] = series::sub(&series::derivative(&psi[k - 1][entry]), &residual[entry]);
        }
        correct(k, &mut raw, residual, &a, &form);
        psi[k] = raw;
    }
    psi
}

/// Adds `Σ_i (−1)^i/(i+1)! ℓ^{i+1} ∂_a^i R` to the form `raw` of degree `k + 1`.
fn correct<const L: usize>(
    k: usize,
    raw: &mut [Series<L>; MOST],
    mut residual: [Series<L>; MOST],
    a: &[Series<L>; 3],
    form: &[Series<L>; 3],
) {
    let mut power = [[0.0; L]; MOST];
    power[..3].copy_from_slice(form);
    let mut factor = 1.0;
    for i in 0..k + 1 {
        multiply_add(raw, factor, i + 1, &power, k - i, &residual);
        if i < k {
            residual = along(k - i, &residual, a);
            let mut next = [[0.0; L]; MOST];
            let mut linear = [[0.0; L]; MOST];
            linear[..3].copy_from_slice(form);
            multiply_add(&mut next, 1.0, i + 1, &power, 1, &linear);
            power = next;
            factor *= -1.0 / (i + 2) as f64;
        }
    }
}

/// `∂_a` of a form of degree `k ≥ 1`.
fn along<const L: usize>(k: usize, form: &[Series<L>; MOST], a: &[Series<L>; 3]) -> [Series<L>; MOST] {
    let mut out = [[0.0; L]; MOST];
    let (from, to) = (monomial::first(k), monomial::first(k - 1));
    for entry in 0..components(k - 1) {
        for s in 0..3 {
            let up = monomial::product(to + entry, 1 + s);
            let factor = f64::from(TABLE[up].exponents[s]);
            series::mul_add(&mut out[entry], &series::scale(&a[s], factor), &form[up - from]);
        }
    }
    out
}

/// `out += factor · x y` for forms of degrees `p` and `q`.
fn multiply_add<const L: usize>(
    out: &mut [Series<L>; MOST],
    factor: f64,
    p: usize,
    x: &[Series<L>; MOST],
    q: usize,
    y: &[Series<L>; MOST],
) {
    let (fx, fy, fo) = (monomial::first(p), monomial::first(q), monomial::first(p + q));
    for i in 0..components(p) {
        let scaled = series::scale(&x[i], factor);
        for j in 0..components(q) {
            series::mul_add(&mut out[monomial::product(fx + i, fy + j) - fo], &scaled, &y[j]);
        }
    }
}

/// Derivatives of order 0 to `N` of the height in the cross parameter, as series along the edge about `t` in its canonical
/// direction; coefficients up to order `L − 1 − N` are good.
pub(crate) fn cross<const N: usize, const L: usize>(
    strip: &Strip,
    t: f64,
    leaving: &Leaving<L>,
) -> CrossData<L> {
    let mut out = [[0.0; L]; MAX_ORDER + 1];
    [out[0]] = horner::<L, 1>(strip.level(0), t);
    if N == 0 {
        return out;
    }
    let psi = tensors::<N, L>(strip, t);
    let (value, delta) = (strip.normal(t), strip.normals()[1] - strip.normals()[0]);
    let normal: [Series<L>; 3] = std::array::from_fn(|axis| {
        let mut n = series::constant(value[axis]);
        n[1] = delta[axis];
        n
    });
    let gradient = [psi[0][0], psi[0][1], psi[0][2]];
    let inverse = series::recip(&series::dot(&gradient, &normal));
    // Coefficient of s^j of every monomial of z up to degree N.
    let mut powers = [[[0.0; L]; MAX_ORDER + 1]; monomial::count(MAX_ORDER)];
    let mut factorial = 1.0;
    let mut lower = out[0];
    for j in 1..N + 1 {
        let mut z: [Series<L>; 3] = std::array::from_fn(|axis| {
            series::add(&leaving.base[j - 1][axis], &series::mul(&lower, &leaving.normal[axis]))
        });
        let mut value = series::dot(&gradient, &z);
        for i in 4..monomial::count(j) {
            let m = TABLE[i];
            let mut sum = [0.0; L];
            for l in 1..j {
                series::mul_add(
                    &mut sum,
                    &powers[m.parent as usize][j - l],
                    &powers[1 + m.variable as usize][l],
                );
            }
            powers[i][j] = sum;
            let degree = m.exponents.iter().map(|&e| e as usize).sum::<usize>();
            series::mul_add(&mut value, &psi[degree - 1][i - monomial::first(degree)], &sum);
        }
        let c = series::scale(&series::mul(&value, &inverse), -1.0);
        for axis in 0..3 {
            series::mul_add(&mut z[axis], &c, &normal[axis]);
            powers[1 + axis][j] = z[axis];
        }
        factorial *= j as f64;
        out[j] = series::scale(&c, factorial);
        lower = c;
    }
    out
}
