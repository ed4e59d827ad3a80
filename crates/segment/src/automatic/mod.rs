//! Automatic segmentation: many cells, merged and smoothed.

mod cells;
mod diffusion;
mod merge;
mod moves;
mod shape;
mod smooth;
mod split;
mod survey;
mod thin;

pub use split::split_charts;
use suture_mesh::{Topology, TriMesh};

use crate::segmentation::check_mesh;
use crate::{Flatten, Limits, NormalSpread, Segment, SegmentError, Segmentation};
use merge::{Map, Rules};
use shape::Shape;

/// Segmentation from the mesh alone: few discs with long arcs, borders on creases where there are any.
///
/// A fine partition into Voronoi cells is merged greedily (flat parts first), arcs that are too short are merged away, and then
/// borders are smoothed and corners moved in turn. Charts too narrow for blends are given to their neighbours. Every step keeps the invariants of [`Segmentation`], so that the result is
/// valid whenever the start was. Deterministic, independent of threads, and invariant under scaling and moving by powers of two.
///
/// Not guaranteed: that every arc is long enough for strips (see [`Segmentation::arc_widths`]), and that every chart can be
/// flattened well, since smoothing and moving change charts after merging asked [`Flatten`].
pub struct Automatic {
    /// What is asked of the charts.
    pub options: AutomaticOptions,
    /// The test whether a union of charts can still be flattened. The default estimates it from normals, [`NormalSpread`];
    /// inject one that maps the union where a parameterisation is at hand.
    pub flatten: Box<dyn Flatten + Send + Sync>,
}

/// What is asked of automatic charts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AutomaticOptions {
    /// Number of charts to merge down to. Merging stops there, and goes on with laxer shape conditions while there are more; it
    /// is not reached where no admissible merge is left. `None`, the default, merges while shapes stay good.
    pub charts: Option<usize>,
    /// Rounds of smoothing, corner moves and merging of short arcs. The default 2 is where arcs stop growing on most meshes; 0 leaves
    /// the borders as zigzag as merging made them.
    pub rounds: usize,
    /// What the partition is allowed to be. The default valence is 6: beyond it no blend has all coefficients in [0, 1].
    pub limits: Limits,
}

impl Default for AutomaticOptions {
    fn default() -> Self {
        Self { charts: None, rounds: 2, limits: Limits { max_valence: 6 } }
    }
}

impl Default for Automatic {
    fn default() -> Self {
        Self { options: AutomaticOptions::default(), flatten: Box::new(NormalSpread::default()) }
    }
}

impl std::fmt::Debug for Automatic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Automatic").field("options", &self.options).finish_non_exhaustive()
    }
}

/// Charts thinner than this part of the diagonal are given to neighbours: blends that are pleasant to look at are not narrower either.
const THINNEST: f64 = 0.008;

impl Segment for Automatic {
    /// # Errors
    /// [`MeshMismatch`](SegmentError::MeshMismatch), [`Open`](SegmentError::Open), [`Disconnected`](SegmentError::Disconnected),
    /// [`NotFinite`](SegmentError::NotFinite), [`Solve`](SegmentError::Solve), [`NoValidStart`](SegmentError::NoValidStart), and
    /// [`CornerValence`](SegmentError::CornerValence) where merging could not lower a valence.
    fn segment(&self, mesh: &TriMesh, topology: &Topology) -> Result<Segmentation, SegmentError> {
        check_mesh(mesh, topology)?;
        let Limits { max_valence } = self.options.limits;
        let any = Limits { max_valence: usize::MAX };
        let shape = Shape::new(mesh, topology)?;
        let flatten: &(dyn Flatten + Sync) = &*self.flatten;
        let enough = self.options.charts.unwrap_or(0);

        let start = Segmentation::from_labels_with(mesh, topology, &cells::cells(&shape)?, any)?;
        let mut map = Map::new(&shape, flatten, &start);
        for cone in [0.08, 0.2, 0.36] {
            map.greedy(Rules::cone(cone), enough);
        }
        if self.options.charts.is_some() {
            for rules in Rules::LADDER {
                map.greedy(rules, enough);
            }
        }
        map.lower_valence(max_valence);
        map.lengthen(0.008);
        let mut now = Segmentation::from_labels_with(mesh, topology, &map.labels(), any)?;
        for round in 0..self.options.rounds {
            let charts = now.charts.len();
            let mut labels = smooth::smooth_borders(&shape, flatten, now.labels, charts, max_valence)?;
            moves::move_corners(&shape, flatten, &mut labels, charts, max_valence);
            let moved = Segmentation::from_labels_with(mesh, topology, &labels, any)?;
            let mut map = Map::new(&shape, flatten, &moved);
            map.greedy(Rules::cone(0.36), enough);
            map.lengthen(if round == 0 { 0.014 } else { 0.02 });
            now = Segmentation::from_labels_with(mesh, topology, &map.labels(), any)?;
        }
        let charts = now.charts.len();
        let labels = smooth::settle_corners(&shape, flatten, now.labels, charts, max_valence)?;
        let settled = Segmentation::from_labels_with(mesh, topology, &labels, any)?;
        // What became too short for any blend is merged away.
        let mut map = Map::new(&shape, flatten, &settled);
        map.lengthen(0.012);
        let long = Segmentation::from_labels_with(mesh, topology, &map.labels(), self.options.limits)?;
        Ok(thin::absorb_thin(&shape, flatten, long, self.options.limits, THINNEST))
    }
}
