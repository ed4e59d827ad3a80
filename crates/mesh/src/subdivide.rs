//! Finer meshes of the same shape.

use std::collections::HashMap;

use crate::{MeshError, TriMesh, io::mean_normal};

/// Divides every face into four at the midpoints of its edges; the shape stays the same. The old vertices come first, then the
/// midpoints in the order of first use; face `f` becomes faces `4 f` to `4 f + 3` (at its first, second and third vertex, then
/// in the middle). Normals of midpoints are the mean directions of their ends, or zero where these cancel.
///
/// # Errors
/// [`MeshError::VertexIndex`], [`MeshError::NormalCount`], and [`MeshError::TooLarge`] where 32-bit indices run out.
pub fn subdivide_midpoint(mesh: &TriMesh) -> Result<TriMesh, MeshError> {
    let vertices = mesh.positions.len();
    if let Some(normals) = mesh.normals.as_ref().map(Vec::len).filter(|&n| n != vertices) {
        return Err(MeshError::NormalCount { normals, vertices });
    }
    let limit = u32::MAX as usize - 1;
    let most = vertices.saturating_add(mesh.faces.len().saturating_mul(3));
    if most > limit {
        return Err(MeshError::TooLarge { what: "vertices after subdivision", count: most, limit });
    }
    let mut fine = TriMesh { faces: Vec::with_capacity(4 * mesh.faces.len()), ..mesh.clone() };
    fine.faces.clear();
    let mut midpoints = HashMap::with_capacity(2 * mesh.faces.len());
    for (face, &corners) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(MeshError::VertexIndex { face, vertex, vertices });
        }
        let mut middle = |a: u32, b: u32| {
            // Sums in the order of the vertices: the bits do not depend on the side of the edge.
            let (a, b) = (a.min(b), a.max(b));
            *midpoints.entry((a, b)).or_insert_with(|| {
                let [p, q] = [a, b].map(|v| mesh.positions[v as usize]);
                fine.positions.push(0.5 * p + 0.5 * q);
                if let (Some(to), Some(from)) = (&mut fine.normals, &mesh.normals) {
                    to.push(mean_normal(&[from[a as usize], from[b as usize]]).unwrap_or_default());
                }
                fine.positions.len() as u32 - 1
            })
        };
        let [a, b, c] = corners;
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        fine.faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    Ok(fine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, shapes};

    #[test]
    fn topology_and_volume_stay() {
        let mesh = shapes::double_torus(2);
        let (coarse, fine) = (check(&mesh), check(&subdivide_midpoint(&mesh).unwrap()));
        assert_eq!((fine.faces, fine.edges), (4 * coarse.faces, 2 * coarse.edges + 3 * coarse.faces));
        assert_eq!((fine.genus, fine.closed, fine.oriented), (coarse.genus, true, true));
        assert!((fine.volume / coarse.volume - 1.0).abs() < 1e-13);
    }

    #[test]
    fn a_missing_vertex_is_an_error() {
        let mut mesh = shapes::sphere(0);
        mesh.faces[7][1] = 12;
        assert!(matches!(subdivide_midpoint(&mesh), Err(MeshError::VertexIndex { face: 7, vertex: 12, .. })));
    }
}
