//! Charts too narrow for any blend.

use std::collections::BTreeMap;

use super::merge::smoothed;
use super::shape::Shape;
use crate::{Limits, Segmentation};

/// Thickness, in diagonals, below which a chart is given to a neighbour: blends that are pleasant to look at are not narrower either.
const THINNEST: f64 = 0.008;

/// Gives charts that are too narrow to the neighbours with the longest borders, as long as a partition remains. Narrow charts beside each
/// other go together: alone, one would leave the other with two corners.
pub(super) fn absorb_thin(shape: &Shape<'_>, mut now: Segmentation, limits: Limits) -> Segmentation {
    'again: loop {
        let lengths: Vec<f64> = now.arcs.iter().map(|arc| smoothed(shape, &arc.vertices)).collect();
        for group in thin_groups(shape, &now, &lengths) {
            for neighbour in neighbours(&now, &group, &lengths) {
                let mut labels = now.labels.clone();
                labels.iter_mut().filter(|l| group.contains(l)).for_each(|l| *l = neighbour);
                if let Ok(next) = Segmentation::from_labels_with(shape.mesh, shape.topology, &labels, limits)
                {
                    now = next;
                    continue 'again;
                }
            }
        }
        return now;
    }
}

/// Charts whose area is less than half their circumference times [`THINNEST`], those that are neighbours together.
fn thin_groups(shape: &Shape<'_>, now: &Segmentation, lengths: &[f64]) -> Vec<Vec<u32>> {
    let thin: Vec<bool> = now
        .charts
        .iter()
        .map(|chart| {
            let area: f64 = chart.faces.iter().map(|&f| shape.areas[f as usize]).sum();
            2.0 * area < THINNEST * chart.arcs.iter().map(|end| lengths[end.arc]).sum::<f64>()
        })
        .collect();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    let mut seen = vec![false; thin.len()];
    for start in (0..thin.len()).filter(|&c| thin[c]) {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut group = vec![start as u32];
        let mut next = 0;
        while let Some(&chart) = group.get(next) {
            next += 1;
            for end in &now.charts[chart as usize].arcs {
                let arc = &now.arcs[end.arc];
                for other in [arc.left, arc.right] {
                    if thin[other as usize] && !std::mem::replace(&mut seen[other as usize], true) {
                        group.push(other);
                    }
                }
            }
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}

/// The charts around a group, that with the longest common border first.
fn neighbours(now: &Segmentation, group: &[u32], lengths: &[f64]) -> Vec<u32> {
    let mut common: BTreeMap<u32, f64> = BTreeMap::new();
    for (arc, length) in now.arcs.iter().zip(lengths) {
        for (inside, outside) in [(arc.left, arc.right), (arc.right, arc.left)] {
            if group.contains(&inside) && !group.contains(&outside) {
                *common.entry(outside).or_default() += length;
            }
        }
    }
    let mut all: Vec<(u32, f64)> = common.into_iter().collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    all.into_iter().map(|(chart, _)| chart).collect()
}
