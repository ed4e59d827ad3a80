//! A closed triangle mesh in, a certified C² surface out: the stages in their order, and the plain data between them.

use std::collections::BTreeMap;
use std::time::Instant;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::BSplineSurface;
use suture_blend::{
    ArcCurve, ArcEnd, ArcSample, Blend, Corner, CornerMaps, Correspondence, Network, WidthOptions,
};
use suture_certify::{Certificate, CertifyOptions, Deviation, SurfaceSamples, certify, deviation};
use suture_fit::{Fit, FitInput, FitOptions, FitSurface, Outcome, PenalizedLeastSquares};
use suture_mesh::{Topology, TriMesh};
use suture_param::{Chart, CollarOptions, Limits, Parameterize, Recommended, disc_with_collar};
use suture_segment::{Automatic, FairOptions, MeshPoint, Segment, Segmentation, fair_arcs};
use suture_tessellate::{Tessellation, TessellationOptions, tessellate};

use crate::{Stage, SutureError, Watch};

/// The stages that can be swapped; the defaults are the best ones known.
pub struct Stages<'a> {
    /// Mesh → segments.
    pub segment: Box<dyn Segment + 'a>,
    /// Segment → parameters.
    pub parameterize: Box<dyn Parameterize + Sync + 'a>,
    /// Chart → B-spline.
    pub fit: Box<dyn FitSurface + Sync + 'a>,
    /// B-splines → maps.
    pub maps: Box<dyn CornerMaps + 'a>,
}

impl Default for Stages<'_> {
    fn default() -> Self {
        Self {
            segment: Box::new(Automatic::default()),
            parameterize: Box::new(Recommended::default()),
            fit: Box::new(PenalizedLeastSquares { options: FitOptions::default() }),
            maps: Box::new(Correspondence::default()),
        }
    }
}

/// What a reconstruction is asked for beyond its stages.
#[derive(Clone, Debug, Default)]
pub struct ReconstructOptions {
    /// Widths of the blends.
    pub widths: WidthOptions,
    /// Arcs as fair curves on the mesh; `None` follows the mesh edges, as the paper does.
    pub fair: Fairness,
    /// Fineness of the tessellation.
    pub tessellation: TessellationOptions,
    /// Density and limits of the certificate.
    pub certify: CertifyOptions,
}

/// How arcs are taken from the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fairness {
    /// Along the mesh edges, as the paper does.
    Edges,
    /// As fair curves on the mesh.
    Fair(FairOptions),
}

impl Default for Fairness {
    fn default() -> Self {
        Self::Fair(FairOptions::default())
    }
}

/// A reconstructed surface with every stage's product.
#[derive(Debug)]
pub struct Reconstruction {
    /// Segments, corners and arcs.
    pub segmentation: Segmentation,
    /// Chart of every segment, in the parameters of its B-spline.
    pub charts: Vec<Chart>,
    /// B-spline of every segment, with its report.
    pub fits: Vec<Fit>,
    /// The surface, with the numbers of its making.
    pub blend: Blend,
    /// One watertight mesh of it.
    pub tessellation: Tessellation,
    /// How its seams join.
    pub certificate: Certificate,
    /// How far it lies from the mesh.
    pub deviation: Deviation,
    /// Seconds per stage.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Reconstructs a closed, connected, oriented manifold mesh.
///
/// # Errors
/// [`SutureError`], naming the stage and the segment, arc, corner or face where it stopped.
pub fn reconstruct(
    mesh: &TriMesh,
    stages: &Stages<'_>,
    options: &ReconstructOptions,
    watch: &dyn Watch,
) -> Result<Reconstruction, SutureError> {
    let mut clock = Clock { seconds: BTreeMap::new(), watch };
    let mut warnings = Vec::new();
    let topology = clock.run(Stage::Mesh, 1, || Ok(Topology::build(mesh)?))?;
    let diagonal = mesh.diagonal();
    let segmentation = clock.run(Stage::Segment, 1, || Ok(stages.segment.segment(mesh, &topology)?))?;

    let (charts, fits, reaches, mut lines) = clock.run(Stage::Fit, segmentation.charts.len(), || {
        let lines = arc_lines(mesh, &topology, &segmentation, options, STRAIGHTNESS[0]);
        let collars =
            collar_widths(mesh, &segmentation, &lines, &options.widths, stages.maps.as_ref(), diagonal);
        let sharp = match options.widths.intent {
            suture_blend::Intent::Fidelity => CollarOptions::default().sharp,
            suture_blend::Intent::Fillet => std::f64::consts::PI,
        };
        let context = Charting {
            mesh,
            topology: &topology,
            segmentation: &segmentation,
            parameterize: stages.parameterize.as_ref(),
            fit: stages.fit.as_ref(),
            sharp,
            diagonal,
            edge: suture_mesh::median_edge_length(mesh),
        };
        let charted: Vec<Charted> = (0..segmentation.charts.len())
            .into_par_iter()
            .map(|s| {
                if watch.interrupted() {
                    return Err(SutureError::Interrupted);
                }
                let charted = chart(&context, s, collars[s]);
                watch.step();
                charted
            })
            .collect::<Vec<_>>()
            .into_iter()
            .collect::<Result<_, _>>()?;
        let mut split = (Vec::new(), Vec::new(), Vec::new());
        for Charted { chart, fit, reach } in charted {
            split.0.push(chart);
            split.1.push(fit);
            split.2.push(reach);
        }
        Ok((split.0, split.1, split.2, lines))
    })?;
    let blend = clock.run(Stage::Blend, 1, || {
        // Arcs that no width fits on may fit when they are drawn more or less straight.
        let mut failure = None;
        for (attempt, &straightness) in STRAIGHTNESS.iter().enumerate() {
            let lines = match attempt {
                0 => std::mem::take(&mut lines),
                _ => arc_lines(mesh, &topology, &segmentation, options, straightness),
            };
            let mut notes = Vec::new();
            let network = network(
                mesh,
                &topology,
                &segmentation,
                &charts,
                &fits,
                &reaches,
                lines,
                diagonal,
                &mut notes,
            )?;
            match suture_blend::blend(&network, stages.maps.as_ref(), &options.widths) {
                Ok(blend) => {
                    warnings.append(&mut notes);
                    return Ok(blend);
                }
                Err(error) => failure = failure.or(Some(error)),
            }
            if options.fair == Fairness::Edges {
                break;
            }
        }
        let none = || SutureError::Internal { what: "no way to draw the arcs was tried".into() };
        Err(failure.map_or_else(none, SutureError::from))
    })?;
    let tessellation =
        clock.run(Stage::Tessellate, 1, || Ok(tessellate(&blend.surface, &options.tessellation)?))?;
    let certificate =
        clock.run(Stage::Certify, 1, || Ok(certify(&blend.surface, diagonal, &options.certify)?))?;
    let deviation =
        clock.run(Stage::Deviation, 1, || Ok(deviation(mesh, &blend.surface, &samples(&tessellation))?))?;
    let seconds = clock.seconds;
    Ok(Reconstruction {
        segmentation,
        charts,
        fits,
        blend,
        tessellation,
        certificate,
        deviation,
        seconds,
        warnings,
    })
}

/// A tessellation as the plain data that the deviation is measured on.
pub fn samples(tessellation: &Tessellation) -> SurfaceSamples<'_> {
    SurfaceSamples {
        positions: &tessellation.mesh.positions,
        triangles: &tessellation.mesh.faces,
        triangle_patch: &tessellation.triangle_patch,
        corner_parameters: &tessellation.corner_parameters,
    }
}

struct Clock<'a> {
    seconds: BTreeMap<&'static str, f64>,
    watch: &'a dyn Watch,
}

impl Clock<'_> {
    fn run<T>(
        &mut self,
        stage: Stage,
        steps: usize,
        work: impl FnOnce() -> Result<T, SutureError>,
    ) -> Result<T, SutureError> {
        if self.watch.interrupted() {
            return Err(SutureError::Interrupted);
        }
        self.watch.begin(stage, steps);
        let start = Instant::now();
        let result = work();
        self.seconds.insert(stage.name(), start.elapsed().as_secs_f64());
        result
    }
}

/// An arc as a polyline on the mesh; the two sides may name different faces for one point.
struct ArcLine {
    left: Vec<MeshPoint>,
    right: Vec<MeshPoint>,
}

/// Bends shorter than this many widths are smoothed away: a strip folds where its arc bends within half of its width, which a bend of
/// three widths does only at an amplitude of half a width.
const FAIR_WIDTHS: f64 = 1.5;

/// Multiples of that length that are tried in turn when no width fits.
const STRAIGHTNESS: [f64; 4] = [1.0, 3.0, 0.5, 8.0];

fn arc_lines(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    options: &ReconstructOptions,
    straightness: f64,
) -> Vec<ArcLine> {
    match options.fair {
        Fairness::Fair(fair) => {
            let edge = suture_mesh::median_edge_length(mesh);
            let width = FAIR_WIDTHS * options.widths.wanted * mesh.diagonal();
            let fair = FairOptions { cutoff: straightness * fair.cutoff.max(width / edge), ..fair };
            fair_arcs(mesh, topology, segmentation, &fair)
                .into_iter()
                .map(|line| ArcLine { left: line.clone(), right: line })
                .collect()
        }
        Fairness::Edges => {
            segmentation.arcs.iter().map(|arc| edge_line(mesh, topology, &arc.vertices)).collect()
        }
    }
}

/// The chain of edges itself: its vertices in the faces on either side, so that both charts surely know them.
fn edge_line(mesh: &TriMesh, topology: &Topology, chain: &[u32]) -> ArcLine {
    let side = |left: bool| {
        (0..chain.len())
            .filter_map(|i| {
                let (a, b) =
                    if i + 1 < chain.len() { (chain[i], chain[i + 1]) } else { (chain[i - 1], chain[i]) };
                let h = if left { topology.half_edge(a, b) } else { topology.half_edge(b, a) }?;
                let face = topology.face(h);
                let barycentric = mesh.faces[face as usize].map(|v| if v == chain[i] { 1.0 } else { 0.0 });
                Some(MeshPoint { face, barycentric, position: mesh.positions[chain[i] as usize] })
            })
            .collect()
    };
    ArcLine { left: side(true), right: side(false) }
}

fn length(line: &[MeshPoint]) -> f64 {
    line.windows(2).map(|w| w[0].position.distance(w[1].position)).sum()
}

/// Width of the collar of every segment: how far blends will reach out of it.
fn collar_widths(
    mesh: &TriMesh,
    segmentation: &Segmentation,
    lines: &[ArcLine],
    widths: &WidthOptions,
    maps: &dyn CornerMaps,
    diagonal: f64,
) -> Vec<f64> {
    let valences: Vec<usize> = segmentation.corners.iter().map(|c| c.arcs.len()).collect();
    let given = match (widths.d_in, widths.d_out) {
        (None, None) => None,
        (i, o) => Some(2.0 * i.unwrap_or(0.0).max(o.unwrap_or(0.0)) * diagonal),
    };
    let corner = match given {
        Some(width) => vec![width; valences.len()],
        None => {
            let arcs: Vec<_> = segmentation
                .arcs
                .iter()
                .zip(lines)
                .map(|(arc, line)| (arc.corners, length(&line.left)))
                .collect();
            suture_blend::admissible(&valences, &arcs, widths.wanted * diagonal, |n| maps.reach(n))
        }
    };
    let mut collars = vec![0.0_f64; segmentation.charts.len()];
    for (c, &width) in corner.iter().enumerate() {
        for segment in segmentation.segments(c) {
            let collar = &mut collars[segment as usize];
            *collar = collar.max(width * suture_blend::outward_reach(valences[c]));
        }
    }
    // A fair arc leaves the border of its segments, and the blends go with it.
    let mut shifts = vec![0.0_f64; segmentation.charts.len()];
    for (arc, line) in segmentation.arcs.iter().zip(lines) {
        let chain = |p: DVec3| {
            arc.vertices
                .iter()
                .map(|&v| mesh.positions[v as usize].distance_squared(p))
                .fold(f64::INFINITY, f64::min)
        };
        let shift = line.left.iter().map(|p| chain(p.position)).fold(0.0, f64::max).sqrt();
        for segment in [arc.left, arc.right] {
            let s = &mut shifts[segment as usize];
            *s = s.max(shift);
        }
    }
    collars.iter().zip(shifts).map(|(collar, shift)| collar + shift).collect()
}

/// Most rings of a collar: a bound for meshes whose triangles are tiny against the width of the blends.
const MAX_RINGS: usize = 12;

/// Parts of the wanted collar that are tried in turn; the last one is a single ring.
const COLLARS: [f64; 4] = [1.0, 0.5, 0.25, 0.0];

/// Residual (relative to the diagonal) up to which a fit is good enough to keep a collar.
const GOOD_FIT: f64 = 5e-4;

/// What the charting of all segments shares, measured once.
#[derive(Clone, Copy)]
struct Charting<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    segmentation: &'a Segmentation,
    parameterize: &'a (dyn Parameterize + Sync),
    fit: &'a (dyn FitSurface + Sync),
    /// Dihedral angle that collars do not cross.
    sharp: f64,
    diagonal: f64,
    /// Median edge length.
    edge: f64,
}

/// A segment with its chart, its B-spline, and how far outside the segment that may be used.
struct Charted {
    chart: Chart,
    fit: Fit,
    reach: f64,
}

/// Cuts, flattens and fits a segment with the widest collar that can be fitted well: a collar that runs into a cavity or over a
/// tip spoils the whole chart (spot: residuals of 3e-3 with three rings, 3e-4 with one).
fn chart(context: &Charting<'_>, segment: usize, collar: f64) -> Result<Charted, SutureError> {
    let mut best: Option<(f64, Charted)> = None;
    let mut failure = None;
    for part in COLLARS {
        match collared(context, segment, part * collar) {
            Ok(charted) => {
                let report = &charted.fit.report;
                let sound = report.guard.passed() && charted.chart.distortion.accepted;
                if sound && (report.outcome == Outcome::Tolerance || report.rms <= GOOD_FIT) {
                    return Ok(charted);
                }
                let score = report.rms * if sound { 1.0 } else { UNSOUND };
                if best.as_ref().is_none_or(|(least, _)| score < *least) {
                    best = Some((score, charted));
                }
            }
            Err(error) => failure = failure.or(Some(error)),
        }
    }
    match (best, failure) {
        (Some((_, charted)), _) => Ok(charted),
        (None, Some(error)) => Err(error),
        (None, None) => Err(SutureError::Internal { what: format!("segment {segment} was not charted") }),
    }
}

/// Residuals of charts with flipped samples or too much distortion count this much more.
const UNSOUND: f64 = 4.0;

fn collared(context: &Charting<'_>, segment: usize, collar: f64) -> Result<Charted, SutureError> {
    let Charting { mesh, topology, segmentation, parameterize, fit, .. } = *context;
    let wrong = |source| SutureError::Chart { segment, source };
    let collar_options = CollarOptions { width: collar, max_rings: MAX_RINGS, sharp: context.sharp };
    let disc = disc_with_collar(mesh, topology, &segmentation.charts[segment].faces, &collar_options)
        .map_err(wrong)?;
    let chart = Chart::flatten(disc, &parameterize, &Limits::default()).map_err(wrong)?;
    // A crease or a handle may stop the collar short: there the B-spline continues on its own.
    // Half a knot spacing, about an edge, it does so without harm.
    let reach = collar.max(chart.disc.reach.unwrap_or(0.0)).max(context.edge);
    let input = FitInput {
        points: &chart.disc.positions,
        params: &chart.uv,
        triangles: &chart.disc.faces,
        in_segment: &chart.disc.in_segment,
        diagonal: context.diagonal,
        reach,
    };
    let fit = fit.fit(&input).map_err(|source| SutureError::Fit { segment, source })?;
    let chart = chart.with_uv(fit.params.clone()).map_err(wrong)?;
    Ok(Charted { chart, fit, reach })
}

fn network(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    charts: &[Chart],
    fits: &[Fit],
    reaches: &[f64],
    lines: Vec<ArcLine>,
    diagonal: f64,
    warnings: &mut Vec<String>,
) -> Result<Network, SutureError> {
    let arcs = segmentation
        .arcs
        .iter()
        .zip(lines)
        .enumerate()
        .map(|(a, (arc, line))| {
            let start = segmentation.corners[arc.corners[0]].vertex;
            let sides = |line: &ArcLine| {
                let side = |segment: u32, line: &[MeshPoint]| {
                    let s = segment as usize;
                    let at = parameters(&charts[s], start, line)?;
                    Some(
                        line.iter()
                            .zip(at)
                            .map(|(x, at)| foot_point(&fits[s].surface, x.position, at))
                            .collect::<Vec<_>>(),
                    )
                };
                Some((side(arc.left, &line.left)?, side(arc.right, &line.right)?))
            };
            let (line, (left, right)) = match sides(&line) {
                Some(found) => (line, found),
                None => {
                    warnings.push(format!(
                        "arc {a}: its fair curve leaves the charts beside it; the mesh edges are used instead"
                    ));
                    let line = edge_line(mesh, topology, &arc.vertices);
                    let found = sides(&line).ok_or_else(|| SutureError::Internal {
                        what: format!("the charts beside arc {a} lack one of its vertices"),
                    })?;
                    (line, found)
                }
            };
            let samples = line
                .left
                .iter()
                .zip(left.into_iter().zip(right))
                .map(|(point, (left, right))| ArcSample { position: point.position, left, right })
                .collect();
            let (left, right) = (arc.left as usize, arc.right as usize);
            Ok(ArcCurve { corners: arc.corners, left, right, samples })
        })
        .collect::<Result<_, SutureError>>()?;
    let corners = segmentation
        .corners
        .iter()
        .enumerate()
        .map(|(c, corner)| {
            let reach =
                segmentation.segments(c).iter().map(|&s| reaches[s as usize]).fold(f64::INFINITY, f64::min);
            Corner {
                arcs: corner.arcs.iter().map(|e| ArcEnd { arc: e.arc, starts: e.forward }).collect(),
                widest: reach / suture_blend::outward_reach(corner.arcs.len()),
            }
        })
        .collect();
    let surfaces = fits.iter().map(|f| std::sync::Arc::new(f.surface.clone())).collect();
    Ok(Network { surfaces, corners, arcs, diagonal })
}

/// The parameter of the point of `surface` nearest to `x`, from a guess: Gauss–Newton with halved steps.
///
/// The barycentric parameters of a line are only as smooth as the triangles of the chart, which scatter with the vertices; the
/// foot points of a fair line are as smooth as the surface. Each foot point lies within the guess's own distance of `x`.
fn foot_point(surface: &BSplineSurface<DVec3>, x: DVec3, guess: DVec2) -> DVec2 {
    let mut at = guess;
    let mut jet = surface.jet(at);
    for _ in 0..FOOT_STEPS {
        let gap = x - jet.p;
        let (e, f, g) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        let determinant = e * g - f * f;
        if !(determinant > 1e-12 * e * g) {
            break;
        }
        let (a, b) = (gap.dot(jet.du), gap.dot(jet.dv));
        let mut step = DVec2::new(g * a - f * b, e * b - f * a) / determinant;
        let mut next = surface.jet(at + step);
        while next.p.distance_squared(x) > jet.p.distance_squared(x) && step != DVec2::ZERO {
            step *= 0.5;
            if step.length_squared() <= f64::EPSILON * f64::EPSILON * at.length_squared() {
                return at;
            }
            next = surface.jet(at + step);
        }
        (at, jet) = (at + step, next);
    }
    at
}

/// Steps of a foot point: it converges quadratically where the surface is near, and need not where it is not.
const FOOT_STEPS: usize = 8;

/// Parameters of a polyline that starts at mesh vertex `start` on the border of the segment. Of several copies of a face in the
/// collar the one that continues the line is meant. `None` where a face is not in the chart.
fn parameters(chart: &Chart, start: u32, line: &[MeshPoint]) -> Option<Vec<DVec2>> {
    let disc = &chart.disc;
    let corner = disc
        .faces
        .iter()
        .zip(&disc.in_segment)
        .filter(|(_, inside)| **inside)
        .flat_map(|(face, _)| *face)
        .find(|&v| disc.vertices[v as usize] == start)?;
    let mut at = chart.uv[corner as usize];
    line.iter()
        .map(|point| {
            at = chart
                .copies(point.face)
                .map(|copy| chart.at(copy, point.barycentric))
                .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)))?;
            Some(at)
        })
        .collect()
}
