//! Triangles of the surface: a regular grid over every face. Points on edges are computed once and used by all faces there, so that the
//! mesh is watertight by construction.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_mesh::TriMesh;
use suture_surface::{Patch, PatchId};

use crate::{BubbleError, BubblePatch, BubbleSurface};

/// A triangle mesh of the surface that knows where its vertices and triangles come from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BubbleTessellation {
    /// The mesh, with unit normals; closed where the input is.
    pub mesh: TriMesh,
    /// The patch on which each vertex was computed.
    pub vertex_patch: Vec<PatchId>,
    /// Parameter of each vertex on its patch.
    pub vertex_parameter: Vec<DVec2>,
    /// The patch of every triangle.
    pub triangle_patch: Vec<PatchId>,
    /// Parameters of the corners of every triangle on the triangle's patch.
    pub corner_parameters: Vec<[DVec2; 3]>,
}

/// A vertex in the making: position, normal, patch, parameter.
type Vertex = (DVec3, DVec3, u32, DVec2);

/// Largest number of segments along an edge.
const MOST: usize = 1024;

impl BubbleSurface {
    /// Triangulates the surface: `n` segments along every edge, `n²` triangles per triangle of the mesh, `2 n²` per quad.
    ///
    /// # Errors
    /// [`BubbleError::Option`] for `n` outside `1..=1024`, [`BubbleError::TooLarge`], [`BubbleError::NotFinitePatch`].
    pub fn tessellate(&self, n: usize) -> Result<BubbleTessellation, BubbleError> {
        if !(1..=MOST).contains(&n) {
            return Err(BubbleError::Option { name: "n", value: n as f64, range: "1 to 1024" });
        }
        let faces = self.patches().len();
        let limit = u32::MAX as usize / (12 * n * n);
        if faces > limit {
            return Err(BubbleError::TooLarge { faces, limit });
        }
        let edges = self.network().edges();
        let point = |f: u32, at: DVec2| {
            let patch = &self.patches()[f as usize];
            let jet = patch.jet(at);
            let normal = jet.normal().or_else(|| mean_normal(patch)).unwrap_or(DVec3::Z);
            (jet.p, normal, f, at)
        };

        let mut vertices: Vec<Vertex> = Vec::new();
        // A corner is computed on the first patch around it.
        let mut numbers = vec![u32::MAX; self.network().implicits().len()];
        let corners: Vec<[u32; 4]> = (0..faces)
            .map(|f| {
                let count = self.patches()[f].corners().len();
                let mut ids = [u32::MAX; 4];
                for k in 0..count {
                    // Sectors at a crease share their point.
                    let v = self.whole(self.corner(f, k)) as usize;
                    if numbers[v] == u32::MAX {
                        numbers[v] = vertices.len() as u32;
                        vertices.push(point(f as u32, corner(count, k)));
                    }
                    ids[k] = numbers[v];
                }
                ids
            })
            .collect();
        // Both sides of a crease share the points of one.
        let mut slots: Vec<usize> = (0..edges.len()).collect();
        self.network().creases.iter().for_each(|&[a, b]| slots[b as usize] = a as usize);
        let along: Vec<Vec<Vertex>> = edges
            .par_iter()
            .enumerate()
            .map(|(number, e)| {
                let Some(a) = e.faces.first().filter(|_| slots[number] == number) else { return Vec::new() };
                let count = self.patches()[a.face as usize].corners().len();
                (1..n)
                    .map(|k| {
                        let t = if a.forward { k } else { n - k } as f64 / n as f64;
                        point(a.face, side(count, a.side as usize, t))
                    })
                    .collect()
            })
            .collect();
        let mut starts = Vec::with_capacity(edges.len());
        for points in along {
            starts.push(vertices.len());
            vertices.extend(points);
        }
        let inside: Vec<Vec<Vertex>> = (0..faces)
            .into_par_iter()
            .map(|f| {
                let count = self.patches()[f].corners().len();
                inner(count, n).map(|[i, j]| point(f as u32, parameter(i, j, n))).collect()
            })
            .collect();

        let mut out = BubbleTessellation::default();
        for (f, points) in inside.into_iter().enumerate() {
            let count = self.patches()[f].corners().len();
            let before = vertices.len();
            vertices.extend(points);
            let id = |i: usize, j: usize| -> u32 {
                let (k, step) = match on_side(count, n, i, j) {
                    Place::Inside(index) => return (before + index) as u32,
                    Place::Side(k, step) => (k, step),
                };
                if step == 0 {
                    return corners[f][k];
                }
                let edge = self.side_edge(f, k);
                let step = if edges[edge].vertices[0] == self.corner(f, k) { step } else { n - step };
                (starts[slots[edge]] + step - 1) as u32
            };
            let mut push = |nodes: [[usize; 2]; 3]| {
                out.mesh.faces.push(nodes.map(|[i, j]| id(i, j)));
                out.triangle_patch.push(PatchId(f as u32));
                out.corner_parameters.push(nodes.map(|[i, j]| parameter(i, j, n)));
            };
            for j in 0..n {
                let last = if count == 4 { n } else { n - j };
                for i in 0..last {
                    push([[i, j], [i + 1, j], [i, j + 1]]);
                    if count == 4 || i + 1 < last {
                        push([[i + 1, j], [i + 1, j + 1], [i, j + 1]]);
                    }
                }
            }
        }
        if let Some(v) = vertices.iter().find(|v| !v.0.is_finite()) {
            return Err(BubbleError::NotFinitePatch { face: v.2 as usize });
        }
        out.mesh.positions = vertices.iter().map(|v| v.0).collect();
        out.mesh.normals = Some(vertices.iter().map(|v| v.1).collect());
        out.vertex_patch = vertices.iter().map(|v| PatchId(v.2)).collect();
        out.vertex_parameter = vertices.iter().map(|v| v.3).collect();
        Ok(out)
    }
}

/// What stands in for the normal where the patch has none.
fn mean_normal(patch: &BubblePatch) -> Option<DVec3> {
    patch.corner_normals().iter().sum::<DVec3>().try_normalize()
}

fn parameter(i: usize, j: usize, n: usize) -> DVec2 {
    DVec2::new(i as f64 / n as f64, j as f64 / n as f64)
}

fn corner(count: usize, k: usize) -> DVec2 {
    match (count, k) {
        (_, 0) => DVec2::ZERO,
        (_, 1) => DVec2::X,
        (4, 2) => DVec2::ONE,
        _ => DVec2::Y,
    }
}

/// The parameter at `t` of side `k`.
fn side(count: usize, k: usize, t: f64) -> DVec2 {
    corner(count, k) * (1.0 - t) + corner(count, (k + 1) % count) * t
}

/// The inner nodes of a face, row by row.
fn inner(count: usize, n: usize) -> impl Iterator<Item = [usize; 2]> {
    (1..n).flat_map(move |j| (1..if count == 4 { n } else { n - j }).map(move |i| [i, j]))
}

/// Where a node of the grid of a face is.
enum Place {
    /// Inside: its number in the order of [`inner`].
    Inside(usize),
    /// On a side, so many steps from its first corner, fewer than `n`.
    Side(usize, usize),
}

fn on_side(count: usize, n: usize, i: usize, j: usize) -> Place {
    if count == 4 {
        match (i, j) {
            _ if j == 0 && i < n => Place::Side(0, i),
            _ if i == n && j < n => Place::Side(1, j),
            _ if j == n && i > 0 => Place::Side(2, n - i),
            _ if i == 0 => Place::Side(3, n - j),
            _ => Place::Inside((j - 1) * (n - 1) + i - 1),
        }
    } else if j == 0 && i < n {
        Place::Side(0, i)
    } else if i + j == n && i > 0 {
        Place::Side(1, j)
    } else if i == 0 {
        Place::Side(2, n - j)
    } else {
        // Rows of n − 2, n − 3, … nodes.
        Place::Inside((j - 1) * (n - 1) - (j - 1) * j / 2 + i - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BubbleOptions, Face, PolyMesh, bubble};
    use suture_mesh::shapes;

    #[track_caller]
    fn check(mesh: &PolyMesh, n: usize, triangles: usize) -> BubbleTessellation {
        let surface = bubble(mesh, &BubbleOptions { order: 1, ..Default::default() }).unwrap();
        let t = surface.tessellate(n).unwrap();
        assert_eq!(t.mesh.faces.len(), triangles);
        for (face, (patch, at)) in t.mesh.faces.iter().zip(t.triangle_patch.iter().zip(&t.corner_parameters))
        {
            for k in 0..3 {
                let p = surface.patches()[patch.0 as usize].jet(at[k]).p;
                assert!(p.distance(t.mesh.positions[face[k] as usize]) < 1e-12, "{face:?} {at:?}");
            }
        }
        t
    }

    #[test]
    fn grids_are_watertight_and_every_triangle_knows_its_parameters() {
        let mesh = shapes::sphere(1);
        let poly = PolyMesh::from_triangles(&mesh, &mesh.positions).unwrap();
        for n in [1, 2, 3, 5] {
            let report = suture_mesh::check(&check(&poly, n, 80 * n * n).mesh);
            assert!(report.closed && report.manifold && report.oriented && report.genus == Some(0));
        }
    }

    #[test]
    fn quads_and_boundaries() {
        let mut mesh = PolyMesh::default();
        for j in 0..3 {
            for i in 0..3 {
                let (x, y) = (f64::from(i), f64::from(j));
                mesh.positions.push(DVec3::new(x, y, 0.1 * x * y));
                mesh.normals.push(DVec3::new(-0.1 * y, -0.1 * x, 1.0).normalize());
            }
        }
        mesh.faces = vec![
            Face::Quad([0, 1, 4, 3]),
            Face::Quad([1, 2, 5, 4]),
            Face::Quad([3, 4, 7, 6]),
            Face::Triangle([4, 5, 8]),
            Face::Triangle([8, 7, 4]),
        ];
        let report = suture_mesh::check(&check(&mesh, 4, 3 * 32 + 2 * 16).mesh);
        assert!(report.manifold && report.oriented && report.boundary_loops.total == 1);
    }

    #[test]
    fn resolutions_out_of_range_are_refused() {
        let mesh = shapes::sphere(0);
        let poly = PolyMesh::from_triangles(&mesh, &mesh.positions).unwrap();
        let surface = bubble(&poly, &BubbleOptions::default()).unwrap();
        for n in [0, 1025] {
            assert!(matches!(surface.tessellate(n), Err(BubbleError::Option { name: "n", .. })));
        }
    }
}
