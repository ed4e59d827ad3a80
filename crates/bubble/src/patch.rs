//! The patch over a triangle or quad: `B = L + h N`.
//!
//! The height `h` interpolates the Hermite data of all edges by Gordon and Coons' construction. On a triangle every ordered pairing
//! `P_i ⊕ P_j` of the three side operators does; the mean of the six is a sum of six *halves*, each of one edge seen along the lines of
//! constant barycentric coordinate of one of its ends:
//!
//! `h = Σ Σ_i w^i H_{0,i}(x/w) [½ e_i(λ) − ⅙ Q_i(λ)]`, `w = 1 − λ`,
//!
//! with the cross derivatives `e_i` of the edge and the polynomials `Q_i` that repair the edges beside it. On a quad there are four
//! halves, one per edge, with weights 1 and ½ and `w = 1`.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, SplinePool};

use crate::{
    MAX_ORDER,
    corner::{CornerFrame, corner_jet, plane_count, plane_index},
    cross::{CrossData, Leaving, cross},
    fast::{self, Directions, Lane, Pair},
    hermite::{Hermite, LENGTH, Polynomial, binomial, factorial, rising},
    implicit::Implicit,
    series::{self, Plane},
    strip::Strip,
};

/// Which of the interpolants of the same boundary data a triangular patch is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Pairing {
    /// The mean of the six ordered pairings: independent of the order of the corners and of orientation.
    #[default]
    Mean,
    /// `P₁ ⊕ P₂` with the corners taken in this order (a permutation of 0, 1, 2).
    Single([u8; 3]),
}

impl Pairing {
    pub(crate) fn valid(&self) -> bool {
        match self {
            Self::Mean => true,
            Self::Single(order) => (0..3).all(|k| order.contains(&k)),
        }
    }
}

/// A patch over a face.
#[derive(Clone, Debug)]
pub struct BubblePatch {
    pub(crate) strips: Arc<Vec<Strip>>,
    pub(crate) sides: [Side; 4],
    pub(crate) count: usize,
    pub(crate) order: usize,
    pub(crate) pairing: Pairing,
    pub(crate) corners: [DVec3; 4],
    pub(crate) normals: [DVec3; 4],
    /// Coefficients of `h` about every corner, in the parameters towards the next and the previous corner.
    pub(crate) jets: Vec<f64>,
    /// Coefficients of `Q_i`, by half, then by `i`.
    pub(crate) twists: Vec<f64>,
}

/// A side of a patch: its strip, and whether the side runs against the strip's canonical direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Side {
    pub(crate) strip: u32,
    pub(crate) reversed: bool,
}

/// Up to this barycentric distance from a corner (by order) the corner's polynomial stands for the height: the exact formula divides
/// rounding by the square of the distance there, the polynomial's second derivatives are off by its power `2n − 1`.
const RADIUS: [f64; MAX_ORDER + 1] = [1e-5, 1e-5, 1e-3, 7e-3, 2e-2];

/// Gradients of the barycentric coordinates in `(u, v)`.
const GRADIENT: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

/// A half: the side it belongs to, the corners from which and to which its parameter runs, the corner it leaves the edge for.
#[derive(Clone, Copy)]
struct Half {
    side: usize,
    from: usize,
    to: usize,
    inward: usize,
    against: bool,
}

/// Value and derivatives to order two in two variables `x` (inward) and `λ` (along).
type Two = [f64; 6];

impl BubblePatch {
    /// A patch from its strips and the implicits of its corners.
    pub(crate) fn build(
        strips: Arc<Vec<Strip>>,
        sides: &[Side],
        corners: &[DVec3],
        implicits: &[&Implicit],
        (order, contact): (usize, usize),
        pairing: Pairing,
        hermite: &Hermite,
        scratch: &mut Vec<f64>,
    ) -> Self {
        let count = corners.len();
        let mut patch = Self {
            strips,
            sides: [Side::default(); 4],
            count,
            order,
            pairing,
            corners: [DVec3::ZERO; 4],
            normals: [DVec3::ZERO; 4],
            jets: Vec::new(),
            twists: Vec::new(),
        };
        for k in 0..count {
            (patch.sides[k], patch.corners[k]) = (sides[k], corners[k]);
            patch.normals[k] = implicits[k].gradient();
        }
        if order == 0 {
            if contact > 0 {
                patch.flat_corner_jets();
            }
            return patch;
        }
        let length = 2 * order + 1;
        patch.jets.reserve_exact(count * plane_count(length));
        for k in 0..count {
            let (next, prev) = ((k + 1) % count, (k + count - 1) % count);
            let opposite = |x: &[DVec3; 4]| {
                if count == 4 { x[(k + 2) % 4] - x[next] - x[prev] + x[k] } else { DVec3::ZERO }
            };
            let (v, n) = (&patch.corners, &patch.normals);
            let base = [DVec3::ZERO, v[next] - v[k], v[prev] - v[k], DVec3::ZERO, opposite(v), DVec3::ZERO];
            let normal = [n[k], n[next] - n[k], n[prev] - n[k], opposite(n)];
            let jet = corner_jet(implicits[k], &CornerFrame { base: &base, normal }, length, scratch);
            patch.jets.extend(jet);
        }
        patch.make_twists(hermite);
        patch
    }

    /// The `2`-jets of the curved G⁰ patch at its corners: its halves expanded.
    fn flat_corner_jets(&mut self) {
        if self.count != 3 || self.pairing != Pairing::Mean {
            return;
        }
        let taylor = |k: usize| {
            let side = self.sides[k];
            let [a, b] = self.strips[side.strip as usize].height_taylor();
            // The first two coefficients seen from corner k, and the first one from the other end.
            let (a, b) = if side.reversed { (b, a) } else { (a, b) };
            let at = |c: &[f64], i: usize| c.get(i).copied().unwrap_or_default();
            [[at(&a, 1), at(&a, 2)], [at(&b, 1), at(&b, 2)]]
        };
        let data = [0, 1, 2].map(taylor);
        let mut jets = Vec::with_capacity(18);
        for k in 0..3 {
            let (out, back) = (data[k][0], data[(k + 2) % 3][1]);
            let far = data[(k + 1) % 3];
            let mixed = 0.5 * (out[1] - out[0] + back[1] - back[0] + far[0][0] + far[1][0]);
            jets.extend([0.0, out[0], back[0], out[1], mixed, back[1]]);
        }
        self.jets = jets;
    }

    /// Number of coefficients of one corner's polynomial, and its length (degree + 1).
    fn jet_size(&self) -> (usize, usize) {
        let length = if self.order == 0 { 3 } else { 2 * self.order + 1 };
        (plane_count(length), length)
    }

    /// `∂_a^i ∂_b^j h` at corner `k`, `a` towards corner `toward`, `b` towards the other neighbour.
    fn corner_derivative(&self, k: usize, toward: usize, i: usize, j: usize) -> f64 {
        let (size, _) = self.jet_size();
        let (i, j) = if toward == (k + 1) % self.count { (i, j) } else { (j, i) };
        self.jets[k * size + plane_index(i, j)] * factorial(i) * factorial(j)
    }

    fn make_twists(&mut self, hermite: &Hermite) {
        let n = self.order;
        let mut twists = Vec::with_capacity(self.halves() * (n + 1) * (2 * n + 2));
        for half in (0..self.halves()).map(|h| self.half(h)) {
            for k in 0..n + 1 {
                let mut q: Polynomial = [0.0; LENGTH];
                let mut add = |p: &Polynomial, c: f64| (0..2 * n + 2).for_each(|i| q[i] += c * p[i]);
                for i in 0..n + 1 {
                    let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
                    if self.count == 4 {
                        add(&hermite.basis[0][i], self.corner_derivative(half.from, half.to, i, k));
                        add(&hermite.basis[1][i], sign * self.corner_derivative(half.to, half.from, i, k));
                        continue;
                    }
                    for l in 0..k + 1 {
                        let choose = binomial(k, l);
                        let start = self.corner_derivative(half.from, half.inward, k - l, i);
                        let end = self.corner_derivative(half.to, half.inward, k - l, i);
                        add(&hermite.phi[l][0][i], choose * start);
                        add(&hermite.phi[l][1][i], choose * sign * end);
                    }
                }
                twists.extend_from_slice(&q[..2 * n + 2]);
            }
        }
        self.twists = twists;
    }

    /// The order `n`.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The corners, counter-clockwise.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The normals between which N is interpolated.
    pub fn corner_normals(&self) -> &[DVec3] {
        &self.normals[..self.count]
    }

    /// The strips along the sides, from corner `k` to the next.
    pub fn strip(&self, side: usize) -> Option<&Strip> {
        (side < self.count).then(|| self.strips.get(self.sides[side].strip as usize)).flatten()
    }

    #[inline(always)]
    fn halves(&self) -> usize {
        if self.count == 3 { 6 } else { 4 }
    }

    #[inline(always)]
    fn half(&self, h: usize) -> Half {
        if self.count == 4 {
            // Quads leave their edge for both corners at once; `inward` is the one beside `from`.
            let (from, to, inward) = (h, (h + 1) % 4, (h + 3) % 4);
            return Half { side: h, from, to, inward, against: self.sides[h].reversed };
        }
        let (side, second) = (h / 2, h % 2 == 1);
        let (a, b, c) = (side, (side + 1) % 3, (side + 2) % 3);
        let (from, to) = if second { (b, a) } else { (a, b) };
        Half { side, from, to, inward: c, against: self.sides[side].reversed != second }
    }

    /// Weights of data and twists in half `half`.
    #[inline(always)]
    fn weights(&self, half: &Half) -> [f64; 2] {
        if self.count == 4 {
            return [1.0, 0.5];
        }
        match self.pairing {
            Pairing::Mean => [0.5, 1.0 / 6.0],
            // P_{σ1} runs along the lines of constant λ_σ1; of P_{σ2} only the half on the edge opposite σ1 is added.
            Pairing::Single([a, b, c]) => {
                if half.to == b as usize {
                    [1.0, 0.0]
                } else if half.to == c as usize && half.from == a as usize {
                    [1.0, 1.0]
                } else {
                    [0.0, 0.0]
                }
            }
        }
    }

    /// How the patch leaves the edge of `half`, in the canonical parameter about `lambda`.
    #[inline(always)]
    fn leaving<const L: usize>(&self, half: &Half, lambda: f64) -> Leaving<L> {
        let [(base, slope), (normal, turn)] = self.leave(half, lambda);
        let mut out = Leaving { base: [[[0.0; L]; 3]; MAX_ORDER], normal: [[0.0; L]; 3] };
        for axis in 0..3 {
            (out.base[0][axis][0], out.normal[axis][0]) = (base[axis], normal[axis]);
            if L > 1 {
                (out.base[0][axis][1], out.normal[axis][1]) = (slope[axis], turn[axis]);
            }
        }
        out
    }

    /// `L_d` and `N_d`, each with its derivative in the canonical parameter (zero on triangles).
    #[inline(always)]
    fn leave(&self, half: &Half, lambda: f64) -> [(DVec3, DVec3); 2] {
        [&self.corners, &self.normals].map(|x| {
            let start = x[half.inward] - x[half.from];
            if self.count == 3 {
                return (start, DVec3::ZERO);
            }
            let end = x[(half.to + 1) % 4] - x[half.to];
            let slope = if half.against { start - end } else { end - start };
            (start * (1.0 - lambda) + end * lambda, slope)
        })
    }

    /// Inward coordinate, coordinate along, and what is left to the end of the edge, of half `half`.
    #[inline(always)]
    fn coordinates(&self, half: &Half, at: DVec2) -> [f64; 3] {
        if self.count == 3 {
            let b = [1.0 - at.x - at.y, at.x, at.y];
            return [b[half.inward], b[half.to], b[half.from] + b[half.inward]];
        }
        let (u, v) = (at.x, at.y);
        match half.side {
            0 => [v, u, 1.0 - u],
            1 => [1.0 - u, v, 1.0 - v],
            2 => [1.0 - v, 1.0 - u, u],
            _ => [u, 1.0 - v, v],
        }
    }

    /// Gradients in `(u, v)` of the inward coordinate and of the coordinate along.
    #[inline(always)]
    fn gradients(&self, half: &Half) -> [[f64; 2]; 2] {
        if self.count == 3 {
            return [GRADIENT[half.inward], GRADIENT[half.to]];
        }
        match half.side {
            0 => [[0.0, 1.0], [1.0, 0.0]],
            1 => [[-1.0, 0.0], [0.0, 1.0]],
            2 => [[0.0, -1.0], [-1.0, 0.0]],
            _ => [[1.0, 0.0], [0.0, -1.0]],
        }
    }

    /// The corner whose polynomial stands for the height at `at`, with the local parameters there.
    #[inline(always)]
    fn near_corner(&self, at: DVec2) -> Option<(usize, f64, f64)> {
        if self.count == 4 {
            return None;
        }
        let b = [1.0 - at.x - at.y, at.x, at.y];
        let radius = RADIUS[self.order];
        (0..3).find_map(|k| {
            let (x, y) = (b[(k + 1) % 3], b[(k + 2) % 3]);
            (x + y <= radius).then_some((k, x, y))
        })
    }

    /// The jet of the height `h`.
    pub fn height(&self, at: DVec2) -> Jet2<f64> {
        match self.order {
            0 => self.height_fast::<0>(at),
            1 => self.height_fast::<1>(at),
            2 => self.height_fast::<2>(at),
            3 => self.height_sized::<3, 6>(at),
            _ => self.height_sized::<4, 7>(at),
        }
    }

    #[inline(always)]
    fn height_sized<const N: usize, const L: usize>(&self, at: DVec2) -> Jet2<f64> {
        if let Some((k, x, y)) = self.near_corner(at) {
            return self.corner_height(k, x, y);
        }
        let mut sum = Jet2::default();
        for h in 0..self.halves() {
            let half = self.half(h);
            let [data, twist] = self.weights(&half);
            if data == 0.0 {
                continue;
            }
            let [x, lambda, w] = self.coordinates(&half, at);
            let strip = &self.strips[self.sides[half.side].strip as usize];
            let t = if half.against { w } else { lambda };
            let mut e: CrossData<L> = cross::<N, L>(strip, t, &self.leaving(&half, lambda));
            if half.against {
                e.iter_mut().for_each(|e| e[1] = -e[1]);
            }
            let mut values = [[0.0; 3]; MAX_ORDER + 1];
            for i in 0..N + 1 {
                values[i] = [data * e[i][0], data * e[i][1], 2.0 * data * e[i][2]];
            }
            self.subtract_twists::<N>(h, lambda, twist, &mut values);
            let f = if self.count == 3 { blend::<N>(x, w, &values) } else { blend_square::<N>(x, &values) };
            sum = sum.add(plane_jet(&f, &self.gradients(&half)));
        }
        sum
    }

    /// [`height_sized`](Self::height_sized) for orders up to 2: the two halves of a side go together.
    #[inline(always)]
    fn height_fast<const N: usize>(&self, at: DVec2) -> Jet2<f64> {
        if let Some((k, x, y)) = self.near_corner(at) {
            return self.corner_height(k, x, y);
        }
        let mut sum = Jet2::default();
        if self.count == 4 {
            for h in 0..4 {
                let half = self.half(h);
                let [x, lambda, w] = self.coordinates(&half, at);
                let [(base, base_slope), (normal, normal_slope)] =
                    self.leave(&half, lambda).map(|(a, b)| (a.to_array(), b.to_array()));
                let d = Directions { base, base_slope, normal, normal_slope };
                let t = if half.against { w } else { lambda };
                let mut e = fast::cross::<f64, N, true>(self.strip_of(&half), t, &d);
                let sign = if half.against { -1.0 } else { 1.0 };
                for (i, e) in e.iter_mut().enumerate().take(N + 1) {
                    let q = self.twist::<f64, N, 1>([h], i, lambda, |[c]| c);
                    *e = [e[0] - 0.5 * q[0], sign * e[1] - 0.5 * q[1], 2.0 * e[2] - q[2]];
                }
                let f = fast::blend::<f64, N, true>(x, w, &e);
                sum = sum.add(plane_jet(&f, &self.gradients(&half)));
            }
            return sum;
        }
        for side in 0..3 {
            let halves = [self.half(2 * side), self.half(2 * side + 1)];
            let [first, second] = [0, 1].map(|k| self.weights(&halves[k]));
            if first[0] == 0.0 && second[0] == 0.0 {
                continue;
            }
            let [p, q] = [0, 1].map(|k| self.coordinates(&halves[k], at));
            let (x, lambda, w) = (Pair([p[0], q[0]]), Pair([p[1], q[1]]), Pair([p[2], q[2]]));
            let zero = [Pair([0.0; 2]); 3];
            let [base, normal] = [&self.corners, &self.normals].map(|x| {
                let [a, b] = [0, 1].map(|k| x[halves[k].inward] - x[halves[k].from]);
                [Pair([a.x, b.x]), Pair([a.y, b.y]), Pair([a.z, b.z])]
            });
            let d = Directions { base, base_slope: zero, normal, normal_slope: zero };
            // The halves run against each other: one of them along the strip's canonical direction.
            let (t, sign) = if halves[0].against {
                (Pair([p[2], q[1]]), Pair([-1.0, 1.0]))
            } else {
                (Pair([p[1], q[2]]), Pair([1.0, -1.0]))
            };
            let mut e = fast::cross::<Pair, N, false>(self.strip_of(&halves[0]), t, &d);
            let (data, weight) = (Pair([first[0], second[0]]), Pair([first[1], second[1]]));
            for (i, e) in e.iter_mut().enumerate().take(N + 1) {
                let q = self.twist::<Pair, N, 2>([2 * side, 2 * side + 1], i, lambda, Pair);
                let two = Pair([2.0; 2]);
                *e = [
                    data * e[0] - weight * q[0],
                    data * sign * e[1] - weight * q[1],
                    two * (data * e[2] - weight * q[2]),
                ];
            }
            let f = fast::blend::<Pair, N, false>(x, w, &e);
            for k in 0..2 {
                sum = sum.add(plane_jet(&f.map(|f| f.0[k]), &self.gradients(&halves[k])));
            }
        }
        sum
    }

    #[inline(always)]
    fn strip_of(&self, half: &Half) -> &Strip {
        &self.strips[self.sides[half.side].strip as usize]
    }

    /// Taylor coefficients of order 0 to 2 of `Q_i` of some halves.
    #[inline(always)]
    fn twist<T: Lane, const N: usize, const K: usize>(
        &self,
        halves: [usize; K],
        i: usize,
        lambda: T,
        pack: impl Fn([f64; K]) -> T,
    ) -> [T; 3] {
        let mut q = [T::splat(0.0); 3];
        if N == 0 {
            return q;
        }
        let rows = halves.map(|h| &self.twists[(h * (N + 1) + i) * (2 * N + 2)..][..2 * N + 2]);
        for j in (0..2 * N + 2).rev() {
            q[2] = q[2] * lambda + q[1];
            q[1] = q[1] * lambda + q[0];
            q[0] = q[0] * lambda + pack(rows.map(|r| r[j]));
        }
        q
    }

    /// Takes `weight · Q_i(λ)` off value and first two derivatives.
    #[inline(always)]
    fn subtract_twists<const N: usize>(
        &self,
        half: usize,
        lambda: f64,
        weight: f64,
        values: &mut [[f64; 3]],
    ) {
        if weight == 0.0 || self.twists.is_empty() {
            return;
        }
        let rows = &self.twists[half * (N + 1) * (2 * N + 2)..];
        for (value, row) in values.iter_mut().zip(rows.chunks_exact(2 * N + 2)).take(N + 1) {
            let mut q = [0.0; 3];
            for &c in row.iter().rev() {
                q = [q[0] * lambda + c, q[1] * lambda + q[0], q[2] * lambda + q[1]];
            }
            *value = [value[0] - weight * q[0], value[1] - weight * q[1], value[2] - 2.0 * weight * q[2]];
        }
    }

    /// The corner's polynomial; the inward gradients of its parameters turn it to `(u, v)`.
    fn corner_height(&self, k: usize, x: f64, y: f64) -> Jet2<f64> {
        let (size, length) = self.jet_size();
        let Some(c) = self.jets.get(k * size..(k + 1) * size) else {
            if self.order == 0 && self.pairing != Pairing::Mean {
                return self.nudged(k, x, y);
            }
            return Jet2::default();
        };
        let [px, py] = [powers(x), powers(y)];
        let mut f: Two = [0.0; 6];
        for a in 0..length {
            for b in 0..length - a {
                let c = c[plane_index(a, b)];
                f[0] += c * px[0][a] * py[0][b];
                f[1] += c * px[1][a] * py[0][b];
                f[2] += c * px[0][a] * py[1][b];
                f[3] += c * px[2][a] * py[0][b];
                f[4] += c * px[1][a] * py[1][b];
                f[5] += c * px[0][a] * py[2][b];
            }
        }
        plane_jet(&f, &[GRADIENT[(k + 1) % 3], GRADIENT[(k + 2) % 3]])
    }

    /// Taylor's polynomial about a point a little further inside: single pairings of order 0 have no polynomial of their own at
    /// corners.
    fn nudged(&self, k: usize, x: f64, y: f64) -> Jet2<f64> {
        let r = 2.0 * RADIUS[0];
        let local = DVec2::new(r, r);
        let mut b = [0.0; 3];
        (b[k], b[(k + 1) % 3], b[(k + 2) % 3]) = (1.0 - 2.0 * r, r, r);
        let j = self.height(DVec2::new(b[1], b[2]));
        let d = DVec2::new(x, y) - local;
        // From changes of the corner's barycentric coordinates to changes of u and v.
        let mut to = [0.0; 3];
        (to[k], to[(k + 1) % 3], to[(k + 2) % 3]) = (-d.x - d.y, d.x, d.y);
        let (du, dv) = (to[1], to[2]);
        Jet2 {
            p: j.p + j.du * du + j.dv * dv + 0.5 * (j.duu * du * du + j.dvv * dv * dv) + j.duv * du * dv,
            du: j.du + j.duu * du + j.duv * dv,
            dv: j.dv + j.duv * du + j.dvv * dv,
            ..j
        }
    }

    /// Coefficients of `δu^i δv^j`, `i + j ≤ 4`, of the patch about `at`, as `[i][j]`; the others are zero. What verifies orders three
    /// and four; [`jet`](Patch::jet) is faster.
    pub fn taylor(&self, at: DVec2) -> [[DVec3; 5]; 5] {
        let h = match self.order {
            0 => self.height_taylor::<0>(at),
            1 => self.height_taylor::<1>(at),
            2 => self.height_taylor::<2>(at),
            3 => self.height_taylor::<3>(at),
            _ => self.height_taylor::<4>(at),
        };
        let [l, n] = [&self.corners, &self.normals].map(|x| self.interpolate(x, at));
        let mut out = [[DVec3::ZERO; 5]; 5];
        for i in 0..5 {
            for j in 0..5 - i {
                let mut p = h.0[i][j] * n.p;
                if i > 0 {
                    p += h.0[i - 1][j] * n.du;
                }
                if j > 0 {
                    p += h.0[i][j - 1] * n.dv;
                }
                if i > 0 && j > 0 {
                    p += h.0[i - 1][j - 1] * n.duv;
                }
                out[i][j] = p;
            }
        }
        out[0][0] += l.p;
        out[1][0] += l.du;
        out[0][1] += l.dv;
        out[1][1] += l.duv;
        out
    }

    fn height_taylor<const N: usize>(&self, at: DVec2) -> Plane<5> {
        if let Some((k, x, y)) = self.near_corner(at) {
            let (size, length) = self.jet_size();
            let Some(c) = self.jets.get(k * size..(k + 1) * size) else { return Plane::ZERO };
            let [gx, gy] = [GRADIENT[(k + 1) % 3], GRADIENT[(k + 2) % 3]];
            let (x, y) = (Plane::linear(x, gx[0], gx[1]), Plane::linear(y, gy[0], gy[1]));
            let mut sum = Plane::ZERO;
            for a in (0..length).rev() {
                let mut row = Plane::ZERO;
                for b in (0..length - a).rev() {
                    row = row.mul(&y);
                    row.0[0][0] += c[plane_index(a, b)];
                }
                sum = sum.mul(&x).add(&row);
            }
            return sum;
        }
        let mut sum = Plane::<5>::ZERO;
        let hermite = Hermite::new(N);
        for h in 0..self.halves() {
            let half = self.half(h);
            let [data, twist] = self.weights(&half);
            if data == 0.0 {
                continue;
            }
            let [x, lambda, w] = self.coordinates(&half, at);
            let strip = &self.strips[self.sides[half.side].strip as usize];
            let t = if half.against { w } else { lambda };
            let mut e: CrossData<9> = cross::<N, 9>(strip, t, &self.leaving(&half, lambda));
            if half.against {
                e.iter_mut().flat_map(|e| e.iter_mut().skip(1).step_by(2)).for_each(|e| *e = -*e);
            }
            let [gx, gl] = self.gradients(&half);
            let x = Plane::<5>::linear(x, gx[0], gx[1]);
            let along = Plane::<5>::linear(lambda, gl[0], gl[1]);
            let w =
                if self.count == 3 { Plane::linear(w, -gl[0], -gl[1]) } else { Plane::linear(1.0, 0.0, 0.0) };
            let r = x.mul(&w.recip());
            let mut scale = Plane::linear(1.0, 0.0, 0.0);
            for i in 0..N + 1 {
                let mut value = along.substitute(&series::scale(&e[i], data)[..5]);
                if twist != 0.0 && !self.twists.is_empty() {
                    let row = &self.twists[(h * (N + 1) + i) * (2 * N + 2)..][..2 * N + 2];
                    let q = row.iter().rev().fold(Plane::ZERO, |sum, &c| {
                        let mut sum: Plane<5> = sum.mul(&along);
                        sum.0[0][0] += c;
                        sum
                    });
                    value = value.add(&q.scale(-twist));
                }
                let basis = hermite.basis[0][i].iter().rev().fold(Plane::ZERO, |sum, &c| {
                    let mut sum: Plane<5> = sum.mul(&r);
                    sum.0[0][0] += c;
                    sum
                });
                sum = sum.add(&scale.mul(&basis).mul(&value));
                scale = scale.mul(&w);
            }
        }
        sum
    }

    /// The (bi)linear interpolant of corner values.
    #[inline(always)]
    pub(crate) fn interpolate(&self, x: &[DVec3; 4], at: DVec2) -> Jet2 {
        let (u, v) = (at.x, at.y);
        if self.count == 3 {
            let p = x[0] * (1.0 - u - v) + x[1] * u + x[2] * v;
            return Jet2 { p, du: x[1] - x[0], dv: x[2] - x[0], ..Jet2::default() };
        }
        let (bottom, top) = (x[0] * (1.0 - u) + x[1] * u, x[3] * (1.0 - u) + x[2] * u);
        let (left, right) = (x[3] - x[0], x[2] - x[1]);
        Jet2 {
            p: bottom * (1.0 - v) + top * v,
            du: (x[1] - x[0]) * (1.0 - v) + (x[2] - x[3]) * v,
            dv: left * (1.0 - u) + right * u,
            duv: right - left,
            ..Jet2::default()
        }
    }
}

impl Patch for BubblePatch {
    fn domain(&self) -> Domain {
        if self.count == 4 {
            Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }
        } else {
            Domain::Polygon(vec![DVec2::ZERO, DVec2::X, DVec2::Y])
        }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let h = self.height(at);
        let [l, n] = [&self.corners, &self.normals].map(|x| self.interpolate(x, at));
        l.add(n.weighted(&h))
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Bubble { n: self.count as u8 }
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        crate::record::record(self)
    }
}

/// `Σ_i w^i H_{0,i}(x/w) E_i(λ)` with `w = 1 − λ`: value and derivatives in `x` and `λ`, from `E_i` with two derivatives.
#[inline(always)]
fn blend<const N: usize>(x: f64, w: f64, e: &[[f64; 3]; MAX_ORDER + 1]) -> Two {
    let inverse = 1.0 / w;
    let r = x * inverse;
    let basis = rising::<N>(r, (w - x) * inverse);
    let mut f = [0.0; 6];
    // w^(i−2), w^(i−1), w^i.
    let mut scale = [inverse * inverse, inverse, 1.0];
    for i in 0..N + 1 {
        let [h, d, dd] = basis[i];
        let i_f = i as f64;
        let g = scale[2] * h;
        let (gx, gw) = (scale[1] * d, scale[1] * (i_f * h - r * d));
        let gxx = scale[0] * dd;
        let gxw = scale[0] * ((i_f - 1.0) * d - r * dd);
        let gww = scale[0] * (i_f * (i_f - 1.0) * h - 2.0 * (i_f - 1.0) * r * d + r * r * dd);
        let [e0, e1, e2] = e[i];
        f[0] += g * e0;
        f[1] += gx * e0;
        f[2] += g * e1 - gw * e0;
        f[3] += gxx * e0;
        f[4] += gx * e1 - gxw * e0;
        f[5] += g * e2 - 2.0 * gw * e1 + gww * e0;
        scale = [scale[1], scale[2], scale[2] * w];
    }
    f
}

/// `Σ_i H_{0,i}(x) E_i(λ)`.
#[inline(always)]
fn blend_square<const N: usize>(x: f64, e: &[[f64; 3]; MAX_ORDER + 1]) -> Two {
    let basis = rising::<N>(x, 1.0 - x);
    let mut f = [0.0; 6];
    for i in 0..N + 1 {
        let ([h, d, dd], [e0, e1, e2]) = (basis[i], e[i]);
        f[0] += h * e0;
        f[1] += d * e0;
        f[2] += h * e1;
        f[3] += dd * e0;
        f[4] += d * e1;
        f[5] += h * e2;
    }
    f
}

/// Chain rule with affine coordinates.
#[inline(always)]
fn plane_jet(f: &Two, [a, b]: &[[f64; 2]; 2]) -> Jet2<f64> {
    let second =
        |i: usize, j: usize| f[3] * (a[i] * a[j]) + f[4] * (a[i] * b[j] + a[j] * b[i]) + f[5] * (b[i] * b[j]);
    Jet2 {
        p: f[0],
        du: f[1] * a[0] + f[2] * b[0],
        dv: f[1] * a[1] + f[2] * b[1],
        duu: second(0, 0),
        duv: second(0, 1),
        dvv: second(1, 1),
    }
}

/// Powers `x^a` with their first two derivatives.
fn powers(x: f64) -> [[f64; 9]; 3] {
    let mut out = [[0.0; 9]; 3];
    let mut power = 1.0;
    for a in 0..9 {
        out[0][a] = power;
        if a + 1 < 9 {
            out[1][a + 1] = (a + 1) as f64 * power;
        }
        if a + 2 < 9 {
            out[2][a + 2] = ((a + 1) * (a + 2)) as f64 * power;
        }
        power *= x;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BubbleOptions, Face, PolyMesh, bubble};

    #[test]
    fn the_fast_and_the_general_way_agree() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.1, 0.2], [1.3, 1.2, -0.1], [-0.1, 0.9, 0.3], [0.5, 1.9, 0.4]];
        let normals =
            [[-0.2, -0.3, 1.0], [0.3, -0.2, 0.9], [0.2, 0.25, 1.1], [-0.1, 0.2, 1.0], [0.0, 0.4, 0.9]];
        let faces = vec![Face::Quad([0, 1, 2, 3]), Face::Triangle([3, 2, 4])];
        let [positions, normals] = [positions, normals].map(|x| x.map(DVec3::from_array).to_vec());
        let mesh = PolyMesh { positions, normals, faces };
        for order in 0..3 {
            for pairing in [Pairing::Mean, Pairing::Single([1, 2, 0])] {
                let s = bubble(&mesh, &BubbleOptions { order, pairing, ..Default::default() }).unwrap();
                for patch in s.patches() {
                    for (u, v) in [(0.2, 0.3), (0.5, 0.0), (0.7, 0.1), (0.0, 0.4), (0.35, 0.65)] {
                        let at = DVec2::new(u, v);
                        let general = match order {
                            0 => patch.height_sized::<0, 3>(at),
                            1 => patch.height_sized::<1, 4>(at),
                            _ => patch.height_sized::<2, 5>(at),
                        };
                        let fast = patch.height(at);
                        let c = patch.taylor(at);
                        let jet = patch.jet(at);
                        for (a, b) in [
                            (general.p, fast.p),
                            (general.du, fast.du),
                            (general.dv, fast.dv),
                            (general.duu, fast.duu),
                            (general.duv, fast.duv),
                            (general.dvv, fast.dvv),
                        ] {
                            assert!((a - b).abs() < 1e-11, "{order} {pairing:?} {at}: {general:?} {fast:?}");
                        }
                        for (a, b) in [(c[1][0], jet.du), (c[2][0] * 2.0, jet.duu), (c[1][1], jet.duv)] {
                            assert!(a.distance(b) < 1e-11, "{order} {pairing:?} {at}: {a} {b}");
                        }
                    }
                }
            }
        }
    }
}
