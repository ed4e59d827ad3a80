//! The tessellation: vertices of corners, curves and patches put together.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_mesh::TriMesh;
use suture_surface::{Domain, PatchId, Surface};

use crate::{
    TessellateError, TessellationOptions,
    counts::Counts,
    demand::{Demand, Extent, QuadDemand, Sample, of_edge, of_quad},
    grid::{self, PatchMesh},
    net::Net,
    options::Limits,
    planar::{self, Boundary},
};

/// Rounds of doubling the segments of curves whose polylines cross.
const ROUNDS: usize = 8;

/// A triangle mesh of a surface that knows where its vertices and triangles come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// The mesh, closed where all edges of the patches belong to seams. Normals are unit normals of [`vertex_patch`](Self::vertex_patch)
    /// at [`vertex_parameter`](Self::vertex_parameter); where the patch is singular, the mean of the triangles around.
    pub mesh: TriMesh,
    /// The patch whose evaluation gave each vertex: on seams side `a`, in corners the first patch there.
    pub vertex_patch: Vec<PatchId>,
    /// Parameter of each vertex in its patch.
    pub vertex_parameter: Vec<DVec2>,
    /// The patch of every triangle.
    pub triangle_patch: Vec<PatchId>,
    /// Parameters of the corners of every triangle in the triangle's own patch: what exact normals and curvatures are evaluated
    /// from. Counter-clockwise.
    pub corner_parameters: Vec<[DVec2; 3]>,
}

/// Triangulates a surface.
///
/// Edges that no seam names become boundary edges of the mesh. A seam with `same_direction` set makes a mesh whose triangles are
/// oriented inconsistently there, as the patches are.
///
/// # Errors
/// [`TessellateError`]: an option out of range, a domain that is not a bounded region, a point that is not finite, a loop that
/// is oriented the wrong way round or meets itself, too many vertices.
///
/// # References
/// Interior points of trimmed patches after J. Ruppert (1995), see the crate's README.
pub fn tessellate(surface: &Surface, options: &TessellationOptions) -> Result<Tessellation, TessellateError> {
    options.check()?;
    if surface.patches().is_empty() {
        return Err(TessellateError::Empty);
    }
    let domains: Vec<Domain> = surface.patches().iter().map(|p| p.domain()).collect();
    let net = Net::new(surface, &domains)?;
    let Demands { curves, patches, size } = demands(&net)?;
    if size <= 0.0 {
        return Err(TessellateError::Point);
    }
    let limits = options.limits(size);
    let mut counts = Counts::new(&net, &curves, &patches, &limits);
    uncross(&net, &mut counts)?;
    assemble(&net, &counts, &limits)
}

/// What a surface asks for.
struct Demands {
    /// Every curve.
    curves: Vec<Demand>,
    /// The interior of every rectangle and polygon.
    patches: Vec<Option<QuadDemand>>,
    /// Diagonal of the box around all samples.
    size: f64,
}

/// Samples all curves and patches.
fn demands(net: &Net) -> Result<Demands, TessellateError> {
    let curves: Vec<(Demand, Extent)> = net
        .curves
        .par_iter()
        .map(|curve| {
            let mut extent = Extent::EMPTY;
            let mut demand = of_edge(&net.frames[curve.a.0], curve.a.0, curve.a.1, &mut extent)?;
            if let Some(b) = curve.b {
                demand = demand.max(of_edge(&net.frames[b.0], b.0, b.1, &mut extent)?);
            }
            Ok((demand, extent))
        })
        .collect::<Result<_, _>>()?;
    let patches: Vec<(Option<QuadDemand>, Extent)> = net
        .frames
        .par_iter()
        .enumerate()
        .map(|(index, frame)| {
            let mut extent = Extent::EMPTY;
            let quads = match frame.domain {
                &Domain::Rectangle { min, max } => {
                    vec![[min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]]
                }
                Domain::Polygon(corners) => grid::polygon_quads(corners),
                Domain::Trimmed(_) => return Ok((None, extent)),
            };
            let mut demand = QuadDemand::default();
            for quad in quads {
                demand = demand.max(of_quad(frame, index, quad, &mut extent)?);
            }
            Ok((Some(demand), extent))
        })
        .collect::<Result<_, _>>()?;
    let extents = curves.iter().map(|c| c.1).chain(patches.iter().map(|p| p.1));
    let size = extents.fold(Extent::EMPTY, Extent::join).size();
    Ok(Demands {
        curves: curves.into_iter().map(|c| c.0).collect(),
        patches: patches.into_iter().map(|p| p.0).collect(),
        size,
    })
}

/// The boundary points of patch `index`.
fn boundary(net: &Net, counts: &Counts, index: usize) -> Boundary {
    let frame = &net.frames[index];
    Boundary::new(frame, |edge| counts.of(frame.sides[edge].curve))
}

/// Whether a patch gets a regular grid; both counts of a rectangle, or the one of a polygon.
fn grid_counts(net: &Net, counts: &Counts, index: usize) -> Option<[usize; 2]> {
    let sides = &net.frames[index].sides;
    let n: Vec<usize> = sides.iter().map(|s| counts.of(s.curve)).collect();
    let agrees = match net.frames[index].domain {
        Domain::Rectangle { .. } => n[0] == n[2] && n[1] == n[3],
        Domain::Polygon(_) => n[0].is_multiple_of(2) && n.iter().all(|&m| m == n[0]),
        Domain::Trimmed(_) => false,
    };
    (counts.structured[index] && agrees).then(|| [n[0], n[1]])
}

/// Refines curves until the boundary polylines of all freely triangulated patches are simple: two curves that pass close to each
/// other may cross as polylines although they do not as curves.
fn uncross(net: &Net, counts: &mut Counts) -> Result<(), TessellateError> {
    for round in 0..=ROUNDS {
        let crossings: Vec<(usize, usize)> = (0..net.frames.len())
            .into_par_iter()
            .filter(|&index| grid_counts(net, counts, index).is_none())
            .map(|index| {
                let boundary = boundary(net, counts, index);
                planar::check_orientation(index, &boundary)?;
                let point = planar::crossing(&net.frames[index], &boundary);
                Ok(point.map(|point| (index, boundary.edge[point])))
            })
            .collect::<Result<Vec<_>, _>>()?
            .into_iter()
            .flatten()
            .collect();
        let mut raised = false;
        for &(patch, _) in &crossings {
            // Which of the two curves is too coarse is not known; all of the patch are refined.
            for side in &net.frames[patch].sides {
                raised |= counts.raise(side.curve);
            }
        }
        match crossings.first() {
            None => break,
            Some(_) if raised && round < ROUNDS => {}
            Some(&(patch, edge)) => {
                let segments = counts.of(net.frames[patch].sides[edge].curve);
                return Err(TessellateError::SelfIntersection { patch, edge, segments });
            }
        }
    }
    Ok(())
}

/// A vertex: patch, parameter, point.
type Vertex = (usize, DVec2, Sample);

/// Triangles of a patch in numbers of the whole mesh, and its interior vertices.
struct Part {
    vertices: Vec<Vertex>,
    mesh: PatchMesh,
    ids: Vec<u32>,
    parameters: Vec<DVec2>,
}

fn assemble(net: &Net, counts: &Counts, limits: &Limits) -> Result<Tessellation, TessellateError> {
    let (mut vertices, first) = shared_vertices(net, counts)?;
    let shared = &vertices;
    let parts: Vec<Part> = (0..net.frames.len())
        .into_par_iter()
        .map(|index| part(net, counts, limits, index, shared, &first))
        .collect::<Result<_, _>>()?;
    let count = vertices.len() + parts.iter().map(|p| p.vertices.len()).sum::<usize>();
    if count > u32::MAX as usize / 6 {
        return Err(TessellateError::TooLarge { vertices: count, limit: u32::MAX as usize / 6 });
    }
    let mut faces = Vec::new();
    let mut triangle_patch = Vec::new();
    let mut corner_parameters = Vec::new();
    for (index, part) in parts.into_iter().enumerate() {
        let on_boundary = part.ids.len();
        let before = vertices.len();
        for triangle in &part.mesh.triangles {
            let ids = triangle.map(|v| {
                let v = v as usize;
                if v < on_boundary { part.ids[v] } else { (before + v - on_boundary) as u32 }
            });
            // At a collapsed edge the triangles beside it have no area.
            if ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0] {
                continue;
            }
            faces.push(ids);
            triangle_patch.push(PatchId(index as u32));
            corner_parameters.push(triangle.map(|v| part.parameters[v as usize]));
        }
        vertices.extend(part.vertices);
    }
    let mut mesh = TriMesh::new(vertices.iter().map(|v| v.2.p).collect(), faces);
    mesh.normals = Some(normals(&mesh, &vertices));
    Ok(Tessellation {
        mesh,
        vertex_patch: vertices.iter().map(|v| PatchId(v.0 as u32)).collect(),
        vertex_parameter: vertices.iter().map(|v| v.1).collect(),
        triangle_patch,
        corner_parameters,
    })
}

/// Corners, then the inner vertices of every curve; and the number of the first inner vertex of every curve.
fn shared_vertices(net: &Net, counts: &Counts) -> Result<(Vec<Vertex>, Vec<usize>), TessellateError> {
    let vertex = |(patch, edge): (usize, usize), t: f64| {
        let frame = &net.frames[patch];
        let at = frame.edges[edge].point(t);
        Ok((patch, at, frame.sample(patch, at)?))
    };
    let mut vertices =
        net.corners.par_iter().map(|&edge| vertex(edge, 0.0)).collect::<Result<Vec<Vertex>, _>>()?;
    let inner: Vec<Vec<Vertex>> = (0..net.curves.len())
        .into_par_iter()
        .map(|c| {
            let curve = &net.curves[c];
            let n = if curve.collapsed { 1 } else { counts.of(c) };
            (1..n).map(|k| vertex(curve.a, k as f64 / n as f64)).collect::<Result<_, _>>()
        })
        .collect::<Result<_, _>>()?;
    let mut first = Vec::with_capacity(inner.len());
    for points in inner {
        first.push(vertices.len());
        vertices.extend(points);
    }
    Ok((vertices, first))
}

/// Triangulates one patch.
fn part(
    net: &Net,
    counts: &Counts,
    limits: &Limits,
    index: usize,
    shared: &[Vertex],
    first: &[usize],
) -> Result<Part, TessellateError> {
    let frame = &net.frames[index];
    let boundary = boundary(net, counts, index);
    let ids = boundary_ids(net, counts, index, first);
    let inner = |points: &[DVec2]| -> Result<Vec<Vertex>, TessellateError> {
        points.iter().map(|&at| Ok((index, at, frame.sample(index, at)?))).collect()
    };
    let grid = grid_counts(net, counts, index).and_then(|n| match frame.domain {
        &Domain::Rectangle { min, max } => Some(grid::rectangle(min, max, n)),
        Domain::Polygon(corners) => Some(grid::polygon(corners, n[0])),
        Domain::Trimmed(_) => None,
    });
    let (mesh, vertices) = match grid {
        Some(grid) => {
            let vertices = inner(&grid.interior)?;
            let position = |v: u32| match ids.get(v as usize) {
                Some(&id) => shared[id as usize].2.p,
                None => vertices[v as usize - ids.len()].2.p,
            };
            (grid.split(|a, b| position(a).distance_squared(position(b))), vertices)
        }
        None => {
            let mesh = planar::triangulate(frame, index, &boundary, limits)?;
            let vertices = inner(&mesh.interior)?;
            (mesh, vertices)
        }
    };
    let mut parameters = boundary.at;
    parameters.extend(&mesh.interior);
    Ok(Part { vertices, mesh, ids, parameters })
}

/// Numbers, in the whole mesh, of the boundary points of a patch.
fn boundary_ids(net: &Net, counts: &Counts, index: usize, first: &[usize]) -> Vec<u32> {
    let frame = &net.frames[index];
    let mut ids = Vec::new();
    for edge in frame.loops.iter().cloned().flatten() {
        let side = frame.sides[edge];
        let curve = &net.curves[side.curve];
        let n = counts.of(side.curve);
        for k in 0..n {
            let k = if side.forward { k } else { n - k };
            ids.push(match k {
                0 => curve.ends[0],
                _ if k == n => curve.ends[1],
                _ if curve.collapsed => curve.ends[0],
                _ => first[side.curve] + k - 1,
            } as u32);
        }
    }
    ids
}

/// Exact normals; where the patch is singular, the mean of the triangles around, weighted by area.
fn normals(mesh: &TriMesh, vertices: &[Vertex]) -> Vec<DVec3> {
    let mut normals: Vec<DVec3> = vertices.iter().map(|v| v.2.n.unwrap_or(DVec3::ZERO)).collect();
    if vertices.iter().any(|v| v.2.n.is_none()) {
        for (f, face) in mesh.faces.iter().enumerate() {
            for &v in face.iter().filter(|&&v| vertices[v as usize].2.n.is_none()) {
                normals[v as usize] += mesh.area_vector(f);
            }
        }
        for (normal, _) in normals.iter_mut().zip(vertices).filter(|(_, v)| v.2.n.is_none()) {
            *normal = normal.normalize_or_zero();
        }
    }
    normals
}
