//! Segmentation of a closed triangle mesh into disc charts.
//!
//! The stage between a mesh and its charts: every face gets a label, and the labels are read as *charts* (discs), *corners*
//! (vertices where three or more charts meet) and *arcs* (chains of edges between two corners, along which exactly two charts
//! meet). Three ways lead there, all behind the trait [`Segment`]:
//!
//! * [`Labels`]: one label per face, from a file or another program;
//! * [`Waypoints`]: paths through vertices clicked by hand, joined by shortest paths that prefer creases;
//! * [`Automatic`]: over-segmentation, merging and smoothing of the borders, no input but the mesh.
//!
//! ```
//! use glam::DVec3;
//! use suture_mesh::{Topology, TriMesh};
//! use suture_segment::{Labels, Segment};
//!
//! // A tetrahedron, one chart per face: every vertex is a corner of valence three.
//! let mesh = TriMesh::new(
//!     vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
//!     vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//! );
//! let topology = Topology::build(&mesh)?;
//! let segmentation = Labels(vec![0, 1, 2, 3]).segment(&mesh, &topology)?;
//! assert_eq!((segmentation.corners.len(), segmentation.arcs.len(), segmentation.charts.len()), (4, 6, 4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: faces are counter-clockwise seen from outside; a chart lies on the left of its border loop; the arcs of a corner
//! are listed counter-clockwise. Lengths are relative to the diagonal of the bounding box. Results are deterministic and do not
//! change under scaling and moving by powers of two.
//!
//! Not for open or disconnected meshes (they are refused, with the edge or the face), and not for texture atlases: charts here
//! keep arcs long and corners few, and nothing is said about packing.

#![forbid(unsafe_code)]

mod automatic;
mod balance;
mod census;
mod colouring;
mod error;
mod fair;
mod flatten;
mod labels;
mod segmentation;
mod waypoints;

pub use automatic::{Automatic, AutomaticOptions, split_charts};
pub use balance::balance_corners;
pub use colouring::colouring;
pub use error::SegmentError;
pub use fair::{FairOptions, Fairing, MeshPoint, fair_arcs, smooth_line};
pub use flatten::{Flatten, NormalSpread};
pub use labels::{Labels, read_labels, write_labels};
pub use segmentation::{Arc, ArcEnd, ChartBoundary, Corner, Limits, Segmentation, reach};
pub use waypoints::{WaypointOptions, Waypoints, read_paths};

use suture_mesh::{Topology, TriMesh};

/// A way to cut a closed mesh into disc charts.
pub trait Segment {
    /// Cuts the mesh; `topology` is the adjacency built from `mesh`.
    ///
    /// # Errors
    /// [`SegmentError`] when the mesh is open or disconnected, or when the result would break an invariant of [`Segmentation`].
    fn segment(&self, mesh: &TriMesh, topology: &Topology) -> Result<Segmentation, SegmentError>;

    /// Whether it speaks of the faces or vertices of one mesh by their numbers, so that it cannot be asked to segment a finer one. By
    /// default it does not.
    fn names_the_mesh(&self) -> bool {
        false
    }
}
