//! Which faces, edges and vertices a surface becomes.
//!
//! A patch whose B-spline is known is one face as it is. Every other patch becomes four-sided *blocks*, to be refitted: a rectangle is
//! one block, an N-gon is N kites (corner, middle of the edge after it, centre, middle of the edge before it), and rectangles in a row that
//! join C² up to a linear change of the parameter, as the strips of an arc do, are one block of several *pieces*. Along a block run `a`
//! and `b`, counter-clockwise from its lower left corner its sides are bottom, right, top and left.
//!
//! Sides that lie opposite each other or on each other have the same nodes ([`nodes`]).

mod nodes;
mod rows;
mod sides;
mod topology;

use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;
use suture_surface::{Domain, Jet2, Patch, PatchKind, SplinePool, Surface};

use self::nodes::Halves;
pub(crate) use self::nodes::{Class, Interval, Ruler};
use self::topology::Topology;
pub(crate) use self::topology::Vertex;
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
    /// Nodes of the sides left and right.
    pub(crate) ruler: Ruler,
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
    /// Nodes of its sides bottom and top.
    pub(crate) ruler: Ruler,
}

/// A patch whose surface is known.
#[derive(Debug)]
pub(crate) struct Exact {
    pub(crate) patch: usize,
    pub(crate) geometry: Geometry,
    /// Whether the geometry's normals are against those of the patch.
    pub(crate) against: bool,
}

/// An edge with its one or two uses, the owner first: the side of a block that gives its curve, or the only one.
#[derive(Debug)]
pub(crate) struct LayoutEdge {
    pub(crate) ends: [Vertex; 2],
    /// Parameters at the ends and where the patches change in between.
    pub(crate) joints: Vec<f64>,
    pub(crate) uses: Vec<Use>,
    /// Nodes of every part between joints; none where no block takes part.
    pub(crate) rulers: Vec<Option<Ruler>>,
}

/// An edge as a face sees it.
#[derive(Clone, Debug)]
pub(crate) enum Use {
    /// On a side of a block, from one value of `a` or `b` to another.
    Block { block: usize, side: usize, ends: [f64; 2] },
    /// On edges of the domain of an exact face, each from one parameter to another.
    Exact { face: usize, parts: Vec<(usize, [f64; 2])> },
}

impl Layout {
    /// Lays out `surface`, with `intervals` on every half of an edge.
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
        let halves = Halves::new(&topology, &face_of);
        let blocks = rows::blocks(surface, &topology, &face_of, &halves);
        let edges = sides::edges(&topology, &face_of, &blocks, &halves);
        let shells = topology.shells();
        let classes = halves.classes(intervals);
        Ok(Self { domains: topology.domains, blocks, exact, edges, classes, shells })
    }

    /// The nodes of a block along `a` and `b`, break by break.
    pub(crate) fn nodes(&self, block: &Block) -> [Vec<Vec<f64>>; 2] {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for piece in &block.pieces {
            piece.ruler.nodes(&self.classes, piece.span, &mut a);
        }
        block.ruler.nodes(&self.classes, [0.0, block.height], &mut b);
        [a, b]
    }

    /// The intervals between these nodes, with the piece they lie on.
    pub(crate) fn intervals(&self, block: &Block) -> [Vec<(usize, Interval)>; 2] {
        let of = |k: usize, ruler: &Ruler, span| {
            ruler.intervals(&self.classes, span).into_iter().map(move |i| (k, i)).collect::<Vec<_>>()
        };
        let a = block.pieces.iter().enumerate().flat_map(|(k, p)| of(k, &p.ruler, p.span)).collect();
        [a, of(0, &block.ruler, [0.0, block.height])]
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
