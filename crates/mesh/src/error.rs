//! What can be wrong with a mesh file or a mesh.

use std::{fmt, io, path::PathBuf};

use crate::io::MeshFormat;

/// Where in a file: a line of a text format, a byte offset of a binary one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line, counted from 1.
    Line(u64),
    /// Byte offset from the beginning of the file.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a mesh could not be read, written or changed. Texts taken from the file are shortened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The operating system refused.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// `read` or `write`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// Neither the extension nor the content names a known format.
    #[error(
        "cannot tell the mesh format of {}; give it the extension .obj, .stl, .ply or .off",
        path.display()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A word that does not belong there.
    #[error("{format}, {at}: found `{found}`, expected {expected}")]
    Syntax {
        /// File kind.
        format: MeshFormat,
        /// Where.
        at: Place,
        /// What stands there.
        found: String,
        /// What should.
        expected: &'static str,
    },
    /// The file ends inside something.
    #[error(
        "{format}, {at}: the file ends where {expected} should follow; it is truncated, get a complete copy"
    )]
    Truncated {
        /// File kind.
        format: MeshFormat,
        /// Where it ends.
        at: Place,
        /// What is missing.
        expected: &'static str,
    },
    /// A header claims more than the file can hold.
    #[error(
        "{format}, {at}: the header claims {claimed} {what}, but the rest of the file holds at most {possible}; \
         it is truncated or its header is wrong"
    )]
    CountExceedsFile {
        /// File kind.
        format: MeshFormat,
        /// Where the data would begin.
        at: Place,
        /// What is counted.
        what: String,
        /// The number in the header.
        claimed: u64,
        /// The number that fits.
        possible: u64,
    },
    /// A coordinate is NaN or infinite (or too large for `f64`).
    #[error(
        "{format}, {at}: coordinate `{value}` of vertex {vertex} (from 0) is not a finite number; correct or remove the vertex"
    )]
    NotFinite {
        /// File kind.
        format: MeshFormat,
        /// Where.
        at: Place,
        /// The vertex, from 0.
        vertex: usize,
        /// The coordinate.
        value: String,
    },
    /// A face names a vertex or normal that does not exist.
    #[error("{format}, {at}: index {index} names no {what}; valid are {valid}")]
    Index {
        /// File kind.
        format: MeshFormat,
        /// The face's place.
        at: Place,
        /// `vertex` or `normal`.
        what: &'static str,
        /// The index as it stands in the file.
        index: String,
        /// The valid range in the counting of the format.
        valid: String,
    },
    /// A concave polygon too large for the quadratic triangulation.
    #[error(
        "{format}, {at}: a polygon with {corners} corners, {reflex} of them reflex, is too large; \
         triangulate it in the program that wrote it"
    )]
    Polygon {
        /// File kind.
        format: MeshFormat,
        /// The face's place.
        at: Place,
        /// Its corners.
        corners: usize,
        /// Its reflex corners.
        reflex: usize,
    },
    /// A legitimate part of the format that is not read.
    #[error("{format}, {at}: {what}")]
    Unsupported {
        /// File kind.
        format: MeshFormat,
        /// Where.
        at: Place,
        /// What it is, and what to do.
        what: &'static str,
    },
    /// There are no faces.
    #[error(
        "{format}: there are {vertices} vertices but no faces; a mesh with triangles or polygons is needed"
    )]
    NoFaces {
        /// File kind.
        format: MeshFormat,
        /// Number of vertices.
        vertices: usize,
    },
    /// More vertices or faces than 32-bit indices can hold.
    #[error("{count} {what}; at most {limit} are supported, split the mesh")]
    TooLarge {
        /// What is counted.
        what: &'static str,
        /// The number.
        count: usize,
        /// The largest supported number.
        limit: usize,
    },
    /// The mesh in memory names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {vertices}")]
    VertexIndex {
        /// The face.
        face: usize,
        /// The missing vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// The mesh in memory has another number of normals than of vertices.
    #[error("{normals} normals for {vertices} vertices; give one per vertex or none")]
    NormalCount {
        /// Number of normals.
        normals: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// The colours do not go with the faces.
    #[error("{colours} colours for {faces} faces; give one per face")]
    ColourCount {
        /// Number of colours.
        colours: usize,
        /// Number of faces.
        faces: usize,
    },
    /// A vertex or normal in memory is not finite, or does not fit the numbers of the format.
    #[error("vertex {vertex} cannot be written as {format}: {value} is not a finite {precision} number")]
    NotWritable {
        /// File kind.
        format: MeshFormat,
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        value: f64,
        /// `64-bit` or `32-bit`.
        precision: &'static str,
    },
    /// A tolerance outside `[0, 1)`.
    #[error("tolerance {value} is relative to the diagonal and must lie in [0, 1)")]
    Tolerance {
        /// The value.
        value: f64,
    },
}
