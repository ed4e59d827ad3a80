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
    corner::{CornerFrame, corner_jet, plane_count, plane_index},
    hermite::{Hermite, LENGTH, Polynomial, binomial, factorial},
    implicit::Implicit,
    lean::Leans,
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
    /// Whether a side is bent: its strip adds a curve to the straight edge.
    pub(crate) bent: bool,
    /// What is added to leave a side to the inside, by side; empty where nothing is.
    pub(crate) leans: Leans,
    /// The implicits from which strips, jets and twists follow, by vertex; none over strips that were given.
    pub(crate) sources: Option<Arc<Vec<Implicit>>>,
    /// The vertices, as numbers in `sources`.
    pub(crate) vertices: [u32; 4],
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

impl BubblePatch {
    /// A patch from its strips and the implicits of its corners; leans that are not given are sought.
    pub(crate) fn build(
        strips: Arc<Vec<Strip>>,
        sides: &[Side],
        corners: &[DVec3],
        implicits: &[&Implicit],
        (order, contact): (usize, usize),
        pairing: Pairing,
        leans: Option<Leans>,
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
            bent: false,
            leans: Vec::new(),
            sources: None,
            vertices: [0; 4],
            corners: [DVec3::ZERO; 4],
            normals: [DVec3::ZERO; 4],
            jets: Vec::new(),
            twists: Vec::new(),
        };
        for k in 0..count {
            (patch.sides[k], patch.corners[k]) = (sides[k], corners[k]);
            patch.normals[k] = implicits[k].gradient();
        }
        patch.bent = (0..count).any(|k| !patch.strips[sides[k].strip as usize].bend().is_empty());
        if order == 0 {
            if contact > 0 {
                patch.flat_corner_jets();
            }
            return patch;
        }
        patch.leans = leans.unwrap_or_else(|| patch.find_leans());
        patch.bent |= !patch.leans.is_empty();
        let length = 2 * order + 1;
        patch.jets.reserve_exact(count * plane_count(length));
        for k in 0..count {
            let (next, prev) = ((k + 1) % count, (k + count - 1) % count);
            let opposite = |x: &[DVec3; 4]| {
                if count == 4 { x[(k + 2) % 4] - x[next] - x[prev] + x[k] } else { DVec3::ZERO }
            };
            let (v, n) = (&patch.corners, &patch.normals);
            let mut base = [DVec3::ZERO; plane_count(9)];
            (base[1], base[2], base[4]) = (v[next] - v[k], v[prev] - v[k], opposite(v));
            let base = if patch.bent {
                let bends = patch.bend_at_corner(k);
                for a in 0..9 {
                    for b in 0..9 - a {
                        base[plane_index(a, b)] +=
                            DVec3::from_array([0, 1, 2].map(|axis| bends[axis].0[a][b]));
                    }
                }
                &base[..]
            } else {
                &base[..6]
            };
            let normal = [n[k], n[next] - n[k], n[prev] - n[k], opposite(n)];
            let jet = corner_jet(implicits[k], &CornerFrame { base, normal }, length, scratch);
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
    pub(crate) fn jet_size(&self) -> (usize, usize) {
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

    /// `L + h N` and the bends.
    #[inline(always)]
    pub(crate) fn lift(&self, h: &Jet2<f64>, at: DVec2) -> Jet2 {
        let [l, n] = [&self.corners, &self.normals].map(|x| self.interpolate(x, at));
        let sum = l.add(n.weighted(h));
        if self.bent() { sum.add(self.bend_jet(at)) } else { sum }
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
        self.lift(&self.height(at), at)
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Bubble { n: self.count as u8 }
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        crate::record::record(self)
    }
}
