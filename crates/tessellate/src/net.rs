//! The network of boundary curves: every seam once, every edge without a seam once, and the corners where they meet.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;
use suture_surface::{Domain, EdgeCurve, Patch, Surface};

use crate::{TessellateError, union_find::UnionFind};

/// A boundary edge of a patch, by index.
pub(crate) type Edge = (usize, usize);

/// One curve of the network.
pub(crate) struct Curve {
    /// The side whose evaluation gives the positions.
    pub(crate) a: Edge,
    /// The other side of a seam.
    pub(crate) b: Option<Edge>,
    /// Corners at the start and the end of side `a`.
    pub(crate) ends: [usize; 2],
    /// Whether the whole curve is one point in space.
    pub(crate) collapsed: bool,
}

/// The curve that a boundary edge is, and whether the edge runs along it.
#[derive(Clone, Copy)]
pub(crate) struct Side {
    pub(crate) curve: usize,
    pub(crate) forward: bool,
}

/// A patch with its domain taken apart.
pub(crate) struct Frame<'a> {
    pub(crate) patch: &'a dyn Patch,
    pub(crate) domain: &'a Domain,
    pub(crate) edges: Vec<EdgeCurve<'a>>,
    pub(crate) loops: Vec<Range<usize>>,
    /// The edge after each edge in its loop.
    pub(crate) next: Vec<usize>,
    /// The curve of each edge.
    pub(crate) sides: Vec<Side>,
}

/// Patches, curves and corners of a surface.
pub(crate) struct Net<'a> {
    pub(crate) frames: Vec<Frame<'a>>,
    pub(crate) curves: Vec<Curve>,
    /// The first edge (in the order of patches and edges) that starts at each corner.
    pub(crate) corners: Vec<Edge>,
}

impl<'a> Net<'a> {
    /// Takes the surface apart.
    pub(crate) fn new(surface: &'a Surface, domains: &'a [Domain]) -> Result<Self, TessellateError> {
        let mut frames: Vec<Frame> = Vec::with_capacity(domains.len());
        for (index, (patch, domain)) in surface.patches().iter().zip(domains).enumerate() {
            frames.push(frame(index, patch.as_ref(), domain)?);
        }
        let mut curves = Vec::new();
        for seam in surface.seams() {
            let [a, b] = [seam.a, seam.b].map(|e| (e.patch.0 as usize, e.edge as usize));
            frames[a.0].sides[a.1] = Side { curve: curves.len(), forward: true };
            frames[b.0].sides[b.1] = Side { curve: curves.len(), forward: seam.same_direction };
            curves.push(Curve { a, b: Some(b), ends: [0; 2], collapsed: false });
        }
        for (patch, frame) in frames.iter_mut().enumerate() {
            for (edge, side) in frame.sides.iter_mut().enumerate() {
                if side.curve == usize::MAX {
                    *side = Side { curve: curves.len(), forward: true };
                    curves.push(Curve { a: (patch, edge), b: None, ends: [0; 2], collapsed: false });
                }
            }
        }
        curves.par_iter_mut().for_each(|curve| curve.collapsed = collapsed(&frames[curve.a.0], curve.a.1));
        let corners = corners(&frames, &mut curves);
        Ok(Self { frames, curves, corners })
    }
}

/// Whether an edge is one point in space, up to the rounding of coordinates of the patch's magnitude.
fn collapsed(frame: &Frame, edge: usize) -> bool {
    let at = |e: usize, t: f64| frame.patch.jet(frame.edges[e].point(t)).p;
    let [a, b, c] = [0.0, 0.375, 0.75].map(|t| at(edge, t));
    let spread = a.distance(b).max(a.distance(c));
    let rounding = 64.0 * f64::EPSILON;
    // The other corners count too: an edge may collapse into the origin.
    spread <= rounding * a.abs().max_element()
        || (0..frame.edges.len()).any(|e| spread <= rounding * at(e, 0.0).abs().max_element())
}

/// Identifies the ends of edges through the seams, along chains of any length, and numbers the resulting corners.
fn corners(frames: &[Frame], curves: &mut [Curve]) -> Vec<Edge> {
    let mut first = Vec::with_capacity(frames.len());
    let mut slots = Vec::new();
    for (patch, frame) in frames.iter().enumerate() {
        first.push(slots.len());
        slots.extend((0..frame.edges.len()).map(|edge| (patch, edge)));
    }
    let start = |e: Edge| first[e.0] + e.1;
    let end = |e: Edge| first[e.0] + frames[e.0].next[e.1];
    let mut sets = UnionFind::new(slots.len());
    for curve in curves.iter() {
        if let Some(b) = curve.b {
            let same = frames[b.0].sides[b.1].forward;
            let (head, tail) = if same { (start(b), end(b)) } else { (end(b), start(b)) };
            sets.join(start(curve.a), head);
            sets.join(end(curve.a), tail);
        }
        if curve.collapsed {
            sets.join(start(curve.a), end(curve.a));
        }
    }
    let mut number = vec![0; slots.len()];
    let mut corners = Vec::new();
    for slot in 0..slots.len() {
        // The representative is the smallest member, so it is numbered before the others ask for it.
        let root = sets.find(slot);
        if root == slot {
            number[slot] = corners.len();
            corners.push(slots[slot]);
        }
        number[slot] = number[root];
    }
    for curve in curves {
        curve.ends = [number[start(curve.a)], number[end(curve.a)]];
    }
    corners
}

fn frame<'a>(index: usize, patch: &'a dyn Patch, domain: &'a Domain) -> Result<Frame<'a>, TessellateError> {
    let refuse = |reason| Err(TessellateError::Domain { patch: index, reason });
    let loops = domain.loops();
    match domain {
        Domain::Rectangle { min, max } if !(min.x < max.x && min.y < max.y) => {
            return refuse("the lower corner of the rectangle is not below and left of the upper one");
        }
        Domain::Polygon(corners) if corners.len() < 3 => return refuse("a polygon needs three corners"),
        Domain::Polygon(corners) if !convex(corners) => {
            return refuse("the polygon is not convex and counter-clockwise");
        }
        _ if loops.is_empty() || loops.iter().any(|l| l.is_empty()) => {
            return refuse("a boundary loop has no edges");
        }
        _ => {}
    }
    let edges: Vec<EdgeCurve> = match domain {
        // `Domain::edge` counts through the loops on every call.
        Domain::Trimmed(loops) => loops.iter().flatten().map(EdgeCurve::Bezier).collect(),
        _ => (0..domain.edge_count()).filter_map(|i| domain.edge(i)).collect(),
    };
    let mut next = vec![0; edges.len()];
    for range in &loops {
        for i in range.clone() {
            next[i] = if i + 1 < range.end { i + 1 } else { range.start };
        }
    }
    if edges.iter().any(|e| !e.point(0.0).is_finite() || !e.point(1.0).is_finite()) {
        return refuse("a corner of the domain is not finite");
    }
    let sides = vec![Side { curve: usize::MAX, forward: true }; edges.len()];
    Ok(Frame { patch, domain, edges, loops, next, sides })
}

/// Whether every corner turns to the left by less than half a turn (which a polygon wound twice also does: its area is not
/// checked, its triangles are).
fn convex(corners: &[DVec2]) -> bool {
    let n = corners.len();
    (0..n).all(|i| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % n]);
        (b - a).perp_dot(c - b) > 0.0
    })
}
