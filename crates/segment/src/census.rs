//! Counts that decide whether a labelling is a partition into discs with corners.

use suture_mesh::Topology;

/// What the invariants of a partition are read from, per vertex and per chart.
pub(crate) struct Census {
    /// Number of border half-edges that leave each vertex = number of sectors around it; 0 inside a chart.
    pub(crate) sectors: Vec<u32>,
    /// Counts of each chart.
    pub(crate) charts: Vec<ChartCount>,
}

/// Counts of one chart.
#[derive(Clone, Copy, Default)]
pub(crate) struct ChartCount {
    /// Number of faces.
    pub(crate) faces: usize,
    /// Vertices − edges + faces of the chart cut out of the mesh.
    pub(crate) euler: i64,
    /// Number of border loops.
    pub(crate) loops: usize,
    /// Number of corners on all loops.
    pub(crate) corners: usize,
    /// A vertex where two sectors of the chart meet.
    pub(crate) pinch: Option<u32>,
    /// A border half-edge of a loop without corner.
    pub(crate) smooth_loop: Option<u32>,
    /// The largest number of sectors at one of its corners.
    pub(crate) valence: usize,
}

impl ChartCount {
    /// Whether the chart is a pinch-free disc with at least three corners of at most `max_valence` sectors.
    pub(crate) fn is_valid(&self, max_valence: usize) -> bool {
        self.faces > 0
            && self.euler == 1
            && self.loops == 1
            && self.corners >= 3
            && self.pinch.is_none()
            && self.valence <= max_valence
    }
}

/// Counts everything in O(faces). `labels` are compact (`0..charts`) and the mesh is closed.
pub(crate) fn census(topology: &Topology, labels: &[u32], charts: usize) -> Census {
    let half_edges = topology.half_edge_count() as u32;
    let mut count = vec![ChartCount::default(); charts];
    let mut border = vec![0i64; charts];
    let mut sectors = vec![0u32; topology.vertex_count()];
    for &r in labels {
        count[r as usize].faces += 1;
    }
    for h in 0..half_edges {
        if is_border(topology, labels, h) {
            sectors[topology.tail(h) as usize] += 1;
            border[labels[h as usize / 3] as usize] += 1;
        }
    }
    // V_r: every chart counts a vertex once, however many of its sectors meet there.
    let mut around = Vec::new();
    for v in 0..topology.vertex_count() as u32 {
        around.clear();
        if sectors[v as usize] == 0 {
            around.extend(topology.outgoing(v).next().map(|h| labels[h as usize / 3]));
        } else {
            around.extend(
                topology
                    .outgoing(v)
                    .filter(|&h| is_border(topology, labels, h))
                    .map(|h| labels[h as usize / 3]),
            );
            around.sort_unstable();
            for pair in around.windows(2).filter(|p| p[0] == p[1]) {
                count[pair[0] as usize].pinch.get_or_insert(v);
            }
            around.dedup();
        }
        for &r in &around {
            count[r as usize].euler += 1;
        }
    }
    for (chart, border) in count.iter_mut().zip(&border) {
        let faces = chart.faces as i64;
        chart.euler += faces - (3 * faces + border) / 2;
    }
    let mut seen = vec![false; half_edges as usize];
    for start in 0..half_edges {
        if seen[start as usize] || !is_border(topology, labels, start) {
            continue;
        }
        let chart = &mut count[labels[start as usize / 3] as usize];
        chart.loops += 1;
        let before = chart.corners;
        let mut h = start;
        while !seen[h as usize] {
            seen[h as usize] = true;
            let around = sectors[topology.tail(h) as usize] as usize;
            if around >= 3 {
                chart.corners += 1;
                chart.valence = chart.valence.max(around);
            }
            h = next_border(topology, labels, h);
        }
        if chart.corners == before {
            chart.smooth_loop.get_or_insert(start);
        }
    }
    Census { sectors, charts: count }
}

/// Whether the faces left and right of `h` have different labels.
pub(crate) fn is_border(topology: &Topology, labels: &[u32], h: u32) -> bool {
    topology.opposite(h).is_none_or(|o| labels[o as usize / 3] != labels[h as usize / 3])
}

/// The border half-edge that follows the border half-edge `h` on the loop of the chart on its left.
pub(crate) fn next_border(topology: &Topology, labels: &[u32], h: u32) -> u32 {
    // Turning about the head ends at the latest at the edge of `h` itself, which is a border.
    let mut g = topology.next(h);
    while let Some(o) = topology.opposite(g).filter(|&o| labels[o as usize / 3] == labels[g as usize / 3]) {
        g = topology.next(o);
    }
    g
}

/// Number of edge-connected pieces of one chart.
pub(crate) fn pieces(topology: &Topology, labels: &[u32], chart: u32) -> usize {
    let mut seen = vec![false; labels.len()];
    let mut pieces = 0;
    let mut stack = Vec::new();
    for start in 0..labels.len() as u32 {
        if labels[start as usize] != chart || seen[start as usize] {
            continue;
        }
        pieces += 1;
        seen[start as usize] = true;
        stack.push(start);
        while let Some(f) = stack.pop() {
            for h in 3 * f..3 * f + 3 {
                if let Some(g) = topology.opposite(h).map(|o| o / 3)
                    && labels[g as usize] == chart
                    && !seen[g as usize]
                {
                    seen[g as usize] = true;
                    stack.push(g);
                }
            }
        }
    }
    pieces
}
