//! Why a segment is not flattened.

use glam::DVec3;

/// Why a segment is not flattened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// There are no faces.
    #[error("there are no faces to flatten")]
    Empty,
    /// A segment names a face that the mesh does not have.
    #[error("the segment names face {face}, but the mesh has only {faces}")]
    FaceIndex {
        /// The missing face.
        face: u32,
        /// Number of faces of the mesh.
        faces: usize,
    },
    /// A segment names a face twice.
    #[error("the segment names face {face} twice; name every face once")]
    RepeatedFace {
        /// The face.
        face: u32,
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
    /// A vertex has a coordinate that is not finite.
    #[error("vertex {vertex} is not finite: {value}; repair the mesh first")]
    NotFinite {
        /// The vertex (of the mesh when a disc is cut out, of the chart when it is flattened).
        vertex: usize,
        /// Its position; parameters are given with `z = 0`.
        value: DVec3,
    },
    /// Two arrays that belong together have different lengths.
    #[error("{what}: {given} given, {needed} needed")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        given: usize,
        /// The length that it should have.
        needed: usize,
    },
    /// An option has a value without meaning.
    #[error("option `{option}` = {value} must be {limit}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What is admitted.
        limit: &'static str,
    },
    /// The faces are not an oriented disc.
    #[error(
        "the faces are not a disc: Euler characteristic {euler} (a disc has 1), {loops} boundary loops (1), \
         {components} components (1), {defects} edges or vertices with more than two faces or one fan (0); split the segment"
    )]
    NotDisc {
        /// Vertices − edges + faces.
        euler: i64,
        /// Number of boundary loops.
        loops: usize,
        /// Number of components.
        components: usize,
        /// Number of directed edges used twice plus vertices with more than one fan.
        defects: usize,
    },
    /// An interior chart vertex does not have the faces of its mesh vertex: an internal error of the collar.
    #[error(
        "interior chart vertex {vertex} has {found} faces, its mesh vertex has {needed}; please report the mesh"
    )]
    Valence {
        /// The chart vertex.
        vertex: usize,
        /// Number of its chart faces.
        found: usize,
        /// Number of faces of its mesh vertex.
        needed: usize,
    },
    /// The collar winds around the surface so often that it outgrows the mesh.
    #[error(
        "the collar has {faces} faces after {rings} rings, the limit is {limit}; ask for a narrower collar"
    )]
    CollarTooLarge {
        /// Number of chart faces.
        faces: usize,
        /// Number of rings grown.
        rings: usize,
        /// Largest number admitted.
        limit: usize,
    },
    /// The pinned vertices are not two different vertices of the chart with two different finite positions.
    #[error("pins {pins:?} are not two different vertices among {vertices} at two different finite points")]
    Pins {
        /// The pinned vertices.
        pins: [usize; 2],
        /// Number of vertices.
        vertices: usize,
    },
    /// A linear system has no usable solution.
    #[error(
        "{method}: the system of {unknowns} unknowns is singular to working precision; try `Recommended`"
    )]
    Singular {
        /// The method that assembled the system.
        method: &'static str,
        /// Its number of unknowns.
        unknowns: usize,
    },
    /// The parameters cover no area.
    #[error("the parameters collapse: total area {area:e}; try `Recommended`")]
    Collapsed {
        /// Area in the parameter plane.
        area: f64,
    },
    /// Faces are flipped where none may be.
    #[error(
        "{method}: {count} of {faces} faces are flipped, the worst is chart face {face}; split the segment"
    )]
    Flips {
        /// The method that met them.
        method: &'static str,
        /// Number of flipped faces.
        count: usize,
        /// Number of faces.
        faces: usize,
        /// The chart face with the most negative area relative to its area in space.
        face: usize,
    },
    /// No memory for a factorisation.
    #[error("out of memory while factorising a system of {unknowns} unknowns; split the segment")]
    OutOfMemory {
        /// Number of unknowns.
        unknowns: usize,
    },
}
