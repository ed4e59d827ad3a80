//! What jumps across one seam, and where.

use std::cmp::Ordering;
use std::f64::consts::PI;

use serde::Serialize;
use suture_surface::{Continuity, EdgeCurve, EdgeRef, Patch, Seam};

use crate::shape::{Shape, regularity};
use crate::{CertifyOptions, Limits};

/// Distances from the ends of a seam that are always sampled: `2⁻¹⁰`, `2⁻²⁰`, `2⁻³⁰`, exact on either side of `1 − t`.
const NEAR_ENDS: [f64; 3] = [1.0 / (1u64 << 30) as f64, 1.0 / (1u64 << 20) as f64, 1.0 / (1u64 << 10) as f64];

/// The largest jump of one measure along a seam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// The largest value sampled; infinite (π for angles) where a side cannot be measured.
    pub value: f64,
    /// Where: parameter on side `a` of the seam.
    pub t: f64,
    /// The drop from there to the lower of the two neighbouring samples: a smooth maximum exceeds `value` by less than this.
    pub within: f64,
}

/// Why a side of a seam could not be measured at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Unmeasured {
    /// The patch has no normal there, not even as a limit that it knows: `S_u` and `S_v` vanish or are parallel.
    Singular,
    /// The patch has a position or derivative there that is not finite.
    NotFinite,
}

/// The first sample of a seam at which a side could not be measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlindSpot {
    /// The side.
    pub side: EdgeRef,
    /// Parameter on side `a` of the seam.
    pub t: f64,
    /// Why.
    pub why: Unmeasured,
}

/// What jumps across one seam.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeamReport {
    /// Its two sides and its claim.
    pub seam: Seam,
    /// What its maker claims.
    pub claimed: Continuity,
    /// What it keeps; `None`: not even positions agree. See [`Certificate::measured`](crate::Certificate::measured).
    pub measured: Option<Continuity>,
    /// Gap relative to the diagonal.
    pub position: Jump,
    /// Angle between the normals, radians.
    pub normal: Jump,
    /// Jump of the shape operator (spectral norm: the largest difference of normal curvature over all directions) relative to
    /// `largest_curvature` or to one over the diagonal, whichever is larger.
    pub curvature: Jump,
    /// Largest absolute principal curvature of both patches along the seam, times the diagonal.
    pub largest_curvature: f64,
    /// Smallest `|S_u × S_v| / (|S_u| |S_v|)` of both patches along the seam.
    pub regularity: f64,
    /// Where a side could not be measured, if anywhere: then the seam measures `C0` at most.
    pub blind_spot: Option<BlindSpot>,
    /// Number of samples.
    pub samples: usize,
}

/// One side of a seam.
pub(crate) struct Side<'a> {
    pub(crate) patch: &'a dyn Patch,
    pub(crate) curve: EdgeCurve<'a>,
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    t: f64,
    /// Position, normal, curvature (times the diagonal).
    jumps: [f64; 3],
    curvature: f64,
    regularity: f64,
    blind: Option<(EdgeRef, Unmeasured)>,
}

/// Measures one seam, its largest jumps sought by halving the intervals beside the worst samples.
pub(crate) fn measure(
    seam: Seam,
    sides: [Side<'_>; 2],
    diagonal: f64,
    options: &CertifyOptions,
) -> SeamReport {
    let take = |t: f64| sample(seam, &sides, diagonal, t);
    let mut samples: Vec<Sample> = start(options.samples).into_iter().map(take).collect();
    for _ in 0..options.refinements {
        let mut fresh: Vec<f64> = (0..3)
            .flat_map(|measure| {
                let worst = worst(&samples, measure);
                let middle = |i: usize, j: usize| 0.5 * (samples[i].t + samples[j].t);
                let before = worst.checked_sub(1).map(|i| middle(i, worst));
                let after = (worst + 1 < samples.len()).then(|| middle(worst, worst + 1));
                before.into_iter().chain(after)
            })
            .collect();
        fresh.sort_by(f64::total_cmp);
        fresh.dedup();
        samples.extend(fresh.into_iter().map(take));
        samples.sort_by(|a, b| a.t.total_cmp(&b.t));
        samples.dedup_by(|a, b| a.t == b.t);
    }
    report(seam, &samples, &options.limits)
}

fn start(count: usize) -> Vec<f64> {
    let last = (count - 1) as f64;
    let half = |i: usize| (0.5 * PI * i as f64 / last).sin().powi(2);
    // Mirrored rather than computed through, so that a seam and its reverse have the same samples.
    let lobatto = (0..count).map(|i| match (2 * i).cmp(&(count - 1)) {
        Ordering::Less => half(i),
        Ordering::Equal => 0.5,
        Ordering::Greater => 1.0 - half(count - 1 - i),
    });
    let mut all: Vec<f64> = lobatto.chain(NEAR_ENDS.into_iter().flat_map(|e| [e, 1.0 - e])).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn sample(seam: Seam, sides: &[Side<'_>; 2], diagonal: f64, t: f64) -> Sample {
    let at = [0, 1].map(|i| sides[i].curve.point(if i == 0 { t } else { seam.opposite(t) }));
    let [a, b] = [0, 1].map(|i| sides[i].patch.jet(at[i]));
    let shapes = [Shape::of(&a), Shape::of(&b).map(|s| if seam.same_direction { s.flipped() } else { s })];
    // Where a patch shrinks to a point its normal has a limit, which it may know. Its curvature there is left to the samples nearby.
    let normals = [0, 1].map(|i| match &shapes[i] {
        Some(shape) => Some(shape.normal),
        None if ![a, b][i].finite() => None,
        None => {
            let limit = sides[i].patch.normal(at[i]).filter(|n| n.is_finite());
            limit.map(|n| if i == 1 && seam.same_direction { -n } else { n })
        }
    });
    let mut blind = None;
    for (jet, (normal, side)) in [a, b].iter().zip(normals.iter().zip([seam.a, seam.b])) {
        if !jet.finite() {
            blind = Some((side, Unmeasured::NotFinite));
            break;
        }
        if normal.is_none() && blind.is_none() {
            blind = Some((side, Unmeasured::Singular));
        }
    }
    let gap = a.p.distance(b.p) / diagonal;
    let (normal, jump) = match (&shapes, &normals) {
        ([Some(a), Some(b)], _) => (a.angle(b), a.jump(b) * diagonal),
        (_, [Some(m), Some(n)]) => (m.cross(*n).length().atan2(m.dot(*n)), 0.0),
        _ => (PI, f64::INFINITY),
    };
    let endless = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
    Sample {
        t,
        jumps: [endless(gap), normal, endless(jump)],
        curvature: shapes.iter().flatten().map(|s| s.curvature() * diagonal).fold(0.0, f64::max),
        regularity: regularity(&a).min(regularity(&b)),
        blind,
    }
}

/// Index of the first largest sample of one measure.
fn worst(samples: &[Sample], measure: usize) -> usize {
    (1..samples.len())
        .fold(0, |w, i| if samples[i].jumps[measure] > samples[w].jumps[measure] { i } else { w })
}

fn report(seam: Seam, samples: &[Sample], limits: &Limits) -> SeamReport {
    let largest_curvature = samples.iter().map(|s| s.curvature).fold(0.0, f64::max);
    let jump = |measure: usize, unit: f64| {
        let w = worst(samples, measure);
        let value = samples[w].jumps[measure];
        let neighbours = [w.checked_sub(1), (w + 1 < samples.len()).then_some(w + 1)];
        let least = neighbours.into_iter().flatten().map(|i| samples[i].jumps[measure]).fold(value, f64::min);
        let within = if value.is_finite() { (value - least) / unit } else { 0.0 };
        Jump { value: value / unit, t: samples[w].t, within }
    };
    // A plane has no curvature to compare with: there the scale of the whole takes its place.
    let (position, normal, curvature) = (jump(0, 1.0), jump(1, 1.0), jump(2, largest_curvature.max(1.0)));
    let blind = |why| {
        let found = samples.iter().find(|s| s.blind.is_some_and(|(_, w)| w == why));
        found.and_then(|s| s.blind.map(|(side, why)| BlindSpot { side, t: s.t, why }))
    };
    SeamReport {
        seam,
        claimed: seam.claimed,
        measured: order(seam.claimed, [position.value, normal.value, curvature.value], limits),
        position,
        normal,
        curvature,
        largest_curvature,
        regularity: samples.iter().map(|s| s.regularity).fold(1.0, f64::min),
        blind_spot: blind(Unmeasured::NotFinite).or_else(|| blind(Unmeasured::Singular)),
        samples: samples.len(),
    }
}

/// The order that jumps keep. Geometry alone tells `G` from nothing; `C` is `G` after the change of parameters that the claim names.
fn order(claimed: Continuity, jumps: [f64; 3], limits: &Limits) -> Option<Continuity> {
    let [position, normal, curvature] = jumps;
    let parametric = |order| match claimed {
        Continuity::C1 | Continuity::C2 => claimed.min(order),
        _ => Continuity::C0,
    };
    if position > limits.position {
        None
    } else if normal > limits.normal {
        Some(Continuity::C0)
    } else if curvature > limits.curvature {
        Some(Continuity::G1.max(parametric(Continuity::C1)))
    } else {
        Some(Continuity::G2.max(parametric(Continuity::C2)))
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;

    #[test]
    fn the_start_holds_both_ends_and_their_neighbourhood() {
        let t = start(17);
        assert_eq!((t.len(), t[0], t[22]), (23, 0.0, 1.0));
        assert!(t[1] < 1e-9 && 1.0 - t[21] < 1e-9 && t[11] == 0.5);
        assert_eq!(start(3).len(), 9);
    }

    /// The half plane above (`1`) or below (`−1`) the x axis in polar coordinates, or a cone: its tip is at `u = 0`.
    #[derive(Debug)]
    struct Fan {
        side: f64,
        slope: f64,
        limit: bool,
    }

    impl Patch for Fan {
        fn domain(&self) -> suture_surface::Domain {
            suture_surface::Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }
        }

        fn jet(&self, at: DVec2) -> suture_surface::Jet2 {
            let (s, c) = (self.side * at.y).sin_cos();
            let out = DVec3::new(c, s, self.slope * at.y);
            let round = DVec3::new(-s * self.side, c * self.side, self.slope);
            let bend = DVec3::new(-c, -s, 0.0);
            suture_surface::Jet2 {
                p: out * at.x,
                du: out,
                dv: round * at.x,
                duu: DVec3::ZERO,
                duv: round,
                dvv: bend * at.x,
            }
        }

        fn kind(&self) -> suture_surface::PatchKind {
            suture_surface::PatchKind::Given
        }

        fn record(&self, _: &mut suture_surface::SplinePool) -> suture_surface::Record {
            unreachable!("nobody saves it")
        }

        fn normal(&self, at: DVec2) -> Option<DVec3> {
            let jet = self.jet(at);
            let limit = suture_surface::Jet2 { dv: jet.duv, ..jet };
            jet.normal().or_else(|| limit.normal().filter(|_| self.limit))
        }
    }

    #[test]
    fn tips_are_measured_by_the_limits_of_their_normals() {
        let seam = |slope: f64, limit: bool| {
            let fan = |side| Box::new(Fan { side, slope, limit }) as Box<dyn Patch>;
            let edge = |patch| EdgeRef { patch: suture_surface::PatchId(patch), edge: 0 };
            let mut seam = Seam::new(edge(0), edge(1), Continuity::G1);
            seam.same_direction = true;
            let surface = suture_surface::Surface::new(vec![fan(1.0), fan(-1.0)], vec![seam]).unwrap();
            crate::certify(&surface, 1.0, &CertifyOptions::default()).unwrap().seams.remove(0)
        };
        // The normals are (0, 0, 1) and, with the slope, (0, ∓slope, 1).
        let flat = seam(0.0, true);
        assert_eq!((flat.measured, flat.blind_spot), (Some(Continuity::G2), None));
        let steep = seam(0.1, true);
        assert!(
            steep.measured == Some(Continuity::C0)
                && (steep.normal.value - 2.0 * 0.1f64.atan()).abs() < 1e-12
        );
        let blind = seam(0.0, false);
        assert_eq!(blind.measured, Some(Continuity::C0));
        assert_eq!(blind.blind_spot.map(|b| (b.t, b.why)), Some((0.0, Unmeasured::Singular)));
    }

    #[test]
    fn the_order_keeps_the_type_of_the_claim() {
        use Continuity::{C0, C1, C2, G1, G2};
        let order = |claimed, p, n, c| super::order(claimed, [p, n, c], &Limits::default());
        assert_eq!(order(C2, 1e-9, 0.0, 0.0), None);
        assert_eq!(order(C2, 0.0, 1e-7, 0.0), Some(C0));
        assert_eq!([C0, G1, C1, G2, C2].map(|c| order(c, 0.0, 0.0, 1e-5)), [G1, G1, C1, G1, C1].map(Some));
        assert_eq!([C0, G1, C1, G2, C2].map(|c| order(c, 0.0, 0.0, 0.0)), [G2, G2, G2, G2, C2].map(Some));
    }
}
