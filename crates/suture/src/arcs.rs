//! Arcs between segmentation and blends: fair polylines on the mesh, the collars that they ask for, and the network of B-splines
//! with the parameters of every arc on both sides.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::BSplineSurface;
use suture_blend::{ArcCurve, ArcEnd, ArcSample, Corner, CornerMaps, Network, WidthOptions};
use suture_mesh::{Topology, TriMesh};
use suture_segment::{FairOptions, MeshPoint, Segmentation, balance_corners, fair_arc, smooth_line};

use crate::SutureError;
use crate::charting::Charted;
use crate::reconstruct::{Fairness, ReconstructOptions};

/// An arc as a polyline on the mesh; the two sides may name different faces for one point.
pub(crate) struct ArcLine {
    left: Vec<MeshPoint>,
    right: Vec<MeshPoint>,
}

/// Bends shorter than this many widths are smoothed away: a strip folds where its arc bends within half of its width, which a bend of
/// three widths does only at an amplitude of half a width.
const FAIR_WIDTHS: f64 = 1.5;

/// How an arc is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drawing {
    /// Multiple of the usual length below which bends are smoothed away.
    straightness: f64,
    /// Where its parameters are: at the foot points on the B-splines, or where the triangles of the charts say. The former are as
    /// smooth as the B-splines, the latter never fold, however far off the B-splines are.
    feet: bool,
}

/// The drawings that are tried in turn where no width fits.
pub(crate) const DRAWINGS: [Drawing; 8] = [
    Drawing { straightness: 1.0, feet: true },
    Drawing { straightness: 0.5, feet: true },
    Drawing { straightness: 1.0, feet: false },
    Drawing { straightness: 3.0, feet: true },
    Drawing { straightness: 0.5, feet: false },
    Drawing { straightness: 3.0, feet: false },
    Drawing { straightness: 0.2, feet: true },
    Drawing { straightness: 0.2, feet: false },
];

/// All arcs as polylines on the mesh, each by the drawing of its number in [`DRAWINGS`]; arcs that leave a corner too close to each other
/// are turned apart.
pub(crate) fn arc_lines(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    options: &ReconstructOptions,
    drawings: &[usize],
) -> Vec<ArcLine> {
    let lines: Vec<ArcLine> = segmentation
        .arcs
        .par_iter()
        .zip(drawings)
        .map(|(arc, &d)| arc_line(mesh, topology, arc, options, DRAWINGS[d].straightness))
        .collect();
    if options.fair == Fairness::Edges {
        return lines;
    }
    let mut fair: Vec<Vec<MeshPoint>> = lines.into_iter().map(|line| line.left).collect();
    let radius = TURNED_WIDTHS * options.widths.wanted * mesh.diagonal();
    balance_corners(mesh, topology, segmentation, &mut fair, radius, LEAST_SECTOR);
    fair.into_iter().map(|line| ArcLine { left: line.clone(), right: line }).collect()
}

/// Arcs are turned apart within this many widths of their corners, up to sectors of this angle: blends reach less than two widths
/// out of a corner with sectors of 50°, and ever farther out of sharper ones.
const TURNED_WIDTHS: f64 = 2.5;
const LEAST_SECTOR: f64 = 50.0 * std::f64::consts::PI / 180.0;

fn arc_line(
    mesh: &TriMesh,
    topology: &Topology,
    arc: &suture_segment::Arc,
    options: &ReconstructOptions,
    straightness: f64,
) -> ArcLine {
    match options.fair {
        Fairness::Fair(fair) => {
            let line = fair_arc(mesh, topology, &arc.vertices, &fairness(mesh, options, fair, straightness));
            ArcLine { left: line.clone(), right: line }
        }
        Fairness::Edges => edge_line(mesh, topology, &arc.vertices),
    }
}

fn fairness(
    mesh: &TriMesh,
    options: &ReconstructOptions,
    fair: FairOptions,
    straightness: f64,
) -> FairOptions {
    let edge = suture_mesh::median_edge_length(mesh);
    let width = FAIR_WIDTHS * options.widths.wanted * mesh.diagonal();
    FairOptions { cutoff: straightness * fair.cutoff.max(width / edge), ..fair }
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
pub(crate) fn collar_widths(
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

pub(crate) fn network(
    mesh: &TriMesh,
    topology: &Topology,
    segmentation: &Segmentation,
    charted: &[Charted],
    lines: Vec<ArcLine>,
    options: &ReconstructOptions,
    drawings: &[usize],
    warnings: &mut Vec<String>,
) -> Result<Network, SutureError> {
    let diagonal = mesh.diagonal();
    let edge = suture_mesh::median_edge_length(mesh);
    // As far as a fit may miss the mesh and still be meant.
    let tolerance = 0.25 * edge;
    let arcs = segmentation
        .arcs
        .iter()
        .zip(lines)
        .enumerate()
        .map(|(a, (arc, line))| {
            let start = segmentation.corners[arc.corners[0]].vertex;
            let Drawing { straightness, feet } = DRAWINGS[drawings[a]];
            let cutoff = (!feet).then_some(straightness * FAIR_WIDTHS * options.widths.wanted * diagonal);
            let sides = |line: &ArcLine| {
                let side = |segment: u32, line: &[MeshPoint]| {
                    parameters(&charted[segment as usize], start, line, tolerance, cutoff)
                };
                Some((side(arc.left, &line.left)?, side(arc.right, &line.right)?))
            };
            // The fairest line whose points both surfaces know; the edges themselves always are.
            let shorter = |part: f64| arc_line(mesh, topology, arc, options, part * straightness);
            let found = sides(&line).map(|sides| (line, sides)).or_else(|| {
                [0.5, 0.25, 0.1].into_iter().find_map(|part| {
                    let line = shorter(part);
                    sides(&line).map(|sides| (line, sides))
                })
            });
            let (line, (left, right)) = match found {
                Some(found) => found,
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
            let reach = segmentation
                .segments(c)
                .iter()
                .map(|&s| charted[s as usize].reach)
                .fold(f64::INFINITY, f64::min);
            Corner {
                arcs: corner.arcs.iter().map(|e| ArcEnd { arc: e.arc, starts: e.forward }).collect(),
                widest: reach / suture_blend::outward_reach(corner.arcs.len()),
            }
        })
        .collect();
    let surfaces = charted.iter().map(|c| Arc::new(c.fit.surface.clone())).collect();
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

/// Parameters of a polyline that starts at mesh vertex `start` on the border of the segment: foot points on its surface. Of several
/// copies of a face in the collar the one that continues the line is meant; where the line leaves the collar the foot points
/// go on from the last one. `None` where they do not find the line within `tolerance`. With a `cutoff` the parameters are those of the
/// triangles, smoothed over that length.
fn parameters(
    charted: &Charted,
    start: u32,
    line: &[MeshPoint],
    tolerance: f64,
    cutoff: Option<f64>,
) -> Option<Vec<DVec2>> {
    let Charted { chart, fit, .. } = charted;
    let disc = &chart.disc;
    let corner = disc
        .faces
        .iter()
        .zip(&disc.in_segment)
        .filter(|(_, inside)| **inside)
        .flat_map(|(face, _)| *face)
        .find(|&v| disc.vertices[v as usize] == start)?;
    let mut at = chart.uv[corner as usize];
    let found: Option<Vec<DVec2>> = line
        .iter()
        .map(|point| {
            let known = chart
                .copies(point.face)
                .map(|copy| chart.at(copy, point.barycentric))
                .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)));
            if let (Some(known), Some(_)) = (known, cutoff) {
                at = known;
                return Some(at);
            }
            let foot = foot_point(&fit.surface, point.position, known.unwrap_or(at));
            let inside = fit.cells.covers(foot);
            at = match known {
                // A foot point that strays says less than the triangle does.
                Some(known) => {
                    if inside {
                        foot
                    } else {
                        known
                    }
                }
                None => foot,
            };
            let found =
                known.is_some() || inside && fit.surface.jet(at).p.distance(point.position) <= tolerance;
            found.then_some(at)
        })
        .collect();
    match cutoff {
        Some(cutoff) => {
            found.map(|line_at| smooth_parameters(&line_at, cutoff * line_at.len() as f64 / length(line)))
        }
        None => found,
    }
}

/// Parameters without the bends shorter than `cutoff` steps; the ends stay.
fn smooth_parameters(line: &[DVec2], cutoff: f64) -> Vec<DVec2> {
    let last = line.len() - 1;
    let targets: Vec<DVec3> = line.iter().map(|p| p.extend(0.0)).collect();
    let weights: Vec<f64> = (0..=last).map(|i| if i == 0 || i == last { 1e12 } else { 1.0 }).collect();
    // As for arcs: a wave of the length of the cutoff is halved.
    let mu = (cutoff / std::f64::consts::TAU).powi(4);
    let mut smooth: Vec<DVec2> =
        smooth_line(&targets, &weights, mu).into_iter().map(|p| p.truncate()).collect();
    (smooth[0], smooth[last]) = (line[0], line[last]);
    smooth
}
