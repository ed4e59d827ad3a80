//! Vertex implicits: the polynomials whose zero sets the surface osculates at the vertices.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::{
    BubbleError,
    monomial::{self, MAX_DEGREE},
    poly_mesh::PolyMesh,
};

/// A polynomial `f(z) = n·z + Σ c_α z^α`, `2 ≤ |α| ≤ m`, in `z = x − v`: the surface near vertex `v` is its zero set, to order `2n`.
///
/// Terms of degree above `2n` have no effect on the surface of order `n`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Implicit {
    degree: usize,
    /// By the numbers of the monomials; the constant is zero.
    coefficients: Vec<f64>,
}

impl Implicit {
    /// The plane across `n`.
    pub fn plane(n: DVec3) -> Self {
        Self { degree: 1, coefficients: vec![0.0, n.x, n.y, n.z] }
    }

    /// `n·z + ½ zᵀ H z`; of `hessian` the symmetric part counts.
    pub fn quadric(n: DVec3, hessian: DMat3) -> Self {
        let h = |i: usize, j: usize| 0.5 * (hessian.col(j)[i] + hessian.col(i)[j]);
        let mut coefficients = vec![0.0, n.x, n.y, n.z];
        coefficients.extend([0.5 * h(0, 0), h(0, 1), h(0, 2), 0.5 * h(1, 1), h(1, 2), 0.5 * h(2, 2)]);
        Self { degree: 2, coefficients }
    }

    /// A polynomial of degree 1 to 8 from its coefficients, a constant that is taken for zero first: by degree, then by
    /// falling exponent of x, then of y (`1, x, y, z, x², xy, xz, y², yz, z², x³, …`).
    ///
    /// # Errors
    /// [`BubbleError::Implicit`] (with vertex 0) when the number of coefficients is not that of the degree, or one is not finite,
    /// or the gradient is zero.
    pub fn new(degree: usize, mut coefficients: Vec<f64>) -> Result<Self, BubbleError> {
        let bad = |reason| BubbleError::Implicit { vertex: 0, reason };
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(bad("its degree is not 1 to 8"));
        }
        if coefficients.len() != monomial::count(degree) {
            return Err(bad("it has the wrong number of coefficients"));
        }
        if !coefficients.iter().all(|c| c.is_finite()) {
            return Err(bad("a coefficient is not finite"));
        }
        coefficients[0] = 0.0;
        let implicit = Self { degree, coefficients };
        if implicit.gradient() == DVec3::ZERO {
            return Err(bad("its gradient at the vertex is zero"));
        }
        Ok(implicit)
    }

    /// Without the checks, from numbers made here.
    pub(crate) fn from_parts(degree: usize, coefficients: Vec<f64>) -> Self {
        Self { degree, coefficients }
    }

    /// Whether it has the size of its degree, finite coefficients and a gradient.
    pub(crate) fn valid(&self) -> bool {
        (1..=MAX_DEGREE).contains(&self.degree)
            && self.coefficients.len() == monomial::count(self.degree)
            && self.coefficients.iter().all(|c| c.is_finite())
            && self.gradient() != DVec3::ZERO
    }

    /// The degree `m`.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The coefficients, in the order of [`new`](Self::new).
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The gradient at the vertex.
    pub fn gradient(&self) -> DVec3 {
        DVec3::new(self.coefficients[1], self.coefficients[2], self.coefficients[3])
    }

    /// The Hessian at the vertex.
    pub fn hessian(&self) -> DMat3 {
        let Some([xx, xy, xz, yy, yz, zz]) =
            self.coefficients.get(4..10).and_then(|c| <[f64; 6]>::try_from(c).ok())
        else {
            return DMat3::ZERO;
        };
        DMat3::from_cols(
            DVec3::new(2.0 * xx, xy, xz),
            DVec3::new(xy, 2.0 * yy, yz),
            DVec3::new(xz, yz, 2.0 * zz),
        )
    }

    /// The value at `z`, the offset from the vertex.
    pub fn value(&self, z: DVec3) -> f64 {
        let z = z.to_array();
        let mut powers = [1.0; monomial::TOTAL];
        let mut sum = 0.0;
        for (i, &c) in self.coefficients.iter().enumerate().skip(1) {
            let m = monomial::TABLE[i];
            powers[i] = powers[m.parent as usize] * z[m.variable as usize];
            sum += c * powers[i];
        }
        sum
    }
}

/// Where the vertex implicits come from.
pub trait VertexImplicits: Sync {
    /// One implicit per vertex of `mesh`. Gradients give the tangent planes; they are best parallel to the normals of the mesh, and
    /// of unit length: N of a patch interpolates the gradients.
    ///
    /// # Errors
    /// [`BubbleError`].
    fn implicits(&self, mesh: &PolyMesh) -> Result<Vec<Implicit>, BubbleError>;
}

/// Implicits that are already there, one per vertex.
impl VertexImplicits for Vec<Implicit> {
    fn implicits(&self, _: &PolyMesh) -> Result<Vec<Implicit>, BubbleError> {
        Ok(self.clone())
    }
}

/// The Taylor expansion of one known implicit surface at every vertex: `taylor(v)` returns the coefficients of `f(v + z)`.
#[derive(Clone, Copy, Debug)]
pub struct TaylorOf<F> {
    /// Degree of the expansion, 1 to 8; `2n` for full accuracy at order `n`.
    pub degree: usize,
    /// The coefficients of `f(v + z)` in `z`, in the order of [`Implicit::new`].
    pub taylor: F,
}

impl<F: Fn(DVec3) -> Vec<f64> + Sync> VertexImplicits for TaylorOf<F> {
    fn implicits(&self, mesh: &PolyMesh) -> Result<Vec<Implicit>, BubbleError> {
        let at = |(vertex, &v): (usize, &DVec3)| {
            Implicit::new(self.degree, (self.taylor)(v)).map_err(|e| match e {
                BubbleError::Implicit { reason, .. } => BubbleError::Implicit { vertex, reason },
                other => other,
            })
        };
        mesh.positions.iter().enumerate().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrics_have_their_hessian() {
        let h = DMat3::from_cols_array(&[1.0, 2.0, 3.0, 2.0, 4.0, 5.0, 3.0, 5.0, 6.0]);
        let f = Implicit::quadric(DVec3::Z, h);
        assert_eq!((f.hessian(), f.gradient()), (h, DVec3::Z));
        let z = DVec3::new(0.3, -0.7, 1.1);
        assert!((f.value(z) - (z.z + 0.5 * z.dot(h * z))).abs() < 1e-15);
    }

    #[test]
    fn bad_polynomials_are_refused() {
        assert!(Implicit::new(0, vec![0.0]).is_err());
        assert!(Implicit::new(1, vec![0.0; 4]).is_err());
        assert!(Implicit::new(1, vec![0.0, 1.0, f64::NAN, 0.0]).is_err());
        assert!(Implicit::new(2, vec![0.0, 1.0, 0.0, 0.0]).is_err());
        assert!(Implicit::new(1, vec![5.0, 1.0, 0.0, 0.0]).is_ok_and(|f| f.coefficients()[0] == 0.0));
    }
}
