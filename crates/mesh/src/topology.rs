//! Half-edge adjacency of an oriented manifold mesh.

use crate::TriMesh;

const NONE: u32 = u32::MAX;

/// Half-edge adjacency of an oriented manifold mesh, with or without boundary.
///
/// Half-edge `h = 3 f + k` runs along face `f` from its `k`-th vertex to the next one, with the face on its left; nothing is
/// stored per half-edge but its opposite.
///
/// # Panics
/// All methods panic on half-edges and vertices that do not exist.
#[derive(Clone, Debug)]
pub struct Topology {
    tails: Vec<u32>,
    opposites: Vec<u32>,
    outgoing: Vec<u32>,
}

/// Why a mesh has no half-edge adjacency; `suture check` lists every such defect.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// The mesh has no faces.
    #[error("the mesh has no faces")]
    Empty,
    /// More half-edges than 32-bit indices can hold.
    #[error("the mesh has {faces} faces; at most {limit} are supported")]
    TooLarge {
        /// Number of faces.
        faces: usize,
        /// Largest supported number.
        limit: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are only {vertices}")]
    VertexIndex {
        /// The face.
        face: usize,
        /// The missing vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A face names one vertex twice.
    #[error("face {face} names vertex {vertex} twice; remove the face")]
    RepeatedVertex {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// Two faces run through one edge in the same direction: the edge is non-manifold or the faces are oriented inconsistently.
    #[error(
        "faces {} and {} run through the edge {} → {} in the same direction: it has more than two faces, or one of them is flipped",
        faces[0], faces[1], edge[0], edge[1]
    )]
    Edge {
        /// Tail and head.
        edge: [u32; 2],
        /// The two faces.
        faces: [usize; 2],
    },
    /// The faces around a vertex form more than one fan.
    #[error("the faces around vertex {vertex} form more than one fan; split the vertex")]
    Vertex {
        /// The vertex.
        vertex: u32,
    },
}

impl Topology {
    /// Builds the adjacency in O(vertices + faces), whatever the valences.
    ///
    /// # Errors
    /// [`TopologyError`], the first defect in the order of faces, then of vertices.
    pub fn build(mesh: &TriMesh) -> Result<Self, TopologyError> {
        let limit = (NONE / 3) as usize;
        if mesh.faces.is_empty() {
            return Err(TopologyError::Empty);
        }
        if mesh.faces.len() > limit {
            return Err(TopologyError::TooLarge { faces: mesh.faces.len(), limit });
        }
        let vertices = mesh.positions.len();
        let bad_face =
            mesh.faces.iter().enumerate().find_map(|(f, c)| Some((f, bad_corner(f, c, vertices)?)));
        // An edge defect before the bad face comes first.
        let good = bad_face.as_ref().map_or(mesh.faces.len(), |(f, _)| *f);
        let tails: Vec<u32> = mesh.faces[..good].iter().flatten().copied().collect();
        let opposites = opposites(&tails, vertices)?;
        if let Some((_, error)) = bad_face {
            return Err(error);
        }
        // At a boundary vertex, start with the half-edge whose opposite is missing: turning counter-clockwise from it visits
        // the whole fan.
        let mut outgoing = vec![NONE; vertices];
        let mut valence = vec![0u32; vertices];
        for (h, &v) in tails.iter().enumerate() {
            valence[v as usize] += 1;
            if outgoing[v as usize] == NONE || opposites[h] == NONE {
                outgoing[v as usize] = h as u32;
            }
        }
        let topology = Self { tails, opposites, outgoing };
        for (vertex, &valence) in (0u32..).zip(&valence) {
            if topology.outgoing(vertex).count() != valence as usize {
                return Err(TopologyError::Vertex { vertex });
            }
        }
        Ok(topology)
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.tails.len() / 3
    }

    /// Number of half-edges, three per face.
    pub fn half_edge_count(&self) -> usize {
        self.tails.len()
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        let boundary = self.opposites.iter().filter(|&&o| o == NONE).count();
        (self.tails.len() + boundary) / 2
    }

    /// Number of vertices, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.outgoing.len()
    }

    /// The face on the left of `h`.
    pub fn face(&self, h: u32) -> u32 {
        h / 3
    }

    /// The vertex where `h` starts.
    pub fn tail(&self, h: u32) -> u32 {
        self.tails[h as usize]
    }

    /// The vertex where `h` ends.
    pub fn head(&self, h: u32) -> u32 {
        self.tail(self.next(h))
    }

    /// The next half-edge of the same face.
    pub fn next(&self, h: u32) -> u32 {
        h - h % 3 + (h + 1) % 3
    }

    /// The previous half-edge of the same face.
    pub fn prev(&self, h: u32) -> u32 {
        h - h % 3 + (h + 2) % 3
    }

    /// The half-edge of the neighbouring face; `None` on the boundary.
    pub fn opposite(&self, h: u32) -> Option<u32> {
        let o = self.opposites[h as usize];
        (o != NONE).then_some(o)
    }

    /// The half-edges that leave `v`, counter-clockwise; at a boundary vertex beginning with the boundary half-edge. Empty at an
    /// isolated vertex.
    pub fn outgoing(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.outgoing[v as usize];
        let mut at = (first != NONE).then_some(first);
        std::iter::from_fn(move || {
            let h = at?;
            at = self.opposite(self.prev(h)).filter(|&n| n != first);
            Some(h)
        })
    }

    /// The half-edge from `a` to `b`, if there is one.
    pub fn half_edge(&self, a: u32, b: u32) -> Option<u32> {
        self.outgoing(a).find(|&h| self.head(h) == b)
    }

    /// Whether no half-edge lacks its opposite.
    pub fn is_closed(&self) -> bool {
        self.opposites.iter().all(|&o| o != NONE)
    }

    /// Whether `v` lies on the boundary; an isolated vertex does not.
    pub fn is_boundary_vertex(&self, v: u32) -> bool {
        self.outgoing(v).next().is_some_and(|h| self.opposite(h).is_none())
    }

    /// The boundary loops: half-edges without opposite, each followed by the one that leaves where it ends; the surface is on
    /// the left. In the order of their lowest half-edges, with which they begin.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.tails.len()];
        let mut loops = Vec::new();
        for first in 0..self.tails.len() as u32 {
            let mut walk = Vec::new();
            let mut h = first;
            while self.opposite(h).is_none() && !std::mem::replace(&mut seen[h as usize], true) {
                walk.push(h);
                // One fan per vertex: its first half-edge is the only one on the boundary that leaves it.
                h = self.outgoing[self.head(h) as usize];
            }
            if !walk.is_empty() {
                loops.push(walk);
            }
        }
        loops
    }
}

fn bad_corner(face: usize, corners: &[u32; 3], vertices: usize) -> Option<TopologyError> {
    (0..3).find_map(|k| {
        let vertex = corners[k];
        if vertex as usize >= vertices {
            return Some(TopologyError::VertexIndex { face, vertex, vertices });
        }
        let repeated = vertex == corners[(k + 1) % 3] || vertex == corners[(k + 2) % 3];
        repeated.then_some(TopologyError::RepeatedVertex { face, vertex })
    })
}

/// The opposite of every half-edge, or `NONE`. Vertex by vertex: mark where its half-edges lead, then look up where those that
/// arrive come from; no hashing, and linear for vertices of any valence.
fn opposites(tails: &[u32], vertices: usize) -> Result<Vec<u32>, TopologyError> {
    let next = |h: u32| h - h % 3 + (h + 1) % 3;
    let prev = |h: u32| h - h % 3 + (h + 2) % 3;
    let mut starts = vec![0u32; vertices + 1];
    for &v in tails {
        starts[v as usize + 1] += 1;
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut fill = starts.clone();
    let mut leaving = vec![0u32; tails.len()];
    for (h, &v) in (0u32..).zip(tails) {
        leaving[fill[v as usize] as usize] = h;
        fill[v as usize] += 1;
    }
    let mut opposites = vec![NONE; tails.len()];
    // The latest half-edge that was seen to lead to a vertex; valid if it leaves the current one.
    let mut mark = vec![NONE; vertices];
    let marked = |mark: &[u32], u: u32, v: u32| {
        Some(mark[u as usize]).filter(|&h| h != NONE && tails[h as usize] == v)
    };
    let mut twice: Option<[u32; 2]> = None;
    for v in 0..vertices {
        let fan = &leaving[starts[v] as usize..starts[v + 1] as usize];
        for &h in fan {
            let head = tails[next(h) as usize];
            if let Some(other) = marked(&mark, head, v as u32) {
                // The first defect in the order of faces is wanted, not that in the order of vertices.
                if twice.is_none_or(|[_, second]| h < second) {
                    twice = Some([other, h]);
                }
            }
            mark[head as usize] = h;
        }
        for &h in fan {
            let arriving = prev(h);
            let from = tails[arriving as usize];
            opposites[arriving as usize] = marked(&mark, from, v as u32).unwrap_or(NONE);
        }
    }
    match twice {
        None => Ok(opposites),
        Some([other, h]) => Err(TopologyError::Edge {
            edge: [tails[h as usize], tails[next(h) as usize]],
            faces: [other, h].map(|h| h as usize / 3),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use glam::DVec3;

    fn build(vertices: usize, faces: &[[u32; 3]]) -> Result<Topology, TopologyError> {
        Topology::build(&TriMesh::new(vec![DVec3::ZERO; vertices], faces.to_vec()))
    }

    #[test]
    fn half_edges_keep_their_promises() {
        let mut open = shapes::torus(2.0, 0.5, 9, 6);
        open.faces.remove(40);
        for mesh in [shapes::sphere(2), shapes::double_torus(2), open] {
            let t = Topology::build(&mesh).unwrap();
            for h in 0..t.half_edge_count() as u32 {
                assert_eq!((t.next(t.prev(h)), t.next(t.next(t.next(h)))), (h, h));
                assert_eq!(t.half_edge(t.tail(h), t.head(h)), Some(h));
                assert_eq!(mesh.faces[t.face(h) as usize][h as usize % 3], t.tail(h));
                if let Some(o) = t.opposite(h) {
                    assert_eq!((t.opposite(o), t.tail(o), t.head(o)), (Some(h), t.head(h), t.tail(h)));
                }
            }
            let visited: usize = (0..t.vertex_count() as u32).map(|v| t.outgoing(v).count()).sum();
            assert_eq!(visited, t.half_edge_count());
            let euler = t.vertex_count() as i64 - t.edge_count() as i64 + t.face_count() as i64;
            assert_eq!(euler, crate::check(&mesh).euler_characteristic);
        }
    }

    #[test]
    fn a_fan_is_walked_counter_clockwise_from_the_boundary() {
        let t = build(5, &[[0, 2, 3], [0, 1, 2], [0, 3, 4]]).unwrap();
        let heads: Vec<_> = t.outgoing(0).map(|h| t.head(h)).collect();
        assert_eq!(heads, [1, 2, 3]);
        assert!(t.is_boundary_vertex(0) && !t.is_closed());
        let [walk] = &t.boundary_loops()[..] else { panic!() };
        assert_eq!(walk.iter().map(|&h| t.tail(h)).collect::<Vec<_>>(), [2, 3, 4, 0, 1]);
    }

    #[test]
    fn isolated_vertices_have_no_half_edges() {
        let t = build(4, &[[0, 1, 2]]).unwrap();
        assert_eq!((t.outgoing(3).count(), t.half_edge(3, 0), t.is_boundary_vertex(3)), (0, None, false));
    }

    #[test]
    fn the_first_defect_is_named() {
        let edge = |edge, faces| Some(TopologyError::Edge { edge, faces });
        assert_eq!(build(3, &[]).err(), Some(TopologyError::Empty));
        assert_eq!(build(4, &[[0, 1, 2], [0, 1, 3]]).err(), edge([0, 1], [0, 1]));
        assert_eq!(build(6, &[[3, 4, 5], [0, 1, 2], [3, 4, 0], [0, 1, 5]]).err(), edge([3, 4], [0, 2]));
        assert_eq!(build(4, &[[0, 1, 2], [0, 1, 3], [0, 0, 1]]).err(), edge([0, 1], [0, 1]));
        assert_eq!(
            build(4, &[[0, 1, 2], [3, 1, 3], [0, 1, 3]]).err(),
            Some(TopologyError::RepeatedVertex { face: 1, vertex: 3 })
        );
        assert_eq!(
            build(3, &[[0, 1, 7]]).err(),
            Some(TopologyError::VertexIndex { face: 0, vertex: 7, vertices: 3 })
        );
        assert_eq!(build(5, &[[0, 1, 2], [0, 3, 4]]).err(), Some(TopologyError::Vertex { vertex: 0 }));
    }

    #[test]
    fn a_vertex_of_huge_valence_takes_linear_time() {
        let n = 300_000;
        let faces: Vec<_> = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect();
        let t = build(n as usize + 1, &faces).unwrap();
        assert_eq!((t.outgoing(0).count(), t.boundary_loops()[0].len()), (n as usize, n as usize));
    }
}
