//! From the layout to faces that keep the tolerance: fit, measure, refine the nodes where it is missed, again.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;
use suture_bernstein::BSplineSurface;
use suture_surface::Surface;

use super::brep::{Brep, Coedge, Edge, Face, Geometry, Pcurve};
use super::layout::{Block, Interval, Layout, LayoutEdge, Use, Vertex};
use super::measure::{self, Jump};
use super::{StepOptions, exact, fit, quadric};
use crate::{ExportError, group};

/// Intervals to begin with on half an edge.
const FIRST: usize = 1;

/// Length that no interval falls below, in halves of an edge, for the sake of position, of angles, and of curvatures, which gain the least.
const LEAST: [f64; 3] = [1.0 / 2048.0, 1.0 / 512.0, 1.0 / 256.0];

/// The same where a jump of curvature is beyond its limit.
const LEAST_CURVED: f64 = 1.0 / 1024.0;

/// Into how many parts an interval is divided at most, for the sake of each.
const PARTS: [f64; 3] = [4.0, 3.0, 2.0];

/// How far beyond its limit a jump of curvature may be to get nodes; the next one counts when a class would have too many, as where a patch is
/// nearly singular and no number of them helps.
const HOPES: [f64; 3] = [f64::INFINITY, 8.0, 0.0];

/// How many times the nodes are refined at most.
const ROUNDS: usize = 10;

/// Share of the limits of position, angle and curvature that samples may use: between them it may be worse, the more the rougher it is.
const SAFETY: [f64; 3] = [0.8, 0.8, 0.6];

/// Largest errors found; lengths in units of the surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct Errors {
    pub(crate) position: f64,
    pub(crate) gap: f64,
    pub(crate) angle: f64,
    pub(crate) curvature: f64,
    pub(crate) curvature_at: Option<[String; 2]>,
}

/// A fitted block and how far it is from its patches.
type Fitted = (BSplineSurface<DVec3>, measure::Deviation);

/// Place of an edge in the walk around a face: loop, side or edge, parameter.
type Place = (usize, usize, f64);

/// The faces, and their errors.
///
/// # Errors
/// [`ExportError::StepTolerance`] when no number of nodes within reason keeps the tolerance.
pub(crate) fn refine(
    surface: &Surface,
    options: &StepOptions,
    diagonal: f64,
) -> Result<(Brep, Errors), ExportError> {
    let mut layout = Layout::new(surface, FIRST)?;
    let limit = options.tolerance * diagonal;
    let natural: Vec<Jump> =
        layout.edges.par_iter().map(|edge| measure::natural(surface, &layout, edge, diagonal)).collect();
    let mut fitted: Vec<Option<BSplineSurface<DVec3>>> = vec![None; layout.blocks.len()];
    let mut deviations = vec![measure::Deviation::default(); layout.blocks.len()];
    for round in 0..=ROUNDS {
        // Blocks one by one, in parallel, those that are as they were excepted; the order of results is that of the blocks.
        let fresh: Vec<Result<Option<Fitted>, ExportError>> = (0..layout.blocks.len())
            .into_par_iter()
            .map(|b| {
                if fitted[b].is_some() {
                    return Ok(None);
                }
                let found = fit::fit(surface, &layout, b)?;
                let deviation = measure::block(surface, &layout, &layout.blocks[b], &found);
                Ok(Some((found, deviation)))
            })
            .collect();
        for (b, fresh) in fresh.into_iter().enumerate() {
            if let Some((found, deviation)) = fresh? {
                fitted[b] = Some(found);
                deviations[b] = deviation;
            }
        }
        let brep = assemble(surface, &layout, &fitted)?;
        let uses = uses(&brep);
        let jumps: Vec<Vec<(Option<Interval>, Jump)>> = (0..brep.edges.len())
            .into_par_iter()
            .map(|e| measure::edge(&brep, &layout, e, diagonal, &uses[e]))
            .collect();
        let errors = worst(&brep, &uses, &deviations, &jumps);
        let changed = round < ROUNDS && divide(&mut layout, &deviations, &jumps, &natural, limit, options);
        if !changed {
            let found = errors.position.max(errors.gap);
            if !(found <= limit) {
                return Err(ExportError::StepTolerance { found: found / diagonal, limit: options.tolerance });
            }
            return Ok((brep, errors));
        }
        for (block, fitted) in layout.blocks.iter().zip(&mut fitted) {
            let nodes = layout.nodes(block);
            let counts = nodes.map(|n| n.iter().map(|n| n.len() - 1).sum::<usize>() + 3 + 2 * n.len());
            if fitted.as_ref().is_some_and(|f| f.count() != counts) {
                *fitted = None;
            }
        }
    }
    // The last round changes nothing and returns.
    Err(ExportError::StepTolerance { found: f64::NAN, limit: options.tolerance })
}

/// Divides the intervals whose errors are beyond the limits; whether there were any.
fn divide(
    layout: &mut Layout,
    deviations: &[measure::Deviation],
    jumps: &[Vec<(Option<Interval>, Jump)>],
    natural: &[Jump],
    limit: f64,
    options: &StepOptions,
) -> bool {
    // Of every interval of every class: how far beyond its limit each kind of error is.
    let mut over: Vec<Vec<[f64; 3]>> = layout.classes.iter().map(|c| vec![[0.0; 3]; c.count()]).collect();
    let mut ask = |at: Interval, kind: usize, error: f64, limit: f64| {
        let by = error / (SAFETY[kind] * limit);
        let worst = &mut over[at.class][at.number][kind];
        *worst = if by.is_nan() { f64::INFINITY } else { worst.max(by) };
    };
    for deviation in deviations {
        for &(at, error) in deviation.along_a.iter().chain(&deviation.along_b) {
            ask(at, 0, error, limit);
        }
        let columns = deviation.along_b.len();
        for (cell, &error) in deviation.inside.iter().enumerate() {
            let ((a, in_a), (b, in_b)) =
                (deviation.along_a[cell / columns], deviation.along_b[cell % columns]);
            if in_a.max(in_b) <= SAFETY[0] * limit {
                ask(if in_a > in_b { a } else { b }, 0, error, limit);
            }
        }
    }
    for (edge, natural) in jumps.iter().zip(natural) {
        for &(at, jump) in edge {
            let Some(at) = at else { continue };
            ask(at, 0, jump.gap, limit);
            // No nodes cure what the patches themselves have.
            if natural.angle <= options.angle {
                ask(at, 1, jump.angle, options.angle);
            }
            if natural.curvature <= options.curvature {
                ask(at, 2, jump.curvature, options.curvature);
            }
        }
    }
    let mut changed = false;
    for (class, over) in layout.classes.iter_mut().zip(over) {
        let parts = |worst: f64| -> Vec<usize> {
            let one = |(i, over): (usize, &[f64; 3])| {
                let of = |kind: usize| {
                    // Where knot lines cross, curvatures gain little: the shortest intervals are for places that fail without.
                    let fails = kind == 2 && over[2] * SAFETY[2] > 1.0;
                    let least = if fails { LEAST_CURVED } else { LEAST[kind] };
                    let possible = (class.length(i) / least).floor().min(PARTS[kind]);
                    if over[kind] <= 1.0 || possible < 2.0 || (kind == 2 && over[2] > worst) {
                        return 1;
                    }
                    // Values are met to the third order only, angles to the second, curvatures to the first: the surfaces beneath are
                    // piecewise, and patches are C² where they cross.
                    (1.1 * over[kind].powf([1.0 / 3.0, 0.5, 1.0][kind])).ceil().clamp(2.0, possible) as usize
                };
                (0..3).map(of).fold(1, usize::max)
            };
            over.iter().enumerate().map(one).collect()
        };
        let tries = HOPES.map(parts);
        changed |= tries.iter().any(|parts| class.divide(parts));
    }
    changed
}

/// Of every edge the faces that use it, and the place of the use in the face.
fn uses(brep: &Brep) -> Vec<Vec<(usize, usize)>> {
    let mut uses = vec![Vec::new(); brep.edges.len()];
    for (f, face) in brep.faces.iter().enumerate() {
        for (at, coedge) in face.loops.iter().flatten().enumerate() {
            uses[coedge.edge].push((f, at));
        }
    }
    uses
}

fn worst(
    brep: &Brep,
    uses: &[Vec<(usize, usize)>],
    deviations: &[measure::Deviation],
    jumps: &[Vec<(Option<Interval>, Jump)>],
) -> Errors {
    let nan_max = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
    let all = deviations
        .iter()
        .flat_map(|d| d.along_a.iter().chain(&d.along_b).map(|x| x.1).chain(d.inside.iter().copied()));
    let mut errors = Errors { position: all.fold(0.0, nan_max), ..Errors::default() };
    for (edge, parts) in jumps.iter().enumerate() {
        for (_, jump) in parts {
            errors.gap = nan_max(errors.gap, jump.gap);
            errors.angle = errors.angle.max(jump.angle);
            if jump.curvature > errors.curvature {
                errors.curvature = jump.curvature;
                if let [a, b] = uses[edge][..] {
                    errors.curvature_at = Some([a, b].map(|(f, _)| brep.faces[f].name.clone()));
                }
            }
        }
    }
    errors
}

/// Puts faces, edges and vertices together.
fn assemble(
    surface: &Surface,
    layout: &Layout,
    fitted: &[Option<BSplineSurface<DVec3>>],
) -> Result<Brep, ExportError> {
    let missing = || ExportError::StepTolerance { found: f64::NAN, limit: 0.0 };
    let mut brep = Brep::default();
    let mut vertices: BTreeMap<Vertex, usize> = BTreeMap::new();
    // Per face its uses: loop, place in the walk, and the use itself.
    let first_exact = layout.blocks.len();
    let mut loops: Vec<Vec<(Place, Coedge)>> = vec![Vec::new(); first_exact + layout.exact.len()];
    for (number, edge) in layout.edges.iter().enumerate() {
        let ends = [edge.joints[0], edge.joints[edge.joints.len() - 1]];
        let curve = match &edge.uses[0] {
            Use::Block { block, side, .. } => {
                fit::side(fitted[*block].as_ref().ok_or_else(missing)?, *side, ends)?
            }
            Use::Exact { face, parts } => exact::curve(surface, layout, *face, parts, &edge.joints)?,
        };
        let ids = [0, 1].map(|k| {
            *vertices.entry(edge.ends[k]).or_insert_with(|| {
                brep.vertices.push(if k == 0 { curve.net()[0] } else { curve.net()[curve.net().len() - 1] });
                brep.vertices.len() - 1
            })
        });
        for one in &edge.uses {
            let (face, place, forward, pcurve) = place(layout, edge, one)?;
            let face = if matches!(one, Use::Exact { .. }) { first_exact + face } else { face };
            loops[face].push((place, Coedge { edge: number, forward, pcurve }));
        }
        let plain = |one: &Use| matches!(one, Use::Exact { face, .. } if !matches!(layout.exact[*face].geometry, Geometry::Spline(_)));
        let circle = edge.uses.iter().all(plain).then(|| {
            let points: Vec<DVec3> =
                (0..=16).map(|i| curve.point(ends[0] + (ends[1] - ends[0]) * f64::from(i) / 16.0)).collect();
            quadric::circle(&points)
        });
        brep.edges.push(Edge { ends: ids, curve, circle: circle.flatten() });
    }
    for (f, mut coedges) in loops.into_iter().enumerate() {
        coedges.sort_by(|a, b| (a.0.0, a.0.1).cmp(&(b.0.0, b.0.1)).then(a.0.2.total_cmp(&b.0.2)));
        let mut loops: Vec<Vec<Coedge>> = Vec::new();
        let mut last = None;
        for ((l, ..), coedge) in coedges {
            if last != Some(l) {
                loops.push(Vec::new());
                last = Some(l);
            }
            if let Some(loop_) = loops.last_mut() {
                loop_.push(coedge);
            }
        }
        let (patch, geometry, name, against) = match layout.blocks.get(f) {
            Some(block) => {
                let patch = block.pieces[0].patch;
                let spline = Geometry::Spline(fitted[f].clone().ok_or_else(missing)?);
                (patch, spline, block_name(surface, layout, f, block), false)
            }
            None => {
                let exact = &layout.exact[f - first_exact];
                (
                    exact.patch,
                    exact.geometry.clone(),
                    format!("{} {}", group_name(surface, exact.patch), exact.patch),
                    exact.against,
                )
            }
        };
        let (shell, flipped) = layout.shells[patch];
        let colour = group::group_of(surface.patches()[patch].kind());
        brep.faces.push(Face { geometry, loops, name, colour, shell, flipped, against });
    }
    Ok(brep)
}

fn group_name(surface: &Surface, patch: usize) -> &'static str {
    group::GROUPS[group::group_of(surface.patches()[patch].kind())].name
}

/// `arc 3-9` for the strips of an arc, `nblend 4.2` for the second part of an N-blend, by the numbers of the patches.
fn block_name(surface: &Surface, layout: &Layout, number: usize, block: &Block) -> String {
    let patch = block.pieces[0].patch;
    if block.pieces.len() > 1 {
        let low = block.pieces.iter().map(|p| p.patch).min().unwrap_or(patch);
        let high = block.pieces.iter().map(|p| p.patch).max().unwrap_or(patch);
        return format!("arc {low}-{high}");
    }
    let name = group_name(surface, patch);
    let first = layout.blocks[..number].iter().rev().take_while(|b| b.pieces[0].patch == patch).count();
    if block.height < 1.0 { format!("{name} {patch}.{}", first + 1) } else { format!("{name} {patch}") }
}

/// Face, place in the walk around it, direction and parameter curve of a use of an edge.
fn place(
    layout: &Layout,
    edge: &LayoutEdge,
    one: &Use,
) -> Result<(usize, Place, bool, Option<Pcurve>), ExportError> {
    let start = edge.joints[0];
    match one {
        Use::Block { block, side, ends } => {
            let forward = (ends[1] > ends[0]) == (*side < 2);
            let low = ends[0].min(ends[1]);
            let key = if *side < 2 { low } else { -low };
            let speed = if ends[1] > ends[0] { 1.0 } else { -1.0 };
            let at = |s: f64| layout.blocks[*block].on_side(*side, s);
            let direction = (at(ends[1]) - at(ends[0])).normalize_or_zero();
            // The side's parameter may differ from the edge's by a constant and by direction.
            let origin = at(ends[0] - speed * start);
            Ok((*block, (0, *side, key), forward, Some(Pcurve::Line { origin, direction })))
        }
        Use::Exact { face, parts } => {
            let domain = &layout.domains[layout.exact[*face].patch];
            let forward = parts[0].1[1] > parts[0].1[0];
            let (walked, t) = if forward { parts[0] } else { parts[parts.len() - 1] };
            let loop_ = domain.loops().iter().position(|l| l.contains(&walked)).unwrap_or_default();
            let pcurve = match layout.exact[*face].geometry {
                Geometry::Spline(_) => Some(exact::pcurve(domain, parts, &edge.joints)?),
                _ => None,
            };
            Ok((*face, (loop_, walked, t[0].min(t[1])), forward, pcurve))
        }
    }
}
