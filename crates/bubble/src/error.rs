//! Why a mesh has no bubble surface.

/// Why a mesh has no bubble surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BubbleError {
    /// The mesh has no faces.
    #[error("the mesh has no faces")]
    Empty,
    /// More faces than 32-bit indices can hold.
    #[error("the mesh has {faces} faces; at most {limit} are supported")]
    TooLarge {
        /// Number of faces.
        faces: usize,
        /// Largest supported number.
        limit: usize,
    },
    /// The order is not supported.
    #[error("order {order} is not supported; use 0 to {limit}")]
    Order {
        /// The order asked for.
        order: usize,
        /// The largest one.
        limit: usize,
    },
    /// An option is out of range.
    #[error("the option {name} = {value} is out of range: {range}")]
    Option {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// Normals and vertices do not match.
    #[error("there are {normals} normals for {vertices} vertices; give one per vertex")]
    NormalCount {
        /// Number of normals.
        normals: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {vertices}")]
    VertexIndex {
        /// The face.
        face: usize,
        /// The missing vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A face names one vertex twice.
    #[error("face {face} names vertex {vertex} twice; remove the face")]
    RepeatedVertex {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// A position is not finite, or so large that its square is not.
    #[error("the position of vertex {vertex} is not finite or too large to be squared")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A normal has no direction.
    #[error(
        "the normal of vertex {vertex} has length {length:e}; give it a direction, or estimate the normals"
    )]
    Normal {
        /// The vertex.
        vertex: usize,
        /// Its length.
        length: f64,
    },
    /// A vertex implicit cannot be used.
    #[error("the implicit of vertex {vertex} cannot be used: {reason}")]
    Implicit {
        /// The vertex.
        vertex: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A tagged edge is no edge of the mesh.
    #[error("the mesh has no edge {} → {}; tag edges by the numbers of their vertices, from 0", edge[0], edge[1])]
    NoSuchEdge {
        /// The edge, lower index first.
        edge: [u32; 2],
    },
    /// Numbers of implicits or strips do not match the mesh.
    #[error("{given} {what} were given, {needed} are needed")]
    Count {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The ends of an edge coincide, to working precision.
    #[error("vertices {} and {} of an edge coincide; weld them and drop the degenerate faces", edge[0], edge[1])]
    CoincidentVertices {
        /// The edge.
        edge: [u32; 2],
    },
    /// A strip is degenerate: the edge runs along a normal, or the normals at its ends oppose each other.
    #[error(
        "the strip of edge {} → {} is degenerate at t = {t:.3}: {what} is {value:.3}, below {limit}; refine the mesh there, smooth the \
         normals, or accept it with a smaller `refuse`",
        edge[0], edge[1]
    )]
    Degenerate {
        /// The edge, lower index first.
        edge: [u32; 2],
        /// Parameter on the edge.
        t: f64,
        /// The quantity.
        what: Measure,
        /// Its value.
        value: f64,
        /// Its limit.
        limit: f64,
    },
    /// A strip that was given does not fit.
    #[error("strip {strip} does not fit: {reason}")]
    Strip {
        /// The strip.
        strip: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A surface point is not finite.
    #[error(
        "the surface over face {face} is not finite; its coordinates or normals are too large or too small"
    )]
    NotFinitePatch {
        /// The face.
        face: usize,
    },
    /// Patches and seams do not form a surface.
    #[error(transparent)]
    Surface(#[from] suture_surface::SurfaceError),
}

/// What tells a healthy strip from a degenerate one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Measure {
    /// Length of the boundary curve's derivative relative to that of the edge.
    Speed,
    /// Length of the interpolated normal relative to that of the longer one at the ends.
    Normal,
    /// Cosine of the angle between the strip's gradient and the interpolated normal.
    Cosine,
}

impl std::fmt::Display for Measure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Speed => "the speed of the boundary curve relative to the edge",
            Self::Normal => "the relative length of the interpolated normal",
            Self::Cosine => "the cosine between gradient and interpolated normal",
        })
    }
}
