//! Indexed triangle meshes: adjacency, checks, repairs and file formats.
//!
//! * [`TriMesh`] is plain data and may be anything; [`check`] lists its defects; [`repair`] mends what can be mended safely;
//!   [`Topology`] is the half-edge adjacency of a mesh that has none.
//! * [`io`] reads OBJ, STL, PLY and OFF from untrusted bytes, and writes them atomically.
//! * [`shapes`] makes meshes by formula.
//!
//! ```
//! use suture_mesh::{Topology, check, io, shapes};
//!
//! let mut bytes = Vec::new();
//! io::write_to(&mut bytes, &shapes::torus(2.0, 0.5, 32, 16), io::MeshFormat::Ply, Default::default())?;
//! let loaded = io::read_from(&bytes, io::MeshFormat::Ply)?;
//!
//! let report = check(&loaded.mesh);
//! assert!(report.is_sound() && report.closed);
//! assert_eq!((report.euler_characteristic, report.genus), (0, Some(1)));
//! let topology = Topology::build(&loaded.mesh)?;
//! assert_eq!(topology.half_edge_count(), 3 * loaded.mesh.faces.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: faces are counter-clockwise seen from outside; indices are from 0; tolerances are relative to the diagonal of the
//! bounding box of the vertices in use. Results depend on the order of vertices and faces only where it is said.
//!
//! When not to use it: quad or polygon meshes (they are triangulated on reading), colours and texture coordinates (dropped),
//! point clouds, remeshing beyond local refinement, boolean operations, closest points and rays.

#![forbid(unsafe_code)]

mod check;
mod edges;
mod error;
mod flat;
pub mod io;
mod iron;
mod loops;
mod measure;
pub mod normals;
mod refine;
pub mod repair;
mod report;
pub mod shapes;
mod split;
mod subdivide;
mod topology;
mod tri_mesh;

pub use check::check;
pub use error::{MeshError, Place};
pub use flat::turn_flat_edges;
pub use iron::{IronOptions, Ironed, iron};
pub use measure::{dihedral_angle, median_edge_length, vertex_normals_area_weighted};
pub use normals::{EstimateNormals, NormalsError};
pub use refine::{RefineOptions, Refined, refine_curved};
pub use report::{
    BadIndex, BoundaryLoop, CoincidentVertex, Component, DuplicateFace, Listed, MeshReport, MisorientedEdge,
    NonManifoldEdge,
};
pub use split::components;
pub use subdivide::subdivide_midpoint;
pub use topology::{Topology, TopologyError};
pub use tri_mesh::TriMesh;

/// Equal for positions that compare equal: −0 is 0.
fn weld_key(p: glam::DVec3) -> [u64; 3] {
    (p + glam::DVec3::ZERO).to_array().map(f64::to_bits)
}
