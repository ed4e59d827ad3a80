//! Bézier triangles.

use crate::curve::check_finite;
use crate::{Jet2, MAX_DEGREE, NetError, Vector};
use glam::DVec2;

/// A Bézier triangle `Σ B_ijk^n(ρ, σ, τ) b_ijk`, `B_ijk^n = n!/(i! j! k!) ρⁱ σʲ τᵏ`, over barycentric coordinates.
///
/// The net is stored by rows of constant `k`, `j` rising within a row: `b_{n,0,0}, b_{n−1,1,0}, …, b_{0,n,0}, b_{n−1,0,1}, …, b_{0,0,n}`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BezierTriangle<T> {
    degree: usize,
    net: Vec<T>,
}

impl<T: Vector> BezierTriangle<T> {
    /// A triangle of `degree` `n` from its `(n + 1)(n + 2)/2` control points.
    ///
    /// # Errors
    /// [`NetError::Degree`], [`NetError::Count`], [`NetError::NotFinite`].
    pub fn new(degree: usize, net: Vec<T>) -> Result<Self, NetError> {
        if degree > MAX_DEGREE {
            return Err(NetError::Degree { degree });
        }
        let needed = (degree + 1) * (degree + 2) / 2;
        if net.len() != needed {
            return Err(NetError::Count { given: net.len(), needed });
        }
        check_finite(&net)?;
        Ok(Self { degree, net })
    }

    /// The polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The control points, in the order of the type's documentation.
    pub fn net(&self) -> &[T] {
        &self.net
    }

    /// Position of `b_ijk` in the net, `i = n − j − k`.
    pub fn index(degree: usize, j: usize, k: usize) -> usize {
        k * (degree + 1) - k * k.saturating_sub(1) / 2 + j
    }

    /// Value and partials to second order with respect to plane coordinates `(U, V)` in which the corners of the triangle
    /// (`i`, `j`, `k` = `n` in this order) lie at `corners`.
    pub fn jet(&self, corners: [DVec2; 3], at: DVec2) -> Jet2<T> {
        // Gradients of the barycentric coordinates in (U, V).
        let [r, s, t] = corners;
        let area = (s - r).perp_dot(t - r);
        let gradient = |a: DVec2, b: DVec2| DVec2::new(a.y - b.y, b.x - a.x) / area;
        let g = [gradient(s, t), gradient(t, r), gradient(r, s)];
        let w = [
            (s - at).perp_dot(t - at) / area,
            (t - at).perp_dot(r - at) / area,
            (r - at).perp_dot(s - at) / area,
        ];
        let n = self.degree;
        // The three corner values of the net at two, one and no steps before the end of de Casteljau's algorithm are the
        // second, first and zeroth polar forms.
        let mut work = [T::default(); (MAX_DEGREE + 1) * (MAX_DEGREE + 2) / 2];
        work[..self.net.len()].copy_from_slice(&self.net);
        let step = |work: &mut [T], m: usize| {
            for k in 0..m {
                for j in 0..m - k {
                    let (a, b) = (Self::index(m, j, k), Self::index(m, j + 1, k));
                    let c = Self::index(m, j, k + 1);
                    // Row-major writes of the smaller net never overtake the reads.
                    work[Self::index(m - 1, j, k)] = work[a] * w[0] + work[b] * w[1] + work[c] * w[2];
                }
            }
        };
        let mut jet = Jet2::default();
        for m in (3..=n).rev() {
            step(&mut work, m);
        }
        let along = |c: [T; 3], d: [f64; 3]| c[0] * d[0] + c[1] * d[1] + c[2] * d[2];
        let (gu, gv) = (g.map(|g| g.x), g.map(|g| g.y));
        if n >= 2 {
            let f = (n * (n - 1)) as f64;
            let row = |d: [f64; 3]| {
                // Net of degree 2: b200, b110, b020, b101, b011, b002.
                let q = &work[..6];
                [along([q[0], q[1], q[3]], d), along([q[1], q[2], q[4]], d), along([q[3], q[4], q[5]], d)]
            };
            let (ru, rv) = (row(gu), row(gv));
            jet.duu = along(ru, gu) * f;
            jet.duv = along(ru, gv) * f;
            jet.dvv = along(rv, gv) * f;
            step(&mut work, 2);
        }
        if n >= 1 {
            let c = [work[0], work[1], work[2]];
            jet.du = along(c, gu) * n as f64;
            jet.dv = along(c, gv) * n as f64;
            step(&mut work, 1);
        }
        jet.p = work[0];
        jet
    }
}
