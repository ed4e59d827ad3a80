//! The partition of a closed mesh into disc charts, and the invariants it keeps.

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

use crate::SegmentError;
use crate::census::{Census, census, is_border, next_border, pieces};

/// A partition of a closed mesh into discs.
///
/// Every chart is a disc without pinch, has at least three corners and so never borders itself; every arc joins two different
/// corners; every corner has between three and [`Limits::max_valence`] segments. For a connected mesh of genus g,
/// corners − arcs + charts = 2 − 2g.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segmentation {
    /// The chart of every face, `0..charts.len()`, numbered in ascending order of the labels given.
    pub labels: Vec<u32>,
    /// Border and faces of every chart.
    pub charts: Vec<ChartBoundary>,
    /// The corners, by ascending vertex.
    pub corners: Vec<Corner>,
    /// The arcs, each once.
    pub arcs: Vec<Arc>,
}

/// A mesh vertex where three or more charts meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Corner {
    /// The mesh vertex.
    pub vertex: u32,
    /// The arcs that leave the corner, counter-clockwise seen from outside. Their number is the valence; segment `i` lies between
    /// `arcs[i]` and `arcs[i + 1]`, to the left of `arcs[i]`.
    pub arcs: Vec<ArcEnd>,
}

/// An arc with a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ArcEnd {
    /// Index into [`Segmentation::arcs`].
    pub arc: usize,
    /// Whether it is walked as it is stored: at a [`Corner`], whether the arc starts there.
    pub forward: bool,
}

/// A maximal chain of border edges between two corners.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arc {
    /// Start and end, indices into [`Segmentation::corners`].
    pub corners: [usize; 2],
    /// The chain of mesh vertices, both corners included.
    pub vertices: Vec<u32>,
    /// The chart on the left of the walk.
    pub left: u32,
    /// The chart on the right of the walk.
    pub right: u32,
}

/// The border loop and the faces of one chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChartBoundary {
    /// The loop counter-clockwise seen from outside, with the chart on its left.
    pub arcs: Vec<ArcEnd>,
    /// The faces, ascending.
    pub faces: Vec<u32>,
}

/// What a partition is allowed to be beyond the invariants that all stages need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of segments around a corner. The default 8 is what blends have tables for; blends with coefficients in
    /// [0, 1] exist up to 6 (Wagner, Hormann, Greiner 2003, appendix A).
    pub max_valence: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_valence: 8 }
    }
}

impl Segmentation {
    /// Reads the partition off one label per face (`u32`, `i32`, `i64`, …, negative ones included) with the default [`Limits`].
    ///
    /// # Errors
    /// See [`from_labels_with`](Self::from_labels_with).
    pub fn from_labels<L: Copy + Into<i64>>(
        mesh: &TriMesh,
        topology: &Topology,
        labels: &[L],
    ) -> Result<Self, SegmentError> {
        Self::from_labels_with(mesh, topology, labels, Limits::default())
    }

    /// Reads the partition off one label per face, in O(faces).
    ///
    /// # Errors
    /// In this order: [`MeshMismatch`](SegmentError::MeshMismatch), [`LabelCount`](SegmentError::LabelCount),
    /// [`Open`](SegmentError::Open), [`Disconnected`](SegmentError::Disconnected); then for the charts by ascending label
    /// [`Pinch`](SegmentError::Pinch), [`ChartNotDisc`](SegmentError::ChartNotDisc),
    /// [`ClosedCurveWithoutCorner`](SegmentError::ClosedCurveWithoutCorner), [`ChartCorners`](SegmentError::ChartCorners); then
    /// [`CornerValence`](SegmentError::CornerValence).
    pub fn from_labels_with<L: Copy + Into<i64>>(
        mesh: &TriMesh,
        topology: &Topology,
        labels: &[L],
        limits: Limits,
    ) -> Result<Self, SegmentError> {
        check_mesh(mesh, topology)?;
        if labels.len() != mesh.faces.len() {
            return Err(SegmentError::LabelCount { labels: labels.len(), faces: mesh.faces.len() });
        }
        let given: Vec<i64> = labels.iter().map(|&l| l.into()).collect();
        let mut names = given.clone();
        names.sort_unstable();
        names.dedup();
        let compact: Vec<u32> = given.iter().map(|l| names.partition_point(|n| n < l) as u32).collect();
        let census = census(topology, &compact, names.len());
        check_census(topology, &compact, &names, &census, limits)?;
        Ok(trace(topology, compact, &census))
    }

    /// The corners of a chart in the order of its loop: the starts of its arcs.
    ///
    /// # Panics
    /// When the chart does not exist.
    pub fn chart_corners(&self, chart: usize) -> Vec<usize> {
        self.charts[chart].arcs.iter().map(|&end| self.start(end)).collect()
    }

    /// The corner where a directed arc starts.
    ///
    /// # Panics
    /// When the arc does not exist.
    pub fn start(&self, end: ArcEnd) -> usize {
        self.arcs[end.arc].corners[usize::from(!end.forward)]
    }

    /// The segments around a corner, counter-clockwise: entry `i` lies to the left of arc `i`.
    ///
    /// # Panics
    /// When the corner does not exist.
    pub fn segments(&self, corner: usize) -> Vec<u32> {
        let side = |end: &ArcEnd| {
            let arc = &self.arcs[end.arc];
            if end.forward { arc.left } else { arc.right }
        };
        self.corners[corner].arcs.iter().map(side).collect()
    }

    /// The strip width that every arc admits, relative to the diagonal of the mesh's bounding box:
    /// length / (c(N₀) + c(N₁) + 1) with the [`reach`] c of the two corners. The length is that of the chain after six half
    /// Laplacian steps, because the chain of mesh edges is a zigzag. The smallest of them bounds the width of the whole model.
    ///
    /// # Panics
    /// When `mesh` is not the mesh of this segmentation.
    pub fn arc_widths(&self, mesh: &TriMesh) -> Vec<f64> {
        let diagonal = mesh.diagonal();
        let mut chain = Vec::new();
        self.arcs
            .iter()
            .map(|arc| {
                chain.clear();
                chain.extend(arc.vertices.iter().map(|&v| mesh.positions[v as usize]));
                let valence = arc.corners.map(|c| self.corners[c].arcs.len());
                width(smoothed_length(&mut chain), valence) / diagonal
            })
            .collect()
    }
}

/// Distance from a corner of `valence` segments with equal angles to the connection points of its strips, in units of the strip
/// width at d_in : d_out = 2 : 1: c(N) = 23/12 · cot(π/N), i.e. 1.107, 1.917, 2.637, 3.320 for N = 3 … 6.
///
/// # References
/// Wagner, Hormann, Greiner, "C²-continuous surface reconstruction with piecewise polynomial patches", 2003, section 6.3.
pub fn reach(valence: usize) -> f64 {
    23.0 / 12.0 / (std::f64::consts::PI / valence.max(3) as f64).tan()
}

/// Width that an arc of this smoothed length admits between corners of these valences.
pub(crate) fn width(length: f64, valence: [usize; 2]) -> f64 {
    length / (reach(valence[0]) + reach(valence[1]) + 1.0)
}

/// Length of a chain after six half Laplacian steps with fixed ends; the chain is overwritten.
pub(crate) fn smoothed_length(chain: &mut [DVec3]) -> f64 {
    for _ in 0..6 {
        let Some(&(mut before)) = chain.first() else { return 0.0 };
        for i in 1..chain.len().saturating_sub(1) {
            let here = chain[i];
            chain[i] = 0.5 * here + 0.25 * (before + chain[i + 1]);
            before = here;
        }
    }
    chain.windows(2).map(|p| p[0].distance(p[1])).sum()
}

/// Checks that the mesh is the one of the adjacency, closed and connected.
pub(crate) fn check_mesh(mesh: &TriMesh, topology: &Topology) -> Result<(), SegmentError> {
    let (faces, adjacent) = (mesh.faces.len(), topology.face_count());
    let same = |f: usize| (0..3).all(|k| topology.tail((3 * f + k) as u32) == mesh.faces[f][k]);
    if faces != adjacent || mesh.positions.len() != topology.vertex_count() || !(0..faces).all(same) {
        return Err(SegmentError::MeshMismatch { faces, adjacent });
    }
    for h in 0..topology.half_edge_count() as u32 {
        if topology.opposite(h).is_none() {
            let edge = [topology.tail(h), topology.head(h)];
            return Err(SegmentError::Open { edge, face: topology.face(h) });
        }
    }
    let mut seen = vec![false; faces];
    let mut stack = Vec::new();
    let (mut components, mut face) = (0, 0);
    for start in 0..faces as u32 {
        if seen[start as usize] {
            continue;
        }
        components += 1;
        if components == 2 {
            face = start;
        }
        seen[start as usize] = true;
        stack.push(start);
        while let Some(f) = stack.pop() {
            for g in (3 * f..3 * f + 3).filter_map(|h| topology.opposite(h)).map(|o| o / 3) {
                if !std::mem::replace(&mut seen[g as usize], true) {
                    stack.push(g);
                }
            }
        }
    }
    if components > 1 { Err(SegmentError::Disconnected { components, face }) } else { Ok(()) }
}

fn check_census(
    topology: &Topology,
    labels: &[u32],
    names: &[i64],
    census: &Census,
    limits: Limits,
) -> Result<(), SegmentError> {
    for (r, count) in census.charts.iter().enumerate() {
        let chart = names[r];
        let face = || labels.iter().position(|&l| l as usize == r).unwrap_or(0) as u32;
        if let Some(vertex) = count.pinch {
            return Err(SegmentError::Pinch { chart, vertex });
        }
        if count.loops != 1 || count.euler != 1 {
            let components = pieces(topology, labels, r as u32);
            let (loops, euler) = (count.loops, count.euler);
            return Err(SegmentError::ChartNotDisc { chart, face: face(), components, loops, euler });
        }
        if let Some(h) = count.smooth_loop {
            let across = topology.opposite(h).map_or(r, |o| labels[o as usize / 3] as usize);
            return Err(SegmentError::ClosedCurveWithoutCorner {
                vertex: topology.tail(h),
                charts: [chart, names[across]],
            });
        }
        if count.corners < 3 {
            return Err(SegmentError::ChartCorners { chart, face: face(), corners: count.corners });
        }
    }
    let limit = limits.max_valence;
    match census.sectors.iter().position(|&n| n as usize > limit) {
        Some(vertex) => {
            let valence = census.sectors[vertex] as usize;
            Err(SegmentError::CornerValence { vertex: vertex as u32, valence, limit })
        }
        None => Ok(()),
    }
}

/// Traces corners, arcs and loops of a labelling that passed the checks.
fn trace(topology: &Topology, labels: Vec<u32>, census: &Census) -> Segmentation {
    const NONE: usize = usize::MAX;
    let mut corner_at = vec![NONE; topology.vertex_count()];
    let mut corners = Vec::new();
    for (v, &n) in census.sectors.iter().enumerate() {
        if n >= 3 {
            corner_at[v] = corners.len();
            corners.push(Corner { vertex: v as u32, arcs: Vec::with_capacity(n as usize) });
        }
    }
    // The arc that starts or ends with the half-edge leaving a corner.
    let mut leaving: Vec<Option<ArcEnd>> = vec![None; topology.half_edge_count()];
    let mut arcs: Vec<Arc> = Vec::new();
    for c in 0..corners.len() {
        for h in topology.outgoing(corners[c].vertex).filter(|&h| is_border(topology, &labels, h)) {
            let end = leaving[h as usize].unwrap_or_else(|| {
                let arc = arcs.len();
                let mut vertices = vec![corners[c].vertex, topology.head(h)];
                let mut last = h;
                while corner_at[topology.head(last) as usize] == NONE {
                    last = next_border(topology, &labels, last);
                    vertices.push(topology.head(last));
                }
                let back = topology.opposite(last).unwrap_or(last);
                leaving[back as usize] = Some(ArcEnd { arc, forward: false });
                let right = topology.opposite(h).unwrap_or(h);
                arcs.push(Arc {
                    corners: [c, corner_at[topology.head(last) as usize]],
                    vertices,
                    left: labels[h as usize / 3],
                    right: labels[right as usize / 3],
                });
                ArcEnd { arc, forward: true }
            });
            corners[c].arcs.push(end);
        }
    }
    let mut charts: Vec<ChartBoundary> = census
        .charts
        .iter()
        .map(|count| ChartBoundary { arcs: Vec::new(), faces: Vec::with_capacity(count.faces) })
        .collect();
    for (f, &r) in labels.iter().enumerate() {
        charts[r as usize].faces.push(f as u32);
    }
    let mut segmentation = Segmentation { labels, charts, corners, arcs };
    for arc in 0..segmentation.arcs.len() {
        for (forward, chart) in
            [(true, segmentation.arcs[arc].left as usize), (false, segmentation.arcs[arc].right as usize)]
        {
            if segmentation.charts[chart].arcs.is_empty() {
                segmentation.charts[chart].arcs = walk(&segmentation, ArcEnd { arc, forward });
            }
        }
    }
    segmentation
}

/// The loop of the chart on the left of `first`.
fn walk(segmentation: &Segmentation, first: ArcEnd) -> Vec<ArcEnd> {
    let mut border = Vec::new();
    let mut at = first;
    loop {
        border.push(at);
        let back = ArcEnd { arc: at.arc, forward: !at.forward };
        let around = &segmentation.corners[segmentation.start(back)].arcs;
        let Some(i) = around.iter().position(|&end| end == back) else { return border };
        // The chart lies on the right of the way back, hence on the left of the arc before it.
        at = around[(i + around.len() - 1) % around.len()];
        if at == first {
            return border;
        }
    }
}
