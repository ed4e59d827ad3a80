//! How many segments a curve or a parameter direction asks for, from samples.

use glam::{DVec2, DVec3};
use suture_surface::EdgeCurve;

use crate::{TessellateError, net::Frame, options::Limits};

/// Intervals between the samples of a boundary curve.
const CURVE_SAMPLES: usize = 16;
/// Intervals between the samples of a patch, in either direction.
const PATCH_SAMPLES: usize = 8;

/// A point of a patch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) p: DVec3,
    /// Unit normal; `None` where the patch is singular.
    pub(crate) n: Option<DVec3>,
}

impl Frame<'_> {
    /// The point of the patch (number `index`, for the error) at `at`.
    pub(crate) fn sample(&self, index: usize, at: DVec2) -> Result<Sample, TessellateError> {
        let jet = self.patch.jet(at);
        if !jet.p.is_finite() {
            return Err(TessellateError::NotFinite { patch: index, at });
        }
        Ok(Sample { p: jet.p, n: jet.normal().filter(|n| n.is_finite()) })
    }
}

/// What a direction asks for: the figures of one single segment. With `n` segments the bend divides by `n²`, the rest by `n`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Demand {
    /// Distance of the chord.
    pub(crate) bend: f64,
    /// Turn of the normal.
    pub(crate) turn: f64,
    /// Length.
    pub(crate) length: f64,
}

impl Demand {
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            bend: self.bend.max(other.bend),
            turn: self.turn.max(other.turn),
            length: self.length.max(other.length),
        }
    }

    /// Number of segments, as a real number, at least one.
    pub(crate) fn segments(&self, limits: &Limits) -> f64 {
        let bend = (self.bend / limits.chord).sqrt();
        bend.max(self.turn / limits.angle).max(self.length / limits.edge).max(1.0)
    }
}

/// The box around samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) lo: DVec3,
    pub(crate) hi: DVec3,
}

impl Extent {
    pub(crate) const EMPTY: Self =
        Self { lo: DVec3::splat(f64::INFINITY), hi: DVec3::splat(f64::NEG_INFINITY) };

    pub(crate) fn include(&mut self, p: DVec3) {
        self.lo = self.lo.min(p);
        self.hi = self.hi.max(p);
    }

    pub(crate) fn join(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Length of the diagonal.
    pub(crate) fn size(&self) -> f64 {
        let d = self.hi - self.lo;
        if d.x >= 0.0 { d.length() } else { 0.0 }
    }
}

/// What boundary edge `edge` asks for: the curve itself by its full bend, the patch beside it by the turn of its normal.
pub(crate) fn of_edge(
    frame: &Frame,
    index: usize,
    edge: usize,
    extent: &mut Extent,
) -> Result<Demand, TessellateError> {
    let line = edge_samples(frame, index, &frame.edges[edge])?;
    line.iter().for_each(|s| extent.include(s.p));
    let k = CURVE_SAMPLES as f64;
    let mut demand = along(&line);
    for w in line.windows(3) {
        let (d0, d1) = (w[1].p - w[0].p, w[2].p - w[1].p);
        // Half of the turn: a boundary may turn twice as far as the normal.
        demand.turn = demand.turn.max(0.5 * k * angle(d0, d1));
        // Only what is across: uneven speed along the curve does not take the chord away from it.
        let (bend, chord) = (d1 - d0, (d0 + d1).normalize_or_zero());
        demand.bend = demand.bend.max((bend - chord * bend.dot(chord)).length() * k * k / 8.0);
    }
    Ok(demand)
}

/// The samples of an edge, both ends included.
pub(crate) fn edge_samples(
    frame: &Frame,
    index: usize,
    edge: &EdgeCurve,
) -> Result<Vec<Sample>, TessellateError> {
    (0..=CURVE_SAMPLES).map(|i| frame.sample(index, edge.point(i as f64 / CURVE_SAMPLES as f64))).collect()
}

/// What a quadrilateral of the parameter plane asks for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct QuadDemand {
    /// Along the first and the second direction.
    pub(crate) along: [Demand; 2],
    /// Bend of the diagonals, which neither direction sees alone; divides by both numbers of segments.
    pub(crate) twist: f64,
}

impl QuadDemand {
    pub(crate) fn max(self, other: Self) -> Self {
        let along = [0, 1].map(|d| self.along[d].max(other.along[d]));
        Self { along, twist: self.twist.max(other.twist) }
    }

    /// Numbers of segments, as real numbers, such that the sum of all three bends stays below the limit.
    pub(crate) fn segments(&self, limits: &Limits) -> [f64; 2] {
        let [nu, nv] = self.along.map(|d| d.segments(limits));
        let bend = self.along[0].bend / (nu * nu) + self.twist / (nu * nv) + self.along[1].bend / (nv * nv);
        let factor = (bend / limits.chord).max(1.0).sqrt();
        [nu * factor, nv * factor]
    }
}

/// What the bilinear quadrilateral `corners` (counter-clockwise; first direction from corner 0 to 1) of the parameter plane asks for.
pub(crate) fn of_quad(
    frame: &Frame,
    index: usize,
    corners: [DVec2; 4],
    extent: &mut Extent,
) -> Result<QuadDemand, TessellateError> {
    const K: usize = PATCH_SAMPLES;
    let k = K as f64;
    let mut grid = Vec::with_capacity((K + 1) * (K + 1));
    for j in 0..=K {
        for i in 0..=K {
            let s = frame.sample(index, bilinear(corners, i as f64 / k, j as f64 / k))?;
            extent.include(s.p);
            grid.push(s);
        }
    }
    let at = |i: usize, j: usize| grid[j * (K + 1) + i];
    let mut demand = QuadDemand::default();
    for l in 0..=K {
        let lines: [[Sample; K + 1]; 2] =
            [std::array::from_fn(|i| at(i, l)), std::array::from_fn(|j| at(l, j))];
        for d in 0..2 {
            demand.along[d] = demand.along[d].max(along(&lines[d]));
        }
    }
    for j in 0..K {
        for i in 0..K {
            let d = at(i + 1, j + 1).p - at(i + 1, j).p - at(i, j + 1).p + at(i, j).p;
            demand.twist = demand.twist.max(at(i, j).n.map_or(0.0, |n| n.dot(d).abs()) * k * k / 4.0);
        }
    }
    Ok(demand)
}

/// The point of a bilinear quadrilateral.
pub(crate) fn bilinear([a, b, c, d]: [DVec2; 4], s: f64, t: f64) -> DVec2 {
    (a * (1.0 - s) + b * s) * (1.0 - t) + (d * (1.0 - s) + c * s) * t
}

/// Demand of a line of samples: turn of the normal, bend along the normal, length.
fn along(line: &[Sample]) -> Demand {
    let k = (line.len() - 1) as f64;
    let mut demand = Demand::default();
    for w in line.windows(2) {
        demand.length = demand.length.max(w[0].p.distance(w[1].p) * k);
        if let (Some(a), Some(b)) = (w[0].n, w[1].n) {
            demand.turn = demand.turn.max(angle(a, b) * k);
        }
    }
    for w in line.windows(3) {
        let across = w[1].n.map_or(0.0, |n| n.dot(w[0].p - 2.0 * w[1].p + w[2].p).abs());
        demand.bend = demand.bend.max(across * k * k / 8.0);
    }
    demand
}

/// Angle between two vectors; 0 if one of them vanishes. Accurate for small angles, unlike the arc cosine.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}
