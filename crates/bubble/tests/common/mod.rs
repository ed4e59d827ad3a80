//! Jumps across seams, measured from the patches alone.
#![allow(dead_code, unreachable_pub, reason = "every user takes what it needs")]

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use suture_bubble::{BubblePatch, BubbleSurface, Face, PolyMesh};
use suture_mesh::TriMesh;
use suture_surface::{EdgeRef, Jet2, Patch, Seam};

/// Unit normal and shape operator as a symmetric tensor in space.
pub fn shape(jet: &Jet2) -> (DVec3, DMat3) {
    let cross = jet.du.cross(jet.dv);
    let (area, n) = (cross.length(), cross.normalize());
    let (au, av) = (jet.dv.cross(n) / area, n.cross(jet.du) / area);
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let mixed = outer(au, av) + outer(av, au);
    let s = outer(au, au) * jet.duu.dot(n) + mixed * jet.duv.dot(n) + outer(av, av) * jet.dvv.dot(n);
    (n, s)
}

pub fn frobenius(m: &DMat3) -> f64 {
    m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub fn mean_curvature(jet: &Jet2) -> f64 {
    let s = shape(jet).1;
    0.5 * (s.x_axis.x + s.y_axis.y + s.z_axis.z)
}

/// Largest jumps over all seams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jumps {
    /// Distance, relative to the diagonal.
    pub position: f64,
    /// Angle of the normals in radians.
    pub normal: f64,
    /// Difference of the shape operators relative to the larger of them (or to the inverse of the diagonal).
    pub shape: f64,
}

impl Jumps {
    fn max(self, o: Self) -> Self {
        let max = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
        Self {
            position: max(self.position, o.position),
            normal: max(self.normal, o.normal),
            shape: max(self.shape, o.shape),
        }
    }
}

pub fn edge_point(surface: &BubbleSurface, edge: EdgeRef, t: f64) -> (&BubblePatch, DVec2) {
    let patch = &surface.patches()[edge.patch.0 as usize];
    let at = patch.domain().edge(edge.edge as usize).unwrap().point(t);
    (patch, at)
}

/// Jumps over all seams at the parameters `ts`; the angles ignore the orientation of the patches.
pub fn jumps(surface: &BubbleSurface, diagonal: f64, ts: &[f64]) -> Jumps {
    patch_jumps(surface.patches(), surface.seams(), diagonal, ts)
}

/// As [`jumps`], of any patches.
pub fn patch_jumps<P: Patch>(patches: &[P], seams: &[Seam], diagonal: f64, ts: &[f64]) -> Jumps {
    let each: Vec<Jumps> = seams
        .par_iter()
        .map(|seam| {
            ts.iter().fold(Jumps::default(), |worst, &t| {
                let jet = |edge: EdgeRef, t| {
                    let patch = &patches[edge.patch.0 as usize];
                    patch.jet(patch.domain().edge(edge.edge as usize).unwrap().point(t))
                };
                let (a, b) = (jet(seam.a, t), jet(seam.b, seam.opposite(t)));
                let ((na, sa), (mut nb, mut sb)) = (shape(&a), shape(&b));
                // A patch that folds over turns its normal.
                if na.dot(nb) < 0.0 {
                    (nb, sb) = (-nb, sb * -1.0);
                }
                let curvature = frobenius(&sa).max(frobenius(&sb)).max(1.0 / diagonal);
                worst.max(Jumps {
                    position: a.p.distance(b.p) / diagonal,
                    normal: na.cross(nb).length().atan2(na.dot(nb)),
                    shape: frobenius(&(sa - sb)) / curvature,
                })
            })
        })
        .collect();
    each.into_iter().fold(Jumps::default(), Jumps::max)
}

/// `count` parameters from 0 to 1, both included.
pub fn parameters(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 / (count - 1) as f64).collect()
}

/// Parameters close to 0 and 1, where patches change from one formula to another.
pub fn near_ends() -> Vec<f64> {
    (6..34).step_by(3).map(|k| 0.5_f64.powi(k)).flat_map(|e| [e, 1.0 - e]).collect()
}

type Plane = [[f64; 5]; 5];

fn mul(a: &Plane, b: &Plane) -> Plane {
    let mut out = [[0.0; 5]; 5];
    for i in 0..5 {
        for j in 0..5 - i {
            for k in 0..5 - i - j {
                for l in 0..5 - i - j - k {
                    out[i + k][j + l] += a[i][j] * b[k][l];
                }
            }
        }
    }
    out
}

/// Coefficients of the surface as a graph over the plane across `n`, in units of `unit`, by order: `[k][a]` belongs to
/// `x^a y^(k−a)`.
pub fn graph(c: &[[DVec3; 5]; 5], n: DVec3, unit: f64) -> Vec<Vec<f64>> {
    let (e, f) = n.any_orthonormal_pair();
    let part = |d: DVec3| {
        let mut p: Plane = std::array::from_fn(|i| std::array::from_fn(|j| c[i][j].dot(d) / unit));
        p[0][0] = 0.0;
        p
    };
    let (x, y, z) = (part(e), part(f), part(n));
    let mut one = [[0.0; 5]; 5];
    one[0][0] = 1.0;
    let orders: Vec<(usize, usize)> = (1..5).flat_map(|k| (0..k + 1).map(move |a| (a, k - a))).collect();
    let power = |p: &Plane, k: usize| (0..k).fold(one, |q, _| mul(&q, p));
    let columns: Vec<Plane> = orders.iter().map(|&(a, b)| mul(&power(&x, a), &power(&y, b))).collect();
    let m = nalgebra::DMatrix::from_fn(14, 14, |r, c| columns[c][orders[r].0][orders[r].1]);
    let right = nalgebra::DVector::from_fn(14, |r, _| z[orders[r].0][orders[r].1]);
    let solution = m.lu().solve(&right).unwrap();
    let mut out = vec![vec![0.0]];
    for k in 1..5 {
        out.push(
            (0..k + 1).map(|a| solution[orders.iter().position(|&o| o == (a, k - a)).unwrap()]).collect(),
        );
    }
    out
}

/// Largest jump of the graph coefficients of orders 0 to 4 over all seams, in units of the edge, relative to the coefficients' size (or
/// to 1).
pub fn jet_jumps(surface: &BubbleSurface, ts: &[f64]) -> [f64; 5] {
    let mut worst = [0.0_f64; 5];
    for seam in surface.seams() {
        for &t in ts {
            let ((p, a), (q, b)) =
                (edge_point(surface, seam.a, t), edge_point(surface, seam.b, seam.opposite(t)));
            let (a_jet, b_jet) = (p.taylor(a), q.taylor(b));
            let unit = p.corners()[0].distance(p.corners()[1]);
            let n = p.jet(a).normal().unwrap();
            let (ga, gb) = (graph(&a_jet, n, unit), graph(&b_jet, n, unit));
            worst[0] = worst[0].max(a_jet[0][0].distance(b_jet[0][0]) / unit);
            for k in 1..5 {
                let size = ga[k].iter().chain(&gb[k]).fold(1.0_f64, |m, x| m.max(x.abs()));
                let jump = ga[k].iter().zip(&gb[k]).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
                worst[k] = worst[k].max(jump / size);
            }
        }
    }
    worst
}

/// A triangle mesh with the normals of its vertices, averaged over faces.
pub fn with_normals(mesh: &TriMesh) -> PolyMesh {
    PolyMesh::from_triangles(mesh, &suture_mesh::vertex_normals_area_weighted(mesh)).unwrap()
}

pub fn tetrahedron() -> TriMesh {
    let p = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]].map(DVec3::from_array);
    TriMesh::new(p.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

/// A sphere's points displaced, so that nothing is symmetric.
pub fn deformed(level: u32) -> TriMesh {
    let mut mesh = suture_mesh::shapes::sphere(level);
    for p in &mut mesh.positions {
        let q = *p;
        *p *= 1.0 + 0.12 * (2.0 * q.x + 0.7 * q.y).sin() + 0.08 * (3.0 * q.z - q.x).cos();
    }
    mesh
}

/// A closed tube around a ring of quads, every `triangles`-th of which is divided into two triangles; normals are exact.
pub fn torus(nu: u32, nv: u32, triangles: u32) -> PolyMesh {
    let mut mesh = PolyMesh::default();
    for i in 0..nu {
        for j in 0..nv {
            let (a, b) = (
                std::f64::consts::TAU * f64::from(i) / f64::from(nu),
                std::f64::consts::TAU * f64::from(j) / f64::from(nv),
            );
            let out = DVec3::new(a.cos(), a.sin(), 0.0);
            let n = out * b.cos() + DVec3::Z * b.sin();
            mesh.positions.push(out * 2.0 + 0.8 * n);
            mesh.normals.push(n);
            let v = |i: u32, j: u32| i % nu * nv + j % nv;
            let quad = [v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1)];
            if triangles > 0 && (i * nv + j).is_multiple_of(triangles) {
                mesh.faces.push(Face::Triangle([quad[0], quad[1], quad[2]]));
                mesh.faces.push(Face::Triangle([quad[0], quad[2], quad[3]]));
            } else {
                mesh.faces.push(Face::Quad(quad));
            }
        }
    }
    mesh
}
