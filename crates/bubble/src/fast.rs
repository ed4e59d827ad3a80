//! Orders 0 to 2 at speed: what [`crate::cross`] does in general, unrolled for second-order jets, two halves at a time.
//!
//! For order 2 the projected Hessian is never formed: with `β = (a·B)/(a·a)` and `B⊥ = B − β a` the closed form of the projection gives
//! `Bᵀ H B = B⊥ᵀ Ĥ B⊥ + β g′·(2 B − β a)`.

use std::ops::{Add, Mul, Neg, Sub};

use crate::strip::Strip;

/// Numbers side by side: one, or one for each of two halves. `FMA`: products and sums are rounded once, for machines that do so at no cost.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<const K: usize, const FMA: bool>(pub(crate) [f64; K]);

/// What the formulas need of a number.
pub(crate) trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn splat(x: f64) -> Self;
    fn recip(self) -> Self;
    /// `self · b + c`.
    fn mul_add(self, b: Self, c: Self) -> Self;
}

impl<const K: usize, const FMA: bool> Lane for Lanes<K, FMA> {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; K])
    }

    #[inline(always)]
    fn recip(self) -> Self {
        Self(self.0.map(|x| 1.0 / x))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(std::array::from_fn(|k| {
            if FMA { self.0[k].mul_add(b.0[k], c.0[k]) } else { self.0[k] * b.0[k] + c.0[k] }
        }))
    }
}

macro_rules! by_lane {
    ($trait:ident, $name:ident, $op:tt) => {
        impl<const K: usize, const FMA: bool> $trait for Lanes<K, FMA> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, o: Self) -> Self {
                Self(std::array::from_fn(|k| self.0[k] $op o.0[k]))
            }
        }
    };
}
by_lane!(Add, add, +);
by_lane!(Sub, sub, -);
by_lane!(Mul, mul, *);

impl<const K: usize, const FMA: bool> Neg for Lanes<K, FMA> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

/// How halves leave their edge: value and slope in the canonical parameter of the directions of base and N.
#[derive(Clone, Copy)]
pub(crate) struct Directions<T> {
    pub(crate) base: [T; 3],
    pub(crate) base_slope: [T; 3],
    pub(crate) normal: [T; 3],
    pub(crate) normal_slope: [T; 3],
}

#[inline(always)]
fn dot<T: Lane>(a: &[T; 3], b: &[T; 3]) -> T {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Coefficients of order 0 to 2 of the product of two vectors of series.
#[inline(always)]
fn products<T: Lane>(a: &[[T; 3]; 3], b: &[[T; 3]; 3]) -> [T; 3] {
    let add = |a: &[T; 3], b: &[T; 3], c: T| a[2].mul_add(b[2], a[1].mul_add(b[1], a[0].mul_add(b[0], c)));
    [
        dot(&a[0], &b[0]),
        add(&a[0], &b[1], dot(&a[1], &b[0])),
        add(&a[0], &b[2], add(&a[1], &b[1], dot(&a[2], &b[0]))),
    ]
}

#[inline(always)]
fn axpy<T: Lane>(a: &[T; 3], c: T, b: &[T; 3]) -> [T; 3] {
    [c.mul_add(b[0], a[0]), c.mul_add(b[1], a[1]), c.mul_add(b[2], a[2])]
}

#[inline(always)]
fn times<T: Lane>(c: T, b: &[T; 3]) -> [T; 3] {
    [c * b[0], c * b[1], c * b[2]]
}

/// The polynomials of a level as series of length `L`, entries inside.
#[inline(always)]
fn horner<T: Lane, const L: usize, const C: usize>(c: &[f64], t: T, s: T) -> [[T; C]; L] {
    let zero = T::splat(0.0);
    let mut out = [[zero; C]; L];
    let (pairs, _) = c.as_chunks::<C>();
    // Coefficients come in pairs: odd ones belong to the node 1, even ones to 0. Three entries at a time fit into registers.
    let mut first = 0;
    while first < C {
        let width = if C - first < 3 { C - first } else { 3 };
        let mut acc = [[zero; 3]; L];
        let mut i = pairs.len();
        while i >= 2 {
            for (row, x) in [(&pairs[i - 1], s), (&pairs[i - 2], t)] {
                for e in 0..width {
                    for k in (1..L).rev() {
                        acc[k][e] = acc[k][e].mul_add(x, acc[k - 1][e]);
                    }
                    acc[0][e] = acc[0][e].mul_add(x, T::splat(row[first + e]));
                }
            }
            i -= 2;
        }
        for k in 0..L {
            for e in 0..width {
                out[k][first + e] = acc[k][e];
            }
        }
        first += 3;
    }
    out
}

/// `−a/b` as series.
#[inline(always)]
fn minus_quotient<T: Lane>(a: &[T; 3], b: &[T; 3], inverse: T) -> [T; 3] {
    let x0 = -(a[0] * inverse);
    let x1 = -(x0.mul_add(b[1], a[1]) * inverse);
    let x2 = -(x1.mul_add(b[1], x0.mul_add(b[2], a[2])) * inverse);
    [x0, x1, x2]
}

/// Cross derivatives of order 0 to `N ≤ 2` with their Taylor coefficients of order 0 to 2 along the edge, in its canonical direction.
/// `SKEW` says whether the directions have slopes.
#[inline(always)]
pub(crate) fn cross<T: Lane, const N: usize, const SKEW: bool>(
    strip: &Strip,
    t: T,
    d: &Directions<T>,
) -> [[T; 3]; 3] {
    let zero = T::splat(0.0);
    let two = T::splat(2.0);
    let s = t - T::splat(1.0);
    let mut out = [[zero; 3]; 3];
    if N == 0 {
        let h = horner::<T, 3, 1>(strip.level(0), t, s);
        out[0] = [h[0][0], h[1][0], h[2][0]];
        return out;
    }
    let h = horner::<T, 5, 1>(strip.level(0), t, s);
    let h = [h[0][0], h[1][0], h[2][0], h[3][0], h[4][0]];
    out[0] = [h[0], h[1], h[2]];
    let ([p, q], [m, n]) = (strip.ends(), strip.normals());
    let edge = (q - p).to_array().map(T::splat);
    let delta = (n - m).to_array().map(T::splat);
    let start = m.to_array().map(T::splat);
    let end = n.to_array().map(T::splat);
    // As the general code does: exact at both ends.
    let normal: [T; 3] = std::array::from_fn(|e| start[e] * -s + end[e] * t);

    // a = p′ as a series.
    let a0 = axpy(&axpy(&edge, h[1], &normal), h[0], &delta);
    let a1 = times(two, &axpy(&times(h[2], &normal), h[1], &delta));
    let a2 = times(T::splat(3.0), &axpy(&times(h[3], &normal), h[2], &delta));
    let raw = horner::<T, 4, 3>(strip.level(1), t, s);
    let aa = [dot(&a0, &a0), two * dot(&a0, &a1), two * dot(&a0, &a2) + dot(&a1, &a1)];
    let inverse = aa[0].recip();
    let ga = products(&[raw[0], raw[1], raw[2]], &[a0, a1, a2]);
    let alpha = minus_quotient(&ga, &aa, inverse);
    let g0 = axpy(&raw[0], alpha[0], &a0);
    let g1 = axpy(&axpy(&raw[1], alpha[0], &a1), alpha[1], &a0);
    let g2 = axpy(&axpy(&axpy(&raw[2], alpha[0], &a2), alpha[1], &a1), alpha[2], &a0);

    let denominator =
        [dot(&g0, &normal), dot(&g1, &normal) + dot(&g0, &delta), dot(&g2, &normal) + dot(&g1, &delta)];
    let below = denominator[0].recip();
    // Base and h̃ times N, in the cross direction.
    let mut m0 = axpy(&d.base, h[0], &d.normal);
    let mut m1 = times(h[1], &d.normal);
    let mut m2 = times(h[2], &d.normal);
    if SKEW {
        m1 = axpy(&axpy(&m1, h[0], &d.normal_slope), T::splat(1.0), &d.base_slope);
        m2 = axpy(&m2, h[1], &d.normal_slope);
    }
    let above = products(&[g0, g1, g2], &[m0, m1, m2]);
    let c = minus_quotient(&above, &denominator, below);
    out[1] = c;
    if N == 1 {
        return out;
    }

    // Third-order coefficients of a and g, for g′.
    let a3 = times(T::splat(4.0), &axpy(&times(h[4], &normal), h[3], &delta));
    let aa3 = two * (dot(&a0, &a3) + dot(&a1, &a2));
    let ga3 = dot(&raw[0], &a3) + dot(&raw[1], &a2) + dot(&raw[2], &a1) + dot(&raw[3], &a0);
    let alpha3 = -((ga3 + alpha[0] * aa3 + alpha[1] * aa[2] + alpha[2] * aa[1]) * inverse);
    let g3 = axpy(&axpy(&axpy(&axpy(&raw[3], alpha[0], &a3), alpha[1], &a2), alpha[2], &a1), alpha3, &a0);
    let dg = [g1, times(two, &g2), times(T::splat(3.0), &g3)];

    // B_d.
    m2 = axpy(&axpy(&m2, c[2], &normal), c[1], &delta);
    m1 = axpy(&axpy(&m1, c[1], &normal), c[0], &delta);
    m0 = axpy(&m0, c[0], &normal);
    let ab = products(&[a0, a1, a2], &[m0, m1, m2]);
    let beta = minus_quotient(&ab, &aa, inverse);
    let along = [
        times(beta[0], &a0),
        axpy(&times(beta[0], &a1), beta[1], &a0),
        axpy(&axpy(&times(beta[0], &a2), beta[1], &a1), beta[2], &a0),
    ];
    let b = [m0, m1, m2];
    let across: [[T; 3]; 3] = std::array::from_fn(|k| std::array::from_fn(|e| b[k][e] + along[k][e]));
    // β has the sign of −(a·B): 2 B − β a becomes B + across.
    let twice: [[T; 3]; 3] = std::array::from_fn(|k| std::array::from_fn(|e| b[k][e] + across[k][e]));
    let turn = products(&dg, &twice);

    // Half the Hessian's form on B⊥, with the products of its coordinates as series.
    let half = horner::<T, 3, 6>(strip.level(2), t, s);
    let mut bend = [zero; 3];
    for (entry, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
        let (x, y) = ([across[0][i], across[1][i], across[2][i]], [across[0][j], across[1][j], across[2][j]]);
        let product = if i == j {
            [x[0] * x[0], two * (x[0] * x[1]), two.mul_add(x[0] * x[2], x[1] * x[1])]
        } else {
            [
                x[0] * y[0],
                x[0].mul_add(y[1], x[1] * y[0]),
                x[0].mul_add(y[2], x[1].mul_add(y[1], x[2] * y[0])),
            ]
        };
        let [f0, f1, f2] = [half[0][entry], half[1][entry], half[2][entry]];
        bend[0] = f0.mul_add(product[0], bend[0]);
        bend[1] = f1.mul_add(product[0], f0.mul_add(product[1], bend[1]));
        bend[2] = f2.mul_add(product[0], f1.mul_add(product[1], f0.mul_add(product[2], bend[2])));
    }
    // g·N_d.
    let mut lean = [dot(&g0, &d.normal), dot(&g1, &d.normal), dot(&g2, &d.normal)];
    if SKEW {
        lean[1] = lean[1] + dot(&g0, &d.normal_slope);
        lean[2] = lean[2] + dot(&g1, &d.normal_slope);
    }
    let above = [
        two * (bend[0] + c[0] * lean[0]) - beta[0] * turn[0],
        two * (bend[1] + c[0] * lean[1] + c[1] * lean[0]) - beta[0] * turn[1] - beta[1] * turn[0],
        two * (bend[2] + c[0] * lean[2] + c[1] * lean[1] + c[2] * lean[0])
            - beta[0] * turn[2]
            - beta[1] * turn[1]
            - beta[2] * turn[0],
    ];
    out[2] = minus_quotient(&above, &denominator, below);
    out
}

/// Value and first two derivatives of `H_{0,i}` at `r`, `i ≤ N ≤ 2`; `q = 1 − r`.
#[inline(always)]
pub(crate) fn rising<T: Lane, const N: usize>(r: T, q: T) -> [[T; 3]; 3] {
    let x = T::splat;
    let mut out = [[x(0.0); 3]; 3];
    match N {
        0 => out[0] = [q, x(-1.0), x(0.0)],
        1 => {
            out[0] = [q * q * (x(1.0) + x(2.0) * r), x(-6.0) * r * q, x(12.0) * r - x(6.0)];
            out[1] = [q * q * r, q * (x(1.0) - x(3.0) * r), x(6.0) * r - x(4.0)];
        }
        _ => {
            let (q2, rq) = (q * q, r * q);
            let q3 = q2 * q;
            out[0] = [
                q3 * (x(1.0) + r * (x(3.0) + x(6.0) * r)),
                x(-30.0) * (rq * rq),
                x(60.0) * rq * (x(2.0) * r - x(1.0)),
            ];
            out[1] = [
                r * q3 * (x(1.0) + x(3.0) * r),
                q2 * (x(1.0) + r * (x(2.0) - x(15.0) * r)),
                rq * (x(60.0) * r - x(36.0)),
            ];
            out[2] = [
                x(0.5) * (r * r * q3),
                x(0.5) * r * q2 * (x(2.0) - x(5.0) * r),
                q * (x(1.0) + r * (x(10.0) * r - x(8.0))),
            ];
        }
    }
    out
}

/// `Σ_i w^i H_{0,i}(x/w) E_i(λ)` with `w = 1 − λ` (`SQUARE`: with `w = 1` throughout): value, `∂_x`, `∂_λ`, `∂_xx`, `∂_xλ`, `∂_λλ`, from `E_i`
/// with two derivatives.
#[inline(always)]
pub(crate) fn blend<T: Lane, const N: usize, const SQUARE: bool>(x: T, w: T, e: &[[T; 3]; 3]) -> [T; 6] {
    let zero = T::splat(0.0);
    let mut f = [zero; 6];
    if SQUARE {
        let basis = rising::<T, N>(x, T::splat(1.0) - x);
        for i in 0..N + 1 {
            let ([h, d, dd], [e0, e1, e2]) = (basis[i], e[i]);
            f = [f[0] + h * e0, f[1] + d * e0, f[2] + h * e1, f[3] + dd * e0, f[4] + d * e1, f[5] + h * e2];
        }
        return f;
    }
    let inverse = w.recip();
    let r = x * inverse;
    let basis = rising::<T, N>(r, (w - x) * inverse);
    // w^(i−2), w^(i−1), w^i.
    let mut scale = [inverse * inverse, inverse, T::splat(1.0)];
    for i in 0..N + 1 {
        let [h, d, dd] = basis[i];
        let (order, less) = (T::splat(i as f64), T::splat(i as f64 - 1.0));
        let g = scale[2] * h;
        let (gx, gw) = (scale[1] * d, scale[1] * (order * h - r * d));
        let gxx = scale[0] * dd;
        let gxw = scale[0] * (less * d - r * dd);
        let gww = scale[0] * (less * (order * h - T::splat(2.0) * r * d) + r * r * dd);
        let [e0, e1, e2] = e[i];
        f[0] = g.mul_add(e0, f[0]);
        f[1] = gx.mul_add(e0, f[1]);
        f[2] = g.mul_add(e1, (-gw).mul_add(e0, f[2]));
        f[3] = gxx.mul_add(e0, f[3]);
        f[4] = gx.mul_add(e1, (-gxw).mul_add(e0, f[4]));
        f[5] = g.mul_add(e2, (T::splat(-2.0) * gw).mul_add(e1, gww.mul_add(e0, f[5])));
        scale = [scale[1], scale[2], scale[2] * w];
    }
    f
}
