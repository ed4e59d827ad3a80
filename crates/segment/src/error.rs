//! Why a mesh has no segmentation of the asked kind.

/// Why a mesh has no segmentation of the asked kind. Charts are named by the label they had in the input, faces and vertices by
/// their index.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SegmentError {
    /// A line of a label file is not an integer in `0..2³²`.
    #[error("line {line}: `{text}` is not a label; write one integer from 0 to 4294967295 per face and line")]
    Label {
        /// The line, counted from 1.
        line: usize,
        /// What stands there, cut to 40 characters.
        text: String,
    },
    /// The number of labels is not the number of faces.
    #[error("{labels} labels for {faces} faces; give one label per face, in the order of the faces")]
    LabelCount {
        /// How many labels were given.
        labels: usize,
        /// How many faces the mesh has.
        faces: usize,
    },
    /// The adjacency was built from another mesh.
    #[error(
        "the adjacency ({adjacent} faces) is not that of the mesh ({faces} faces); build it from this mesh"
    )]
    MeshMismatch {
        /// Faces of the mesh.
        faces: usize,
        /// Faces of the adjacency.
        adjacent: usize,
    },
    /// The mesh has a border; only closed meshes can be segmented.
    #[error("the mesh is open: edge {} → {} of face {face} has no neighbour; close the hole", edge[0], edge[1])]
    Open {
        /// Tail and head of the first border edge.
        edge: [u32; 2],
        /// Its face.
        face: u32,
    },
    /// The mesh has several components.
    #[error(
        "the mesh has {components} components (face {face} is in the second one); segment each one separately"
    )]
    Disconnected {
        /// Number of components.
        components: usize,
        /// The first face outside the component of face 0.
        face: u32,
    },
    /// A coordinate is not finite, or all faces have no extent.
    #[error(
        "the vertices have no finite extent (diagonal {diagonal:e}); remove coordinates that are not finite"
    )]
    NotFinite {
        /// Length of the diagonal of the bounding box.
        diagonal: f64,
    },
    /// Two sectors of one chart meet in a vertex without sharing an edge there.
    #[error(
        "chart {chart} touches itself at vertex {vertex}; give the faces between the two sectors another label"
    )]
    Pinch {
        /// The chart.
        chart: i64,
        /// The vertex.
        vertex: u32,
    },
    /// A chart is not a disc.
    #[error(
        "chart {chart} (face {face}) is not a disc: {components} components, {loops} border loops, Euler number {euler} \
         (wanted 1, 1 and 1); cut it by further arcs"
    )]
    ChartNotDisc {
        /// The chart.
        chart: i64,
        /// Its first face.
        face: u32,
        /// Number of edge-connected pieces.
        components: usize,
        /// Number of border loops.
        loops: usize,
        /// Vertices − edges + faces.
        euler: i64,
    },
    /// A closed border curve meets no corner.
    #[error(
        "the closed curve through vertex {vertex} between charts {} and {} meets no corner; let further arcs end on it",
        charts[0], charts[1]
    )]
    ClosedCurveWithoutCorner {
        /// The first vertex of the curve.
        vertex: u32,
        /// The charts on its two sides.
        charts: [i64; 2],
    },
    /// A chart has too few corners.
    #[error(
        "chart {chart} (face {face}) has {corners} corners, at least 3 are needed; let further arcs end on its border"
    )]
    ChartCorners {
        /// The chart.
        chart: i64,
        /// Its first face.
        face: u32,
        /// How many corners it has.
        corners: usize,
    },
    /// Too many charts meet in one vertex.
    #[error(
        "{valence} charts meet at vertex {vertex}, at most {limit} can be blended; put a small chart around it"
    )]
    CornerValence {
        /// The vertex.
        vertex: u32,
        /// How many charts meet there.
        valence: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// A line of a path file is not a list of vertices.
    #[error(
        "line {line}: `{text}` is not a vertex; write one path per line, its vertex numbers separated by blanks"
    )]
    Path {
        /// The line, counted from 1.
        line: usize,
        /// What stands there, cut to 40 characters.
        text: String,
    },
    /// A path names a vertex that no face uses.
    #[error("path {path} names vertex {vertex}, but no face uses it (the mesh has {vertices} vertices)")]
    PathVertex {
        /// Index of the path.
        path: usize,
        /// The vertex.
        vertex: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A path has fewer than two different way points in a row.
    #[error("path {path} has no two different way points in a row at vertex {vertex:?}; give at least two")]
    PathTooShort {
        /// Index of the path.
        path: usize,
        /// The repeated vertex, if the path has one.
        vertex: Option<u32>,
    },
    /// Earlier paths separate two way points.
    #[error(
        "path {path}: no way from vertex {from} to vertex {to} without crossing or touching an earlier path; end it on the \
         earlier path, give way points around it, or refine the mesh there"
    )]
    PathBlocked {
        /// Index of the path.
        path: usize,
        /// The way point where the leg starts.
        from: u32,
        /// The way point where it should end.
        to: u32,
    },
    /// A path ends at a vertex that no other path reaches.
    #[error("a path ends at vertex {vertex}, where no other path passes; lead it on to one")]
    DanglingPath {
        /// The vertex.
        vertex: u32,
    },
    /// A path has one chart on both sides.
    #[error(
        "the path through the edge {} – {} has the same chart on both sides (face {face}); it does not cut it, add the paths \
         that close the border", edge[0], edge[1]
    )]
    PathInsideChart {
        /// The edge.
        edge: [u32; 2],
        /// A face of the chart.
        face: u32,
    },
    /// The over-segmentation found no valid start.
    #[error(
        "no valid partition after {rounds} rounds, {cells} cells ({invalid} invalid); subdivide the mesh once (1:4) and try again"
    )]
    NoValidStart {
        /// Rounds of repair.
        rounds: usize,
        /// Cells of the last round.
        cells: usize,
        /// How many of them were no discs or had fewer than three corners.
        invalid: usize,
    },
    /// A linear system could not be factorised.
    #[error("smoothing over the {faces} faces failed: {reason}; look for degenerate faces")]
    Solve {
        /// Size of the system.
        faces: usize,
        /// What the solver said.
        reason: String,
    },
}
