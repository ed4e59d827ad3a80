//! Why a surface cannot be written or read.

use std::path::PathBuf;

use suture_bernstein::NetError;
use suture_mesh::MeshError;
use suture_surface::{RecordError, SurfaceError};

/// Why a surface cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The extension names no format that can be written.
    #[error("{}: no format has this extension; use {known}", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The extensions that exist.
        known: &'static str,
    },
    /// The format writes triangles, but there is no tessellation.
    #[error("{format} files hold triangles: tessellate the surface first")]
    NeedsTessellation {
        /// The format.
        format: crate::Format,
    },
    /// The tessellation contradicts itself or the surface.
    #[error("the tessellation does not belong to the surface: {reason}")]
    Tessellation {
        /// What does not fit.
        reason: String,
    },
    /// A coordinate does not fit the numbers of the format.
    #[error(
        "vertex {vertex} has the coordinate {value:e}, which 32-bit numbers cannot hold; choose another unit of length"
    )]
    Range {
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// The file would be larger than the format allows.
    #[error("the file would have {bytes} bytes, {limit} are possible; tessellate more coarsely")]
    TooLarge {
        /// The size it would have.
        bytes: u64,
        /// The largest size of the format.
        limit: u64,
    },
    /// A patch has no form in STEP.
    #[error(
        "patch {patch} cannot leave as STEP: {reason}; export triangles (.obj, .glb) or native .json instead"
    )]
    StepPatch {
        /// The patch.
        patch: usize,
        /// Why.
        reason: &'static str,
    },
    /// The faces of a STEP file cannot be brought as close to the patches as asked.
    #[error(
        "the STEP faces deviate by {found:e} of the diagonal from the surface or from each other, {limit:e} is allowed; allow more (--cad-tolerance)"
    )]
    StepTolerance {
        /// The deviation that is left, relative to the diagonal.
        found: f64,
        /// The deviation that is allowed.
        limit: f64,
    },
    /// The mesh writer refuses the tessellation.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The operating system refuses.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The bytes are not JSON, or not of the form that the schema asks for.
    #[error("line {line}, column {column}: {reason}")]
    Json {
        /// Line, from 1; 0 where there is none to name.
        line: usize,
        /// Column, from 1; 0 where there is none to name.
        column: usize,
        /// What is wrong.
        reason: String,
    },
    /// The file follows another schema than this version reads.
    #[error("the file follows schema {found}, this version reads {supported}")]
    Schema {
        /// The schema of the file.
        found: u64,
        /// The schema that can be read.
        supported: u64,
    },
    /// A B-spline of the file is refused.
    #[error("B-spline {index}: {source}")]
    Spline {
        /// Its number.
        index: usize,
        /// Why.
        source: NetError,
    },
    /// A patch of the file is refused by its loader, or none knows its type.
    #[error("patch {index}: {source}")]
    Patch {
        /// Its number.
        index: usize,
        /// Why.
        source: RecordError,
    },
    /// Patches and seams of the file do not form a surface.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

impl From<serde_json::Error> for ExportError {
    fn from(e: serde_json::Error) -> Self {
        let reason = e.to_string();
        // The place is already in the fields.
        let reason = match reason.rfind(" at line ") {
            Some(end) if e.line() > 0 => reason[..end].to_owned(),
            _ => reason,
        };
        Self::Json { line: e.line(), column: e.column(), reason }
    }
}
