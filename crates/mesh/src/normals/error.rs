//! Why normals cannot be estimated.

/// Why normals cannot be estimated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NormalsError {
    /// The adjacency is not that of the mesh.
    #[error(
        "the adjacency has {expected} faces, the mesh {faces}, or their vertices differ; build it from this mesh"
    )]
    Topology {
        /// Faces of the mesh.
        faces: usize,
        /// Faces of the adjacency.
        expected: usize,
    },
    /// A vertex is not finite.
    #[error("vertex {vertex} is not finite; correct or remove it")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// The faces around a vertex have no area, or their normals cancel.
    #[error("the faces around vertex {vertex} determine no normal; give one, or remove faces without area")]
    NoNormal {
        /// The vertex.
        vertex: usize,
    },
}
