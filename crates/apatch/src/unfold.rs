//! Folds taken out of a mesh: no tetrahedra fit between two faces that lie on each other, and no normal sees both.
//!
//! Such a fold mostly is a triangle turned over by noise. Turning an edge of its to the other diagonal of the two faces beside it lays it
//! back, and moves no vertex.

use glam::DVec3;
use suture_mesh::{Topology, TopologyError, TriMesh};

/// Cosine of the angle (135 degrees) between the normals of two faces beyond which they count as folded.
const FOLDED: f64 = -std::f64::consts::FRAC_1_SQRT_2;

/// What the sum over the five edges of a turn must lose: half a fold.
const GAIN: f64 = 1.0;

/// Smallest height of a new face over its longest edge, relative to that edge.
const LEAST_HEIGHT: f64 = 1e-3;

/// Sweeps over the mesh; a turn may make the next one possible.
const SWEEPS: usize = 16;

/// A mesh with some edges turned.
#[derive(Clone)]
pub(crate) struct Unfolded {
    pub(crate) mesh: TriMesh,
    pub(crate) topology: Topology,
    /// The ends of the edges that were turned.
    pub(crate) edges: Vec<[u32; 2]>,
    /// The vertices of the faces beside them, in order.
    pub(crate) vertices: Vec<u32>,
}

impl Unfolded {
    /// The mesh as it is.
    pub(crate) fn none(mesh: &TriMesh, topology: &Topology) -> Self {
        Self { mesh: mesh.clone(), topology: topology.clone(), edges: Vec::new(), vertices: Vec::new() }
    }
}

/// Turns edges of the given faces, and of those beside them, where that takes a fold away. `None` where there is nothing to turn.
///
/// # References
/// N. Dyn, K. Hormann, S.-J. Kim, D. Levin, *Optimizing 3D triangulations using discrete curvature analysis*, 2001: the best turn first.
pub(crate) fn unfold(
    mesh: &TriMesh,
    topology: &Topology,
    faces: &[usize],
) -> Result<Option<Unfolded>, TopologyError> {
    let mut out = Unfolded::none(mesh, topology);
    let mut near = vec![false; mesh.faces.len()];
    for &f in faces {
        near[f] = true;
        let beside = (3 * f as u32..3 * f as u32 + 3).filter_map(|h| topology.opposite(h));
        beside.for_each(|o| near[topology.face(o) as usize] = true);
    }
    for _ in 0..SWEEPS {
        let t = &out.topology;
        let mut turns: Vec<Turn> = (0..t.half_edge_count() as u32)
            .filter(|&h| near[t.face(h) as usize])
            .filter_map(|h| Turn::new(&out.mesh, t, h))
            .filter(|turn| turn.least < FOLDED && turn.gain > GAIN)
            .collect();
        if turns.is_empty() {
            break;
        }
        turns.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.edge.cmp(&b.edge)));
        let mut taken = vec![false; mesh.faces.len()];
        for turn in turns {
            // What a turn gains depends on the faces around.
            if turn.around.iter().any(|&f| taken[f as usize]) {
                continue;
            }
            turn.around.iter().for_each(|&f| taken[f as usize] = true);
            for (f, face) in turn.faces {
                out.mesh.faces[f as usize] = face;
                near[f as usize] = true;
                out.vertices.extend(face);
            }
            out.edges.push(turn.edge);
        }
        out.topology = Topology::build(&out.mesh)?;
    }
    out.vertices.sort_unstable();
    out.vertices.dedup();
    Ok((!out.edges.is_empty()).then_some(out))
}

/// One more edge turned, that of a half-edge, whatever it gains; `None` where that leaves no manifold, or faces without height.
pub(crate) fn turn(from: &Unfolded, h: u32) -> Result<Option<Unfolded>, TopologyError> {
    let Some(turn) = Turn::new(&from.mesh, &from.topology, h) else { return Ok(None) };
    let mut out = from.clone();
    for (f, face) in turn.faces {
        out.mesh.faces[f as usize] = face;
        out.vertices.extend(face);
    }
    out.vertices.sort_unstable();
    out.vertices.dedup();
    out.edges.push(turn.edge);
    out.topology = Topology::build(&out.mesh)?;
    Ok(Some(out))
}

/// An edge to be turned.
struct Turn {
    /// What the sum over five edges of the squares of `1 − cos` of their angles loses.
    gain: f64,
    /// The least cosine of these angles before.
    least: f64,
    edge: [u32; 2],
    /// The two new faces, in place of the old ones.
    faces: [(u32, [u32; 3]); 2],
    /// The faces that share an edge with them, and themselves.
    around: Vec<u32>,
}

impl Turn {
    /// The turn of the edge of a half-edge, if it leaves a manifold.
    fn new(mesh: &TriMesh, topology: &Topology, h: u32) -> Option<Self> {
        let o = topology.opposite(h)?;
        let [f, g] = [h, o].map(|h| topology.face(h));
        let [a, b] = [topology.tail(h), topology.head(h)];
        let [c, d] = [h, o].map(|h| topology.tail(topology.prev(h)));
        // Inner vertices keep three faces, those on the boundary one.
        let spare = |v: u32| {
            let faces = topology.outgoing(v).count();
            faces > if topology.is_boundary_vertex(v) { 1 } else { 3 }
        };
        if c == d || !(spare(a) && spare(b)) || joined(topology, c, d) {
            return None;
        }
        let normal = |v: [u32; 3]| {
            let [p, q, r] = v.map(|v| mesh.positions[v as usize]);
            (q - p).cross(r - p).normalize_or_zero()
        };
        let outer = [
            (topology.next(h), 0, 1),
            (topology.prev(h), 0, 0),
            (topology.next(o), 1, 0),
            (topology.prev(o), 1, 1),
        ];
        let faces = [[a, d, c], [b, c, d]];
        let old = [f, g].map(|f| normal(mesh.faces[f as usize]));
        let new = faces.map(normal);
        if !faces.iter().all(|face| is_fat(face.map(|v| mesh.positions[v as usize]))) {
            return None;
        }
        let fold = |m: DVec3, n: DVec3| (1.0 - m.dot(n)).powi(2);
        let (mut before, mut after) = (fold(old[0], old[1]), fold(new[0], new[1]));
        let mut least = old[0].dot(old[1]);
        let mut around = vec![f, g];
        for (h, was, is) in outer {
            let Some(x) = topology.opposite(h) else { continue };
            let x = topology.face(x);
            let n = normal(mesh.faces[x as usize]);
            least = least.min(n.dot(old[was]));
            before += fold(n, old[was]);
            after += fold(n, new[is]);
            around.push(x);
        }
        let gain = before - after;
        let edge = if a < b { [a, b] } else { [b, a] };
        Some(Self { gain, least, edge, faces: [(f, faces[0]), (g, faces[1])], around })
    }
}

/// Whether an edge runs between two vertices.
fn joined(topology: &Topology, c: u32, d: u32) -> bool {
    topology.half_edge(c, d).or_else(|| topology.half_edge(d, c)).is_some()
}

fn is_fat([a, b, c]: [DVec3; 3]) -> bool {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    (b - a).cross(c - a).length() >= LEAST_HEIGHT * longest * longest
}
