//! The product: an implicit surface that can be evaluated, taken apart into patches, asked and changed.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_mesh::{Topology, TriMesh};
use suture_surface::{Continuity, EdgeRef, Patch, PatchId, Seam, Surface};

use crate::bounds::{bound_face, spans};
use crate::edge::EdgeForm;
use crate::face::{FaceForm, SurfacePoint};
use crate::hull::Class;
use crate::patches::{EdgePatch, FacePatch, PlanarPatch};
use crate::{ApatchError, ApatchReport, FaceBound};

/// A side of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Where the normals point.
    Positive,
    /// The other one.
    Negative,
}

impl Side {
    pub(crate) fn index(self) -> usize {
        match self {
            Self::Positive => 0,
            Self::Negative => 1,
        }
    }

    pub(crate) fn of(index: usize) -> Self {
        if index == 0 { Self::Positive } else { Self::Negative }
    }
}

/// An implicit surface over a mesh: `F = 0` in the tetrahedra of its faces and edges, `F < 0` inside, `F > 0` outside, near the surface.
#[derive(Clone, Debug)]
pub struct ApatchSurface {
    pub(crate) mesh: TriMesh,
    pub(crate) topology: Topology,
    pub(crate) classes: Vec<Class>,
    pub(crate) parents: Vec<u32>,
    pub(crate) faces: Vec<Option<Arc<FaceForm>>>,
    pub(crate) edges: Vec<Arc<EdgeForm>>,
    /// The half-edge along which each edge runs.
    pub(crate) halves: Vec<u32>,
    /// The edge of every half-edge.
    pub(crate) of_half: Vec<u32>,
    pub(crate) report: ApatchReport,
}

impl ApatchSurface {
    /// The mesh that the surface interpolates, refined where that was necessary; its normals are the gradients.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// The face of the input that each face is a part of.
    pub fn parents(&self) -> &[u32] {
        &self.parents
    }

    /// What the construction found and did.
    pub fn report(&self) -> &ApatchReport {
        &self.report
    }

    /// Class of every face.
    pub fn face_classes(&self) -> &[Class] {
        &self.classes
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The two vertices of an edge, in its direction.
    pub fn edge_vertices(&self, edge: usize) -> Option<[u32; 2]> {
        let &h = self.halves.get(edge)?;
        Some([self.topology.tail(h), self.topology.head(h)])
    }

    /// The class of an edge.
    pub fn edge_class(&self, edge: usize) -> Option<Class> {
        Some(Class::of_edge(self.edges.get(edge)?.e))
    }

    /// The surface over a point of a face, by its barycentric coordinates (of sum 1); `None` if there is no such face.
    pub fn face_point(&self, face: usize, q: [f64; 3]) -> Option<SurfacePoint> {
        match self.faces.get(face)? {
            Some(form) => Some(form.point(q)),
            None => {
                let [a, b, c] = self.mesh.corners(face);
                let position = a * q[0] + b * q[1] + c * q[2];
                Some(SurfacePoint { position, gradient: (b - a).cross(c - a), t: 0.0, simple: true })
            }
        }
    }

    /// The surface along an edge: `xi` from its first vertex to its second, `y` from its right face (0) to its left one (1). `None` if
    /// there is no such edge or no tetrahedron along it.
    pub fn edge_point(&self, edge: usize, xi: f64, y: f64) -> Option<SurfacePoint> {
        let form = self.edges.get(edge)?;
        form.side(form.b0(xi))?;
        Some(form.point(xi, y))
    }

    /// The apex of a face on a side and its weight (times the sign of the side: larger is closer to the face).
    pub fn apex(&self, face: usize, side: Side) -> Option<(DVec3, f64)> {
        let side = self.faces.get(face)?.as_ref()?.sides[side.index()].as_ref()?;
        Some((side.apex, side.sign * side.b))
    }

    /// The lower bound of the weight of an apex, attained and proven, no further apart than `gap` of the largest height
    /// coefficient unless `cells` do not suffice.
    pub fn face_bound(&self, face: usize, side: Side, gap: f64, cells: usize) -> Option<FaceBound> {
        let form = self.faces.get(face)?.as_ref()?;
        let side = form.sides[side.index()].as_ref()?;
        let height = side.h.iter().fold(0.0_f64, |m, h| m.max(h.abs()));
        Some(bound_face(form, side, gap * height, cells))
    }

    /// The parameter of each half-edge at which the surface crosses its edge.
    pub(crate) fn pinch(&self, h: u32) -> Option<f64> {
        let edge = self.of_half[h as usize] as usize;
        let x = EdgeForm::pinch(self.edges[edge].e)?;
        Some(if self.halves[edge] == h { x } else { 1.0 - x })
    }

    /// The lunes of an edge: span and side, in the direction of the edge. Empty on the boundary and for straight edges.
    pub(crate) fn lunes(&self, edge: usize) -> Vec<([f64; 2], usize)> {
        let form = &self.edges[edge];
        let mut all: Vec<([f64; 2], usize)> = (0..2)
            .filter_map(|s| Some((form.sides[s].as_ref()?, s)))
            .flat_map(|(side, s)| spans(form, side.sign).into_iter().map(move |span| (span, s)))
            .collect();
        all.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        all
    }

    /// First patch of the lunes of every edge, after those of the faces.
    pub(crate) fn lune_patches(&self) -> Vec<u32> {
        let mut next = self.faces.len() as u32;
        (0..self.edges.len())
            .map(|e| {
                let first = next;
                next += self.lunes(e).len() as u32;
                first
            })
            .collect()
    }

    /// The surface as patches with their seams: first one patch per face, then those of the edges. Seams claim C¹.
    ///
    /// # Errors
    /// [`ApatchError::Surface`] if patches and seams did not fit together.
    pub fn surface(&self) -> Result<Surface, ApatchError> {
        let mut patches: Vec<Box<dyn Patch>> = Vec::with_capacity(self.faces.len() + self.edges.len());
        // The first domain edge of every half-edge in the patch of its face.
        let mut first = vec![0u32; self.of_half.len()];
        for (f, form) in self.faces.iter().enumerate() {
            let pinches = [0, 1, 2].map(|j| self.pinch((3 * f + j) as u32));
            let mut edge = 0;
            for j in 0..3 {
                first[3 * f + j] = edge;
                edge += if form.is_some() && pinches[j].is_some() { 2 } else { 1 };
            }
            patches.push(match form {
                Some(form) => Box::new(FacePatch::new(Arc::clone(form), pinches)),
                None => Box::new(PlanarPatch::new(self.mesh.corners(f))),
            });
        }
        let mut seams = Vec::new();
        let at = |patch: u32, edge: u32| EdgeRef { patch: PatchId(patch), edge };
        let mut seam = |a, b| seams.push(Seam::new(a, b, Continuity::C1));
        for (e, &h) in self.halves.iter().enumerate() {
            let Some(o) = self.topology.opposite(h) else { continue };
            let [f, g] = [h, o].map(|h| self.topology.face(h));
            let lunes = self.lunes(e);
            if lunes.is_empty() {
                seam(at(f, first[h as usize]), at(g, first[o as usize]));
            }
            let count = lunes.len() as u32;
            for (n, (span, side)) in (0u32..).zip(lunes) {
                let Some(patch) = EdgePatch::new(Arc::clone(&self.edges[e]), span, side) else { continue };
                let id = patches.len() as u32;
                patches.push(Box::new(patch));
                seam(at(f, first[h as usize] + n), at(id, 1));
                // The right face meets the lunes in the reverse order.
                seam(at(g, first[o as usize] + count - 1 - n), at(id, 0));
            }
        }
        Ok(Surface::new(patches, seams)?)
    }
}

#[cfg(test)]
mod tests {
    use crate::coefficients::{EDGE, alpha};
    use crate::edge::EdgeSide;
    use crate::hull::opposite_vertex;
    use crate::{ApatchOptions, apatch};
    use suture_mesh::shapes;

    /// Erratum 1: the coefficient `kju` as printed takes `kki` for `kkj`. The walls show it; regular solids would not.
    #[test]
    fn the_printed_coefficient_of_step_4_is_not_c1() {
        let mut mesh = shapes::sphere(2);
        for p in &mut mesh.positions {
            *p *= 1.0 + 0.12 * (3.0 * p.x).sin() * (2.0 * p.y + p.z).cos();
        }
        let normals = suture_mesh::vertex_normals_area_weighted(&mesh);
        let surface = apatch(&mesh, &normals, &ApatchOptions::default()).unwrap();
        let jump = |printed: bool| {
            let mut worst = 0.0_f64;
            for (e, form) in surface.edges.iter().enumerate() {
                let (h, Some(o)) = (surface.halves[e], surface.topology.opposite(surface.halves[e])) else {
                    continue;
                };
                let [Some(f), Some(g)] =
                    [h, o].map(|h| surface.faces[surface.topology.face(h) as usize].clone())
                else {
                    continue;
                };
                for s in 0..2 {
                    let (Some(mut a), Some(b), Some(_)) = (f.sides[s], g.sides[s], form.sides[s]) else {
                        continue;
                    };
                    let k = opposite_vertex(h);
                    if printed {
                        // The edge is "kj" of the paper: its slopes are those towards the third vertex "i" by mistake.
                        let face = surface.topology.face(h) as usize;
                        let gradient = normals[mesh.faces[face][EDGE[k][1]] as usize];
                        let [p, q] = EDGE[k].map(|v| f.p[v]);
                        let w = alpha(a.apex, p, q);
                        let right = (p - q).dot(gradient) / 3.0;
                        let wrong = (f.p[k] - q).dot(gradient) / 3.0;
                        a.m[k] += 0.5 * (1.0 - w) * (wrong - right);
                    }
                    let edge = EdgeSide::new(form.p, (&a, k), (&b, opposite_vertex(o)));
                    for (i, j) in [(1, 2), (2, 1), (1, 1)] {
                        let [x, y] = [f64::from(i) / 4.0, f64::from(j) / 4.0];
                        let t = 1.0 - x - y;
                        let mut q = [0.0, 0.0, 0.0, t];
                        (q[EDGE[k][0]], q[EDGE[k][1]]) = (x, y);
                        let (_, n) = a.value(&f.base, q);
                        let (_, m) = edge.value(form.e, [0.0, x, y, t]);
                        worst = worst.max(n.distance(m) / n.length());
                    }
                }
            }
            worst
        };
        assert!(jump(false) < 1e-11, "{:e}", jump(false));
        assert!(jump(true) > 1e-2, "{:e}", jump(true));
    }
}
