//! The edges of any mesh, manifold or not.

use crate::TriMesh;

/// One side of a face, as a directed edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// Lower vertex.
    pub(crate) low: u32,
    /// Higher vertex.
    pub(crate) high: u32,
    /// Face times three plus the place of the tail.
    pub(crate) half_edge: u64,
    /// Whether the face runs from `low` to `high`.
    pub(crate) forward: bool,
}

impl Side {
    pub(crate) fn face(&self) -> usize {
        (self.half_edge / 3) as usize
    }
}

/// The sides of the faces that `usable` admits, sorted so that the sides of one edge follow each other in the order of faces:
/// `chunk_by(same_edge)` yields the edges.
pub(crate) fn sides(mesh: &TriMesh, usable: &[bool]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * mesh.faces.len());
    for (f, face) in mesh.faces.iter().enumerate().filter(|&(f, _)| usable[f]) {
        for k in 0..3 {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            let half_edge = 3 * f as u64 + k as u64;
            sides.push(Side { low: a.min(b), high: a.max(b), half_edge, forward: a < b });
        }
    }
    sides.sort_unstable();
    sides
}

pub(crate) fn same_edge(a: &Side, b: &Side) -> bool {
    (a.low, a.high) == (b.low, b.high)
}

/// Whether each face names three different vertices that exist.
pub(crate) fn usable_faces(mesh: &TriMesh) -> Vec<bool> {
    let n = mesh.positions.len();
    mesh.faces
        .iter()
        .map(|&[a, b, c]| a != b && b != c && c != a && [a, b, c].iter().all(|&v| (v as usize) < n))
        .collect()
}

/// Disjoint sets of indices; the representative of a set is its lowest member.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            // Path halving.
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    pub(crate) fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// For each face that `usable` admits, the number of its component (joined by shared vertices), in the order of their first faces;
/// and the number of components.
pub(crate) fn face_components(mesh: &TriMesh, usable: &[bool]) -> (Vec<Option<usize>>, usize) {
    let mut sets = Sets::new(mesh.positions.len());
    for (_, &[a, b, c]) in mesh.faces.iter().enumerate().filter(|&(f, _)| usable[f]) {
        sets.union(a, b);
        sets.union(b, c);
    }
    let mut numbers = vec![None; mesh.positions.len()];
    let mut count = 0;
    let labels = mesh
        .faces
        .iter()
        .zip(usable)
        .map(|(face, &usable)| {
            usable.then(|| {
                *numbers[sets.find(face[0]) as usize].get_or_insert_with(|| {
                    count += 1;
                    count - 1
                })
            })
        })
        .collect();
    (labels, count)
}

/// Agreement of orientation across the edges that join exactly two faces.
pub(crate) struct Orientation {
    /// For each face, the patch it belongs to (joined by such edges); the number is that of the patch's first face.
    pub(crate) patch: Vec<u32>,
    /// For each face, whether it runs against the first face of its patch.
    pub(crate) against: Vec<bool>,
    /// First faces of the patches that cannot be oriented, ascending.
    pub(crate) contradictory: Vec<u32>,
}

/// Walks over the edges with exactly two faces, breadth first from the lowest face of each patch.
pub(crate) fn orientation(faces: usize, sides: &[Side]) -> Orientation {
    // Neighbours by compressed rows: face → (neighbour, whether the two disagree).
    let pairs: Vec<(usize, usize, bool)> = sides
        .chunk_by(same_edge)
        .filter_map(|edge| match edge {
            [a, b] => Some((a.face(), b.face(), a.forward == b.forward)),
            _ => None,
        })
        .collect();
    let mut starts = vec![0usize; faces + 1];
    for &(a, b, _) in &pairs {
        starts[a + 1] += 1;
        starts[b + 1] += 1;
    }
    for f in 0..faces {
        starts[f + 1] += starts[f];
    }
    let mut fill = starts.clone();
    let mut neighbours = vec![(0u32, false); 2 * pairs.len()];
    for &(a, b, disagree) in &pairs {
        for (from, to) in [(a, b), (b, a)] {
            neighbours[fill[from]] = (to as u32, disagree);
            fill[from] += 1;
        }
    }
    const UNSEEN: u32 = u32::MAX;
    let (mut patch, mut against) = (vec![UNSEEN; faces], vec![false; faces]);
    let mut contradictory = Vec::new();
    let mut queue = Vec::new();
    for first in 0..faces {
        if patch[first] != UNSEEN {
            continue;
        }
        patch[first] = first as u32;
        queue.clear();
        queue.push(first);
        let mut bad = false;
        let mut at = 0;
        while let Some(&f) = queue.get(at) {
            at += 1;
            for &(g, disagree) in &neighbours[starts[f]..starts[f + 1]] {
                let g = g as usize;
                if patch[g] == UNSEEN {
                    patch[g] = first as u32;
                    against[g] = against[f] ^ disagree;
                    queue.push(g);
                } else {
                    bad |= against[g] != against[f] ^ disagree;
                }
            }
        }
        if bad {
            contradictory.push(first as u32);
        }
    }
    Orientation { patch, against, contradictory }
}
