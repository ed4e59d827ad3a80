//! The simplicial hull: classes of faces and edges, apex directions and apexes (specification, sections 1 and 2).

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use suture_mesh::{Topology, TriMesh};

use crate::apexes::{Apexes, Site, normals};
use crate::coefficients::{Corners, EDGE};
use crate::directions::Directions;
use crate::{ApatchError, ApatchOptions};

/// How a face or an edge bends, seen from the positive side of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// The surface lies on the positive side: one rational piece over a face, one tetrahedron along an edge.
    Positive,
    /// The surface lies on the negative side: one rational piece over a face, one tetrahedron along an edge.
    Negative,
    /// The surface may cross the face (three cubic pieces on each side), or crosses the edge (one tetrahedron on each side).
    Nonconvex,
    /// The surface is the face itself, or contains the edge.
    Zero,
}

impl Class {
    /// The class of an edge with coefficients `e_ab`, `e_ba`.
    pub(crate) fn of_edge(e: [f64; 2]) -> Self {
        if e == [0.0; 2] {
            Self::Zero
        } else if e[0] <= 0.0 && e[1] <= 0.0 {
            Self::Positive
        } else if e[0] >= 0.0 && e[1] >= 0.0 {
            Self::Negative
        } else {
            Self::Nonconvex
        }
    }

    /// The class of a face.
    pub(crate) fn of_face(corners: &Corners) -> Self {
        let edges = EDGE.map(|[a, b]| Self::of_edge([corners.e[a][b], corners.e[b][a]]));
        let any = |class: Self| edges.contains(&class);
        let w = corners.w();
        if edges == [Self::Zero; 3] {
            Self::Zero
        } else if any(Self::Nonconvex) || (any(Self::Positive) && any(Self::Negative)) {
            Self::Nonconvex
        } else if any(Self::Positive) {
            // With a positive w the rational piece might cross the face (erratum 12).
            if w.iter().any(|&w| w > 0.0) { Self::Nonconvex } else { Self::Positive }
        } else if w.iter().any(|&w| w < 0.0) {
            Self::Nonconvex
        } else {
            Self::Negative
        }
    }

    /// Whether there are tetrahedra on the positive and on the negative side.
    pub(crate) fn sides(self) -> [bool; 2] {
        match self {
            Self::Positive => [true, false],
            Self::Negative => [false, true],
            Self::Nonconvex => [true, true],
            Self::Zero => [false, false],
        }
    }
}

/// Corners, classes and apexes of all faces.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    pub(crate) corners: Vec<Corners>,
    pub(crate) classes: Vec<Class>,
    pub(crate) apexes: Vec<Apexes>,
    /// Half-edges (the lower of each pair) whose tetrahedra intersect those of the faces beside them.
    pub(crate) bad_edges: Vec<u32>,
    /// Faces without any direction, with the vertex whose normal stands worst.
    pub(crate) hopeless: Vec<(usize, usize)>,
}

impl Hull {
    /// Classes and apexes; directions other than the face normals where tetrahedra would intersect their neighbours.
    pub(crate) fn new(
        mesh: &TriMesh,
        gradients: &[DVec3],
        topology: &Topology,
        options: &ApatchOptions,
    ) -> Self {
        let found: Vec<(Corners, Class, Result<Apexes, usize>)> = (0..mesh.faces.len())
            .into_par_iter()
            .map(|f| {
                let gradients = mesh.faces[f].map(|v| gradients[v as usize]);
                let corners = Corners::new(mesh.corners(f), gradients, options.snap);
                let class = Class::of_face(&corners);
                let apexes = match class {
                    Class::Zero => Ok(Apexes::NONE),
                    _ => Site::new(&corners, class, options).first(),
                };
                (corners, class, apexes)
            })
            .collect();
        let hopeless = found.iter().enumerate().filter_map(|(f, a)| a.2.as_ref().err().map(|&k| (f, k)));
        let hopeless: Vec<(usize, usize)> = hopeless.collect();
        let none = Apexes { steep: true, ..Apexes::NONE };
        let mut apexes: Vec<Apexes> = found.iter().map(|a| *a.2.as_ref().unwrap_or(&none)).collect();
        let (corners, classes): (Vec<_>, Vec<_>) = found.into_iter().map(|a| (a.0, a.1)).unzip();
        let directions = Directions { corners: &corners, classes: &classes, topology, options };
        let bad_edges = directions.improve(&mut apexes);
        Self { corners, classes, apexes, bad_edges, hopeless }
    }

    /// Whether the surface contains the edge of a half-edge.
    pub(crate) fn is_straight(&self, h: u32) -> bool {
        let (f, [i, j]) = ((h / 3) as usize, EDGE[opposite_vertex(h)]);
        Class::of_edge([self.corners[f].e[i][j], self.corners[f].e[j][i]]) == Class::Zero
    }

    /// Whether every face has apexes, none is steep and no tetrahedra intersect.
    pub(crate) fn is_sound(&self) -> bool {
        self.hopeless.is_empty() && self.trouble() == 0
    }

    /// How many places are left where tetrahedra intersect or are too steep.
    pub(crate) fn trouble(&self) -> usize {
        self.bad_edges.len() + self.apexes.iter().filter(|a| a.steep).count()
    }

    /// How much of it there is at every vertex, faces without any direction counted as much as many edges.
    pub(crate) fn trouble_at(&self, mesh: &TriMesh, topology: &Topology) -> Vec<usize> {
        let mut at = vec![0; mesh.positions.len()];
        let mut add = |vertices: &[u32], n: usize| vertices.iter().for_each(|&v| at[v as usize] += n);
        for &h in &self.bad_edges {
            add(&[topology.tail(h), topology.head(h)], 1);
        }
        for (face, apexes) in mesh.faces.iter().zip(&self.apexes) {
            add(face, usize::from(apexes.steep));
        }
        for &(f, _) in &self.hopeless {
            add(&mesh.faces[f], 1000);
        }
        at
    }

    /// Faces that have no apexes or steep ones, or whose tetrahedra intersect those beside them.
    pub(crate) fn faces_in_trouble(&self, topology: &Topology) -> Vec<usize> {
        let mut faces: Vec<usize> = self
            .bad_edges
            .iter()
            .flat_map(|&h| [Some(h), topology.opposite(h)])
            .flatten()
            .map(|h| topology.face(h) as usize)
            .collect();
        faces.extend(self.hopeless.iter().map(|h| h.0));
        faces.extend(self.apexes.iter().enumerate().filter(|(_, a)| a.steep).map(|(f, _)| f));
        faces.sort_unstable();
        faces.dedup();
        faces
    }
}

/// The corner of its face opposite a half-edge.
pub(crate) fn opposite_vertex(h: u32) -> usize {
    ((h % 3 + 2) % 3) as usize
}

/// The error for a face without direction.
pub(crate) fn against(mesh: &TriMesh, corners: &Corners, face: usize, k: usize) -> ApatchError {
    let (normal, units) = normals(corners);
    let degrees = units[k].cross(normal).length().atan2(units[k].dot(normal)).to_degrees();
    ApatchError::NormalAgainstFace { face, vertex: mesh.faces[face][k] as usize, degrees }
}
