//! The implicit function: which tetrahedron holds a point, what `F` is there, and on which side of the surface it lies.

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

use crate::surface::{ApatchSurface, Side};

/// A tetrahedron of the hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cell {
    /// Over a face, with vertices `p₀, p₁, p₂` and the apex.
    Face {
        /// The face.
        face: u32,
        /// Its side.
        side: Side,
    },
    /// Along an edge, with vertices: apex of the right face, first and second vertex of the edge, apex of the left face.
    Edge {
        /// The edge.
        edge: u32,
        /// Its side.
        side: Side,
    },
}

/// A point of the hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// The tetrahedron.
    pub cell: Cell,
    /// Barycentric coordinates in the order of its vertices.
    pub barycentric: [f64; 4],
}

impl ApatchSurface {
    /// All tetrahedra, faces first.
    pub fn cells(&self) -> Vec<Cell> {
        let faces = (0u32..).zip(&self.faces).flat_map(|(face, form)| {
            let sides = form.as_ref().map_or([false; 2], |f| [0, 1].map(|s| f.sides[s].is_some()));
            (0..2).filter(move |&s| sides[s]).map(move |s| Cell::Face { face, side: Side::of(s) })
        });
        let edges = (0u32..).zip(&self.edges).flat_map(|(edge, form)| {
            let sides = [0, 1].map(|s| form.sides[s].is_some());
            (0..2).filter(move |&s| sides[s]).map(move |s| Cell::Edge { edge, side: Side::of(s) })
        });
        faces.chain(edges).collect()
    }

    /// The vertices of a tetrahedron; `None` if it does not exist.
    pub fn cell_vertices(&self, cell: Cell) -> Option<[DVec3; 4]> {
        match cell {
            Cell::Face { face, side } => {
                let form = self.faces.get(face as usize)?.as_ref()?;
                let [a, b, c] = form.p;
                Some([a, b, c, form.sides[side.index()].as_ref()?.apex])
            }
            Cell::Edge { edge, side } => {
                let form = self.edges.get(edge as usize)?;
                let side = form.sides[side.index()].as_ref()?;
                Some([side.apex[0], form.p[0], form.p[1], side.apex[1]])
            }
        }
    }

    /// `F` and its gradient at a point of a tetrahedron; `None` if the tetrahedron does not exist.
    pub fn value(&self, at: Location) -> Option<(f64, DVec3)> {
        match at.cell {
            Cell::Face { face, side } => {
                let form = self.faces.get(face as usize)?.as_ref()?;
                Some(form.sides[side.index()].as_ref()?.value(&form.base, at.barycentric))
            }
            Cell::Edge { edge, side } => {
                let form = self.edges.get(edge as usize)?;
                Some(form.sides[side.index()].as_ref()?.value(form.e, at.barycentric))
            }
        }
    }

    /// Barycentric coordinates of any point with respect to a tetrahedron; `None` if the tetrahedron does not exist.
    pub fn barycentric(&self, cell: Cell, p: DVec3) -> Option<[f64; 4]> {
        match cell {
            Cell::Face { face, side } => {
                let form = self.faces.get(face as usize)?.as_ref()?;
                Some(form.sides[side.index()].as_ref()?.barycentric(p))
            }
            Cell::Edge { edge, side } => {
                let form = self.edges.get(edge as usize)?;
                Some(form.sides[side.index()].as_ref()?.barycentric(p))
            }
        }
    }

    /// Whether a point of the hull lies inside the surface: on its ray, before the surface seen from the mesh on the positive side,
    /// beyond it on the negative one. Other sheets of `F = 0` in the tetrahedron do not count.
    pub fn inside(&self, at: Location) -> Option<bool> {
        let [a, b, c, d] = at.barycentric;
        let (sign, t, root) = match at.cell {
            Cell::Face { face, side } => {
                let form = self.faces.get(face as usize)?.as_ref()?;
                let side = form.sides[side.index()].as_ref()?;
                let sum = a + b + c;
                if !(sum > 0.0) {
                    return Some(side.sign < 0.0);
                }
                let q = [a / sum, b / sum, c / sum];
                let (l0, _) = form.base.gradient(q);
                (side.sign, d, (side.sign * l0 < 0.0).then(|| form.shooting(side, q, l0).root().t))
            }
            Cell::Edge { edge, side } => {
                let form = self.edges.get(edge as usize)?;
                let side = form.sides[side.index()].as_ref()?;
                let (sum, t) = (b + c, a + d);
                if !(sum > 0.0) {
                    return Some(side.sign < 0.0);
                }
                let (xi, y) = (c / sum, if t > 0.0 { d / t } else { 0.5 });
                let b0 = form.b0(xi);
                (side.sign, t, (side.sign * b0 < 0.0).then(|| form.shooting(side, xi, y).root().t))
            }
        };
        // Where the surface lies on the other side of the mesh, all of this side is beyond it.
        let before = root.is_some_and(|root| t < root);
        Some(before == (sign > 0.0))
    }
}

/// Finds the tetrahedra that hold a point.
pub struct Locator<'a> {
    surface: &'a ApatchSurface,
    cells: Vec<Cell>,
    tree: Bvh,
}

impl std::fmt::Debug for Locator<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Locator").field("cells", &self.cells.len()).finish_non_exhaustive()
    }
}

impl<'a> Locator<'a> {
    /// Builds the index over all tetrahedra.
    pub fn new(surface: &'a ApatchSurface) -> Self {
        let cells = surface.cells();
        let boxes: Vec<Aabb> =
            cells.iter().map(|&c| bounds(&surface.cell_vertices(c).unwrap_or_default())).collect();
        Self { surface, cells, tree: tree(&boxes) }
    }

    /// The tetrahedra that hold `p`, in order; several on walls and where tetrahedra intersect, none outside the hull.
    pub fn locate(&self, p: DVec3) -> Vec<Location> {
        if !p.is_finite() || self.cells.is_empty() {
            return Vec::new();
        }
        let point = Aabb::new(p, p);
        let mut found: Vec<Location> = self
            .tree
            .intersect_aabb(&point)
            .filter_map(|leaf| {
                let &cell = self.cells.get(leaf as usize)?;
                let barycentric = self.surface.barycentric(cell, p)?;
                // A few roundings: points on walls belong to both sides.
                barycentric.iter().all(|&x| x >= -1e-12).then_some(Location { cell, barycentric })
            })
            .collect();
        found.sort_by_key(|l| l.cell);
        found
    }
}

/// The box around four points, a little larger than they need.
pub(crate) fn bounds(v: &[DVec3; 4]) -> Aabb {
    let (lo, hi) = (v[0].min(v[1]).min(v[2].min(v[3])), v[0].max(v[1]).max(v[2].max(v[3])));
    let margin = (hi - lo) * 1e-9;
    Aabb::new(lo - margin, hi + margin)
}

pub(crate) fn tree(boxes: &[Aabb]) -> Bvh {
    Bvh::from_leaves(BvhBuildStrategy::default(), boxes)
}
