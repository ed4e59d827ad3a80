//! Segmentation by paths through way points: the interactive tool of the paper.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use suture_mesh::{Topology, TriMesh};

use crate::labels::excerpt;
use crate::segmentation::check_mesh;
use crate::{Limits, Segment, SegmentError, Segmentation};

/// Segmentation by paths on the mesh edges, each through a list of vertices.
///
/// Consecutive way points are joined by the path of least cost Σ |e| · max(0.05, 1 − |θ|/π)^q over its edges, θ the angle between
/// the normals of the two faces. Paths are laid in the given order and do not cross: a leg passes through no vertex of an earlier
/// path or leg, but may begin and end on one, which makes a corner there (a T-junction). The regions between the paths become the
/// charts, numbered by their first face.
///
/// # References
/// Wagner, Hormann, Greiner, "C²-continuous surface reconstruction with piecewise polynomial patches", 2003, equation (1). Printed
/// there is the angle between the triangles, which prefers creases only if it is the wedge angle π − |θ|; the floor 0.05 keeps
/// folds from being free. The linear program of the paper is a shortest path, found by Dijkstra's algorithm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waypoints {
    /// The way points of every path: vertex indices, at least two per path.
    pub paths: Vec<Vec<u32>>,
    /// How paths are weighed.
    pub options: WaypointOptions,
}

/// How paths between way points are weighed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaypointOptions {
    /// The exponent q. The default 1 is the paper's; 3 holds paths to creases more strongly (a right-angled crease then costs an
    /// eighth of a flat edge instead of a half), 0 makes paths as short as possible.
    pub exponent: f64,
    /// What the partition is allowed to be.
    pub limits: Limits,
}

impl Default for WaypointOptions {
    fn default() -> Self {
        Self { exponent: 1.0, limits: Limits::default() }
    }
}

impl Segment for Waypoints {
    /// # Errors
    /// Those of [`Segmentation::from_labels_with`], and [`PathVertex`](SegmentError::PathVertex),
    /// [`PathTooShort`](SegmentError::PathTooShort), [`PathBlocked`](SegmentError::PathBlocked),
    /// [`DanglingPath`](SegmentError::DanglingPath), [`PathInsideChart`](SegmentError::PathInsideChart).
    fn segment(&self, mesh: &TriMesh, topology: &Topology) -> Result<Segmentation, SegmentError> {
        check_mesh(mesh, topology)?;
        let mut network = Network::new(mesh, topology, self.options.exponent)?;
        for (path, points) in self.paths.iter().enumerate() {
            network.lay(path, points)?;
        }
        let labels = network.regions()?;
        Segmentation::from_labels_with(mesh, topology, &labels, self.options.limits)
    }

    fn names_the_mesh(&self) -> bool {
        true
    }
}

/// Reads paths: one per line, vertex numbers from 0 separated by blanks or commas; `#` begins a comment, empty lines are skipped.
///
/// # Errors
/// [`SegmentError::Path`] with the line and the word.
pub fn read_paths(text: &str) -> Result<Vec<Vec<u32>>, SegmentError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut paths = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("");
        let path = line
            .split(|c: char| c.is_whitespace() || c == ',')
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().map_err(|_| SegmentError::Path { line: i + 1, text: excerpt(word) }))
            .collect::<Result<Vec<u32>, _>>()?;
        if !path.is_empty() {
            paths.push(path);
        }
    }
    Ok(paths)
}

/// The paths laid so far.
struct Network<'a> {
    topology: &'a Topology,
    /// Cost of every half-edge, an integer so that equal paths cost the same in any order of summation.
    cost: Vec<u64>,
    /// Whether a path runs through the vertex.
    taken: Vec<bool>,
    /// Whether a path runs along the half-edge, in either direction.
    barrier: Vec<bool>,
}

impl<'a> Network<'a> {
    fn new(mesh: &TriMesh, topology: &'a Topology, exponent: f64) -> Result<Self, SegmentError> {
        let diagonal = mesh.diagonal();
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return Err(SegmentError::NotFinite { diagonal });
        }
        let normals: Vec<_> =
            (0..mesh.faces.len()).map(|f| mesh.area_vector(f).normalize_or_zero()).collect();
        let cost = (0..topology.half_edge_count() as u32)
            .map(|h| {
                // Both directions are summed alike: the lower half-edge decides.
                let o = topology.opposite(h).unwrap_or(h);
                let (a, b) = (h.min(o), h.max(o));
                let [n, m] = [a, b].map(|h| normals[h as usize / 3]);
                let theta = n.cross(m).length().atan2(n.dot(m));
                let [p, q] =
                    [topology.tail(a), topology.head(a)].map(|v| mesh.positions[v as usize] / diagonal);
                let weight = (1.0 - theta / std::f64::consts::PI).max(0.05).powf(exponent);
                ((p.distance(q) * weight * 2f64.powi(40)).round() as u64).clamp(1, 1 << 44)
            })
            .collect();
        let taken = vec![false; topology.vertex_count()];
        let barrier = vec![false; topology.half_edge_count()];
        Ok(Self { topology, cost, taken, barrier })
    }

    /// Lays one path, leg by leg.
    fn lay(&mut self, path: usize, points: &[u32]) -> Result<(), SegmentError> {
        let vertices = self.topology.vertex_count();
        for &vertex in points {
            if vertex as usize >= vertices || self.topology.outgoing(vertex).next().is_none() {
                return Err(SegmentError::PathVertex { path, vertex, vertices });
            }
        }
        if points.len() < 2 {
            return Err(SegmentError::PathTooShort { path, vertex: None });
        }
        for leg in points.windows(2) {
            let (from, to) = (leg[0], leg[1]);
            if from == to {
                return Err(SegmentError::PathTooShort { path, vertex: Some(from) });
            }
            let chain = self
                .shortest(from, to, |v| points.contains(&v))
                .ok_or(SegmentError::PathBlocked { path, from, to })?;
            for &h in &chain {
                self.barrier[h as usize] = true;
                if let Some(o) = self.topology.opposite(h) {
                    self.barrier[o as usize] = true;
                }
                self.taken[self.topology.tail(h) as usize] = true;
                self.taken[self.topology.head(h) as usize] = true;
            }
        }
        Ok(())
    }

    /// The cheapest chain of half-edges through free vertices; ties by the number of edges, then by the lower vertex.
    fn shortest(&self, from: u32, to: u32, is_waypoint: impl Fn(u32) -> bool) -> Option<Vec<u32>> {
        const FAR: (u64, u32, u32) = (u64::MAX, u32::MAX, u32::MAX);
        // Cost, hops and predecessor; with the half-edge that arrives.
        let mut best = vec![FAR; self.topology.vertex_count()];
        let mut via = vec![u32::MAX; self.topology.vertex_count()];
        let mut queue = BinaryHeap::new();
        best[from as usize] = (0, 0, from);
        queue.push(Reverse((0u64, 0u32, from)));
        while let Some(Reverse((cost, hops, v))) = queue.pop() {
            if v == to {
                break;
            }
            if (cost, hops) != (best[v as usize].0, best[v as usize].1) {
                continue;
            }
            for h in self.topology.outgoing(v) {
                let w = self.topology.head(h);
                let inner = w != to;
                if self.barrier[h as usize] || (inner && (self.taken[w as usize] || is_waypoint(w))) {
                    continue;
                }
                let next = (cost.saturating_add(self.cost[h as usize]), hops + 1, v);
                let old = best[w as usize];
                if next < old {
                    best[w as usize] = next;
                    via[w as usize] = h;
                    if (next.0, next.1) != (old.0, old.1) {
                        queue.push(Reverse((next.0, next.1, w)));
                    }
                }
            }
        }
        let mut chain = Vec::new();
        let mut at = to;
        while at != from {
            let h = via[at as usize];
            if h == u32::MAX {
                return None;
            }
            chain.push(h);
            at = self.topology.tail(h);
        }
        chain.reverse();
        Some(chain)
    }

    /// Fills the regions between the paths.
    fn regions(&self) -> Result<Vec<u32>, SegmentError> {
        let topology = self.topology;
        for vertex in 0..topology.vertex_count() as u32 {
            if topology.outgoing(vertex).filter(|&h| self.barrier[h as usize]).count() == 1 {
                return Err(SegmentError::DanglingPath { vertex });
            }
        }
        let mut labels = vec![u32::MAX; topology.face_count()];
        let mut charts = 0;
        let mut stack = Vec::new();
        for start in 0..labels.len() as u32 {
            if labels[start as usize] != u32::MAX {
                continue;
            }
            labels[start as usize] = charts;
            stack.push(start);
            while let Some(f) = stack.pop() {
                for h in (3 * f..3 * f + 3).filter(|&h| !self.barrier[h as usize]) {
                    if let Some(g) = topology.opposite(h).map(|o| o / 3)
                        && labels[g as usize] == u32::MAX
                    {
                        labels[g as usize] = charts;
                        stack.push(g);
                    }
                }
            }
            charts += 1;
        }
        for h in (0..topology.half_edge_count() as u32).filter(|&h| self.barrier[h as usize]) {
            let face = topology.face(h);
            if topology.opposite(h).is_some_and(|o| labels[o as usize / 3] == labels[face as usize]) {
                return Err(SegmentError::PathInsideChart {
                    edge: [topology.tail(h), topology.head(h)],
                    face,
                });
            }
        }
        Ok(labels)
    }
}
