//! Normals of the limit surface of Loop subdivision.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::weighted::{angle_weighted, named};
use super::{EstimateNormals, NormalsError, check, ring};
use crate::measure::unit;
use crate::{Topology, TriMesh};

/// Normals of the limit surface of Loop subdivision of the mesh, the default for smooth surfaces through its vertices. Where the limit
/// tangents are parallel, or point to the other side than the faces, the mean of the face normals weighted by angle takes their place.
///
/// # References
/// C. Loop, *Smooth subdivision surfaces based on triangles*, 1987; at boundaries H. Hoppe et al., *Piecewise smooth surface
/// reconstruction*, 1994.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoopLimit;

impl EstimateNormals for LoopLimit {
    fn estimate(&self, mesh: &TriMesh, topology: &Topology) -> Result<Vec<DVec3>, NormalsError> {
        check(mesh, topology)?;
        let normal = |v: u32| {
            let mean = angle_weighted(mesh, topology, v)?;
            Some(limit(mesh, topology, v).filter(|n| n.dot(mean) > 0.0).unwrap_or(mean))
        };
        let normals = (0..mesh.positions.len() as u32).map(|v| normal(v).unwrap_or_default()).collect();
        named(topology, normals)
    }
}

fn limit(mesh: &TriMesh, topology: &Topology, v: u32) -> Option<DVec3> {
    let centre = mesh.positions[v as usize];
    // From the vertex: the masks of tangents sum to zero.
    let d: Vec<DVec3> = ring(topology, v).iter().map(|&w| mesh.positions[w as usize] - centre).collect();
    let k = d.len();
    let (s, t) = if !topology.is_boundary_vertex(v) {
        let turn = |j: usize| (TAU * j as f64 / k as f64).sin_cos();
        let cosine: DVec3 = d.iter().enumerate().map(|(j, d)| *d * turn(j).1).sum();
        let sine: DVec3 = d.iter().enumerate().map(|(j, d)| *d * turn(j).0).sum();
        (cosine, sine)
    } else {
        // Counter-clockwise from the first to the last neighbour on the boundary.
        let (first, last) = (*d.first()?, *d.last()?);
        let along = first - last;
        let across = match k {
            2 => first + last,
            3 => d[1],
            _ => {
                let theta = PI / (k - 1) as f64;
                let ends = (first + last) * theta.sin();
                let inner: DVec3 =
                    (1..k - 1).map(|j| d[j] * ((2.0 * theta.cos() - 2.0) * (j as f64 * theta).sin())).sum();
                // The mask points out of the surface.
                -(ends + inner)
            }
        };
        (along, across)
    };
    unit(unit(s)?.cross(unit(t)?))
}
