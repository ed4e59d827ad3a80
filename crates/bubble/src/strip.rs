//! Surface strips: the boundary curve over an edge and the tensors of the surface along it.
//!
//! Along an edge the surface is given by a function `F(t; z) = Σ_k ψ_k(t; z)`, `ψ_k` homogeneous of degree `k ≤ n` in
//! `z = x − p(t)`: gradient, half the Hessian, a sixth of the third derivative, and so on. Both neighbours solve `F = 0` for their
//! heights, hence they meet with order `n`. Its parts belong together only if `∂ψ_k/∂t = ∂_{p′} ψ_{k+1}`; this is enforced where a
//! strip is evaluated ([`crate::cross`]), the strip itself stores the Hermite polynomials before that projection.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{
    BubbleError, MAX_ORDER, bend,
    ends::{end_taylor, line_base},
    implicit::Implicit,
    newton::{horner, newton},
    series::{self, Series},
};

/// Entries of the tensor of degree `k`.
pub(crate) const fn components(k: usize) -> usize {
    (k + 1) * (k + 2) / 2
}

/// Largest number of entries of one tensor.
pub(crate) const MOST: usize = components(MAX_ORDER);

/// A strip over an edge, in its canonical direction `t` from the first end to the second.
///
/// Stored are polynomials in Newton's form with the nodes 0, 1, 0, 1, …: as well conditioned as Bernstein's, cheaper to evaluate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawStrip")]
pub struct Strip {
    order: usize,
    contact: usize,
    ends: [DVec3; 2],
    normals: [DVec3; 2],
    /// Level 0 is `h̃`, level `k` the `components(k)` entries of `ψ_k`, all entries of one coefficient together.
    coefficients: Vec<f64>,
    /// Bernstein coefficients of the curve added to the straight edge; none for most.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    bend: Vec<DVec3>,
}

/// What a strip copies at one end: Taylor coefficients in the parameter that grows from that end (`s = 1 − t` at the second).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EndTaylor {
    /// `h̃`, orders 0 to `2n` (to the contact order for `n = 0`).
    pub height: Vec<f64>,
    /// For every degree `k = 1..=n` the coefficients of `z^β`, `|β| = k` (by falling exponent of x, then of y), each of orders 0 to
    /// `2n − k`: `tensors[k − 1][β][order]`.
    pub tensors: Vec<Vec<Vec<f64>>>,
}

impl Strip {
    /// The strip of order `n ≤ 4` and contact order (`2n` unless `n = 0`) with given Taylor coefficients at both ends.
    ///
    /// # Errors
    /// [`BubbleError::Order`], [`BubbleError::Strip`] (with number 0) when the counts do not fit or a number is not finite.
    pub fn new(
        order: usize,
        contact: usize,
        ends: [DVec3; 2],
        normals: [DVec3; 2],
        data: &[EndTaylor; 2],
    ) -> Result<Self, BubbleError> {
        if order > MAX_ORDER {
            return Err(BubbleError::Order { order, limit: MAX_ORDER });
        }
        let bad = |reason| Err(BubbleError::Strip { strip: 0, reason });
        let counts = Counts { order, contact };
        if !counts.valid() {
            return bad("its contact order is not 2n, or above 8");
        }
        for d in data {
            let heights = d.height.len() == contact + 1;
            let tensors = d.tensors.len() == order
                && d.tensors.iter().zip(1..).all(|(entries, k)| {
                    entries.len() == components(k) && entries.iter().all(|e| e.len() == counts.per_end(k))
                });
            if !heights || !tensors {
                return bad("its Taylor coefficients have the wrong counts");
            }
        }
        let mut coefficients = vec![0.0; counts.total()];
        newton(&data[0].height, &data[1].height, &mut coefficients, 1);
        for k in 1..order + 1 {
            let first = counts.offset(k);
            for entry in 0..components(k) {
                let [a, b] = [0, 1].map(|end| &data[end].tensors[k - 1][entry]);
                newton(a, b, &mut coefficients[first + entry..], components(k));
            }
        }
        Self::checked(Self { order, contact, ends, normals, coefficients, bend: Vec::new() })
    }

    /// The strip between two vertices with their implicits.
    pub(crate) fn between(
        counts: Counts,
        ends: [DVec3; 2],
        normals: [DVec3; 2],
        implicits: [&Implicit; 2],
        bend: Bend,
        scratch: &mut Vec<f64>,
    ) -> Self {
        // The lengths are those of powers of t; one instance per order keeps the loops short.
        match counts.contact {
            0..=2 => Self::between_sized::<3>(counts, ends, normals, implicits, bend, scratch),
            3..=4 => Self::between_sized::<5>(counts, ends, normals, implicits, bend, scratch),
            _ => Self::between_sized::<9>(counts, ends, normals, implicits, bend, scratch),
        }
    }

    fn between_sized<const L: usize>(
        counts: Counts,
        ends: [DVec3; 2],
        normals: [DVec3; 2],
        implicits: [&Implicit; 2],
        bend: Bend,
        scratch: &mut Vec<f64>,
    ) -> Self {
        let mut heights = [[0.0; L]; 2];
        let mut tensors = [[[[0.0; L]; MOST]; MAX_ORDER]; 2];
        for end in 0..2 {
            let (n, m) = (normals[end], normals[1 - end]);
            let mut base = line_base(ends[1 - end] - ends[end]);
            let curve = bend.curve();
            if !curve.is_empty() {
                let extra = bend::taylor::<L>(curve, end);
                for axis in 0..3 {
                    base[axis] = series::add(&base[axis], &extra[axis]);
                }
            }
            heights[end] =
                end_taylor::<L>(counts.order, implicits[end], &base, n, m - n, &mut tensors[end], scratch);
            if matches!(bend, Bend::Whole(_)) {
                // Zero but for rounding: both sides of a crease must have the same curve to the bit.
                heights[end] = [0.0; L];
            }
        }
        Self { bend: bend.curve().to_vec(), ..Self::from_series(counts, ends, normals, heights, &tensors) }
    }

    /// From series in the parameters of the ends.
    pub(crate) fn from_series<const L: usize>(
        counts: Counts,
        ends: [DVec3; 2],
        normals: [DVec3; 2],
        heights: [Series<L>; 2],
        tensors: &[[[Series<L>; MOST]; MAX_ORDER]; 2],
    ) -> Self {
        let mut coefficients = vec![0.0; counts.total()];
        let m = counts.contact + 1;
        newton(&heights[0][..m], &heights[1][..m], &mut coefficients, 1);
        for k in 1..counts.order + 1 {
            let (first, m) = (counts.offset(k), counts.per_end(k));
            for entry in 0..components(k) {
                let [a, b] = [0, 1].map(|end| &tensors[end][k - 1][entry][..m]);
                newton(a, b, &mut coefficients[first + entry..], components(k));
            }
        }
        let bend = Vec::new();
        Self { order: counts.order, contact: counts.contact, ends, normals, coefficients, bend }
    }

    fn checked(self) -> Result<Self, BubbleError> {
        let finite = self.coefficients.iter().all(|c| c.is_finite())
            && self.ends.iter().chain(&self.normals).chain(&self.bend).all(|p| p.is_finite());
        if finite { Ok(self) } else { Err(BubbleError::Strip { strip: 0, reason: "a number is not finite" }) }
    }

    /// The order `n`.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The order to which the boundary curve lies on the implicits of its ends.
    pub fn contact(&self) -> usize {
        self.contact
    }

    /// The ends of the edge.
    pub fn ends(&self) -> [DVec3; 2] {
        self.ends
    }

    /// The normals at the ends, between which N is linear.
    pub fn normals(&self) -> [DVec3; 2] {
        self.normals
    }

    /// Bernstein coefficients of the curve that is added to the straight edge; none where nothing is.
    pub fn bend(&self) -> &[DVec3] {
        &self.bend
    }

    /// Whether every number of it is finite, and its ends are apart.
    pub(crate) fn sound(&self) -> bool {
        self.finite() && self.ends[0] != self.ends[1] && self.normals.iter().all(|n| *n != DVec3::ZERO)
    }

    /// Whether every number of it is finite.
    pub(crate) fn finite(&self) -> bool {
        self.coefficients.iter().all(|c| c.is_finite()) && self.bend.iter().all(|q| q.is_finite())
    }

    /// The Newton coefficients of level `k`, `components(k)` entries each.
    #[inline(always)]
    pub(crate) fn level(&self, k: usize) -> &[f64] {
        let counts = Counts { order: self.order, contact: self.contact };
        &self.coefficients[counts.offset(k)..counts.offset(k + 1)]
    }

    /// Bernstein coefficients of `h̃`, of degree `2 contact + 1` (`4n + 1`).
    pub fn height_bernstein(&self) -> Vec<f64> {
        let degree = 2 * self.contact + 1;
        let [a, b] = self.height_taylor();
        let binomial = suture_bernstein::bernstein::binomial;
        let mut out = vec![0.0; degree + 1];
        for i in 0..self.contact + 1 {
            let sum = |c: &[f64]| (0..i + 1).map(|k| binomial(i, k) / binomial(degree, k) * c[k]).sum();
            out[i] = sum(&a);
            out[degree - i] = sum(&b);
        }
        out
    }

    /// Taylor coefficients of `h̃` at both ends, each in the parameter that grows from its end.
    pub fn height_taylor(&self) -> [Vec<f64>; 2] {
        let m = self.contact + 1;
        let [mut a, mut b] = [0.0, 1.0].map(|t| {
            let [h] = horner::<9, 1>(self.level(0), t);
            h[..m].to_vec()
        });
        a.truncate(m);
        for c in b.iter_mut().skip(1).step_by(2) {
            *c = -*c;
        }
        [a, b]
    }

    /// What the strip copies at both ends, as [`new`](Self::new) takes it.
    pub fn end_taylor(&self) -> [EndTaylor; 2] {
        let counts = Counts { order: self.order, contact: self.contact };
        let heights = self.height_taylor();
        let mut out = heights.map(|height| EndTaylor { height, ..EndTaylor::default() });
        for (end, out) in out.iter_mut().enumerate() {
            let t = end as f64;
            let sign = |i: usize| if end == 1 && i % 2 == 1 { -1.0 } else { 1.0 };
            for k in 1..self.order + 1 {
                let width = components(k);
                let entry = |e: usize| {
                    let column: Vec<f64> = self.level(k).iter().skip(e).step_by(width).copied().collect();
                    let [series] = horner::<9, 1>(&column, t);
                    (0..counts.per_end(k)).map(|i| sign(i) * series[i]).collect()
                };
                out.tensors.push((0..width).map(entry).collect());
            }
        }
        out
    }

    /// The boundary curve: position and first two derivatives at `t`.
    pub fn curve(&self, t: f64) -> [DVec3; 3] {
        let p = self.curve_series::<3>(t);
        let at = |k: usize, c: f64| DVec3::new(p[0][k], p[1][k], p[2][k]) * c;
        [at(0, 1.0), at(1, 1.0), at(2, 2.0)]
    }

    /// `p(t + δ)` as a series in δ.
    #[inline(always)]
    pub(crate) fn curve_series<const L: usize>(&self, t: f64) -> [Series<L>; 3] {
        let [h] = horner::<L, 1>(self.level(0), t);
        let (start, edge) = (self.ends[0] * (1.0 - t) + self.ends[1] * t, self.ends[1] - self.ends[0]);
        let (normal, delta) = (self.normal(t), self.normals[1] - self.normals[0]);
        let p: [Series<L>; 3] = std::array::from_fn(|axis| {
            let (n, d) = (normal[axis], delta[axis]);
            let mut out: Series<L> =
                std::array::from_fn(|k| h[k] * n + if k > 0 { h[k - 1] * d } else { 0.0 });
            out[0] += start[axis];
            if L > 1 {
                out[1] += edge[axis];
            }
            out
        });
        if self.bend.is_empty() {
            return p;
        }
        let bend = bend::series::<L>(&self.bend, t);
        std::array::from_fn(|axis| series::add(&p[axis], &bend[axis]))
    }

    /// The interpolated normal at `t`; exact at both ends.
    #[inline(always)]
    pub(crate) fn normal(&self, t: f64) -> DVec3 {
        self.normals[0] * (1.0 - t) + self.normals[1] * t
    }
}

/// What is read before it is checked.
#[derive(Deserialize)]
struct RawStrip {
    order: usize,
    contact: usize,
    ends: [DVec3; 2],
    normals: [DVec3; 2],
    coefficients: Vec<f64>,
    #[serde(default)]
    bend: Vec<DVec3>,
}

impl TryFrom<RawStrip> for Strip {
    type Error = BubbleError;

    fn try_from(raw: RawStrip) -> Result<Self, BubbleError> {
        let RawStrip { order, contact, ends, normals, coefficients, bend } = raw;
        let counts = Counts { order, contact };
        if !counts.valid() || coefficients.len() != counts.total() {
            return Err(BubbleError::Strip { strip: 0, reason: "its coefficients have the wrong counts" });
        }
        if !bend_fits(&bend, contact) {
            return Err(BubbleError::Strip {
                strip: 0,
                reason: "its bend is too long or does not vanish at its ends",
            });
        }
        Self { order, contact, ends, normals, coefficients, bend }.checked()
    }
}

/// What is added to a straight edge.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Bend<'a> {
    /// Nothing.
    None,
    /// A curve, beside a height.
    Part(&'a [DVec3]),
    /// A curve, instead of a height.
    Whole(&'a [DVec3]),
}

impl<'a> Bend<'a> {
    pub(crate) fn curve(&self) -> &'a [DVec3] {
        match self {
            Self::None => &[],
            Self::Part(curve) | Self::Whole(curve) => curve,
        }
    }
}

/// Whether a bend is no longer than those made here, and vanishes at its ends.
pub(crate) fn bend_fits(bend: &[DVec3], contact: usize) -> bool {
    let zero = |q: Option<&DVec3>| q.is_none_or(|q| *q == DVec3::ZERO);
    bend.len() <= 2 * contact + 4 && zero(bend.first()) && zero(bend.last())
}

/// How many coefficients a strip has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Counts {
    /// The order `n`.
    pub(crate) order: usize,
    /// The contact order of the boundary curve.
    pub(crate) contact: usize,
}

impl Counts {
    pub(crate) fn valid(&self) -> bool {
        self.order <= MAX_ORDER
            && self.contact <= 2 * MAX_ORDER
            && (self.order == 0 || self.contact == 2 * self.order)
    }

    /// Taylor coefficients per end at level `k`: `2n − k + 1`, just as many as the compatibility of twists needs.
    #[inline(always)]
    pub(crate) fn per_end(&self, k: usize) -> usize {
        self.contact + 1 - k
    }

    #[inline(always)]
    fn offset(&self, k: usize) -> usize {
        (0..k).map(|j| 2 * self.per_end(j) * components(j)).sum()
    }

    fn total(&self) -> usize {
        self.offset(self.order + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_boundary_curve_lies_on_its_implicits_to_the_contact_order() {
        let f = Implicit::quadric(DVec3::Z, glam::DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5)));
        let ends = [DVec3::ZERO, DVec3::new(1.0, 0.3, -0.2)];
        let normals = [DVec3::Z, DVec3::new(0.3, 0.1, 0.9)];
        let counts = Counts { order: 2, contact: 4 };
        let strip = Strip::between(counts, ends, normals, [&f, &f], Bend::None, &mut Vec::new());
        let [coarse, fine] = [0.02, 0.01].map(|t| f.value(strip.curve(t)[0]));
        assert!((coarse / fine).log2() > 4.8, "{coarse:e} {fine:e}");
        assert_eq!(strip.curve(0.0)[0], ends[0]);
        assert!(strip.curve(1.0)[0].distance(ends[1]) < 1e-15);
    }
}
