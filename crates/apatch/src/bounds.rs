//! Proofs that every ray meets the surface once: branch and bound over faces and edges (specification, section 6).
//!
//! On a cell of rays, the smallest Bernstein coefficients of `B₀..B₃` are the coefficients of a cubic below all their shooting
//! polynomials; what [`Shooting::required`] asks of that one suffices for all. That is more than some rays need, however small the cell;
//! with the largest coefficients as well it comes down to it ([`Shooting::required_up_to`]). Cells that are not settled are halved.

use std::collections::BinaryHeap;

use crate::cubic::{Cubic, dot};
use crate::edge::{EdgeForm, EdgeSide};
use crate::face::{Base, FaceForm, FaceSide};
use crate::shooting::Shooting;

/// What is known of the rays of a face or an edge on one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Every ray has a minimal root that is simple.
    Proven,
    /// A ray without such a root was found.
    Violated,
    /// The allowance of cells was used up.
    Undecided,
}

type Triangle = [[f64; 3]; 3];

/// Cells of one face and side.
struct FaceCells<'a> {
    form: &'a FaceForm,
    side: &'a FaceSide,
}

impl FaceCells<'_> {
    /// The whole face, by the pieces of its base.
    fn start(&self) -> Vec<(usize, Triangle)> {
        let whole = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let pieces = if matches!(self.form.base, Base::Split(_)) { 3 } else { 1 };
        (0..pieces).map(|k| (k, whole)).collect()
    }

    /// Coordinates on the face of coordinates on a piece.
    fn global(&self, piece: usize, y: [f64; 3]) -> [f64; 3] {
        if !matches!(self.form.base, Base::Split(_)) {
            return y;
        }
        let third = y[0] / 3.0;
        let [a, b] = crate::coefficients::EDGE[piece];
        let mut x = [third; 3];
        x[a] += y[1];
        x[b] += y[2];
        x
    }

    /// Lower bounds of the coefficients, times `s`, on a cell for the apex weight `b`.
    fn lower(&self, s: f64, piece: usize, cell: &Triangle, b: f64) -> Shooting {
        let b0 = match &self.form.base {
            Base::Split(cubics) => cubics[piece].lower(cell, s),
            Base::Rational { cubic, w } => {
                let mut c = cubic.0;
                c[9] = s * lower_mean(w.map(|w| s * w), cell);
                Cubic(c).lower(cell, s)
            }
        };
        let x = cell.map(|y| self.global(piece, y));
        let (h, m) = (self.side.h, self.side.m);
        let mut b1 = f64::INFINITY;
        for i in 0..3 {
            let line = [
                h[0] * x[i][0] + m[2] * x[i][1] + m[1] * x[i][2],
                m[2] * x[i][0] + h[1] * x[i][1] + m[0] * x[i][2],
                m[1] * x[i][0] + m[0] * x[i][1] + h[2] * x[i][2],
            ];
            for y in &x[i..] {
                b1 = b1.min(s * dot(line, *y));
            }
        }
        let r = self.side.q.map(|q| (b + 2.0 * q) / 3.0);
        let b2 = x.iter().fold(f64::INFINITY, |m, x| m.min(s * dot(r, *x)));
        Shooting([b0, b1, b2, s * b])
    }

    /// The shooting polynomial at the middle of a cell.
    fn middle(&self, piece: usize, cell: &Triangle, b: f64) -> Shooting {
        let y = [0, 1, 2].map(|i| (cell[0][i] + cell[1][i] + cell[2][i]) / 3.0);
        let x = self.global(piece, y);
        let (l0, _) = self.form.base.gradient(x);
        let side = FaceSide { b, r: self.side.q.map(|q| (b + 2.0 * q) / 3.0), ..*self.side };
        self.form.shooting(&side, x, l0)
    }
}

/// A lower bound of the mean of `w` with weights `x₁x₂, x₂x₀, x₀x₁` on a cell.
fn lower_mean(w: [f64; 3], cell: &Triangle) -> f64 {
    let [lo, hi] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|f| {
        let x = [0, 1, 2].map(|i| f(f(cell[0][i], cell[1][i]), cell[2][i]));
        [x[1] * x[2], x[2] * x[0], x[0] * x[1]]
    });
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| w[i].total_cmp(&w[j]));
    let least = w[order[0]];
    // The extreme of a weighted mean over a box of weights: the small values get the large weights, from some rank on the reverse.
    let means = (1..3).map(|n| {
        let weight = |rank: usize| if rank < n { hi[order[rank]] } else { lo[order[rank]] };
        let sum: f64 = (0..3).map(weight).sum();
        if sum > 0.0 { (0..3).map(|i| weight(i) * w[order[i]]).sum::<f64>() / sum } else { least }
    });
    means.fold(f64::INFINITY, f64::min).max(least)
}

/// Halves of a triangle across its longest edge.
fn halves(cell: &Triangle) -> [Triangle; 2] {
    let square = |a: usize, b: usize| (0..3).map(|i| (cell[a][i] - cell[b][i]).powi(2)).sum::<f64>();
    let lengths = [square(1, 2), square(2, 0), square(0, 1)];
    let k = (0..3).fold(0, |k, i| if lengths[i] > lengths[k] { i } else { k });
    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
    let middle = [0, 1, 2].map(|i| 0.5 * (cell[a][i] + cell[b][i]));
    let (mut left, mut right) = (*cell, *cell);
    (left[b], right[a]) = (middle, middle);
    [left, right]
}

/// Whether every ray of a face has a simple minimal root on a side when the apex weight is `b`.
pub(crate) fn certify_face(form: &FaceForm, side: &FaceSide, b: f64, limit: usize) -> Verdict {
    let cells = FaceCells { form, side };
    let mut open = cells.start();
    let mut seen = 0;
    while let Some((piece, cell)) = open.pop() {
        seen += 1;
        let low = cells.lower(side.sign, piece, &cell, b);
        if low.is_content() {
            continue;
        }
        let middle = cells.middle(piece, &cell, b);
        // Not `>=`: what is not a number is not proven.
        if !(middle.required_sharp(1.0) < 0.0) {
            return Verdict::Violated;
        }
        if low.required_up_to(&cells.lower(-side.sign, piece, &cell, b).negative()) < 0.0 {
            continue;
        }
        if seen >= limit {
            return Verdict::Undecided;
        }
        open.extend(halves(&cell).map(|c| (piece, c)));
    }
    Verdict::Proven
}

/// The lower bound of a face's apex weight on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceBound {
    /// Attained by a ray: at smaller weights the surface is not single-sheeted. Times the sign of the side.
    pub attained: f64,
    /// Proven: above it every ray has a simple minimal root. Times the sign of the side.
    pub proven: f64,
    /// Number of cells examined.
    pub cells: usize,
}

/// A cell in the queue, the one that asks for most first.
struct Ranked<C> {
    required: f64,
    cell: C,
}

impl<C> PartialEq for Ranked<C> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<C> Eq for Ranked<C> {}

impl<C> PartialOrd for Ranked<C> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<C> Ord for Ranked<C> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.required.total_cmp(&other.required)
    }
}

/// Both bounds, no further apart than `gap` unless the allowance of cells is used up.
pub(crate) fn bound_face(form: &FaceForm, side: &FaceSide, gap: f64, limit: usize) -> FaceBound {
    let cells = FaceCells { form, side };
    let mut attained = f64::NEG_INFINITY;
    let mut heap: BinaryHeap<Ranked<(usize, Triangle)>> = BinaryHeap::new();
    let mut fresh = cells.start();
    let mut seen = 0;
    loop {
        for (piece, cell) in fresh.drain(..) {
            seen += 1;
            let middle = cells.middle(piece, &cell, 0.0);
            attained = attained.max(middle.required_sharp(1.0));
            let low = cells.lower(side.sign, piece, &cell, 0.0);
            let required = low.required_up_to(&cells.lower(-side.sign, piece, &cell, 0.0).negative());
            if required > f64::NEG_INFINITY {
                heap.push(Ranked { required, cell: (piece, cell) });
            }
        }
        let Some(top) = heap.pop() else {
            return FaceBound { attained, proven: attained, cells: seen };
        };
        if top.required <= attained + gap || seen >= limit || !top.required.is_finite() {
            return FaceBound { attained, proven: top.required.max(attained), cells: seen };
        }
        let (piece, cell) = top.cell;
        fresh.extend(halves(&cell).map(|cell| (piece, cell)));
    }
}

/// The parts of an edge, by parameter from `p_i` to `p_j`, over which the surface lies on a side.
pub(crate) fn spans(form: &EdgeForm, sign: f64) -> Vec<[f64; 2]> {
    match EdgeForm::pinch(form.e) {
        None if form.is_nonconvex() => Vec::new(),
        None => vec![[0.0, 1.0]],
        Some(x) if (form.e[0] < 0.0) == (sign > 0.0) => vec![[0.0, x]],
        Some(x) => vec![[x, 1.0]],
    }
}

/// Restricts Bernstein coefficients from `[0, 1]` to `[lo, hi]`.
fn restrict<const N: usize>(mut c: [f64; N], lo: f64, hi: f64) -> [f64; N] {
    // Right end first; then the left end within what remains.
    for r in 1..N {
        for i in (r..N).rev() {
            c[i] = c[i - 1] * (1.0 - hi) + c[i] * hi;
        }
    }
    let at = if hi > 0.0 { lo / hi } else { 0.0 };
    for r in 1..N {
        for i in 0..N - r {
            c[i] = c[i] * (1.0 - at) + c[i + 1] * at;
        }
    }
    c
}

/// Lower bounds of the coefficients, times `s`, on a box of rays.
fn edge_lower(form: &EdgeForm, side: &EdgeSide, s: f64, [xi, y]: Box2) -> Shooting {
    let least = |c: &[f64]| c.iter().fold(f64::INFINITY, |m, c| m.min(s * c));
    let b0 = least(&restrict([0.0, form.e[0], form.e[1], 0.0], xi[0], xi[1]));
    let rows = side.b1.map(|row| restrict(row, xi[0], xi[1]));
    let columns = side.b2.map(|column| restrict(column, y[0], y[1]));
    let (mut b1, mut b2) = (f64::INFINITY, f64::INFINITY);
    for at in y {
        b1 = b1.min(least(&[0, 1, 2].map(|i| rows[0][i] * (1.0 - at) + rows[1][i] * at)));
    }
    for at in xi {
        b2 = b2.min(least(&[0, 1, 2, 3].map(|i| columns[0][i] * (1.0 - at) + columns[1][i] * at)));
    }
    Shooting([b0, b1, b2, least(&restrict(side.b3, y[0], y[1]))])
}

/// Parameters along and across an edge.
pub(crate) type Box2 = [[f64; 2]; 2];

/// Whether every ray of an edge has a simple minimal root on a side; where that is not proven, the cell that asks for most.
pub(crate) fn certify_edge(form: &EdgeForm, side: &EdgeSide, limit: usize) -> (Verdict, Option<Box2>) {
    let mut fresh: Vec<Box2> = spans(form, side.sign).into_iter().map(|s| [s, [0.0, 1.0]]).collect();
    let mut open: BinaryHeap<Ranked<Box2>> = BinaryHeap::new();
    let mut seen = 0;
    loop {
        for cell in fresh.drain(..) {
            seen += 1;
            let low = edge_lower(form, side, side.sign, cell);
            if low.is_content() {
                continue;
            }
            let [x, y] = cell.map(|[a, b]| 0.5 * (a + b));
            let middle = form.shooting(side, x, y);
            if !(middle.required_sharp(1.0) < 0.0) {
                return (Verdict::Violated, Some(cell));
            }
            let required = low.required_up_to(&edge_lower(form, side, -side.sign, cell).negative());
            // Not `>=`: what is not a number is not proven.
            if !(required < 0.0) {
                open.push(Ranked { required, cell });
            }
        }
        // The most demanding first: if a ray is not content, it is found before the allowance is spent on others.
        let Some(Ranked { cell, .. }) = open.pop() else { return (Verdict::Proven, None) };
        if seen >= limit {
            return (Verdict::Undecided, Some(cell));
        }
        let [x, y] = cell.map(|[a, b]| 0.5 * (a + b));
        let [wide, high] = cell.map(|[a, b]| b - a);
        if wide > high {
            fresh.extend([[[cell[0][0], x], cell[1]], [[x, cell[0][1]], cell[1]]]);
        } else {
            fresh.extend([[cell[0], [cell[1][0], y]], [cell[0], [y, cell[1][1]]]]);
        }
    }
}

/// An increment of the weights of the two faces beside an edge, times the sign of the side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Raise {
    /// Of the weight of `u`.
    pub(crate) by: f64,
    /// Of the weight of `u'`, relative to that of `u`.
    pub(crate) ratio: f64,
}

/// What a ray asks for: an increment `D` of its shooting polynomial by `D t²`, and how much of it the weights of `u` and `u'` give.
#[derive(Clone, Copy)]
struct Demand {
    need: f64,
    betas: [f64; 2],
}

impl Demand {
    fn new(form: &EdgeForm, side: &EdgeSide, xi: f64, y: f64) -> Self {
        Self { need: form.shooting(side, xi, y).required_sharp(1.0), betas: side.betas(y) }
    }

    /// The increment of `u` that satisfies the ray if `u'` is raised by `ratio` times that; infinite if none does. Rays that are
    /// content are taken to stay so.
    fn asks(&self, ratio: f64) -> f64 {
        let beta = self.betas[0] + ratio * self.betas[1];
        if beta > 0.0 {
            self.need / beta
        } else if self.need < 0.0 {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        }
    }

    /// The largest increment of `u` in that ratio with which the ray stays content.
    fn bears(&self, ratio: f64) -> f64 {
        let beta = self.betas[0] + ratio * self.betas[1];
        if beta < 0.0 && self.need < 0.0 { self.need / beta } else { f64::INFINITY }
    }
}

/// The smallest increments of the weights of `u` and `u'` after which sampled rays of an edge are content, with a margin; `None` where
/// they are already, unless it is to be done `anyway`, or where no increments help (specification, sections 6 and 9.6). `near` is a cell
/// that holds a ray that is not, or may.
pub(crate) fn raise_edge(
    form: &EdgeForm,
    side: &EdgeSide,
    margin: f64,
    near: Option<Box2>,
    anyway: bool,
) -> Option<Raise> {
    let whole = spans(form, side.sign);
    let spans: Vec<Box2> = whole.into_iter().map(|span| [span, [0.0, 1.0]]).chain(near).collect();
    let grid = |[x, y]: Box2| {
        let at = |[lo, hi]: [f64; 2], i: i32| lo + (hi - lo) * f64::from(i) / 12.0;
        (0..=12).flat_map(move |i| (0..=12).map(move |j| (at(x, i), at(y, j))))
    };
    let rays: Vec<Demand> = spans
        .iter()
        .flat_map(|&cell| grid(cell))
        .map(|(xi, y)| Demand::new(form, side, xi, y))
        .filter(|d| d.need > f64::NEG_INFINITY)
        .collect();
    let total = |ratio: f64| {
        let asks = rays.iter().fold(f64::NEG_INFINITY, |m, d| m.max(d.asks(ratio)));
        let bears = rays.iter().fold(f64::INFINITY, |m, d| m.min(d.bears(ratio)));
        if asks.max(0.0) < bears { (asks.max(0.0) + margin) * (1.0 + ratio) } else { f64::INFINITY }
    };
    let (mu, nu) = (side.mu[3], side.nu[3]);
    let balanced = (mu < 0.0 && nu < 0.0).then(|| mu / nu);
    let mut ratios: Vec<(f64, f64)> = balanced
        .into_iter()
        .chain((-12..=12).map(|n| 2f64.powi(n)))
        .chain([0.0])
        // Equal increments wherever they do nearly as well as others.
        .map(|ratio| (if ratio == 1.0 { 0.5 } else { 1.0 } * total(ratio), ratio))
        .filter(|r| r.0.is_finite())
        .collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Between the samples there may be rays that a ratio does not help.
    let (need, ratio) = ratios
        .into_iter()
        .map(|(_, ratio)| (sharpen(&spans, |xi, y| Demand::new(form, side, xi, y).asks(ratio)), ratio))
        .find(|n| n.0 < f64::INFINITY)?;
    let raise = Raise { by: if anyway { need.max(0.0) } else { need } + margin, ratio };
    // Not for a trifle: the margin need not be met to the last digit.
    ((anyway || need > -0.5 * margin) && raise.by.is_finite() && (raise.by * ratio).is_finite())
        .then_some(raise)
}

/// The largest value found over cells of an edge by sampling finer and finer around the best.
fn sharpen(cells: &[Box2], at: impl Fn(f64, f64) -> f64) -> f64 {
    let mut worst = f64::NEG_INFINITY;
    for &[[lo, hi], [low, high]] in cells {
        let mut centre = (0.5 * (lo + hi), 0.5 * (low + high));
        let mut half = (0.5 * (hi - lo), 0.5 * (high - low));
        for round in 0..4 {
            let n = if round == 0 { 12 } else { 8 };
            let mut best = (f64::NEG_INFINITY, centre);
            for i in 0..=n {
                for j in 0..=n {
                    let part = |k: i32| 2.0 * f64::from(k) / f64::from(n) - 1.0;
                    let x = (centre.0 + half.0 * part(i)).clamp(lo, hi);
                    let y = (centre.1 + half.1 * part(j)).clamp(low, high);
                    let value = at(x, y);
                    if value > best.0 {
                        best = (value, (x, y));
                    }
                }
            }
            worst = worst.max(best.0);
            centre = best.1;
            half = (0.3 * half.0, 0.3 * half.1);
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn restriction_keeps_the_polynomial(c in prop::array::uniform4(-1.0..1.0f64), a in 0.0..1.0f64, b in 0.0..1.0f64, t in 0.0..1.0f64) {
            let value = |c: [f64; 4], t: f64| {
                let s = 1.0 - t;
                c[0] * s * s * s + 3.0 * c[1] * s * s * t + 3.0 * c[2] * s * t * t + c[3] * t * t * t
            };
            let (lo, hi) = (a.min(b), a.max(b));
            prop_assert!((value(restrict(c, lo, hi), t) - value(c, lo * (1.0 - t) + hi * t)).abs() < 1e-13);
        }

        #[test]
        fn no_mean_lies_below_its_bound(
            w in prop::array::uniform3(-2.0..1.0f64), cell in prop::array::uniform3(prop::array::uniform3(0.01..1.0f64)),
            at in prop::array::uniform3(0.01..1.0f64),
        ) {
            let sum: f64 = at.iter().sum();
            let x = [0, 1, 2].map(|i| (0..3).map(|k| at[k] / sum * cell[k][i]).sum::<f64>());
            let a = [x[1] * x[2], x[2] * x[0], x[0] * x[1]];
            prop_assert!(dot(w, a) / (a[0] + a[1] + a[2]) >= lower_mean(w, &cell) - 1e-12);
        }
    }
}
