//! Smoothing of the whole network of borders by threshold dynamics.

use rayon::prelude::*;

use super::diffusion::Diffusion;
use super::merge::{DISTORTED, distortion};
use super::shape::{Shape, conductance};
use super::survey::{Surveyor, border};
use crate::census::{census, is_border};
use crate::{Flatten, SegmentError};

/// Scales of the smoothing, coarse to fine: a border moves only where it travels about an edge per step, so that long shallow bends
/// need a long scale; a short one finds the corners' places.
const SCALES: [f64; 3] = [0.04, 0.02, 0.012];
/// Steps per scale.
const STEPS: usize = 3;

/// One scale of the smoothing.
struct Scale {
    /// Distance that diffusion sees.
    distance: f64,
    /// Whether the corners stay.
    pinned: bool,
    /// How much the objective may rise before the scale is taken back.
    price: f64,
}

/// How much the objective may rise for corners of 120°: sharp corners fold every blend, short arcs only make it narrow.
const SETTLING: f64 = 2.0;

/// Moves the borders by curvature, on several scales: every chart's indicator diffuses and every face takes the chart with the
/// largest value. Triple corners turn to 120°, and creases hold borders because they hardly conduct. Faces around charts that would
/// break an invariant keep their label, and so do charts that could not be flattened any more. A scale after which the objective is higher by
/// more than 0.05 is taken back; 0.5 on the coarser scales, where the corners are held.
///
/// # References
/// Merriman, Bence, Osher, "Motion of multiple junctions: a level set approach", Journal of Computational Physics 112, 1994.
pub(super) fn smooth_borders(
    shape: &Shape,
    flatten: &(dyn Flatten + Sync),
    labels: Vec<u32>,
    charts: usize,
    max_valence: usize,
) -> Result<Vec<u32>, SegmentError> {
    let finest = 1.3 * shape.median_edge;
    // Scales below the mesh's own are one.
    let count = 1 + SCALES.iter().take(SCALES.len() - 1).take_while(|&&s| s > finest).count();
    let scales = (0..count).map(|k| {
        let last = k + 1 == count;
        Scale { distance: SCALES[k].max(finest), pinned: !last, price: if last { 0.05 } else { 0.5 } }
    });
    smooth(shape, flatten, labels, charts, max_valence, scales)
}

/// Turns the corners to 120° at the scale of the blends, whatever that costs in lengths of arcs.
pub(super) fn settle_corners(
    shape: &Shape,
    flatten: &(dyn Flatten + Sync),
    labels: Vec<u32>,
    charts: usize,
    max_valence: usize,
) -> Result<Vec<u32>, SegmentError> {
    let finest = 1.3 * shape.median_edge;
    let scales = [0.03, 0.015].into_iter().map(|scale| Scale {
        distance: f64::max(scale, finest),
        pinned: false,
        price: SETTLING,
    });
    smooth(shape, flatten, labels, charts, max_valence, scales)
}

fn smooth(
    shape: &Shape,
    flatten: &(dyn Flatten + Sync),
    labels: Vec<u32>,
    charts: usize,
    max_valence: usize,
    scales: impl Iterator<Item = Scale>,
) -> Result<Vec<u32>, SegmentError> {
    let mut new = labels.clone();
    for scale in scales {
        new = smooth_at(shape, new, charts, max_valence, &scale)?;
    }
    keep_flat(shape, flatten, &labels, &mut new, charts, max_valence);
    Ok(new)
}

fn smooth_at(
    shape: &Shape,
    labels: Vec<u32>,
    charts: usize,
    max_valence: usize,
    scale: &Scale,
) -> Result<Vec<u32>, SegmentError> {
    let Scale { distance: step, pinned, price } = *scale;
    let conductances: Vec<f64> = (0..shape.lengths.len())
        .map(|h| conductance(shape.lengths[h], shape.spans[h]) * (1.0 - 0.98 * shape.creases[h]))
        .collect();
    let diffusion = Diffusion::new(shape.topology, &shape.areas, &conductances, step * step)?;
    let mut new = labels.clone();
    for _ in 0..STEPS {
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
        if pinned {
            near_corners(shape, &before, charts, step).into_iter().for_each(|f| new[f] = before[f]);
        }
        repair(shape, &before, &mut new, charts, max_valence);
    }
    let mut surveyor = Surveyor::new(shape, max_valence);
    let mut objective =
        |labels: &[u32]| surveyor.survey(labels, &border(shape, labels), charts).map(|s| s.objective);
    Ok(match (objective(&labels), objective(&new)) {
        (Some(old), Some(after)) if after <= old + price => new,
        _ => labels,
    })
}

/// Undoes the changes of charts that can no longer be flattened as they could.
fn keep_flat(
    shape: &Shape,
    flatten: &(dyn Flatten + Sync),
    before: &[u32],
    new: &mut [u32],
    charts: usize,
    max_valence: usize,
) {
    let mut open: Vec<u32> = (0..charts as u32).collect();
    while !open.is_empty() {
        let faces = |labels: &[u32], r: u32| -> Vec<u32> {
            (0..labels.len() as u32).filter(|&f| labels[f as usize] == r).collect()
        };
        let worse: Vec<u32> = open
            .into_par_iter()
            .filter(|&r| {
                let [old, now] = [before, &*new].map(|labels| faces(labels, r));
                if old == now {
                    return false;
                }
                let after = distortion(shape, flatten, &now);
                after > DISTORTED && after >= distortion(shape, flatten, &old)
            })
            .collect();
        let reference = new.to_vec();
        for (label, &old) in new.iter_mut().zip(before) {
            if *label != old && (worse.contains(label) || worse.contains(&old)) {
                *label = old;
            }
        }
        repair(shape, before, new, charts, max_valence);
        // Charts beside those that were undone have changed with them.
        open = reference.iter().zip(&*new).filter(|(a, b)| a != b).flat_map(|(a, b)| [*a, *b]).collect();
        open.sort_unstable();
        open.dedup();
    }
}

/// The faces within `radius` of a corner.
fn near_corners(shape: &Shape, labels: &[u32], charts: usize, radius: f64) -> Vec<usize> {
    let census = census(shape.topology, labels, charts);
    let corners: Vec<glam::DVec3> =
        (0..census.sectors.len()).filter(|&v| census.sectors[v] >= 3).map(|v| shape.positions[v]).collect();
    (0..labels.len())
        .filter(|&f| corners.iter().any(|c| c.distance_squared(shape.centroids[f]) < radius * radius))
        .collect()
}

/// Rounds of local repairs before all changes of the charts concerned are undone.
const LOCAL_ROUNDS: usize = 30;

/// Undoes changes until all charts are valid or nothing is left to undo: first around pinches, crowded vertices and stray pieces,
/// then those of all faces whose old or new chart is still invalid.
fn repair(shape: &Shape, before: &[u32], new: &mut [u32], charts: usize, max_valence: usize) {
    let mut local = 0;
    loop {
        let census = census(shape.topology, new, charts);
        let bad: Vec<bool> = census.charts.iter().map(|c| !c.is_valid(max_valence)).collect();
        if !bad.contains(&true) {
            return;
        }
        let mut undo = Vec::new();
        if local < LOCAL_ROUNDS {
            local += 1;
            undo.extend(around_defects(shape, before, new, &census.sectors, max_valence));
            undo.extend(strays(shape, before, new, charts));
        }
        if undo.is_empty() {
            undo.extend(
                (0..new.len())
                    .filter(|&f| new[f] != before[f] && (bad[new[f] as usize] || bad[before[f] as usize])),
            );
        }
        if undo.is_empty() {
            return;
        }
        undo.into_iter().for_each(|f| new[f] = before[f]);
    }
}

/// The changed faces nearest to the vertices where a chart meets itself or too many charts meet.
fn around_defects(
    shape: &Shape,
    before: &[u32],
    new: &[u32],
    sectors: &[u32],
    max_valence: usize,
) -> Vec<usize> {
    let topology = shape.topology;
    let mut faces = Vec::new();
    let mut around = Vec::new();
    for v in 0..topology.vertex_count() as u32 {
        if sectors[v as usize] < 2 {
            continue;
        }
        around.clear();
        around.extend(
            topology.outgoing(v).filter(|&h| is_border(topology, new, h)).map(|h| new[h as usize / 3]),
        );
        around.sort_unstable();
        let pinched = around.windows(2).any(|pair| pair[0] == pair[1]);
        if !pinched && sectors[v as usize] as usize <= max_valence {
            continue;
        }
        let ring: Vec<usize> = topology.outgoing(v).map(|h| h as usize / 3).collect();
        let changed = |faces: &[usize]| -> Vec<usize> {
            faces.iter().copied().filter(|&f| new[f] != before[f]).collect()
        };
        let mut near = changed(&ring);
        if near.is_empty() {
            let wider: Vec<usize> = ring
                .iter()
                .flat_map(|&f| 3 * f as u32..3 * f as u32 + 3)
                .flat_map(|h| topology.outgoing(topology.tail(h)).map(|g| g as usize / 3).collect::<Vec<_>>())
                .collect();
            near = changed(&wider);
        }
        faces.extend(near);
    }
    faces
}

/// The changes that tore pieces off charts: of every piece but the largest the changed faces, and those beside it that it lost.
fn strays(shape: &Shape, before: &[u32], new: &[u32], charts: usize) -> Vec<usize> {
    let topology = shape.topology;
    let mut piece = vec![usize::MAX; new.len()];
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    let mut largest: Vec<Option<usize>> = vec![None; charts];
    for start in 0..new.len() {
        if piece[start] != usize::MAX {
            continue;
        }
        let mut members = vec![start];
        piece[start] = pieces.len();
        let mut done = 0;
        while done < members.len() {
            let f = members[done];
            done += 1;
            for h in 3 * f as u32..3 * f as u32 + 3 {
                let Some(g) = topology.opposite(h).map(|o| o as usize / 3) else { continue };
                if new[g] == new[start] && piece[g] == usize::MAX {
                    piece[g] = pieces.len();
                    members.push(g);
                }
            }
        }
        let most = &mut largest[new[start] as usize];
        if most.is_none_or(|k: usize| pieces[k].len() < members.len()) {
            *most = Some(pieces.len());
        }
        pieces.push(members);
    }
    let mut undo = Vec::new();
    for (k, members) in pieces.iter().enumerate() {
        let chart = new[members[0]];
        if largest[chart as usize] == Some(k) {
            continue;
        }
        for &f in members {
            if new[f] != before[f] {
                undo.push(f);
            }
            let beside = (3 * f as u32..3 * f as u32 + 3)
                .filter_map(|h| topology.opposite(h).map(|o| o as usize / 3))
                .filter(|&g| new[g] != chart && before[g] == chart);
            undo.extend(beside);
        }
    }
    undo
}
