//! Halves: the edges of a patch, seen along the lines of constant barycentric coordinate of one of their ends.

use glam::{DVec2, DVec3};

use crate::{
    MAX_ORDER,
    cross::Leaving,
    patch::{BubblePatch, Pairing},
    strip::Strip,
};

/// Gradients of the barycentric coordinates in `(u, v)`.
pub(crate) const GRADIENT: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

/// A half: the side it belongs to, the corners from which and to which its parameter runs, the corner it leaves the edge for.
#[derive(Clone, Copy)]
pub(crate) struct Half {
    pub(crate) side: usize,
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) inward: usize,
    pub(crate) against: bool,
}

/// A half as a point sees it.
pub(crate) struct Seen<'a> {
    pub(crate) number: usize,
    pub(crate) half: Half,
    /// Weights of data and twists.
    pub(crate) weights: [f64; 2],
    /// As [`coordinates`](BubblePatch::coordinates).
    pub(crate) coordinates: [f64; 3],
    pub(crate) strip: &'a Strip,
    /// Parameter on the strip.
    pub(crate) t: f64,
}

impl BubblePatch {
    /// The halves that count, as `at` sees them.
    #[inline(always)]
    pub(crate) fn seen_from(&self, at: DVec2) -> impl Iterator<Item = Seen<'_>> {
        (0..self.halves()).filter_map(move |number| {
            let half = self.half(number);
            let weights = self.weights(&half);
            let coordinates = self.coordinates(&half, at);
            let [_, lambda, w] = coordinates;
            let t = if half.against { w } else { lambda };
            let strip = self.strip_of(&half);
            (weights[0] != 0.0).then_some(Seen { number, half, weights, coordinates, strip, t })
        })
    }

    #[inline(always)]
    pub(crate) fn strip_of(&self, half: &Half) -> &Strip {
        &self.strips[self.sides[half.side].strip as usize]
    }

    #[inline(always)]
    pub(crate) fn halves(&self) -> usize {
        if self.count == 3 { 6 } else { 4 }
    }

    #[inline(always)]
    pub(crate) fn half(&self, h: usize) -> Half {
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
    pub(crate) fn weights(&self, half: &Half) -> [f64; 2] {
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
    pub(crate) fn leaving<const L: usize>(&self, half: &Half, lambda: f64) -> Leaving<L> {
        let [(base, slope), (normal, turn)] = self.leave(half, lambda);
        let mut out = Leaving { base: [[[0.0; L]; 3]; MAX_ORDER], normal: [[0.0; L]; 3] };
        for axis in 0..3 {
            (out.base[0][axis][0], out.normal[axis][0]) = (base[axis], normal[axis]);
            if L > 1 {
                (out.base[0][axis][1], out.normal[axis][1]) = (slope[axis], turn[axis]);
            }
        }
        if self.bent() {
            let bends = self.bend_off::<L>(half, lambda);
            for j in 1..L.min(MAX_ORDER + 1) {
                for axis in 0..3 {
                    for k in 0..L - j {
                        let sign = if half.against && k % 2 == 1 { -1.0 } else { 1.0 };
                        out.base[j - 1][axis][k] += sign * bends[axis].0[j][k];
                    }
                }
            }
        }
        out
    }

    /// `L_d` and `N_d`, each with its derivative in the canonical parameter (zero on triangles).
    #[inline(always)]
    pub(crate) fn leave(&self, half: &Half, lambda: f64) -> [(DVec3, DVec3); 2] {
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
    pub(crate) fn coordinates(&self, half: &Half, at: DVec2) -> [f64; 3] {
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
    pub(crate) fn gradients(&self, half: &Half) -> [[f64; 2]; 2] {
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
}
