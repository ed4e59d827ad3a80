//! The patch with splined boundary data.

use glam::DVec2;
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, SplinePool};

use super::{cubic::Cubic, pieces::Pieces};
use crate::{
    MAX_ORDER,
    cross::{CrossData, cross},
    half::Half,
    height::{Corner, blend, blend_square, plane_jet},
    patch::{BubblePatch, Pairing},
    series,
};

/// A bubble patch whose boundary data are cubic splines.
#[derive(Clone, Debug)]
pub struct SplinePatch {
    /// The exact patch, with the pairing `P₁ ⊕ P₂`.
    pub(crate) exact: BubblePatch,
    pub(crate) intervals: usize,
    pub(crate) exact_height: bool,
    /// Of every half that the pairing takes: its number and the data of cross orders 0 to `n`, along the half.
    pub(crate) data: Vec<(usize, Vec<Datum>)>,
}

/// One datum along an edge.
#[derive(Clone, Debug)]
pub(crate) enum Datum {
    Spline(Cubic),
    /// Monomial coefficients.
    Polynomial(Vec<f64>),
}

impl Datum {
    fn jet(&self, t: f64) -> [f64; 3] {
        match self {
            Self::Spline(s) => s.jet(t),
            Self::Polynomial(c) => {
                let [v, d, dd] =
                    c.iter().rev().fold([0.0; 3], |[v, d, dd], &c| [v * t + c, d * t + v, dd * t + d]);
                [v, d, 2.0 * dd]
            }
        }
    }

    pub(crate) fn pieces(&self, intervals: usize) -> Pieces {
        match self {
            Self::Spline(s) => s.pieces(),
            Self::Polynomial(c) => Pieces::polynomial(intervals, c),
        }
    }
}

/// Barycentric distance from a corner below which the corner's polynomial stands for the height.
const RADIUS: f64 = 1e-4;

impl SplinePatch {
    /// `intervals` at least 4; `exact.order()` at most 2.
    pub(crate) fn new(exact: &BubblePatch, intervals: usize, exact_height: bool) -> Self {
        let mut exact = exact.clone();
        if exact.count == 3 {
            exact.pairing = Pairing::Single([0, 1, 2]);
        }
        let mut data = Vec::with_capacity(4);
        for h in 0..exact.halves() {
            let half = exact.half(h);
            if exact.weights(&half)[0] != 0.0 {
                let datum = |i| datum(&exact, &half, i, intervals, exact_height);
                data.push((h, (0..exact.order + 1).map(datum).collect()));
            }
        }
        Self { exact, intervals, exact_height, data }
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// The jet of the height.
    pub fn height(&self, at: DVec2) -> Jet2<f64> {
        if self.exact.count == 3 {
            let b = [1.0 - at.x - at.y, at.x, at.y];
            for k in 0..3 {
                let (x, y) = (b[(k + 1) % 3], b[(k + 2) % 3]);
                if self.exact.order > 0 && x + y <= RADIUS {
                    return self.exact.corner_height(&Corner { k, x, y });
                }
                // Flat-data patches have no polynomial at corners; there they are those of a point close by.
                if self.exact.order == 0 && x + y < 1e-7 {
                    let mut c = [1e-7; 3];
                    c[k] = 1.0 - 2e-7;
                    let h = self.formula(DVec2::new(c[1], c[2]));
                    return Jet2 { p: if x + y == 0.0 { 0.0 } else { h.p }, ..h };
                }
            }
        }
        self.formula(at)
    }

    fn formula(&self, at: DVec2) -> Jet2<f64> {
        match self.exact.order {
            0 => self.formula_sized::<0>(at),
            1 => self.formula_sized::<1>(at),
            _ => self.formula_sized::<2>(at),
        }
    }

    fn formula_sized<const N: usize>(&self, at: DVec2) -> Jet2<f64> {
        let patch = &self.exact;
        let mut sum = Jet2::default();
        for (h, data) in &self.data {
            let half = patch.half(*h);
            let [_, twist] = patch.weights(&half);
            let [x, lambda, w] = patch.coordinates(&half, at);
            let mut values = [[0.0; 3]; MAX_ORDER + 1];
            for (value, datum) in values.iter_mut().zip(data) {
                *value = datum.jet(lambda);
            }
            patch.subtract_twists::<N>(*h, lambda, twist, &mut values);
            let f = if patch.count == 3 { blend::<N>(x, w, &values) } else { blend_square::<N>(x, &values) };
            sum = sum.add(plane_jet(&f, &patch.gradients(&half)));
        }
        sum
    }
}

/// The datum of cross order `i` along `half`.
fn datum(patch: &BubblePatch, half: &Half, i: usize, intervals: usize, exact_height: bool) -> Datum {
    let strip = patch.strip_of(half);
    if i == 0 && exact_height {
        // From the Bernstein form: Taylor coefficients at the half's own end.
        let [mut c] = crate::newton::horner::<18, 1>(strip.level(0), if half.against { 1.0 } else { 0.0 });
        if half.against {
            c.iter_mut().skip(1).step_by(2).for_each(|c| *c = -*c);
        }
        return Datum::Polynomial(c[..2 * strip.contact() + 2].to_vec());
    }
    let at = |lambda: f64| -> [f64; 3] {
        let t = if half.against { 1.0 - lambda } else { lambda };
        let e: CrossData<6> = match patch.order {
            0 => cross::<0, 6>(strip, t, &patch.leaving(half, lambda)),
            1 => cross::<1, 6>(strip, t, &patch.leaving(half, lambda)),
            _ => cross::<2, 6>(strip, t, &patch.leaving(half, lambda)),
        };
        let e: series::Series<6> = e[i];
        [e[0], if half.against { -e[1] } else { e[1] }, 2.0 * e[2]]
    };
    Datum::Spline(Cubic::new(intervals, [at(0.0), at(1.0)], patch.order == 2, |t| at(t)[0]))
}

impl Patch for SplinePatch {
    fn domain(&self) -> Domain {
        self.exact.domain()
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        self.exact.lift(&self.height(at), at)
    }

    fn kind(&self) -> PatchKind {
        self.exact.kind()
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        crate::record::record_spline(self)
    }
}
