//! What a reader did besides reading.

use std::fmt;

use crate::Place;

/// Something that a reader did or left out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// Coinciding STL corners became one vertex.
    Welded {
        /// Corners in the file.
        before: usize,
        /// Vertices in the mesh.
        after: usize,
    },
    /// Polygons with more than three corners were cut into triangles.
    Triangulated {
        /// Number of polygons.
        polygons: usize,
        /// Corners of the largest.
        largest: usize,
    },
    /// Polygons that cross themselves or span no area were cut blindly: some of their triangles may be folded or degenerate.
    IrregularPolygons {
        /// Number of polygons.
        polygons: usize,
        /// The first of them.
        first: Place,
    },
    /// Faces with fewer than three corners were skipped.
    SkippedFaces {
        /// Number of faces.
        faces: usize,
        /// The first of them.
        first: Place,
        /// Its number of corners.
        corners: usize,
    },
    /// Something in the file that a mesh does not need.
    Ignored {
        /// What it is.
        what: String,
        /// How often.
        count: usize,
        /// The first of them.
        first: Place,
    },
    /// Faces disagree on the normal of a vertex: it got the mean direction.
    AveragedNormals {
        /// Number of vertices.
        vertices: usize,
    },
    /// The normals of the file were dropped.
    DroppedNormals {
        /// Why.
        reason: &'static str,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Welded { before, after } => {
                write!(f, "welded {before} facet corners into {after} vertices")
            }
            Self::Triangulated { polygons, largest } => {
                write!(f, "triangulated {polygons} polygons with up to {largest} corners")
            }
            Self::IrregularPolygons { polygons, first } => {
                write!(f, "{polygons} polygons cross themselves or span no area, the first at {first}")
            }
            Self::SkippedFaces { faces, first, corners } => write!(
                f,
                "skipped {faces} faces with fewer than three corners, the first at {first} with {corners}"
            ),
            Self::Ignored { what, count, first } => {
                write!(f, "ignored {count} × {what}, the first at {first}")
            }
            Self::AveragedNormals { vertices } => {
                write!(f, "faces disagree on the normal of {vertices} vertices; took the mean")
            }
            Self::DroppedNormals { reason } => write!(f, "dropped the normals: {reason}"),
        }
    }
}
