//! Why there is no picture.

use std::path::PathBuf;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// An option is out of range.
    #[error("{name} is {value}; it must lie between {:e} and {:e}", limits[0], limits[1])]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Value given.
        value: f64,
        /// Smallest and largest value.
        limits: [f64; 2],
    },
    /// There are no triangles.
    #[error("the tessellation has no triangles")]
    Empty,
    /// All points of the mesh coincide, or one is not finite.
    #[error("the box around the mesh has the diagonal {diagonal}, which cannot be shown")]
    Extent {
        /// Length of the diagonal.
        diagonal: f64,
    },
    /// The tessellation is not one of this surface.
    #[error("triangle {triangle} does not belong to the surface: {reason}; tessellate this very surface")]
    Mismatch {
        /// The triangle.
        triangle: usize,
        /// What is missing.
        reason: &'static str,
    },
    /// A list does not have one entry for each of what it describes.
    #[error("{name}: {given} entries instead of {needed}; give those of this very surface and mesh")]
    Length {
        /// What the list holds.
        name: &'static str,
        /// Number of entries.
        given: usize,
        /// Number of entries needed.
        needed: usize,
    },
    /// [`Shade::Deviation`](crate::Shade::Deviation) was asked for without distances.
    #[error("there are no distances to show; name the mesh to compare with")]
    NoDistances,
    /// The page could not be packed.
    #[error("the page cannot be written: {what}")]
    Page {
        /// Why.
        what: String,
    },
    /// The pixels of an image are not `width × height × 4` bytes.
    #[error("the image has {given} bytes, its size asks for {needed}")]
    Pixels {
        /// Number of bytes.
        given: usize,
        /// Number of bytes needed.
        needed: usize,
    },
    /// The file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
