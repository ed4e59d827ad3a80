//! The indexed triangle mesh.

use glam::DVec3;

use crate::measure::length;

/// Triangles over shared vertices; faces are counter-clockwise seen from outside.
///
/// The fields are plain data and nothing is promised of them: [`Topology::build`](crate::Topology::build) is where a mesh proves
/// that it is an oriented manifold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, in the units of the input.
    pub positions: Vec<DVec3>,
    /// Vertex indices of every face.
    pub faces: Vec<[u32; 3]>,
    /// One normal per vertex, where the file has them; not necessarily of unit length.
    pub normals: Option<Vec<DVec3>>,
}

impl TriMesh {
    /// A mesh without normals.
    pub fn new(positions: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Self {
        Self { positions, faces, normals: None }
    }

    /// The three positions of face `f`.
    ///
    /// # Panics
    /// When the face or one of its vertices does not exist.
    pub fn corners(&self, f: usize) -> [DVec3; 3] {
        self.faces[f].map(|v| self.positions[v as usize])
    }

    /// Half the cross product of two edges of face `f`: its outward normal times its area.
    ///
    /// # Panics
    /// When the face or one of its vertices does not exist.
    pub fn area_vector(&self, f: usize) -> DVec3 {
        let [a, b, c] = self.corners(f);
        0.5 * (b - a).cross(c - a)
    }

    /// Lower and upper corner of the box around the vertices that faces use; `None` without any. Faces may name vertices that do
    /// not exist.
    pub fn bounding_box(&self) -> Option<[DVec3; 2]> {
        let mut used = self.faces.iter().flatten().filter_map(|&v| self.positions.get(v as usize)).copied();
        let first = used.next()?;
        Some(used.fold([first; 2], |[lo, hi], p| [lo.min(p), hi.max(p)]))
    }

    /// Length of the diagonal of [`bounding_box`](Self::bounding_box): the length that all tolerances refer to. 0 without faces.
    pub fn diagonal(&self) -> f64 {
        self.bounding_box().map_or(0.0, |[lo, hi]| length(hi - lo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_is_that_of_the_vertices_in_use() {
        let positions = [DVec3::ZERO, DVec3::splat(9.0), DVec3::new(3.0, 4.0, 0.0)];
        for scale in [1.0, 2f64.powi(900), 2f64.powi(-900)] {
            let positions = positions.iter().map(|&p| p * scale).collect();
            let mesh = TriMesh::new(positions, vec![[0, 2, 2], [0, 77, 0]]);
            assert_eq!(mesh.diagonal(), 5.0 * scale);
        }
        assert_eq!((TriMesh::default().bounding_box(), TriMesh::default().diagonal()), (None, 0.0));
    }
}
