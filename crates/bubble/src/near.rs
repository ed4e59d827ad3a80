//! Heights close to a corner, where the halves that run to it are quotients of tiny numbers.
//!
//! With the distance `w = 1 − λ` from corner `k`, the two halves that run to it sum to `Σ_i w^i [H_{0,i}(q) A_i(w) + H_{0,i}(1 − q) B_i(w)]`,
//! `q = x/w`. Sorted by degree that is `Σ_d w^d G_d(q)` with polynomials `G_d` of degree `2n + 1`: what they have above degree `d` would be
//! a pole. It is zero, since the data of both edges come from one jet; in floating point it is rounding divided by powers of `w`. So expand
//! `A_i`, `B_i` about the corner and leave it away: `Σ_d Σ_{j ≤ d} G_{d,j} w^{d−j} x^j`, a polynomial. The other halves are smooth there.

use crate::{
    MAX_ORDER,
    cross::cross,
    half::{GRADIENT, Half},
    height::Corner,
    hermite::{Hermite, LENGTH},
    patch::BubblePatch,
    series::{Plane, Series},
};

/// Number of coefficients taken of the data: `|G_d|` falls like a power of the distance to the nearest pole of the data, which is a
/// twentieth of the edge on the worst strips.
const TERMS: usize = 14;

impl BubblePatch {
    /// The two halves that run to a corner, about a point close to it: coefficients in `u` and `v`.
    pub(crate) fn near<const N: usize, const L: usize>(&self, &Corner { k, x, y }: &Corner) -> Plane<L> {
        let hermite = Hermite::new(N);
        let mut g = [[0.0; LENGTH]; TERMS];
        for number in 0..self.halves() {
            let half = self.half(number);
            if half.to != k || self.weights(&half)[0] == 0.0 {
                continue;
            }
            // The coordinate x is inward for one of them, w − x for the other.
            let first = half.inward == (k + 1) % 3;
            let data = self.data_at_end::<N>(number, &half);
            for (i, e) in data.iter().enumerate().take(N + 1) {
                let basis = &hermite.basis[usize::from(!first)][i];
                let sign = if !first && i % 2 == 1 { -1.0 } else { 1.0 };
                for d in i..TERMS {
                    for j in 0..(2 * N + 2).min(d + 1) {
                        g[d][j] += sign * basis[j] * e[d - i];
                    }
                }
            }
        }
        let [gx, gy] = [GRADIENT[(k + 1) % 3], GRADIENT[(k + 2) % 3]];
        let w = Plane::<L>::linear(x + y, gx[0] + gy[0], gx[1] + gy[1]);
        let x = Plane::<L>::linear(x, gx[0], gx[1]);
        let mut sum = Plane::ZERO;
        for j in (0..2 * N + 2).rev() {
            let mut row = Plane::ZERO;
            for g in g[j..].iter().rev() {
                row = row.mul(&w);
                row.0[0][0] += g[j];
            }
            sum = sum.mul(&x).add(&row);
        }
        sum
    }

    /// `½ e_i − ⅙ Q_i` (or with the weights of the pairing) of a half about its end, in powers of `1 − λ`.
    fn data_at_end<const N: usize>(&self, number: usize, half: &Half) -> [Series<TERMS>; MAX_ORDER + 1] {
        let [data, twist] = self.weights(half);
        let t = if half.against { 0.0 } else { 1.0 };
        let mut e = cross::<N, TERMS>(self.strip_of(half), t, &self.leaving(half, 1.0));
        for e in e.iter_mut().take(N + 1) {
            for (k, c) in e.iter_mut().enumerate() {
                *c *= if !half.against && k % 2 == 1 { -data } else { data };
            }
        }
        if twist != 0.0 && !self.twists.is_empty() {
            let rows = &self.twists[number * (N + 1) * (2 * N + 2)..];
            for (e, row) in e.iter_mut().zip(rows.chunks_exact(2 * N + 2)).take(N + 1) {
                let mut q = [0.0; TERMS];
                for &c in row.iter().rev() {
                    for k in (1..TERMS).rev() {
                        q[k] -= q[k - 1];
                    }
                    q[0] += c;
                }
                (0..TERMS).for_each(|k| e[k] -= twist * q[k]);
            }
        }
        e
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use suture_bernstein::Jet2;

    use crate::{
        BubbleOptions, bubble_creased,
        height::{NEAR, TIP, tests::quad_and_triangle},
    };

    fn parts(j: &Jet2<f64>) -> [f64; 6] {
        [j.p, j.du, j.dv, j.duu, j.duv, j.dvv]
    }

    #[test]
    fn the_ways_to_the_height_agree_where_they_meet() {
        let mesh = quad_and_triangle();
        for tagged in [vec![], vec![[2, 3]]] {
            for order in 0..5 {
                let s =
                    bubble_creased(&mesh, &tagged, &BubbleOptions { order, ..Default::default() }).unwrap();
                for patch in &s.patches()[1..] {
                    let across = |r: f64| {
                        let [inside, outside] = [1.0 - 1e-12, 1.0 + 1e-12]
                            .map(|f| patch.height(DVec2::new(1.0 - r * f, 0.4 * r * f)));
                        [parts(&inside), parts(&outside)]
                    };
                    let [near, open] = across(NEAR);
                    assert!((0..6).all(|k| (near[k] - open[k]).abs() < 1e-9), "{order} {near:?} {open:?}");
                    let [tip, near] = across(TIP[order]);
                    // The tip's error in derivatives of order n is the power n + 1 of its size.
                    let known = [1, 3, 6, 6, 6][order];
                    assert!((0..known).all(|k| (tip[k] - near[k]).abs() < 1e-9), "{order} {tip:?} {near:?}");
                }
            }
        }
    }
}
