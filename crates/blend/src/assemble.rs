//! From maps to patches and seams.

use glam::DVec2;
use suture_bernstein::{BezierCurve, BezierPatch};
use suture_surface::{Continuity, EdgeRef, Patch, PatchId, PatchKind, Seam, Surface};

use crate::check::MapReport;
use crate::maps::MapSet;
use crate::patches::{NBlend, Strip, Trimmed};
use crate::widths::Widths;
use crate::{ArcEnd, BlendError, Network};

/// A blended surface with the numbers of its making.
#[derive(Debug)]
pub struct Blend {
    /// The surface: per segment a trimmed patch, per corner an N-blend and its adjacent strips, per arc its chain.
    pub surface: Surface,
    /// The widths used.
    pub widths: Widths,
    /// The quality of the maps.
    pub maps: MapReport,
    /// How many strips would remain if those of one arc were merged: one per arc.
    pub merged_strips: usize,
}

/// One edge of a trimming loop.
pub(crate) struct TrimmingEdge {
    pub(crate) curve: BezierCurve<DVec2>,
    /// The strip beside it.
    pub(crate) strip: StripAt,
    /// Whether it runs along `V = 1` of the strip (with `U`) or along `V = 0` (against it).
    pub(crate) upper: bool,
    /// The corners that its width depends on.
    pub(crate) corners: [usize; 2],
}

/// Where a strip stands in a [`MapSet`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum StripAt {
    /// On arc `slot` of a corner.
    Corner { corner: usize, slot: usize },
    /// The `index`-th strip of the chain of an arc.
    Chain { arc: usize, index: usize },
}

impl StripAt {
    /// The arc that it runs along.
    pub(crate) fn arc(self, network: &Network) -> usize {
        match self {
            Self::Corner { corner, slot } => network.corners[corner].arcs[slot].arc,
            Self::Chain { arc, .. } => arc,
        }
    }
}

/// The inner sides of all strips around a segment, counter-clockwise.
pub(crate) fn trimming_loop(
    network: &Network,
    maps: &MapSet,
    segment: usize,
) -> Result<Vec<TrimmingEdge>, BlendError> {
    let open =
        || BlendError::Inconsistent { what: format!("the arcs around segment {segment} do not close") };
    // A segment is a disc whose corners are all different, so one walk from any of its corners visits its whole boundary.
    let start = network
        .corners
        .iter()
        .enumerate()
        .find_map(|(c, corner)| {
            (0..corner.arcs.len()).find(|&i| network.segment(corner, i) == segment).map(|i| (c, i))
        })
        .ok_or_else(open)?;
    let mut edges = Vec::new();
    let (mut corner, mut slot) = start;
    for _ in 0..=network.arcs.len() {
        let ArcEnd { arc, starts } = network.corners[corner].arcs[slot];
        let other = network.arcs[arc].corners[usize::from(starts)];
        let n = network.corners[other].arcs.len();
        let arriving = network.corners[other]
            .arcs
            .iter()
            .position(|&e| e == ArcEnd { arc, starts: !starts })
            .ok_or_else(open)?;
        let mut push = |strip: StripAt, upper: bool, corners: [usize; 2]| -> Result<(), BlendError> {
            let (down, up) = match strip {
                StripAt::Corner { corner, slot } => {
                    let s = &maps.corners[corner].strips[slot];
                    (&s.down, &s.up)
                }
                StripAt::Chain { arc, index } => {
                    let s = &maps.chains[arc][index];
                    (&s.down, &s.up)
                }
            };
            let curve = inner_side(if upper { up } else { down }, upper)?;
            edges.push(TrimmingEdge { curve, strip, upper, corners });
            Ok(())
        };
        // Leaving a corner the segment is ↓ of the adjacent strip, arriving it is ↑.
        push(StripAt::Corner { corner, slot }, false, [corner; 2])?;
        let count = maps.chains[arc].len();
        for k in 0..count {
            let index = if starts { k } else { count - 1 - k };
            push(StripAt::Chain { arc, index }, starts, network.arcs[arc].corners)?;
        }
        push(StripAt::Corner { corner: other, slot: arriving }, true, [other; 2])?;
        // The segment on the left of the arc is, at its far corner, the one before the arriving arc.
        (corner, slot) = (other, (arriving + n - 1) % n);
        if (corner, slot) == start {
            return Ok(edges);
        }
    }
    Err(open())
}

/// The inner side of a strip map as a curve with the segment on its left.
fn inner_side(map: &BezierPatch<DVec2>, upper: bool) -> Result<BezierCurve<DVec2>, BlendError> {
    let columns = map.degree()[1] + 1;
    let rows = map.net().chunks(columns);
    let net = if upper { rows.map(|r| r[columns - 1]).collect() } else { rows.rev().map(|r| r[0]).collect() };
    BezierCurve::new(net).map_err(|e| BlendError::Inconsistent { what: format!("a trimming curve: {e}") })
}

/// Edges of a strip's rectangle, counter-clockwise from `V = 0`.
const BOTTOM: u32 = 0;
const GON_END: u32 = 1;
const TOP: u32 = 2;
const START: u32 = 3;

/// The surface of usable maps.
pub(crate) fn assemble(
    network: &Network,
    maps: &MapSet,
    widths: Widths,
    report: MapReport,
) -> Result<Blend, BlendError> {
    let mut patches: Vec<Box<dyn Patch>> = Vec::new();
    let mut seams = Vec::new();
    let mut push = |patch: Box<dyn Patch>| {
        patches.push(patch);
        PatchId(patches.len() as u32 - 1)
    };
    let sew = |a: (PatchId, u32), b: (PatchId, u32)| {
        let edge = |(patch, edge)| EdgeRef { patch, edge };
        Seam::new(edge(a), edge(b), Continuity::C2)
    };
    let surface = |segment: usize| network.surfaces[segment].clone();

    let mut loops = Vec::new();
    let mut trimmed = Vec::new();
    for segment in 0..network.surfaces.len() {
        let edges = trimming_loop(network, maps, segment)?;
        let curves = edges.iter().map(|e| e.curve.clone()).collect();
        trimmed.push(push(Box::new(Trimmed::new(surface(segment), vec![curves]))));
        loops.push(edges);
    }
    let mut adjacent: Vec<Vec<PatchId>> = Vec::new();
    for (corner, set) in network.corners.iter().zip(&maps.corners) {
        let n = corner.arcs.len();
        let around: Vec<_> = (0..n).map(|i| surface(network.segment(corner, i))).collect();
        let blend = NBlend::new(around.clone(), set.gon.clone())
            .ok_or_else(|| BlendError::Inconsistent { what: "a corner lacks a map".into() })?;
        let gon = push(Box::new(blend));
        let ids: Vec<PatchId> = set
            .strips
            .iter()
            .enumerate()
            .map(|(i, s)| {
                let sides = [around[i].clone(), around[(i + n - 1) % n].clone()];
                push(Box::new(Strip::new(sides, [s.down.clone(), s.up.clone()], PatchKind::AdjacentStrip)))
            })
            .collect();
        // Edge i of the N-gon runs from R_i to R_{i+1} and faces arc i + 1.
        seams.extend((0..n).map(|i| sew((gon, i as u32), (ids[(i + 1) % n], GON_END))));
        adjacent.push(ids);
    }
    let mut chained: Vec<Vec<PatchId>> = Vec::new();
    for (a, (arc, chain)) in network.arcs.iter().zip(&maps.chains).enumerate() {
        let ids: Vec<PatchId> = chain
            .iter()
            .enumerate()
            .map(|(k, s)| {
                let sides = [surface(arc.right), surface(arc.left)];
                let kind = PatchKind::Strip { odd: k % 2 == 1 };
                push(Box::new(Strip::new(sides, [s.down.clone(), s.up.clone()], kind)))
            })
            .collect();
        let end = |e: usize| {
            let corner = arc.corners[e];
            let wanted = ArcEnd { arc: a, starts: e == 0 };
            let slot = network.corners[corner].arcs.iter().position(|&x| x == wanted);
            slot.map(|s| adjacent[corner][s])
        };
        if let (Some(&first), Some(&last), Some(start), Some(stop)) =
            (ids.first(), ids.last(), end(0), end(1))
        {
            seams.push(sew((start, START), (first, START)));
            seams.extend(ids.windows(2).map(|w| sew((w[0], GON_END), (w[1], START))));
            seams.push(sew((last, GON_END), (stop, START)));
        }
        chained.push(ids);
    }
    for (segment, edges) in loops.iter().enumerate() {
        for (number, edge) in edges.iter().enumerate() {
            let strip = match edge.strip {
                StripAt::Corner { corner, slot } => adjacent[corner][slot],
                StripAt::Chain { arc, index } => chained[arc][index],
            };
            let side = if edge.upper { TOP } else { BOTTOM };
            seams.push(sew((trimmed[segment], number as u32), (strip, side)));
        }
    }
    let surface = Surface::new(patches, seams)?;
    Ok(Blend { surface, widths, maps: report, merged_strips: network.arcs.len() })
}
