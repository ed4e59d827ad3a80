//! Taylor expansions of a patch, to order four.

use glam::{DVec2, DVec3};

use crate::{
    corner::plane_index,
    cross::{CrossData, cross},
    half::{GRADIENT, Seen},
    height::{Corner, Place},
    hermite::Hermite,
    patch::BubblePatch,
    series::{self, Plane},
};

impl BubblePatch {
    /// Coefficients of `δu^i δv^j`, `i + j ≤ 4`, of the patch about `at`, as `[i][j]`; the others are zero. What verifies orders three
    /// and four; [`jet`](suture_surface::Patch::jet) is faster.
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
        if self.bent() {
            let bends = self.bend_taylor::<5>(at);
            for i in 0..5 {
                for j in 0..5 - i {
                    out[i][j] += DVec3::from_array([0, 1, 2].map(|axis| bends[axis].0[i][j]));
                }
            }
        }
        out
    }

    fn height_taylor<const N: usize>(&self, at: DVec2) -> Plane<5> {
        let place = self.place(at);
        if let Place::Tip(Corner { k, x, y }) = place {
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
        let near = if let Place::Near(corner) = place { Some(corner) } else { None };
        let mut sum = near.map_or(Plane::ZERO, |corner| self.near::<N, 5>(&corner));
        let hermite = Hermite::new(N);
        for Seen { number, half, weights: [data, twist], coordinates: [x, lambda, w], strip, t } in
            self.seen_from(at)
        {
            if near.is_some_and(|corner| corner.k == half.to) {
                continue;
            }
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
                    let row = &self.twists[(number * (N + 1) + i) * (2 * N + 2)..][..2 * N + 2];
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
}
