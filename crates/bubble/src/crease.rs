//! Creases: tagged edges across which only positions agree.
//!
//! Every vertex is split into its *sectors*, the fans of faces between creases, each with a normal and an implicit of its own. Along a crease both
//! sides share one curve, whose ends follow the intersection of the two sectors' zero sets to order `2n`: there both patches have height zero
//! over a base bent to the curve ([`crate::bend`]), and the strips of all other edges are as ever.

use glam::DVec3;

use crate::{
    BubbleError, bend,
    implicit::Implicit,
    monomial::{self, TABLE},
    network::Edges,
    poly_mesh::{Face, PolyMesh},
};

/// Sectors are not told apart where their normals differ by less: 5°.
const MERGE: f64 = 0.087;

/// A mesh split along creases.
#[derive(Clone, Debug, Default)]
pub struct Creased {
    /// The mesh; sectors are vertices of their own. Its faces are numbered as before.
    pub mesh: PolyMesh,
    /// The vertex of the mesh before that each one was.
    pub source: Vec<u32>,
    /// Both sides of every crease, as vertices of [`mesh`](Self::mesh).
    pub(crate) creases: Vec<[[u32; 2]; 2]>,
    /// Tagged edges that are no creases: both ends have one sector only.
    pub smooth: usize,
}

impl Creased {
    /// Number of creases.
    pub fn count(&self) -> usize {
        self.creases.len()
    }
}

/// The edges across which the normals of the faces make an angle of more than `angle` (radians), lower vertex first.
///
/// # Errors
/// What is wrong with the mesh.
pub fn sharp_edges(mesh: &PolyMesh, angle: f64) -> Result<Vec<[u32; 2]>, BubbleError> {
    mesh.check()?;
    let normal = |f: u32| {
        let v = mesh.faces[f as usize].vertices();
        let p = |k: usize| mesh.positions[v[k] as usize];
        // Of a quad the mean of its corners'.
        if v.len() == 3 { (p(1) - p(0)).cross(p(2) - p(0)) } else { (p(2) - p(0)).cross(p(3) - p(1)) }
    };
    let sharp = Edges::of(mesh).edges.into_iter().filter(|e| match e.faces[..] {
        [a, b] => {
            let (a, mut b, same) = (normal(a.face), normal(b.face), a.forward == b.forward);
            if same {
                b = -b;
            }
            a.length() > 0.0 && b.length() > 0.0 && a.angle_between(b) > angle
        }
        _ => false,
    });
    Ok(sharp.map(|e| e.vertices).collect())
}

/// Splits `mesh` along the edges `tagged` (in any order and direction; edges with other than two faces are left alone). Sectors have the mean of their faces'
/// normals, weighted by angles; vertices of one sector keep their normal.
///
/// # Errors
/// What is wrong with the mesh; [`BubbleError::NoSuchEdge`].
pub fn split_creases(mesh: &PolyMesh, tagged: &[[u32; 2]]) -> Result<Creased, BubbleError> {
    mesh.check()?;
    let edges = Edges::of(mesh);
    let mut is_crease = vec![false; edges.edges.len()];
    let mut touched = vec![false; mesh.positions.len()];
    for &[a, b] in tagged {
        let key = [a.min(b), a.max(b)];
        let e = edges
            .edges
            .binary_search_by_key(&key, |e| e.vertices)
            .map_err(|_| BubbleError::NoSuchEdge { edge: key })?;
        if edges.edges[e].faces.len() == 2 {
            is_crease[e] = true;
            key.iter().for_each(|&v| touched[v as usize] = true);
        }
    }
    let mut sectors = Sectors::of(mesh, &edges, &is_crease, &touched);
    while sectors.merge(mesh, &edges, &is_crease) {}

    let mut out = Creased::default();
    let mut numbers = vec![[u32::MAX; 4]; mesh.faces.len()];
    for v in 0..mesh.positions.len() {
        let corners = &sectors.around[v];
        let mut here: Vec<(usize, u32)> = Vec::new();
        for &(f, k) in corners {
            let root = sectors.find(4 * f as usize + k as usize);
            let known = here.iter().find(|h| h.0 == root).map(|h| h.1);
            let number = known.unwrap_or_else(|| {
                let number = out.source.len() as u32;
                here.push((root, number));
                out.source.push(v as u32);
                out.mesh.positions.push(mesh.positions[v]);
                out.mesh.normals.push(mesh.normals[v]);
                number
            });
            numbers[f as usize][k as usize] = number;
        }
        if here.len() > 1 {
            for (root, number) in here {
                let n = sectors.normal(mesh, v, root);
                out.mesh.normals[number as usize] = n.unwrap_or(mesh.normals[v]);
            }
        }
        if corners.is_empty() {
            out.source.push(v as u32);
            out.mesh.positions.push(mesh.positions[v]);
            out.mesh.normals.push(mesh.normals[v]);
        }
    }
    out.mesh.faces = (mesh.faces.iter().zip(&numbers))
        .map(|(face, &n)| match face {
            Face::Triangle(_) => Face::Triangle([n[0], n[1], n[2]]),
            Face::Quad(_) => Face::Quad(n),
        })
        .collect();
    for (e, _) in edges.edges.iter().zip(&is_crease).filter(|e| *e.1) {
        let [a, b] = [e.faces[0], e.faces[1]].map(|u| {
            let n = &numbers[u.face as usize];
            let count = mesh.faces[u.face as usize].vertices().len();
            let (k, next) = (u.side as usize, (u.side as usize + 1) % count);
            if u.forward { [n[k], n[next]] } else { [n[next], n[k]] }
        });
        if a == b {
            out.smooth += 1;
        } else {
            out.creases.push([a, b]);
        }
    }
    Ok(out)
}

/// Corners of faces united to sectors.
struct Sectors {
    /// Corners `(face, k)` at every vertex.
    around: Vec<Vec<(u32, u8)>>,
    parents: Vec<u32>,
}

impl Sectors {
    fn of(mesh: &PolyMesh, edges: &Edges, is_crease: &[bool], touched: &[bool]) -> Self {
        let mut around = vec![Vec::new(); mesh.positions.len()];
        for (f, face) in (0u32..).zip(&mesh.faces) {
            for (k, &v) in (0u8..).zip(face.vertices()) {
                around[v as usize].push((f, k));
            }
        }
        let mut out = Self { around, parents: (0..4 * mesh.faces.len() as u32).collect() };
        for (e, crease) in edges.edges.iter().zip(is_crease) {
            for pair in e.faces.windows(2).filter(|_| !crease) {
                for end in 0..2 {
                    out.unite(corner(mesh, pair[0], end), corner(mesh, pair[1], end));
                }
            }
        }
        // Away from creases vertices stay whole, whatever their faces do.
        for v in (0..touched.len()).filter(|&v| !touched[v]) {
            for i in 1..out.around[v].len() {
                let [a, b] = [out.around[v][0], out.around[v][i]].map(|(f, k)| 4 * f as usize + k as usize);
                out.unite(a, b);
            }
        }
        out
    }

    fn find(&self, mut i: usize) -> usize {
        while self.parents[i] as usize != i {
            i = self.parents[i] as usize;
        }
        i
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }

    /// Mean of the normals of the sector's corners, weighted by their angles.
    fn normal(&self, mesh: &PolyMesh, v: usize, root: usize) -> Option<DVec3> {
        let mut sum = DVec3::ZERO;
        for &(f, k) in &self.around[v] {
            if self.find(4 * f as usize + k as usize) != root {
                continue;
            }
            let w = mesh.faces[f as usize].vertices();
            let k = k as usize;
            let p = |k: usize| mesh.positions[w[k % w.len()] as usize] - mesh.positions[v];
            let (a, b) = (p(k + 1), p(k + w.len() - 1));
            sum += a.cross(b).try_normalize().map_or(DVec3::ZERO, |n| n * a.angle_between(b));
        }
        sum.try_normalize()
    }

    /// Unites sectors on both sides of a crease whose normals hardly differ; whether there were any.
    fn merge(&mut self, mesh: &PolyMesh, edges: &Edges, is_crease: &[bool]) -> bool {
        let mut any = false;
        for (e, _) in edges.edges.iter().zip(is_crease).filter(|e| *e.1) {
            for end in 0..2 {
                let [a, b] = [0, 1].map(|side| self.find(corner(mesh, e.faces[side], end)));
                if a == b {
                    continue;
                }
                let v = e.vertices[end] as usize;
                let normals = [a, b].map(|root| self.normal(mesh, v, root));
                let [Some(m), Some(n)] = normals else { continue };
                if m.angle_between(n) < MERGE {
                    self.unite(a, b);
                    any = true;
                }
            }
        }
        any
    }
}

/// The corner of a face at the first or second vertex of an edge.
fn corner(mesh: &PolyMesh, u: crate::EdgeUse, end: usize) -> usize {
    let count = mesh.faces[u.face as usize].vertices().len();
    let k = if u.forward == (end == 0) { u.side as usize } else { (u.side as usize + 1) % count };
    4 * u.face as usize + k
}

/// The bend that takes the straight edge `e` to the crease: at both ends it follows the intersection of two implicits (or one, where both are the
/// same) to order `contact`.
pub(crate) fn curve(contact: usize, e: DVec3, implicits: [[&Implicit; 2]; 2]) -> Vec<DVec3> {
    let start = along_intersection(contact, e, implicits[0]);
    let end = along_intersection(contact, -e, implicits[1]);
    bend::hermite([&start, &end])
}

/// Solves `f(t e + D(t)) = 0` for both implicits order by order, `D` in the plane of their gradients.
fn along_intersection(contact: usize, e: DVec3, [f, g]: [&Implicit; 2]) -> Vec<DVec3> {
    const L: usize = 9;
    let same = std::ptr::eq(f, g);
    let (a, b) = (f.gradient(), g.gradient());
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let determinant = aa * bb - ab * ab;
    let used = monomial::count(f.degree().max(g.degree()).min(contact));
    let mut powers = vec![[0.0; L]; used.max(4)];
    powers[0][0] = 1.0;
    let mut d = vec![DVec3::ZERO; contact + 1];
    for k in 1..contact + 1 {
        let base = if k == 1 { e } else { DVec3::ZERO };
        let mut values = [a.dot(base), b.dot(base)];
        for i in 4..used {
            let m = TABLE[i];
            let [parent, variable] = [m.parent as usize, 1 + m.variable as usize];
            let sum: f64 = (1..k).map(|j| powers[parent][k - j] * powers[variable][j]).sum();
            powers[i][k] = sum;
            for (value, f) in values.iter_mut().zip([f, g]) {
                *value += f.coefficients().get(i).copied().unwrap_or_default() * sum;
            }
        }
        let [x, y] = values;
        d[k] = if same {
            a * (-x / aa)
        } else {
            a * ((ab * y - bb * x) / determinant) + b * ((ab * x - aa * y) / determinant)
        };
        let p = base + d[k];
        for axis in 0..3 {
            powers[1 + axis][k] = p[axis];
        }
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    #[test]
    fn the_curve_touches_both_zero_sets() {
        let f = Implicit::quadric(DVec3::Z, DMat3::IDENTITY);
        let g = Implicit::quadric(DVec3::Y, DMat3::from_diagonal(DVec3::new(0.5, 1.0, 2.0)));
        let e = DVec3::new(1.0, 0.2, -0.3);
        let d = along_intersection(4, e, [&f, &g]);
        let at = |t: f64| (1..5).fold(e * t, |p, k| p + d[k] * t.powi(k as i32));
        for f in [&f, &g] {
            let [coarse, fine] = [0.02, 0.01].map(|t| f.value(at(t)));
            assert!((coarse / fine).log2() > 4.8, "{coarse:e} {fine:e}");
        }
    }

    #[test]
    fn a_cube_falls_into_its_faces() {
        let mesh = suture_mesh::shapes::cuboid(DVec3::ONE, 1);
        let poly = PolyMesh::from_triangles(&mesh, &mesh.positions.clone()).unwrap();
        let sharp = sharp_edges(&poly, 0.5).unwrap();
        assert_eq!(sharp.len(), 12);
        let split = split_creases(&poly, &sharp).unwrap();
        assert_eq!((split.count(), split.mesh.positions.len(), split.smooth), (12, 24, 0));
        assert!(split.mesh.normals.iter().all(|n| n.abs().max_element() == 1.0));
        // One crease alone ends in both its vertices: nothing is split.
        let one = split_creases(&poly, &sharp[..1]).unwrap();
        assert_eq!((one.count(), one.smooth, one.mesh.positions.len()), (0, 1, 8));
        assert!(matches!(split_creases(&poly, &[[0, 99]]), Err(BubbleError::NoSuchEdge { edge: [0, 99] })));
    }
}
