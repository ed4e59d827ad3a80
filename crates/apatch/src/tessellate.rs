//! Triangles of the surface: a regular grid over every face and every edge (Section 5 of the paper).
//!
//! Points on the walls between tetrahedra are computed once and used by both sides, so that the mesh is watertight by construction.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_mesh::TriMesh;
use suture_surface::PatchId;

use crate::face::SurfacePoint;
use crate::hull::Class;
use crate::{ApatchError, ApatchSurface};

/// A triangle mesh of the surface that knows where its vertices and triangles come from.
#[derive(Clone, Debug, PartialEq)]
pub struct ApatchTessellation {
    /// The mesh, with unit normals; closed where the input is.
    pub mesh: TriMesh,
    /// The patch (of [`ApatchSurface::surface`]) on which each vertex was computed.
    pub vertex_patch: Vec<PatchId>,
    /// Parameter of each vertex on its patch.
    pub vertex_parameter: Vec<DVec2>,
    /// The patch of every triangle.
    pub triangle_patch: Vec<PatchId>,
    /// Parameters of the corners of every triangle on the triangle's patch.
    pub corner_parameters: Vec<[DVec2; 3]>,
    /// Rays without a simple minimal root.
    pub missed: usize,
}

/// What lines on a surface show its smoothness: isophotes or reflection lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shading {
    /// The cosine of the angle between the normal and a direction: its level lines are isophotes.
    Isophotes {
        /// The direction, of any length.
        light: DVec3,
    },
    /// Where the mirrored view ray passes a bundle of parallel light lines: its level lines are reflection lines.
    Reflection {
        /// The eye, or the direction towards it where `parallel`.
        eye: DVec3,
        /// Whether all view rays are parallel.
        parallel: bool,
        /// Direction of the light lines.
        line: DVec3,
        /// Direction across the light lines in their plane.
        across: DVec3,
    },
}

impl Shading {
    /// The value at a point with a unit normal. Smooth of one order less than the surface.
    pub fn value(&self, position: DVec3, normal: DVec3) -> f64 {
        match *self {
            Self::Isophotes { light } => normal.dot(light.normalize_or_zero()),
            Self::Reflection { eye, parallel, line, across } => {
                let view = if parallel { eye } else { eye - position }.normalize_or_zero();
                let mirrored = 2.0 * normal.dot(view) * normal - view;
                // The angle around the lines, so that no plane of lights has an edge.
                let (x, n) = (across.normalize_or_zero(), line.cross(across).normalize_or_zero());
                mirrored.dot(x).atan2(mirrored.dot(n))
            }
        }
    }
}

/// A vertex in the making.
#[derive(Clone, Copy)]
struct Vertex {
    point: SurfacePoint,
    patch: u32,
    at: DVec2,
}

/// Numbers of the vertices along the walls of every edge: on the left and on the right one, in the direction of the edge.
struct Walls {
    /// Parameters of the samples, the ends included.
    xi: Vec<f64>,
    left: Vec<u32>,
    right: Vec<u32>,
    pinch: Option<usize>,
}

/// Samples of an edge, which of them is the crossing, and the points between its ends on the left and the right wall.
type WallPoints = (Vec<f64>, Option<usize>, [Vec<Vertex>; 2]);

impl ApatchSurface {
    /// Triangulates the surface: `n` segments along every edge, `m` across the patches of edges; `n²` triangles per face.
    ///
    /// # Errors
    /// [`ApatchError::Option`] for resolutions outside `1..=1024`, [`ApatchError::TooLarge`], [`ApatchError::NotFinitePatch`].
    pub fn tessellate(&self, n: usize, m: usize) -> Result<ApatchTessellation, ApatchError> {
        for (name, value) in [("n", n), ("m", m)] {
            if !(1..=1024).contains(&value) {
                return Err(ApatchError::Option { name, value: value as f64, range: "1..=1024" });
            }
        }
        let limit = u32::MAX as usize / 6;
        let count =
            self.faces.len().saturating_mul(n * n).saturating_add(self.edges.len().saturating_mul(2 * n * m));
        if count > limit {
            return Err(ApatchError::TooLarge { what: "triangles", count, limit });
        }
        let mut vertices = Vec::new();
        let corner = self.corners(&mut vertices);
        let walls = self.walls(n, &corner, &mut vertices);
        let lunes = self.lune_patches();
        let mut out = ApatchTessellation {
            mesh: TriMesh::default(),
            vertex_patch: Vec::new(),
            vertex_parameter: Vec::new(),
            triangle_patch: Vec::new(),
            corner_parameters: Vec::new(),
            missed: 0,
        };
        self.face_grids(n, &corner, &walls, &mut vertices, &mut out);
        self.edge_grids(m, &walls, &lunes, &mut vertices, &mut out);
        if let Some(v) = vertices.iter().find(|v| !v.point.position.is_finite()) {
            return Err(ApatchError::NotFinitePatch { face: self.face_of_patch(v.patch, &lunes) });
        }
        out.missed = vertices.iter().filter(|v| !v.point.simple).count();
        out.mesh.positions = vertices.iter().map(|v| v.point.position).collect();
        out.mesh.normals = Some(vertices.iter().map(|v| v.point.normal()).collect());
        out.vertex_patch = vertices.iter().map(|v| PatchId(v.patch)).collect();
        out.vertex_parameter = vertices.iter().map(|v| v.at).collect();
        Ok(out)
    }

    fn face_of_patch(&self, patch: u32, lunes: &[u32]) -> usize {
        if (patch as usize) < self.faces.len() {
            return patch as usize;
        }
        let edge = lunes.partition_point(|&l| l <= patch).saturating_sub(1);
        self.halves.get(edge).map_or(0, |&h| self.topology.face(h) as usize)
    }

    /// The vertices of the mesh that have faces; their numbers.
    fn corners(&self, vertices: &mut Vec<Vertex>) -> Vec<u32> {
        let gradients = self.mesh.normals.as_deref().unwrap_or(&[]);
        (0..self.mesh.positions.len() as u32)
            .map(|v| {
                let Some(h) = self.topology.outgoing(v).next() else { return u32::MAX };
                let point = SurfacePoint {
                    position: self.mesh.positions[v as usize],
                    gradient: gradients[v as usize],
                    t: 0.0,
                    simple: true,
                };
                vertices.push(Vertex { point, patch: self.topology.face(h), at: CORNERS[(h % 3) as usize] });
                vertices.len() as u32 - 1
            })
            .collect()
    }

    fn walls(&self, n: usize, corner: &[u32], vertices: &mut Vec<Vertex>) -> Vec<Walls> {
        // Points first, in parallel; numbers afterwards, in order.
        let points: Vec<WallPoints> = (0..self.edges.len())
            .into_par_iter()
            .map(|e| {
                let h = self.halves[e];
                let pinch = self.pinch(h).filter(|_| n > 1);
                let at = pinch.map(|x| ((x * n as f64).round() as usize).clamp(1, n - 1));
                let xi: Vec<f64> = (0..=n)
                    .map(|k| match pinch {
                        Some(x) if at == Some(k) => x,
                        _ => k as f64 / n as f64,
                    })
                    .collect();
                let wall = |h: u32, reverse: bool| -> Vec<Vertex> {
                    let along = |x: f64| if reverse { 1.0 - x } else { x };
                    xi[1..n].iter().map(|&x| self.wall_point(h, along(x))).collect()
                };
                let left = wall(h, false);
                let right = match self.topology.opposite(h) {
                    Some(o) if Class::of_edge(self.edges[e].e) != Class::Zero => wall(o, true),
                    _ => Vec::new(),
                };
                (xi, at, [left, right])
            })
            .collect();
        points
            .into_iter()
            .zip(&self.halves)
            .map(|((xi, pinch, [left, right]), &h)| {
                let [a, b] = [self.topology.tail(h), self.topology.head(h)].map(|v| corner[v as usize]);
                let mut number = |points: Vec<Vertex>, known: &[u32]| {
                    let mut ids = vec![a];
                    for (k, p) in points.into_iter().enumerate() {
                        if let (Some(&id), true) = (known.get(k + 1), pinch == Some(k + 1)) {
                            ids.push(id);
                        } else {
                            ids.push(vertices.len() as u32);
                            vertices.push(p);
                        }
                    }
                    ids.push(b);
                    ids
                };
                let left = number(left, &[]);
                let right = if right.is_empty() { left.clone() } else { number(right, &left) };
                Walls { xi, left, right, pinch }
            })
            .collect()
    }

    /// The surface at parameter `x` of a half-edge, seen from its face.
    fn wall_point(&self, h: u32, x: f64) -> Vertex {
        let (f, j) = (self.topology.face(h), (h % 3) as usize);
        let mut q = [0.0; 3];
        q[j] = 1.0 - x;
        q[(j + 1) % 3] = x;
        let point = self.face_point(f as usize, q).unwrap_or_default();
        Vertex { point, patch: f, at: DVec2::new(q[1], q[2]) }
    }

    fn face_grids(
        &self,
        n: usize,
        corner: &[u32],
        walls: &[Walls],
        vertices: &mut Vec<Vertex>,
        out: &mut ApatchTessellation,
    ) {
        let inner: Vec<Vec<Vertex>> = (0..self.faces.len())
            .into_par_iter()
            .map(|f| {
                let mut points = Vec::with_capacity((n.max(2) - 1) * (n.max(2) - 2) / 2);
                for j in 1..n {
                    for i in 1..n - j {
                        let at = DVec2::new(i as f64, j as f64) / n as f64;
                        let q = [(n - i - j) as f64 / n as f64, at.x, at.y];
                        let point = self.face_point(f, q).unwrap_or_default();
                        points.push(Vertex { point, patch: f as u32, at });
                    }
                }
                points
            })
            .collect();
        for (f, points) in inner.into_iter().enumerate() {
            let first = vertices.len();
            vertices.extend(points);
            // Samples along the three edges in the direction of the face.
            let sides = [0, 1, 2].map(|j| {
                let h = (3 * f + j) as u32;
                let e = self.of_half[h as usize] as usize;
                (&walls[e], self.halves[e] == h)
            });
            let on = |j: usize, k: usize| {
                let (wall, forward) = sides[j];
                let (ids, k) = if forward { (&wall.left, k) } else { (&wall.right, n - k) };
                (ids[k], if forward { wall.xi[k] } else { 1.0 - wall.xi[k] })
            };
            let node = |i: usize, j: usize| {
                let uniform = DVec2::new(i as f64, j as f64) / n as f64;
                if i + j == 0 || i == n || j == n {
                    let k = if i == n {
                        1
                    } else if j == n {
                        2
                    } else {
                        0
                    };
                    (corner[self.mesh.faces[f][k] as usize], CORNERS[k])
                } else if j == 0 {
                    let (id, x) = on(0, i);
                    (id, DVec2::new(x, 0.0))
                } else if i == 0 {
                    let (id, x) = on(2, n - j);
                    (id, DVec2::new(0.0, 1.0 - x))
                } else if i + j == n {
                    let (id, x) = on(1, j);
                    (id, DVec2::new(1.0 - x, x))
                } else {
                    // Rows of n − 2, n − 3, … points.
                    let before = (j - 1) * (n - 1) - (j - 1) * j / 2;
                    ((first + before + i - 1) as u32, uniform)
                }
            };
            for j in 0..n {
                for i in 0..n - j {
                    let mut push = |t: [(u32, DVec2); 3]| {
                        out.mesh.faces.push(t.map(|c| c.0));
                        out.triangle_patch.push(PatchId(f as u32));
                        out.corner_parameters.push(t.map(|c| c.1));
                    };
                    push([node(i, j), node(i + 1, j), node(i, j + 1)]);
                    if i + j + 2 <= n {
                        push([node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
                    }
                }
            }
        }
    }

    fn edge_grids(
        &self,
        m: usize,
        walls: &[Walls],
        lunes: &[u32],
        vertices: &mut Vec<Vertex>,
        out: &mut ApatchTessellation,
    ) {
        let inner: Vec<Vec<(Vertex, usize)>> = (0..self.edges.len())
            .into_par_iter()
            .map(|e| {
                let (wall, form) = (&walls[e], &self.edges[e]);
                let mut points = Vec::new();
                for k in 1..wall.xi.len() - 1 {
                    if wall.left[k] == wall.right[k] {
                        continue;
                    }
                    let (piece, zeta) = wall.place(k, k);
                    for j in 1..m {
                        let y = j as f64 / m as f64;
                        let point = form.point(wall.xi[k], y);
                        points.push((Vertex { point, patch: lunes[e] + piece, at: lune(zeta, y) }, k));
                    }
                }
                points
            })
            .collect();
        for (e, points) in inner.into_iter().enumerate() {
            let wall = &walls[e];
            if wall.left == wall.right {
                continue;
            }
            let n = wall.xi.len() - 1;
            let mut first = vec![0u32; n + 1];
            for (v, k) in points {
                if first[k] == 0 {
                    first[k] = vertices.len() as u32;
                }
                vertices.push(v);
            }
            let id = |k: usize, j: usize| match j {
                0 => wall.right[k],
                _ if j == m || wall.left[k] == wall.right[k] => wall.left[k],
                _ => first[k] + j as u32 - 1,
            };
            for k in 0..n {
                let (piece, _) = wall.place(k, k + 1);
                let patch = PatchId(lunes[e] + piece);
                for j in 0..m {
                    let node = |k: usize, j: usize, other: usize| {
                        (id(k, j), lune(wall.place(k, other).1, j as f64 / m as f64))
                    };
                    let [a, b] = [node(k, j, k + 1), node(k + 1, j, k)];
                    let [d, c] = [node(k, j + 1, k + 1), node(k + 1, j + 1, k)];
                    let position = |i: u32| vertices[i as usize].point.position;
                    let split = position(a.0).distance_squared(position(c.0))
                        <= position(b.0).distance_squared(position(d.0));
                    let pair = if split { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                    for t in pair {
                        // Where a lune ends, its columns are single points.
                        if t[0].0 == t[1].0 || t[1].0 == t[2].0 || t[2].0 == t[0].0 {
                            continue;
                        }
                        out.mesh.faces.push(t.map(|c| c.0));
                        out.triangle_patch.push(patch);
                        out.corner_parameters.push(t.map(|c| c.1));
                    }
                }
            }
        }
    }
}

impl Walls {
    /// The lune of the segment between samples `k` and `other` (0 or, beyond the crossing, 1), and the parameter there of sample `k`.
    fn place(&self, k: usize, other: usize) -> (u32, f64) {
        let x = self.xi[k];
        match self.pinch {
            None => (0, x),
            Some(p) if k.max(other) <= p => (0, x / self.xi[p]),
            Some(p) => (1, (x - self.xi[p]) / (1.0 - self.xi[p])),
        }
    }
}

const CORNERS: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

/// The parameter in the domain of a lune of the ray `(ζ, y)`.
fn lune(zeta: f64, y: f64) -> DVec2 {
    DVec2::new(zeta, (2.0 * y - 1.0) * zeta * (1.0 - zeta))
}
