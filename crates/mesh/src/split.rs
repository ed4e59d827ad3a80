//! The components of a mesh, each as a mesh.

use crate::{
    TriMesh,
    edges::{face_components, usable_faces},
};

/// Splits a mesh into the parts that hang together by shared vertices, in the order of their first faces; vertices and faces keep
/// their order, normals go along. Isolated vertices and faces that name missing or repeated vertices are left out.
pub fn components(mesh: &TriMesh) -> Vec<TriMesh> {
    let usable = usable_faces(mesh);
    let (label, count) = face_components(mesh, &usable);
    let normals = mesh.normals.as_ref().filter(|n| n.len() == mesh.positions.len());
    let mut parts = vec![TriMesh { normals: normals.map(|_| Vec::new()), ..TriMesh::default() }; count];
    let mut home = vec![None; mesh.positions.len()];
    for (face, &c) in mesh.faces.iter().zip(&label) {
        if c.is_some() {
            face.iter().for_each(|&v| home[v as usize] = c);
        }
    }
    let mut renumbered = vec![0; mesh.positions.len()];
    for (v, &c) in home.iter().enumerate() {
        let Some(c) = c else { continue };
        let part = &mut parts[c];
        renumbered[v] = part.positions.len() as u32;
        part.positions.push(mesh.positions[v]);
        if let (Some(to), Some(from)) = (&mut part.normals, normals) {
            to.push(from[v]);
        }
    }
    for (face, &c) in mesh.faces.iter().zip(&label) {
        if let Some(c) = c {
            parts[c].faces.push(face.map(|v| renumbered[v as usize]));
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn parts_come_back_as_they_went_in() {
        let (a, b) = (shapes::sphere(1), shapes::torus(3.0, 1.0, 5, 4));
        let mut both = a.clone();
        both.positions.push(glam::DVec3::ONE);
        let offset = both.positions.len() as u32;
        both.positions.extend(&b.positions);
        both.faces.extend(b.faces.iter().map(|f| f.map(|v| v + offset)));
        both.faces.push([0, 0, u32::MAX]);
        assert_eq!(components(&both), [a, b]);
        assert!(components(&TriMesh::default()).is_empty());
    }
}
