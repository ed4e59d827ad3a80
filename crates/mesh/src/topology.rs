//! Half-edge adjacency of an oriented manifold mesh.

use std::collections::HashMap;

use crate::TriMesh;

const NONE: u32 = u32::MAX;

/// Half-edge adjacency of an oriented manifold mesh, with or without boundary.
///
/// Half-edge `h = 3 f + k` runs along face `f` from its `k`-th vertex to the next one, with the face on its left; nothing is
/// stored per half-edge but its opposite.
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
    /// Builds the adjacency in O(faces).
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
        let mut edges = HashMap::with_capacity(mesh.faces.len() * 3);
        for (face, corners) in mesh.faces.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if a as usize >= vertices {
                    return Err(TopologyError::VertexIndex { face, vertex: a, vertices });
                }
                if a == b || a == corners[(k + 2) % 3] {
                    return Err(TopologyError::RepeatedVertex { face, vertex: a });
                }
                if let Some(other) = edges.insert((a, b), (3 * face + k) as u32) {
                    let faces = [other as usize / 3, face];
                    return Err(TopologyError::Edge { edge: [a, b], faces });
                }
            }
        }
        let tails: Vec<u32> = mesh.faces.iter().flatten().copied().collect();
        let head = |h: usize| tails[h - h % 3 + (h + 1) % 3];
        let opposites: Vec<u32> =
            (0..tails.len()).map(|h| edges.get(&(head(h), tails[h])).copied().unwrap_or(NONE)).collect();
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
        for vertex in 0..vertices as u32 {
            if topology.outgoing(vertex).count() != valence[vertex as usize] as usize {
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
}
