//! What there is to say of a segmentation: its charts and how they flatten, its corners and its arcs.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use suture_mesh::{Topology, TriMesh};
use suture_param::{Chart, CollarOptions, Limits, ParamError, Parameterize, disc_with_collar};
use suture_segment::Segmentation;

/// A segmentation in numbers. Lengths are relative to the diagonal, areas to that of the mesh.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SegmentsReport {
    /// The charts, in the order of their labels.
    pub charts: Vec<ChartReport>,
    /// The corners.
    pub corners: Vec<CornerReport>,
    /// The arcs.
    pub arcs: Vec<ArcReport>,
}

/// One chart: a disc, or the segmentation would have been refused.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ChartReport {
    /// Number of faces.
    pub faces: usize,
    /// Share of the area.
    pub area: f64,
    /// Length of its border.
    pub circumference: f64,
    /// Number of corners on its border.
    pub corners: usize,
    /// How it lies in the plane.
    pub flattening: Option<FlatteningReport>,
    /// Why it could not be flattened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// How a chart with one ring of collar lies in the plane.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct FlatteningReport {
    /// Greatest over least area scale of a triangle.
    pub area_ratio: f64,
    /// Largest quotient of the singular values of a triangle.
    pub stretch: f64,
    /// Triangles turned over.
    pub flips: usize,
    /// Pairs of border edges that cross.
    pub overlaps: usize,
}

/// One corner.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct CornerReport {
    /// The vertex.
    pub vertex: u32,
    /// Number of charts around it.
    pub valence: usize,
}

/// One arc.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct ArcReport {
    /// The corners at its ends.
    pub corners: [usize; 2],
    /// The charts left and right of it.
    pub charts: [u32; 2],
    /// Length along the mesh edges.
    pub length: f64,
    /// Widest blend that it has room for.
    pub width: f64,
}

/// Measures a segmentation of a mesh, flattening every chart.
///
/// # Panics
/// When the segmentation does not belong to the mesh.
pub fn describe_segments(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    method: &(dyn Parameterize + Sync),
) -> SegmentsReport {
    let diagonal = mesh.diagonal();
    let position = |v: u32| mesh.positions[v as usize];
    let lengths: Vec<f64> = segmentation
        .arcs
        .iter()
        .map(|arc| {
            arc.vertices.windows(2).map(|w| position(w[0]).distance(position(w[1]))).sum::<f64>() / diagonal
        })
        .collect();
    let area = |f: u32| mesh.area_vector(f as usize).length();
    let total: f64 = (0..mesh.faces.len() as u32).map(area).sum();
    let charts = segmentation
        .charts
        .par_iter()
        .map(|chart| {
            let (flattening, error) = match flatten(mesh, topology, &chart.faces, method) {
                Ok(flat) => (Some(flat), None),
                Err(error) => (None, Some(error.to_string())),
            };
            ChartReport {
                faces: chart.faces.len(),
                area: chart.faces.iter().map(|&f| area(f)).sum::<f64>() / total,
                circumference: chart.arcs.iter().map(|end| lengths[end.arc]).sum(),
                corners: chart.arcs.len(),
                flattening,
                error,
            }
        })
        .collect();
    let corners = segmentation
        .corners
        .iter()
        .map(|corner| CornerReport { vertex: corner.vertex, valence: corner.arcs.len() })
        .collect();
    let widths = segmentation.arc_widths(mesh);
    let arcs = segmentation
        .arcs
        .iter()
        .zip(lengths.iter().zip(widths))
        .map(|(arc, (&length, width))| ArcReport {
            corners: arc.corners,
            charts: [arc.left, arc.right],
            length,
            width,
        })
        .collect();
    SegmentsReport { charts, corners, arcs }
}

fn flatten(
    mesh: &TriMesh,
    topology: &Topology,
    faces: &[u32],
    method: &(dyn Parameterize + Sync),
) -> Result<FlatteningReport, ParamError> {
    let collar = CollarOptions { max_rings: 1, ..CollarOptions::default() };
    let disc = disc_with_collar(mesh, topology, faces, &collar)?;
    let d = Chart::flatten(disc, &method, &Limits::default())?.distortion;
    Ok(FlatteningReport {
        area_ratio: d.area_ratio,
        stretch: d.stretch,
        flips: d.flips,
        overlaps: d.overlaps,
    })
}
