//! STEP: a boundary representation that CAD systems read.

mod brep;
mod entities;
mod exact;
mod fit;
mod layout;
mod measure;
mod part21;
mod quadric;
mod quintic;
mod refine;

use glam::DVec3;
use suture_surface::Surface;

use crate::ExportError;

/// Smallest uncertainty that OpenCASCADE tells from zero, in units of the file.
const LEAST_UNCERTAINTY: f64 = 1e-7;

/// How a surface becomes a STEP file.
#[derive(Clone, Debug)]
pub struct StepOptions {
    /// Largest distance of any face from its patch, and of the two sides of any edge from each other, relative to the diagonal. Knots are
    /// refined until it holds.
    pub tolerance: f64,
    /// Largest angle in radians between the normals on both sides of an edge for which knots are refined. Edges along which the patches
    /// themselves do not join tangentially keep their angles.
    pub angle: f64,
    /// Largest jump of curvature across an edge, relative to the larger curvature, for which knots are refined.
    pub curvature: f64,
    /// What lengths are relative to; without it the diagonal of the box around the borders of the patches.
    pub diagonal: Option<f64>,
    /// Name of the product.
    pub name: String,
    /// Unit of the coordinates.
    pub unit: LengthUnit,
    /// The time that the file gives as that of its making, as ISO 8601 has it. Fixed by default: the same surface gives the same bytes.
    pub time: String,
}

impl Default for StepOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            angle: 0.01f64.to_radians(),
            curvature: 0.01,
            diagonal: None,
            name: "suture".into(),
            unit: LengthUnit::Millimetre,
            time: "1970-01-01T00:00:00".into(),
        }
    }
}

/// The unit of the coordinates of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// 10⁻⁶ m.
    Micrometre,
    /// 10⁻³ m, what CAD systems take for granted.
    #[default]
    Millimetre,
    /// 10⁻² m.
    Centimetre,
    /// The metre.
    Metre,
}

impl LengthUnit {
    fn prefix(self) -> Option<&'static str> {
        match self {
            Self::Micrometre => Some("MICRO"),
            Self::Millimetre => Some("MILLI"),
            Self::Centimetre => Some("CENTI"),
            Self::Metre => None,
        }
    }
}

/// What is in a STEP file and how far it is from the surface. Lengths are relative to the diagonal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepReport {
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
    /// Largest distance between the curve of an edge and the same parameter on either face, or between the faces.
    pub gap: f64,
    /// Largest angle between the normals across an edge, in radians.
    pub angle: f64,
    /// Largest jump of curvature across an edge, relative to the larger curvature there.
    pub curvature: f64,
    /// The edge where the curvature jumps most: the faces on both sides, by their names in the file.
    pub curvature_at: Option<[String; 2]>,
    /// The tolerance that the file states, in its units.
    pub uncertainty: f64,
    /// The diagonal that lengths are relative to.
    pub diagonal: f64,
    /// Size of the file.
    pub bytes: usize,
}

/// The surface as a STEP file (AP214), with what it contains and how exact it is.
///
/// Trimmed B-splines leave exactly as they are, cut to the part that is used. The strips of an arc become one biquintic face, an N-blend N
/// four-sided ones. Both sides of an edge have the same curve, and a curve in the parameters of either face.
///
/// # Errors
/// [`ExportError::StepPatch`] for patches without a form in STEP, [`ExportError::StepTolerance`] when the tolerance cannot be kept,
/// [`ExportError::Spline`] when the surface is not finite.
pub fn to_step(surface: &Surface, options: &StepOptions) -> Result<(Vec<u8>, StepReport), ExportError> {
    let diagonal = match options.diagonal {
        Some(d) if d > 0.0 && d.is_finite() => d,
        _ => diagonal(surface),
    };
    let (brep, errors) = refine::refine(surface, options, diagonal)?;
    let worst = errors.position.max(errors.gap);
    let uncertainty = (2.0 * worst).max(LEAST_UNCERTAINTY);
    let mut report = StepReport {
        faces: brep.faces.len(),
        edges: brep.edges.len(),
        vertices: brep.vertices.len(),
        shells: brep.faces.iter().map(|f| f.shell + 1).max().unwrap_or(0),
        open_edges: brep.open_edges(),
        control_points: brep.control_points(),
        position: errors.position / diagonal,
        gap: errors.gap / diagonal,
        angle: errors.angle,
        curvature: errors.curvature,
        curvature_at: errors.curvature_at,
        uncertainty,
        diagonal,
        bytes: 0,
    };
    let about = entities::About {
        name: &options.name,
        prefix: options.unit.prefix(),
        uncertainty,
        time: &options.time,
    };
    let bytes = entities::file(&brep, &about).into_bytes();
    report.bytes = bytes.len();
    Ok((bytes, report))
}

/// The diagonal of the box around points on all borders.
fn diagonal(surface: &Surface) -> f64 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for patch in surface.patches() {
        let domain = patch.domain();
        for edge in (0..domain.edge_count()).filter_map(|e| domain.edge(e)) {
            for t in [0.0, 0.25, 0.5, 0.75] {
                let p = patch.jet(edge.point(t)).p;
                if p.is_finite() {
                    (low, high) = (low.min(p), high.max(p));
                }
            }
        }
    }
    let diagonal = (high - low).length();
    if diagonal > 0.0 && diagonal.is_finite() { diagonal } else { 1.0 }
}
