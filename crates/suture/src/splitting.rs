//! Which segments are fitted: those that cannot be fitted or blended are split, and splits that made things worse are undone.

use std::collections::BTreeMap;

use suture_blend::Intent;
use suture_mesh::{Topology, TriMesh};
use suture_param::CollarOptions;
use suture_segment::{Fairing, Limits, Segmentation, split_charts};

use crate::arcs::{Drafts, collar_widths};
use crate::charting::{Charted, Charting, chart_all};
use crate::reconstruct::Clock;
use crate::{ReconstructOptions, Stage, Stages, SutureError, Watch};

/// A segmentation with the chart and the fit of every segment.
pub(crate) struct State {
    pub(crate) segmentation: Segmentation,
    pub(crate) charted: Vec<Charted>,
    /// How many segments there may be in the end.
    most: usize,
    /// The faces of both parts of every split.
    splits: Vec<[Vec<u32>; 2]>,
    /// The faces of segments whose fits splitting does not improve, and of those whose splits were undone.
    resists: Vec<Vec<u32>>,
    undone: Vec<Vec<u32>>,
}

/// What all segmentations of one mesh share.
pub(crate) struct Pieces<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    stages: &'a Stages<'a>,
    options: &'a ReconstructOptions,
    limits: Limits,
    watch: &'a dyn Watch,
    /// Dihedral angle that collars do not cross.
    sharp: f64,
    /// Draws arcs on the mesh.
    fairing: Fairing<'a>,
}

/// How many segments splitting may add to few of them; to more it may add as many again.
const FEW: usize = 8;

impl<'a> Pieces<'a> {
    pub(crate) fn new(
        mesh: &'a TriMesh,
        topology: &'a Topology,
        stages: &'a Stages<'a>,
        options: &'a ReconstructOptions,
        limits: Limits,
        watch: &'a dyn Watch,
    ) -> Self {
        let sharp = match options.widths.intent {
            Intent::Fidelity => CollarOptions::default().sharp,
            Intent::Fillet => std::f64::consts::PI,
        };
        let fairing = Fairing::new(mesh, topology);
        Self { mesh, topology, stages, options, limits, watch, sharp, fairing }
    }

    /// The arcs of a segmentation, none drawn yet.
    pub(crate) fn drafts<'b>(&'b self, segmentation: &'b Segmentation) -> Drafts<'b> {
        Drafts::new(self.fairing, self.mesh, self.topology, segmentation, self.options)
    }

    /// Charts and fits every segment.
    pub(crate) fn charted(
        &self,
        clock: &mut Clock<'_>,
        segmentation: Segmentation,
    ) -> Result<State, SutureError> {
        let known = segmentation.charts.iter().map(|_| None).collect();
        let charted = self.chart_all(clock, &segmentation, known)?;
        let count = segmentation.charts.len();
        let most = count + if self.options.splits.rounds == 0 { 0 } else { count.max(FEW) };
        Ok(State { segmentation, charted, most, splits: Vec::new(), resists: Vec::new(), undone: Vec::new() })
    }

    /// Splits segments whose charts fold or whose fits miss the tolerance, as long as that helps.
    pub(crate) fn split_poor(
        &self,
        clock: &mut Clock<'_>,
        mut state: State,
        tolerance: f64,
    ) -> Result<State, SutureError> {
        for _ in 0..self.options.splits.rounds {
            let State { segmentation, charted, most, resists, undone, .. } = &state;
            let mut poor: Vec<usize> = (0..charted.len())
                .filter(|&s| charted[s].poor(tolerance))
                .filter(|&s| {
                    let faces = &segmentation.charts[s].faces;
                    !resists.contains(faces) && !undone.contains(faces)
                })
                .collect();
            // The worst first, should there be too many.
            poor.sort_by(|&a, &b| charted[b].badness().total_cmp(&charted[a].badness()).then(a.cmp(&b)));
            poor.truncate(most.saturating_sub(segmentation.charts.len()));
            let trial = split_charts(self.mesh, self.topology, segmentation, &poor, self.limits, false)?;
            if trial.charts.len() == segmentation.charts.len() {
                break;
            }
            state = self.accept(clock, state, trial)?;
        }
        Ok(state)
    }

    /// Another segmentation where segments cannot be blended: splits that left parts which cannot be fitted are undone, other
    /// segments are split. The same, and `false`, where nothing is left to change.
    pub(crate) fn change(
        &self,
        clock: &mut Clock<'_>,
        mut state: State,
        blamed: &[usize],
    ) -> Result<(State, bool), SutureError> {
        let count = state.segmentation.charts.len();
        let tolerance = self.options.splits.tolerance.unwrap_or(f64::INFINITY);
        let (mut labels, mut merged) = (state.segmentation.labels.clone(), Vec::new());
        for &s in blamed.iter().filter(|&&s| state.charted[s].poor(tolerance)) {
            let faces = |s: usize| &state.segmentation.charts[s].faces;
            let sibling = state.splits.iter().enumerate().find_map(|(k, [a, b])| {
                let other = if a == faces(s) { b } else { Some(a).filter(|_| b == faces(s))? };
                (0..count).find(|&t| faces(t) == other).map(|t| (k, t))
            });
            // Both parts may be blamed.
            let Some((k, t)) = sibling.filter(|(k, _)| !merged.contains(k)) else { continue };
            let mut trial = labels.clone();
            trial.iter_mut().filter(|l| **l == t as u32).for_each(|l| *l = s as u32);
            // Other splits may have made the whole one that meets itself.
            if Segmentation::from_labels_with(self.mesh, self.topology, &trial, self.limits).is_ok() {
                labels = trial;
                merged.push(k);
                let mut whole: Vec<u32> = state.splits[k].concat();
                whole.sort_unstable();
                state.undone.push(whole);
            }
        }
        let next = if merged.is_empty() {
            let mut split: Vec<usize> = blamed.to_vec();
            split.retain(|&s| !state.undone.contains(&state.segmentation.charts[s].faces));
            split.truncate(state.most.saturating_sub(count));
            split_charts(self.mesh, self.topology, &state.segmentation, &split, self.limits, true)?
        } else {
            Segmentation::from_labels_with(self.mesh, self.topology, &labels, self.limits)?
        };
        if merged.is_empty() && next.charts.len() == count {
            return Ok((state, false));
        }
        let State { segmentation, charted, most, mut splits, resists, undone } = state;
        merged.sort_unstable();
        merged.into_iter().rev().for_each(|k| drop(splits.remove(k)));
        let mut pool = pool(&segmentation, charted);
        let known = next.charts.iter().map(|c| pool.remove(&c.faces)).collect();
        let charted = self.chart_all(clock, &next, known)?;
        Ok((State { segmentation: next, charted, most, splits, resists, undone }, true))
    }

    fn chart_all(
        &self,
        clock: &mut Clock<'_>,
        segmentation: &Segmentation,
        known: Vec<Option<Charted>>,
    ) -> Result<Vec<Charted>, SutureError> {
        let Self { mesh, topology, stages, options, .. } = *self;
        let diagonal = mesh.diagonal();
        let lines = self.drafts(segmentation).lines(&vec![0; segmentation.arcs.len()]);
        let collars =
            collar_widths(mesh, segmentation, &lines, &options.widths, stages.maps.as_ref(), diagonal);
        let context = Charting {
            mesh,
            topology,
            segmentation,
            parameterize: stages.parameterize.as_ref(),
            fit: stages.fit.as_ref(),
            sharp: self.sharp,
            shortest: options.widths.wanted * diagonal,
            diagonal,
            edge: self.fairing.edge(),
        };
        let steps = segmentation.charts.len();
        clock.run(Stage::Fit, steps, || chart_all(&context, known, &collars, self.watch))
    }

    /// A trial without the splits that do not help.
    fn accept(&self, clock: &mut Clock<'_>, state: State, trial: Segmentation) -> Result<State, SutureError> {
        let State { segmentation: before, charted, most, mut splits, mut resists, undone } = state;
        let mut labels = trial.labels.clone();
        let mut pool = pool(&before, charted);
        let known = trial.charts.iter().map(|c| pool.remove(&c.faces)).collect();
        let parts = self.chart_all(clock, &trial, known)?;
        for new in before.charts.len()..trial.charts.len() {
            let faces = &trial.charts[new].faces;
            // A new segment was cut from the one that its faces belonged to.
            let Some(old) = faces.first().map(|&f| before.labels[f as usize] as usize) else { continue };
            let faces_before = &before.charts[old].faces;
            let better = |cut: &Charted| cut.worse_than([&parts[old], &parts[new]]);
            if pool.get(faces_before).is_some_and(better) {
                splits.push([trial.charts[old].faces.clone(), faces.clone()]);
            } else {
                faces.iter().for_each(|&f| labels[f as usize] = old as u32);
                resists.push(faces_before.clone());
            }
        }
        pool.extend(trial.charts.iter().map(|c| c.faces.clone()).zip(parts));
        let segmentation = Segmentation::from_labels_with(self.mesh, self.topology, &labels, self.limits)?;
        let known = segmentation.charts.iter().map(|c| pool.remove(&c.faces)).collect();
        let charted = self.chart_all(clock, &segmentation, known)?;
        Ok(State { segmentation, charted, most, splits, resists, undone })
    }
}

/// Charted segments by their faces.
fn pool(segmentation: &Segmentation, charted: Vec<Charted>) -> BTreeMap<Vec<u32>, Charted> {
    segmentation.charts.iter().map(|c| c.faces.clone()).zip(charted).collect()
}
