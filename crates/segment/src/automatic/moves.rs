//! Corner moves: local relabelling that lengthens short arcs.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::merge::{DISTORTED, distortion};
use super::shape::{Shape, UNIT};
use super::survey::{Survey, SurveyArc, Surveyor, border};
use crate::Flatten;
use crate::census::is_border;
use crate::segmentation::reach;

/// Most moves per call.
const MOVES: usize = 80;
/// Most arcs looked at per call, successful moves included; a count and not a time, so that machines agree.
const ATTEMPTS: usize = 240;
/// Largest number of faces a move looks at.
const BALL: usize = 20_000;

/// Most candidates for an arc whose charts are flattened.
const FLATTENED: usize = 4;

/// Lengthens short arcs one by one: for the arc that admits the least width, tries to push its ends outwards, to let other
/// corners slide, and to exchange the neighbours across it, and keeps the valid result with the least objective
/// whose charts can be flattened. Stops when no
/// short arc can be improved, after 80 moves or 240 attempts.
pub(super) fn move_corners(
    shape: &Shape,
    flatten: &(dyn Flatten + Sync),
    labels: &mut Vec<u32>,
    charts: usize,
    max_valence: usize,
) {
    let mut mover = Mover {
        shape,
        flatten,
        surveyor: Surveyor::new(shape, max_valence),
        charts,
        borders: border(shape, labels),
        labels: std::mem::take(labels),
        distortions: vec![None; charts],
        listed: vec![false; shape.lengths.len()],
        distance: vec![u64::MAX; shape.areas.len()],
        reached: vec![(u64::MAX, u32::MAX); shape.areas.len()],
    };
    mover.run();
    *labels = mover.labels;
}

struct Mover<'a> {
    shape: &'a Shape<'a>,
    flatten: &'a (dyn Flatten + Sync),
    surveyor: Surveyor<'a>,
    charts: usize,
    labels: Vec<u32>,
    borders: Vec<u32>,
    /// How the charts are distorted, as far as that was asked.
    distortions: Vec<Option<f64>>,
    /// Scratch: half-edges of the border list.
    listed: Vec<bool>,
    /// Scratch: distance from the centre of the ball.
    distance: Vec<u64>,
    /// Scratch: distance from the growing charts, and which.
    reached: Vec<(u64, u32)>,
}

impl Mover<'_> {
    fn run(&mut self) {
        let Some(mut survey) = self.surveyor.survey(&self.labels, &self.borders, self.charts) else { return };
        let mut blocked: Vec<([u32; 2], [u32; 2])> = Vec::new();
        let mut moves = 0;
        for _ in 0..ATTEMPTS {
            if moves == MOVES {
                return;
            }
            let shortest = survey
                .arcs
                .iter()
                .filter(|a| a.width < a.wanted && !blocked.contains(&(a.charts, a.ends)))
                .min_by(|a, b| {
                    (a.width / a.wanted).total_cmp(&(b.width / b.wanted)).then(a.ends.cmp(&b.ends))
                });
            let Some(arc) = shortest.cloned() else { return };
            let Some((changes, next)) = self.best_move(&arc, survey.objective) else {
                blocked.push((arc.charts, arc.ends));
                continue;
            };
            moves += 1;
            let touched: Vec<u32> =
                changes.iter().flat_map(|&(f, new)| [new, self.labels[f as usize]]).collect();
            // What blocked an arc may be gone when one of its charts changed.
            blocked.retain(|(charts, _)| !charts.iter().any(|r| touched.contains(r)));
            touched.iter().for_each(|&r| self.distortions[r as usize] = None);
            for (f, new) in changes {
                self.labels[f as usize] = new;
            }
            self.borders = border(self.shape, &self.labels);
            survey = next;
        }
    }

    /// The best strictly improving valid candidate whose charts can still be flattened, the first of equals.
    fn best_move(&mut self, arc: &SurveyArc, objective: f64) -> Option<(Vec<(u32, u32)>, Survey)> {
        let mut better: Vec<(Vec<(u32, u32)>, Survey)> = Vec::new();
        let mut tried: Vec<Vec<(u32, u32)>> = Vec::new();
        for (centre, rho, from, to) in self.candidates(arc) {
            let changes = self.grow(centre, rho, &from, &to);
            if changes.is_empty() || tried.contains(&changes) {
                continue;
            }
            if let Some(survey) = self.survey_with(&changes)
                && survey.objective < objective - 1e-9
            {
                better.push((changes.clone(), survey));
            }
            tried.push(changes);
        }
        better.sort_by(|(_, a), (_, b)| a.objective.total_cmp(&b.objective));
        better.truncate(FLATTENED);
        better.into_iter().find(|(changes, _)| self.keeps_flat(changes))
    }

    /// Whether the charts concerned can be flattened, or are no worse than before.
    fn keeps_flat(&mut self, changes: &[(u32, u32)]) -> bool {
        let mut concerned: Vec<u32> =
            changes.iter().flat_map(|&(f, new)| [new, self.labels[f as usize]]).collect();
        concerned.sort_unstable();
        concerned.dedup();
        let (shape, flatten, labels) = (self.shape, self.flatten, &self.labels);
        let faces = |chart: u32| (0..labels.len() as u32).filter(move |&f| labels[f as usize] == chart);
        let distorted: Vec<(u32, f64)> = concerned
            .into_par_iter()
            .map(|chart| {
                let stays = |f: &u32| changes.binary_search_by_key(f, |c| c.0).is_err();
                let gained = changes.iter().filter(|c| c.1 == chart).map(|c| c.0);
                let mut after: Vec<u32> = faces(chart).filter(stays).chain(gained).collect();
                after.sort_unstable();
                (chart, distortion(shape, flatten, &after))
            })
            .filter(|(_, after)| *after > DISTORTED)
            .collect();
        distorted.into_iter().all(|(chart, after)| {
            let before = || distortion(shape, flatten, &faces(chart).collect::<Vec<_>>());
            after < *self.distortions[chart as usize].get_or_insert_with(before)
        })
    }

    /// Centre, radius, the charts that give faces and those that take them.
    fn candidates(&self, arc: &SurveyArc) -> Vec<(u32, f64, Vec<u32>, Vec<u32>)> {
        let shape = self.shape;
        let around = arc.ends.map(|v| self.charts_at(v));
        let missing = (arc.wanted - arc.width) * (reach(around[0].len()) + reach(around[1].len()) + 1.0);
        let mut list = Vec::new();
        for (&v, here) in arc.ends.iter().zip(&around) {
            let others = |x: &[u32]| here.iter().copied().filter(|r| !x.contains(r)).collect::<Vec<_>>();
            for f in [0.5, 1.0, 1.6] {
                let rho = f64::max(f * missing, 1.2 * shape.median_edge);
                list.push((v, rho, others(&arc.charts), arc.charts.to_vec()));
                for &x in here {
                    list.push((v, rho, vec![x], others(&[x])));
                    for y in others(&[x]) {
                        list.push((v, rho, vec![x], vec![y]));
                    }
                }
            }
        }
        let mut beyond: Vec<u32> =
            around.iter().flatten().copied().filter(|r| !arc.charts.contains(r)).collect();
        beyond.sort_unstable();
        beyond.dedup();
        for f in [0.5, 1.0, 1.6] {
            let rho = 0.5 * arc.length + f * missing / 1.5 + shape.median_edge;
            list.push((arc.middle, rho, arc.charts.to_vec(), beyond.clone()));
        }
        list
    }

    fn charts_at(&self, v: u32) -> Vec<u32> {
        let topology = self.shape.topology;
        topology
            .outgoing(v)
            .filter(|&h| is_border(topology, &self.labels, h))
            .map(|h| self.labels[h as usize / 3])
            .collect()
    }

    /// The faces within `rho` of a vertex whose chart is in `from`, each with the nearest chart of `to`, reached through `from`.
    fn grow(&mut self, centre: u32, rho: f64, from: &[u32], to: &[u32]) -> Vec<(u32, u32)> {
        let shape = self.shape;
        let topology = shape.topology;
        let limit = (rho * UNIT) as u64;
        let step = |h: u32| ((shape.spans[h as usize] * UNIT).round() as u64).max(1);
        let mut ball = Vec::new();
        let mut queue = BinaryHeap::new();
        for h in topology.outgoing(centre) {
            let f = h / 3;
            let d = shape.centroids[f as usize].distance(shape.positions[centre as usize]);
            let d = (d * UNIT).round() as u64;
            self.distance[f as usize] = d;
            ball.push(f);
            queue.push(Reverse((d, f)));
        }
        while let Some(Reverse((d, f))) = queue.pop() {
            if d > self.distance[f as usize] || ball.len() > BALL {
                continue;
            }
            for h in 3 * f..3 * f + 3 {
                let Some(g) = topology.opposite(h).map(|o| o / 3) else { continue };
                let next = d + step(h);
                if next <= limit && next < self.distance[g as usize] {
                    if self.distance[g as usize] == u64::MAX {
                        ball.push(g);
                    }
                    self.distance[g as usize] = next;
                    queue.push(Reverse((next, g)));
                }
            }
        }
        let mut queue = BinaryHeap::new();
        for &f in ball.iter().filter(|&&f| to.contains(&self.labels[f as usize])) {
            let label = self.labels[f as usize];
            self.reached[f as usize] = (0, label);
            queue.push(Reverse((0u64, label, f)));
        }
        while let Some(Reverse((d, label, f))) = queue.pop() {
            if (d, label) > self.reached[f as usize] {
                continue;
            }
            for h in 3 * f..3 * f + 3 {
                let Some(g) = topology.opposite(h).map(|o| o / 3) else { continue };
                let inside = self.distance[g as usize] != u64::MAX && from.contains(&self.labels[g as usize]);
                let next = (d + step(h), label);
                if inside && next < self.reached[g as usize] {
                    self.reached[g as usize] = next;
                    queue.push(Reverse((next.0, next.1, g)));
                }
            }
        }
        ball.sort_unstable();
        let mut changes = Vec::new();
        for &f in &ball {
            let (d, label) = self.reached[f as usize];
            if d != u64::MAX && d > 0 {
                changes.push((f, label));
            }
            self.distance[f as usize] = u64::MAX;
            self.reached[f as usize] = (u64::MAX, u32::MAX);
        }
        changes
    }

    /// Surveys the partition with some faces relabelled, and leaves it as it was.
    fn survey_with(&mut self, changes: &[(u32, u32)]) -> Option<Survey> {
        let topology = self.shape.topology;
        let old: Vec<u32> = changes.iter().map(|&(f, _)| self.labels[f as usize]).collect();
        for &(f, new) in changes {
            self.labels[f as usize] = new;
        }
        let mut borders: Vec<u32> = Vec::with_capacity(self.borders.len() + 3 * changes.len());
        borders.extend(self.borders.iter().copied().filter(|&h| is_border(topology, &self.labels, h)));
        for &h in &borders {
            self.listed[h as usize] = true;
        }
        for &(f, _) in changes {
            for h in 3 * f..3 * f + 3 {
                for g in [Some(h), topology.opposite(h)].into_iter().flatten() {
                    if !self.listed[g as usize] && is_border(topology, &self.labels, g) {
                        self.listed[g as usize] = true;
                        borders.push(g);
                    }
                }
            }
        }
        for &h in &borders {
            self.listed[h as usize] = false;
        }
        let survey = self.surveyor.survey(&self.labels, &borders, self.charts);
        for (&(f, _), old) in changes.iter().zip(old) {
            self.labels[f as usize] = old;
        }
        survey
    }
}
