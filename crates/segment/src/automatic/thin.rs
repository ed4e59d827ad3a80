//! Charts too narrow for any blend.

use std::collections::BTreeMap;

use super::merge::{DISTORTED, distortion, smoothed};
use super::shape::Shape;
use super::survey::WANTED;
use crate::{Flatten, Limits, Segmentation};

/// Gives charts thinner than `least` diagonals (area over half the circumference) to the neighbours with the longest borders, as long as a
/// partition remains, no arc becomes too short for blends and the neighbours can still be flattened. Thin charts beside each other go together: alone, one may leave the other with two corners.
pub(super) fn absorb_thin(
    shape: &Shape<'_>,
    flatten: &dyn Flatten,
    mut now: Segmentation,
    limits: Limits,
    least: f64,
) -> Segmentation {
    'again: loop {
        let before = narrowest(shape, &now);
        let lengths: Vec<f64> = now.arcs.iter().map(|arc| smoothed(shape, &arc.vertices)).collect();
        for group in thin_groups(shape, &now, &lengths, least) {
            for neighbour in neighbours(&now, &group, &lengths) {
                let mut labels = now.labels.clone();
                labels.iter_mut().filter(|l| group.contains(l)).for_each(|l| *l = neighbour);
                let Ok(next) = Segmentation::from_labels_with(shape.mesh, shape.topology, &labels, limits)
                else {
                    continue;
                };
                let grown = next.labels[now.charts[neighbour as usize].faces[0] as usize];
                let faces = &next.charts[grown as usize].faces;
                if narrowest(shape, &next) >= before && distortion(shape, flatten, faces) <= DISTORTED {
                    now = next;
                    continue 'again;
                }
            }
        }
        return now;
    }
}

/// The least width that an arc admits, as far as blends would use it.
fn narrowest(shape: &Shape<'_>, segmentation: &Segmentation) -> f64 {
    segmentation.arc_widths(shape.mesh).into_iter().fold(WANTED, f64::min)
}

/// Charts thinner than `least`, those that are neighbours together.
fn thin_groups(shape: &Shape<'_>, now: &Segmentation, lengths: &[f64], least: f64) -> Vec<Vec<u32>> {
    let thin: Vec<bool> = now
        .charts
        .iter()
        .map(|chart| {
            let area: f64 = chart.faces.iter().map(|&f| shape.areas[f as usize]).sum();
            2.0 * area < least * chart.arcs.iter().map(|end| lengths[end.arc]).sum::<f64>()
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

#[cfg(test)]
mod tests {
    use suture_mesh::{Topology, TriMesh, shapes};

    use super::*;
    use crate::NormalSpread;

    #[test]
    fn thin_charts_go_to_a_neighbour_together() {
        let mesh = shapes::cuboid(glam::DVec3::ONE, 10);
        let topology = Topology::build(&mesh).unwrap();
        let centre = |m: &TriMesh, f: usize| m.corners(f).into_iter().sum::<glam::DVec3>() / 3.0;
        let low = (0..mesh.faces.len()).map(|f| centre(&mesh, f).min_element()).fold(f64::INFINITY, f64::min);
        // The six sides, and a row along an edge of one of them in two halves.
        let labels: Vec<u32> = (0..mesh.faces.len())
            .map(|f| {
                let (n, c) = (mesh.area_vector(f).normalize(), centre(&mesh, f));
                let side = (0..6).find(|&k| n[k / 2] * if k % 2 == 0 { 1.0 } else { -1.0 } > 0.5).unwrap();
                match (side, c.y < low + 0.1, c.z < low + 0.5) {
                    (0, true, false) => 6,
                    (0, true, true) => 7,
                    _ => side as u32,
                }
            })
            .collect();
        let limits = Limits::default();
        let before = Segmentation::from_labels_with(&mesh, &topology, &labels, limits).unwrap();
        assert_eq!(before.charts.len(), 8);
        let shape = Shape::new(&mesh, &topology).unwrap();
        let flatten = NormalSpread::default();
        assert_eq!(absorb_thin(&shape, &flatten, before.clone(), limits, 0.01).charts.len(), 8);
        let after = absorb_thin(&shape, &flatten, before, limits, 0.06);
        assert_eq!((after.charts.len(), after.corners.len(), after.arcs.len()), (6, 8, 12));
    }
}
