//! The maps G: which point of which chart goes into which point of a blend.

use std::any::Any;

use glam::DVec2;
use suture_bernstein::{BezierPatch, MAX_DEGREE};

use crate::polynomial::PlanePolynomial;
use crate::widths::Widths;
use crate::{BlendError, Network};

/// The two maps of one strip, from `[0, 1]²` into the charts of its two sides; degree (5, q).
#[derive(Clone, Debug, PartialEq)]
pub struct StripMaps {
    /// Into the chart ↓, on the right of the direction of `U`; `V = 0` is its inner side.
    pub down: BezierPatch<DVec2>,
    /// Into the chart ↑, on the left of the direction of `U`; `V = 1` is its inner side.
    pub up: BezierPatch<DVec2>,
}

/// All maps around one corner of valence N.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerMapSet {
    /// Map of the N-gon into the chart of segment `i`; `R_i` is its inner corner.
    pub gon: Vec<PlanePolynomial>,
    /// Maps of the strip on arc `i`, `U` towards the corner, `U = 1` at the N-gon: `down` is segment `i`, `up` segment `i − 1`.
    pub strips: Vec<StripMaps>,
}

/// All maps of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct MapSet {
    /// Per corner.
    pub corners: Vec<CornerMapSet>,
    /// Per arc, the strips between the two strips adjacent to its corners, `U` along the arc: `down` is the segment on the right of
    /// the arc, `up` the one on its left. At least one.
    pub chains: Vec<Vec<StripMaps>>,
    /// Share of the lines of the reference maps that met no surface (0 for maps that shoot none).
    pub missed: f64,
}

/// What an implementation of [`CornerMaps`] keeps from one call to the next, so that only what changed is made again. It never changes
/// a result.
#[derive(Debug, Default)]
pub struct Memory(Option<Box<dyn Any + Send>>);

impl Memory {
    /// Hands out what was kept; `None` where nothing of that kind was.
    pub fn take<T: Any + Send>(&mut self) -> Option<T> {
        self.0.take()?.downcast().ok().map(|kept| *kept)
    }

    /// Keeps this for the next call.
    pub fn keep<T: Any + Send>(&mut self, kept: T) {
        self.0 = Some(Box::new(kept));
    }
}

/// How the maps of a network are made: the stage of the blend that is worth swapping. Implementations fulfil (G1)–(G8)
/// of Wagner et al. (2003) identically, so that the result is C² whatever else they do.
pub trait CornerMaps {
    /// The maps for given widths. `memory` is new, or that of an earlier call.
    ///
    /// # Errors
    /// Every reason at once, so that all widths concerned can change together: [`BlendError::ArcTooShort`] where they leave no room
    /// for a strip, [`BlendError::Singular`].
    fn maps(
        &self,
        network: &Network,
        widths: &Widths,
        memory: &mut Memory,
    ) -> Result<MapSet, Vec<BlendError>>;

    /// Distance, in widths, between a corner of valence `n` with equal angles and the first cross line of its arcs: the first guess
    /// of what fits on an arc.
    fn reach(&self, valence: usize) -> f64 {
        crate::reach(valence)
    }
}

/// A line across a strip in one chart, with the first two derivatives along the strip: what two consecutive strips share.
/// Each is a polynomial in `V`, by its Bézier points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) p: Vec<DVec2>,
    pub(crate) d: Vec<DVec2>,
    pub(crate) dd: Vec<DVec2>,
}

/// The quintic Hermite strip map between two nodes (Wagner et al. 2003, Section 6.4); `scales` are ã and a: its `U`-derivatives at the
/// ends are `ã d` and `a d`, its second ones `ã² dd` and `a² dd`.
pub(crate) fn between(start: &Node, end: &Node, scales: [f64; 2]) -> Result<BezierPatch<DVec2>, BlendError> {
    let [s, e] = scales;
    let mut rows: [Vec<DVec2>; 6] = Default::default();
    for j in 0..start.p.len() {
        let (p, d, dd) = (start.p[j], start.d[j], start.dd[j]);
        let g1 = p + d * (s / 5.0);
        rows[0].push(p);
        rows[1].push(g1);
        rows[2].push(g1 * 2.0 - p + dd * (s * s / 20.0));
        let (p, d, dd) = (end.p[j], end.d[j], end.dd[j]);
        let g4 = p - d * (e / 5.0);
        rows[5].push(p);
        rows[4].push(g4);
        rows[3].push(g4 * 2.0 - p + dd * (e * e / 20.0));
    }
    bezier(rows)
}

/// The patch of degree (5, q) with the given rows.
pub(crate) fn bezier(rows: [Vec<DVec2>; 6]) -> Result<BezierPatch<DVec2>, BlendError> {
    let q = rows[0].len() - 1;
    debug_assert!(q <= MAX_DEGREE);
    BezierPatch::new([5, q], rows.concat())
        .map_err(|e| BlendError::Inconsistent { what: format!("a strip map is not finite ({e})") })
}

/// All results, or all errors.
pub(crate) fn all<T>(
    results: impl IntoIterator<Item = Result<T, BlendError>>,
) -> Result<Vec<T>, Vec<BlendError>> {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(t) => good.push(t),
            Err(e) => bad.push(e),
        }
    }
    if bad.is_empty() { Ok(good) } else { Err(bad) }
}
