//! Normals of the limit surface of Loop subdivision.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::weighted::{angle_weighted, named};
use super::{EstimateNormals, NormalsError, check, ring, smallest_cap};
use crate::measure::{cross, longest_edge, positive, unit};
use crate::{Topology, TriMesh};

/// Normals of the limit surface of Loop subdivision of the mesh, the default for smooth surfaces through its vertices. Where the limit
/// tangents are parallel, or some face at the vertex turns away from them by more than [`LoopLimit::LARGEST_ANGLE`], the mean of the face
/// normals weighted by angle takes their place; where faces turn away from that as well, the direction that has the largest angle to
/// any of them as small as it can be.
///
/// # References
/// C. Loop, *Smooth subdivision surfaces based on triangles*, 1987; at boundaries H. Hoppe et al., *Piecewise smooth surface
/// reconstruction*, 1994.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoopLimit;

impl LoopLimit {
    /// Largest angle between a limit normal and the faces around its vertex, in degrees. Beyond it the faces hardly see the surface
    /// from their own side, and methods that need them to would fail.
    pub const LARGEST_ANGLE: f64 = 75.0;
}

impl EstimateNormals for LoopLimit {
    fn estimate(&self, mesh: &TriMesh, topology: &Topology) -> Result<Vec<DVec3>, NormalsError> {
        check(mesh, topology)?;
        let normal = |v: u32| {
            let mean = angle_weighted(mesh, topology, v)?;
            let faces: Vec<DVec3> = topology
                .outgoing(v)
                .map(|h| mesh.corners(topology.face(h) as usize))
                .filter_map(|c| unit(cross(c, positive(longest_edge(c)))))
                .collect();
            let least = LoopLimit::LARGEST_ANGLE.to_radians().cos();
            let sees = |n: &DVec3| n.dot(mean) > 0.0 && faces.iter().all(|f| f.dot(*n) >= least);
            let best = limit(mesh, topology, v).into_iter().chain([mean]).find(sees);
            Some(best.or_else(|| smallest_cap(&faces).map(|c| c.0)).unwrap_or(mean))
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
