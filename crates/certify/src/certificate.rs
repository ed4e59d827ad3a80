//! The certificate of a whole surface.

use glam::DVec2;
use rayon::prelude::*;
use serde::Serialize;
use suture_surface::{Continuity, EdgeRef, PatchId, PatchKind, Surface};

use crate::region::Region;
use crate::seam::{Side, measure};
use crate::shape::{Shape, regularity};
use crate::{CertifyError, CertifyOptions, SeamReport};

/// How smoothly every seam of a surface joins, and how regular its patches are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// The smallest claim over all seams; `C2` when there are none.
    pub claimed: Continuity,
    /// The smallest order that a seam keeps; `None`: one has a gap. Limits are those of the options.
    ///
    /// Geometry shows tangent planes and curvatures, not parameters: where a seam claims `C1` or `C2` and its tangent planes (and
    /// curvatures) agree, it measures `C1` (`C2`): smooth after the change of parameters that the claim names.
    pub measured: Option<Continuity>,
    /// Largest gap relative to the diagonal.
    pub position: f64,
    /// Largest angle between normals, radians.
    pub normal: f64,
    /// Largest jump of the shape operator relative to the largest curvature beside it.
    pub curvature: f64,
    /// Smallest `|S_u × S_v| / (|S_u| |S_v|)`, over patches and seams.
    pub regularity: f64,
    /// Largest absolute principal curvature, times the diagonal, over patches and seams.
    pub largest_curvature: f64,
    /// One report per seam.
    pub seams: Vec<SeamReport>,
    /// One report per patch.
    pub patches: Vec<PatchReport>,
    /// Number of boundary edges that no seam names.
    pub open_edges: usize,
    /// Where the largest values are.
    pub worst: Worst,
}

/// Seams with the largest jumps and the patch of least regularity; `None` when there is no seam (no patch).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Worst {
    /// Seam with the largest gap.
    pub position: Option<usize>,
    /// Seam with the largest angle.
    pub normal: Option<usize>,
    /// Seam with the largest jump of the shape operator.
    pub curvature: Option<usize>,
    /// Seam that keeps the least of its order.
    pub measured: Option<usize>,
    /// Patch with the smallest regularity inside.
    pub regularity: Option<PatchId>,
    /// Patch with the largest curvature inside.
    pub largest_curvature: Option<PatchId>,
}

/// Regularity and curvature of one patch, sampled over its closed domain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PatchReport {
    /// Kind of the patch.
    pub kind: PatchKind,
    /// Smallest `|S_u × S_v| / (|S_u| |S_v|)`; 0 where the patch is not finite.
    pub regularity: f64,
    /// Where in the domain.
    pub regularity_at: DVec2,
    /// Largest absolute principal curvature times the diagonal, singular points left out.
    pub curvature: f64,
    /// Where in the domain.
    pub curvature_at: DVec2,
    /// First sample without normal and curvature, if any.
    pub singular_at: Option<DVec2>,
}

/// Measures every seam and every patch of `surface`; lengths relative to `diagonal`, that of the input's bounding box.
///
/// Seams and patches are measured in parallel; the result does not depend on the number of threads.
///
/// # Errors
/// [`CertifyError::Diagonal`], [`CertifyError::Option`], [`CertifyError::Limit`]: the arguments. Gaps, singular points and values that
/// are not finite are results.
///
/// ```
/// use suture_certify::{CertifyOptions, certify};
/// use suture_surface::Surface;
///
/// let certificate = certify(&Surface::default(), 1.0, &CertifyOptions::default())?;
/// assert_eq!((certificate.seams.len(), certificate.position), (0, 0.0));
/// # Ok::<(), suture_certify::CertifyError>(())
/// ```
pub fn certify(
    surface: &Surface,
    diagonal: f64,
    options: &CertifyOptions,
) -> Result<Certificate, CertifyError> {
    if !(diagonal.is_finite() && diagonal > 0.0) {
        return Err(CertifyError::Diagonal { value: diagonal });
    }
    options.check()?;
    let regions: Vec<Region> = surface.patches().par_iter().map(|p| Region::new(p.domain())).collect();
    let patches: Vec<PatchReport> = (0..regions.len())
        .into_par_iter()
        .map(|i| inspect(surface, &regions[i], i, diagonal, options.interior))
        .collect();
    let side = |edge: EdgeRef| {
        let patch = surface.patch(edge.patch)?;
        let curve = regions.get(edge.patch.0 as usize)?.domain().edge(edge.edge as usize)?;
        Some(Side { patch, curve })
    };
    // Surface::new refuses seams of missing edges; a patch whose domain changes between calls loses its seam here.
    let seams: Vec<SeamReport> = surface
        .seams()
        .par_iter()
        .filter_map(|&seam| Some(measure(seam, [side(seam.a)?, side(seam.b)?], diagonal, options)))
        .collect();
    let edges: usize = regions.iter().map(|r| r.domain().edge_count()).sum();
    Ok(summary(seams, patches, edges.saturating_sub(2 * surface.seams().len())))
}

fn inspect(surface: &Surface, region: &Region, index: usize, diagonal: f64, n: usize) -> PatchReport {
    let patch = &surface.patches()[index];
    let mut report = PatchReport {
        kind: patch.kind(),
        regularity: 1.0,
        regularity_at: DVec2::ZERO,
        curvature: 0.0,
        curvature_at: DVec2::ZERO,
        singular_at: None,
    };
    for (i, at) in region.samples(n).into_iter().enumerate() {
        let jet = patch.jet(at);
        let regular = regularity(&jet);
        if i == 0 || regular < report.regularity {
            (report.regularity, report.regularity_at) = (regular, at);
        }
        match Shape::of(&jet) {
            Some(shape) => {
                let curvature = shape.curvature() * diagonal;
                if i == 0 || curvature > report.curvature {
                    (report.curvature, report.curvature_at) = (curvature, at);
                }
            }
            None => report.singular_at = report.singular_at.or(Some(at)),
        }
    }
    report
}

fn summary(seams: Vec<SeamReport>, patches: Vec<PatchReport>, open_edges: usize) -> Certificate {
    let worst_seam = |value: fn(&SeamReport) -> f64| first_largest(seams.iter().map(value));
    let patch = |i: usize| PatchId(i as u32);
    let worst = Worst {
        position: worst_seam(|s| s.position.value),
        normal: worst_seam(|s| s.normal.value),
        curvature: worst_seam(|s| s.curvature.value),
        measured: (0..seams.len()).min_by_key(|&i| seams[i].measured),
        regularity: first_largest(patches.iter().map(|p| -p.regularity)).map(patch),
        largest_curvature: first_largest(patches.iter().map(|p| p.curvature)).map(patch),
    };
    let at = |i: Option<usize>, value: fn(&SeamReport) -> f64| i.map_or(0.0, |i| value(&seams[i]));
    let regular = patches.iter().map(|p| p.regularity).chain(seams.iter().map(|s| s.regularity));
    let curved = patches.iter().map(|p| p.curvature).chain(seams.iter().map(|s| s.largest_curvature));
    Certificate {
        claimed: seams.iter().map(|s| s.claimed).min().unwrap_or(Continuity::C2),
        measured: worst.measured.map_or(Some(Continuity::C2), |i| seams[i].measured),
        position: at(worst.position, |s| s.position.value),
        normal: at(worst.normal, |s| s.normal.value),
        curvature: at(worst.curvature, |s| s.curvature.value),
        regularity: regular.fold(1.0, f64::min),
        largest_curvature: curved.fold(0.0, f64::max),
        worst,
        seams,
        patches,
        open_edges,
    }
}

fn first_largest(values: impl Iterator<Item = f64>) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (i, value) in values.enumerate() {
        if best.is_none_or(|(_, largest)| value > largest) {
            best = Some((i, value));
        }
    }
    best.map(|(i, _)| i)
}
