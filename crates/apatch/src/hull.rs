//! The simplicial hull: classes of faces and edges, apex directions and apexes (specification, sections 1 and 2).

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use suture_mesh::{Topology, TriMesh};

use crate::coefficients::{Corners, EDGE, barycentric, barycentric_gradients};
use crate::{ApatchError, ApatchOptions};

/// How a face bends, seen from the positive side of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaceClass {
    /// The surface lies on the positive side: one rational piece.
    Positive,
    /// The surface lies on the negative side: one rational piece.
    Negative,
    /// The surface may cross the face: three cubic pieces on each side.
    Nonconvex,
    /// The surface is the face itself.
    Zero,
}

/// How an edge bends, seen from the positive side of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeClass {
    /// The surface lies on the positive side.
    Positive,
    /// The surface lies on the negative side.
    Negative,
    /// The surface crosses the edge once.
    Nonconvex,
    /// The edge lies on the surface.
    Zero,
}

impl EdgeClass {
    pub(crate) fn of(e: [f64; 2]) -> Self {
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

impl FaceClass {
    pub(crate) fn of(corners: &Corners) -> Self {
        let edges = EDGE.map(|[a, b]| EdgeClass::of([corners.e[a][b], corners.e[b][a]]));
        let any = |class: EdgeClass| edges.contains(&class);
        let w = corners.w();
        if edges == [EdgeClass::Zero; 3] {
            Self::Zero
        } else if any(EdgeClass::Nonconvex) || (any(EdgeClass::Positive) && any(EdgeClass::Negative)) {
            Self::Nonconvex
        } else if any(EdgeClass::Positive) {
            // With a positive w the rational piece might cross the face (erratum 12).
            if w.iter().any(|&w| w > 0.0) { Self::Nonconvex } else { Self::Positive }
        } else if w.iter().any(|&w| w < 0.0) {
            Self::Nonconvex
        } else {
            Self::Negative
        }
    }

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
    pub(crate) classes: Vec<FaceClass>,
    pub(crate) apexes: Vec<Apexes>,
    /// Half-edges (the lower of each pair) whose tetrahedra intersect those of the faces beside them.
    pub(crate) bad_edges: Vec<u32>,
    /// Faces without any direction, with the vertex whose normal stands worst.
    pub(crate) hopeless: Vec<(usize, usize)>,
}

/// The apexes of one face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apexes {
    /// `u` and `v`.
    pub(crate) points: [Option<DVec3>; 2],
    /// Which candidate direction was taken: 0 is the normal of the face.
    pub(crate) direction: u8,
    /// Whether even the best direction is steeper than wanted.
    pub(crate) steep: bool,
}

impl Hull {
    /// Classes and apexes; directions other than the face normals where tetrahedra would intersect their neighbours.
    pub(crate) fn new(
        mesh: &TriMesh,
        gradients: &[DVec3],
        topology: &Topology,
        options: &ApatchOptions,
    ) -> Self {
        let corners: Vec<Corners> = (0..mesh.faces.len())
            .into_par_iter()
            .map(|f| {
                Corners::new(mesh.corners(f), mesh.faces[f].map(|v| gradients[v as usize]), options.snap)
            })
            .collect();
        let classes: Vec<FaceClass> = corners.par_iter().map(FaceClass::of).collect();
        let mut choice = vec![0u8; corners.len()];
        let place = |choice: &[u8]| -> Vec<Result<Apexes, usize>> {
            (0..corners.len())
                .into_par_iter()
                .map(|f| apexes(&corners[f], classes[f], choice[f], options))
                .collect()
        };
        let settle = |found: Vec<Result<Apexes, usize>>| {
            let none = Apexes { points: [None; 2], direction: 0, steep: true };
            let hopeless: Vec<(usize, usize)> =
                found.iter().enumerate().filter_map(|(f, a)| a.as_ref().err().map(|&k| (f, k))).collect();
            (found.into_iter().map(|a| a.unwrap_or(none)).collect::<Vec<_>>(), hopeless)
        };
        let (apexes, hopeless) = settle(place(&choice));
        let bad_edges = bad_edges(&corners, &apexes, topology);
        let mut best =
            Self { corners: corners.clone(), classes: classes.clone(), apexes, bad_edges, hopeless };
        let mut bad = best.bad_edges.clone();
        for round in 1..=2u8 {
            if bad.is_empty() {
                break;
            }
            for &h in &bad {
                for face in
                    [Some(h), topology.opposite(h)].into_iter().flatten().map(|h| topology.face(h) as usize)
                {
                    choice[face] = choice[face].max(round);
                }
            }
            let (apexes, hopeless) = settle(place(&choice));
            bad = self::bad_edges(&corners, &apexes, topology);
            if bad.len() < best.bad_edges.len() {
                (best.apexes, best.hopeless, best.bad_edges) = (apexes, hopeless, bad.clone());
            }
        }
        best
    }

    /// Whether the surface contains the edge of a half-edge.
    pub(crate) fn is_straight(&self, h: u32) -> bool {
        let (f, [i, j]) = ((h / 3) as usize, EDGE[opposite_vertex(h)]);
        EdgeClass::of([self.corners[f].e[i][j], self.corners[f].e[j][i]]) == EdgeClass::Zero
    }

    /// How many places are left where tetrahedra intersect or are too steep.
    pub(crate) fn trouble(&self) -> usize {
        self.bad_edges.len() + self.apexes.iter().filter(|a| a.steep).count()
    }

    /// Faces that refinement should divide.
    pub(crate) fn faces_to_refine(&self, topology: &Topology) -> Vec<usize> {
        let mut faces: Vec<usize> = self
            .bad_edges
            .iter()
            .flat_map(|&h| [Some(h), topology.opposite(h)])
            .flatten()
            .map(|h| topology.face(h) as usize)
            .collect();
        faces.extend(self.apexes.iter().enumerate().filter(|(_, a)| a.steep).map(|(f, _)| f));
        faces.sort_unstable();
        faces.dedup();
        faces
    }
}

/// Cosine of the largest angle (about 107 degrees) between a normal and a face for which a tetrahedron is built by all means.
const FARTHEST: f64 = -0.3;

/// The apexes of a face; the corner whose normal stands worst where no direction rises above all tangent planes.
fn apexes(corners: &Corners, class: FaceClass, choice: u8, options: &ApatchOptions) -> Result<Apexes, usize> {
    let none = Apexes { points: [None; 2], direction: 0, steep: false };
    if class == FaceClass::Zero {
        return Ok(none);
    }
    let ell = (0.5 * (corners.p[1] - corners.p[0]).cross(corners.p[2] - corners.p[0]).length()).sqrt();
    let (normal, units) = normals(corners);
    let candidates =
        [normal, (units[0] + units[1] + units[2]).normalize_or_zero(), cap_centre(normal, units)];
    let c = corners.centroid();
    let mut best: Option<(u8, f64)> = None;
    // Normals far on the other side are a mistake of the input, not a steep place.
    let facing = units.iter().all(|g| g.dot(normal) > FARTHEST);
    let order: [u8; 3] = if choice == 0 {
        [0, 1, 2]
    } else if choice == 1 {
        [1, 2, 0]
    } else {
        [2, 1, 0]
    };
    for i in order {
        let d = candidates[i as usize];
        let lift = units.iter().fold(d.dot(normal), |m, g| m.min(d.dot(*g)));
        let rises = slopes(corners, c, d * ell).iter().all(|&s| s > 0.0);
        if lift > options.steepness && rises {
            best = Some((i, f64::INFINITY));
            break;
        }
        // Steep ones where nothing else is left; those under which an m_k does not rise last of all.
        let rank = if rises { lift } else { lift - 1.0 };
        if lift > 1e-3 && (rises || facing) && best.is_none_or(|b| rank > b.1) {
            best = Some((i, rank));
        }
    }
    let Some((direction, lift)) = best else {
        let worst = (0..3).fold(0, |w, k| if units[k].dot(normal) < units[w].dot(normal) { k } else { w });
        return Err(worst);
    };
    let d = candidates[direction as usize];
    let eps = options.clearance * ell;
    let (mut up, mut down) = (eps, -eps);
    for l in 0..3 {
        let t = (corners.p[l] - c).dot(corners.g[l]) / d.dot(corners.g[l]);
        (up, down) = (up.max(t + eps), down.min(t - eps));
    }
    let at = corners.m(c, &corners.h(c));
    for (k, slope) in slopes(corners, c, d * ell).into_iter().enumerate() {
        if slope > 0.0 {
            let t = -at[k] * ell / slope;
            (up, down) = (up.max(t), down.min(t));
        }
    }
    let [above, below] = class.sides();
    let points = [above.then(|| c + d * up), below.then(|| c + d * down)];
    Ok(Apexes { points, direction, steep: lift.is_finite() })
}

/// Increase of every `m_k` from `c` to `c + d`.
fn slopes(corners: &Corners, c: DVec3, d: DVec3) -> [f64; 3] {
    let (from, to) = (corners.m(c, &corners.h(c)), corners.m(c + d, &corners.h(c + d)));
    [0, 1, 2].map(|k| to[k] - from[k])
}

/// Unit normals of a face and of its corners.
pub(crate) fn normals(corners: &Corners) -> (DVec3, [DVec3; 3]) {
    let [a, b, c] = corners.p;
    ((b - a).cross(c - a).normalize_or_zero(), corners.g.map(DVec3::normalize_or_zero))
}

/// Centre of the smallest cap of directions around the face normal and the vertex normals: it rises above all of them if any does.
fn cap_centre(normal: DVec3, units: [DVec3; 3]) -> DVec3 {
    let all = [normal, units[0], units[1], units[2]];
    let mut best = (f64::NEG_INFINITY, normal);
    let mut offer = |d: DVec3| {
        let least = all.iter().fold(f64::INFINITY, |m, v| m.min(v.dot(d)));
        if least > best.0 {
            best = (least, d);
        }
    };
    for i in 0..4 {
        for j in 0..i {
            offer((all[i] + all[j]).normalize_or_zero());
            for k in 0..j {
                let d = (all[i] - all[j]).cross(all[j] - all[k]).normalize_or_zero();
                offer(d);
                offer(-d);
            }
        }
    }
    best.1
}

/// Half-edges (the lower of each pair) whose edge tetrahedra are not valid.
fn bad_edges(corners: &[Corners], apexes: &[Apexes], topology: &Topology) -> Vec<u32> {
    (0..topology.half_edge_count() as u32)
        .into_par_iter()
        .filter(|&h| {
            let Some(o) = topology.opposite(h).filter(|&o| h < o) else { return false };
            let ([f, g], [k, l]) = ([h, o].map(|h| topology.face(h) as usize), [h, o].map(opposite_vertex));
            let [i, j] = EDGE[k];
            let sides = EdgeClass::of([corners[f].e[i][j], corners[f].e[j][i]]).sides();
            (0..2).filter(|&s| sides[s]).any(|s| {
                let (Some(u), Some(v)) = (apexes[f].points[s], apexes[g].points[s]) else { return false };
                // Written so that what is not a number is bad.
                !(coordinate(&corners[f], u, k, v) < 0.0 && coordinate(&corners[g], v, l, u) < 0.0)
            })
        })
        .collect()
}

/// Coordinate of `x` that belongs to corner `k` of the tetrahedron over a face.
fn coordinate(corners: &Corners, apex: DVec3, k: usize, x: DVec3) -> f64 {
    let [a, b, c] = corners.p;
    barycentric(x, apex, &barycentric_gradients(&[a, b, c, apex]))[k]
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
