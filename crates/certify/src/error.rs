//! Why nothing could be measured.

/// Why nothing could be measured. A surface that measures badly is not an error: its certificate says so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// The length that everything is measured against is not positive and finite.
    #[error("the diagonal is {value}; give the positive length of the input's bounding box")]
    Diagonal {
        /// The length given.
        value: f64,
    },
    /// An option lies outside its range.
    #[error("option {name} is {value}, outside {least}..={most}")]
    Option {
        /// Name of the field.
        name: &'static str,
        /// The value given.
        value: usize,
        /// Smallest value accepted.
        least: usize,
        /// Largest value accepted.
        most: usize,
    },
    /// A limit is negative or not a number.
    #[error("limit {name} is {value}; give a number that is not negative")]
    Limit {
        /// Name of the field.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} of the {of} names vertex {vertex}, but there are {vertices}")]
    NoSuchVertex {
        /// `"mesh"` or `"tessellation"`.
        of: &'static str,
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is not finite.
    #[error("vertex {vertex} of the {of} is not finite")]
    NotFinite {
        /// `"mesh"` or `"tessellation"`.
        of: &'static str,
        /// The vertex.
        vertex: usize,
    },
    /// There is no triangle of positive area to measure against.
    #[error("the {of} has no triangle of positive area")]
    NoArea {
        /// `"mesh"` or `"tessellation"`.
        of: &'static str,
    },
    /// The slices of the tessellation do not have one entry for every triangle.
    #[error("the tessellation has {triangles} triangles but {given} entries in `{name}`")]
    Length {
        /// Name of the slice.
        name: &'static str,
        /// Number of triangles.
        triangles: usize,
        /// Number of entries.
        given: usize,
    },
    /// A triangle of the tessellation lies on a patch that the surface does not have, or at parameters that are not finite.
    #[error(
        "triangle {triangle} of the tessellation names patch {patch} of {patches}, or parameters that are not finite"
    )]
    NoSuchPatch {
        /// The triangle.
        triangle: usize,
        /// The patch it names.
        patch: u32,
        /// How many patches there are.
        patches: usize,
    },
}
