//! The three-sided fill.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, SplinePool};

use crate::blend::Blend;
use crate::constituent::Constituent;
use crate::error::{CoonsError, NAMES};
use crate::four::{mix, unused};
use crate::options::{FillOptions, Order};
use crate::record;

type Sheet = Arc<dyn Constituent>;

/// The fill of a hole between three surfaces (Szilvási-Nagy, P. Vendel, Stachel 2002, Equation 2):
///
/// `f = P + A W`, `P = (1 − B) r1 + B r2`, `W = r3 − P − (1 − B) t0 − B t1`, `t0 = (r3 − r1)(u, 0)`, `t1 = (r3 − r2)(u, 1)`.
///
/// It meets `r1` along `v = 0`, `r2` along `v = 1` and `r3` along `u = 1`. Where `r1(0, v) = r2(0, v)` is one point, the tip, the edge `u = 0`
/// shrinks to it; otherwise that edge is `P(0, v)`.
#[derive(Clone, Debug)]
pub struct ThreeSided {
    pair: [Sheet; 2],
    third: Sheet,
    pub(crate) alpha: Arc<dyn Blend>,
    pub(crate) beta: Arc<dyn Blend>,
}

/// A three-sided fill with what is known about it.
#[derive(Clone, Debug)]
pub struct CertifiedHole {
    /// The patch.
    pub patch: ThreeSided,
    /// How smoothly it joins.
    pub certificate: HoleCertificate,
}

/// How smoothly a three-sided fill joins its neighbours.
///
/// The conditions of Theorem 6 hold along edges, not at corners: they are measured at 129 points of every edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HoleCertificate {
    /// Diagonal of the hole's bounding box: the unit of lengths here.
    pub diagonal: f64,
    /// Largest jumps along `v = 0`, `v = 1`, `u = 1` of position, first and second derivatives across the edge (out of the tangent plane
    /// only for G¹), over the diagonal.
    pub jumps: [Vec<f64>; 3],
    /// The tip, when the edge `u = 0` is a point.
    pub tip: Option<Tip>,
    /// What was asked for and is reached.
    pub reached: Order,
}

/// The degenerate edge `u = 0` (specification §3.1).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tip {
    /// The point.
    pub point: DVec3,
    /// Limit of the unit normal; at the tip of a cone that at `v = 0`.
    pub normal: DVec3,
    /// Smallest `(U × U')·n`, `U = f_u(0, v)`; positive for a surface that does not fold. At the tip of a cone the smallest `|U × U'|`, negative
    /// where its direction turns over.
    pub smallest: f64,
    /// Where.
    pub at: f64,
    /// Angle by which `U` turns along the edge, in radians; less than `2π` for a surface that does not overlap itself.
    pub turning: f64,
    /// Largest `|U·n|/|U|`: zero when both surfaces have one tangent plane at the tip. Otherwise the tip is that of a cone.
    pub aslant: f64,
}

/// Samples of every edge.
const SAMPLES: u32 = 128;

impl ThreeSided {
    /// Fills the hole as smoothly as `options` ask for (C⁰, C¹, C² or G¹), or says why it cannot be. Nothing is repaired.
    ///
    /// # Errors
    /// [`CoonsError::ThreeSidedOrder`] for C³ and G²; [`CoonsError::Edge`] with edge, order, place, size and limit where a surface does not fit; [`CoonsError::Folds`] where a neighbour
    /// would be left backwards; [`CoonsError::Tip`] where the fill folds at its tip; [`CoonsError::NotFinite`], [`CoonsError::NoExtent`].
    pub fn fill(r: [Sheet; 3], options: &FillOptions) -> Result<CertifiedHole, CoonsError> {
        let blend: Arc<dyn Blend> = Arc::new(options.family.flat(options.order.derivatives()));
        Self::fill_with(r, [Arc::clone(&blend), blend], options)
    }

    /// As [`fill`](Self::fill), with blend functions `α` (away from the tip) and `β` (round it) of the caller's.
    ///
    /// # Errors
    /// As [`fill`](Self::fill); [`CoonsError::Blend`] when one is not flat enough.
    pub fn fill_with(
        r: [Sheet; 3],
        blends: [Arc<dyn Blend>; 2],
        options: &FillOptions,
    ) -> Result<CertifiedHole, CoonsError> {
        let order = options.order;
        if matches!(order, Order::G2 | Order::C3) {
            return Err(CoonsError::ThreeSidedOrder { asked: order });
        }
        let flat = blends[0].flat().min(blends[1].flat());
        if flat < order.derivatives() {
            return Err(CoonsError::Blend { flat, asked: order });
        }
        let patch = Self::raw(r, blends);
        let diagonal = patch.extent()?;
        let jumps = patch.join(order, diagonal, options.tolerance)?;
        let tip = patch.tip(diagonal, options.tolerance)?;
        Ok(CertifiedHole { patch, certificate: HoleCertificate { diagonal, jumps, tip, reached: order } })
    }

    /// The formula with any constituents and blends, whether or not they fit.
    pub fn raw([r1, r2, r3]: [Sheet; 3], [alpha, beta]: [Arc<dyn Blend>; 2]) -> Self {
        Self { pair: [r1, r2], third: r3, alpha, beta }
    }

    /// The constituents `r1`, `r2`, `r3`.
    pub fn constituents(&self) -> [&Sheet; 3] {
        [&self.pair[0], &self.pair[1], &self.third]
    }

    fn extent(&self) -> Result<f64, CoonsError> {
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for i in 0..=SAMPLES {
            let t = f64::from(i) / f64::from(SAMPLES);
            for (k, at) in
                [DVec2::new(t, 0.0), DVec2::new(t, 1.0), DVec2::new(1.0, t)].into_iter().enumerate()
            {
                let jet = self.constituents()[k].jet(at);
                if !jet.finite() {
                    return Err(CoonsError::NotFinite { what: NAMES[k], u: at.x, v: at.y, value: jet.p });
                }
                bounds = (bounds.0.min(jet.p), bounds.1.max(jet.p));
            }
        }
        let diagonal = bounds.0.distance(bounds.1);
        if diagonal > 0.0 && diagonal.is_finite() {
            Ok(diagonal)
        } else {
            Err(CoonsError::NoExtent { diagonal })
        }
    }

    /// Jumps along the three edges; an error for the first that is too large.
    fn join(&self, order: Order, diagonal: f64, limit: f64) -> Result<[Vec<f64>; 3], CoonsError> {
        let k = order.derivatives();
        let mut jumps: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; k + 1]);
        let mut places = [[0.0; 3]; 3];
        let mut note = |edge: usize, j: usize, at: f64, size: f64| {
            if !(size <= jumps[edge][j]) {
                (jumps[edge][j], places[edge][j]) = (size, at);
            }
        };
        for i in 0..=SAMPLES {
            let t = f64::from(i) / f64::from(SAMPLES);
            let a = self.alpha.jet(t)[0];
            for edge in 0..2 {
                let at = DVec2::new(t, edge as f64);
                let (x, y) = (self.pair[edge].jet(at), self.third.jet(at));
                if i == SAMPLES {
                    note(edge, 0, t, (y.p - x.p).length() / diagonal);
                    // The jumps of the third edge are the convex combinations of these two corners.
                    note(2, 0, at.y, (y.p - x.p).length() / diagonal);
                    if k >= 1 {
                        note(2, 1, at.y, (y.du - x.du).length() / diagonal);
                    }
                    if k >= 2 {
                        note(2, 2, at.y, (y.duu - x.duu).length() / diagonal);
                    }
                }
                let first = (y.dv - x.dv) * a;
                if order == Order::G1 {
                    // Where the neighbour itself is singular, at the tip, there is no plane to miss.
                    if let Some(n) = x.normal() {
                        note(edge, 1, t, first.dot(n).abs() / diagonal);
                        let speed = x.du.cross(x.dv + first).dot(n) / x.du.cross(x.dv).length();
                        if !(speed > 0.0) {
                            return Err(CoonsError::Folds { edge: edge as u8, side: t, speed });
                        }
                    }
                } else if k >= 1 {
                    note(edge, 1, t, first.length() / diagonal);
                    if k >= 2 {
                        note(edge, 2, t, ((y.dvv - x.dvv) * a).length() / diagonal);
                    }
                }
            }
        }
        let names = ["v = 0", "v = 1", "u = 1"];
        for (edge, jumps) in jumps.iter().enumerate() {
            if let Some(j) = jumps.iter().position(|j| !(*j <= limit)) {
                let (size, at) = (jumps[j], places[edge][j]);
                return Err(CoonsError::Edge { edge: names[edge], order: j, at, size, limit });
            }
        }
        Ok(jumps)
    }

    /// `U` and `U'` at the edge `u = 0`.
    fn fan(&self, v: f64) -> [DVec3; 2] {
        let b = self.beta.jet(v);
        let p = mix(&self.pair, DVec2::new(0.0, v), &b, unused(&b));
        [p.du, p.duv]
    }

    fn tip(&self, diagonal: f64, tolerance: f64) -> Result<Option<Tip>, CoonsError> {
        let point = self.pair[0].jet(DVec2::ZERO).p;
        let mut size = 0.0f64;
        for i in 0..=SAMPLES {
            let at = DVec2::new(0.0, f64::from(i) / f64::from(SAMPLES));
            for k in 0..2 {
                size = size.max(self.pair[k].jet(at).p.distance(point) / diagonal);
            }
        }
        if size > tolerance.max(1e-12) {
            return Ok(None);
        }
        let n = 2 * SAMPLES;
        let fans: Vec<[DVec3; 2]> = (0..=n).map(|i| self.fan(f64::from(i) / f64::from(n))).collect();
        let cross = |[u, du]: [DVec3; 2]| u.cross(du);
        let normal = cross(fans[0]).normalize_or_zero();
        let aslant = fans.iter().fold(0.0f64, |w, [u, _]| w.max(u.dot(normal).abs() / u.length()));
        // Without a common tangent plane the tip is that of a cone: its normal may turn, but not over.
        let plane = aslant <= 1e-6;
        let mut tip = Tip { point, normal, smallest: f64::INFINITY, at: 0.0, turning: 0.0, aslant };
        let mut before = normal;
        for (i, &fan) in fans.iter().enumerate() {
            let here = cross(fan);
            let towards = if plane { normal } else { before };
            let value = if plane || here.dot(towards) <= 0.0 { here.dot(towards) } else { here.length() };
            before = here.normalize_or_zero();
            if !(value >= tip.smallest) {
                (tip.smallest, tip.at) = (value, i as f64 / f64::from(n));
            }
            // Trapezoidal rule for the angle.
            let weight = if i == 0 || i + 1 == fans.len() { 0.5 } else { 1.0 };
            tip.turning += weight * value / fan[0].length_squared() / f64::from(n);
        }
        let size = fans.iter().fold(0.0f64, |w, [u, du]| w.max(u.length() * du.length()));
        if tip.smallest > 16.0 * f64::EPSILON * size && tip.turning < 2.0 * std::f64::consts::PI {
            Ok(Some(tip))
        } else {
            Err(CoonsError::Tip { at: tip.at, value: tip.smallest, turning: tip.turning })
        }
    }
}

impl Patch for ThreeSided {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }
    }

    /// Specification §3.
    fn jet(&self, at: DVec2) -> Jet2 {
        let (a, b) = (self.alpha.jet(at.x), self.beta.jet(at.y));
        let p = mix(&self.pair, at, &b, unused(&b));
        if a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0 {
            return p;
        }
        let r3 = self.third.jet(at);
        let t = [0, 1].map(|k| {
            let edge = DVec2::new(at.x, k as f64);
            let (x, y) = (self.third.jet(edge), self.pair[k].jet(edge));
            [x.p - y.p, x.du - y.du, x.duu - y.duu]
        });
        let c = 1.0 - b[0];
        let w = Jet2 {
            p: r3.p - t[0][0] * c - t[1][0] * b[0] - p.p,
            du: r3.du - t[0][1] * c - t[1][1] * b[0] - p.du,
            dv: r3.dv - (t[1][0] - t[0][0]) * b[1] - p.dv,
            duu: r3.duu - t[0][2] * c - t[1][2] * b[0] - p.duu,
            duv: r3.duv - (t[1][1] - t[0][1]) * b[1] - p.duv,
            dvv: r3.dvv - (t[1][0] - t[0][0]) * b[2] - p.dvv,
        };
        p.add(Jet2 {
            p: w.p * a[0],
            du: w.p * a[1] + w.du * a[0],
            dv: w.dv * a[0],
            duu: w.p * a[2] + w.du * (2.0 * a[1]) + w.duu * a[0],
            duv: w.dv * a[1] + w.duv * a[0],
            dvv: w.dvv * a[0],
        })
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Fill { sides: 3 }
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        record::three(self, pool)
    }

    /// At the tip the limit of the normals (specification §3.1).
    fn normal(&self, at: DVec2) -> Option<DVec3> {
        if at.x == 0.0 {
            let [u, du] = self.fan(at.y);
            let jet = Jet2 { du: u, dv: du, ..Jet2::default() };
            // An edge that is not a point has a normal of its own.
            return self.jet(at).normal().or_else(|| jet.normal());
        }
        self.jet(at).normal()
    }
}
