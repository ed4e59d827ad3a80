//! What is kept of earlier maps: those of corners and arcs around which nothing changed.

use std::sync::Arc;

use super::{ArcBuild, ArcOrder, CornerBuild, Rung, back_to_back};
use crate::widths::Widths;
use crate::{BlendError, Network};

/// The maps made for the latest widths of a network, by what they depend on.
#[derive(Default)]
pub(super) struct Kept {
    network: Option<Network>,
    /// Arc lengths to the samples of every arc.
    pub(super) lengths: Vec<Vec<f64>>,
    /// Whether the surfaces along every arc turn their backs to each other.
    pub(super) back_to_back: Vec<bool>,
    pub(super) corners: Vec<Versions<CornerKey, CornerBuild>>,
    pub(super) arcs: Vec<Versions<ArcKey, ArcBuild>>,
}

impl Kept {
    /// Forgets what was made of other surfaces and arcs than those of `network`.
    pub(super) fn renew(&mut self, network: &Network) {
        let old = self.network.take().filter(|old| old.differs_in_arcs_only(network));
        let changed: Vec<bool> = (network.arcs.iter().enumerate())
            .map(|(a, arc)| old.as_ref().is_none_or(|old| old.arcs[a] != *arc))
            .collect();
        let corner_changed = |c: &crate::Corner| c.arcs.iter().any(|end| changed[end.arc]);
        self.corners.resize_with(network.corners.len(), Versions::default);
        for (corner, kept) in network.corners.iter().zip(&mut self.corners) {
            if corner_changed(corner) {
                *kept = Versions::default();
            }
        }
        self.arcs.resize_with(network.arcs.len(), Versions::default);
        self.lengths.resize_with(network.arcs.len(), Vec::new);
        self.back_to_back.resize(network.arcs.len(), false);
        for (a, arc) in network.arcs.iter().enumerate() {
            if changed[a] {
                self.lengths[a] = arc.lengths();
                self.back_to_back[a] = back_to_back(network, arc);
            }
            if arc.corners.iter().any(|&c| corner_changed(&network.corners[c])) {
                self.arcs[a] = Versions::default();
            }
        }
        self.network = Some(old.filter(|_| !changed.contains(&true)).unwrap_or_else(|| network.clone()));
    }
}

/// What the maps of a corner depend on beside the surfaces and arcs around it.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct CornerKey {
    pub(super) rung: Rung,
    width: f64,
    inner: f64,
    d_curv: f64,
    reductions: u32,
}

impl CornerKey {
    pub(super) fn new(corner: usize, rung: Rung, widths: &Widths) -> Self {
        let Widths { inner, d_curv, .. } = *widths;
        Self { rung, width: widths.corner[corner], inner, d_curv, reductions: widths.reductions[corner] }
    }
}

/// What the strips of an arc depend on beside its surfaces and its course.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct ArcKey {
    pub(super) order: ArcOrder,
    pub(super) ends: [CornerKey; 2],
    pub(super) shortest: f64,
}

/// The latest things that were made of one place, with what they were made for.
pub(super) struct Versions<K, T>(Vec<(K, Arc<T>)>);

/// How many are kept: as many as the ladder has combinations of rungs.
const MOST_VERSIONS: usize = 6;

impl<K, T> Default for Versions<K, T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<K: PartialEq, T> Versions<K, T> {
    /// What was made for `key`, or is now.
    pub(super) fn get(
        &mut self,
        key: K,
        make: impl FnOnce() -> Result<T, BlendError>,
    ) -> Result<Arc<T>, BlendError> {
        if let Some((_, kept)) = self.0.iter().find(|(k, _)| *k == key) {
            return Ok(kept.clone());
        }
        let made = Arc::new(make()?);
        if self.0.len() == MOST_VERSIONS {
            self.0.remove(0);
        }
        self.0.push((key, made.clone()));
        Ok(made)
    }
}
