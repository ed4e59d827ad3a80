//! Bends: curves added to edges, where a boundary curve cannot stay over the straight edge along the interpolated normal.
//!
//! A bend `D(t)` vanishes at both ends. A patch takes the bends of its sides into its base: on a triangle as the form
//! `Σ C(m, i) λ_a^{m−i} λ_b^i q_i` in the barycentric coordinates of the edge's ends, on a quad times `1 − x` across. Each vanishes on all other sides,
//! and its cross derivatives are polynomials, so that heights over bent bases meet strips just as those over plane ones.

use glam::{DVec2, DVec3};
use suture_surface::Jet2;

use crate::{
    half::Half,
    patch::BubblePatch,
    series::{Plane, Series},
};

/// The bend with derivatives `start` and `end`, each in the parameter that grows from its end: a cubic.
pub(crate) fn tangents(start: DVec3, end: DVec3) -> Vec<DVec3> {
    vec![DVec3::ZERO, start / 3.0, end / 3.0, DVec3::ZERO]
}

/// The bend with given Taylor coefficients at both ends, each in the parameter that grows from its end: Bernstein coefficients, as many as there
/// are Taylor coefficients.
pub(crate) fn hermite(data: [&[DVec3]; 2]) -> Vec<DVec3> {
    let m = data[0].len();
    let degree = 2 * m - 1;
    let mut out = vec![DVec3::ZERO; 2 * m];
    for i in 0..m {
        for k in 1..i + 1 {
            let c = binomial(i, k) / binomial(degree, k);
            out[i] += c * data[0][k];
            out[degree - i] += c * data[1][k];
        }
    }
    out
}

fn binomial(n: usize, k: usize) -> f64 {
    suture_bernstein::bernstein::binomial(n, k)
}

/// `D(t + δ)` as series in δ.
pub(crate) fn series<const L: usize>(bend: &[DVec3], t: f64) -> [Series<L>; 3] {
    let mut out = [[0.0; L]; 3];
    let Some(degree) = bend.len().checked_sub(1) else { return out };
    // Σ C(m, i) b^i a^{m−i} q_i by Horner's rule in a, powers of b kept.
    let mut power = [0.0; L];
    power[0] = 1.0;
    let times = |s: &mut Series<L>, c: f64, slope: f64| {
        for k in (1..L).rev() {
            s[k] = s[k] * c + s[k - 1] * slope;
        }
        s[0] *= c;
    };
    for (i, q) in bend.iter().enumerate() {
        let c = binomial(degree, i);
        for axis in 0..3 {
            times(&mut out[axis], 1.0 - t, -1.0);
            for k in 0..L {
                out[axis][k] += c * q[axis] * power[k];
            }
        }
        times(&mut power, t, 1.0);
    }
    out
}

/// Taylor coefficients of a bend at one end, in the parameter that grows from there.
pub(crate) fn taylor<const L: usize>(bend: &[DVec3], end: usize) -> [Series<L>; 3] {
    let mut out = series::<L>(bend, end as f64);
    if end == 1 {
        out.iter_mut().for_each(|s| s.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c));
    }
    out
}

/// `Σ C(m, i) a^{m−i} b^i q_i`.
fn form<const L: usize>(bend: &[DVec3], a: &Plane<L>, b: &Plane<L>) -> [Plane<L>; 3] {
    let mut out = [Plane::ZERO; 3];
    let Some(degree) = bend.len().checked_sub(1) else { return out };
    let mut power = Plane::linear(1.0, 0.0, 0.0);
    for (i, q) in bend.iter().enumerate() {
        let c = binomial(degree, i);
        for axis in 0..3 {
            out[axis] = out[axis].mul(a).add(&power.scale(c * q[axis]));
        }
        power = power.mul(b);
    }
    out
}

impl BubblePatch {
    /// Whether a side is bent.
    #[inline(always)]
    pub(crate) fn bent(&self) -> bool {
        self.bent
    }

    /// The sum of the bends of all sides; `coordinates` are barycentric ones, or `u`, `v` of a quad.
    fn bends<const L: usize>(&self, coordinates: [Plane<L>; 3]) -> [Plane<L>; 3] {
        let mut out = [Plane::ZERO; 3];
        for k in 0..self.count {
            let side = self.sides[k];
            let bend = self.strips[side.strip as usize].bend();
            let lean: &[DVec3] = self.leans.get(k).map_or(&[], Vec::as_slice);
            if bend.is_empty() && lean.is_empty() {
                continue;
            }
            let (from, to, fade, inward) = if self.count == 3 {
                (coordinates[k], coordinates[(k + 1) % 3], None, coordinates[(k + 2) % 3])
            } else {
                let one = Plane::linear(1.0, 0.0, 0.0);
                let minus = |x: &Plane<L>| one.add(&x.scale(-1.0));
                let [u, v, _] = coordinates;
                let (along, inward) = match k {
                    0 => (u, v),
                    1 => (v, minus(&u)),
                    2 => (minus(&u), minus(&v)),
                    _ => (minus(&v), u),
                };
                let fade = minus(&inward);
                (minus(&along), along, Some(fade), inward.mul(&fade).mul(&fade))
            };
            if !lean.is_empty() {
                let sum = form(lean, &from, &to);
                for axis in 0..3 {
                    out[axis] = out[axis].add(&sum[axis].mul(&inward));
                }
            }
            let sum = if side.reversed { form(bend, &to, &from) } else { form(bend, &from, &to) };
            for axis in 0..3 {
                let part = fade.as_ref().map_or(sum[axis], |f| sum[axis].mul(f));
                out[axis] = out[axis].add(&part);
            }
        }
        out
    }

    /// The bends about `at`, coefficients of `δu^i δv^j`.
    pub(crate) fn bend_taylor<const L: usize>(&self, at: DVec2) -> [Plane<L>; 3] {
        let (u, v) = (Plane::linear(at.x, 1.0, 0.0), Plane::linear(at.y, 0.0, 1.0));
        if self.count == 4 {
            return self.bends([u, v, Plane::ZERO]);
        }
        self.bends([Plane::linear(1.0 - at.x - at.y, -1.0, -1.0), u, v])
    }

    /// The jet of the bends.
    pub(crate) fn bend_jet(&self, at: DVec2) -> Jet2 {
        let d = self.bend_taylor::<3>(at);
        let c = |i: usize, j: usize| DVec3::new(d[0].0[i][j], d[1].0[i][j], d[2].0[i][j]);
        Jet2 { p: c(0, 0), du: c(1, 0), dv: c(0, 1), duu: 2.0 * c(2, 0), duv: c(1, 1), dvv: 2.0 * c(0, 2) }
    }

    /// The bends about corner `k` in its parameters towards the next and the previous corner.
    pub(crate) fn bend_at_corner(&self, k: usize) -> [Plane<9>; 3] {
        let (x, y) = (Plane::linear(0.0, 1.0, 0.0), Plane::linear(0.0, 0.0, 1.0));
        if self.count == 4 {
            let (one, minus) =
                (|p: Plane<9>| Plane::linear(1.0, 0.0, 0.0).add(&p), |p: Plane<9>| p.scale(-1.0));
            let (u, v) = match k {
                0 => (x, y),
                1 => (one(minus(y)), x),
                2 => (one(minus(x)), one(minus(y))),
                _ => (y, one(minus(x))),
            };
            return self.bends([u, v, Plane::ZERO]);
        }
        let mut b = [Plane::ZERO; 3];
        b[k] = Plane::linear(1.0, -1.0, -1.0);
        b[(k + 1) % 3] = x;
        b[(k + 2) % 3] = y;
        self.bends(b)
    }

    /// The bends off the edge of `half`: coefficients of `x^i δ^j`, `x` inward, δ along the half from `lambda`.
    pub(crate) fn bend_off<const L: usize>(&self, half: &Half, lambda: f64) -> [Plane<L>; 3] {
        let (x, along) = (Plane::linear(0.0, 1.0, 0.0), Plane::linear(lambda, 0.0, 1.0));
        if self.count == 4 {
            let minus = |p: Plane<L>| Plane::linear(1.0, 0.0, 0.0).add(&p.scale(-1.0));
            let (u, v) = match half.side {
                0 => (along, x),
                1 => (minus(x), along),
                2 => (minus(along), minus(x)),
                _ => (x, minus(along)),
            };
            return self.bends([u, v, Plane::ZERO]);
        }
        let mut b = [Plane::ZERO; 3];
        b[half.from] = Plane::linear(1.0 - lambda, -1.0, -1.0);
        b[half.to] = along;
        b[half.inward] = x;
        self.bends(b)
    }
}
