//! Arcs between segmentation and blends: fair polylines on the mesh, the collars that they ask for, and the network of B-splines
//! with the parameters of every arc on both sides.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::BSplineSurface;
use suture_blend::{ArcCurve, ArcEnd, ArcSample, Corner, CornerMaps, Network, WidthOptions};
use suture_mesh::{Topology, TriMesh};
use suture_segment::{FairOptions, Fairing, MeshPoint, Segmentation, balance_corners, smooth_line};

use crate::SutureError;
use crate::charting::Charted;
use crate::reconstruct::{Fairness, ReconstructOptions};

/// An arc as a polyline on the mesh; the two sides may name different faces for one point.
#[derive(Clone, Debug, PartialEq)]
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

/// The arcs of a segmentation, drawn again and again: what was drawn before is kept.
pub(crate) struct Drafts<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    segmentation: &'a Segmentation,
    options: &'a ReconstructOptions,
    fairing: Fairing<'a>,
    diagonal: f64,
    /// Per arc its lines by straightness (positive numbers order as their bits do), before corners are balanced.
    lines: Vec<BTreeMap<u64, ArcLine>>,
    /// Per arc the last line and drawing that were located in the charts.
    located: Vec<Option<(ArcLine, Drawing, Located)>>,
}

/// An arc with its parameters on both sides, and what there is to say of it.
#[derive(Clone, Debug)]
struct Located {
    curve: ArcCurve,
    warning: Option<String>,
}

impl<'a> Drafts<'a> {
    pub(crate) fn new(
        fairing: Fairing<'a>,
        mesh: &'a TriMesh,
        topology: &'a Topology,
        segmentation: &'a Segmentation,
        options: &'a ReconstructOptions,
    ) -> Self {
        let count = segmentation.arcs.len();
        let diagonal = mesh.diagonal();
        let (lines, located) = (vec![BTreeMap::new(); count], vec![None; count]);
        Self { mesh, topology, segmentation, options, fairing, diagonal, lines, located }
    }

    /// All arcs as polylines on the mesh, each by the drawing of its number in [`DRAWINGS`]; arcs that leave a corner too close to each
    /// other are turned apart.
    pub(crate) fn lines(&mut self, drawings: &[usize]) -> Vec<ArcLine> {
        let straightness = |a: usize| DRAWINGS[drawings[a]].straightness;
        let missing: Vec<usize> = (0..drawings.len())
            .filter(|&a| !self.lines[a].contains_key(&straightness(a).to_bits()))
            .collect();
        let new: Vec<ArcLine> = missing.par_iter().map(|&a| self.draw(a, straightness(a))).collect();
        for (a, line) in missing.into_iter().zip(new) {
            self.lines[a].insert(straightness(a).to_bits(), line);
        }
        let lines: Vec<ArcLine> =
            (0..drawings.len()).map(|a| self.lines[a][&straightness(a).to_bits()].clone()).collect();
        if self.options.fair == Fairness::Edges {
            return lines;
        }
        let mut fair: Vec<Vec<MeshPoint>> = lines.into_iter().map(|line| line.left).collect();
        let radius = TURNED_WIDTHS * self.options.widths.wanted * self.diagonal;
        balance_corners(self.mesh, self.topology, self.segmentation, &mut fair, radius, LEAST_SECTOR);
        fair.into_iter().map(|line| ArcLine { left: line.clone(), right: line }).collect()
    }

    /// One arc, before corners are balanced.
    fn draw(&self, arc: usize, straightness: f64) -> ArcLine {
        let chain = &self.segmentation.arcs[arc].vertices;
        match self.options.fair {
            Fairness::Fair(fair) => {
                let width = FAIR_WIDTHS * self.options.widths.wanted * self.diagonal;
                let cutoff = straightness * fair.cutoff.max(width / self.fairing.edge());
                let line = self.fairing.arc(chain, &FairOptions { cutoff, ..fair });
                ArcLine { left: line.clone(), right: line }
            }
            Fairness::Edges => edge_line(self.mesh, self.topology, chain),
        }
    }

    /// The charts with all arcs located in them, each by the drawing of its number in [`DRAWINGS`].
    pub(crate) fn network(
        &mut self,
        charted: &[Charted],
        drawings: &[usize],
        warnings: &mut Vec<String>,
    ) -> Result<Network, SutureError> {
        let lines = self.lines(drawings);
        let new: Vec<Option<Result<Located, SutureError>>> = lines
            .par_iter()
            .enumerate()
            .map(|(a, line)| {
                let drawing = DRAWINGS[drawings[a]];
                let known = self.located[a].as_ref().is_some_and(|(l, d, _)| (l, d) == (line, &drawing));
                (!known).then(|| self.locate(a, line, drawing, charted))
            })
            .collect();
        for (a, (line, new)) in lines.into_iter().zip(new).enumerate() {
            if let Some(located) = new {
                self.located[a] = Some((line, DRAWINGS[drawings[a]], located?));
            }
        }
        let located = || self.located.iter().flatten().map(|(_, _, located)| located);
        warnings.extend(located().filter_map(|l| l.warning.clone()));
        let arcs = located().map(|l| l.curve.clone()).collect();
        let corners = (0..self.segmentation.corners.len()).map(|c| self.corner(c, charted)).collect();
        let surfaces = charted.iter().map(|c| Arc::new(c.fit.surface.clone())).collect();
        Ok(Network { surfaces, corners, arcs, diagonal: self.diagonal })
    }

    fn corner(&self, c: usize, charted: &[Charted]) -> Corner {
        let corner = &self.segmentation.corners[c];
        let segments = self.segmentation.segments(c);
        let reach = segments.iter().map(|&s| charted[s as usize].reach).fold(f64::INFINITY, f64::min);
        Corner {
            arcs: corner.arcs.iter().map(|e| ArcEnd { arc: e.arc, starts: e.forward }).collect(),
            widest: reach / suture_blend::outward_reach(corner.arcs.len()),
        }
    }

    /// The parameters of an arc in the charts beside it: of the fairest line whose points both surfaces know; the edges themselves always
    /// are.
    fn locate(
        &self,
        a: usize,
        line: &ArcLine,
        Drawing { straightness, feet }: Drawing,
        charted: &[Charted],
    ) -> Result<Located, SutureError> {
        let arc = &self.segmentation.arcs[a];
        let start = self.segmentation.corners[arc.corners[0]].vertex;
        // As far as a fit may miss the mesh and still be meant.
        let tolerance = 0.25 * self.fairing.edge();
        let cutoff =
            (!feet).then_some(straightness * FAIR_WIDTHS * self.options.widths.wanted * self.diagonal);
        let sides = |line: &ArcLine| {
            let side = |segment: u32, line: &[MeshPoint]| {
                parameters(&charted[segment as usize], start, line, tolerance, cutoff)
            };
            Some((side(arc.left, &line.left)?, side(arc.right, &line.right)?))
        };
        let found = sides(line).map(|sides| (line.clone(), sides)).or_else(|| {
            [0.5, 0.25, 0.1].into_iter().find_map(|part| {
                let line = self.draw(a, part * straightness);
                sides(&line).map(|sides| (line, sides))
            })
        });
        let (line, (left, right), warning) = match found {
            Some((line, sides)) => (line, sides, None),
            None => {
                let line = edge_line(self.mesh, self.topology, &arc.vertices);
                let sides = sides(&line).ok_or_else(|| SutureError::Internal {
                    what: format!("the charts beside arc {a} lack one of its vertices"),
                })?;
                let warning = format!(
                    "arc {a}: its fair curve leaves the charts beside it; the mesh edges are used instead"
                );
                (line, sides, Some(warning))
            }
        };
        let samples = line
            .left
            .iter()
            .zip(left.into_iter().zip(right))
            .map(|(point, (left, right))| ArcSample { position: point.position, left, right })
            .collect();
        let (left, right) = (arc.left as usize, arc.right as usize);
        Ok(Located { curve: ArcCurve { corners: arc.corners, left, right, samples }, warning })
    }
}

/// Arcs are turned apart within this many widths of their corners, up to sectors of this angle: blends reach less than two widths
/// out of a corner with sectors of 50°, and ever farther out of sharper ones.
const TURNED_WIDTHS: f64 = 2.5;
const LEAST_SECTOR: f64 = 50.0 * std::f64::consts::PI / 180.0;

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
