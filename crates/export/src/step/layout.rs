//! Which faces, edges and vertices a surface becomes.
//!
//! A patch whose B-spline is known is one face as it is. Every other patch becomes four-sided *blocks*, to be refitted: a rectangle is
//! one block, an N-gon is N kites (corner, middle of the edge after it, centre, middle of the edge before it), and rectangles in a row that
//! join C² up to a linear change of the parameter, as the strips of an arc do, are one block of several *pieces*. Along a block run `a`
//! and `b`, counter-clockwise from its lower left corner its sides are bottom, right, top and left.
//!
//! Sides that lie opposite each other or on each other have the same nodes: they form a *class*, whose number of intervals is refined
//! as a whole.

use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;
use suture_surface::{Domain, EdgeRef, Jet2, Patch, PatchKind, SplinePool, Surface};

use super::brep::Geometry;
use crate::ExportError;

/// Faces, edges and vertices to be.
#[derive(Debug)]
pub(crate) struct Layout {
    pub(crate) domains: Vec<Domain>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) exact: Vec<Exact>,
    pub(crate) edges: Vec<LayoutEdge>,
    pub(crate) classes: Vec<Class>,
    /// Component of every patch, and whether its orientation is against that of the component.
    pub(crate) shells: Vec<(usize, bool)>,
}

/// A four-sided face to be fitted.
#[derive(Debug)]
pub(crate) struct Block {
    pub(crate) pieces: Vec<Piece>,
    pub(crate) height: f64,
    /// Class of the sides left and right.
    pub(crate) class: usize,
}

/// A part of a block that lies on one patch.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) patch: usize,
    /// Where the corners lie in the domain of the patch, counter-clockwise from the lower left.
    pub(crate) quad: [DVec2; 4],
    /// The vertices there.
    pub(crate) corners: [Vertex; 4],
    /// First and last `a`.
    pub(crate) span: [f64; 2],
    /// Class of its sides bottom and top.
    pub(crate) class: usize,
}

/// A patch whose surface is known.
#[derive(Debug)]
pub(crate) struct Exact {
    pub(crate) patch: usize,
    pub(crate) geometry: Geometry,
    /// Whether the geometry's normals are against those of the patch.
    pub(crate) against: bool,
}

/// Nodes of sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Class {
    /// Intervals on a whole edge of a patch.
    pub(crate) intervals: usize,
    /// Whether the middle of the edges is a vertex somewhere.
    pub(crate) halved: bool,
}

/// What makes a vertex one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Vertex {
    /// A corner of patches: the least number of an edge that starts there.
    Corner(usize),
    /// The middle of an edge: the lesser number of the two edges that lie there.
    Middle(usize),
    /// The centre of a patch.
    Centre(usize),
}

/// An edge with its one or two uses, the owner first: the side of a block that gives its curve, or the only one.
#[derive(Debug)]
pub(crate) struct LayoutEdge {
    pub(crate) ends: [Vertex; 2],
    /// Parameters at the ends and where the patches change in between.
    pub(crate) joints: Vec<f64>,
    pub(crate) uses: Vec<Use>,
    /// Class of every part between joints; none where no block takes part.
    pub(crate) classes: Vec<Option<usize>>,
}

/// An edge as a face sees it.
#[derive(Clone, Debug)]
pub(crate) enum Use {
    /// On a side of a block, from one value of `a` or `b` to another.
    Block { block: usize, side: usize, ends: [f64; 2] },
    /// On edges of the domain of an exact face, each from one parameter to another.
    Exact { face: usize, parts: Vec<(usize, [f64; 2])> },
}

/// Part of a side of a block: an edge of a patch, from one parameter to another, and what `a` or `b` is there.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    patch: usize,
    edge: usize,
    t: [f64; 2],
    block: usize,
    side: usize,
    s: [f64; 2],
    class: usize,
    whole: bool,
}

/// The patch and edge that continue a strip, and the ratio of the lengths of their intervals.
type Join = (usize, usize, f64);

/// How far, relative to the derivatives, rectangles may be from joining C².
const JOIN: f64 = 1e-7;

impl Layout {
    /// Lays out `surface`; every class gets `intervals`.
    ///
    /// # Errors
    /// [`ExportError::StepPatch`] for patches that are neither known nor four-sided nor polygons.
    pub(crate) fn new(surface: &Surface, intervals: usize) -> Result<Self, ExportError> {
        let topology = Topology::new(surface);
        let mut exact = Vec::new();
        let mut face_of = vec![None; surface.patches().len()];
        for (p, patch) in surface.patches().iter().enumerate() {
            if matches!(patch.kind(), PatchKind::Face | PatchKind::Edge | PatchKind::Planar)
                && let Some((geometry, against)) =
                    super::quadric::recognise(patch.as_ref(), &topology.domains[p])
            {
                face_of[p] = Some(exact.len());
                exact.push(Exact { patch: p, geometry, against });
                continue;
            }
            let curved = matches!(topology.domains[p], Domain::Trimmed(_));
            if !curved && !matches!(patch.kind(), PatchKind::Trimmed | PatchKind::Given) {
                continue;
            }
            if let Some(spline) = known_spline(patch.as_ref(), &topology.domains[p]) {
                face_of[p] = Some(exact.len());
                let geometry = Geometry::Spline(super::exact::crop(&spline, &topology.domains[p])?);
                exact.push(Exact { patch: p, geometry, against: false });
            } else if curved {
                let reason = "its domain has curved borders and its surface is no known B-spline";
                return Err(ExportError::StepPatch { patch: p, reason });
            }
        }
        let mut classes = Classes::new(&topology, &face_of);
        let blocks = blocks(surface, &topology, &face_of, &mut classes);
        let stretches = stretches(&topology, &blocks);
        let edges = edges(&topology, &face_of, &blocks, &stretches, &classes);
        let shells = topology.shells();
        let classes = classes.all(intervals);
        Ok(Self { domains: topology.domains, blocks, exact, edges, classes, shells })
    }

    /// The nodes of a block along `a` and `b`, break by break.
    pub(crate) fn nodes(&self, block: &Block) -> [Vec<Vec<f64>>; 2] {
        // A kite's sides are half an edge long.
        let half = block.height < 1.0;
        let along = |class: usize, [from, to]: [f64; 2], out: &mut Vec<Vec<f64>>| {
            let Class { intervals, halved } = self.classes[class];
            let parts = if halved && !half { 2 } else { 1 };
            let count = if halved { intervals / 2 } else { intervals }.max(1);
            let at =
                |i: usize, n: usize| if i == n { to } else { from + (to - from) * (i as f64 / n as f64) };
            out.extend(
                (0..parts).map(|p| (p * count..=(p + 1) * count).map(|i| at(i, parts * count)).collect()),
            );
        };
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for piece in &block.pieces {
            along(piece.class, piece.span, &mut a);
        }
        along(block.class, [0.0, block.height], &mut b);
        [a, b]
    }
}

impl Block {
    /// The number of the piece at `a`.
    pub(crate) fn piece(&self, a: f64) -> usize {
        self.pieces.partition_point(|p| p.span[1] <= a).min(self.pieces.len() - 1)
    }

    /// Length of a side.
    fn length(&self, side: usize) -> f64 {
        if side.is_multiple_of(2) { self.pieces.last().map_or(0.0, |p| p.span[1]) } else { self.height }
    }

    /// `(a, b)` at parameter `s` of a side.
    pub(crate) fn on_side(&self, side: usize, s: f64) -> DVec2 {
        match side {
            0 => DVec2::new(s, 0.0),
            1 => DVec2::new(self.length(0), s),
            2 => DVec2::new(s, self.height),
            _ => DVec2::new(0.0, s),
        }
    }

    /// The jet of the patch in `a` and `b`, taken on piece `k`.
    pub(crate) fn jet(&self, surface: &Surface, k: usize, a: f64, b: f64) -> Jet2 {
        let piece = &self.pieces[k];
        let [q00, q10, q11, q01] = piece.quad;
        let (length, height) = (piece.span[1] - piece.span[0], self.height);
        let (x, y) = ((a - piece.span[0]) / length, b / height);
        let map = Jet2 {
            p: (q00 * (1.0 - x) + q10 * x) * (1.0 - y) + (q01 * (1.0 - x) + q11 * x) * y,
            du: ((q10 - q00) * (1.0 - y) + (q11 - q01) * y) / length,
            dv: ((q01 - q00) * (1.0 - x) + (q11 - q10) * x) / height,
            duv: (q00 - q10 + q11 - q01) / (length * height),
            ..Jet2::default()
        };
        surface.patches()[piece.patch].jet(map.p).compose(&map)
    }
}

/// Domains, neighbours and corners.
struct Topology {
    domains: Vec<Domain>,
    /// Number of the first edge of every patch.
    first: Vec<usize>,
    /// Across every edge: the other edge and whether both run in the same direction.
    across: Vec<Option<(EdgeRef, bool)>>,
    /// The vertex at the start of every edge.
    start: Vec<usize>,
    patch_of: Vec<usize>,
}

impl Topology {
    fn new(surface: &Surface) -> Self {
        let domains: Vec<Domain> = surface.patches().iter().map(|p| p.domain()).collect();
        let mut first = Vec::with_capacity(domains.len());
        let mut patch_of = Vec::new();
        for (p, domain) in domains.iter().enumerate() {
            first.push(patch_of.len());
            patch_of.resize(patch_of.len() + domain.edge_count(), p);
        }
        let index = |e: EdgeRef| first[e.patch.0 as usize] + e.edge as usize;
        let end = |e: EdgeRef| {
            let p = e.patch.0 as usize;
            first[p] + domains[p].next_edge(e.edge as usize)
        };
        let mut across = vec![None; patch_of.len()];
        let mut corners = UnionFind::new(patch_of.len());
        for seam in surface.seams() {
            across[index(seam.a)] = Some((seam.b, seam.same_direction));
            across[index(seam.b)] = Some((seam.a, seam.same_direction));
            let (b0, b1) =
                if seam.same_direction { (index(seam.b), end(seam.b)) } else { (end(seam.b), index(seam.b)) };
            corners.join(index(seam.a), b0);
            corners.join(end(seam.a), b1);
        }
        let start = (0..patch_of.len()).map(|e| corners.root(e)).collect();
        Self { domains, first, across, start, patch_of }
    }

    fn index(&self, e: EdgeRef) -> usize {
        self.first[e.patch.0 as usize] + e.edge as usize
    }

    fn corner(&self, patch: usize, edge: usize) -> Vertex {
        Vertex::Corner(self.start[self.first[patch] + edge])
    }

    fn middle(&self, patch: usize, edge: usize) -> Vertex {
        let e = self.first[patch] + edge;
        Vertex::Middle(self.across[e].map_or(e, |(f, _)| self.index(f).min(e)))
    }

    /// The vertex at `t` of an edge: an end or the middle.
    fn vertex(&self, patch: usize, edge: usize, t: f64) -> Vertex {
        match t {
            0.0 => self.corner(patch, edge),
            1.0 => self.corner(patch, self.domains[patch].next_edge(edge)),
            _ => self.middle(patch, edge),
        }
    }

    fn across(&self, patch: usize, edge: usize) -> Option<(usize, usize, bool)> {
        self.across[self.first[patch] + edge].map(|(e, same)| (e.patch.0 as usize, e.edge as usize, same))
    }

    /// Component and orientation of every patch.
    fn shells(&self) -> Vec<(usize, bool)> {
        let mut shells: Vec<Option<(usize, bool)>> = vec![None; self.domains.len()];
        let mut count = 0;
        for seed in 0..self.domains.len() {
            if shells[seed].is_some() {
                continue;
            }
            shells[seed] = Some((count, false));
            let mut queue = vec![(seed, false)];
            while let Some((p, flipped)) = queue.pop() {
                for edge in 0..self.domains[p].edge_count() {
                    if let Some((q, _, same)) = self.across(p, edge)
                        && shells[q].is_none()
                    {
                        shells[q] = Some((count, flipped != same));
                        queue.push((q, flipped != same));
                    }
                }
            }
            count += 1;
        }
        shells.into_iter().map(Option::unwrap_or_default).collect()
    }
}

/// The B-spline that a patch says it lies on, in its own parameters, if it really does.
fn known_spline(patch: &dyn Patch, domain: &Domain) -> Option<std::sync::Arc<BSplineSurface<DVec3>>> {
    let mut pool = SplinePool::default();
    patch.record(&mut pool);
    let sites: Vec<DVec2> =
        (0..domain.edge_count()).filter_map(|e| domain.edge(e)).map(|curve| curve.point(0.382)).collect();
    let middle = sites.iter().sum::<DVec2>() / sites.len() as f64;
    let inside = sites.iter().map(|&s| s.lerp(middle, 0.3));
    let sites: Vec<DVec2> = sites.iter().copied().chain(inside).collect();
    pool.splines()
        .iter()
        .find(|spline| {
            sites.iter().all(|&at| {
                let (a, b) = (patch.jet(at), spline.jet(at));
                let size = a.p.length() + a.du.length() + a.dv.length();
                a.p.distance(b.p) + a.du.distance(b.du) + a.dv.distance(b.dv) <= 1e-12 * size
            })
        })
        .cloned()
}

/// Classes of edges under construction.
struct Classes {
    sets: UnionFind,
    halved: Vec<bool>,
    number: Vec<usize>,
}

impl Classes {
    fn new(topology: &Topology, face_of: &[Option<usize>]) -> Self {
        let mut sets = UnionFind::new(topology.patch_of.len());
        let block = |p: usize| face_of[p].is_none();
        for (p, domain) in topology.domains.iter().enumerate().filter(|(p, _)| block(*p)) {
            let first = topology.first[p];
            match domain {
                Domain::Rectangle { .. } => {
                    sets.join(first, first + 2);
                    sets.join(first + 1, first + 3);
                }
                _ => (1..domain.edge_count()).for_each(|e| sets.join(first, first + e)),
            }
            for edge in 0..domain.edge_count() {
                if let Some((q, f, _)) = topology.across(p, edge)
                    && block(q)
                {
                    sets.join(first + edge, topology.first[q] + f);
                }
            }
        }
        let mut halved = vec![false; topology.patch_of.len()];
        for (p, domain) in topology.domains.iter().enumerate() {
            if block(p) && matches!(domain, Domain::Polygon(_)) {
                halved[sets.root(topology.first[p])] = true;
            }
        }
        // Roots, numbered in their order.
        let roots: Vec<usize> = (0..topology.patch_of.len()).map(|e| sets.root(e)).collect();
        let mut number = vec![usize::MAX; roots.len()];
        let mut count = 0;
        for (e, &root) in roots.iter().enumerate() {
            if root == e && block(topology.patch_of[e]) {
                number[e] = count;
                count += 1;
            }
        }
        let number = roots.iter().map(|&r| number[r]).collect();
        Self { sets, halved, number }
    }

    fn of(&self, edge: usize) -> usize {
        self.number[edge]
    }

    fn halved(&mut self, edge: usize) -> bool {
        let root = self.sets.root(edge);
        self.halved[root]
    }

    fn all(mut self, intervals: usize) -> Vec<Class> {
        let count = self.number.iter().filter(|&&n| n != usize::MAX).max().map_or(0, |&n| n + 1);
        let mut classes = vec![Class { intervals, halved: false }; count];
        for e in 0..self.number.len() {
            if self.number[e] != usize::MAX && self.halved(e) {
                classes[self.number[e]] = Class { intervals: 2 * intervals, halved: true };
            }
        }
        classes
    }
}

fn blocks(
    surface: &Surface,
    topology: &Topology,
    face_of: &[Option<usize>],
    classes: &mut Classes,
) -> Vec<Block> {
    let joins = joins(surface, topology, face_of);
    let mut done: Vec<bool> = face_of.iter().map(Option::is_some).collect();
    let mut blocks = Vec::new();
    // Rows begin at one of their ends; what is left then are rings, which begin anywhere.
    for ends_only in [true, false] {
        for p in 0..done.len() {
            let linked: Vec<usize> = (0..4).filter(|&e| joins[p][e].is_some()).collect();
            if done[p] || (ends_only && linked.len() > 1) {
                continue;
            }
            match &topology.domains[p] {
                Domain::Rectangle { .. } => {
                    // The row leaves this patch on its right side.
                    let turn = linked.first().map_or(0, |&e| (e + 3) % 4);
                    blocks.push(row(topology, &joins, classes, &mut done, p, turn));
                }
                Domain::Polygon(corners) => {
                    done[p] = true;
                    blocks.extend(kites(topology, classes, p, corners));
                }
                Domain::Trimmed(_) => {}
            }
        }
    }
    blocks
}

/// Across which edges of strips the next one continues the parameters, and the ratio of the lengths of their intervals.
fn joins(surface: &Surface, topology: &Topology, face_of: &[Option<usize>]) -> Vec<[Option<Join>; 4]> {
    let strip = |p: usize| {
        matches!(surface.patches()[p].kind(), PatchKind::Strip { .. } | PatchKind::AdjacentStrip)
            && matches!(topology.domains[p], Domain::Rectangle { .. })
    };
    // Beside the row lie exact faces, or nothing: their curves are cut as the row is.
    let free = |p: usize, edge: usize| {
        [1, 3].iter().all(|s| {
            topology.across(p, (edge + s) % 4).is_none_or(|(q, _, same)| face_of[q].is_some() && !same)
        })
    };
    let mut joins = vec![[None; 4]; topology.domains.len()];
    for p in (0..joins.len()).filter(|&p| strip(p)) {
        for edge in 0..4 {
            if let Some((q, f, false)) = topology.across(p, edge)
                && q != p
                && strip(q)
                && free(p, edge)
                && free(q, f)
            {
                let block = |patch: usize, turn: usize| Block {
                    pieces: vec![piece(topology, patch, turn, [0.0, 1.0], 0)],
                    height: 1.0,
                    class: 0,
                };
                let (a, b) = (block(p, (edge + 3) % 4), block(q, (f + 1) % 4));
                joins[p][edge] = ratio(surface, &a, &b).map(|ratio| (q, f, ratio));
            }
        }
    }
    // What joins one way joins the other way: rounding may not decide otherwise.
    for p in 0..joins.len() {
        for edge in 0..4 {
            if let Some((q, f, ratio)) = joins[p][edge] {
                let back: Option<Join> = joins[q][f];
                joins[p][edge] = back.map(|_| (q, f, ratio));
            }
        }
    }
    joins
}

/// The ratio of the lengths of `b` and `a` with which `b` continues `a` C², if there is one.
fn ratio(surface: &Surface, a: &Block, b: &Block) -> Option<f64> {
    let sites = [0.0, 0.17, 0.5, 0.71, 1.0];
    let jets = sites.map(|y| (a.jet(surface, 0, 1.0, y), b.jet(surface, 0, 0.0, y)));
    let sum = |f: &dyn Fn(&(Jet2, Jet2)) -> f64| jets.iter().map(f).sum::<f64>();
    let ratio = sum(&|(a, b)| a.du.dot(b.du)) / sum(&|(a, _)| a.du.length_squared());
    let good = ratio > 1e-3
        && ratio < 1e3
        && jets.iter().all(|(a, b)| {
            let first = (a.du * ratio).distance(b.du);
            let second = (a.duu * ratio * ratio).distance(b.duu);
            first <= JOIN * b.du.length() && second <= JOIN * (b.du.length() + b.duu.length())
        });
    good.then_some(ratio)
}

fn piece(topology: &Topology, patch: usize, turn: usize, span: [f64; 2], class: usize) -> Piece {
    let corner =
        |k: usize| topology.domains[patch].edge((turn + k) % 4).map_or(DVec2::ZERO, |e| e.point(0.0));
    let vertex = |k: usize| topology.corner(patch, (turn + k) % 4);
    Piece { patch, quad: [0, 1, 2, 3].map(corner), corners: [0, 1, 2, 3].map(vertex), span, class }
}

/// The row that begins with `patch`, whose edge `turn` is its bottom.
fn row(
    topology: &Topology,
    joins: &[[Option<Join>; 4]],
    classes: &Classes,
    done: &mut [bool],
    patch: usize,
    turn: usize,
) -> Block {
    let class = |p: usize, e: usize| classes.of(topology.first[p] + e);
    let (mut p, mut turn) = (patch, turn);
    let mut pieces = Vec::new();
    let (mut at, mut length) = (0.0, 1.0);
    let side = class(p, (turn + 1) % 4);
    loop {
        done[p] = true;
        pieces.push(piece(topology, p, turn, [at, at + length], class(p, turn)));
        at += length;
        match joins[p][(turn + 1) % 4] {
            Some((q, f, ratio)) if !done[q] => {
                length *= ratio;
                (p, turn) = (q, (f + 1) % 4);
            }
            _ => break,
        }
    }
    Block { pieces, height: 1.0, class: side }
}

fn kites<'a>(
    topology: &'a Topology,
    classes: &Classes,
    patch: usize,
    corners: &'a [DVec2],
) -> impl Iterator<Item = Block> + use<'a> {
    let n = corners.len();
    let class = classes.of(topology.first[patch]);
    let centre = corners.iter().sum::<DVec2>() / n as f64;
    let middle = move |k: usize| (corners[k] + corners[(k + 1) % n]) * 0.5;
    (0..n).map(move |k| {
        let before = (k + n - 1) % n;
        let vertices = [
            topology.corner(patch, k),
            topology.middle(patch, k),
            Vertex::Centre(patch),
            topology.middle(patch, before),
        ];
        let quad = [corners[k], middle(k), centre, middle(before)];
        let piece = Piece { patch, quad, corners: vertices, span: [0.0, 0.5], class };
        Block { pieces: vec![piece], height: 0.5, class }
    })
}

/// The parts of the sides of every block that lie on edges of patches, in the order of the side's parameter.
fn stretches(topology: &Topology, blocks: &[Block]) -> Vec<[Vec<Stretch>; 4]> {
    let kite = |b: usize| blocks[b].height < 1.0;
    let mut corner = vec![0; topology.domains.len()];
    (0..blocks.len())
        .map(|block| {
            let mut sides: [Vec<Stretch>; 4] = Default::default();
            let class = blocks[block].class;
            if kite(block) {
                let patch = blocks[block].pieces[0].patch;
                let n = topology.domains[patch].edge_count();
                let k = corner[patch];
                corner[patch] += 1;
                let base = Stretch {
                    patch,
                    edge: k,
                    t: [0.0, 0.5],
                    block,
                    side: 0,
                    s: [0.0, 0.5],
                    class,
                    whole: true,
                };
                sides[0].push(base);
                sides[3].push(Stretch { edge: (k + n - 1) % n, side: 3, t: [1.0, 0.5], ..base });
                return sides;
            }
            let last = blocks[block].pieces.len() - 1;
            for (k, piece) in blocks[block].pieces.iter().enumerate() {
                let patch = piece.patch;
                let is = |e: &usize| {
                    topology.domains[patch].edge(*e).is_some_and(|c| c.point(0.0) == piece.quad[0])
                };
                let turn = (0..4).find(is).unwrap_or_default();
                for side in 0..4 {
                    let outer = match side {
                        1 => k == last,
                        3 => k == 0,
                        _ => true,
                    };
                    if outer {
                        let (s, class) =
                            if side % 2 == 0 { (piece.span, piece.class) } else { ([0.0, 1.0], class) };
                        let t = if side < 2 { [0.0, 1.0] } else { [1.0, 0.0] };
                        let whole = side % 2 == 1 || last == 0;
                        let edge = (turn + side) % 4;
                        sides[side].push(Stretch { patch, edge, t, block, side, s, class, whole });
                    }
                }
            }
            sides
        })
        .collect()
}

/// A part of a stretch between the parameters `t` of its edge.
fn part(stretch: &Stretch, t: [f64; 2]) -> [f64; 2] {
    let at = |t: f64| {
        if t == stretch.t[0] {
            stretch.s[0]
        } else if t == stretch.t[1] {
            stretch.s[1]
        } else {
            let r = (t - stretch.t[0]) / (stretch.t[1] - stretch.t[0]);
            stretch.s[0] + (stretch.s[1] - stretch.s[0]) * r
        }
    };
    t.map(at)
}

fn edges(
    topology: &Topology,
    face_of: &[Option<usize>],
    blocks: &[Block],
    sides: &[[Vec<Stretch>; 4]],
    classes: &Classes,
) -> Vec<LayoutEdge> {
    // Which stretches lie on an edge.
    let mut on: Vec<Vec<Stretch>> = vec![Vec::new(); topology.patch_of.len()];
    for stretch in sides.iter().flatten().flatten() {
        on[topology.first[stretch.patch] + stretch.edge].push(*stretch);
    }
    let root = |e: usize| classes.sets.find(e);
    let mut edges = Vec::new();
    for stretches in sides.iter().flatten() {
        let mut last: Option<(usize, usize, usize)> = None;
        for stretch in stretches {
            let e = topology.first[stretch.patch] + stretch.edge;
            let across = topology.across(stretch.patch, stretch.edge);
            let [t0, t1] = stretch.t;
            let cuts = if classes.halved[root(e)] && (t1 - t0).abs() > 0.75 {
                vec![[t0, 0.5], [0.5, t1]]
            } else {
                vec![[t0, t1]]
            };
            for t in cuts {
                let s = part(stretch, t);
                let own = Use::Block { block: stretch.block, side: stretch.side, ends: s };
                let ends = t.map(|t| topology.vertex(stretch.patch, stretch.edge, t));
                let mut edge = LayoutEdge {
                    ends,
                    joints: s.to_vec(),
                    uses: vec![own],
                    classes: vec![Some(stretch.class)],
                };
                let Some((q, f, same)) = across else {
                    edges.push(edge);
                    continue;
                };
                let u = if same { t } else { t.map(|t| 1.0 - t) };
                if let Some(face) = face_of[q] {
                    // Consecutive edges of one exact face along one side are one edge. Both walk with themselves on the left: the
                    // face passes the bottom of a block against `a`, its top along `a`.
                    let domain = &topology.domains[q];
                    let goes_on = |before: usize| match stretch.side {
                        0 => domain.next_edge(f) == before,
                        _ => domain.next_edge(before) == f,
                    };
                    let one_piece = t == stretch.t && stretch.side % 2 == 0 && !same;
                    match last {
                        Some((number, face_before, before))
                            if one_piece && face_before == face && goes_on(before) =>
                        {
                            let whole: &mut LayoutEdge = &mut edges[number];
                            whole.ends[1] = edge.ends[1];
                            whole.joints.push(s[1]);
                            whole.classes.push(Some(stretch.class));
                            for one in &mut whole.uses {
                                match one {
                                    Use::Block { ends, .. } => ends[1] = s[1],
                                    Use::Exact { parts, .. } => parts.push((f, u)),
                                }
                            }
                            last = Some((number, face, f));
                        }
                        _ => {
                            last = one_piece.then_some((edges.len(), face, f));
                            edge.uses.push(Use::Exact { face, parts: vec![(f, u)] });
                            edges.push(edge);
                        }
                    }
                    continue;
                }
                let lies = |x: &&Stretch| {
                    let [lo, hi] = [x.t[0].min(x.t[1]), x.t[0].max(x.t[1])];
                    u.iter().all(|&u| lo <= u && u <= hi)
                };
                let Some(other) = on[topology.first[q] + f].iter().find(lies) else {
                    edges.push(edge);
                    continue;
                };
                let mine = (!(stretch.whole && t == stretch.t), stretch.block, stretch.side);
                let other_whole = other.whole && (u == other.t || [u[1], u[0]] == other.t);
                if mine < (!other_whole, other.block, other.side) {
                    edge.uses.push(Use::Block { block: other.block, side: other.side, ends: part(other, u) });
                    edges.push(edge);
                }
            }
        }
    }
    edges.extend(spokes(topology, blocks));
    edges.extend(exact_edges(topology, face_of));
    edges
}

/// The edges from the middles of the edges of an N-gon to its centre: right side of one kite, top of the next.
fn spokes(topology: &Topology, blocks: &[Block]) -> Vec<LayoutEdge> {
    let mut edges = Vec::new();
    let mut seen: Vec<usize> = vec![0; topology.domains.len()];
    for (b, block) in blocks.iter().enumerate().filter(|(_, block)| block.height < 1.0) {
        let piece = &block.pieces[0];
        let n = topology.domains[piece.patch].edge_count();
        seen[piece.patch] += 1;
        let next = if seen[piece.patch] == n { b + 1 - n } else { b + 1 };
        edges.push(LayoutEdge {
            ends: [piece.corners[1], piece.corners[2]],
            joints: vec![0.0, 0.5],
            uses: vec![
                Use::Block { block: b, side: 1, ends: [0.0, 0.5] },
                Use::Block { block: next, side: 2, ends: [0.0, 0.5] },
            ],
            classes: vec![Some(block.class)],
        });
    }
    edges
}

/// Edges between exact faces, and their borders.
fn exact_edges(topology: &Topology, face_of: &[Option<usize>]) -> Vec<LayoutEdge> {
    let mut edges = Vec::new();
    for (p, face) in face_of.iter().enumerate() {
        let Some(face) = *face else { continue };
        for e in 0..topology.domains[p].edge_count() {
            let whole = Use::Exact { face, parts: vec![(e, [0.0, 1.0])] };
            let ends = [0.0, 1.0].map(|t| topology.vertex(p, e, t));
            let mut edge =
                LayoutEdge { ends, joints: vec![0.0, 1.0], uses: vec![whole], classes: vec![None] };
            match topology.across(p, e) {
                None => edges.push(edge),
                Some((q, f, same)) => {
                    // Blocks have seen to theirs; of two exact faces the first one does.
                    if let Some(other) = face_of[q]
                        && (p, e) < (q, f)
                    {
                        let t = if same { [0.0, 1.0] } else { [1.0, 0.0] };
                        edge.uses.push(Use::Exact { face: other, parts: vec![(f, t)] });
                        edges.push(edge);
                    }
                }
            }
        }
    }
    edges
}

/// Disjoint sets; the least member stands for its set.
struct UnionFind(Vec<usize>);

impl UnionFind {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn find(&self, mut x: usize) -> usize {
        while self.0[x] != x {
            x = self.0[x];
        }
        x
    }

    fn root(&mut self, x: usize) -> usize {
        let root = self.find(x);
        let mut x = x;
        while self.0[x] != root {
            x = std::mem::replace(&mut self.0[x], root);
        }
        root
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}
