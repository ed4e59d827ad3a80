//! What [`check`](crate::check) found.

use std::fmt;

/// The first few of many things, and how many there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed<T> {
    /// How many there are.
    pub total: usize,
    /// The first of them, at most [`MeshReport::LIST_LIMIT`].
    pub first: Vec<T>,
}

impl<T> Default for Listed<T> {
    fn default() -> Self {
        Self { total: 0, first: Vec::new() }
    }
}

impl<T> Listed<T> {
    /// Counts `item`, and keeps it if there is room.
    pub(crate) fn push(&mut self, item: T) {
        if self.first.len() < MeshReport::LIST_LIMIT {
            self.first.push(item);
        }
        self.total += 1;
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.total == 0
    }
}

impl<T> Extend<T> for Listed<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        items.into_iter().for_each(|item| self.push(item));
    }
}

/// A face that names a vertex which does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadIndex {
    /// The face.
    pub face: usize,
    /// The missing vertex.
    pub vertex: u32,
}

/// A face with the same three vertices as an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DuplicateFace {
    /// The face.
    pub face: usize,
    /// The first face with these vertices.
    pub of: usize,
    /// Whether the two run in opposite directions.
    pub reversed: bool,
}

/// A vertex at exactly the position of an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoincidentVertex {
    /// The vertex.
    pub vertex: u32,
    /// The first vertex there.
    pub of: u32,
}

/// An edge with more than two faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NonManifoldEdge {
    /// Its vertices, the lower first.
    pub edge: [u32; 2],
    /// How many faces it has.
    pub faces: usize,
}

/// An edge whose two faces run through it in the same direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MisorientedEdge {
    /// Its vertices, the lower first.
    pub edge: [u32; 2],
    /// The two faces.
    pub faces: [usize; 2],
}

/// A connected set of edges with one face each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundaryLoop {
    /// Its vertices: for a simple loop in the order of the walk with the surface on the left, where orientation is consistent.
    pub vertices: Vec<u32>,
    /// Whether it is one closed curve that branches nowhere; always so unless there are non-manifold edges.
    pub simple: bool,
}

/// The faces that hang together by shared vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Its lowest face.
    pub first_face: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of faces.
    pub faces: usize,
    /// Number of boundary loops.
    pub boundary_loops: usize,
    /// `vertices − edges + faces`.
    pub euler_characteristic: i64,
    /// Whether no edge has more than two faces and the faces around each vertex form one fan.
    pub manifold: bool,
    /// Whether its faces can be oriented consistently (across the edges with two faces).
    pub orientable: bool,
    /// Whether no edge has only one face.
    pub closed: bool,
    /// Number of handles; of orientable manifolds only.
    pub genus: Option<usize>,
    /// Volume enclosed, in the units of the input to the third power; negative where the faces are seen clockwise from outside.
    /// Of closed, consistently oriented components only.
    pub volume: Option<f64>,
}

/// Everything that [`check`](crate::check) can say about a mesh. Faces with missing or repeated vertices are listed and then left
/// out of all other counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshReport {
    /// Number of vertices, isolated ones included.
    pub vertices: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of faces, defective ones included.
    pub faces: usize,
    /// Vertices that faces use, minus edges, plus faces.
    pub euler_characteristic: i64,
    /// Number of handles of all components together; only if every component has a genus.
    pub genus: Option<usize>,
    /// Length of the diagonal of the box around the vertices in use.
    pub diagonal: f64,
    /// Median of the edges' lengths.
    pub median_edge_length: f64,
    /// Sum of the components' volumes.
    pub volume: f64,
    /// Whether there are faces and every edge has two or more.
    pub closed: bool,
    /// Whether no edge has more than two faces and the faces around each vertex form one fan.
    pub manifold: bool,
    /// Whether the faces at every edge with two faces agree in orientation.
    pub oriented: bool,
    /// Whether the faces of every component can be oriented consistently.
    pub orientable: bool,
    /// Number of closed components with negative volume.
    pub inside_out: usize,
    /// The components, in the order of their first faces.
    pub components: Listed<Component>,
    /// First faces of the components that cannot be oriented.
    pub non_orientable: Listed<usize>,
    /// The boundary loops.
    pub boundary_loops: Listed<BoundaryLoop>,
    /// Faces that name missing vertices.
    pub bad_indices: Listed<BadIndex>,
    /// Vertices with a coordinate that is not finite.
    pub non_finite: Listed<u32>,
    /// Faces that name one vertex twice.
    pub repeated_vertices: Listed<usize>,
    /// Faces whose height over their longest edge is zero up to rounding.
    pub zero_area: Listed<usize>,
    /// Faces with the vertices of an earlier face.
    pub duplicate_faces: Listed<DuplicateFace>,
    /// Vertices that no face uses.
    pub isolated: Listed<u32>,
    /// Vertices at exactly the position of an earlier one.
    pub coincident: Listed<CoincidentVertex>,
    /// Edges with more than two faces.
    pub non_manifold_edges: Listed<NonManifoldEdge>,
    /// Vertices whose faces form more than one fan.
    pub non_manifold_vertices: Listed<u32>,
    /// Edges whose faces disagree in orientation.
    pub misoriented: Listed<MisorientedEdge>,
}

impl MeshReport {
    /// How many of each defect are listed; all are counted.
    pub const LIST_LIMIT: usize = 100;

    /// Whether the mesh is an oriented manifold (with or without boundary) of faces with area and finite vertices. Isolated and
    /// coincident vertices are allowed, and any number of components.
    pub fn is_sound(&self) -> bool {
        self.faces > 0
            && self.manifold
            && self.oriented
            && self.bad_indices.is_empty()
            && self.non_finite.is_empty()
            && self.repeated_vertices.is_empty()
            && self.zero_area.is_empty()
            && self.duplicate_faces.is_empty()
    }

    /// One line per kind of defect, with the first place; empty for a mesh without any.
    pub fn defects(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let mut say = |total: usize, what: &str, first: Option<String>| {
            if let Some(first) = first {
                lines.push(format!("{total} {what}, the first: {first}"));
            }
        };
        let l = &self.bad_indices;
        let text = |b: &BadIndex| format!("face {} names vertex {} of {}", b.face, b.vertex, self.vertices);
        say(l.total, "faces naming missing vertices", l.first.first().map(text));
        let l = &self.non_finite;
        say(l.total, "vertices not finite", l.first.first().map(|v| format!("vertex {v}")));
        let l = &self.repeated_vertices;
        say(l.total, "faces naming one vertex twice", l.first.first().map(|f| format!("face {f}")));
        let l = &self.zero_area;
        say(l.total, "faces without area", l.first.first().map(|f| format!("face {f}")));
        let l = &self.duplicate_faces;
        let text = |d: &DuplicateFace| format!("face {} of face {}", d.face, d.of);
        say(l.total, "duplicate faces", l.first.first().map(text));
        let l = &self.non_manifold_edges;
        let text = |e: &NonManifoldEdge| format!("{} to {} with {} faces", e.edge[0], e.edge[1], e.faces);
        say(l.total, "non-manifold edges", l.first.first().map(text));
        let l = &self.non_manifold_vertices;
        say(l.total, "non-manifold vertices", l.first.first().map(|v| format!("vertex {v}")));
        let l = &self.non_orientable;
        say(
            l.total,
            "components that cannot be oriented",
            l.first.first().map(|f| format!("that of face {f}")),
        );
        let l = &self.misoriented;
        let text = |e: &MisorientedEdge| format!("faces {} and {}", e.faces[0], e.faces[1]);
        say(l.total, "edges whose faces disagree in orientation", l.first.first().map(text));
        let l = &self.isolated;
        say(l.total, "isolated vertices", l.first.first().map(|v| format!("vertex {v}")));
        let l = &self.coincident;
        let text = |c: &CoincidentVertex| format!("vertex {} at vertex {}", c.vertex, c.of);
        say(l.total, "coincident vertices", l.first.first().map(text));
        if self.inside_out > 0 {
            lines.push(format!("{} components inside out", self.inside_out));
        }
        lines
    }
}

impl fmt::Display for MeshReport {
    /// The counts in one line, then the defects.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let genus = self.genus.map_or("undefined".to_owned(), |g| g.to_string());
        write!(
            f,
            "{} vertices, {} edges, {} faces, {} components, {} boundary loops, Euler characteristic {}, genus {genus}",
            self.vertices,
            self.edges,
            self.faces,
            self.components.total,
            self.boundary_loops.total,
            self.euler_characteristic
        )?;
        self.defects().iter().try_for_each(|line| write!(f, "\n{line}"))
    }
}
