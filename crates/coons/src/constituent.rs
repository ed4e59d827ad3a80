//! Constituents: the surfaces that a fill blends, extended over the gap.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_bernstein::BSplineSurface;
use suture_surface::{Jet2, Patch, Record, SplinePool};

use crate::curve::{BorderCurve, curve_jet};
use crate::prepared::{Prepared, prepare_spline};
use crate::real::Real;
use crate::record;
use crate::spline::spline_surface;
use crate::taylor::{Enclosure, Expansion};

/// A surface that a fill blends, defined over the gap: one method to write.
pub trait Constituent: Send + Sync + std::fmt::Debug {
    /// Value and partials to second order. Exact derivatives, no differences.
    fn jet(&self, at: DVec2) -> Jet2;

    /// The coordinates at expanded parameters; `None` when only [`jet`](Self::jet) is known, which is enough up to C².
    fn expand(&self, _u: &Expansion, _v: &Expansion) -> Option<[Expansion; 3]> {
        None
    }

    /// As [`expand`](Self::expand), enclosed in intervals; `None` leaves the corner certificate without proof.
    fn enclose(&self, _u: &Enclosure, _v: &Enclosure) -> Option<[Enclosure; 3]> {
        None
    }

    /// The surface after `maps`, the first one applied first, prepared for many evaluations over one gap; `None` when there is no faster way
    /// than through [`jet`](Self::jet).
    fn prepare(&self, _maps: &[Map]) -> Option<Arc<dyn Prepared>> {
        None
    }

    /// The surface as data; `None` when it cannot be saved.
    fn record(&self, _pool: &mut SplinePool) -> Option<Record> {
        None
    }
}

impl Constituent for Arc<dyn Constituent> {
    fn jet(&self, at: DVec2) -> Jet2 {
        (**self).jet(at)
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        (**self).expand(u, v)
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        (**self).enclose(u, v)
    }

    fn prepare(&self, maps: &[Map]) -> Option<Arc<dyn Prepared>> {
        (**self).prepare(maps)
    }

    fn record(&self, pool: &mut SplinePool) -> Option<Record> {
        (**self).record(pool)
    }
}

/// A B-spline surface; beyond its domain the border pieces continue.
#[derive(Clone, Debug)]
pub struct Spline(pub Arc<BSplineSurface<DVec3>>);

impl Constituent for Spline {
    #[inline]
    fn jet(&self, at: DVec2) -> Jet2 {
        self.0.jet(at)
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        Some(spline_surface(&self.0, *u, *v))
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        Some(spline_surface(&self.0, *u, *v))
    }

    fn prepare(&self, maps: &[Map]) -> Option<Arc<dyn Prepared>> {
        prepare_spline(&self.0, maps)
    }

    fn record(&self, pool: &mut SplinePool) -> Option<Record> {
        Some(Record { kind: record::SPLINE.into(), data: pool.index(&self.0).into() })
    }
}

/// A constituent from a function that returns its jet.
pub fn constituent_fn(f: impl Fn(DVec2) -> Jet2 + Send + Sync + 'static) -> Arc<dyn Constituent> {
    Arc::new(FnConstituent(f))
}

struct FnConstituent<F>(F);

impl<F> std::fmt::Debug for FnConstituent<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FnConstituent")
    }
}

impl<F: Fn(DVec2) -> Jet2 + Send + Sync> Constituent for FnConstituent<F> {
    fn jet(&self, at: DVec2) -> Jet2 {
        (self.0)(at)
    }
}

/// Any patch, taken as it is: it must be defined over the gap.
#[derive(Clone, Debug)]
pub struct PatchSheet(pub Arc<dyn Patch>);

impl Constituent for PatchSheet {
    fn jet(&self, at: DVec2) -> Jet2 {
        self.0.jet(at)
    }

    fn record(&self, pool: &mut SplinePool) -> Option<Record> {
        let data = serde_json::to_value(self.0.record(pool)).ok()?;
        Some(Record { kind: record::PATCH.into(), data })
    }
}

/// A map between parameter planes, quadratic in `v` and linear in `u`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Map {
    /// `origin + u U + v V`.
    Affine {
        /// Image of the origin.
        origin: DVec2,
        /// Image of the first direction.
        u: DVec2,
        /// Image of the second direction.
        v: DVec2,
    },
    /// `(u + ψ(u) w + χ(u) w²/2, at + λ(u) w + κ(u) w²/2)` with `w = v − at` and functions linear in `u`, given by their values at
    /// `u = 0` and `u = 1`: the change of parameters that leaves the edge `v = at` where it is (specification §2.4).
    Edge {
        /// The edge: 0 or 1.
        at: f64,
        /// Shear `ψ`.
        psi: [f64; 2],
        /// Speed `λ`.
        lambda: [f64; 2],
        /// Bend along the edge `χ`.
        chi: [f64; 2],
        /// Bend across the edge `κ`.
        kappa: [f64; 2],
    },
    /// `e(u) + v (e(u) − apex)`, `e(u) = (1 − u) from + u to`: for `v < 0` the part of a convex domain between an edge and a point
    /// inside, for `v > 0` beyond the edge.
    Away {
        /// `e(0)`.
        from: DVec2,
        /// `e(1)`.
        to: DVec2,
        /// The point that `v = −1` is mapped to.
        apex: DVec2,
        /// Factor of `v`.
        reach: f64,
    },
}

impl Map {
    /// Whether every number is finite.
    pub fn valid(&self) -> bool {
        match self {
            Self::Affine { origin, u, v } => [origin, u, v].iter().all(|p| p.is_finite()),
            Self::Away { from, to, apex, reach } => {
                reach.is_finite() && [from, to, apex].iter().all(|p| p.is_finite())
            }
            Self::Edge { at, psi, lambda, chi, kappa } => {
                at.is_finite() && [psi, lambda, chi, kappa].iter().all(|p| p.iter().all(|x| x.is_finite()))
            }
        }
    }

    /// Value and partials.
    #[inline]
    pub fn jet(&self, at: DVec2) -> Jet2<DVec2> {
        match *self {
            Self::Affine { origin, u, v } => {
                Jet2 { p: origin + u * at.x + v * at.y, du: u, dv: v, ..Jet2::default() }
            }
            Self::Away { from, to, apex, reach } => {
                let (e, d, w) = (from * (1.0 - at.x) + to * at.x, to - from, reach * at.y);
                let away = e - apex;
                let (du, duv) = (d * (1.0 + w), d * reach);
                Jet2 { p: e + away * w, du, dv: away * reach, duv, ..Jet2::default() }
            }
            Self::Edge { at: edge, psi, lambda, chi, kappa } => {
                let w = at.y - edge;
                let line = |f: [f64; 2]| (f[0] * (1.0 - at.x) + f[1] * at.x, f[1] - f[0]);
                let pair = |a: [f64; 2], b: [f64; 2]| {
                    let ((a, da), (b, db)) = (line(a), line(b));
                    (DVec2::new(a, b), DVec2::new(da, db))
                };
                let ((first, dfirst), (second, dsecond)) = (pair(psi, lambda), pair(chi, kappa));
                Jet2 {
                    p: DVec2::new(at.x, edge) + first * w + second * (0.5 * w * w),
                    du: DVec2::X + dfirst * w + dsecond * (0.5 * w * w),
                    dv: first + second * w,
                    duu: DVec2::ZERO,
                    duv: dfirst + dsecond * w,
                    dvv: second,
                }
            }
        }
    }

    fn at<R: Real>(&self, u: R, v: R) -> [R; 2] {
        let c = R::of;
        match *self {
            Self::Affine { origin, u: a, v: b } => [0, 1].map(|i| c(origin[i]) + c(a[i]) * u + c(b[i]) * v),
            Self::Away { from, to, apex, reach } => [0, 1].map(|i| {
                let e = c(from[i]) * (c(1.0) - u) + c(to[i]) * u;
                e + (e - c(apex[i])) * c(reach) * v
            }),
            Self::Edge { at, psi, lambda, chi, kappa } => {
                let w = v - c(at);
                let line = |f: [f64; 2]| c(f[0]) * (c(1.0) - u) + c(f[1]) * u;
                let half = c(0.5) * w * w;
                [u + line(psi) * w + line(chi) * half, c(at) + line(lambda) * w + line(kappa) * half]
            }
        }
    }
}

/// A constituent in other parameters: `inner ∘ map`.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// The surface.
    pub inner: Arc<dyn Constituent>,
    /// From the gap's parameters to those of the surface.
    pub map: Map,
}

impl Constituent for Mapped {
    #[inline]
    fn jet(&self, at: DVec2) -> Jet2 {
        let map = self.map.jet(at);
        self.inner.jet(map.p).compose(&map)
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        let [a, b] = self.map.at(*u, *v);
        self.inner.expand(&a, &b)
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        let [a, b] = self.map.at(*u, *v);
        self.inner.enclose(&a, &b)
    }

    fn prepare(&self, maps: &[Map]) -> Option<Arc<dyn Prepared>> {
        self.inner.prepare(&[maps, &[self.map]].concat())
    }

    fn record(&self, pool: &mut SplinePool) -> Option<Record> {
        let data = record::MappedData { inner: self.inner.record(pool)?, map: self.map };
        Some(Record { kind: record::MAPPED.into(), data: serde_json::to_value(data).ok()? })
    }
}

/// The polynomial continuation of boundary data across an edge: `Σ_j w^j/j! c_j(u)`, `w = v − at`, with `c_j = ∂ʲ_v r(u, at)`. Takes the
/// place of a surface that does not exist over the gap.
#[derive(Clone, Debug)]
pub struct Ribbon {
    /// The edge: `v = at`.
    pub at: f64,
    /// `c_0, c_1, …` as functions of `u`: positions, then derivatives across the edge; at most 4.
    pub curves: Vec<Arc<dyn BorderCurve>>,
}

impl Constituent for Ribbon {
    fn jet(&self, at: DVec2) -> Jet2 {
        let w = at.y - self.at;
        // wʲ/j! with its derivatives.
        let mut power = [1.0, 0.0, 0.0];
        let mut jet = Jet2::default();
        for (j, curve) in self.curves.iter().enumerate() {
            let [p, d, dd] = curve.jet(at.x);
            jet.p += p * power[0];
            jet.du += d * power[0];
            jet.dv += p * power[1];
            jet.duu += dd * power[0];
            jet.duv += d * power[1];
            jet.dvv += p * power[2];
            power = [power[0] * w / (j + 1) as f64, power[0], power[1]];
        }
        jet
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        let curves = self.curves.iter().map(|c| c.expand(u)).collect::<Option<Vec<_>>>()?;
        Some(ribbon(&curves, *v - Expansion::of(self.at)))
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        let curves = self.curves.iter().map(|c| c.enclose(u)).collect::<Option<Vec<_>>>()?;
        Some(ribbon(&curves, *v - Enclosure::of(self.at)))
    }

    fn record(&self, _: &mut SplinePool) -> Option<Record> {
        let curves = self.curves.iter().map(|c| c.data()).collect::<Option<_>>()?;
        let data = serde_json::to_value(record::RibbonData { at: self.at, curves }).ok()?;
        Some(Record { kind: record::RIBBON.into(), data })
    }
}

fn ribbon<R: Real>(curves: &[[R; 3]], w: R) -> [R; 3] {
    let mut power = R::of(1.0);
    let mut sum = [R::of(0.0); 3];
    for (j, c) in curves.iter().enumerate() {
        sum = [0, 1, 2].map(|i| sum[i] + c[i] * power);
        power = power * w * R::of((j + 1) as f64).recip();
    }
    sum
}

/// The [`Ribbon`] of a constituent's own boundary jets: takes the place of a surface that runs astray over the gap.
#[derive(Clone, Debug)]
pub struct EdgeRibbon {
    of: Arc<dyn Constituent>,
    order: usize,
    ribbon: Ribbon,
}

impl EdgeRibbon {
    /// The polynomial continuation of degree `order ≤ 3` across the edge `v = at`; `None` when the constituent cannot be expanded.
    pub fn new(of: Arc<dyn Constituent>, at: f64, order: usize) -> Option<Self> {
        of.expand(&Expansion::u(0.0), &Expansion::v(at))?;
        let order = order.min(3);
        let curve = |j| -> Arc<dyn BorderCurve> { Arc::new(EdgeDerivative { of: Arc::clone(&of), at, j }) };
        let curves = (0..=order).map(curve).collect();
        Some(Self { of, order, ribbon: Ribbon { at, curves } })
    }
}

impl Constituent for EdgeRibbon {
    fn jet(&self, at: DVec2) -> Jet2 {
        self.ribbon.jet(at)
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        self.ribbon.expand(u, v)
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        self.ribbon.enclose(u, v)
    }

    fn record(&self, pool: &mut SplinePool) -> Option<Record> {
        let (at, order) = (self.ribbon.at, self.order);
        let data = record::EdgeRibbonData { inner: self.of.record(pool)?, at, order };
        Some(Record { kind: record::EDGE_RIBBON.into(), data: serde_json::to_value(data).ok()? })
    }
}

/// `u ↦ ∂ʲ_v r(u, at)`.
#[derive(Clone, Debug)]
struct EdgeDerivative {
    of: Arc<dyn Constituent>,
    at: f64,
    j: usize,
}

impl BorderCurve for EdgeDerivative {
    fn jet(&self, t: f64) -> [DVec3; 3] {
        self.expand(&Expansion::v(t)).map_or([DVec3::NAN; 3], |p| curve_jet(&p))
    }

    fn expand(&self, t: &Expansion) -> Option<[Expansion; 3]> {
        // The edge runs along the first variable of the constituent; the derivative is re-expanded in the parameter given.
        let p = self.of.expand(&Expansion::u(t.mid()), &Expansion::v(self.at))?;
        Some(p.map(|x| t.apply(&[0, 1, 2, 3].map(|i| x.0[i][self.j] * FACTORIAL[self.j]))))
    }

    fn enclose(&self, t: &Enclosure) -> Option<[Enclosure; 3]> {
        let m = t.mid();
        // Only where the parameter is a number: elsewhere the expansion would have to be over an interval.
        if t.0[0][0] != Real::of(m) {
            return None;
        }
        let p = self.of.enclose(&Enclosure::u(m), &Enclosure::v(self.at))?;
        Some(p.map(|x| t.apply(&[0, 1, 2, 3].map(|i| x.0[i][self.j] * Real::of(FACTORIAL[self.j])))))
    }
}

const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];

/// A patch continued beyond one of its edges by reflection, with values of the inside alone: `r̂(u, −w) = Σ a_i r(u, λ_i w)`, `λ_i = 1, 1/2,
/// …, 1/(k + 1)`, `Σ a_i (−λ_i)ʲ = 1` for `j = 0..=k`, is a `C^k` continuation of any patch (M. R. Hestenes, *Extension of the range of a
/// differentiable function*, 1941), exact for polynomials of degree `k`. The parameter `v` is 0 on the edge and negative inside.
#[derive(Clone, Debug)]
pub struct Reflected {
    /// The patch, in parameters where the edge is `v = 0` and the inside `v < 0`, down to `v = −1`.
    pub inner: Arc<dyn Constituent>,
    /// Order `k ≤ 3`.
    pub order: usize,
}

impl Reflected {
    /// `(a_i, −λ_i)`.
    fn terms(&self) -> impl Iterator<Item = (f64, f64)> {
        let k = self.order.min(3);
        let x = |i: usize| -1.0 / (i + 1) as f64;
        (0..=k).map(move |i| {
            let others = (0..=k).filter(|&m| m != i);
            (others.map(|m| (1.0 - x(m)) / (x(i) - x(m))).product(), x(i))
        })
    }
}

impl Constituent for Reflected {
    fn jet(&self, at: DVec2) -> Jet2 {
        if at.y <= 0.0 {
            return self.inner.jet(at);
        }
        self.terms().fold(Jet2::default(), |sum, (a, s)| {
            let j = self.inner.jet(DVec2::new(at.x, at.y * s));
            sum.add(Jet2 {
                p: j.p * a,
                du: j.du * a,
                dv: j.dv * (a * s),
                duu: j.duu * a,
                duv: j.duv * (a * s),
                dvv: j.dvv * (a * s * s),
            })
        })
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        if v.mid() <= 0.0 {
            return self.inner.expand(u, v);
        }
        self.terms().try_fold([Expansion::of(0.0); 3], |sum, (a, s)| {
            let x = self.inner.expand(u, &v.scale(s))?;
            Some([0, 1, 2].map(|i| sum[i] + x[i].scale(a)))
        })
    }

    fn record(&self, pool: &mut SplinePool) -> Option<Record> {
        let data = record::ReflectedData { inner: self.inner.record(pool)?, order: self.order };
        Some(Record { kind: record::REFLECTED.into(), data: serde_json::to_value(data).ok()? })
    }
}
