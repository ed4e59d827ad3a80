//! Nodes of sides, and where they are refined.
//!
//! Sides that lie opposite each other or on each other have the same nodes. Every edge of a patch has two *halves*, each measured from its
//! end towards the middle: halves that must have the same nodes form a *class*. In an N-gon the first half of every edge, the line from
//! the middle of the edge before it to the centre, and the second half of the edge before that one lie opposite each other: a class runs
//! once around a segment, where three arcs meet at every corner, and is refined where errors are, an interval at a time.

use suture_surface::Domain;

use super::topology::{Topology, UnionFind};

/// The nodes of halves.
#[derive(Clone, Debug)]
pub(crate) struct Class {
    /// From 0 at the end to 1 at the middle.
    pub(crate) nodes: Vec<f64>,
}

/// A half of an edge as a side runs along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Half {
    pub(crate) class: usize,
    /// Whether the side runs from the middle to the end.
    pub(crate) reversed: bool,
}

/// The nodes along an edge of a patch, or along half of it, in the direction of a side.
#[derive(Clone, Debug)]
pub(crate) struct Ruler {
    /// One or two.
    pub(crate) halves: Vec<Half>,
    /// Whether the middle, where there is one, is a break.
    pub(crate) broken: bool,
}

/// An interval between nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) ends: [f64; 2],
    pub(crate) class: usize,
    /// Number of the interval in the class.
    pub(crate) number: usize,
}

/// How much longer an interval may be than the one beside it: splines swing where nodes are too uneven.
const UNEVEN: f64 = 2.5;

/// No class gets more nodes than this.
const MOST_NODES: usize = 160;

impl Class {
    fn new(intervals: usize) -> Self {
        Self { nodes: (0..=intervals).map(|i| i as f64 / intervals as f64).collect() }
    }

    /// Number of intervals.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len() - 1
    }

    pub(crate) fn length(&self, interval: usize) -> f64 {
        self.nodes[interval + 1] - self.nodes[interval]
    }

    /// Divides every interval into as many equal parts as `parts` has for it, and intervals that are much longer than a neighbour. Whether
    /// anything changed: nothing does when there would be too many.
    pub(crate) fn divide(&mut self, parts: &[usize]) -> bool {
        let mut nodes = vec![0.0];
        for i in 0..self.count() {
            let n = parts[i].max(1);
            nodes.extend((1..n).map(|k| self.nodes[i] + self.length(i) * (k as f64 / n as f64)));
            nodes.push(self.nodes[i + 1]);
        }
        if nodes.len() == self.nodes.len() || nodes.len() > MOST_NODES {
            return false;
        }
        self.nodes = nodes;
        let beside = |class: &Self, i: usize| {
            let left = i.checked_sub(1).map_or(f64::INFINITY, |j| class.length(j));
            left.min(if i + 1 < class.count() { class.length(i + 1) } else { f64::INFINITY })
        };
        while let Some(i) = (0..self.count()).find(|&i| self.length(i) > UNEVEN * beside(self, i)) {
            self.nodes.insert(i + 1, 0.5 * (self.nodes[i] + self.nodes[i + 1]));
        }
        true
    }
}

impl Ruler {
    /// The intervals over `span`, in rising order.
    pub(crate) fn intervals(&self, classes: &[Class], [from, to]: [f64; 2]) -> Vec<Interval> {
        let middle = from + (to - from) * 0.5;
        let ends = |k: usize| match (self.halves.len(), k) {
            (1, _) => [from, to],
            (_, 0) => [from, middle],
            _ => [middle, to],
        };
        let mut intervals = Vec::new();
        for (k, half) in self.halves.iter().enumerate() {
            let [low, high] = ends(k);
            let nodes = &classes[half.class].nodes;
            let last = nodes.len() - 1;
            // Ends to the bit.
            let at = |i: usize| match (half.reversed, i) {
                (false, 0) => low,
                (true, 0) => high,
                (false, i) if i == last => high,
                (true, i) if i == last => low,
                (false, i) => low + (high - low) * nodes[i],
                (true, i) => high - (high - low) * nodes[i],
            };
            let one = |number: usize| {
                let (a, b) = (at(number), at(number + 1));
                let ends = if half.reversed { [b, a] } else { [a, b] };
                Interval { ends, class: half.class, number }
            };
            if half.reversed {
                intervals.extend((0..last).rev().map(one));
            } else {
                intervals.extend((0..last).map(one));
            }
        }
        intervals
    }

    /// The nodes over `span`, break by break, appended.
    pub(crate) fn nodes(&self, classes: &[Class], span: [f64; 2], out: &mut Vec<Vec<f64>>) {
        let count = self.halves.first().map_or(0, |h| classes[h.class].count());
        let intervals = self.intervals(classes, span);
        for (i, interval) in intervals.iter().enumerate() {
            match out.last_mut() {
                Some(last) if i > 0 && !(self.broken && i == count) => last.push(interval.ends[1]),
                _ => out.push(interval.ends.to_vec()),
            }
        }
    }

    /// The first or the second half alone.
    pub(crate) fn half(&self, second: bool) -> Self {
        let half = if second { self.halves.last() } else { self.halves.first() };
        Self { halves: half.copied().into_iter().collect(), broken: self.broken }
    }
}

/// Which halves belong together.
pub(crate) struct Halves {
    /// Edges whose middles are vertices if one of them is.
    edges: UnionFind,
    broken: Vec<bool>,
    /// Class of the first and the second half of every edge.
    number: Vec<[usize; 2]>,
    /// Number of classes.
    count: usize,
}

impl Halves {
    pub(crate) fn new(topology: &Topology, face_of: &[Option<usize>]) -> Self {
        let count = topology.patch_of.len();
        let mut edges = UnionFind::new(count);
        let mut halves = UnionFind::new(2 * count);
        let block = |p: usize| face_of[p].is_none();
        for (p, domain) in topology.domains.iter().enumerate().filter(|(p, _)| block(*p)) {
            let first = topology.first[p];
            let n = domain.edge_count();
            for e in 0..n {
                match domain {
                    Domain::Rectangle { .. } if e < 2 => {
                        edges.join(first + e, first + e + 2);
                        (0..2).for_each(|h| halves.join(2 * (first + e) + h, 2 * (first + e + 2) + 1 - h));
                    }
                    Domain::Rectangle { .. } => {}
                    _ => halves.join(2 * (first + (e + 1) % n), 2 * (first + (e + n - 1) % n) + 1),
                }
                if let Some((q, f, same)) = topology.across(p, e)
                    && block(q)
                {
                    let other = topology.first[q] + f;
                    edges.join(first + e, other);
                    let turn = |h: usize| if same { h } else { 1 - h };
                    (0..2).for_each(|h| halves.join(2 * (first + e) + h, 2 * other + turn(h)));
                }
            }
        }
        let mut broken = vec![false; count];
        // Roots, numbered in their order.
        let mut of_root = vec![usize::MAX; 2 * count];
        let mut number = vec![[usize::MAX; 2]; count];
        let mut classes = 0;
        for e in (0..count).filter(|&e| block(topology.patch_of[e])) {
            if matches!(topology.domains[topology.patch_of[e]], Domain::Polygon(_)) {
                broken[edges.root(e)] = true;
            }
            for h in 0..2 {
                let root = halves.root(2 * e + h);
                if of_root[root] == usize::MAX {
                    of_root[root] = classes;
                    classes += 1;
                }
                number[e][h] = of_root[root];
            }
        }
        Self { edges, broken, number, count: classes }
    }

    /// Whether the middle of an edge is a vertex.
    pub(crate) fn broken(&self, edge: usize) -> bool {
        self.broken[self.edges.find(edge)]
    }

    /// Along a whole edge.
    pub(crate) fn ruler(&self, edge: usize) -> Ruler {
        let [first, second] = self.number[edge];
        let halves = vec![Half { class: first, reversed: false }, Half { class: second, reversed: true }];
        Ruler { halves, broken: self.broken(edge) }
    }

    /// Along a half from the end to the middle.
    pub(crate) fn half(&self, edge: usize, second: bool) -> Ruler {
        let class = self.number[edge][usize::from(second)];
        Ruler { halves: vec![Half { class, reversed: false }], broken: true }
    }

    /// All classes, with this many intervals.
    pub(crate) fn classes(&self, intervals: usize) -> Vec<Class> {
        vec![Class::new(intervals); self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_refined_where_asked_and_graded_around_it() {
        let mut class = Class::new(4);
        assert!(!class.divide(&[1; 4]));
        assert!(class.divide(&[4, 1, 1, 1]));
        assert_eq!(class.nodes[..5], [0.0, 0.0625, 0.125, 0.1875, 0.25]);
        for i in 1..class.count() {
            let ratio = class.length(i) / class.length(i - 1);
            assert!(ratio < UNEVEN && ratio > 1.0 / UNEVEN);
        }
    }

    #[test]
    fn both_halves_of_an_edge_meet_at_its_middle() {
        let mut classes = vec![Class::new(2), Class::new(3)];
        classes[1].divide(&[2, 1, 1]);
        let halves = vec![Half { class: 0, reversed: false }, Half { class: 1, reversed: true }];
        for broken in [false, true] {
            let ruler = Ruler { halves: halves.clone(), broken };
            let intervals = ruler.intervals(&classes, [0.1, 0.7]);
            assert_eq!(intervals.len(), 6);
            assert!(intervals.windows(2).all(|w| w[0].ends[1] == w[1].ends[0]));
            assert_eq!((intervals[0].ends[0], intervals[5].ends[1], intervals[5].number), (0.1, 0.7, 0));
            let mut nodes = Vec::new();
            ruler.nodes(&classes, [0.1, 0.7], &mut nodes);
            assert_eq!(nodes.len(), if broken { 2 } else { 1 });
            assert_eq!(nodes.iter().map(Vec::len).sum::<usize>(), if broken { 8 } else { 7 });
        }
        let half = Ruler { halves, broken: true }.half(true);
        assert_eq!(half.intervals(&classes, [0.4, 0.7])[0].ends[0], 0.4);
    }
}
