//! What the construction found and did.

use serde::Serialize;

/// Faces or edges by class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ClassCounts {
    /// The surface lies on the positive side.
    pub positive: usize,
    /// The surface lies on the negative side.
    pub negative: usize,
    /// The surface crosses, or may.
    pub nonconvex: usize,
    /// Plane faces, straight edges on the surface.
    pub zero: usize,
}

/// Intersections of tetrahedra that are not neighbours.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Intersections {
    /// Number of pairs.
    pub pairs: usize,
    /// The first pairs, by the face that each tetrahedron belongs to (for edge tetrahedra, one of its two).
    pub first: Vec<[u32; 2]>,
}

/// What the construction found and did. Numbers of faces and vertices are those of [`ApatchSurface::mesh`](crate::ApatchSurface::mesh).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ApatchReport {
    /// Vertices of the input.
    pub input_vertices: usize,
    /// Faces of the input.
    pub input_faces: usize,
    /// Vertices after refinement.
    pub vertices: usize,
    /// Faces after refinement.
    pub faces: usize,
    /// Edges between folded faces that were turned to the other diagonal of these faces, by their ends before.
    pub turned_edges: Vec<[u32; 2]>,
    /// Vertices whose normals were against a face, or at turned edges, and were estimated again.
    pub estimated_again: Vec<u32>,
    /// Rounds of local refinement.
    pub refinements: usize,
    /// Edges with one face.
    pub boundary_edges: usize,
    /// Classes of faces.
    pub face_classes: ClassCounts,
    /// Classes of inner edges.
    pub edge_classes: ClassCounts,
    /// Pieces of `F` over faces: one per convex face, six per nonconvex one (three per side).
    pub face_pieces: usize,
    /// Pieces of `F` along edges: one per convex edge, two per nonconvex one.
    pub edge_pieces: usize,
    /// Faces whose apexes do not lie over the face normal.
    pub turned_faces: usize,
    /// Faces whose normals are so steep that no direction keeps the wanted distance from the tangent planes.
    pub steep_faces: Vec<u32>,
    /// Edges whose tetrahedron intersects those of the faces beside it: the patches join smoothly there, but may fold.
    pub bad_edges: Vec<[u32; 2]>,
    /// Faces whose apex weight had to be raised above what was asked for.
    pub raised_faces: usize,
    /// Rounds in which edges raised weights.
    pub edge_rounds: usize,
    /// Edges that raised the weights of their faces by different amounts.
    pub weighted_edges: usize,
    /// Faces for which it is not proven that every ray has a simple minimal root.
    pub unproven_faces: Vec<u32>,
    /// Of these, the faces where a ray without such a root was found.
    pub violated_faces: Vec<u32>,
    /// Edges for which it is not proven that every ray has a simple minimal root.
    pub unproven_edges: Vec<[u32; 2]>,
    /// Of these, the edges where a ray without such a root was found.
    pub violated_edges: Vec<[u32; 2]>,
    /// Intersections of tetrahedra that share no vertex; `None` where they were not looked for.
    pub intersections: Option<Intersections>,
}
