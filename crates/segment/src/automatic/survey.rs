//! Fast check and measure of a partition from its border half-edges alone.

use glam::DVec3;

use super::shape::Shape;
use crate::census::{is_border, next_border};
use crate::segmentation::{smoothed_length, width};

/// Width that every arc should admit; shorter ones cost.
pub(super) const WANTED: f64 = 0.025;

/// An arc as the survey sees it, walked with `charts[0]` on its left.
#[derive(Clone, Debug)]
pub(super) struct SurveyArc {
    pub(super) charts: [u32; 2],
    /// Vertices of both ends.
    pub(super) ends: [u32; 2],
    /// The vertex in the middle of the chain.
    pub(super) middle: u32,
    /// Smoothed length.
    pub(super) length: f64,
    /// Admissible width.
    pub(super) width: f64,
    /// Width that it should admit.
    pub(super) wanted: f64,
}

/// A valid partition's arcs and its objective: Σ max(0, 1 − W/w)² over the arcs + 0.3 Σ |e| (1 − 0.9 k) over the border.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    pub(super) arcs: Vec<SurveyArc>,
    pub(super) objective: f64,
}

/// The surveyor and its scratch memory.
pub(super) struct Surveyor<'a> {
    shape: &'a Shape<'a>,
    max_valence: usize,
    euler: i64,
    sectors: Vec<u32>,
    stamp: Vec<u32>,
    now: u32,
    walk: Vec<u32>,
    chain: Vec<DVec3>,
}

impl<'a> Surveyor<'a> {
    pub(super) fn new(shape: &'a Shape<'a>, max_valence: usize) -> Self {
        let vertices = shape.topology.vertex_count();
        let used = (0..vertices as u32).filter(|&v| shape.topology.outgoing(v).next().is_some()).count();
        Self {
            shape,
            max_valence,
            euler: used as i64 - shape.areas.len() as i64 / 2,
            sectors: vec![0; vertices],
            stamp: vec![0; vertices],
            now: 0,
            walk: Vec::new(),
            chain: Vec::new(),
        }
    }

    /// Surveys the labels `0..charts` whose border half-edges are `border`; `None` when an invariant is broken.
    ///
    /// When every chart has one loop without pinch, it is connected and its Euler number is at most 1; then all are discs iff
    /// corners − arcs + charts is the Euler number of the mesh.
    pub(super) fn survey(&mut self, labels: &[u32], border: &[u32], charts: usize) -> Option<Survey> {
        for &h in border {
            self.sectors[self.shape.topology.tail(h) as usize] += 1;
        }
        let survey = self.read(labels, border, charts);
        for &h in border {
            self.sectors[self.shape.topology.tail(h) as usize] = 0;
        }
        survey
    }

    fn read(&mut self, labels: &[u32], border: &[u32], charts: usize) -> Option<Survey> {
        let topology = self.shape.topology;
        let mut first = vec![(u32::MAX, 0usize); charts];
        for &h in border {
            let entry = &mut first[labels[h as usize / 3] as usize];
            *entry = (entry.0.min(h), entry.1 + 1);
        }
        let mut survey = Survey { arcs: Vec::new(), objective: 0.0 };
        let mut ends = 0i64;
        for (start, count) in first {
            if count == 0 {
                return None;
            }
            self.now += 1;
            self.walk.clear();
            let (mut h, mut turning) = (start, None);
            let mut around = 0;
            loop {
                let v = topology.tail(h) as usize;
                if self.stamp[v] == self.now {
                    return None;
                }
                self.stamp[v] = self.now;
                if self.sectors[v] >= 3 {
                    if self.sectors[v] as usize > self.max_valence {
                        return None;
                    }
                    around += 1;
                    turning.get_or_insert(self.walk.len());
                }
                self.walk.push(h);
                h = next_border(topology, labels, h);
                if h == start {
                    break;
                }
            }
            if self.walk.len() != count || around < 3 {
                return None;
            }
            ends += around;
            self.walk.rotate_left(turning.unwrap_or(0));
            self.arcs(labels, &mut survey);
        }
        let distinct = self.distinct_corners(border);
        (distinct - ends / 2 + charts as i64 == self.euler).then_some(survey)
    }

    fn distinct_corners(&mut self, border: &[u32]) -> i64 {
        self.now += 1;
        let mut corners = 0;
        for &h in border {
            let v = self.shape.topology.tail(h) as usize;
            if self.sectors[v] >= 3 && self.stamp[v] != self.now {
                self.stamp[v] = self.now;
                corners += 1;
            }
        }
        corners
    }

    /// Measures the arcs on the loop `self.walk`, which begins at a corner; each arc once, from its lower chart.
    fn arcs(&mut self, labels: &[u32], survey: &mut Survey) {
        let Self { shape, sectors, walk, chain, .. } = self;
        let topology = shape.topology;
        let corner = |v: u32| sectors[v as usize] >= 3;
        let mut from = 0;
        for to in 1..=walk.len() {
            if to < walk.len() && !corner(topology.tail(walk[to])) {
                continue;
            }
            let piece = &walk[from..to];
            from = to;
            let (head, last) = (piece[0], piece[piece.len() - 1]);
            let left = labels[head as usize / 3];
            let right = topology.opposite(head).map_or(left, |o| labels[o as usize / 3]);
            if left > right {
                continue;
            }
            let ends = [topology.tail(head), topology.head(last)];
            chain.clear();
            chain.extend(piece.iter().map(|&h| shape.positions[topology.tail(h) as usize]));
            chain.push(shape.positions[ends[1] as usize]);
            let length = smoothed_length(chain);
            let width = width(length, ends.map(|v| sectors[v as usize] as usize));
            let wanted = WANTED * shape.modesty(ends);
            let short = (1.0 - width / wanted).max(0.0);
            survey.objective += short * short;
            for &h in piece {
                survey.objective += 0.3 * shape.lengths[h as usize] * (1.0 - 0.9 * shape.creases[h as usize]);
            }
            let middle = topology.tail(piece[piece.len() / 2]);
            survey.arcs.push(SurveyArc { charts: [left, right], ends, middle, length, width, wanted });
        }
    }
}

/// All border half-edges of a labelling, ascending.
pub(super) fn border(shape: &Shape, labels: &[u32]) -> Vec<u32> {
    (0..shape.topology.half_edge_count() as u32).filter(|&h| is_border(shape.topology, labels, h)).collect()
}
