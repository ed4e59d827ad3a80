//! The height of a patch: its halves summed, or the corner's polynomial.

use glam::DVec2;
use suture_surface::Jet2;

use crate::{
    MAX_ORDER,
    corner::plane_index,
    cross::{CrossData, cross},
    fast::{self, Directions, Lane, Lanes},
    half::{GRADIENT, Seen},
    hermite::rising,
    patch::BubblePatch,
    series::Plane,
};

/// Up to this barycentric distance from a corner (by order) the corner's polynomial stands for the height; its error in derivatives of
/// order `n` is the power `n + 1` of the distance.
pub(crate) const TIP: [f64; MAX_ORDER + 1] = [1e-9, 1e-7, 1e-5, 1e-4, 1e-3];

/// Up to this one the halves that run to the corner are taken as polynomials ([`crate::near`]): the exact formula divides rounding by the square
/// of the distance. Over plane bases points on the sides are as good by the exact formula, which is faster.
pub(crate) const NEAR: f64 = 1e-2;

/// Points on a side: those nearer to it, relative to the distance from the corner.
const SIDE: f64 = 1e-6;

/// Value and derivatives to order two in two variables `x` (inward) and `λ` (along).
pub(crate) type Two = [f64; 6];

/// A point close to corner `k`, with its coordinates towards the next and the previous corner.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    pub(crate) k: usize,
    pub(crate) x: f64,
    pub(crate) y: f64,
}

/// What stands for the height at a point.
pub(crate) enum Place {
    /// The corner's polynomial.
    Tip(Corner),
    /// The halves, those that run to the corner as polynomials.
    Near(Corner),
    /// The halves.
    Open,
}

/// The fast way at one point, compiled once for every set of instructions.
struct Fast<'a, const N: usize> {
    patch: &'a BubblePatch,
    at: DVec2,
}

impl<const N: usize> pulp::WithSimd for Fast<'_, N> {
    type Output = Jet2<f64>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Jet2<f64> {
        // Whatever has vectors here has fused products.
        if S::IS_SCALAR {
            self.patch.height_lanes::<N, false>(self.at)
        } else {
            self.patch.height_lanes::<N, true>(self.at)
        }
    }
}

impl BubblePatch {
    /// Where `at` lies, as corners see it.
    #[inline(always)]
    pub(crate) fn place(&self, at: DVec2) -> Place {
        if self.count == 4 {
            return Place::Open;
        }
        let b = [1.0 - at.x - at.y, at.x, at.y];
        for k in 0..3 {
            let (x, y) = (b[(k + 1) % 3], b[(k + 2) % 3]);
            if x + y > NEAR {
                continue;
            }
            let corner = Corner { k, x, y };
            if x + y <= TIP[self.order] {
                return if self.jets.is_empty() { Place::Near(corner) } else { Place::Tip(corner) };
            }
            let inside = self.bent() || x.min(y) > SIDE * (x + y);
            return if inside { Place::Near(corner) } else { Place::Open };
        }
        Place::Open
    }

    /// The jet of the height `h`.
    pub fn height(&self, at: DVec2) -> Jet2<f64> {
        let near = match self.place(at) {
            Place::Tip(corner) => return self.corner_height(&corner),
            Place::Near(corner) => Some(corner),
            Place::Open => None,
        };
        // Bent bases are for the general code.
        let general = near.is_some() || self.bent();
        match self.order {
            0 if general => self.height_sized::<0, 3>(at, near),
            1 if general => self.height_sized::<1, 4>(at, near),
            2 if general => self.height_sized::<2, 5>(at, near),
            0 => self.height_fast::<0>(at),
            1 => self.height_fast::<1>(at),
            2 => self.height_fast::<2>(at),
            3 => self.height_sized::<3, 6>(at, near),
            _ => self.height_sized::<4, 7>(at, near),
        }
    }

    /// The halves summed; those that run to the corner `near` go together.
    #[inline(always)]
    fn height_sized<const N: usize, const L: usize>(&self, at: DVec2, near: Option<Corner>) -> Jet2<f64> {
        let mut sum = near.map_or(Jet2::default(), |corner| jet_of(&self.near::<N, 3>(&corner)));
        for Seen { number, half, weights: [data, twist], coordinates: [x, lambda, w], strip, t } in
            self.seen_from(at)
        {
            if near.is_some_and(|corner| corner.k == half.to) {
                continue;
            }
            let mut e: CrossData<L> = cross::<N, L>(strip, t, &self.leaving(&half, lambda));
            if half.against {
                e.iter_mut().for_each(|e| e[1] = -e[1]);
            }
            let mut values = [[0.0; 3]; MAX_ORDER + 1];
            for i in 0..N + 1 {
                values[i] = [data * e[i][0], data * e[i][1], 2.0 * data * e[i][2]];
            }
            self.subtract_twists::<N>(number, lambda, twist, &mut values);
            let f = if self.count == 3 { blend::<N>(x, w, &values) } else { blend_square::<N>(x, &values) };
            sum = sum.add(plane_jet(&f, &self.gradients(&half)));
        }
        sum
    }

    /// [`height_sized`](Self::height_sized) for orders up to 2, with the instructions that the machine has.
    #[inline]
    fn height_fast<const N: usize>(&self, at: DVec2) -> Jet2<f64> {
        pulp::Arch::new().dispatch(Fast::<N> { patch: self, at })
    }

    /// The two halves of a side go together.
    #[inline(always)]
    fn height_lanes<const N: usize, const FMA: bool>(&self, at: DVec2) -> Jet2<f64> {
        let mut sum = Jet2::default();
        if self.count == 4 {
            for h in 0..4 {
                let half = self.half(h);
                let [x, lambda, w] = self.coordinates(&half, at);
                let [(base, base_slope), (normal, normal_slope)] =
                    self.leave(&half, lambda).map(|(a, b)| (a.to_array(), b.to_array()));
                let [base, base_slope, normal, normal_slope] =
                    [base, base_slope, normal, normal_slope].map(|x| x.map(|x| Lanes::<1, FMA>([x])));
                let d = Directions { base, base_slope, normal, normal_slope };
                let t = Lanes([if half.against { w } else { lambda }]);
                let mut e = fast::cross::<Lanes<1, FMA>, N, true>(self.strip_of(&half), t, &d);
                let sign = Lanes([if half.against { -1.0 } else { 1.0 }]);
                let (x, lambda, w) = (Lanes([x]), Lanes([lambda]), Lanes([w]));
                let (half_of, two) = (Lanes([0.5]), Lanes([2.0]));
                for (i, e) in e.iter_mut().enumerate().take(N + 1) {
                    let q = self.twist::<Lanes<1, FMA>, N, 1>([h], i, lambda, Lanes);
                    *e = [e[0] - half_of * q[0], sign * e[1] - half_of * q[1], two * e[2] - q[2]];
                }
                let f = fast::blend::<Lanes<1, FMA>, N, true>(x, w, &e);
                sum = sum.add(plane_jet(&f.map(|f| f.0[0]), &self.gradients(&half)));
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
            let (x, lambda, w) = (Lanes([p[0], q[0]]), Lanes([p[1], q[1]]), Lanes([p[2], q[2]]));
            let zero = [Lanes([0.0; 2]); 3];
            let [base, normal] = [&self.corners, &self.normals].map(|x| {
                let [a, b] = [0, 1].map(|k| x[halves[k].inward] - x[halves[k].from]);
                [Lanes([a.x, b.x]), Lanes([a.y, b.y]), Lanes([a.z, b.z])]
            });
            let d = Directions { base, base_slope: zero, normal, normal_slope: zero };
            // The halves run against each other: one of them along the strip's canonical direction.
            let (t, sign) = if halves[0].against {
                (Lanes([p[2], q[1]]), Lanes([-1.0, 1.0]))
            } else {
                (Lanes([p[1], q[2]]), Lanes([1.0, -1.0]))
            };
            let mut e = fast::cross::<Lanes<2, FMA>, N, false>(self.strip_of(&halves[0]), t, &d);
            let (data, weight) = (Lanes([first[0], second[0]]), Lanes([first[1], second[1]]));
            for (i, e) in e.iter_mut().enumerate().take(N + 1) {
                let q = self.twist::<Lanes<2, FMA>, N, 2>([2 * side, 2 * side + 1], i, lambda, Lanes);
                let two = Lanes([2.0; 2]);
                *e = [
                    data * e[0] - weight * q[0],
                    data * sign * e[1] - weight * q[1],
                    two * (data * e[2] - weight * q[2]),
                ];
            }
            let f = fast::blend::<Lanes<2, FMA>, N, false>(x, w, &e);
            for k in 0..2 {
                sum = sum.add(plane_jet(&f.map(|f| f.0[k]), &self.gradients(&halves[k])));
            }
        }
        sum
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
    pub(crate) fn subtract_twists<const N: usize>(
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
    pub(crate) fn corner_height(&self, &Corner { k, x, y }: &Corner) -> Jet2<f64> {
        let (size, length) = self.jet_size();
        let Some(c) = self.jets.get(k * size..(k + 1) * size) else { return Jet2::default() };
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
}

/// `Σ_i w^i H_{0,i}(x/w) E_i(λ)` with `w = 1 − λ`: value and derivatives in `x` and `λ`, from `E_i` with two derivatives.
#[inline(always)]
pub(crate) fn blend<const N: usize>(x: f64, w: f64, e: &[[f64; 3]; MAX_ORDER + 1]) -> Two {
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
pub(crate) fn blend_square<const N: usize>(x: f64, e: &[[f64; 3]; MAX_ORDER + 1]) -> Two {
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
pub(crate) fn plane_jet(f: &Two, [a, b]: &[[f64; 2]; 2]) -> Jet2<f64> {
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

/// Value and derivatives from Taylor coefficients.
fn jet_of(Plane(c): &Plane<3>) -> Jet2<f64> {
    Jet2 { p: c[0][0], du: c[1][0], dv: c[0][1], duu: 2.0 * c[2][0], duv: c[1][1], dvv: 2.0 * c[0][2] }
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
pub(crate) mod tests {
    use super::*;
    use crate::{BubbleOptions, Face, Pairing, PolyMesh, bubble};
    use glam::DVec3;
    use suture_surface::Patch;

    /// A skew quad and a triangle on its upper side.
    pub(crate) fn quad_and_triangle() -> PolyMesh {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.1, 0.2], [1.3, 1.2, -0.1], [-0.1, 0.9, 0.3], [0.5, 1.9, 0.4]];
        let normals =
            [[-0.2, -0.3, 1.0], [0.3, -0.2, 0.9], [0.2, 0.25, 1.1], [-0.1, 0.2, 1.0], [0.0, 0.4, 0.9]];
        let faces = vec![Face::Quad([0, 1, 2, 3]), Face::Triangle([3, 2, 4])];
        let [positions, normals] = [positions, normals].map(|x| x.map(DVec3::from_array).to_vec());
        PolyMesh { positions, normals, faces }
    }

    #[test]
    fn the_fast_and_the_general_way_agree() {
        let mesh = quad_and_triangle();
        for order in 0..3 {
            for pairing in [Pairing::Mean, Pairing::Single([1, 2, 0])] {
                let s = bubble(&mesh, &BubbleOptions { order, pairing, ..Default::default() }).unwrap();
                for patch in s.patches() {
                    for (u, v) in [(0.2, 0.3), (0.5, 0.0), (0.7, 0.1), (0.0, 0.4), (0.35, 0.65)] {
                        let at = DVec2::new(u, v);
                        let general = match order {
                            0 => patch.height_sized::<0, 3>(at, None),
                            1 => patch.height_sized::<1, 4>(at, None),
                            _ => patch.height_sized::<2, 5>(at, None),
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
