//! Why a surface has no tessellation.

use glam::DVec2;

/// Why a surface has no tessellation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TessellateError {
    /// An option is out of range.
    #[error("option {name} is {value}, it must be positive and at least {limit}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Value given.
        value: f64,
        /// Lower limit.
        limit: f64,
    },
    /// The surface has no patches.
    #[error("the surface has no patches")]
    Empty,
    /// The domain of a patch is not a bounded region with a boundary.
    #[error("the domain of patch {patch} is unusable: {reason}")]
    Domain {
        /// The patch.
        patch: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A patch has a point that is not finite.
    #[error("patch {patch} is not finite at the parameter {at}")]
    NotFinite {
        /// The patch.
        patch: usize,
        /// The parameter.
        at: DVec2,
    },
    /// All sampled points of the surface coincide.
    #[error("all points of the surface coincide; there is nothing to tessellate")]
    Point,
    /// A loop runs the wrong way round: the outer one must be counter-clockwise, holes clockwise.
    #[error(
        "loop {ring} of patch {patch} encloses the signed area {area:e}; the outer loop must run counter-clockwise, holes clockwise"
    )]
    Orientation {
        /// The patch.
        patch: usize,
        /// The loop.
        ring: usize,
        /// Its signed area in the parameter plane.
        area: f64,
    },
    /// The boundary polyline of a patch meets itself in the parameter plane.
    #[error(
        "the boundary of patch {patch} meets itself at edge {edge} with {segments} segments on that edge; raise max_segments if the exact curves do not cross"
    )]
    SelfIntersection {
        /// The patch.
        patch: usize,
        /// An edge of its domain where it happens.
        edge: usize,
        /// Segments on that edge.
        segments: usize,
    },
    /// The mesh would have more vertices than 32-bit indices can hold.
    #[error("the mesh would have {vertices} vertices; at most {limit} are supported; relax the tolerances")]
    TooLarge {
        /// Number of vertices.
        vertices: usize,
        /// Largest supported number.
        limit: usize,
    },
}
