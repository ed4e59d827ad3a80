//! Means of face normals.

use glam::DVec3;

use super::{EstimateNormals, NormalsError, check};
use crate::measure::{cross, longest_edge, positive, unit};
use crate::{Topology, TriMesh, vertex_normals_area_weighted};

/// Means of the face normals around each vertex, weighted by area.
///
/// # References
/// H. Gouraud, *Continuous shading of curved surfaces*, 1971.
#[derive(Clone, Copy, Debug, Default)]
pub struct AreaWeighted;

impl EstimateNormals for AreaWeighted {
    fn estimate(&self, mesh: &TriMesh, topology: &Topology) -> Result<Vec<DVec3>, NormalsError> {
        check(mesh, topology)?;
        named(topology, vertex_normals_area_weighted(mesh))
    }
}

/// Means of the face normals around each vertex, weighted by the angle of the face there: independent of how a plane part is divided.
///
/// # References
/// G. Thürmer, C. Wüthrich, *Computing vertex normals from polygonal facets*, 1998.
#[derive(Clone, Copy, Debug, Default)]
pub struct AngleWeighted;

impl EstimateNormals for AngleWeighted {
    fn estimate(&self, mesh: &TriMesh, topology: &Topology) -> Result<Vec<DVec3>, NormalsError> {
        check(mesh, topology)?;
        let normals = (0..mesh.positions.len() as u32)
            .map(|v| angle_weighted(mesh, topology, v).unwrap_or_default())
            .collect();
        named(topology, normals)
    }
}

/// The mean at one vertex; `None` where it vanishes.
pub(super) fn angle_weighted(mesh: &TriMesh, topology: &Topology, v: u32) -> Option<DVec3> {
    let mut sum = DVec3::ZERO;
    for h in topology.outgoing(v) {
        let corners = mesh.corners(topology.face(h) as usize);
        let at = |v: u32| mesh.positions[v as usize];
        let p = at(v);
        let (a, b) = (unit(at(topology.head(h)) - p), unit(at(topology.tail(topology.prev(h))) - p));
        let (Some(a), Some(b), Some(n)) = (a, b, unit(cross(corners, positive(longest_edge(corners)))))
        else {
            continue;
        };
        sum += n * a.cross(b).length().atan2(a.dot(b));
    }
    unit(sum)
}

/// Refuses vertices that have faces and no normal.
pub(super) fn named(topology: &Topology, normals: Vec<DVec3>) -> Result<Vec<DVec3>, NormalsError> {
    let bare = |v: usize| normals[v] == DVec3::ZERO && topology.outgoing(v as u32).next().is_some();
    match (0..normals.len()).find(|&v| bare(v)) {
        Some(vertex) => Err(NormalsError::NoNormal { vertex }),
        None => Ok(normals),
    }
}
