//! The plain input of the blends: B-splines, and where their segments meet.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;

use crate::BlendError;
use crate::gon::MAX_VALENCE;

/// B-spline surfaces, one per segment of a closed surface, with the corners and arcs where their segments meet.
#[derive(Clone, Debug)]
pub struct Network {
    /// The surface of every segment.
    pub surfaces: Vec<Arc<BSplineSurface<DVec3>>>,
    /// Where three or more segments meet.
    pub corners: Vec<Corner>,
    /// Where two segments meet.
    pub arcs: Vec<ArcCurve>,
    /// Length that tolerances refer to: the diagonal of the bounding box of the mesh.
    pub diagonal: f64,
}

/// A corner: the arcs that leave it, counter-clockwise seen from outside. Segment `i` of the corner lies between arc `i` and arc
/// `i + 1`; it is the one on the left of arc `i` seen from the corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    /// The arcs around the corner.
    pub arcs: Vec<ArcEnd>,
    /// Largest width of the blends here: as far as the surfaces around the corner can be trusted outside their segments.
    pub widest: f64,
}

/// One of the two ends of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArcEnd {
    /// Index in [`Network::arcs`].
    pub arc: usize,
    /// Whether the arc starts here (otherwise it ends here).
    pub starts: bool,
}

/// An arc as a fine polyline of surface points, each with its parameters on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcCurve {
    /// Corners where it starts and ends.
    pub corners: [usize; 2],
    /// Segment on the left of the walk.
    pub left: usize,
    /// Segment on the right of the walk.
    pub right: usize,
    /// Points from corner to corner, at least two, no two consecutive ones equal.
    pub samples: Vec<ArcSample>,
}

/// One point of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcSample {
    /// Position in space.
    pub position: DVec3,
    /// Parameter in the chart on the left.
    pub left: DVec2,
    /// Parameter of the same point in the chart on the right.
    pub right: DVec2,
}

impl ArcCurve {
    /// Arc length from the start to every sample.
    pub(crate) fn lengths(&self) -> Vec<f64> {
        let mut total = 0.0;
        let mut previous = self.samples.first().map(|s| s.position);
        self.samples
            .iter()
            .map(|s| {
                total += previous.replace(s.position).map_or(0.0, |p| p.distance(s.position));
                total
            })
            .collect()
    }
}

/// An arc seen from one of its corners: samples in the order of the walk away from the corner, left and right as seen then.
pub(crate) struct Ray<'a> {
    curve: &'a ArcCurve,
    lengths: &'a [f64],
    starts: bool,
}

impl<'a> Ray<'a> {
    pub(crate) fn new(curve: &'a ArcCurve, lengths: &'a [f64], starts: bool) -> Self {
        Self { curve, lengths, starts }
    }

    pub(crate) fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// The point at arc length `at` from the corner, linear between samples.
    pub(crate) fn sample(&self, at: f64) -> ArcSample {
        let total = self.length();
        let at = if self.starts { at } else { total - at }.clamp(0.0, total);
        let sample = sample_at(self.curve, self.lengths, at);
        if self.starts { sample } else { ArcSample { left: sample.right, right: sample.left, ..sample } }
    }

    /// Segment on the left of the walk away from the corner.
    pub(crate) fn left(&self) -> usize {
        if self.starts { self.curve.left } else { self.curve.right }
    }

    /// Segment on the right of the walk away from the corner.
    pub(crate) fn right(&self) -> usize {
        if self.starts { self.curve.right } else { self.curve.left }
    }
}

/// The point at arc length `at`, linear between samples.
pub(crate) fn sample_at(curve: &ArcCurve, lengths: &[f64], at: f64) -> ArcSample {
    let last = curve.samples.len() - 1;
    let k = lengths.partition_point(|&l| l <= at).clamp(1, last);
    let (a, b) = (&curve.samples[k - 1], &curve.samples[k]);
    let step = lengths[k] - lengths[k - 1];
    let w = if step > 0.0 { ((at - lengths[k - 1]) / step).clamp(0.0, 1.0) } else { 0.0 };
    ArcSample {
        position: a.position * (1.0 - w) + b.position * w,
        left: a.left * (1.0 - w) + b.left * w,
        right: a.right * (1.0 - w) + b.right * w,
    }
}

impl Network {
    /// Checks that the corners and arcs fit together and that every number is finite.
    ///
    /// # Errors
    /// [`BlendError::Inconsistent`], [`BlendError::Valence`], [`BlendError::NotFinite`].
    pub fn check(&self) -> Result<(), BlendError> {
        let bad = |what: String| Err(BlendError::Inconsistent { what });
        if !(self.diagonal > 0.0 && self.diagonal.is_finite()) {
            return bad(format!("the diagonal is {}", self.diagonal));
        }
        for (i, arc) in self.arcs.iter().enumerate() {
            if arc.samples.len() < 2 {
                return bad(format!("arc {i} has fewer than two samples"));
            }
            if arc.left >= self.surfaces.len() || arc.right >= self.surfaces.len() {
                return bad(format!("arc {i} names a surface that does not exist"));
            }
            if let Some(s) = arc
                .samples
                .iter()
                .position(|s| !(s.position.is_finite() && s.left.is_finite() && s.right.is_finite()))
            {
                return Err(BlendError::NotFinite { arc: i, sample: s });
            }
            for (end, starts) in [(0, true), (1, false)] {
                let listed = self
                    .corners
                    .get(arc.corners[end])
                    .is_some_and(|c| c.arcs.contains(&ArcEnd { arc: i, starts }));
                if !listed {
                    return bad(format!("corner {} does not list arc {i}", arc.corners[end]));
                }
            }
        }
        for (i, corner) in self.corners.iter().enumerate() {
            let n = corner.arcs.len();
            if !(corner.widest > 0.0) {
                return Err(BlendError::Width { name: "widest", value: corner.widest });
            }
            if !(3..=MAX_VALENCE).contains(&n) {
                return Err(BlendError::Valence { corner: i, valence: n });
            }
            for (j, end) in corner.arcs.iter().enumerate() {
                let next = corner.arcs[(j + 1) % n];
                let (Some(a), Some(b)) = (self.arcs.get(end.arc), self.arcs.get(next.arc)) else {
                    return bad(format!("corner {i} names an arc that does not exist"));
                };
                let left = if end.starts { a.left } else { a.right };
                let right = if next.starts { b.right } else { b.left };
                if left != right {
                    return bad(format!(
                        "segments {left} and {right} both lie between arcs {j} and {} of corner {i}",
                        (j + 1) % n
                    ));
                }
            }
        }
        Ok(())
    }

    /// Whether two networks differ in the course of their arcs at most. Surfaces are compared by value: whoever draws arcs anew may have
    /// made them again.
    pub(crate) fn differs_in_arcs_only(&self, other: &Self) -> bool {
        let ends = |network: &Self| -> Vec<([usize; 2], usize, usize)> {
            network
                .arcs
                .iter()
                .map(|ArcCurve { corners, left, right, .. }| (*corners, *left, *right))
                .collect()
        };
        let arcs = |network: &Self| network.corners.iter().map(|c| c.arcs.clone()).collect::<Vec<_>>();
        self.diagonal == other.diagonal
            && self.surfaces == other.surfaces
            && arcs(self) == arcs(other)
            && ends(self) == ends(other)
    }

    /// Segment `i` of a corner.
    pub(crate) fn segment(&self, corner: &Corner, i: usize) -> usize {
        let end = corner.arcs[i];
        let arc = &self.arcs[end.arc];
        if end.starts { arc.left } else { arc.right }
    }
}
