//! A fine valid partition to start from: Voronoi cells of the dual metric.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::shape::{Shape, UNIT};
use crate::SegmentError;
use crate::census::census;

/// Cells are refined until no face is farther than this from its seed.
const RADIUS: f64 = 0.045;
/// Rounds of repair before giving up.
const ROUNDS: usize = 60;

/// Labels of a partition into discs with at least three corners each; valences are not limited.
///
/// Farthest-point seeds, two steps of Lloyd's iteration, then further seeds in the cells that are no discs. One face per cell is
/// always valid, so the repair ends.
pub(super) fn cells(shape: &Shape) -> Result<Vec<u32>, SegmentError> {
    let faces = shape.areas.len();
    let mut voronoi = Voronoi::new(shape, vec![first_seed(shape)]);
    let most = (faces / 5).clamp(8, 500).min(faces);
    while voronoi.seeds.len() < most {
        let Some(f) = voronoi.farthest(|_| true) else { break };
        if (voronoi.distances[f as usize] as f64) < RADIUS * UNIT {
            break;
        }
        voronoi.insert(f);
    }
    for _ in 0..2 {
        let seeds = voronoi.centres();
        voronoi = Voronoi::new(shape, seeds);
    }
    for rounds in 0..=ROUNDS {
        let cells = voronoi.seeds.len();
        let census = census(shape.topology, &voronoi.labels, cells);
        let bad: Vec<usize> = (0..cells).filter(|&r| !census.charts[r].is_valid(usize::MAX)).collect();
        if bad.is_empty() {
            return Ok(voronoi.labels);
        }
        let mut split = bad.clone();
        for &r in bad.iter().filter(|&&r| census.charts[r].corners < 3) {
            split.extend(voronoi.longest_neighbour(r as u32));
        }
        split.sort_unstable();
        split.dedup();
        let new: Vec<u32> = split
            .iter()
            .filter_map(|&r| voronoi.farthest(|f| voronoi.labels[f as usize] == r as u32))
            .collect();
        if new.is_empty() || rounds == ROUNDS {
            return Err(SegmentError::NoValidStart { rounds, cells, invalid: bad.len() });
        }
        for f in new {
            voronoi.insert(f);
        }
    }
    Err(SegmentError::NoValidStart { rounds: ROUNDS, cells: voronoi.seeds.len(), invalid: 0 })
}

/// The face farthest from the centre of area.
fn first_seed(shape: &Shape) -> u32 {
    let total: f64 = shape.areas.iter().sum();
    let centre = shape.areas.iter().zip(&shape.centroids).map(|(a, c)| *a * *c).sum::<DVec3>() / total;
    // Rounded, so that equally far faces are a tie.
    let key = |f: u32| (shape.centroids[f as usize].distance(centre) * UNIT).round() as u64;
    (0..shape.areas.len() as u32).max_by_key(|&f| (key(f), Reverse(f))).unwrap_or(0)
}

/// Voronoi cells, kept up to date while seeds are added; ties go to the lower seed.
struct Voronoi<'a> {
    shape: &'a Shape<'a>,
    seeds: Vec<u32>,
    distances: Vec<u64>,
    labels: Vec<u32>,
}

impl<'a> Voronoi<'a> {
    fn new(shape: &'a Shape<'a>, seeds: Vec<u32>) -> Self {
        let faces = shape.areas.len();
        let mut voronoi = Self {
            shape,
            seeds: Vec::new(),
            distances: vec![u64::MAX; faces],
            labels: vec![u32::MAX; faces],
        };
        for seed in seeds {
            voronoi.insert(seed);
        }
        voronoi
    }

    /// Adds a seed. Later seeds have higher labels, hence win a face only when strictly nearer.
    fn insert(&mut self, seed: u32) {
        let label = self.seeds.len() as u32;
        self.seeds.push(seed);
        self.distances[seed as usize] = 0;
        self.labels[seed as usize] = label;
        let mut queue = BinaryHeap::from([Reverse((0u64, seed))]);
        while let Some(Reverse((d, f))) = queue.pop() {
            if d > self.distances[f as usize] {
                continue;
            }
            for h in 3 * f..3 * f + 3 {
                let Some(g) = self.shape.topology.opposite(h).map(|o| o / 3) else { continue };
                let next = d + self.shape.weights[h as usize];
                if next < self.distances[g as usize] {
                    self.distances[g as usize] = next;
                    self.labels[g as usize] = label;
                    queue.push(Reverse((next, g)));
                }
            }
        }
    }

    /// The face farthest from its seed among those chosen, the lowest of equals; `None` when only seeds are chosen.
    fn farthest(&self, choose: impl Fn(u32) -> bool) -> Option<u32> {
        (0..self.labels.len() as u32)
            .filter(|&f| self.distances[f as usize] > 0 && choose(f))
            .max_by_key(|&f| (self.distances[f as usize], Reverse(f)))
    }

    /// For every cell the face nearest to its centre of area.
    fn centres(&self) -> Vec<u32> {
        let shape = self.shape;
        let mut sums = vec![(0.0, DVec3::ZERO); self.seeds.len()];
        for (f, &r) in self.labels.iter().enumerate() {
            let (area, moment) = &mut sums[r as usize];
            *area += shape.areas[f];
            *moment += shape.areas[f] * shape.centroids[f];
        }
        let mut best = vec![(u64::MAX, u32::MAX); self.seeds.len()];
        for (f, &r) in self.labels.iter().enumerate() {
            let (area, moment) = sums[r as usize];
            let d = (shape.centroids[f].distance(moment / area) * UNIT).round() as u64;
            let best = &mut best[r as usize];
            *best = (*best).min((d, f as u32));
        }
        best.into_iter().map(|(_, f)| f).collect()
    }

    /// The cell with the longest common border; the lowest of equals.
    fn longest_neighbour(&self, cell: u32) -> Option<usize> {
        let mut common = vec![0.0; self.seeds.len()];
        for h in 0..self.shape.topology.half_edge_count() as u32 {
            if self.labels[h as usize / 3] == cell
                && let Some(o) = self.shape.topology.opposite(h)
                && self.labels[o as usize / 3] != cell
            {
                common[self.labels[o as usize / 3] as usize] += self.shape.lengths[h as usize];
            }
        }
        let best = (0..common.len()).rev().max_by(|&a, &b| common[a].total_cmp(&common[b]))?;
        (common[best] > 0.0).then_some(best)
    }
}
