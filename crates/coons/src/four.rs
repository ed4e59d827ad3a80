//! The four-sided fill.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, SplinePool};

use crate::blend::Blend;
use crate::certificate::{self, CornerCertificate, Parts};
use crate::constituent::Constituent;
use crate::curve::{BorderCurve, SumCurve, hermite};
use crate::error::{CoonsError, NAMES};
use crate::geometric;
use crate::options::{FillOptions, Order};
use crate::prepared::{EndSeries, Prepared};
use crate::real::Real;
use crate::record;
use crate::taylor::{Expansion, partial};

type Sheet = Arc<dyn Constituent>;
type Border = Arc<dyn BorderCurve>;

/// The fill of a gap between two surfaces and two curves (Szilvási-Nagy, P. Vendel, Stachel 2002, Equation 1):
///
/// `f = P + (1 − A) (r3 − P(0, v)) + A (r4 − P(1, v))`, `P = (1 − B) r1 + B r2`, `A = α(u)`, `B = β(v)`.
///
/// It runs from `r1(u, 0)` at `v = 0` to `r2(u, 1)` at `v = 1`, and from `r3(v)` at `u = 0` to `r4(v)` at `u = 1`. The correction
/// function of Theorem 3 is nothing but another blend `β`, so that there is none here.
#[derive(Clone, Debug)]
pub struct FourSided {
    pub(crate) r: [Sheet; 2],
    pub(crate) borders: [Border; 2],
    /// The constituents and curves, where there is a faster way to them.
    prepared: [Option<Arc<dyn Prepared>>; 2],
    series: [Option<Arc<EndSeries>>; 2],
    pub(crate) alpha: Arc<dyn Blend>,
    pub(crate) beta: Arc<dyn Blend>,
}

/// A four-sided fill with what is known about it.
#[derive(Clone, Debug)]
pub struct CertifiedFill {
    /// The patch.
    pub patch: FourSided,
    /// How smoothly it joins along `v = 0` and `v = 1`. For G¹ and G² with respect to the reparametrised constituents.
    pub certificate: CornerCertificate,
    /// How far repair has moved the two border curves, over the diagonal; zero without repair.
    pub moved: [f64; 2],
}

impl FourSided {
    /// Fills the gap as smoothly as `options` ask for, or says why it cannot be.
    ///
    /// # Errors
    /// [`CoonsError::Corner`] with edge, side, order, size and limit where a border curve does not join a surface as asked for;
    /// [`CoonsError::Folds`] for G¹ and G²; [`CoonsError::NotFinite`], [`CoonsError::NoExtent`],
    /// [`CoonsError::NoThirdDerivatives`].
    pub fn fill(
        r: [Sheet; 2],
        borders: [Border; 2],
        options: &FillOptions,
    ) -> Result<CertifiedFill, CoonsError> {
        let k = options.order.derivatives();
        let blend: Arc<dyn Blend> = Arc::new(options.family.flat(k));
        Self::fill_with(r, borders, [Arc::clone(&blend), blend], options)
    }

    /// As [`fill`](Self::fill), with blend functions `α` (along the edges) and `β` (across the gap) of the caller's.
    ///
    /// # Errors
    /// As [`fill`](Self::fill); [`CoonsError::Blend`] when `β` is not flat enough.
    pub fn fill_with(
        r: [Sheet; 2],
        mut borders: [Border; 2],
        [alpha, beta]: [Arc<dyn Blend>; 2],
        options: &FillOptions,
    ) -> Result<CertifiedFill, CoonsError> {
        let (order, k) = (options.order, options.order.derivatives());
        if beta.flat() < k {
            return Err(CoonsError::Blend { flat: beta.flat(), asked: order });
        }
        let diagonal = extent(&r, &borders)?;
        let r = if order.geometric() { geometric::reparametrise(&r, &borders, k)? } else { r };
        if order == Order::C3 {
            let at = (Expansion::u(0.0), Expansion::v(0.0));
            let sheets = r.iter().map(|r| r.expand(&at.0, &at.1).is_some());
            let known = sheets.chain(borders.iter().map(|c| c.expand(&at.1).is_some()));
            if let Some((i, _)) = known.enumerate().find(|(_, known)| !known) {
                return Err(CoonsError::NoThirdDerivatives { what: NAMES[i], asked: order });
            }
        }
        let mut moved = [0.0; 2];
        if options.repair {
            for side in 0..2 {
                let before = Arc::clone(&borders[side]);
                // Twice: the second pass removes what the first one rounded.
                for _ in 0..2 {
                    let parts = parts(&r, &borders, &alpha, &beta, diagonal);
                    let deltas = certificate::deltas(&parts, k);
                    let of = |edge: u8| -> Vec<DVec3> {
                        let here = deltas.iter().filter(|d| d.edge == edge && d.side == side as u8);
                        here.map(|d| -d.delta).collect()
                    };
                    let (start, end) = (of(0), of(1));
                    if start.iter().chain(&end).all(|d| *d == DVec3::ZERO) {
                        break;
                    }
                    let correction = hermite(&start, &end)
                        .map_err(|source| CoonsError::Net { what: "repair".into(), source })?;
                    borders[side] = Arc::new(SumCurve(Arc::clone(&borders[side]), Arc::new(correction)));
                }
                moved[side] = (0..=128).fold(0.0, |worst: f64, i| {
                    let t = f64::from(i) / 128.0;
                    worst.max(borders[side].jet(t)[0].distance(before.jet(t)[0]) / diagonal)
                });
            }
        }
        let parts = parts(&r, &borders, &alpha, &beta, diagonal);
        let certificate = certificate::certify(&parts, k, options.tolerance);
        let worst = certificate.deltas.iter().find(|d| !(d.size <= options.tolerance));
        if let Some(d) = worst {
            let (edge, side, order, size) = (d.edge, d.side, d.order, d.size);
            return Err(CoonsError::Corner { edge, side, order, size, limit: options.tolerance });
        }
        Ok(CertifiedFill { patch: Self::raw(r, borders, [alpha, beta]), certificate, moved })
    }

    /// The formula with any constituents, curves and blends, whether or not they fit: what errata are shown with. The certificate
    /// says what it reaches.
    pub fn raw(r: [Sheet; 2], borders: [Border; 2], [alpha, beta]: [Arc<dyn Blend>; 2]) -> Self {
        let prepared = [0, 1].map(|k| r[k].prepare(&[]));
        let series = [0, 1].map(|k| borders[k].data().and_then(|c| EndSeries::new(&c)).map(Arc::new));
        Self { r, borders, prepared, series, alpha, beta }
    }

    /// The corner certificate to order `order ≤ 3`; differences up to `tolerance` of the diagonal count as none.
    ///
    /// # Errors
    /// [`CoonsError::NotFinite`], [`CoonsError::NoExtent`].
    pub fn certificate(&self, order: usize, tolerance: f64) -> Result<CornerCertificate, CoonsError> {
        let diagonal = extent(&self.r, &self.borders)?;
        let parts = parts(&self.r, &self.borders, &self.alpha, &self.beta, diagonal);
        Ok(certificate::certify(&parts, order, tolerance))
    }

    /// The constituents `r1`, `r2`, reparametrised for G¹ and G².
    pub fn constituents(&self) -> &[Sheet; 2] {
        &self.r
    }

    /// The border curves `r3`, `r4`.
    pub fn borders(&self) -> &[Border; 2] {
        &self.borders
    }

    /// Value and partials to second order.
    ///
    /// # Errors
    /// [`CoonsError::Outside`] the unit square or for NaN; [`CoonsError::NotFinite`] where a constituent is not.
    pub fn jet_at(&self, u: f64, v: f64) -> Result<Jet2, CoonsError> {
        if !((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)) {
            return Err(CoonsError::Outside { u, v });
        }
        let jet = self.jet(DVec2::new(u, v));
        if jet.finite() {
            Ok(jet)
        } else {
            Err(CoonsError::NotFinite { what: "the fill", u, v, value: jet.p })
        }
    }

    /// All partials to third order, `[i][j]` for `∂ⁱ_u ∂ʲ_v` with `i + j ≤ 3` (the others are not exact); `None` when a constituent
    /// or curve knows no third derivatives.
    pub fn partials(&self, at: DVec2) -> Option<[[DVec3; 4]; 4]> {
        let f = self.expand_at(at)?;
        Some([0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| partial(&f, i, j))))
    }

    /// The formula as it stands in Equation 1, in expansions: nothing of `jet` enters here.
    fn expand_at(&self, at: DVec2) -> Option<[Expansion; 3]> {
        let (u, v) = (Expansion::u(at.x), Expansion::v(at.y));
        let series = |j: [f64; 4]| [j[0], j[1], j[2] / 2.0, j[3] / 6.0];
        let (a, b) = (u.apply(&series(self.alpha.jet(at.x))), v.apply(&series(self.beta.jet(at.y))));
        let one = Expansion::of(1.0);
        let p = |u: &Expansion| -> Option<[Expansion; 3]> {
            let (x, y) = (self.r[0].expand(u, &v)?, self.r[1].expand(u, &v)?);
            Some([0, 1, 2].map(|i| (one - b) * x[i] + b * y[i]))
        };
        let (inner, p0, p1) = (p(&u)?, p(&Expansion::of(0.0))?, p(&one)?);
        let (r3, r4) = (self.borders[0].expand(&v)?, self.borders[1].expand(&v)?);
        Some([0, 1, 2].map(|i| inner[i] + (one - a) * (r3[i] - p0[i]) + a * (r4[i] - p1[i])))
    }

    /// Constituent `k` at `at`, and its value and two derivatives in `v` on both sides.
    #[inline]
    fn constituent(&self, k: usize, at: DVec2) -> (Jet2, [[DVec3; 3]; 2]) {
        if let Some(fast) = &self.prepared[k] {
            return fast.jet_and_sides(at);
        }
        let side = |u: f64| {
            let j = self.r[k].jet(DVec2::new(u, at.y));
            [j.p, j.dv, j.dvv]
        };
        (self.r[k].jet(at), [side(0.0), side(1.0)])
    }

    #[inline]
    fn border(&self, side: usize, v: f64) -> [DVec3; 3] {
        self.series[side].as_ref().map_or_else(|| self.borders[side].jet(v), |s| s.jet(v))
    }
}

impl Patch for FourSided {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }
    }

    /// Specification §2.1.
    fn jet(&self, at: DVec2) -> Jet2 {
        let (a, b) = (self.alpha.jet(at.x), self.beta.jet(at.y));
        let skip = unused(&b);
        let part = |k: usize| if skip[k] { Default::default() } else { self.constituent(k, at) };
        let ((x, x_sides), (y, y_sides)) = (part(0), part(1));
        let p = mix_jets(&x, &y, &b);
        let e = [0, 1].map(|side| {
            let (c, p) = (self.border(side, at.y), mix_column(&x_sides[side], &y_sides[side], &b));
            [c[0] - p[0], c[1] - p[1], c[2] - p[2]]
        });
        let [e0, e1] = e;
        // On the sides themselves the curves are met to the bit.
        let value = if a[0] == 0.0 && at.x == 0.0 {
            self.borders[0].jet(at.y)[0]
        } else if a[0] == 1.0 && at.x == 1.0 {
            self.borders[1].jet(at.y)[0]
        } else {
            p.p + e0[0] * (1.0 - a[0]) + e1[0] * a[0]
        };
        Jet2 {
            p: value,
            du: p.du + (e1[0] - e0[0]) * a[1],
            dv: p.dv + e0[1] * (1.0 - a[0]) + e1[1] * a[0],
            duu: p.duu + (e1[0] - e0[0]) * a[2],
            duv: p.duv + (e1[1] - e0[1]) * a[1],
            dvv: p.dvv + e0[2] * (1.0 - a[0]) + e1[2] * a[0],
        }
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Fill { sides: 4 }
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        record::four(self, pool)
    }
}

/// Which constituents have no weight, and no derivative of a weight, at `B = b`: they need not be defined there.
#[inline]
pub(crate) fn unused(b: &[f64; 4]) -> [bool; 2] {
    let flat = b[1] == 0.0 && b[2] == 0.0;
    [flat && b[0] == 1.0, flat && b[0] == 0.0]
}

/// `P = (1 − B) r1 + B r2` with its partials.
#[inline]
pub(crate) fn mix(r: &[Sheet; 2], at: DVec2, b: &[f64; 4], skip: [bool; 2]) -> Jet2 {
    let jet = |k: usize| if skip[k] { Jet2::default() } else { r[k].jet(at) };
    mix_jets(&jet(0), &jet(1), b)
}

#[inline]
fn mix_jets(x: &Jet2, y: &Jet2, b: &[f64; 4]) -> Jet2 {
    let c = 1.0 - b[0];
    // Products with both weights rather than x + B (y − x): exact at both ends, so that neighbours share bits.
    let sum = |x: DVec3, y: DVec3| x * c + y * b[0];
    Jet2 {
        p: sum(x.p, y.p),
        du: sum(x.du, y.du),
        dv: sum(x.dv, y.dv) + (y.p - x.p) * b[1],
        duu: sum(x.duu, y.duu),
        duv: sum(x.duv, y.duv) + (y.du - x.du) * b[1],
        dvv: sum(x.dvv, y.dvv) + (y.dv - x.dv) * (2.0 * b[1]) + (y.p - x.p) * b[2],
    }
}

/// `P` on a side, with two derivatives in `v`.
#[inline]
fn mix_column(x: &[DVec3; 3], y: &[DVec3; 3], b: &[f64; 4]) -> [DVec3; 3] {
    let c = 1.0 - b[0];
    [
        x[0] * c + y[0] * b[0],
        x[1] * c + y[1] * b[0] + (y[0] - x[0]) * b[1],
        x[2] * c + y[2] * b[0] + (y[1] - x[1]) * (2.0 * b[1]) + (y[0] - x[0]) * b[2],
    ]
}

fn parts<'a>(
    r: &'a [Sheet; 2],
    borders: &'a [Border; 2],
    alpha: &'a Arc<dyn Blend>,
    beta: &'a Arc<dyn Blend>,
    diagonal: f64,
) -> Parts<'a> {
    Parts {
        r: [r[0].as_ref(), r[1].as_ref()],
        borders: [borders[0].as_ref(), borders[1].as_ref()],
        alpha: alpha.as_ref(),
        beta: beta.as_ref(),
        diagonal,
    }
}

/// Diagonal of the box around the four sides; all of them finite.
fn extent(r: &[Sheet; 2], borders: &[Border; 2]) -> Result<f64, CoonsError> {
    let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut add = |what, u, v, value: DVec3, rest: &[DVec3]| {
        if let Some(&value) = std::iter::once(&value).chain(rest).find(|p| !p.is_finite()) {
            return Err(CoonsError::NotFinite { what, u, v, value });
        }
        bounds = (bounds.0.min(value), bounds.1.max(value));
        Ok(())
    };
    for i in 0..=16 {
        let t = f64::from(i) / 16.0;
        for k in 0..2 {
            let v = k as f64;
            let j = r[k].jet(DVec2::new(t, v));
            add(NAMES[k], t, v, j.p, &[j.du, j.dv, j.duu, j.duv, j.dvv])?;
            let j = borders[k].jet(t);
            add(NAMES[k + 2], v, t, j[0], &j[1..])?;
        }
    }
    let diagonal = bounds.0.distance(bounds.1);
    if diagonal > 0.0 && diagonal.is_finite() { Ok(diagonal) } else { Err(CoonsError::NoExtent { diagonal }) }
}
