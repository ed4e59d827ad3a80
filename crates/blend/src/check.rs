//! Are the maps of a network usable: no fold, no ring that crosses itself, nothing outside the domain of a B-spline?

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::{BSplineSurface, BezierPatch, Jet2};
use suture_surface::PatchKind;

use crate::assemble::trimming_loop;
use crate::maps::{MapSet, StripMaps};
use crate::patches::{NBlend, Strip};
use crate::{ArcCurve, BlendError, Network, gon, weights};

/// Samples across a strip; three times as many along it.
const SAMPLES: usize = 8;
/// Samples per edge of a trimming loop.
const LOOP_SAMPLES: usize = 32;

/// Smallest Jacobian of a strip map relative to its largest: what 25 × 9 samples may miss of a fold is small against it.
pub(crate) const LEAST_JACOBIAN: f64 = 0.02;
/// The same where narrower blends are worth trying: the curvature grows like its inverse square.
const GOOD_JACOBIAN: f64 = 0.1;

/// Smallest area element of a blend relative to those of the surfaces it blends.
const LEAST_AREA: f64 = 0.2;

/// Largest distance of two points that are blended, in widths, beyond what the surfaces are apart on the arc itself. At a crease of
/// 130° it is 1.2 widths.
const MOST_APART: f64 = 2.0;

/// A map that cannot be used, with the corners whose widths it depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What is wrong, and where.
    pub error: BlendError,
    /// The corners whose widths could be reduced.
    pub corners: Vec<usize>,
    /// The arc whose chain folds, if that is what is wrong.
    pub chain: Option<usize>,
    /// The arcs that could be drawn differently.
    pub arcs: Vec<usize>,
}

impl Obstacle {
    /// Whether a surface with this obstacle is ugly but one: to be removed by narrower blends or other arcs, to be left where neither
    /// helps.
    pub(crate) fn bearable(&self) -> bool {
        match self.error {
            BlendError::Apart { .. } | BlendError::Crumpled { .. } => true,
            BlendError::Fold { jacobian, .. } => jacobian > LEAST_JACOBIAN,
            _ => false,
        }
    }
}

/// Smallest Jacobian of any map relative to its largest, how far blended points are apart, and everything that is wrong.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapReport {
    /// Smallest over all strip maps of (smallest Jacobian)/(largest Jacobian); 1 for affine maps.
    pub jacobian: f64,
    /// Largest distance of two points that a strip blends, in widths of the blend.
    pub separation: f64,
    /// What is wrong, empty for usable maps.
    pub obstacles: Vec<Obstacle>,
}

impl MapReport {
    fn clear() -> Self {
        Self { jacobian: 1.0, separation: 0.0, obstacles: Vec::new() }
    }
}

/// Tests every map of the network by samples: 25 × 9 per strip, 32 per edge of a trimming loop. `widths` holds the width at every
/// corner.
pub fn check_maps(network: &Network, maps: &MapSet, widths: &[f64]) -> MapReport {
    Findings::default().update(network, maps.clone(), widths)
}

/// What was found on the latest maps, by corner, arc and segment: where the next ones are the same it still holds.
#[derive(Default)]
pub(crate) struct Findings {
    latest: Option<(MapSet, Vec<f64>)>,
    corners: Vec<MapReport>,
    arcs: Vec<MapReport>,
    loops: Vec<MapReport>,
}

impl Findings {
    /// The maps that were tested last.
    pub(crate) fn maps(&self) -> Option<&MapSet> {
        self.latest.as_ref().map(|(maps, _)| maps)
    }

    /// Forgets what was found on an arc and at its ends.
    pub(crate) fn forget(&mut self, arc: usize, ends: [usize; 2]) {
        if let Some((maps, _)) = &mut self.latest {
            maps.chains[arc].clear();
            ends.into_iter().for_each(|c| maps.corners[c].strips.clear());
        }
    }

    /// Tests what is new in `maps`.
    pub(crate) fn update(&mut self, network: &Network, maps: MapSet, widths: &[f64]) -> MapReport {
        let old = self.latest.as_ref();
        let same_width = |c: usize| old.is_some_and(|(_, before)| before[c] == widths[c]);
        let same_corner: Vec<bool> = (0..network.corners.len())
            .map(|c| same_width(c) && old.is_some_and(|(before, _)| before.corners[c] == maps.corners[c]))
            .collect();
        let same_arc: Vec<bool> = (network.arcs.iter().enumerate())
            .map(|(a, arc)| {
                arc.corners.iter().all(|&c| same_width(c))
                    && old.is_some_and(|(before, _)| before.chains[a] == maps.chains[a])
            })
            .collect();
        let mut same_loop = vec![true; network.surfaces.len()];
        for (arc, same) in network.arcs.iter().zip(&same_arc) {
            let same = *same && arc.corners.iter().all(|&c| same_corner[c]);
            [arc.left, arc.right].into_iter().for_each(|s| same_loop[s] &= same);
        }
        renew(&mut self.corners, &same_corner, |c| check_corner(network, &maps, widths, c));
        renew(&mut self.arcs, &same_arc, |a| check_chain(network, &maps, widths, a));
        renew(&mut self.loops, &same_loop, |s| check_loop(network, &maps, s));
        self.latest = Some((maps, widths.to_vec()));
        let mut report = MapReport::clear();
        for part in self.corners.iter().chain(&self.arcs).chain(&self.loops) {
            report.jacobian = report.jacobian.min(part.jacobian);
            report.separation = report.separation.max(part.separation);
            report.obstacles.extend(part.obstacles.iter().cloned());
        }
        report
    }
}

/// Makes again what is not the same.
fn renew(parts: &mut Vec<MapReport>, same: &[bool], make: impl Fn(usize) -> MapReport + Sync) {
    parts.resize_with(same.len(), MapReport::clear);
    parts.par_iter_mut().enumerate().filter(|(k, _)| !same[*k]).for_each(|(k, part)| *part = make(k));
}

fn check_corner(network: &Network, maps: &MapSet, widths: &[f64], c: usize) -> MapReport {
    let (mut report, corner, set) = (MapReport::clear(), &network.corners[c], &maps.corners[c]);
    let n = corner.arcs.len();
    for (j, strip) in set.strips.iter().enumerate() {
        let sides = [network.segment(corner, j), network.segment(corner, (j + n - 1) % n)];
        let arc = corner.arcs[j].arc;
        let place = || format!("the strip beside corner {c} on arc {arc}");
        let grid = check_strip(network, strip, sides, &[c], arc, false, &place, &mut report);
        check_apart(network, arc, grid, sides, widths[c], &[c], &place, &mut report);
        check_strip_area(network, strip, sides, arc, &place, &mut report);
    }
    for (j, map) in set.gon.iter().enumerate() {
        let segment = network.segment(corner, j);
        let points = gon::corners(n).into_iter().map(|p| map.jet(p).p);
        let place = || format!("the N-blend at corner {c}");
        let arcs: Vec<usize> = corner.arcs.iter().map(|end| end.arc).collect();
        check_inside(&network.surfaces[segment], segment, points, &[c], &arcs, &place, &mut report);
    }
    let surfaces: Vec<_> = (0..n).map(|j| network.surfaces[network.segment(corner, j)].clone()).collect();
    if let Some(blend) = NBlend::new(surfaces, set.gon.clone()) {
        let r = gon::corners(n);
        let around = (0..n).flat_map(|j| [r[j], 0.5 * (r[j] + r[(j + 1) % n])]);
        let points = around.flat_map(|p| [0.45 * p, 0.9 * p]).chain([DVec2::ZERO]);
        let areas = points.map(|at| area((0..n).map(|k| blend.part(k, at)), &weights::n_blend(n, at)[..n]));
        let arcs = corner.arcs.iter().map(|end| end.arc).collect();
        check_area(areas, &|| format!("the N-blend at corner {c}"), arcs, &mut report);
    }
    report
}

fn check_chain(network: &Network, maps: &MapSet, widths: &[f64], a: usize) -> MapReport {
    let (mut report, arc) = (MapReport::clear(), &network.arcs[a]);
    for (k, strip) in maps.chains[a].iter().enumerate() {
        let place = || format!("strip {k} of arc {a}");
        // Only the ends of a chain depend on one corner alone.
        let corners = arc.corners;
        let sides = [arc.right, arc.left];
        let grid = check_strip(network, strip, sides, &corners, a, true, &place, &mut report);
        let width = widths[corners[0]].max(widths[corners[1]]);
        check_apart(network, a, grid, sides, width, &corners, &place, &mut report);
        check_strip_area(network, strip, sides, a, &place, &mut report);
    }
    report
}

/// Returns the jets of both maps that it looked at.
fn check_strip(
    network: &Network,
    strip: &StripMaps,
    sides: [usize; 2],
    corners: &[usize],
    arc: usize,
    in_chain: bool,
    place: &dyn Fn() -> String,
    report: &mut MapReport,
) -> [Vec<Jet2<DVec2>>; 2] {
    [(&strip.down, sides[0]), (&strip.up, sides[1])].map(|(map, segment)| {
        let grid = jets(map);
        let ratio = jacobian(grid.iter().copied());
        report.jacobian = report.jacobian.min(ratio);
        if !(ratio > GOOD_JACOBIAN) {
            let error = BlendError::Fold { place: place(), segment, jacobian: ratio };
            report.obstacles.push(Obstacle {
                error,
                corners: corners.to_vec(),
                chain: in_chain.then_some(arc),
                arcs: vec![arc],
            });
        }
        let points = grid.iter().map(|j| j.p);
        check_inside(&network.surfaces[segment], segment, points, corners, &[arc], place, report);
        grid
    })
}

/// Largest distance of pairs of parameters on two surfaces.
fn apart(network: &Network, [a, b]: [usize; 2], pairs: impl Iterator<Item = (DVec2, DVec2)>) -> f64 {
    let [a, b] = [a, b].map(|segment| &network.surfaces[segment]);
    pairs.map(|(p, q)| a.point(p).distance_squared(b.point(q))).fold(0.0, f64::max).sqrt()
}

fn check_apart(
    network: &Network,
    arc: usize,
    [down, up]: [Vec<Jet2<DVec2>>; 2],
    sides: [usize; 2],
    width: f64,
    corners: &[usize],
    place: &dyn Fn() -> String,
    report: &mut MapReport,
) {
    let distance = apart(network, sides, down.iter().zip(&up).map(|(d, u)| (d.p, u.p)));
    report.separation = report.separation.max(distance / width);
    let excess = distance - MOST_APART * width;
    // The gap on the arc matters to few strips.
    let gap = || {
        let ArcCurve { left, right, samples, .. } = &network.arcs[arc];
        apart(network, [*left, *right], samples.iter().map(|s| (s.left, s.right)))
    };
    if excess > 0.0 && excess > gap() {
        let error = BlendError::Apart { place: place(), segments: sides, distance: distance / width };
        report.obstacles.push(Obstacle { error, corners: corners.to_vec(), chain: None, arcs: vec![arc] });
    }
}

/// Area element of a blend relative to the mean of those of its parts, by the direction of their normals.
fn area(parts: impl Iterator<Item = Jet2>, weights: &[Jet2<f64>]) -> f64 {
    let (mut blend, mut sum, mut total) = (Jet2::default(), DVec3::ZERO, 0.0);
    for (part, weight) in parts.zip(weights) {
        blend = blend.add(part.weighted(weight));
        let normal = part.du.cross(part.dv);
        (sum, total) = (sum + normal, total + normal.length());
    }
    blend.du.cross(blend.dv).dot(sum.normalize_or_zero()) * weights.len() as f64 / total
}

fn check_area(
    areas: impl Iterator<Item = f64>,
    place: &dyn Fn() -> String,
    arcs: Vec<usize>,
    report: &mut MapReport,
) {
    let ratio = areas.fold(f64::INFINITY, f64::min);
    if ratio < LEAST_AREA {
        // Narrower blends would be steeper still.
        let error = BlendError::Crumpled { place: place(), ratio };
        report.obstacles.push(Obstacle { error, corners: Vec::new(), chain: None, arcs });
    }
}

fn check_strip_area(
    network: &Network,
    maps: &StripMaps,
    sides: [usize; 2],
    arc: usize,
    place: &dyn Fn() -> String,
    report: &mut MapReport,
) {
    let surfaces = sides.map(|segment| network.surfaces[segment].clone());
    let strip = Strip::new(surfaces, [maps.down.clone(), maps.up.clone()], PatchKind::AdjacentStrip);
    let part = |i: usize, n: usize| i as f64 / n as f64;
    let points =
        (0..=SAMPLES).flat_map(|i| (1..SAMPLES).map(move |j| DVec2::new(part(i, SAMPLES), part(j, SAMPLES))));
    let areas = points.map(|at| area((0..2).map(|k| strip.part(k, at)), &weights::strip(at.y)));
    check_area(areas, place, vec![arc], report);
}

/// Smallest Jacobian of a strip map relative to its largest.
pub(crate) fn strip_jacobian(map: &BezierPatch<DVec2>) -> f64 {
    jacobian(jets(map).into_iter())
}

/// Smallest Jacobian relative to the largest, 0 where there is none.
pub(crate) fn jacobian(jets: impl Iterator<Item = Jet2<DVec2>>) -> f64 {
    let determinants = jets.map(|j| j.du.perp_dot(j.dv));
    let (low, high) =
        determinants.fold((f64::INFINITY, 0.0_f64), |(low, high), d| (low.min(d), high.max(d.abs())));
    if high > 0.0 { low / high } else { 0.0 }
}

fn jets(map: &BezierPatch<DVec2>) -> Vec<Jet2<DVec2>> {
    // Along the strip the maps have the higher degree.
    let along = |i: usize| i as f64 / (3 * SAMPLES) as f64;
    let across = |j: usize| j as f64 / SAMPLES as f64;
    (0..=3 * SAMPLES)
        .flat_map(|i| (0..=SAMPLES).map(move |j| DVec2::new(along(i), across(j))))
        .map(|at| map.jet(at))
        .collect()
}

fn check_inside(
    surface: &BSplineSurface<glam::DVec3>,
    segment: usize,
    points: impl Iterator<Item = DVec2>,
    corners: &[usize],
    arcs: &[usize],
    place: &dyn Fn() -> String,
    report: &mut MapReport,
) {
    let [min, max] = surface.domain();
    let outside = points.fold(0.0_f64, |worst, p| {
        let d = (min - p).max(p - max).max(DVec2::ZERO) / (max - min);
        worst.max(d.max_element())
    });
    // Rounding beside the border is continued polynomially and harmless.
    if outside > 1e-12 {
        let error = BlendError::OutsideDomain { place: place(), segment, overshoot: outside };
        report.obstacles.push(Obstacle {
            error,
            corners: corners.to_vec(),
            chain: None,
            arcs: arcs.to_vec(),
        });
    }
}

/// The trimming loop of a segment must be a simple, counter-clockwise polygon.
fn check_loop(network: &Network, maps: &MapSet, segment: usize) -> MapReport {
    let mut report = MapReport::clear();
    let Ok(edges) = trimming_loop(network, maps, segment) else {
        return report;
    };
    let mut points = Vec::new();
    for (e, edge) in edges.iter().enumerate() {
        for k in 0..LOOP_SAMPLES {
            points.push((edge.curve.jet::<1>(k as f64 / LOOP_SAMPLES as f64)[0], e));
        }
    }
    let n = points.len();
    let area: f64 = (0..n).map(|i| points[i].0.perp_dot(points[(i + 1) % n].0)).sum();
    let mut blame = |guilty: &[usize]| {
        let arcs = guilty.iter().map(|&e| edges[e].strip.arc(network)).collect();
        let corners = guilty.iter().flat_map(|&e| edges[e].corners).collect();
        report.obstacles.push(Obstacle {
            error: BlendError::Overlap { segment },
            corners,
            chain: None,
            arcs,
        });
    };
    if !(area > 0.0) {
        blame(&(0..edges.len()).collect::<Vec<_>>());
        return report;
    }
    // Sweep over the sides in the order of their left ends.
    let mut sides: Vec<(f64, f64, usize)> = (0..n)
        .map(|i| {
            let (a, b) = (points[i].0.x, points[(i + 1) % n].0.x);
            (a.min(b), a.max(b), i)
        })
        .collect();
    sides.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    for (s, &(_, right, i)) in sides.iter().enumerate() {
        for &(left, _, j) in &sides[s + 1..] {
            if left > right {
                break;
            }
            let adjacent = (i + 1) % n == j || (j + 1) % n == i;
            if !adjacent && cross([points[i].0, points[(i + 1) % n].0], [points[j].0, points[(j + 1) % n].0])
            {
                blame(&[points[i].1, points[j].1]);
                return report;
            }
        }
    }
    report
}

fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
