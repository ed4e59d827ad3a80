//! Free triangulation of a patch: constrained Delaunay in the parameter plane, scaled by the mean metric of the patch.
//!
//! # References
//! J. Ruppert, *A Delaunay refinement algorithm for quality 2-dimensional mesh generation* (1995): the refinement, here with
//! boundary segments that are never split, because the neighbouring patch has them too.

use std::ops::Range;

use glam::DVec2;
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, HasPosition, Point2, RefinementParameters, Triangulation,
    handles::FixedVertexHandle,
};

use crate::{
    TessellateError,
    grid::PatchMesh,
    net::Frame,
    options::Limits,
    sites::{Region, sites},
};

/// The boundary points of a patch, loop by loop, edge by edge.
#[derive(Debug, Default)]
pub(crate) struct Boundary {
    /// Parameters.
    pub(crate) at: Vec<DVec2>,
    /// The edge that each point starts a segment of.
    pub(crate) edge: Vec<usize>,
    /// The points of each loop.
    pub(crate) loops: Vec<Range<usize>>,
}

impl Boundary {
    /// The points of `frame` with `count(edge)` segments per edge.
    pub(crate) fn new(frame: &Frame, count: impl Fn(usize) -> usize) -> Self {
        let mut boundary = Self::default();
        for edges in &frame.loops {
            let first = boundary.at.len();
            for edge in edges.clone() {
                let n = count(edge);
                for k in 0..n {
                    boundary.at.push(frame.edges[edge].point(k as f64 / n as f64));
                    boundary.edge.push(edge);
                }
            }
            boundary.loops.push(first..boundary.at.len());
        }
        boundary
    }

    /// First and last point of every segment.
    fn segments(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.loops
            .iter()
            .flat_map(|l| l.clone().map(move |i| [i, if i + 1 < l.end { i + 1 } else { l.start }]))
    }
}

const INTERIOR: u32 = u32::MAX;

/// A vertex of the triangulation: where it is, and which boundary point it is.
#[derive(Clone, Copy, Debug)]
struct Site {
    p: Point2<f64>,
    point: u32,
}

impl From<Point2<f64>> for Site {
    fn from(p: Point2<f64>) -> Self {
        Self { p, point: INTERIOR }
    }
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.p
    }
}

type Cdt = ConstrainedDelaunayTriangulation<Site>;

/// The affine map from the parameter plane to one where the patch is, on average, isometric and the boundary of unit size.
struct Plane {
    origin: DVec2,
    /// Rows of the upper triangular matrix.
    x: DVec2,
    y: f64,
    /// Length in space of a length 1.
    unit: f64,
}

impl Plane {
    fn new(frame: &Frame, boundary: &Boundary) -> Self {
        let lo = boundary.at.iter().fold(DVec2::INFINITY, |a, &b| a.min(b));
        let hi = boundary.at.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b));
        let [mut e, mut f, mut g] = [0.0; 3];
        for &at in &boundary.at {
            let jet = frame.patch.jet(at);
            e += jet.du.length_squared();
            f += jet.du.dot(jet.dv);
            g += jet.dv.length_squared();
        }
        let mean = boundary.at.len() as f64;
        [e, f, g] = [e / mean, f / mean, g / mean];
        // Cholesky; a metric that is nearly singular or not finite says nothing about the shape of triangles.
        let det = e * g - f * f;
        let (x, y) = if det.is_finite() && det > 1e-6 * e * g {
            (DVec2::new(e.sqrt(), f / e.sqrt()), (det / e).sqrt())
        } else {
            let d = hi - lo;
            (DVec2::new(1.0 / d.x, 0.0), 1.0 / d.y)
        };
        let mut plane = Self { origin: lo, x, y, unit: 1.0 };
        let size = boundary.at.iter().fold(0.0_f64, |m, &at| m.max(plane.map(at).abs().max_element()));
        plane.x /= size;
        plane.y /= size;
        plane.unit = size;
        plane
    }

    fn map(&self, at: DVec2) -> DVec2 {
        let d = at - self.origin;
        DVec2::new(self.x.dot(d), self.y * d.y)
    }

    fn unmap(&self, p: DVec2) -> DVec2 {
        let v = p.y / self.y;
        self.origin + DVec2::new((p.x - self.x.y * v) / self.x.x, v)
    }
}

/// Signed areas of the loops: the outer one positive, holes negative.
pub(crate) fn check_orientation(index: usize, boundary: &Boundary) -> Result<(), TessellateError> {
    for (ring, points) in boundary.loops.iter().enumerate() {
        let at = &boundary.at[points.clone()];
        let area: f64 = at.windows(2).map(|w| 0.5 * (w[0] - at[0]).perp_dot(w[1] - at[0])).sum();
        if (ring == 0) != (area > 0.0) {
            return Err(TessellateError::Orientation { patch: index, ring, area });
        }
    }
    Ok(())
}

/// The triangulation of the boundary alone.
///
/// # Errors
/// The number of a boundary point whose segment meets another one.
fn outline(plane: &Plane, boundary: &Boundary) -> Result<(Cdt, Vec<FixedVertexHandle>), usize> {
    let mut cdt = Cdt::new();
    let mut handles = Vec::with_capacity(boundary.at.len());
    for (i, &at) in boundary.at.iter().enumerate() {
        let handle = cdt.insert(Site { p: spade_point(plane.map(at)), point: i as u32 }).map_err(|_| i)?;
        if handle.index() != i {
            return Err(i);
        }
        handles.push(handle);
    }
    for [a, b] in boundary.segments() {
        let (from, to) = (handles[a], handles[b]);
        if !cdt.can_add_constraint(from, to) {
            return Err(a);
        }
        cdt.add_constraint(from, to);
        // A vertex on the segment splits it in two.
        if !cdt.exists_constraint(from, to) {
            return Err(a);
        }
    }
    Ok((cdt, handles))
}

/// Whether the boundary polyline is simple; otherwise a boundary point whose segment meets another one.
pub(crate) fn crossing(frame: &Frame, boundary: &Boundary) -> Option<usize> {
    outline(&Plane::new(frame, boundary), boundary).err()
}

/// Triangulates a patch with the given boundary points.
pub(crate) fn triangulate(
    frame: &Frame,
    index: usize,
    boundary: &Boundary,
    limits: &Limits,
) -> Result<PatchMesh, TessellateError> {
    let meets_itself = |point: usize| {
        let edge = boundary.edge[point];
        let segments = boundary.edge.iter().filter(|&&e| e == edge).count();
        TessellateError::SelfIntersection { patch: index, edge, segments }
    };
    let plane = Plane::new(frame, boundary);
    let (mut cdt, handles) = outline(&plane, boundary).map_err(meets_itself)?;
    let region = Region::new(
        boundary
            .segments()
            .map(|s| s.map(|i| handles[i]))
            .map(|s| s.map(|h| dvec(cdt.vertex(h).position())))
            .collect(),
    );
    let inner = sites(&region, plane.unit, limits, |p| frame.sample(index, plane.unmap(p)))?;
    for p in inner {
        // Positions inside the unit square are never refused; a lost point costs shape, not topology.
        let _ = cdt.insert(spade_point(p).into());
    }
    cdt.refine(
        RefinementParameters::new()
            .with_angle_limit(AngleLimit::from_deg(20.0))
            .with_max_additional_vertices(cdt.num_vertices())
            .keep_constraint_edges()
            .exclude_outer_faces(true),
    );
    split_chords(&mut cdt, &handles, boundary).map_err(meets_itself)?;
    let inside = inside(&cdt, &handles, boundary).map_err(meets_itself)?;
    let mut number = vec![INTERIOR; cdt.num_vertices()];
    let mut mesh = PatchMesh::default();
    for face in cdt.inner_faces().filter(|f| inside[f.fix().index()]) {
        mesh.triangles.push(face.vertices().map(|v| {
            let site = v.data();
            if site.point != INTERIOR {
                return site.point;
            }
            let slot = &mut number[v.fix().index()];
            if *slot == INTERIOR {
                *slot = (boundary.at.len() + mesh.interior.len()) as u32;
                mesh.interior.push(plane.unmap(dvec(site.p)));
            }
            *slot
        }));
    }
    Ok(mesh)
}

/// Puts a vertex on every inner edge between two boundary points: the patch on the other side of the boundary may have the same
/// edge. The new edges all end in the new vertices, so one pass suffices.
fn split_chords(cdt: &mut Cdt, handles: &[FixedVertexHandle], boundary: &Boundary) -> Result<(), usize> {
    let inside = inside(cdt, handles, boundary)?;
    let chords: Vec<[FixedVertexHandle; 2]> = cdt
        .undirected_edges()
        .filter(|e| {
            !e.is_constraint_edge()
                && e.vertices().iter().all(|v| v.data().point != INTERIOR)
                && e.as_directed().face().as_inner().is_some_and(|f| inside[f.fix().index()])
        })
        .map(|e| e.vertices().map(|v| v.fix()))
        .collect();
    for [a, b] in chords {
        let Some(edge) = cdt.get_edge_from_neighbors(a, b) else { continue };
        let [p, q] = edge.positions().map(dvec);
        // The apexes on both sides with the areas of their triangles.
        let apex = |e: spade::handles::DirectedEdgeHandle<Site, (), spade::CdtEdge<()>, ()>| {
            e.opposite_position().map(dvec).map(|r| (r, (q - p).perp_dot(r - p).abs()))
        };
        let sides = [apex(edge), apex(edge.rev())];
        let (Some(left), Some(right)) = (sides[0], sides[1]) else { continue };
        let (thin, thick) = if left.1 < right.1 { (left, right) } else { (right, left) };
        // The middle of a chord beside a needle is on the boundary but for rounding; the middle of the other triangle is not.
        let split =
            if thin.1 > 1e-6 * (q - p).length_squared() { (p + q) * 0.5 } else { (p + q + thick.0) / 3.0 };
        let _ = cdt.insert(spade_point(split).into());
    }
    Ok(())
}

/// Which faces lie inside: reached from the left of the boundary without crossing it. Errors as [`outline`].
fn inside(cdt: &Cdt, handles: &[FixedVertexHandle], boundary: &Boundary) -> Result<Vec<bool>, usize> {
    let mut inside = vec![false; cdt.num_all_faces()];
    let mut stack = Vec::new();
    for [a, b] in boundary.segments() {
        let edge = cdt
            .get_edge_from_neighbors(handles[a], handles[b])
            .filter(|e| e.is_constraint_edge())
            .ok_or(a)?;
        let face = edge.face().as_inner().ok_or(a)?.fix();
        if !std::mem::replace(&mut inside[face.index()], true) {
            stack.push(face);
        }
    }
    while let Some(face) = stack.pop() {
        for edge in cdt.face(face).adjacent_edges() {
            if edge.is_constraint_edge() {
                continue;
            }
            // Inside the boundary there is no way to the unbounded face, unless a hole lies outside the outer loop.
            let Some(next) = edge.rev().face().as_inner().map(|f| f.fix()) else {
                return Err(boundary.loops.last().map_or(0, |l| l.start));
            };
            if !std::mem::replace(&mut inside[next.index()], true) {
                stack.push(next);
            }
        }
    }
    Ok(inside)
}

/// Rounds to zero what is so small that the triangulation refuses it: far below the resolution at size 1.
fn spade_point(p: DVec2) -> Point2<f64> {
    let flush = |x: f64| if x.abs() < 1e-40 { 0.0 } else { x };
    Point2::new(flush(p.x), flush(p.y))
}

fn dvec(p: Point2<f64>) -> DVec2 {
    DVec2::new(p.x, p.y)
}
