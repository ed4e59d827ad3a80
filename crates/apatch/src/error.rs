//! Why a mesh has no A-patches.

use suture_mesh::TopologyError;

/// Why a mesh with normals does not become a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ApatchError {
    /// The mesh is not an oriented manifold.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A vertex is not finite.
    #[error("vertex {vertex} is not finite; correct or remove it")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// There are as many normals as vertices, or there is no surface.
    #[error("{normals} normals for {vertices} vertices; give one per vertex, or have them estimated")]
    NormalCount {
        /// Number of normals.
        normals: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A normal is zero or not finite.
    #[error(
        "the normal of vertex {vertex} is {value:?}; give it a finite normal that is not zero, or have all estimated"
    )]
    Normal {
        /// The vertex.
        vertex: usize,
        /// The normal.
        value: [f64; 3],
    },
    /// A face has no area.
    #[error(
        "face {face} has no area (height {height:e} of its longest edge, at least {limit:e} is needed); remove it or move its corners"
    )]
    DegenerateFace {
        /// The face.
        face: usize,
        /// Its height over its longest edge, relative to that edge.
        height: f64,
        /// The smallest height accepted.
        limit: f64,
    },
    /// No direction rises above a face and all three tangent planes at its corners.
    #[error(
        "the normals at the corners of face {face} do not allow a tetrahedron over it: the normal of vertex {vertex} makes an angle of \
         {degrees:.1} degrees with the face; turn it, estimate the normals again or divide the face"
    )]
    NormalAgainstFace {
        /// The face of the input mesh, or of the refined one where refinement came first.
        face: usize,
        /// The vertex with the largest angle.
        vertex: usize,
        /// Angle between its normal and that of the face.
        degrees: f64,
    },
    /// An option is out of range.
    #[error("the option {name} = {value} must lie in {range}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is accepted.
        range: &'static str,
    },
    /// The given apex weights do not fit the faces.
    #[error("{given} apex weights for {faces} faces; give one per face of the input")]
    WeightCount {
        /// Number of weights.
        given: usize,
        /// Number of faces.
        faces: usize,
    },
    /// A given apex weight is not finite.
    #[error("the apex weight of face {face} is {value}; it must be finite")]
    Weight {
        /// The face.
        face: usize,
        /// Its weight.
        value: f64,
    },
    /// A face or an edge that does not exist, or a side that it does not have.
    #[error("there is no {what} {index} with that side; {count} exist")]
    NoSuch {
        /// `face` or `edge`.
        what: &'static str,
        /// The number given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// More vertices than 32-bit indices can hold.
    #[error("{count} {what} are too many, at most {limit} are supported; use a lower resolution")]
    TooLarge {
        /// What is counted.
        what: &'static str,
        /// The number.
        count: usize,
        /// The largest supported number.
        limit: usize,
    },
    /// A surface point is not finite.
    #[error(
        "the surface over face {face} is not finite; its coordinates or gradients are too large or too small"
    )]
    NotFinitePatch {
        /// The face.
        face: usize,
    },
    /// Patches and seams do not form a surface.
    #[error(transparent)]
    Surface(#[from] suture_surface::SurfaceError),
}
