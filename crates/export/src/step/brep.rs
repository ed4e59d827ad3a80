//! A boundary representation as plain data: what goes into the file.

use glam::{DVec2, DVec3};
use suture_bernstein::{BSplineCurve, BSplineSurface};

/// Faces on shared edges on shared vertices.
#[derive(Debug, Default)]
pub(crate) struct Brep {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) faces: Vec<Face>,
}

/// A curve between two vertices, its parameter growing from the first to the second.
#[derive(Debug)]
pub(crate) struct Edge {
    pub(crate) ends: [usize; 2],
    pub(crate) curve: BSplineCurve<DVec3>,
    /// Frame and radius of the circle that the curve is, between faces that are no splines.
    pub(crate) circle: Option<([DVec3; 3], f64)>,
}

/// A part of a surface, on the left of its loops.
#[derive(Debug)]
pub(crate) struct Face {
    pub(crate) geometry: Geometry,
    pub(crate) loops: Vec<Vec<Coedge>>,
    pub(crate) name: String,
    /// Number of the colour.
    pub(crate) colour: usize,
    /// Component of the surface that the face belongs to.
    pub(crate) shell: usize,
    /// Whether the outside is on the other side of the patch.
    pub(crate) flipped: bool,
    /// Whether the normals of the geometry are against those of the patch.
    pub(crate) against: bool,
}

/// What a face lies on. All but splines have the axes of a frame: point, direction of the axis, direction of zero longitude.
#[derive(Clone, Debug)]
pub(crate) enum Geometry {
    Spline(BSplineSurface<DVec3>),
    Plane {
        frame: [DVec3; 3],
    },
    Sphere {
        frame: [DVec3; 3],
        radius: f64,
    },
    Cylinder {
        frame: [DVec3; 3],
        radius: f64,
    },
    /// Widens along its axis, from `radius` at the point of the frame; `angle` is half its opening.
    Cone {
        frame: [DVec3; 3],
        radius: f64,
        angle: f64,
    },
}

/// The use of an edge by a face.
#[derive(Clone, Debug)]
pub(crate) struct Coedge {
    pub(crate) edge: usize,
    pub(crate) forward: bool,
    /// The edge in the parameters of the face's surface, parameter for parameter; `None` on analytic surfaces.
    pub(crate) pcurve: Option<Pcurve>,
}

/// A curve in a parameter plane.
#[derive(Clone, Debug)]
pub(crate) enum Pcurve {
    /// `origin + t direction`, the direction of length 1.
    Line {
        origin: DVec2,
        direction: DVec2,
    },
    Spline(BSplineCurve<DVec2>),
}

impl Pcurve {
    pub(crate) fn point(&self, t: f64) -> DVec2 {
        match self {
            Self::Line { origin, direction } => *origin + *direction * t,
            Self::Spline(curve) => curve.point(t),
        }
    }
}

impl Brep {
    /// Number of edges that are used by one face only.
    pub(crate) fn open_edges(&self) -> usize {
        let mut uses = vec![0usize; self.edges.len()];
        for coedge in self.faces.iter().flat_map(|f| f.loops.iter().flatten()) {
            uses[coedge.edge] += 1;
        }
        uses.into_iter().filter(|&n| n == 1).count()
    }

    /// Number of control points of all faces.
    pub(crate) fn control_points(&self) -> usize {
        self.faces
            .iter()
            .map(|f| match &f.geometry {
                Geometry::Spline(surface) => surface.net().len(),
                _ => 0,
            })
            .sum()
    }
}
