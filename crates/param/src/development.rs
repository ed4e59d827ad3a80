//! Growing an abstract disc over the mesh, face copy by face copy.

use std::collections::HashMap;

use suture_mesh::Topology;

use crate::creases::Creases;
use crate::rim::Union;

/// Copies of mesh faces, glued along edges.
///
/// Corners of copies are united into classes, the chart vertices. The state is always closed under two rules: (1) a class has at
/// most one copy of a mesh face; (2) if two faces that share a mesh edge at a vertex both have a copy in one class of that
/// vertex, the classes at the other end of the edge are one, unless the edge is on a crease and not inside the segment. Both are
/// Horn rules, so the closure of any set of attached faces is unique, whatever the order of attaching.
pub(crate) struct Development<'a> {
    topology: &'a Topology,
    creases: Creases<'a>,
    segment_len: usize,
    /// Mesh face of every copy; merged copies stay and point to their representative.
    copies: Vec<u32>,
    same: Union,
    /// Class of every corner: corner 3 c + k of copy c.
    classes: Union,
    /// Copies in every class, stored at its root.
    members: Vec<Vec<u32>>,
    /// Copy of a mesh face in a class (by root).
    at: HashMap<(u32, u32), u32>,
    /// Corner at every vertex of the disc extracted last, and whether faces can still be attached there.
    vertices: Vec<u32>,
    open: Vec<bool>,
    todo: Vec<Task>,
}

enum Task {
    /// These corners are one vertex.
    Unite(u32, u32),
    /// These copies are one.
    Merge(u32, u32),
}

impl<'a> Development<'a> {
    /// The segment alone, glued along its inner edges. Faces must exist.
    pub(crate) fn new(topology: &'a Topology, segment: &[u32], creases: Creases<'a>) -> Self {
        let mut new = Self {
            topology,
            creases,
            segment_len: segment.len(),
            copies: Vec::new(),
            same: Union::new(0),
            classes: Union::new(0),
            members: Vec::new(),
            at: HashMap::new(),
            vertices: Vec::new(),
            open: Vec::new(),
            todo: Vec::new(),
        };
        for &f in segment {
            new.copy(f);
        }
        // Copies of the segment are numbered like the sorted segment.
        let copy = |f: u32| segment.binary_search(&f).ok().map(|c| c as u32);
        for (c, &f) in segment.iter().enumerate() {
            for k in 0..3 {
                let Some(o) = topology.opposite(3 * f + k) else { continue };
                if let Some(d) = copy(o / 3) {
                    let here = 3 * c as u32 + k;
                    new.todo.push(Task::Unite(here, 3 * d + topology.next(o) % 3));
                }
            }
        }
        new.close();
        new
    }

    /// Number of copies made so far, merged ones included.
    pub(crate) fn copies(&self) -> usize {
        self.copies.len()
    }

    /// Attaches all missing faces around these vertices of the disc extracted last, as far as no blocked edge is crossed;
    /// whether there were any. Stops early when more than `limit` copies have been made.
    pub(crate) fn complete(&mut self, vertices: &[u32], limit: usize) -> bool {
        let before = self.copies.len();
        for &v in vertices {
            let corner = self.vertices[v as usize];
            // Walks both ways around the vertex from every face that is there, over the gaps.
            let root = self.classes.find(corner as usize);
            for c in self.members[root].clone() {
                if self.copies.len() > limit {
                    return true;
                }
                let root = self.classes.find(corner as usize);
                let start = self.leaving(c, root);
                for forward in [true, false] {
                    let mut h = start;
                    while let Some(next) = self.turn(h, forward) {
                        let root = self.classes.find(corner as usize);
                        if self.at.contains_key(&(root as u32, next / 3)) {
                            break;
                        }
                        let fresh = self.copy(next / 3);
                        // Only united here; rule 2 is applied when the task is done, and glues the edge just crossed.
                        self.todo.push(Task::Unite(corner, 3 * fresh + next % 3));
                        self.close();
                        h = next;
                    }
                }
            }
        }
        self.copies.len() > before
    }

    /// Chart vertices (their mesh vertices), chart faces and their mesh faces: the segment, then the collar in the order of
    /// attaching. Vertices are numbered as the faces name them.
    pub(crate) fn faces(&mut self) -> (Vec<u32>, Vec<[u32; 3]>, Vec<u32>) {
        let mut number = vec![u32::MAX; 3 * self.copies.len()];
        let (mut vertices, mut faces, mut mesh_faces) = (Vec::new(), Vec::new(), Vec::new());
        self.vertices.clear();
        self.open.clear();
        for c in 0..self.copies.len() {
            if self.same.find(c) != c {
                continue;
            }
            let f = self.copies[c];
            let mut face = [0; 3];
            for k in 0..3 {
                let root = self.classes.find(3 * c + k);
                if number[root] == u32::MAX {
                    number[root] = vertices.len() as u32;
                    vertices.push(self.topology.tail(3 * f + k as u32));
                    self.vertices.push((3 * c + k) as u32);
                    self.open.push(false);
                }
                face[k] = number[root];
                let h = 3 * f + k as u32;
                let ends = [(h, true), (h, false)];
                for (h, forward) in ends {
                    if let Some(next) = self.turn(h, forward) {
                        self.open[face[k] as usize] |= !self.at.contains_key(&(root as u32, next / 3));
                    }
                }
            }
            faces.push(face);
            mesh_faces.push(f);
        }
        (vertices, faces, mesh_faces)
    }

    /// For every vertex of the disc extracted last, whether a face can be attached there.
    pub(crate) fn open(&self) -> &[bool] {
        &self.open
    }

    /// The half-edge that leaves the same vertex in the neighbouring face, counter-clockwise or clockwise; `None` at a
    /// blocked edge.
    fn turn(&mut self, h: u32, forward: bool) -> Option<u32> {
        let t = self.topology;
        let crossed = if forward { t.prev(h) } else { h };
        let o = t.opposite(crossed).filter(|_| !self.creases.stop(crossed))?;
        Some(if forward { o } else { t.next(o) })
    }

    /// The mesh half-edge of copy `c` that leaves the vertex of class `root`.
    fn leaving(&mut self, c: u32, root: usize) -> u32 {
        let k = (0..3).find(|&k| self.classes.find((3 * c + k) as usize) == root).unwrap_or(0);
        3 * self.copies[c as usize] + k
    }

    fn copy(&mut self, face: u32) -> u32 {
        let c = self.copies.len() as u32;
        self.copies.push(face);
        self.same.grow(1);
        self.classes.grow(3);
        for k in 0..3 {
            self.members.push(vec![c]);
            self.at.insert((3 * c + k, face), c);
        }
        c
    }

    fn close(&mut self) {
        while let Some(task) = self.todo.pop() {
            match task {
                Task::Unite(a, b) => self.unite(a as usize, b as usize),
                Task::Merge(c, d) => {
                    let (c, d) = (self.same.find(c as usize) as u32, self.same.find(d as usize) as u32);
                    if c != d {
                        self.same.unite(c as usize, d as usize);
                        self.todo.extend((0..3).map(|k| Task::Unite(3 * c + k, 3 * d + k)));
                    }
                }
            }
        }
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.classes.find(a), self.classes.find(b));
        if a == b {
            return;
        }
        self.classes.unite(a, b);
        let root = self.classes.find(a);
        let other = a + b - root;
        let (mut kept, mut moved) =
            (std::mem::take(&mut self.members[root]), std::mem::take(&mut self.members[other]));
        // The younger list moves, as the keys of the map follow the root: the list of a fresh face has one entry.
        for &c in &moved {
            self.at.remove(&(other as u32, self.copies[c as usize]));
        }
        let mut fresh = Vec::with_capacity(moved.len());
        for c in moved.drain(..) {
            let face = self.copies[c as usize];
            match self.at.get(&(root as u32, face)) {
                Some(&d) => self.todo.push(Task::Merge(c, d)),
                None => {
                    self.at.insert((root as u32, face), c);
                    fresh.push(c);
                }
            }
        }
        kept.extend(&fresh);
        self.members[root] = kept;
        for c in fresh {
            self.glue(c, root);
        }
    }

    /// Rule 2 for copy `c` and its two neighbours in the class.
    fn glue(&mut self, c: u32, root: usize) {
        let h = self.leaving(c, root);
        for (forward, crossed) in [(true, self.topology.prev(h)), (false, h)] {
            let Some(o) = self.topology.opposite(crossed) else { continue };
            let Some(&d) = self.at.get(&(root as u32, o / 3)) else { continue };
            // The segment's own faces have the lowest numbers and represent whatever is merged with them.
            let inner = self.same.find(c as usize).max(self.same.find(d as usize)) < self.segment_len;
            if !inner && self.creases.stop(crossed) {
                continue;
            }
            // The far end: the tail of `crossed` going forward, its head otherwise.
            let (here, there) =
                if forward { (crossed, self.topology.next(o)) } else { (self.topology.next(crossed), o) };
            self.todo.push(Task::Unite(3 * c + here % 3, 3 * d + there % 3));
        }
    }
}
