//! Fills of gaps and holes, tessellated and measured.

use std::collections::BTreeMap;
use std::sync::Arc;

use suture_certify::{Certificate, CertifyOptions, certify};
use suture_coons::{
    FillOptions, FillReport, FillSurface, Gap, GapOptions, JoinCertificate, Order, Scene, fill, fill_gaps,
};
use suture_surface::Surface;
use suture_tessellate::{Tessellation, TessellationOptions, tessellate};

use crate::sew::Clock;
use crate::{Stage, SutureError, Watch};

/// What is to be filled.
#[derive(Clone, Debug)]
pub enum Unfilled {
    /// What a scene says.
    Scene(Scene),
    /// Gaps of a surface: those named, or those found.
    Surface {
        /// The surface.
        surface: Arc<Surface>,
        /// The gaps; `None`: those that are found.
        gaps: Option<Vec<Gap>>,
    },
}

/// Given patches and fills as one surface, tessellated and measured.
#[derive(Debug)]
pub struct Filled {
    /// The given patches, then the fills, with the seams between them.
    pub surface: Surface,
    /// How every fill joins, from its own corners and edges.
    pub report: FillReport,
    /// One mesh of the surface.
    pub tessellation: Tessellation,
    /// How the seams join.
    pub certificate: Certificate,
    /// Seconds per stage.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Filled {
    /// Whether every fill reached the order that was asked for.
    pub fn complete(&self) -> bool {
        self.report.fills.iter().all(|f| f.reached() == Some(f.asked))
    }
}

/// Fills gaps and holes ([`suture_coons`]), tessellates and measures the whole. Gaps are sought only where none are named.
///
/// # Errors
/// [`SutureError::Fill`], naming the fill, the edge, the side and the order; [`SutureError::Interrupted`].
pub fn fill_and_measure(
    what: Unfilled,
    options: &FillOptions,
    search: &GapOptions,
    tessellation: &TessellationOptions,
    watch: &dyn Watch,
) -> Result<Filled, SutureError> {
    let mut clock = Clock { seconds: BTreeMap::new(), watch };
    let FillSurface { surface, report } = clock.run(Stage::Patches, || {
        Ok(match what {
            Unfilled::Scene(scene) if scene.fills.is_empty() => fill(&scene.with_gaps(search)?, options)?,
            Unfilled::Scene(scene) => fill(&scene, options)?,
            Unfilled::Surface { surface, gaps } => fill_gaps(surface, gaps.as_deref(), options, search)?,
        })
    })?;
    let tessellation = clock.run(Stage::Tessellate, || Ok(tessellate(&surface, tessellation)?))?;
    let diagonal = tessellation.mesh.diagonal();
    let certificate =
        clock.run(Stage::Certify, || Ok(certify(&surface, diagonal, &CertifyOptions::default())?))?;
    let seconds = clock.seconds;
    let warnings = warnings(&surface, &report);
    Ok(Filled { surface, report, tessellation, certificate, seconds, warnings })
}

fn warnings(surface: &Surface, report: &FillReport) -> Vec<String> {
    let mut all = Vec::new();
    for (number, fill) in report.fills.iter().enumerate() {
        let moved = fill.moved[0].max(fill.moved[1]);
        if moved > 0.0 {
            all.push(format!(
                "fill {number}: its border curves were moved by {moved:.1e} of the diagonal, so that they join"
            ));
        }
        if let JoinCertificate::Split(c) = &fill.certificate
            && c.reached != Order::G1
        {
            let corner = c.corners.iter().copied().fold(0.0, f64::max);
            all.push(format!(
                "fill {number}: reaches {:?} only; tangent planes at its corners differ by up to {corner:.1e} rad",
                c.reached
            ));
        }
        if let JoinCertificate::Hole(c) = &fill.certificate
            && let Some(tip) = c.tip.filter(|t| t.aslant > 1e-6)
        {
            all.push(format!(
                "fill {number}: its tip is that of a cone (up to {:.2} out of the tangent plane), not smooth there",
                tip.aslant
            ));
        }
    }
    let turned = surface.seams().iter().filter(|s| s.same_direction).count();
    if turned > 0 {
        all.push(format!(
            "{turned} seams join surfaces of opposite orientation; shading shows their other side"
        ));
    }
    all
}
