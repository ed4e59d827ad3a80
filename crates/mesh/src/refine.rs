//! Local refinement with curved midpoints: a mesh that is coarse for its curvature, made fine without flattening it.
//!
//! The midpoint of an edge lies on the cubic through both ends that is perpendicular to their normals (Vlachos, Peters, Boyd &
//! Mitchell 2001, *Curved PN triangles*, equation for b₂₁₀ and b₁₂₀). Creases part the normals of a vertex into sectors; along a
//! crease the midpoint is that of the four-point scheme (Dyn, Levin & Gregory 1987). Vertices of the input stay where they are.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::{Topology, TopologyError, TriMesh, turn_flat_edges};

/// When edges are split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefineOptions {
    /// Edges longer than this are split. In the units of the mesh.
    pub longest: f64,
    /// Edges are split as well where the normals at their ends differ by more than this angle, in radians.
    pub turn: f64,
    /// but none is shorter than this, in the units of the mesh.
    pub shortest: f64,
    /// Dihedral angle, in radians, from which an edge is a crease: normals are not averaged across it.
    pub crease: f64,
    /// Rounds of splitting; each halves the edges at most once.
    pub rounds: usize,
    /// Edges inside planes are turned to Delaunay's before and after every round ([`turn_flat_edges`]): how far a plane may be off, in the units
    /// of the mesh. `None` leaves edges where they are.
    pub flat: Option<f64>,
}

/// A refined mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The mesh; its first vertices are those of the input. Without normals.
    pub mesh: TriMesh,
    /// The face of the input that every face is a part of; where edges were turned, one of the same plane. Every face of the input has a part.
    pub parents: Vec<u32>,
}

impl Refined {
    fn turn(&mut self, options: &RefineOptions) -> Result<(), TopologyError> {
        if let Some(flat) = options.flat {
            self.mesh = turn_flat_edges(&self.mesh, flat)?;
        }
        Ok(())
    }

    /// For every face of the input a face that its centroid lies in.
    pub fn holders(&self, input: &TriMesh, topology: &Topology) -> Vec<u32> {
        let mut holders = vec![0; input.faces.len()];
        for (f, &parent) in self.parents.iter().enumerate().rev() {
            holders[parent as usize] = f as u32;
        }
        for (f, holder) in holders.iter_mut().enumerate() {
            let centroid = input.corners(f).into_iter().sum::<DVec3>() / 3.0;
            for _ in 0..FARTHEST {
                let Some(next) = self.towards(topology, *holder, centroid) else { break };
                *holder = next;
            }
        }
        holders
    }

    /// The face beyond the edge that separates a face most from a point in its plane; `None` in the face that holds it.
    fn towards(&self, topology: &Topology, face: u32, point: DVec3) -> Option<u32> {
        let corners = self.mesh.corners(face as usize);
        let normal = self.mesh.area_vector(face as usize);
        let inside = |k: usize| {
            (corners[(k + 1) % 3] - corners[k]).cross(point - corners[k]).dot(normal)
                / normal.length_squared()
        };
        let (k, least) = (0..3).map(|k| (k, inside(k))).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let across = topology.opposite(3 * face + k as u32)? / 3;
        let flat =
            self.mesh.area_vector(across as usize).normalize_or_zero().dot(normal.normalize_or_zero()) > 0.99;
        (least < -1e-9 && flat).then_some(across)
    }
}

/// Most faces that the way to a holder may lead over.
const FARTHEST: usize = 1000;

/// Splits edges that are too long or too curved, with curved midpoints; triangles with two such edges are cut in four, the neighbours
/// in two, so that the mesh stays closed.
///
/// # Errors
/// As [`Topology::build`].
pub fn refine_curved(mesh: &TriMesh, options: &RefineOptions) -> Result<Refined, TopologyError> {
    let mut now = Refined {
        mesh: TriMesh::new(mesh.positions.clone(), mesh.faces.clone()),
        parents: (0..mesh.faces.len() as u32).collect(),
    };
    if options.rounds > 0 {
        now.turn(options)?;
    }
    for _ in 0..options.rounds {
        let topology = Topology::build(&now.mesh)?;
        let round = Round::new(&now.mesh, &topology, options);
        let marked = round.marked();
        if !marked.contains(&true) {
            break;
        }
        now = round.split(&now, &marked);
        now.turn(options)?;
    }
    Ok(now)
}

/// Largest distance of a midpoint from its chord, in chords: normals of scans are not to be trusted beyond.
const BULGE: f64 = 0.15;
/// Cosine of the largest turn of a crease that goes on through a vertex.
const STRAIGHT: f64 = 0.7;

/// One round of splitting.
struct Round<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    options: &'a RefineOptions,
    /// Per half-edge: is it a crease?
    creased: Vec<bool>,
    /// Unit normal at the tail of every half-edge, of its sector between creases.
    normals: Vec<DVec3>,
}

impl<'a> Round<'a> {
    fn new(mesh: &'a TriMesh, topology: &'a Topology, options: &'a RefineOptions) -> Self {
        let unit: Vec<DVec3> =
            (0..mesh.faces.len()).map(|f| mesh.area_vector(f).normalize_or_zero()).collect();
        let limit = options.crease.cos();
        let creased = (0..topology.half_edge_count() as u32)
            .map(|h| {
                let across = topology.opposite(h).map(|o| unit[o as usize / 3]);
                across.is_none_or(|n| n.dot(unit[h as usize / 3]) < limit)
            })
            .collect();
        let mut round = Self { mesh, topology, options, creased, normals: Vec::new() };
        round.normals = round.sector_normals(&unit);
        round
    }

    /// Sums of the face normals, weighted by their angles, over the sectors between creases.
    fn sector_normals(&self, unit: &[DVec3]) -> Vec<DVec3> {
        let topology = self.topology;
        let weighted = |h: u32| {
            let (a, b) = (self.along(h), -self.along(topology.prev(h)));
            unit[h as usize / 3] * a.cross(b).length().atan2(a.dot(b))
        };
        let open = |h: &u32| !self.creased[*h as usize];
        let left = |h: u32| Some(topology.prev(h)).filter(open).and_then(|p| topology.opposite(p));
        let right =
            |h: u32| Some(h).filter(open).and_then(|h| topology.opposite(h)).map(|o| topology.next(o));
        let normal = |h: u32| {
            // As far to the right as it goes, or once around; then everything to the left.
            let mut first = h;
            while let Some(next) = right(first).filter(|&next| next != h) {
                first = next;
            }
            let mut sum = weighted(first);
            let mut at = first;
            while let Some(next) = left(at).filter(|&next| next != first) {
                sum += weighted(next);
                at = next;
            }
            sum.normalize_or_zero()
        };
        (0..topology.half_edge_count() as u32).map(normal).collect()
    }

    fn along(&self, h: u32) -> DVec3 {
        self.mesh.positions[self.topology.head(h) as usize]
            - self.mesh.positions[self.topology.tail(h) as usize]
    }

    /// Per half-edge: is its edge split? With two edges of a triangle the third one is, too.
    fn marked(&self) -> Vec<bool> {
        let topology = self.topology;
        let count = topology.half_edge_count();
        let turn = self.options.turn.cos();
        let mut marked: Vec<bool> = (0..count as u32)
            .map(|h| {
                let length = self.along(h).length();
                let [a, b] = self.ends(h);
                let curved = !self.creased[h as usize] && a.dot(b) < turn;
                length > self.options.longest || curved && length > 2.0 * self.options.shortest
            })
            .collect();
        let mut open: Vec<u32> = (0..count as u32).filter(|&h| marked[h as usize]).collect();
        for &h in &open {
            if let Some(o) = topology.opposite(h) {
                marked[o as usize] = true;
            }
        }
        open = (0..count as u32).filter(|&h| marked[h as usize]).collect();
        while let Some(h) = open.pop() {
            let [a, b, c] = [h, topology.next(h), topology.prev(h)].map(|h| h as usize);
            if marked[a] && (marked[b] != marked[c]) {
                let third = if marked[b] { c } else { b };
                marked[third] = true;
                if let Some(o) = topology.opposite(third as u32) {
                    marked[o as usize] = true;
                    open.push(o);
                }
            }
        }
        marked
    }

    /// The normals at tail and head of an edge that is no crease, on the side of its own face.
    fn ends(&self, h: u32) -> [DVec3; 2] {
        [self.normals[h as usize], self.normals[self.topology.next(h) as usize]]
    }

    fn midpoint(&self, h: u32) -> DVec3 {
        let (a, b) = (self.topology.tail(h), self.topology.head(h));
        let [p, q] = [a, b].map(|v| self.mesh.positions[v as usize]);
        let d = q - p;
        let offset = if self.creased[h as usize] {
            (self.extension(b, -d) + self.extension(a, d)) / 16.0
        } else {
            let [m, n] = self.ends(h);
            (n * d.dot(n) - m * d.dot(m)) / 8.0
        };
        0.5 * (p + q) + offset.clamp_length_max(BULGE * d.length())
    }

    /// What a crease that goes on beyond its vertex `v` bends away from the edge that leaves `v` along `d`; zero at its corners and ends.
    fn extension(&self, v: u32, d: DVec3) -> DVec3 {
        let mut others = Vec::new();
        for h in self.topology.outgoing(v) {
            let prev = self.topology.prev(h);
            for (edge, from) in [(h, self.along(h)), (prev, -self.along(prev))] {
                if self.creased[edge as usize] && !others.contains(&from) {
                    others.push(from);
                }
            }
        }
        others.retain(|&x| x != d);
        match others[..] {
            // 2v − (v + d) is where a straight crease of equal edges would come from.
            [x] if x.dot(d) < -STRAIGHT * x.length() * d.length() => -(x * (d.length() / x.length()) + d),
            _ => DVec3::ZERO,
        }
    }

    fn split(&self, before: &Refined, marked: &[bool]) -> Refined {
        let topology = self.topology;
        let mut positions = self.mesh.positions.clone();
        let mut middle: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for h in (0..topology.half_edge_count() as u32).filter(|&h| marked[h as usize]) {
            let (a, b) = (topology.tail(h), topology.head(h));
            middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push(self.midpoint(h));
                positions.len() as u32 - 1
            });
        }
        let at = |a: u32, b: u32| middle.get(&(a.min(b), a.max(b))).copied();
        let (mut faces, mut parents) = (Vec::new(), Vec::new());
        for (f, &face) in self.mesh.faces.iter().enumerate() {
            let [a, b, c] = face;
            let parts: Vec<[u32; 3]> = match [at(a, b), at(b, c), at(c, a)] {
                [None, None, None] => vec![face],
                [Some(x), Some(y), Some(z)] => vec![[a, x, z], [x, b, y], [z, y, c], [x, y, z]],
                [Some(x), None, None] => vec![[a, x, c], [x, b, c]],
                [None, Some(y), None] => vec![[b, y, a], [y, c, a]],
                [None, None, Some(z)] => vec![[c, z, b], [z, a, b]],
                // Marks come alone or all three.
                [Some(x), Some(y), None] => vec![[x, b, y], [a, x, y], [a, y, c]],
                [None, Some(y), Some(z)] => vec![[y, c, z], [b, y, z], [b, z, a]],
                [Some(x), None, Some(z)] => vec![[z, a, x], [c, z, x], [c, x, b]],
            };
            parents.extend(std::iter::repeat_n(before.parents[f], parts.len()));
            faces.extend(parts);
        }
        Refined { mesh: TriMesh::new(positions, faces), parents }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, shapes};

    fn options(longest: f64) -> RefineOptions {
        RefineOptions { longest, turn: 10.0, shortest: 0.0, crease: 0.9, rounds: 4, flat: None }
    }

    #[test]
    fn a_sphere_stays_round() {
        let coarse = shapes::sphere(1);
        let fine = refine_curved(&coarse, &options(0.2)).unwrap();
        let report = check(&fine.mesh);
        assert!(report.is_sound() && report.closed && report.genus == Some(0));
        let off = fine.mesh.positions.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f64::max);
        // Flat midpoints of the same edges lie 0.047 inside.
        assert!(off < 5e-3, "{off}");
        assert!(fine.mesh.faces.len() > 4 * coarse.faces.len());
    }

    #[test]
    fn a_box_stays_a_box() {
        let points: Vec<DVec3> =
            (0..8).map(|k| DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64)).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let cube = TriMesh::new(points, faces);
        let fine = refine_curved(&cube, &options(0.3)).unwrap();
        assert!(check(&fine.mesh).is_sound());
        for p in &fine.mesh.positions {
            assert!(p.to_array().iter().any(|&x| x == 0.0 || x == 1.0), "{p}");
        }
        let area = |m: &TriMesh| (0..m.faces.len()).map(|f| m.area_vector(f).length()).sum::<f64>();
        assert!((area(&fine.mesh) / area(&cube) - 1.0).abs() < 1e-14);
        // Every part lies in its parent.
        for (f, &parent) in fine.parents.iter().enumerate() {
            let n = |m: &TriMesh, f: usize| m.area_vector(f).normalize();
            assert!(n(&fine.mesh, f).dot(n(&cube, parent as usize)) > 1.0 - 1e-12);
        }
    }

    #[test]
    fn the_rim_of_a_cylinder_is_a_circle() {
        let n = 12;
        let at = |i: usize, z: f64| {
            let (s, c) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
            DVec3::new(c, s, z)
        };
        let mut points: Vec<DVec3> = (0..n).map(|i| at(i, 0.0)).chain((0..n).map(|i| at(i, 1.0))).collect();
        points.extend([DVec3::ZERO, DVec3::Z]);
        let (low, high) = (2 * n as u32, 2 * n as u32 + 1);
        let faces = (0..n as u32)
            .flat_map(|i| {
                let (j, k) = ((i + 1) % n as u32, n as u32);
                [[i, j, k + j], [i, k + j, k + i], [low, j, i], [high, k + i, k + j]]
            })
            .collect();
        let fine = refine_curved(&TriMesh::new(points, faces), &options(0.3)).unwrap();
        assert!(check(&fine.mesh).is_sound());
        for p in fine.mesh.positions.iter().filter(|p| p.truncate().length() > 0.8) {
            assert!((p.truncate().length() - 1.0).abs() < 2e-3, "{p}");
        }
    }

    #[test]
    fn slivers_in_planes_are_turned_before_they_are_split() {
        // A long box whose ends are fine and whose sides are fans of slivers between them.
        let (n, at) = (8u32, |k: u32, x: f64| {
            let t = f64::from(k % 8);
            let (y, z) = match k / 8 {
                0 => (t, 0.0),
                1 => (8.0, t),
                2 => (8.0 - t, 8.0),
                _ => (0.0, 8.0 - t),
            };
            DVec3::new(x, y, z) / 8.0
        });
        let mut points: Vec<DVec3> =
            (0..4 * n).map(|k| at(k, 0.0)).chain((0..4 * n).map(|k| at(k, 32.0))).collect();
        points.extend([DVec3::new(0.0, 0.5, 0.5), DVec3::new(4.0, 0.5, 0.5)]);
        let (low, high) = (8 * n, 8 * n + 1);
        let mut faces = Vec::new();
        for side in 0..4 {
            for k in 0..n {
                let (a, b) = (side * n + k, (side * n + k + 1) % (4 * n));
                let last = 4 * n + (side + 1) * n % (4 * n);
                faces.extend([[low, b, a], [high, 4 * n + a, 4 * n + b]]);
                // Every vertex of one end is joined with the first one of the side at the other.
                faces.extend([[a, b, last], [4 * n + a, side * n, 4 * n + b]]);
            }
        }
        let box_ = TriMesh::new(points, faces);
        assert!(check(&box_).is_sound() && check(&box_).closed);
        let with = |flat| refine_curved(&box_, &RefineOptions { flat, ..options(1.0) }).unwrap();
        let (plain, turned) = (with(None), with(Some(1e-9)));
        assert!(check(&turned.mesh).is_sound() && check(&turned.mesh).closed);
        assert!(turned.mesh.faces.len() < plain.mesh.faces.len());
        let topology = Topology::build(&turned.mesh).unwrap();
        for (f, holder) in turned.holders(&box_, &topology).into_iter().enumerate() {
            let centroid = box_.corners(f).into_iter().sum::<DVec3>() / 3.0;
            let [a, b, c] = turned.mesh.corners(holder as usize);
            let n = (b - a).cross(c - a);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                assert!((q - p).cross(centroid - p).dot(n) > -1e-9 * n.length_squared());
            }
        }
    }

    #[test]
    fn what_is_fine_stays() {
        let mesh = shapes::torus(2.0, 0.5, 64, 32);
        let same = refine_curved(&mesh, &options(1.0)).unwrap();
        assert_eq!(same.mesh.positions, mesh.positions);
        assert_eq!(same.parents.len(), mesh.faces.len());
    }
}
