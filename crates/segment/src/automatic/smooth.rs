//! Smoothing of the whole network of borders by threshold dynamics.

use super::diffusion::Diffusion;
use super::shape::{Shape, conductance};
use super::survey::{Surveyor, border};
use crate::SegmentError;
use crate::census::census;

/// Moves the borders by curvature: three times, every chart's indicator diffuses and every face takes the chart with the largest
/// value. Triple corners turn to 120°, and creases hold borders because they hardly conduct. Faces around charts that would break
/// an invariant keep their label. Returns the old labels when the objective rises by more than 0.05.
///
/// # References
/// Merriman, Bence, Osher, "Motion of multiple junctions: a level set approach", Journal of Computational Physics 112, 1994.
pub(super) fn smooth_borders(
    shape: &Shape,
    labels: Vec<u32>,
    charts: usize,
    max_valence: usize,
) -> Result<Vec<u32>, SegmentError> {
    let step = f64::max(0.012, 1.3 * shape.median_edge);
    let conductances: Vec<f64> = (0..shape.lengths.len())
        .map(|h| conductance(shape.lengths[h], shape.spans[h]) * (1.0 - 0.98 * shape.creases[h]))
        .collect();
    let diffusion = Diffusion::new(shape.topology, &shape.areas, &conductances, step * step)?;
    let mut new = labels.clone();
    for _ in 0..3 {
        let mut best = vec![(f64::NEG_INFINITY, 0u32); new.len()];
        for r in 0..charts as u32 {
            let u = diffusion.smooth(new.iter().map(|&l| f64::from(u8::from(l == r))));
            for (best, u) in best.iter_mut().zip(u) {
                // Rounded, so that symmetric borders are ties, which go to the lower chart.
                let u = (u * 1e9).round();
                if u > best.0 {
                    *best = (u, r);
                }
            }
        }
        let before = new.clone();
        for (label, best) in new.iter_mut().zip(best) {
            *label = best.1;
        }
        repair(shape, &before, &mut new, charts, max_valence);
    }
    let mut surveyor = Surveyor::new(shape, max_valence);
    let mut objective =
        |labels: &[u32]| surveyor.survey(labels, &border(shape, labels), charts).map(|s| s.objective);
    Ok(match (objective(&labels), objective(&new)) {
        (Some(old), Some(after)) if after <= old + 0.05 => new,
        _ => labels,
    })
}

/// Undoes the changes of faces whose old or new chart is invalid, until all charts are valid or nothing is left to undo.
fn repair(shape: &Shape, before: &[u32], new: &mut [u32], charts: usize, max_valence: usize) {
    loop {
        let census = census(shape.topology, new, charts);
        let bad: Vec<bool> = census.charts.iter().map(|c| !c.is_valid(max_valence)).collect();
        let mut undone = false;
        for (new, &old) in new.iter_mut().zip(before) {
            if *new != old && (bad[*new as usize] || bad[old as usize]) {
                *new = old;
                undone = true;
            }
        }
        if !undone {
            return;
        }
    }
}
