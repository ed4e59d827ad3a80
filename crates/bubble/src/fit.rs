//! Vertex implicits fitted to the positions and normals around each vertex.
//!
//! All fits are least squares in `ζ = (x − v)/ℓ`, `ℓ` the mean length of the edges at the vertex: the residuals are `f(ζ_w)` and
//! `∇f(ζ_w) − n_w` at the neighbours `w`, without units, so that the surface of a scaled mesh is the scaled surface.

use glam::{DMat3, DVec3};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

use crate::{
    BubbleError,
    implicit::{Implicit, VertexImplicits},
    monomial::{self, TABLE},
    network::{Edges, Rings},
    poly_mesh::PolyMesh,
};

/// How vertex implicits are fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Fit {
    /// Planes: no neighbour is asked. The surface has flat points at the vertices.
    Plane,
    /// A quadric with `H = Σ x_ij t_i t_jᵀ + ½ (x₁₁ + x₂₂) n̂ n̂ᵀ` in the tangents `t_i`: three unknowns, determined by any two
    /// neighbours in different directions. Exact on spheres and planes. The default for every order: of the real meshes measured, it alone
    /// leaves all strips of order 2 sound.
    #[default]
    Tangential,
    /// A full quadric, six unknowns, its parts along the normal drawn with weight `lambda` to where the tangential fit
    /// has them. Rings that span no more than a plane fall back to the tangential fit.
    Quadric {
        /// Weight of the two rows, 1e-4 to 1e-2; 0 for none.
        lambda: f64,
    },
    /// For smooth, dense meshes and orders from 2 on, where it gains three orders of accuracy; noise makes it bend sharply. A quartic over
    /// the neighbours and theirs, weights `|ζ|⁻⁴`, ridges 1e-6 and 1e-4 on the terms of degree 3 and 4 (in the
    /// rotation-invariant norm). Falls back to the tangential fit at boundaries and where there are fewer than ten of them.
    Quartic,
}

/// Ridge of the tangential fit: what two collinear neighbours do not determine becomes zero.
const TANGENTIAL_RIDGE: f64 = 1e-9;
/// Ridges of the quartic fit on degrees 2, 3, 4.
const QUARTIC_RIDGE: [f64; 3] = [0.0, 1e-6, 1e-4];
/// Smallest two-ring of a quartic fit.
const QUARTIC_RING: usize = 10;

/// The implicits that a fit gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// The kind of fit.
    pub fit: Fit,
}

impl VertexImplicits for Fitted {
    fn implicits(&self, mesh: &PolyMesh) -> Result<Vec<Implicit>, BubbleError> {
        mesh.check()?;
        if let Fit::Quadric { lambda } = self.fit
            && !(lambda >= 0.0 && lambda.is_finite())
        {
            let range = "finite and not negative";
            return Err(BubbleError::Option { name: "lambda", value: lambda, range });
        }
        let rings = Edges::of(mesh).rings(mesh.positions.len());
        let fit = self.fit;
        let fitted = (0..mesh.positions.len())
            .into_par_iter()
            .map_init(Vec::new, |two, v| one(mesh, &rings, fit, v, two));
        Ok(fitted.collect())
    }
}

fn one(mesh: &PolyMesh, rings: &Rings, fit: Fit, v: usize, two: &mut Vec<u32>) -> Implicit {
    let (position, normal) = (mesh.positions[v], mesh.normals[v]);
    let ring = rings.one(v);
    let length =
        ring.iter().map(|&w| mesh.positions[w as usize].distance(position)).sum::<f64>() / ring.len() as f64;
    // NaN for an isolated vertex.
    if !(length > 0.0 && length.is_finite()) {
        return Implicit::plane(normal);
    }
    let neighbour = |&w: &u32| Neighbour {
        zeta: (mesh.positions[w as usize] - position) / length,
        change: mesh.normals[w as usize] - normal,
    };
    let quadric = |h: DMat3| Implicit::quadric(normal, h * (1.0 / length));
    let tangential = || quadric(tangential(normal, ring.iter().map(neighbour)));
    match fit {
        Fit::Plane => Implicit::plane(normal),
        Fit::Quadric { lambda } => {
            full_quadric(normal, lambda, ring.iter().map(neighbour)).map_or_else(tangential, quadric)
        }
        Fit::Quartic if !rings.boundary[v] => {
            rings.two(v, two);
            if two.len() < QUARTIC_RING {
                return tangential();
            }
            let x = quartic(normal, two.iter().map(neighbour));
            x.map_or_else(tangential, |x| {
                let mut c = vec![0.0, normal.x, normal.y, normal.z];
                c.extend((4..monomial::count(4)).map(|i| x[i - 4] / length.powi(degree(i) as i32 - 1)));
                if c.iter().all(|c| c.is_finite()) { Implicit::from_parts(4, c) } else { tangential() }
            })
        }
        _ => tangential(),
    }
}

/// A neighbour in the scale of the ring, and how its normal differs.
struct Neighbour {
    zeta: DVec3,
    change: DVec3,
}

fn degree(i: usize) -> usize {
    TABLE[i].exponents.iter().map(|&e| e as usize).sum()
}

fn tangential(normal: DVec3, ring: impl Iterator<Item = Neighbour>) -> DMat3 {
    let unit = normal.normalize();
    let (t1, t2) = unit.any_orthonormal_pair();
    let mut system = Normal::<3>::default();
    for Neighbour { zeta, change } in ring {
        let (a, b, c) = (t1.dot(zeta), t2.dot(zeta), unit.dot(zeta));
        let bent = 0.5 * c * c;
        system.row([0.5 * (a * a + bent), a * b, 0.5 * (b * b + bent)], -normal.dot(zeta), 1.0);
        let columns = [t1 * a + unit * (0.5 * c), t1 * b + t2 * a, t2 * b + unit * (0.5 * c)];
        for axis in 0..3 {
            system.row(columns.map(|x| x[axis]), change[axis], 1.0);
        }
    }
    // The off-diagonal entry stands for two of the tensor.
    for (i, weight) in [1.0, 2.0, 1.0].into_iter().enumerate() {
        system.matrix[(i, i)] += weight * TANGENTIAL_RIDGE;
    }
    let x = system.solve().filter(|x| x.iter().all(|x| x.is_finite())).unwrap_or_default();
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    outer(t1, t1) * x[0]
        + (outer(t1, t2) + outer(t2, t1)) * x[1]
        + outer(t2, t2) * x[2]
        + outer(unit, unit) * (0.5 * (x[0] + x[2]))
}

fn full_quadric(normal: DVec3, lambda: f64, ring: impl Iterator<Item = Neighbour>) -> Option<DMat3> {
    let mut system = Normal::<6>::default();
    for neighbour in ring {
        polynomial_rows(&mut system, normal, &neighbour, 1.0);
    }
    let unit = normal.normalize();
    let (t1, t2) = unit.any_orthonormal_pair();
    // aᵀ H b as a row in the coefficients of x², xy, xz, y², yz, z².
    let form = |a: DVec3, b: DVec3| {
        [
            2.0 * a.x * b.x,
            a.x * b.y + a.y * b.x,
            a.x * b.z + a.z * b.x,
            2.0 * a.y * b.y,
            a.y * b.z + a.z * b.y,
            2.0 * a.z * b.z,
        ]
    };
    let (n, x, y) = (form(unit, unit), form(t1, t1), form(t2, t2));
    system.row(std::array::from_fn(|i| n[i] - 0.5 * (x[i] + y[i])), 0.0, lambda);
    system.row(form(unit, t1), 0.0, 2.0 * lambda);
    system.row(form(unit, t2), 0.0, 2.0 * lambda);
    // Rank 5 where the neighbours span a plane: the smallest pivot of the factor tells.
    let factor = system.matrix.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    if !(pivots.min() > 1e-6 * pivots.max()) {
        return None;
    }
    let x = factor.solve(&system.right);
    let h = Implicit::from_parts(2, [&[0.0; 4], x.as_slice()].concat()).hessian();
    h.is_finite().then_some(h)
}

fn quartic(normal: DVec3, ring: impl Iterator<Item = Neighbour>) -> Option<SVector<f64, 31>> {
    let mut system = Normal::<31>::default();
    for neighbour in ring {
        let weight = neighbour.zeta.length_squared().powi(-2);
        if !weight.is_finite() {
            return None;
        }
        polynomial_rows(&mut system, normal, &neighbour, weight);
    }
    for i in 4..monomial::count(4) {
        let e = TABLE[i].exponents.map(|e| crate::hermite::factorial(e as usize));
        let bombieri = e[0] * e[1] * e[2] / crate::hermite::factorial(degree(i));
        system.matrix[(i - 4, i - 4)] += QUARTIC_RIDGE[degree(i) - 2] * bombieri;
    }
    system.solve()
}

/// Adds the four rows of a neighbour for the coefficients from degree 2 on.
fn polynomial_rows<const U: usize>(
    system: &mut Normal<U>,
    normal: DVec3,
    neighbour: &Neighbour,
    weight: f64,
) {
    let zeta = neighbour.zeta.to_array();
    let mut powers = [1.0; monomial::count(4)];
    for i in 1..4 + U {
        let m = TABLE[i];
        powers[i] = powers[m.parent as usize] * zeta[m.variable as usize];
    }
    let row = std::array::from_fn(|i| powers[4 + i]);
    system.row(row, -normal.dot(neighbour.zeta), weight);
    for axis in 0..3 {
        let row = std::array::from_fn(|i| {
            let mut e = TABLE[4 + i].exponents.map(usize::from);
            let factor = e[axis] as f64;
            if e[axis] == 0 {
                return 0.0;
            }
            e[axis] -= 1;
            factor * powers[monomial::index(e[0], e[1], e[2])]
        });
        system.row(row, neighbour.change[axis], weight);
    }
}

/// Normal equations of a least squares problem, lower triangle.
struct Normal<const U: usize> {
    matrix: SMatrix<f64, U, U>,
    right: SVector<f64, U>,
}

impl<const U: usize> Default for Normal<U> {
    fn default() -> Self {
        Self { matrix: SMatrix::zeros(), right: SVector::zeros() }
    }
}

impl<const U: usize> Normal<U> {
    #[inline]
    fn row(&mut self, row: [f64; U], right: f64, weight: f64) {
        for j in 0..U {
            let x = weight * row[j];
            if x == 0.0 {
                continue;
            }
            let column = &mut self.matrix.column_mut(j);
            for i in j..U {
                column[i] += x * row[i];
            }
            self.right[j] += x * right;
        }
    }

    fn solve(self) -> Option<SVector<f64, U>> {
        let x = self.matrix.cholesky()?.solve(&self.right);
        x.iter().all(|x| x.is_finite()).then_some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::poly_mesh::Face;

    fn fan(positions: Vec<DVec3>, normals: Vec<DVec3>) -> PolyMesh {
        let n = positions.len() as u32;
        let faces = (1..n).map(|k| Face::Triangle([0, k, if k + 1 < n { k + 1 } else { 1 }])).collect();
        PolyMesh { positions, normals, faces }
    }

    #[test]
    fn spheres_are_reproduced_by_every_fit() {
        let mesh = suture_mesh::shapes::sphere(1);
        let poly = PolyMesh::from_triangles(&mesh, &mesh.positions.clone()).unwrap();
        for fit in
            [Fit::Tangential, Fit::Quadric { lambda: 0.0 }, Fit::Quadric { lambda: 1e-2 }, Fit::Quartic]
        {
            for f in (Fitted { fit }).implicits(&poly).unwrap() {
                let off = f.hessian() - DMat3::IDENTITY;
                let worst = off.to_cols_array().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                assert!(worst < 1e-8, "{fit:?}: {worst:e}");
                assert!(f.coefficients().iter().skip(10).all(|c| c.abs() < 1e-8), "{fit:?}");
            }
        }
    }

    #[test]
    fn planar_and_collinear_rings_stay_finite() {
        let flat = fan(
            vec![DVec3::ZERO, DVec3::X, DVec3::new(-1.0, 1.0, 0.0), DVec3::new(-1.0, -1.0, 0.0)],
            vec![DVec3::Z; 4],
        );
        for fit in [Fit::Tangential, Fit::Quadric { lambda: 0.0 }, Fit::Quartic, Fit::Plane] {
            for f in (Fitted { fit }).implicits(&flat).unwrap() {
                assert!(f.coefficients()[4..].iter().all(|c| c.abs() < 1e-12), "{fit:?}");
            }
        }
        let line = fan(
            vec![DVec3::ZERO, DVec3::X, -DVec3::X, 2.0 * DVec3::X],
            vec![DVec3::Z, DVec3::new(0.1, 0.0, 1.0), DVec3::new(-0.1, 0.0, 1.0), DVec3::new(0.2, 0.0, 1.0)],
        );
        let f = &(Fitted { fit: Fit::Tangential }).implicits(&line).unwrap()[0];
        // Positions want 0, normals 0.1; across the line nothing is known.
        assert!((0.01..0.1).contains(&f.hessian().x_axis.x) && f.hessian().y_axis.y.abs() < 1e-6, "{f:?}");
    }
}
