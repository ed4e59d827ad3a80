//! The report: the contract between this program and every other one. Keys are stable, more may be added.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;
use suture_certify::{Certificate, Deviation, Stats};
use suture_export::StepReport;
use suture_mesh::TriMesh;
use suture_surface::{Continuity, PatchKind, Surface};
use suture_tessellate::Tessellation;

use crate::{Filled, Reconstruction, SegmentsReport, Sewn, SutureError};

/// Version of the report's form: raised when a key changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// What a command found. Lengths are relative to the diagonal of the input's bounding box, angles in radians.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Report {
    /// Version of the program.
    pub suture: String,
    /// Version of the report's form.
    pub schema: u32,
    /// The command.
    pub command: String,
    /// The input as given; none for the built-in shape.
    pub input_file: Option<String>,
    /// The mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<InputReport>,
    /// The patches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceReport>,
    /// The seams.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<CertificateReport>,
    /// The distances.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation: Option<DeviationReport>,
    /// The fits, one per segment.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fits: Vec<FitSummary>,
    /// Of `compare`: one entry per method.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub compared: Vec<Compared>,
    /// Of `segment`: charts, corners and arcs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segments: Option<SegmentsReport>,
    /// The tessellation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tessellation: Option<TessellationReport>,
    /// The STEP file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<StepFileReport>,
    /// Seconds per stage, and in total.
    pub seconds: BTreeMap<String, f64>,
    /// Largest resident memory of the process so far, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// Threads used.
    pub threads: usize,
    /// The settings in force, by name.
    pub settings: serde_json::Map<String, serde_json::Value>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Files written.
    pub outputs: Vec<String>,
    /// Present when the command failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorReport>,
}

/// What one method made of a mesh.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Compared {
    /// Its name.
    pub method: String,
    /// The order that it claims.
    pub claimed: Option<String>,
    /// The order that was measured.
    pub measured: Option<String>,
    /// Patches.
    pub patches: usize,
    /// Patches when the strips of one arc count as one.
    pub patches_merged: usize,
    /// Polynomial degrees in words.
    pub degree: String,
    /// Largest angle between normals across seams.
    pub normal: Option<f64>,
    /// Largest jump of the shape operator relative to the largest curvature beside it.
    pub curvature: Option<f64>,
    /// From the vertices of the mesh to the surface.
    pub mesh_to_surface: Option<DistanceReport>,
    /// From the surface to the facets of the mesh.
    pub surface_to_mesh: Option<DistanceReport>,
    /// Triangles of the tessellation.
    pub triangles: usize,
    /// Seconds from the mesh to the measured surface.
    pub seconds: Option<f64>,
    /// Why there is no result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorReport>,
}

/// The mesh that went in.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct InputReport {
    /// Vertices used by faces.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
    /// Genus of the oriented manifold, none if it is not one.
    pub genus: Option<usize>,
    /// Closed boundary curves.
    pub boundary_loops: usize,
    /// Connected components.
    pub components: usize,
    /// Diagonal of the bounding box, in the units of the file.
    pub diagonal: f64,
}

/// The patches that came out.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct SurfaceReport {
    /// Segments.
    pub charts: usize,
    /// Corners.
    pub corners: usize,
    /// Arcs.
    pub arcs: usize,
    /// Patches by kind.
    pub patches: BTreeMap<String, usize>,
    /// Patches when the strips of one arc count as one.
    pub patches_merged: usize,
    /// Smallest and largest width of a blend.
    pub widths: Option<[f64; 2]>,
    /// Smallest Jacobian of a strip map relative to its largest.
    pub smallest_jacobian: Option<f64>,
    /// Largest distance of two points that a strip blends, in widths of the blend; none without blends.
    pub largest_separation: Option<f64>,
    /// What a method of one patch per face counted and proved, by its own names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub construction: Option<serde_json::Value>,
}

/// The certificate of the seams.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CertificateReport {
    /// The order that the maker of the surface claims, for example `"C2"`.
    pub claimed: String,
    /// The order that was measured; none if even positions disagree.
    pub measured: Option<String>,
    /// Largest gap.
    pub position: f64,
    /// Largest angle between normals.
    pub normal: f64,
    /// Largest jump of the shape operator relative to the largest curvature beside it.
    pub curvature: f64,
    /// Smallest `|S_u × S_v| / (|S_u| |S_v|)`.
    pub regularity: f64,
    /// Largest principal curvature times the diagonal.
    pub largest_curvature: f64,
    /// Number of seams.
    pub seams: usize,
    /// Number of boundary edges of patches that no seam names: none if the surface is closed.
    pub open_edges: usize,
    /// Number of seams that join surfaces of opposite orientation.
    pub turned_seams: usize,
}

/// Distances between mesh and surface.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DeviationReport {
    /// From the vertices of the mesh to the surface: the fidelity.
    pub mesh_to_surface: DistanceReport,
    /// The same without the vertices at knife edges that were moved before fitting; none where none was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unmoved_to_surface: Option<DistanceReport>,
    /// From the surface to the facets of the mesh: their sagitta is its floor.
    pub surface_to_mesh: DistanceReport,
    /// From the vertices to the surface, by the kind of the nearest patch.
    pub kinds: BTreeMap<String, DistanceReport>,
}

/// Statistics of a distance.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct DistanceReport {
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
}

/// The fit of one segment.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FitSummary {
    /// Vertices that were fitted, collar included.
    pub points: usize,
    /// Polynomial pieces in either direction.
    pub cells: [usize; 2],
    /// Root mean square distance of the segment's vertices.
    pub rms: f64,
    /// Largest distance of the segment's vertices.
    pub max: f64,
    /// Why the refinement of knots stopped.
    pub outcome: String,
    /// Largest over smallest ratio of parameter area to area.
    pub area_ratio: f64,
}

/// The tessellation.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct TessellationReport {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// No boundary.
    pub closed: bool,
    /// Every edge has at most two triangles, every vertex one fan.
    pub manifold: bool,
    /// Neighbours agree in orientation.
    pub oriented: bool,
    /// Closed boundary curves.
    pub boundary_loops: usize,
    /// Genus of the oriented manifold, none if it is not one.
    pub genus: Option<usize>,
}

/// What is in a STEP file, and how far it is from the surface.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct StepFileReport {
    /// Faces.
    pub faces: usize,
    /// Edges.
    pub edges: usize,
    /// Vertices.
    pub vertices: usize,
    /// Connected components: a solid each when closed, else a shell.
    pub shells: usize,
    /// Edges of one face only.
    pub open_edges: usize,
    /// Control points of all faces.
    pub control_points: usize,
    /// Largest distance of a face from its patch.
    pub position: f64,
    /// Largest distance between both sides of an edge, parameter for parameter.
    pub gap: f64,
    /// Largest angle between the normals across an edge.
    pub angle: f64,
    /// Largest jump of curvature across an edge, relative to the larger curvature there.
    pub curvature: f64,
    /// The two faces between which the curvature jumps most.
    pub curvature_at: Option<[String; 2]>,
    /// The tolerance that the file states, in its own units.
    pub uncertainty: f64,
    /// The diagonal that lengths are relative to, in the units of the file.
    pub diagonal: f64,
    /// Size of the file.
    pub bytes: usize,
}

/// Why a command failed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ErrorReport {
    /// Stable name of the kind of error.
    pub kind: String,
    /// The message that people read.
    pub message: String,
    /// Where, if it is one place.
    pub at: Option<String>,
}

impl Report {
    /// An empty report of a command.
    pub fn new(command: &str, input: Option<&Path>) -> Self {
        Self {
            suture: env!("CARGO_PKG_VERSION").into(),
            schema: SCHEMA,
            command: command.into(),
            input_file: input.map(|p| p.display().to_string()),
            threads: rayon::current_num_threads(),
            ..Self::default()
        }
    }

    /// Enters the mesh.
    pub fn describe_mesh(&mut self, mesh: &TriMesh) {
        let report = suture_mesh::check(mesh);
        self.input = Some(InputReport {
            vertices: report.vertices - report.isolated.total,
            faces: mesh.faces.len(),
            genus: report.genus,
            boundary_loops: report.boundary_loops.total,
            components: report.components.total,
            diagonal: mesh.diagonal(),
        });
    }

    /// Enters everything that a reconstruction knows.
    pub fn describe_reconstruction(&mut self, r: &Reconstruction, diagonal: f64) {
        let patches = kinds(&r.blend.surface);
        let segmentation = &r.segmentation;
        let (charts, corners, arcs) =
            (segmentation.charts.len(), segmentation.corners.len(), segmentation.arcs.len());
        let widths = &r.blend.widths.corner;
        let low = widths.iter().copied().fold(f64::INFINITY, f64::min);
        let high = widths.iter().copied().fold(0.0, f64::max);
        self.surface = Some(SurfaceReport {
            charts,
            corners,
            arcs,
            patches,
            patches_merged: charts + corners + r.blend.merged_strips,
            widths: Some([low / diagonal, high / diagonal]),
            smallest_jacobian: Some(r.blend.maps.jacobian),
            largest_separation: Some(r.blend.maps.separation),
            construction: None,
        });
        self.fits = r
            .fits
            .iter()
            .zip(&r.charts)
            .map(|(fit, chart)| FitSummary {
                points: fit.params.len(),
                cells: fit.report.cells,
                rms: fit.report.rms,
                max: fit.report.max,
                outcome: format!("{:?}", fit.report.outcome).to_lowercase(),
                area_ratio: chart.distortion.area_ratio,
            })
            .collect();
        self.describe_certificate(&r.certificate);
        self.describe_deviation(&r.deviation);
        if let Some(deviation) = self.deviation.as_mut().filter(|_| !r.moved.is_empty()) {
            let unmoved = |v: &usize| r.moved.binary_search(&(*v as u32)).is_err();
            let left: Vec<f64> = (0..r.deviation.mesh_distances.len())
                .filter(unmoved)
                .map(|v| r.deviation.mesh_distances[v])
                .collect();
            let n = left.len().max(1) as f64;
            deviation.unmoved_to_surface = Some(DistanceReport {
                mean: left.iter().sum::<f64>() / n,
                rms: (left.iter().map(|d| d * d).sum::<f64>() / n).sqrt(),
                max: left.iter().copied().fold(0.0, f64::max),
            });
        }
        self.describe_tessellation(&r.tessellation);
        self.seconds = r.seconds.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
        self.warnings.extend(r.warnings.iter().cloned());
    }

    /// Enters everything that is known of a surface with one patch per face.
    pub fn describe_sewn<R: Serialize>(&mut self, sewn: &Sewn<R>) {
        self.surface = Some(SurfaceReport {
            patches: kinds(&sewn.surface),
            patches_merged: sewn.surface.patches().len(),
            construction: serde_json::to_value(&sewn.report).ok(),
            ..SurfaceReport::default()
        });
        self.describe_certificate(&sewn.certificate);
        self.describe_deviation(&sewn.deviation);
        self.describe_tessellation(&sewn.tessellation);
        self.seconds = sewn.seconds.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
        self.warnings.extend(sewn.warnings.iter().cloned());
    }

    /// Enters everything that is known of fills.
    pub fn describe_filled(&mut self, filled: &Filled) {
        self.surface = Some(SurfaceReport {
            patches: kinds(&filled.surface),
            patches_merged: filled.surface.patches().len(),
            construction: serde_json::to_value(&filled.report).ok(),
            ..SurfaceReport::default()
        });
        self.describe_certificate(&filled.certificate);
        self.describe_tessellation(&filled.tessellation);
        self.seconds = filled.seconds.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
        self.warnings.extend(filled.warnings.iter().cloned());
    }

    /// Enters a certificate.
    pub fn describe_certificate(&mut self, c: &Certificate) {
        self.certificate = Some(CertificateReport {
            claimed: order_name(c.claimed).into(),
            measured: c.measured.map(|m| order_name(m).into()),
            position: c.position,
            normal: c.normal,
            curvature: c.curvature,
            regularity: c.regularity,
            largest_curvature: c.largest_curvature,
            seams: c.seams.len(),
            open_edges: c.open_edges,
            turned_seams: c.seams.iter().filter(|s| s.seam.same_direction).count(),
        });
    }

    /// Enters a deviation.
    pub fn describe_deviation(&mut self, d: &Deviation) {
        let kinds = d
            .kinds
            .iter()
            .filter(|k| k.mesh_to_surface.count > 0)
            .map(|k| (kind_name(k.kind).to_owned(), k.mesh_to_surface))
            .fold(BTreeMap::<String, Stats>::new(), |mut map, (name, stats)| {
                map.entry(name).and_modify(|s| *s = s.merge(&stats)).or_insert(stats);
                map
            });
        self.deviation = Some(DeviationReport {
            mesh_to_surface: distances(&d.mesh_to_surface),
            unmoved_to_surface: None,
            surface_to_mesh: distances(&d.surface_to_mesh),
            kinds: kinds.iter().map(|(name, stats)| (name.clone(), distances(stats))).collect(),
        });
    }

    /// Enters a tessellation, tested as any mesh is.
    pub fn describe_tessellation(&mut self, t: &Tessellation) {
        let check = suture_mesh::check(&t.mesh);
        self.tessellation = Some(TessellationReport {
            vertices: t.mesh.positions.len(),
            triangles: t.mesh.faces.len(),
            closed: check.closed,
            manifold: check.manifold,
            oriented: check.oriented,
            boundary_loops: check.boundary_loops.total,
            genus: check.genus,
        });
    }

    /// Enters a STEP file.
    pub fn describe_step(&mut self, s: &StepReport) {
        self.step = Some(StepFileReport {
            faces: s.faces,
            edges: s.edges,
            vertices: s.vertices,
            shells: s.shells,
            open_edges: s.open_edges,
            control_points: s.control_points,
            position: s.position,
            gap: s.gap,
            angle: s.angle,
            curvature: s.curvature,
            curvature_at: s.curvature_at.clone(),
            uncertainty: s.uncertainty,
            diagonal: s.diagonal,
            bytes: s.bytes,
        });
    }

    /// Enters the error that ended the command.
    pub fn fail(&mut self, error: &SutureError) {
        self.error =
            Some(ErrorReport { kind: error.kind().into(), message: error.to_string(), at: error.at() });
    }

    /// Whether everything that was claimed was also measured: the certificate holds its claim and the tessellation is an oriented
    /// manifold of the input's genus, with the input's boundaries; closed where there is no input and all edges of patches have seams. Surfaces of opposite orientation may be joined.
    pub fn holds(&self) -> bool {
        let rank = |name: &str| ORDERS.iter().position(|&o| order_name(o) == name);
        let certificate = self
            .certificate
            .as_ref()
            .is_none_or(|c| c.measured.as_deref().and_then(rank) >= rank(&c.claimed));
        let tessellation = self.tessellation.is_none_or(|t| {
            let form = match (&self.input, &self.certificate) {
                (Some(i), _) => t.boundary_loops == i.boundary_loops && t.genus == i.genus,
                (None, Some(c)) => t.closed == (c.open_edges == 0),
                (None, None) => t.closed,
            };
            let turned = self.certificate.as_ref().is_some_and(|c| c.turned_seams > 0);
            form && t.manifold && (t.oriented || turned)
        });
        certificate && tessellation && self.error.is_none()
    }
}

/// Patches by kind.
fn kinds(surface: &Surface) -> BTreeMap<String, usize> {
    let mut patches = BTreeMap::new();
    for patch in surface.patches() {
        *patches.entry(kind_name(patch.kind()).to_owned()).or_default() += 1;
    }
    patches
}

fn distances(s: &Stats) -> DistanceReport {
    DistanceReport { mean: s.mean, rms: s.rms, max: s.max }
}

/// The orders of continuity, ascending.
const ORDERS: [Continuity; 5] =
    [Continuity::C0, Continuity::G1, Continuity::C1, Continuity::G2, Continuity::C2];

/// The report's name of an order of continuity.
pub fn order_name(order: Continuity) -> &'static str {
    match order {
        Continuity::C0 => "C0",
        Continuity::G1 => "G1",
        Continuity::C1 => "C1",
        Continuity::G2 => "G2",
        Continuity::C2 => "C2",
        _ => "unknown",
    }
}

/// The report's name of a kind of patch.
pub fn kind_name(kind: PatchKind) -> &'static str {
    match kind {
        PatchKind::Trimmed => "trimmed",
        PatchKind::Strip { .. } | PatchKind::AdjacentStrip => "strip",
        PatchKind::NBlend { .. } => "nblend",
        PatchKind::Face => "face",
        PatchKind::Edge => "edge",
        PatchKind::Planar => "planar",
        PatchKind::Bubble { .. } => "bubble",
        PatchKind::Fill { .. } => "fill",
        PatchKind::Given => "given",
        _ => "other",
    }
}

/// Largest resident memory of this process so far, in bytes, where the system tells.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
