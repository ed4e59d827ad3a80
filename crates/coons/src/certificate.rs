//! The finite corner certificate: how smoothly a four-sided fill joins, decided at its corners.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::blend::{Blend, BlendFunction};
use crate::constituent::Constituent;
use crate::curve::BorderCurve;
use crate::options::Order;
use crate::taylor::{Enclosure, Expansion, partial};

/// One corner difference `d^j`: derivative `j` of the border curve minus that of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CornerDelta {
    /// 0 for the edge `v = 0` (`r1`), 1 for `v = 1` (`r2`).
    pub edge: u8,
    /// 0 for the side `u = 0` (`r3`), 1 for `u = 1` (`r4`).
    pub side: u8,
    /// `j`.
    pub order: usize,
    /// The difference.
    pub delta: DVec3,
    /// Its length over the diagonal of the gap.
    pub size: f64,
    /// Proven bound of that for the exact surfaces and curves, by interval arithmetic; `None` when one of them is a function that
    /// only machine numbers can be put into.
    pub proven: Option<f64>,
}

/// What the corners say about the edges `v = 0` and `v = 1` of a four-sided fill (specification §2.5): with a blend that is flat
/// of order `k` the jump of `∂ʲ_v` along an edge is the convex combination of the jumps at its two corners.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CornerCertificate {
    /// All differences, by edge, side and order.
    pub deltas: Vec<CornerDelta>,
    /// Diagonal of the gap's bounding box: the unit of all lengths here.
    pub diagonal: f64,
    /// Order to which the blend across the gap is flat.
    pub flat: usize,
    /// The smoothness that is reached with respect to the constituents, which were reparametrised for G¹ and G².
    pub reached: Option<Order>,
    /// Bounds of the jumps of position, first, second (and third) derivatives along both edges, over the diagonal.
    pub jumps: Vec<f64>,
    /// The same, proven; `None` as in [`CornerDelta::proven`].
    pub proven_jumps: Option<Vec<f64>>,
}

/// The parts of a fill that decide.
pub(crate) struct Parts<'a> {
    pub(crate) r: [&'a dyn Constituent; 2],
    pub(crate) borders: [&'a dyn BorderCurve; 2],
    pub(crate) alpha: &'a dyn Blend,
    pub(crate) beta: &'a dyn Blend,
    pub(crate) diagonal: f64,
}

/// Derivatives `0..=3` across the edge at a corner; the third when it is known.
pub(crate) fn corner_jets(r: &dyn Constituent, u: f64, v: f64) -> [Option<DVec3>; 4] {
    let jet = r.jet(glam::DVec2::new(u, v));
    let third = r.expand(&Expansion::u(u), &Expansion::v(v)).map(|p| partial(&p, 0, 3));
    [Some(jet.p), Some(jet.dv), Some(jet.dvv), third]
}

/// Derivatives `0..=3` of a border curve; the third when it is known.
pub(crate) fn border_jets(c: &dyn BorderCurve, v: f64) -> [Option<DVec3>; 4] {
    let [p, d, dd] = c.jet(v);
    let third = c.expand(&Expansion::v(v)).map(|p| partial(&p, 0, 3));
    [Some(p), Some(d), Some(dd), third]
}

/// Corner differences to order `order` (fewer where third derivatives are unknown), without proof.
pub(crate) fn deltas(parts: &Parts<'_>, order: usize) -> Vec<CornerDelta> {
    let mut all = Vec::with_capacity(16);
    for edge in 0..2u8 {
        for side in 0..2u8 {
            let (u, v) = (f64::from(side), f64::from(edge));
            let a = border_jets(parts.borders[side as usize], v);
            let b = corner_jets(parts.r[edge as usize], u, v);
            for j in 0..=order.min(3) {
                if let (Some(a), Some(b)) = (a[j], b[j]) {
                    let delta = a - b;
                    let size = delta.length() / parts.diagonal;
                    all.push(CornerDelta { edge, side, order: j, delta, size, proven: None });
                }
            }
        }
    }
    all
}

/// Encloses the differences: `[edge][side][order]`.
fn enclose(parts: &Parts<'_>, deltas: &mut [CornerDelta]) -> bool {
    let mut all = true;
    for d in deltas {
        let (u, v) = (f64::from(d.side), f64::from(d.edge));
        let curve = parts.borders[d.side as usize].enclose(&Enclosure::v(v));
        let surface = parts.r[d.edge as usize].enclose(&Enclosure::u(u), &Enclosure::v(v));
        d.proven = curve.zip(surface).map(|(c, s)| {
            let square: f64 = (0..3).map(|x| (c[x] - s[x]).partial(0, d.order).magnitude().powi(2)).sum();
            // A square root and a few sums: four units in the last place are more than they lose.
            square.sqrt() / parts.diagonal * (1.0 + 4.0 * f64::EPSILON)
        });
        all &= d.proven.is_some();
    }
    all
}

/// The certificate of a fill to order `order`.
pub(crate) fn certify(parts: &Parts<'_>, order: usize, tolerance: f64) -> CornerCertificate {
    let mut deltas = deltas(parts, order);
    let proven = enclose(parts, &mut deltas);
    let flat = parts.beta.flat().min(3);
    let small = |j: usize| {
        let of: Vec<_> = deltas.iter().filter(|d| d.order == j).collect();
        of.len() == 4 && of.iter().all(|d| d.size <= tolerance)
    };
    let reached = (0..=flat.min(order)).take_while(|&j| small(j)).last().map(Order::parametric);
    let sup = suprema(parts.alpha);
    let known =
        (0..=order.min(flat)).filter(|&j| deltas.iter().filter(|d| d.order == j).count() == 4).count();
    let jumps = |size: &dyn Fn(&CornerDelta) -> f64| -> Vec<f64> {
        // Partials of total order n: ∂ⁱ_u ∂ʲ_v with i + j = n; |d4 − d3| ≤ |d3| + |d4|.
        (0..known)
            .map(|n| {
                (0..=n).fold(0.0, |worst: f64, j| {
                    let at = |edge: u8| {
                        let of: Vec<f64> =
                            deltas.iter().filter(|d| d.order == j && d.edge == edge).map(size).collect();
                        let largest = of.iter().copied().fold(0.0, f64::max);
                        if n == j { largest } else { sup[n - j] * of.iter().sum::<f64>() }
                    };
                    worst.max(at(0)).max(at(1))
                })
            })
            .collect()
    };
    let proven_jumps = proven.then(|| jumps(&|d| d.proven.unwrap_or(f64::INFINITY)));
    let jumps = jumps(&|d| d.size);
    CornerCertificate { jumps, proven_jumps, diagonal: parts.diagonal, flat, reached, deltas }
}

/// Bounds of the absolute values of a blend and its derivatives: the specification's table, rounded up; sampled with a margin of a
/// percent for functions that are not in it.
fn suprema(blend: &dyn Blend) -> [f64; 4] {
    let table = match blend.function() {
        Some(BlendFunction::Polynomial(0)) => Some((1.0, 0.0)),
        Some(BlendFunction::Polynomial(1)) => Some((1.5, 6.0)),
        Some(BlendFunction::Polynomial(2)) => Some((1.875, 5.7735027)),
        Some(BlendFunction::Polynomial(_)) => Some((2.1875, 7.5131885)),
        Some(BlendFunction::Trigonometric(1)) => Some((1.5707964, 4.9348023)),
        Some(BlendFunction::Trigonometric(2)) => Some((1.5707964, 6.6475514)),
        Some(BlendFunction::Trigonometric(3)) => Some((2.3561945, 8.5472922)),
        Some(BlendFunction::Rational(1)) => Some((1.73923799, 8.0)),
        Some(BlendFunction::Rational(2)) => Some((1.87218462, 6.4189490)),
        Some(BlendFunction::Rational(3)) => Some((2.57816517, 11.8058165)),
        _ => None,
    };
    let mut sup = [0.0f64; 4];
    for i in 0..=4096 {
        let jet = blend.jet(f64::from(i) / 4096.0);
        (0..4).for_each(|d| sup[d] = sup[d].max(jet[d].abs()));
    }
    let mut sup = sup.map(|s| s * 1.01);
    if let Some((first, second)) = table {
        (sup[0], sup[1], sup[2]) = (1.0, first, second);
    }
    sup
}
