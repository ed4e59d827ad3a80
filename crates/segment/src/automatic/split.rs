//! Splitting charts that turned out too hard.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};
use nalgebra::Matrix3;
use suture_mesh::{Topology, TriMesh};

use super::shape::Shape;
use super::survey::{SurveyArc, Surveyor, border};
use crate::segmentation::check_mesh;
use crate::{Limits, SegmentError, Segmentation};

/// Fewest faces of a chart that is split: a part needs a few vertices inside.
const FEWEST: usize = 24;
/// Smallest part of a cut, as a share of the area.
const SMALLEST_PART: f64 = 0.08;
/// Width that arcs of a part admit unless shorter ones are allowed: narrower blends are for want of others.
const NARROW: f64 = 0.006;
/// How much the objective of the borders may rise for every unit by which the cut straightens the normals.
const PRICE: f64 = 1.5;

/// Cuts each of `charts` in two where a valid cut exists, the first part keeping its label and the second one getting a new label
/// at the end: all other charts stay what they are. Of the cuts between far points, across the long directions of the chart and
/// between its normals, the one is taken that leaves the straightest parts for the shortest borders.
/// With `short_arcs` cuts may leave arcs that admit blends narrower than 0.6 % of the diagonal, where there are no others.
///
/// # Errors
/// As [`Segmentation::from_labels`] for a segmentation that does not belong to the mesh.
pub fn split_charts(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    charts: &[usize],
    limits: Limits,
    short_arcs: bool,
) -> Result<Segmentation, SegmentError> {
    check_mesh(mesh, topology)?;
    let shape = Shape::new(mesh, topology)?;
    let mut labels = segmentation.labels.clone();
    let mut count = segmentation.charts.len();
    let mut surveyor = Surveyor::new(&shape, limits.max_valence);
    for &chart in charts {
        let Some(boundary) = segmentation.charts.get(chart) else { continue };
        if boundary.faces.len() < FEWEST {
            continue;
        }
        let mut best: Option<((bool, f64), Vec<u32>)> = None;
        for part in candidates(&shape, &boundary.faces) {
            let Some(part) = connected(&shape, &boundary.faces, part) else { continue };
            let Some(straightened) = gain(&shape, &boundary.faces, &part) else { continue };
            let mut trial = labels.clone();
            part.iter().for_each(|&f| trial[f as usize] = count as u32);
            let Some(survey) = surveyor.survey(&trial, &border(&shape, &trial), count + 1) else { continue };
            let beside =
                |a: &&SurveyArc| a.charts.contains(&(chart as u32)) || a.charts.contains(&(count as u32));
            let narrow = survey.arcs.iter().filter(beside).any(|a| a.width < NARROW);
            if narrow && !short_arcs {
                continue;
            }
            let score = (narrow, survey.objective - PRICE * straightened);
            if best.as_ref().is_none_or(|(least, _)| score < *least) {
                best = Some((score, trial));
            }
        }
        if let Some((_, trial)) = best {
            labels = trial;
            count += 1;
        }
    }
    Segmentation::from_labels_with(mesh, topology, &labels, limits)
}

/// Second parts of possible cuts of the faces.
fn candidates(shape: &Shape, faces: &[u32]) -> Vec<Vec<u32>> {
    let mut inside = vec![false; shape.areas.len()];
    faces.iter().for_each(|&f| inside[f as usize] = true);
    let mut parts = Vec::new();
    // Four points, each farthest from those before it.
    let mut seeds = Vec::new();
    let mut fields: Vec<Vec<u64>> = Vec::new();
    let mut next = faces[0];
    for _ in 0..4 {
        let from_last = distances(shape, &inside, next);
        let farthest = |least: &dyn Fn(u32) -> u64| {
            faces.iter().copied().max_by_key(|&f| (least(f), Reverse(f))).unwrap_or(faces[0])
        };
        if seeds.is_empty() {
            // The first point is as far as possible from anywhere.
            next = farthest(&|f| from_last[f as usize]);
            seeds.push(next);
            fields.push(distances(shape, &inside, next));
        } else {
            seeds.push(next);
            fields.push(from_last);
        }
        next = farthest(&|f| fields.iter().map(|d| d[f as usize]).min().unwrap_or(0));
    }
    for (a, b) in [(0, 1), (2, 3), (0, 2), (1, 2), (0, 3), (1, 3)] {
        parts
            .push(faces.iter().copied().filter(|&f| fields[b][f as usize] < fields[a][f as usize]).collect());
    }
    let halves = |values: &dyn Fn(usize) -> DVec3, parts: &mut Vec<Vec<u32>>| {
        let area: f64 = faces.iter().map(|&f| shape.areas[f as usize]).sum();
        let weighted = |f: &u32| values(*f as usize) * shape.areas[*f as usize];
        let mean = faces.iter().map(weighted).sum::<DVec3>() / area;
        let mut moments = DMat3::ZERO;
        for &f in faces {
            let d = values(f as usize) - mean;
            let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            moments += outer * (shape.areas[f as usize] / area);
        }
        let eigen = Matrix3::from_column_slice(&moments.to_cols_array()).symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        for k in order.into_iter().take(2) {
            let axis = eigen.eigenvectors.column(k);
            let axis = DVec3::new(axis[0], axis[1], axis[2]);
            parts.push(
                faces.iter().copied().filter(|&f| (values(f as usize) - mean).dot(axis) > 0.0).collect(),
            );
        }
    };
    halves(&|f| shape.centroids[f], &mut parts);
    halves(&|f| shape.normals[f], &mut parts);
    parts
}

/// Distances from a face in the dual metric within the faces marked.
fn distances(shape: &Shape, inside: &[bool], from: u32) -> Vec<u64> {
    let mut distance = vec![u64::MAX; inside.len()];
    distance[from as usize] = 0;
    let mut queue = BinaryHeap::from([Reverse((0u64, from))]);
    while let Some(Reverse((d, f))) = queue.pop() {
        if d > distance[f as usize] {
            continue;
        }
        for h in 3 * f..3 * f + 3 {
            let Some(g) = shape.topology.opposite(h).map(|o| o / 3) else { continue };
            let next = d + shape.weights[h as usize];
            if inside[g as usize] && next < distance[g as usize] {
                distance[g as usize] = next;
                queue.push(Reverse((next, g)));
            }
        }
    }
    distance
}

/// Makes both parts connected: all but the largest component of either go to the other side. `None` where that does not end in two
/// connected parts.
fn connected(shape: &Shape, faces: &[u32], part: Vec<u32>) -> Option<Vec<u32>> {
    let mut side = vec![2u8; shape.areas.len()];
    faces.iter().for_each(|&f| side[f as usize] = 0);
    part.iter().for_each(|&f| side[f as usize] = 1);
    for _ in 0..4 {
        let mut seen = vec![false; side.len()];
        let mut components: [Vec<(f64, Vec<u32>)>; 2] = Default::default();
        for &start in faces {
            if seen[start as usize] {
                continue;
            }
            let which = side[start as usize];
            seen[start as usize] = true;
            let mut component = vec![start];
            let mut done = 0;
            while done < component.len() {
                let f = component[done];
                done += 1;
                for h in 3 * f..3 * f + 3 {
                    let Some(g) = shape.topology.opposite(h).map(|o| o / 3) else { continue };
                    if side[g as usize] == which && !seen[g as usize] {
                        seen[g as usize] = true;
                        component.push(g);
                    }
                }
            }
            let area = component.iter().map(|&f| shape.areas[f as usize]).sum();
            components[usize::from(which)].push((area, component));
        }
        if components.iter().any(Vec::is_empty) {
            return None;
        }
        if components.iter().all(|c| c.len() == 1) {
            return Some(faces.iter().copied().filter(|&f| side[f as usize] == 1).collect());
        }
        for (which, parts) in components.into_iter().enumerate() {
            let largest =
                (0..parts.len()).max_by(|&a, &b| parts[a].0.total_cmp(&parts[b].0).then(b.cmp(&a)))?;
            for (k, (_, stray)) in parts.into_iter().enumerate() {
                if k != largest {
                    stray.into_iter().for_each(|f| side[f as usize] = 1 - which as u8);
                }
            }
        }
    }
    None
}

/// How much straighter the parts are than the whole: (|S_a| + |S_b| − |S|)/A of the summed normals; `None` for a sliver of a part.
fn gain(shape: &Shape, faces: &[u32], part: &[u32]) -> Option<f64> {
    let sum = |faces: &mut dyn Iterator<Item = u32>| {
        faces.fold((0.0, DVec3::ZERO), |(area, normal), f| {
            let a = shape.areas[f as usize];
            (area + a, normal + shape.normals[f as usize] * a)
        })
    };
    let (area, whole) = sum(&mut faces.iter().copied());
    let (a, first) = sum(&mut part.iter().copied());
    let share = a / area;
    let straightened = (first.length() + (whole - first).length() - whole.length()) / area;
    (SMALLEST_PART..=1.0 - SMALLEST_PART).contains(&share).then_some(straightened)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Automatic, AutomaticOptions, Segment};

    #[test]
    fn a_split_keeps_every_other_chart() {
        let mesh = suture_mesh::shapes::torus(1.0, 0.4, 48, 24);
        let topology = Topology::build(&mesh).unwrap();
        let options = AutomaticOptions { rounds: 1, ..AutomaticOptions::default() };
        let automatic = Automatic { options, ..Automatic::default() };
        let before = automatic.segment(&mesh, &topology).unwrap();
        let limits = Limits { max_valence: 6 };
        let after = split_charts(&mesh, &topology, &before, &[1, 2], limits, false).unwrap();
        let n = before.charts.len();
        assert_eq!(after.charts.len(), n + 2);
        for (old, new) in before.labels.iter().zip(&after.labels) {
            assert!(old == new || (*old == 1 && *new == n as u32) || (*old == 2 && *new == n as u32 + 1));
        }
        let corners = after.corners.len() as i64;
        assert_eq!(corners - after.arcs.len() as i64 + after.charts.len() as i64, 0, "a torus of discs");
    }

    #[test]
    fn tiny_charts_stay_whole() {
        let mesh = TriMesh::new(
            vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        );
        let topology = Topology::build(&mesh).unwrap();
        let segmentation = Segmentation::from_labels(&mesh, &topology, &[0u32, 1, 2, 3]).unwrap();
        let same =
            split_charts(&mesh, &topology, &segmentation, &[0, 3], Limits { max_valence: 8 }, true).unwrap();
        assert_eq!(same.labels, segmentation.labels);
    }
}
