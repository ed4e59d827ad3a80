//! Merging of charts on the map of corners and arcs.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::shape::Shape;
use crate::segmentation::{smoothed_length, width};
use crate::{Flatten, Segmentation};

/// The shape that a union of two charts may have.
#[derive(Clone, Copy)]
pub(super) struct Rules {
    /// Largest cone value E = 1 − |S|/A of the union.
    pub(super) cone: f64,
    /// Largest share of crease in the arc that disappears.
    pub(super) crease: f64,
    /// Largest perimeter² / (4π area); `None` for the bound that relaxes for flat charts.
    pub(super) round: Option<f64>,
    /// E above which the union must be flattened.
    pub(super) test_above: f64,
    /// Largest distortion of the flattening.
    pub(super) distortion: f64,
}

impl Rules {
    /// For the greedy phases; flat parts first (0.08), half cylinders last (0.36).
    pub(super) fn cone(cone: f64) -> Self {
        Self { cone, crease: CREASED, round: None, test_above: CURVED, distortion: 5.0 }
    }

    /// From the strictest to the laxest, for arcs that are too short.
    pub(super) const LADDER: [Self; 3] = [
        Self { cone: 0.36, crease: CREASED, round: None, test_above: CURVED, distortion: 5.0 },
        Self { cone: 0.45, crease: 1.0, round: Some(4.0), test_above: CURVED, distortion: 5.0 },
        Self { cone: 0.85, crease: 1.0, round: Some(4.0), test_above: 0.0, distortion: 6.0 },
    ];
}

/// Share of crease in an arc from which it lies on one.
const CREASED: f64 = 0.25;
/// Largest distortion that smoothing and moving may give a chart.
pub(super) const DISTORTED: f64 = 6.0;

/// Length of creases inside a chart, in roots of its area, up to which its cone alone tells whether it is flat: a hole may have small sides in a
/// large plane.
const NOTCH: f64 = 0.05;
/// Cone value up to which a chart without creases inside is flat.
const CURVED: f64 = 0.15;

/// How the chart of these faces (ascending) is distorted, 1 if it is nearly flat; infinite where it cannot be flattened.
pub(super) fn distortion(shape: &Shape, flatten: &dyn Flatten, faces: &[u32]) -> f64 {
    let (mut area, mut normal, mut crease) = (0.0, DVec3::ZERO, 0.0);
    for &f in faces {
        area += shape.areas[f as usize];
        normal += shape.areas[f as usize] * shape.normals[f as usize];
        crease += shape.crease_inside(f as usize, |g| faces.binary_search(&(g as u32)).is_ok());
    }
    if 1.0 - normal.length() / area <= CURVED && crease <= NOTCH * area.sqrt() {
        return 1.0;
    }
    flatten.distortion(shape.mesh, shape.topology, faces).unwrap_or(f64::INFINITY)
}

/// An arc of the map, with the charts left and right of the walk.
struct Arc {
    ends: [usize; 2],
    sides: [usize; 2],
    length: f64,
    crease: f64,
    smoothed: f64,
    chain: Vec<u32>,
    alive: bool,
}

/// A chart of the map.
struct Chart {
    arcs: Vec<usize>,
    faces: Vec<u32>,
    area: f64,
    normal: DVec3,
    moment: DVec3,
    /// Length of the creases inside.
    crease: f64,
    version: u32,
}

/// Corners, arcs and charts under merging.
///
/// A merge across the arc e of A and B with the ends p, q is admissible iff A and B have no other common corner, at least three
/// arcs remain, and every third chart at an end of valence three, which vanishes, keeps at least three corners. Valences never
/// grow and arcs never shrink, so a valid map stays valid.
pub(super) struct Map<'a> {
    shape: &'a Shape<'a>,
    flatten: &'a dyn Flatten,
    corners: Vec<Vec<usize>>,
    arcs: Vec<Arc>,
    charts: Vec<Option<Chart>>,
    count: usize,
}

impl<'a> Map<'a> {
    pub(super) fn new(shape: &'a Shape<'a>, flatten: &'a dyn Flatten, segmentation: &Segmentation) -> Self {
        let topology = shape.topology;
        let arcs: Vec<Arc> = segmentation
            .arcs
            .iter()
            .map(|arc| {
                let (mut length, mut crease) = (0.0, 0.0);
                for pair in arc.vertices.windows(2) {
                    if let Some(h) = topology.half_edge(pair[0], pair[1]) {
                        length += shape.lengths[h as usize];
                        crease += shape.lengths[h as usize] * shape.creases[h as usize];
                    }
                }
                Arc {
                    ends: arc.corners,
                    sides: [arc.left as usize, arc.right as usize],
                    length,
                    crease,
                    smoothed: smoothed(shape, &arc.vertices),
                    chain: arc.vertices.clone(),
                    alive: true,
                }
            })
            .collect();
        let corners =
            segmentation.corners.iter().map(|c| c.arcs.iter().map(|end| end.arc).collect()).collect();
        let charts = segmentation
            .charts
            .iter()
            .map(|chart| {
                let border: Vec<usize> = chart.arcs.iter().map(|end| end.arc).collect();
                let mut new = Chart {
                    arcs: border,
                    faces: chart.faces.clone(),
                    area: 0.0,
                    normal: DVec3::ZERO,
                    moment: DVec3::ZERO,
                    crease: 0.0,
                    version: 0,
                };
                for &f in &chart.faces {
                    let f = f as usize;
                    new.area += shape.areas[f];
                    new.normal += shape.areas[f] * shape.normals[f];
                    new.moment += shape.areas[f] * shape.centroids[f];
                    new.crease +=
                        shape.crease_inside(f, |g| segmentation.labels[g] == segmentation.labels[f]);
                }
                Some(new)
            })
            .collect::<Vec<_>>();
        let count = charts.len();
        Self { shape, flatten, corners, arcs, charts, count }
    }

    /// The chart of every face.
    pub(super) fn labels(&self) -> Vec<u32> {
        let mut labels = vec![0; self.shape.areas.len()];
        for (r, chart) in self.charts.iter().enumerate() {
            for &f in chart.iter().flat_map(|c| &c.faces) {
                labels[f as usize] = r as u32;
            }
        }
        labels
    }

    /// Merges the cheapest admissible pairs until none is left or only `enough` charts are.
    pub(super) fn greedy(&mut self, rules: Rules, enough: usize) {
        let mut queue = BinaryHeap::new();
        for arc in 0..self.arcs.len() {
            self.push(&mut queue, arc);
        }
        while self.count > enough {
            let Some(Reverse((_, arc, versions))) = queue.pop() else { return };
            if self.versions(arc) != Some(versions) || !self.admits(arc, rules) {
                continue;
            }
            let kept = self.merge(arc);
            let border = self.charts[kept].as_ref().map(|c| c.arcs.clone()).unwrap_or_default();
            for arc in border {
                self.push(&mut queue, arc);
            }
        }
    }

    /// Merges at the ends of arcs that admit less than `least` width, which lengthens or removes them.
    pub(super) fn lengthen(&mut self, least: f64) {
        let mut blocked = vec![false; self.arcs.len()];
        loop {
            let shortest = (0..self.arcs.len())
                .filter(|&a| self.arcs[a].alive && !blocked[a])
                .map(|a| (self.width(a), a))
                .filter(|&(w, _)| w < least)
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let Some((_, arc)) = shortest else { return };
            let ends = self.arcs[arc].ends;
            if self.merge_at(&ends) {
                blocked.fill(false);
            } else {
                blocked[arc] = true;
            }
        }
    }

    /// Merges at corners where more than `most` charts meet.
    pub(super) fn lower_valence(&mut self, most: usize) {
        for corner in 0..self.corners.len() {
            while self.corners[corner].len() > most && self.merge_at(&[corner]) {}
        }
    }

    /// Merges once across an arc that ends at one of the corners; whether that was possible.
    fn merge_at(&mut self, corners: &[usize]) -> bool {
        let mut arcs: Vec<usize> = corners.iter().flat_map(|&c| &self.corners[c]).copied().collect();
        arcs.sort_unstable();
        arcs.dedup();
        let mut ordered: Vec<(i64, usize)> =
            arcs.into_iter().filter_map(|a| self.priority(a).map(|p| (p, a))).collect();
        ordered.sort_unstable();
        for rules in Rules::LADDER {
            for &(_, arc) in &ordered {
                if self.admits(arc, rules) {
                    self.merge(arc);
                    return true;
                }
            }
        }
        false
    }

    /// Width that an arc admits, in what may be wanted of it.
    fn width(&self, arc: usize) -> f64 {
        let arc = &self.arcs[arc];
        let (Some(&first), Some(&last)) = (arc.chain.first(), arc.chain.last()) else { return 0.0 };
        width(arc.smoothed, arc.ends.map(|c| self.corners[c].len())) / self.shape.modesty([first, last])
    }

    fn pair(&self, arc: usize) -> Option<(&Chart, &Chart)> {
        let arc = &self.arcs[arc];
        if !arc.alive {
            return None;
        }
        Some((self.charts[arc.sides[0]].as_ref()?, self.charts[arc.sides[1]].as_ref()?))
    }

    /// Smoothed, because the zigzag of mesh edges would count up to 1.4 times the length.
    fn perimeter(&self, chart: &Chart) -> f64 {
        chart.arcs.iter().map(|&a| self.arcs[a].smoothed).sum()
    }

    fn versions(&self, arc: usize) -> Option<[u32; 2]> {
        self.pair(arc).map(|(a, b)| [a.version, b.version])
    }

    fn push(&self, queue: &mut BinaryHeap<Reverse<(i64, usize, [u32; 2])>>, arc: usize) {
        if let (Some(priority), Some(versions)) = (self.priority(arc), self.versions(arc)) {
            queue.push(Reverse((priority, arc, versions)));
        }
    }

    /// Cost of a merge, rounded so that equal shapes are a tie.
    fn priority(&self, arc: usize) -> Option<i64> {
        let (a, b) = self.pair(arc)?;
        let arc = &self.arcs[arc];
        let spread = a.normal.length() + b.normal.length() - (a.normal + b.normal).length();
        let harmonic = a.area * b.area / (a.area + b.area);
        let perimeter = self.perimeter(a) + self.perimeter(b) - 2.0 * arc.smoothed;
        let compact = perimeter * perimeter / (4.0 * std::f64::consts::PI * (a.area + b.area));
        let apart = (a.moment / a.area).distance_squared(b.moment / b.area);
        let crease = if arc.length > 0.0 { arc.crease / arc.length } else { 0.0 };
        let cost = spread + harmonic * (0.04 * compact + apart + 0.5 * crease);
        Some((cost * 2f64.powi(40)).round() as i64)
    }

    fn admits(&self, arc: usize, rules: Rules) -> bool {
        self.keeps_map(arc) && self.keeps_shape(arc, rules)
    }

    fn keeps_map(&self, arc: usize) -> bool {
        let Some((a, b)) = self.pair(arc) else { return false };
        let (ends, sides) = (self.arcs[arc].ends, self.arcs[arc].sides);
        let corners = |chart: &Chart| {
            let mut corners: Vec<usize> = chart.arcs.iter().flat_map(|&x| self.arcs[x].ends).collect();
            corners.sort_unstable();
            corners.dedup();
            corners
        };
        let of_b = corners(b);
        let common = corners(a).into_iter().filter(|c| of_b.binary_search(c).is_ok()).count();
        if common != 2 {
            return false;
        }
        let vanishing: Vec<usize> = ends.into_iter().filter(|&c| self.corners[c].len() == 3).collect();
        if a.arcs.len() + b.arcs.len() < 5 + vanishing.len() {
            return false;
        }
        let third: Vec<usize> = vanishing
            .iter()
            .flat_map(|&c| &self.corners[c])
            .flat_map(|&x| self.arcs[x].sides)
            .filter(|r| !sides.contains(r))
            .collect();
        // Around a vanishing corner the third chart lies beside two arcs.
        third.iter().all(|&r| {
            let lost = third.iter().filter(|&&s| s == r).count() / 2;
            self.charts[r].as_ref().is_some_and(|c| c.arcs.len() >= 3 + lost)
        })
    }

    fn keeps_shape(&self, arc: usize, rules: Rules) -> bool {
        let Some((a, b)) = self.pair(arc) else { return false };
        let arc = &self.arcs[arc];
        let area = a.area + b.area;
        let cone = 1.0 - (a.normal + b.normal).length() / area;
        let perimeter = self.perimeter(a) + self.perimeter(b) - 2.0 * arc.smoothed;
        let compact = perimeter * perimeter / (4.0 * std::f64::consts::PI * area);
        let round = rules.round.unwrap_or(f64::max(2.6, 6.0 * (1.0 - cone / 0.2)));
        if cone > rules.cone || arc.crease > rules.crease * arc.length || compact > round {
            return false;
        }
        if cone <= rules.test_above && a.crease + b.crease + arc.crease <= NOTCH * area.sqrt() {
            return true;
        }
        let mut faces = [a.faces.as_slice(), &b.faces].concat();
        faces.sort_unstable();
        self.flatten
            .distortion(self.shape.mesh, self.shape.topology, &faces)
            .is_some_and(|ratio| ratio <= rules.distortion)
    }

    /// Merges the two charts of an arc; the union keeps the number of the lower one.
    fn merge(&mut self, arc: usize) -> usize {
        let sides = self.arcs[arc].sides;
        let (kept, gone) = (sides[0].min(sides[1]), sides[0].max(sides[1]));
        let (ends, crease) = (self.arcs[arc].ends, self.arcs[arc].crease);
        let Some(other) = self.charts[gone].take() else { return kept };
        for &x in &other.arcs {
            for side in &mut self.arcs[x].sides {
                if *side == gone {
                    *side = kept;
                }
            }
        }
        if let Some(chart) = self.charts[kept].as_mut() {
            chart.area += other.area;
            chart.normal += other.normal;
            chart.moment += other.moment;
            chart.crease += other.crease + crease;
            chart.version += 1;
            chart.faces.extend(other.faces);
            chart.arcs.extend(other.arcs);
            chart.arcs.retain(|&x| x != arc);
        }
        self.arcs[arc].alive = false;
        self.count -= 1;
        for corner in ends {
            self.corners[corner].retain(|&x| x != arc);
            if let [x, y] = self.corners[corner][..] {
                self.fuse(corner, x, y);
            }
        }
        kept
    }

    /// Joins the arcs `x` and `y` at a corner that vanishes; `x` stays.
    fn fuse(&mut self, corner: usize, x: usize, y: usize) {
        self.corners[corner].clear();
        if self.arcs[x].ends[1] != corner {
            self.reverse(x);
        }
        if self.arcs[y].ends[0] != corner {
            self.reverse(y);
        }
        let tail = std::mem::take(&mut self.arcs[y].chain);
        self.arcs[y].alive = false;
        let (end, length, crease, sides) =
            (self.arcs[y].ends[1], self.arcs[y].length, self.arcs[y].crease, self.arcs[y].sides);
        let arc = &mut self.arcs[x];
        arc.chain.extend(tail.into_iter().skip(1));
        arc.ends[1] = end;
        arc.length += length;
        arc.crease += crease;
        self.arcs[x].smoothed = smoothed(self.shape, &self.arcs[x].chain);
        for entry in &mut self.corners[end] {
            if *entry == y {
                *entry = x;
            }
        }
        for side in sides {
            if let Some(chart) = self.charts[side].as_mut() {
                chart.arcs.retain(|&a| a != y);
            }
        }
    }

    fn reverse(&mut self, arc: usize) {
        let arc = &mut self.arcs[arc];
        arc.ends.swap(0, 1);
        arc.sides.swap(0, 1);
        arc.chain.reverse();
    }
}

/// Length of a chain of vertices without its zigzag.
pub(super) fn smoothed(shape: &Shape, chain: &[u32]) -> f64 {
    let mut points: Vec<DVec3> = chain.iter().map(|&v| shape.positions[v as usize]).collect();
    smoothed_length(&mut points)
}
