//! The network of strips: one per edge of the mesh, in canonical direction.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    BubbleError, MAX_ORDER, bend, crease,
    implicit::Implicit,
    poly_mesh::PolyMesh,
    strip::{Bend, Counts, Strip},
};

/// An edge of the mesh with the faces along it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshEdge {
    /// Its vertices, lower index first: the canonical direction.
    pub vertices: [u32; 2],
    /// The faces along it, in the order of faces.
    pub faces: Vec<EdgeUse>,
}

/// A face along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeUse {
    /// The face.
    pub face: u32,
    /// The side of the face, from corner `side` to the next.
    pub side: u8,
    /// Whether the face runs along the edge in canonical direction.
    pub forward: bool,
}

/// The edges of a mesh by their vertices, and the edge behind every side of every face.
#[derive(Clone, Debug, Default)]
pub(crate) struct Edges {
    pub(crate) edges: Vec<MeshEdge>,
    /// By face, then by side.
    pub(crate) sides: Vec<[u32; 4]>,
}

impl Edges {
    pub(crate) fn of(mesh: &PolyMesh) -> Self {
        let mut keys: Vec<(u32, u32, EdgeUse)> = Vec::with_capacity(3 * mesh.faces.len());
        for (f, face) in (0u32..).zip(&mesh.faces) {
            let v = face.vertices();
            for k in 0..v.len() {
                let (a, b) = (v[k], v[(k + 1) % v.len()]);
                keys.push((a.min(b), a.max(b), EdgeUse { face: f, side: k as u8, forward: a < b }));
            }
        }
        keys.par_sort_unstable_by_key(|&(a, b, e)| (a, b, e.face, e.side));
        let mut out =
            Self { edges: Vec::with_capacity(keys.len() / 2), sides: vec![[0; 4]; mesh.faces.len()] };
        for (a, b, e) in keys {
            match out.edges.last_mut() {
                Some(last) if last.vertices == [a, b] => last.faces.push(e),
                _ => out.edges.push(MeshEdge { vertices: [a, b], faces: vec![e] }),
            }
            out.sides[e.face as usize][e.side as usize] = out.edges.len() as u32 - 1;
        }
        out
    }

    /// The neighbours of every vertex along edges, ascending; and whether it lies on a boundary edge.
    pub(crate) fn rings(&self, vertices: usize) -> Rings {
        let mut starts = vec![0u32; vertices + 1];
        let mut boundary = vec![false; vertices];
        for e in &self.edges {
            for v in e.vertices {
                starts[v as usize + 1] += 1;
                boundary[v as usize] |= e.faces.len() == 1;
            }
        }
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        let mut fill = starts.clone();
        let mut neighbours = vec![0; 2 * self.edges.len()];
        for e in &self.edges {
            for [v, w] in [e.vertices, [e.vertices[1], e.vertices[0]]] {
                neighbours[fill[v as usize] as usize] = w;
                fill[v as usize] += 1;
            }
        }
        for v in 0..vertices {
            neighbours[starts[v] as usize..starts[v + 1] as usize].sort_unstable();
        }
        Rings { starts, neighbours, boundary }
    }
}

/// Neighbours of vertices.
#[derive(Clone, Debug)]
pub(crate) struct Rings {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    pub(crate) boundary: Vec<bool>,
}

impl Rings {
    /// The neighbours of `v`, ascending.
    pub(crate) fn one(&self, v: usize) -> &[u32] {
        &self.neighbours[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// Writes the neighbours of `v` and theirs, ascending, without `v`.
    pub(crate) fn two(&self, v: usize, out: &mut Vec<u32>) {
        out.clear();
        for &w in self.one(v) {
            out.push(w);
            out.extend(self.one(w as usize).iter().filter(|&&x| x as usize != v));
        }
        out.sort_unstable();
        out.dedup();
    }
}

/// Compatible strips over the edges of a mesh, with the implicits of its vertices.
#[derive(Clone, Debug)]
pub struct Network {
    pub(crate) order: usize,
    pub(crate) contact: usize,
    pub(crate) implicits: Arc<Vec<Implicit>>,
    pub(crate) strips: Arc<Vec<Strip>>,
    pub(crate) edges: Edges,
    /// Whether the strips follow from the implicits.
    pub(crate) built: bool,
    /// Pairs of edges that are the two sides of a crease.
    pub(crate) creases: Vec<[u32; 2]>,
}

/// What the boundary curves of some edges are, other than curves over the edge along the interpolated normal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shapes {
    /// By edge, what to add to the derivatives at both ends; or empty.
    pub(crate) tangents: Vec<Option<[DVec3; 2]>>,
    /// Both sides of every crease, by their vertices.
    pub(crate) creases: Vec<[[u32; 2]; 2]>,
}

impl Network {
    /// The strips that osculate the vertex implicits with order `2n` at both ends of every edge. `contact` is the order of contact of the
    /// boundary curves where `order` is 0 (0 for straight edges, 2 for a curved G⁰ surface) and `2n` otherwise.
    ///
    /// # Errors
    /// What is wrong with the mesh, [`BubbleError::Order`], [`BubbleError::Count`], [`BubbleError::CoincidentVertices`].
    pub fn build(
        mesh: &PolyMesh,
        implicits: Vec<Implicit>,
        order: usize,
        contact: usize,
    ) -> Result<Self, BubbleError> {
        Self::build_shaped(mesh, implicits, order, contact, &Shapes::default())
    }

    /// As [`build`](Self::build), with curves given for some edges.
    pub(crate) fn build_shaped(
        mesh: &PolyMesh,
        implicits: Vec<Implicit>,
        order: usize,
        contact: usize,
        shapes: &Shapes,
    ) -> Result<Self, BubbleError> {
        mesh.check()?;
        let counts = check_orders(mesh, &implicits, order, contact)?;
        let edges = Edges::of(mesh);
        let (creases, curves) = bent(mesh, &implicits, &edges, contact, shapes);
        let strips = edges
            .edges
            .par_iter()
            .enumerate()
            .map_init(Vec::new, |scratch, (number, e)| {
                let [a, b] = e.vertices.map(|v| v as usize);
                let ends = [mesh.positions[a], mesh.positions[b]];
                if ends[0] == ends[1] {
                    return Err(BubbleError::CoincidentVertices { edge: e.vertices });
                }
                let normals = [implicits[a].gradient(), implicits[b].gradient()];
                let at = curves.binary_search_by_key(&(number as u32), |c| c.0).ok();
                let bend = match at.map(|i| &curves[i]) {
                    Some((_, curve, true)) => Bend::Whole(curve),
                    Some((_, curve, false)) => Bend::Part(curve),
                    None => Bend::None,
                };
                Ok(Strip::between(counts, ends, normals, [&implicits[a], &implicits[b]], bend, scratch))
            })
            .collect::<Vec<_>>();
        // The first error in the order of edges, whatever the threads did.
        let strips = strips.into_iter().collect::<Result<Vec<_>, _>>()?;
        let (implicits, strips) = (Arc::new(implicits), Arc::new(strips));
        Ok(Self { order, contact, implicits, strips, edges, built: true, creases })
    }

    /// A network of strips from elsewhere, one per edge in the order of [`mesh_edges`], in the canonical direction, with the implicits
    /// that the patches' corners follow.
    ///
    /// # Errors
    /// As [`build`](Self::build), and [`BubbleError::Strip`] where a strip has another order or other ends than its edge. That the
    /// strips match the implicits at their ends to the orders that a patch needs (`2n − k` for the tensor of degree `k`) is not checked; where
    /// they do not, patches lose smoothness at corners.
    pub fn from_strips(
        mesh: &PolyMesh,
        implicits: Vec<Implicit>,
        strips: Vec<Strip>,
    ) -> Result<Self, BubbleError> {
        mesh.check()?;
        let edges = Edges::of(mesh);
        if strips.len() != edges.edges.len() {
            return Err(BubbleError::Count {
                what: "strips",
                given: strips.len(),
                needed: edges.edges.len(),
            });
        }
        let (order, contact) = strips.first().map_or((0, 0), |s| (s.order(), s.contact()));
        check_orders(mesh, &implicits, order, contact)?;
        for (number, (strip, e)) in strips.iter().zip(&edges.edges).enumerate() {
            let bad = |reason| Err(BubbleError::Strip { strip: number, reason });
            if strip.order() != order || strip.contact() != contact {
                return bad("its order differs from that of the first strip");
            }
            let [a, b] = e.vertices.map(|v| v as usize);
            if strip.ends() != [mesh.positions[a], mesh.positions[b]] {
                return bad("its ends are not those of its edge");
            }
            if strip.normals() != [implicits[a].gradient(), implicits[b].gradient()] {
                return bad("its normals are not the gradients of the implicits");
            }
        }
        let (implicits, strips) = (Arc::new(implicits), Arc::new(strips));
        Ok(Self { order, contact, implicits, strips, edges, built: false, creases: Vec::new() })
    }

    /// The order `n`.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The vertex implicits.
    pub fn implicits(&self) -> &[Implicit] {
        &self.implicits
    }

    /// The strips, one per edge.
    pub fn strips(&self) -> &[Strip] {
        &self.strips
    }

    /// The edges, in the order of the strips.
    pub fn edges(&self) -> &[MeshEdge] {
        &self.edges.edges
    }
}

/// An edge, its curve, and whether that stands instead of a height.
type Bent = (u32, Vec<DVec3>, bool);

/// The creases as pairs of edges, and the bends of edges, ascending.
fn bent(
    mesh: &PolyMesh,
    implicits: &[Implicit],
    edges: &Edges,
    contact: usize,
    shapes: &Shapes,
) -> (Vec<[u32; 2]>, Vec<Bent>) {
    let mut curves: Vec<Bent> = Vec::new();
    let mut creases = Vec::with_capacity(shapes.creases.len());
    for sides in &shapes.creases {
        let find = |s: [u32; 2]| edges.edges.binary_search_by_key(&s, |e| e.vertices).ok();
        let (Some(a), Some(b)) = (find(sides[0]), find(sides[1])) else { continue };
        creases.push([a as u32, b as u32]);
        if contact > 0 {
            let at = |end: usize| sides.map(|s| &implicits[s[end] as usize]);
            let [v, w] = sides[0].map(|v| mesh.positions[v as usize]);
            let curve = crease::curve(contact, w - v, [at(0), at(1)]);
            curves.push((a as u32, curve.clone(), true));
            curves.push((b as u32, curve, true));
        }
    }
    curves.sort_by_key(|c| c.0);
    for (number, tangents) in shapes.tangents.iter().enumerate() {
        if let &Some([start, end]) = tangents
            && contact > 0
            && let Err(at) = curves.binary_search_by_key(&(number as u32), |c| c.0)
        {
            curves.insert(at, (number as u32, bend::tangents(start, end), false));
        }
    }
    (creases, curves)
}

/// The edges of a mesh in the order of their vertices: that of the strips of a network.
///
/// # Errors
/// What is wrong with the mesh.
pub fn mesh_edges(mesh: &PolyMesh) -> Result<Vec<MeshEdge>, BubbleError> {
    mesh.check()?;
    Ok(Edges::of(mesh).edges)
}

fn check_orders(
    mesh: &PolyMesh,
    implicits: &[Implicit],
    order: usize,
    contact: usize,
) -> Result<Counts, BubbleError> {
    if order > MAX_ORDER {
        return Err(BubbleError::Order { order, limit: MAX_ORDER });
    }
    let fits = if order == 0 { contact <= 2 } else { contact == 2 * order };
    if !fits {
        let range = "2n, or 0 to 2 where n = 0";
        return Err(BubbleError::Option { name: "contact", value: contact as f64, range });
    }
    if implicits.len() != mesh.positions.len() {
        let needed = mesh.positions.len();
        return Err(BubbleError::Count { what: "vertex implicits", given: implicits.len(), needed });
    }
    Ok(Counts { order, contact })
}
