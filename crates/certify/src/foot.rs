//! Foot points: the point of a smooth surface nearest to a point, from a guess.
//!
//! Newton's method on the squared distance within one patch (Hu & Wallner 2005, *A second order algorithm for orthogonal projection
//! onto curves and surfaces*, discuss the choices); where the foot leaves the domain, it goes on from the seam on the other side.

use glam::{DVec2, DVec3};
use suture_surface::{EdgeRef, Patch, PatchId, Surface};

use crate::region::{BoundaryPoint, Region};

/// Newton steps per patch; the guess comes from a tessellation, three to five are usual.
const STEPS: usize = 16;
/// Edges visited at most: enough to walk around a corner.
const HOPS: usize = 16;

/// A point of the surface and its distance from the point asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub(crate) patch: PatchId,
    pub(crate) at: DVec2,
    pub(crate) distance: f64,
}

/// A surface prepared for foot points.
pub(crate) struct Feet<'a> {
    surface: &'a Surface,
    regions: &'a [Region],
    /// The other side of every edge of every patch, and whether it runs in the same direction.
    across: Vec<Vec<Option<(EdgeRef, bool)>>>,
}

impl<'a> Feet<'a> {
    pub(crate) fn new(surface: &'a Surface, regions: &'a [Region]) -> Self {
        let mut across: Vec<Vec<_>> = regions.iter().map(|r| vec![None; r.domain().edge_count()]).collect();
        for seam in surface.seams() {
            for (from, to) in [(seam.a, seam.b), (seam.b, seam.a)] {
                let slot = across.get_mut(from.patch.0 as usize).and_then(|e| e.get_mut(from.edge as usize));
                if let Some(slot) = slot {
                    *slot = Some((to, seam.same_direction));
                }
            }
        }
        Self { surface, regions, across }
    }

    /// The best point of the surface found from the guess `at` of the closed domain of `patch`, the guess included, so that every
    /// distance returned is one to a point of the surface. `None` if the surface is finite at none of the points tried.
    pub(crate) fn find(&self, p: DVec3, patch: PatchId, at: DVec2) -> Option<Foot> {
        let mut best = self.measure(p, patch, at);
        let (mut patch, mut at) = (patch, at);
        // The edge along which `at` is the nearest point already, and the edge over which the search came.
        let (mut slid, mut from) = (None, None);
        for _ in 0..HOPS {
            let (surface, region) = (self.surface.patch(patch)?, self.regions.get(patch.0 as usize)?);
            let (foot, exit) = newton(surface, region, p, at);
            let Some(exit) = exit else {
                keep(&mut best, self.measure(p, patch, foot));
                break;
            };
            let edge = EdgeRef { patch, edge: exit.edge as u32 };
            let Some((t, nearest)) = self.slide(p, edge, exit.t, &mut best) else { break };
            if slid != Some(edge) {
                // Newton's method may overshoot the boundary: only what leads out from the nearest point of the edge leaves.
                (at, slid) = (nearest, Some(edge));
                continue;
            }
            let over = self.across[patch.0 as usize].get(exit.edge).copied().flatten();
            // Without another side, or coming from it, the foot lies on the edge.
            let Some((other, same)) = over.filter(|_| from != Some(edge)) else { break };
            let region = self.regions.get(other.patch.0 as usize)?;
            let Some(curve) = region.domain().edge(other.edge as usize) else { break };
            (patch, at) = (other.patch, curve.point(if same { t } else { 1.0 - t }));
            (slid, from) = (Some(other), Some(other));
            keep(&mut best, self.measure(p, patch, at));
        }
        best
    }

    fn measure(&self, p: DVec3, patch: PatchId, at: DVec2) -> Option<Foot> {
        let distance = self.surface.patch(patch)?.jet(at).p.distance(p);
        distance.is_finite().then_some(Foot { patch, at, distance })
    }

    /// Newton's method along a boundary edge; parameter and point where it ends.
    fn slide(&self, p: DVec3, edge: EdgeRef, t: f64, best: &mut Option<Foot>) -> Option<(f64, DVec2)> {
        let patch = self.surface.patch(edge.patch)?;
        let curve = self.regions.get(edge.patch.0 as usize)?.domain().edge(edge.edge as usize)?;
        let distance = |t: f64| patch.jet(curve.point(t)).p.distance(p);
        let (mut t, mut least) = (t, distance(t));
        for _ in 0..STEPS {
            let [x, d, dd] = curve.jet(t);
            let jet = patch.jet(x);
            let first = jet.du * d.x + jet.dv * d.y;
            let second = jet.duu * (d.x * d.x) + jet.duv * (2.0 * d.x * d.y) + jet.dvv * (d.y * d.y);
            let second = second + jet.du * dd.x + jet.dv * dd.y;
            let r = jet.p - p;
            let flat = first.length_squared();
            let full = flat + r.dot(second);
            let step = -r.dot(first) / if full > 0.1 * flat { full } else { flat };
            let trial = |k: i32| (t + step * 0.5f64.powi(k)).clamp(0.0, 1.0);
            // Halve until the distance falls; NaN falls nowhere.
            let Some(next) = (0..6).map(trial).find(|&next| distance(next) < least) else { break };
            let done = (next - t).abs() < 4.0 * f64::EPSILON;
            (t, least) = (next, distance(next));
            if done {
                break;
            }
        }
        let at = curve.point(t);
        keep(best, self.measure(p, edge.patch, at));
        Some((t, at))
    }
}

fn keep(best: &mut Option<Foot>, candidate: Option<Foot>) {
    if let Some(candidate) = candidate
        && best.is_none_or(|b| candidate.distance < b.distance)
    {
        *best = Some(candidate);
    }
}

/// The foot point on one patch, or where on the boundary of its domain the iteration leaves.
fn newton(patch: &dyn Patch, region: &Region, p: DVec3, start: DVec2) -> (DVec2, Option<BoundaryPoint>) {
    let mut x = start;
    let mut jet = patch.jet(x);
    let mut leaving: Option<BoundaryPoint> = None;
    for _ in 0..STEPS {
        let r = jet.p - p;
        let Some(step) = step(&jet, r) else { break };
        // Halve until the distance falls: far from the foot a full step may climb.
        let mut scale = 1.0;
        let (mut accepted, mut outward) = (None, None);
        for _ in 0..6 {
            let mut next = x + step * scale;
            let mut exit = None;
            // Patches over rectangles and polygons need not be defined outside; trimmed ones are judged at the end, containment
            // in their loops being dear.
            if region.is_convex() && !region.contains(next) {
                exit = region.nearest(next);
                next = exit.map_or(next, |b| b.at);
            }
            let trial = patch.jet(next);
            if (trial.p - p).length() <= r.length() {
                accepted = Some((next, trial, exit));
                break;
            }
            outward = outward.or(exit);
            scale *= 0.5;
        }
        // The nearest boundary point to a step that leads out need not be nearer to p: the caller goes on along the edge.
        if accepted.is_none() && outward.is_some() {
            return (x, outward);
        }
        let Some((next, trial, exit)) = accepted else { break };
        let moved = (trial.p - jet.p).length();
        let stuck = moved <= 1e-14 * (r.length() + moved) || next == x;
        let again = exit.is_some() && leaving.is_some_and(|l| exit.is_some_and(|e| e.edge == l.edge));
        (x, jet) = (next, trial);
        if exit.is_some() && (again || stuck) {
            return (x, exit);
        }
        leaving = exit;
        if stuck {
            break;
        }
    }
    if leaving.is_some() {
        return (x, leaving);
    }
    if !region.is_convex() && x != start && !region.contains(x) {
        return (x, region.nearest(x));
    }
    (x, None)
}

/// Newton's step on half the squared distance, Gauss–Newton's where the Hessian is not safely positive; `None` where the patch is
/// singular or not finite.
fn step(jet: &suture_bernstein::Jet2, r: DVec3) -> Option<DVec2> {
    let g = DVec2::new(r.dot(jet.du), r.dot(jet.dv));
    let (e, f, h) = (jet.du.dot(jet.du), jet.du.dot(jet.dv), jet.dv.dot(jet.dv));
    let (a, b, c) = (e + r.dot(jet.duu), f + r.dot(jet.duv), h + r.dot(jet.dvv));
    let first = e * h - f * f;
    let full = a * c - b * b;
    let (a, b, c, det) = if a > 0.0 && full > 0.01 * first { (a, b, c, full) } else { (e, f, h, first) };
    let step = DVec2::new(b * g.y - c * g.x, b * g.x - a * g.y) / det;
    (step.is_finite() && det > 1e-14 * a * c).then_some(step)
}
