//! Where a collar stops: at borders of the mesh and at creases.

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

/// Sharp edges that hang together in creases, found where they are asked for.
///
/// A crease shorter than a limit is none: a collar would go around its ends, on either side of each of many, and unfold into the universal
/// cover of a surface with slits. On a scan of 100,000 triangles with 25° edges here and there, collars of 12 rings met the same faces up
/// to 450 times.
pub(crate) struct Creases<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    sharp: f64,
    shortest: f64,
    /// Whether an edge (by the smaller half-edge) belongs to a crease that is long enough.
    known: HashMap<u32, bool>,
}

impl<'a> Creases<'a> {
    /// Of edges whose dihedral angle is beyond `sharp`, creases of at least the extent `shortest`.
    pub(crate) fn new(mesh: &'a TriMesh, topology: &'a Topology, sharp: f64, shortest: f64) -> Self {
        Self { mesh, topology, sharp, shortest, known: HashMap::new() }
    }

    /// Whether a half-edge has no opposite or lies on a crease.
    pub(crate) fn stop(&mut self, h: u32) -> bool {
        let Some(o) = self.topology.opposite(h) else { return true };
        if !self.sharp(h, o) {
            return false;
        }
        if self.shortest <= 0.0 {
            return true;
        }
        let edge = h.min(o);
        if let Some(&known) = self.known.get(&edge) {
            return known;
        }
        let crease = self.connected(edge);
        let long = self.extent(&crease) >= self.shortest;
        self.known.extend(crease.into_iter().map(|e| (e, long)));
        long
    }

    /// A face without normal has no angle.
    fn sharp(&self, h: u32, o: u32) -> bool {
        match (normal(self.mesh, (h / 3) as usize), normal(self.mesh, (o / 3) as usize)) {
            (Some(m), Some(n)) => m.cross(n).length().atan2(m.dot(n)) > self.sharp,
            _ => false,
        }
    }

    /// All sharp edges that hang together with this one.
    fn connected(&self, edge: u32) -> Vec<u32> {
        let mut found = HashSet::from([edge]);
        let mut crease = vec![edge];
        let mut next = 0;
        while let Some(&e) = crease.get(next) {
            next += 1;
            for v in [self.topology.tail(e), self.topology.head(e)] {
                // Around the vertex every edge leaves it or comes in before one that leaves.
                for out in self.topology.outgoing(v).flat_map(|h| [h, self.topology.prev(h)]) {
                    let Some(o) = self.topology.opposite(out) else { continue };
                    if self.sharp(out, o) && found.insert(out.min(o)) {
                        crease.push(out.min(o));
                    }
                }
            }
        }
        crease
    }

    /// Twice the largest distance of an end of its edges from their mean: the same however the mesh is turned and numbered.
    fn extent(&self, crease: &[u32]) -> f64 {
        let ends = |&e: &u32| {
            [self.topology.tail(e), self.topology.head(e)].map(|v| self.mesh.positions[v as usize])
        };
        let mean = crease.iter().flat_map(ends).sum::<DVec3>() / (2 * crease.len()) as f64;
        2.0 * crease.iter().flat_map(ends).map(|p| p.distance(mean)).fold(0.0, f64::max)
    }
}

/// Normal of a face, if rounding errors leave it one.
fn normal(mesh: &TriMesh, face: usize) -> Option<DVec3> {
    let [a, b, c] = mesh.corners(face);
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    let n = mesh.area_vector(face);
    if n.length() > 1e-12 * longest { n.try_normalize() } else { None }
}
