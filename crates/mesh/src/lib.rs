//! Indexed triangle meshes.

#![forbid(unsafe_code)]

mod topology;
mod tri_mesh;

pub use topology::{Topology, TopologyError};
pub use tri_mesh::TriMesh;
