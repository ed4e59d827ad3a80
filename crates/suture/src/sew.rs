//! The methods that sew one patch per face: A-patches and bubble splines, tessellated and measured.

use std::collections::BTreeMap;
use std::time::Instant;

use glam::DVec3;
use suture_apatch::{ApatchOptions, ApatchReport, apatch};
use suture_bubble::spline::{SplineOptions, SplineSurface, spline_surface};
use suture_bubble::{BubbleOptions, BubbleReport, BubbleSurface, PolyMesh, bubble, bubble_creased};
use suture_certify::{Certificate, CertifyOptions, Deviation, SeamReport, certify, deviation};
use suture_mesh::normals::{AngleWeighted, AreaWeighted, EstimateNormals, LoopLimit, QuadricFit};
use suture_mesh::{Topology, TriMesh};
use suture_surface::{Continuity, Patch, Surface};
use suture_tessellate::Tessellation;

use crate::{Stage, SutureError, Watch, samples};

/// A surface with one patch per face, tessellated and measured; `R` is what its method reports.
#[derive(Debug)]
pub struct Sewn<R> {
    /// The patches and their seams.
    pub surface: Surface,
    /// What the method counted and proved.
    pub report: R,
    /// One watertight mesh of the surface.
    pub tessellation: Tessellation,
    /// Of A-patches the tetrahedra that they live in, and whether each belongs to an edge; empty for other methods.
    pub hull: Vec<([DVec3; 4], bool)>,
    /// How the seams join.
    pub certificate: Certificate,
    /// How far the surface lies from the mesh.
    pub deviation: Deviation,
    /// Seconds per stage.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Where the normals of vertices come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NormalSource {
    /// From the mesh if it has them, else [`Loop`](Self::Loop).
    #[default]
    Best,
    /// From the mesh.
    Mesh,
    /// Those of the limit surface of Loop's subdivision.
    Loop,
    /// Mean of the faces' normals, weighted by their angles.
    Angle,
    /// Mean of the faces' normals, weighted by their areas.
    Area,
    /// Gradients of quadrics fitted to the surroundings: of one scale on quadrics, which A-patches then reproduce.
    Quadric,
}

impl NormalSource {
    /// Whether the normals of a mesh from this source are estimates.
    pub fn estimates(self, mesh: &TriMesh) -> bool {
        match self {
            Self::Best => mesh.normals.is_none(),
            Self::Mesh => false,
            Self::Loop | Self::Angle | Self::Area | Self::Quadric => true,
        }
    }
}

/// One normal per vertex; zero at vertices without faces where they are estimated. Lengths are those of the source.
///
/// # Errors
/// [`SutureError::Unsuitable`] where the mesh has none and must, [`SutureError::Topology`], [`SutureError::Normals`].
pub fn vertex_normals(mesh: &TriMesh, source: NormalSource) -> Result<Vec<DVec3>, SutureError> {
    let estimator: &dyn EstimateNormals = match (source, &mesh.normals) {
        (NormalSource::Best | NormalSource::Mesh, Some(normals)) => return Ok(normals.clone()),
        (NormalSource::Mesh, None) => {
            let what = "the mesh has no normals; have them estimated (leave --normals away)".into();
            return Err(SutureError::Unsuitable { what });
        }
        (NormalSource::Best | NormalSource::Loop, _) => &LoopLimit,
        (NormalSource::Angle, _) => &AngleWeighted,
        (NormalSource::Area, _) => &AreaWeighted,
        (NormalSource::Quadric, _) => &QuadricFit::default(),
    };
    Ok(estimator.estimate(mesh, &Topology::build(mesh)?)?)
}

/// How a surface with one patch per face is tessellated and measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SewOptions {
    /// Segments along every edge of the mesh, `1..=1024`. `None`: 12 on small meshes, fewer on large ones, so that there are about half a
    /// million triangles at most where two segments allow it.
    pub resolution: Option<usize>,
    /// Density and limits of the certificate. `None`: those of [`CertifyOptions::default`], fewer samples per seam beyond 20,000 faces.
    pub certify: Option<CertifyOptions>,
}

impl SewOptions {
    fn resolution(&self, faces: usize) -> usize {
        self.resolution.unwrap_or_else(|| ((300_000 / faces.max(1)).isqrt()).clamp(2, 12))
    }

    fn certify(&self, faces: usize) -> CertifyOptions {
        let few = CertifyOptions { samples: 5, refinements: 2, interior: 3, ..CertifyOptions::default() };
        let default = || if faces > MANY { few } else { CertifyOptions::default() };
        self.certify.clone().unwrap_or_else(default)
    }
}

/// Beyond this number of faces, seams are so many that a few samples on each tell what many would.
const MANY: usize = 20_000;

/// A C¹ implicit surface over a mesh with normals: one patch per face and edge ([`suture_apatch`]), tessellated and measured.
///
/// # Errors
/// [`SutureError`], naming the face, edge or vertex; [`SutureError::Interrupted`].
pub fn sew_apatch(
    mesh: &TriMesh,
    normals: &[DVec3],
    apatches: &ApatchOptions,
    options: &SewOptions,
    watch: &dyn Watch,
) -> Result<Sewn<ApatchReport>, SutureError> {
    let mut clock = Clock { seconds: BTreeMap::new(), watch };
    let (implicit, surface) = clock.run(Stage::Patches, || {
        let implicit = apatch(mesh, normals, apatches)?;
        let surface = implicit.surface()?;
        Ok((implicit, surface))
    })?;
    let n = options.resolution(implicit.mesh().faces.len());
    let (tessellation, missed) = clock.run(Stage::Tessellate, || {
        let t = implicit.tessellate(n, n.div_ceil(4))?;
        let missed = t.missed;
        let (mesh, vertex_patch, vertex_parameter) = (t.mesh, t.vertex_patch, t.vertex_parameter);
        let (triangle_patch, corner_parameters) = (t.triangle_patch, t.corner_parameters);
        Ok((Tessellation { mesh, vertex_patch, vertex_parameter, triangle_patch, corner_parameters }, missed))
    })?;
    let mut warnings = Vec::new();
    if missed > 0 {
        warnings.push(format!("{missed} points of the tessellation lie on rays without a simple root"));
    }
    let report = implicit.report().clone();
    warnings.extend(doubts(&report, implicit.parents()));
    let sewn = measure(mesh, surface, report, tessellation, warnings, options, clock)?;
    Ok(Sewn { hull: crate::page::hull(&implicit), ..sewn })
}

/// What an A-patch surface could not prove, in words. Faces are those of the input.
fn doubts(r: &ApatchReport, parents: &[u32]) -> Vec<String> {
    let mut all = Vec::new();
    let parent = |f: u32| parents.get(f as usize).copied().unwrap_or(f);
    let mut faces = |list: &[u32], what: &str| {
        if let Some(&first) = list.first() {
            all.push(format!(
                "{} faces (the first in face {} of the input) {what}",
                list.len(),
                parent(first)
            ));
        }
    };
    faces(&r.steep_faces, "have normals too steep for a tetrahedron of the wanted height");
    faces(&r.violated_faces, "have rays that meet the surface more than once or not at all");
    let open: Vec<u32> = r.unproven_faces.iter().filter(|f| !r.violated_faces.contains(f)).copied().collect();
    faces(&open, "are not proven to be single-sheeted, though nothing contradicts it");
    let mut edges = |list: &[[u32; 2]], what: &str| {
        if let Some([a, b]) = list.first() {
            all.push(format!("{} edges (the first {a} → {b}) {what}", list.len()));
        }
    };
    edges(&r.bad_edges, "have tetrahedra that meet those beside them: the surface may fold there");
    edges(&r.violated_edges, "have rays that meet the surface more than once or not at all");
    let open: Vec<[u32; 2]> =
        r.unproven_edges.iter().filter(|e| !r.violated_edges.contains(e)).copied().collect();
    edges(&open, "are not proven to be single-sheeted, though nothing contradicts it");
    edges(
        &r.turned_edges,
        "were turned to the other diagonal of the faces beside them, which were folded or left no room",
    );
    if let Some(v) = r.estimated_again.first() {
        all.push(format!(
            "the normals of {} vertices (the first {v}) were estimated again, with regard to the faces that they stood against",
            r.estimated_again.len()
        ));
    }
    if r.refinements > 0 {
        all.push(format!(
            "the mesh was refined locally from {} to {} faces, so that tetrahedra do not meet",
            r.input_faces, r.faces
        ));
    }
    if let Some(i) = r.intersections.as_ref().filter(|i| i.pairs > 0) {
        all.push(format!("{} pairs of tetrahedra that are not neighbours intersect", i.pairs));
    }
    all
}

/// A bubble surface of order `G⁰` to `G⁴` over a mesh with normals: one patch per face ([`suture_bubble`]), tessellated and measured. The
/// lengths of the normals do not matter.
///
/// # Errors
/// [`SutureError`], naming the face, edge or vertex; [`SutureError::Interrupted`].
pub fn sew_bubble(
    mesh: &TriMesh,
    normals: &[DVec3],
    bubbles: &BubbleOptions,
    options: &SewOptions,
    watch: &dyn Watch,
) -> Result<Sewn<BubbleReport>, SutureError> {
    sew_creased(mesh, normals, &[], bubbles, options, watch)
}

/// As [`sew_bubble`], with creases along the edges `creases` (pairs of vertices): there the patches share a curve and no more.
///
/// # Errors
/// As [`sew_bubble`]; an edge that the mesh does not have.
pub fn sew_creased(
    mesh: &TriMesh,
    normals: &[DVec3],
    creases: &[[u32; 2]],
    bubbles: &BubbleOptions,
    options: &SewOptions,
    watch: &dyn Watch,
) -> Result<Sewn<BubbleReport>, SutureError> {
    let mut clock = Clock { seconds: BTreeMap::new(), watch };
    let built = clock.run(Stage::Patches, || lay(mesh, normals, creases, bubbles))?;
    let n = options.resolution(mesh.faces.len());
    let tessellation = clock.run(Stage::Tessellate, || triangulate(&built, n))?;
    let report = built.report().clone();
    let warnings = report.warnings.iter().map(ToString::to_string).collect();
    let mut sewn = measure(mesh, built.into_surface()?, report, tessellation, warnings, options, clock)?;
    let note = creased(&sewn);
    sewn.warnings.extend(note);
    Ok(sewn)
}

/// What is reported of a bubble surface in splines.
#[derive(Debug, serde::Serialize)]
pub struct SplinedReport {
    /// Of the surface whose boundary data were splined.
    #[serde(flatten)]
    pub bubble: BubbleReport,
    /// Intervals along every edge.
    pub intervals: usize,
    /// Largest distance across seams, relative to the diagonal.
    pub seam_position: f64,
    /// Largest angle of the normals across seams other than creases, radians.
    pub seam_angle: f64,
}

/// As [`sew_creased`], with cubic splines for boundary data ([`suture_bubble::spline`]): patches are tensor-product B-splines, and normals agree across
/// seams to within an angle that is measured. `take` sees the patches before anything is measured, for their nets.
///
/// # Errors
/// As [`sew_creased`]; orders above 2; those of `take`.
pub fn sew_splined(
    mesh: &TriMesh,
    normals: &[DVec3],
    creases: &[[u32; 2]],
    (bubbles, splines): (&BubbleOptions, &SplineOptions),
    options: &SewOptions,
    watch: &dyn Watch,
    take: impl FnOnce(&SplineSurface) -> Result<(), SutureError>,
) -> Result<Sewn<SplinedReport>, SutureError> {
    let mut clock = Clock { seconds: BTreeMap::new(), watch };
    let (built, splined) = clock.run(Stage::Patches, || {
        let built = lay(mesh, normals, creases, bubbles)?;
        let splined = spline_surface(&built, splines)?;
        take(&splined)?;
        Ok((built, splined))
    })?;
    let n = options.resolution(mesh.faces.len());
    let tessellation = clock.run(Stage::Tessellate, || {
        let mut t = triangulate(&built, n)?;
        let points = t.vertex_patch.iter().zip(&t.vertex_parameter);
        for ((p, (patch, &at)), n) in
            t.mesh.positions.iter_mut().zip(points).zip(t.mesh.normals.iter_mut().flatten())
        {
            let jet = splined.patches[patch.0 as usize].jet(at);
            *p = jet.p;
            *n = jet.normal().unwrap_or(*n);
        }
        Ok(t)
    })?;
    let bubble = built.report().clone();
    let mut warnings: Vec<String> = bubble.warnings.iter().map(ToString::to_string).collect();
    let (intervals, seam_angle) = (splined.intervals, splined.normal);
    let seam_position = splined.position / mesh.diagonal();
    warnings.push(format!(
        "boundary data are splines of {intervals} intervals: normals agree to {:.1e}° across seams, and C0 is all that is claimed",
        seam_angle.to_degrees()
    ));
    let report = SplinedReport { bubble, intervals, seam_position, seam_angle };
    measure(mesh, splined.into_surface()?, report, tessellation, warnings, options, clock)
}

fn lay(
    mesh: &TriMesh,
    normals: &[DVec3],
    creases: &[[u32; 2]],
    bubbles: &BubbleOptions,
) -> Result<BubbleSurface, SutureError> {
    // Zero and what is not finite stay, to be named.
    let unit: Vec<DVec3> = normals.iter().map(|n| n.try_normalize().unwrap_or(*n)).collect();
    let poly = PolyMesh::from_triangles(mesh, &unit)?;
    let laid =
        if creases.is_empty() { bubble(&poly, bubbles) } else { bubble_creased(&poly, creases, bubbles) };
    Ok(laid?)
}

fn triangulate(surface: &BubbleSurface, n: usize) -> Result<Tessellation, SutureError> {
    let t = surface.tessellate(n)?;
    let (mesh, vertex_patch, vertex_parameter) = (t.mesh, t.vertex_patch, t.vertex_parameter);
    let (triangle_patch, corner_parameters) = (t.triangle_patch, t.corner_parameters);
    Ok(Tessellation { mesh, vertex_patch, vertex_parameter, triangle_patch, corner_parameters })
}

/// What the certificate says away from creases, whose claim is the smallest.
fn creased(sewn: &Sewn<BubbleReport>) -> Option<String> {
    let smooth = || sewn.certificate.seams.iter().filter(|s| s.claimed > Continuity::C0);
    let worst = |value: fn(&SeamReport) -> f64| smooth().map(value).fold(0.0, f64::max);
    let least = smooth().map(|s| s.measured).min()?;
    let measured = least.map_or("nothing".into(), |c| format!("{c:?}"));
    let (normal, curvature) = (worst(|s| s.normal.value), worst(|s| s.curvature.value));
    (sewn.report.creases > 0).then(|| {
        format!(
            "{} creases claim no more than C0; away from them {measured} is measured over {} seams: normal {normal:.1e} rad, curvature {curvature:.1e}",
            sewn.report.creases,
            smooth().count(),
        )
    })
}

fn measure<R>(
    mesh: &TriMesh,
    surface: Surface,
    report: R,
    tessellation: Tessellation,
    warnings: Vec<String>,
    options: &SewOptions,
    mut clock: Clock<'_>,
) -> Result<Sewn<R>, SutureError> {
    let density = options.certify(mesh.faces.len());
    let certificate = clock.run(Stage::Certify, || Ok(certify(&surface, mesh.diagonal(), &density)?))?;
    let deviation =
        clock.run(Stage::Deviation, || Ok(deviation(mesh, &surface, &samples(&tessellation))?))?;
    let seconds = clock.seconds;
    let hull = Vec::new();
    Ok(Sewn { surface, report, tessellation, hull, certificate, deviation, seconds, warnings })
}

/// Times the stages and tells of them.
pub(crate) struct Clock<'a> {
    pub(crate) seconds: BTreeMap<&'static str, f64>,
    pub(crate) watch: &'a dyn Watch,
}

impl Clock<'_> {
    pub(crate) fn run<T>(
        &mut self,
        stage: Stage,
        work: impl FnOnce() -> Result<T, SutureError>,
    ) -> Result<T, SutureError> {
        if self.watch.interrupted() {
            return Err(SutureError::Interrupted);
        }
        self.watch.begin(stage, 1);
        let start = Instant::now();
        let result = work()?;
        self.watch.step();
        self.seconds.insert(stage.name(), start.elapsed().as_secs_f64());
        Ok(result)
    }
}
