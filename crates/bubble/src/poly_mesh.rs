//! Polygon meshes of triangles and quads with normals: the input.

use glam::DVec3;
use suture_mesh::TriMesh;

use crate::BubbleError;

/// A face: vertex indices counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Three vertices.
    Triangle([u32; 3]),
    /// Four vertices, not necessarily in a plane.
    Quad([u32; 4]),
}

impl Face {
    /// The vertices, counter-clockwise.
    pub fn vertices(&self) -> &[u32] {
        match self {
            Self::Triangle(v) => v,
            Self::Quad(v) => v,
        }
    }
}

/// Triangles and quads over shared vertices, with one normal per vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolyMesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Outward normals, one per vertex; unit length is right (their lengths weigh the surface's height function).
    pub normals: Vec<DVec3>,
    /// The faces.
    pub faces: Vec<Face>,
}

impl PolyMesh {
    /// A triangle mesh with given normals.
    ///
    /// # Errors
    /// [`BubbleError::NormalCount`] unless there is one normal per vertex.
    pub fn from_triangles(mesh: &TriMesh, normals: &[DVec3]) -> Result<Self, BubbleError> {
        if normals.len() != mesh.positions.len() {
            return Err(BubbleError::NormalCount { normals: normals.len(), vertices: mesh.positions.len() });
        }
        Ok(Self {
            positions: mesh.positions.clone(),
            normals: normals.to_vec(),
            faces: mesh.faces.iter().map(|&f| Face::Triangle(f)).collect(),
        })
    }

    /// Checks indices, positions and normals.
    pub(crate) fn check(&self) -> Result<(), BubbleError> {
        let vertices = self.positions.len();
        if self.faces.is_empty() {
            return Err(BubbleError::Empty);
        }
        if self.normals.len() != vertices {
            return Err(BubbleError::NormalCount { normals: self.normals.len(), vertices });
        }
        let limit = (u32::MAX / 4) as usize;
        if self.faces.len() > limit {
            return Err(BubbleError::TooLarge { faces: self.faces.len(), limit });
        }
        for (face, f) in self.faces.iter().enumerate() {
            let corners = f.vertices();
            for (k, &vertex) in corners.iter().enumerate() {
                if vertex as usize >= vertices {
                    return Err(BubbleError::VertexIndex { face, vertex, vertices });
                }
                if corners[..k].contains(&vertex) {
                    return Err(BubbleError::RepeatedVertex { face, vertex });
                }
                let (p, n) = (self.positions[vertex as usize], self.normals[vertex as usize]);
                // Squares of lengths are formed everywhere: what over- or underflows there is as bad as infinity or zero.
                if !p.is_finite() || !p.length_squared().is_finite() {
                    return Err(BubbleError::NotFinite { vertex: vertex as usize });
                }
                if !(n.length_squared() > 0.0 && n.length_squared().is_finite()) {
                    return Err(BubbleError::Normal { vertex: vertex as usize, length: n.length() });
                }
            }
        }
        Ok(())
    }
}
