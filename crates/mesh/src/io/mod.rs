//! Mesh files: OBJ, STL, PLY and OFF, read from untrusted bytes and written atomically.
//!
//! Readers never panic, never allocate more than a small multiple of the bytes they were given, and never repair silently: what
//! they did besides reading is in [`Loaded::notices`]. They accept defective meshes ([`check`](crate::check) names the defects)
//! and reject defective files.
//!
//! Conventions: polygons are triangulated in their plane and the triangles follow in file order; STL vertices are welded where they
//! coincide exactly; colours, texture coordinates, groups and materials are dropped.

mod atomic;
mod draft;
mod lexer;
mod normals;
mod notice;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod write;

use std::{fmt, path::Path};

pub use atomic::atomic_write;
pub(crate) use normals::mean_normal;
pub use notice::Notice;
pub use write::{WriteOptions, write, write_coloured_ply, write_to, write_with};

use crate::{MeshError, TriMesh};

/// The file formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography, ASCII or binary.
    Stl,
    /// Stanford polygon file, ASCII or binary of either endianness.
    Ply,
    /// Geomview object file, ASCII.
    Off,
}

impl MeshFormat {
    /// The format that the extension names, in any case: `.obj`, `.stl`, `.ply`, `.off`.
    pub fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "obj" => Self::Obj,
            "stl" => Self::Stl,
            "ply" => Self::Ply,
            "off" => Self::Off,
            _ => return None,
        })
    }

    /// The format that the content looks like. OBJ has no signature: its first word must be one of the common keywords.
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        if stl::looks_like(bytes) {
            return Some(Self::Stl);
        }
        if off::looks_like(bytes) {
            return Some(Self::Off);
        }
        obj::looks_like(bytes).then_some(Self::Obj)
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Off => "OFF",
        })
    }
}

/// A mesh from a file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The mesh: at least one face, indices in range, positions finite; nothing else is promised.
    pub mesh: TriMesh,
    /// What the reader did besides reading, in a fixed order.
    pub notices: Vec<Notice>,
}

/// Reads a mesh file. The extension decides the format; where it is unknown, the content does.
///
/// # Errors
/// [`MeshError`], with the line or byte offset.
pub fn read(path: impl AsRef<Path>) -> Result<Loaded, MeshError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| MeshError::Io {
        action: "read",
        path: path.to_owned(),
        source,
    })?;
    let format = MeshFormat::from_extension(path)
        .or_else(|| MeshFormat::sniff(&bytes))
        .ok_or_else(|| MeshError::UnknownFormat { path: path.to_owned() })?;
    read_from(&bytes, format)
}

/// Reads a mesh from the bytes of a file.
///
/// # Errors
/// [`MeshError`], with the line or byte offset.
pub fn read_from(bytes: &[u8], format: MeshFormat) -> Result<Loaded, MeshError> {
    match format {
        MeshFormat::Obj => obj::read(bytes),
        MeshFormat::Stl => stl::read(bytes),
        MeshFormat::Ply => ply::read(bytes),
        MeshFormat::Off => off::read(bytes),
    }
}
