//! Indexed triangle meshes.

#![forbid(unsafe_code)]

mod error;
pub mod io;
mod topology;
mod tri_mesh;

pub use error::{MeshError, Place};
pub use topology::{Topology, TopologyError};
pub use tri_mesh::TriMesh;

/// Equal for positions that compare equal: −0 is 0.
fn weld_key(p: glam::DVec3) -> [u64; 3] {
    (p + glam::DVec3::ZERO).to_array().map(f64::to_bits)
}
