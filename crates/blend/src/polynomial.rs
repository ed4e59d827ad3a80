//! Polynomial maps of the plane.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use suture_bernstein::Jet2;

/// A polynomial map of total degree `n` from the plane of an N-gon into the parameter plane of a chart, in monomials
/// `1, U, V, U², UV, V², U³, …` about the centre of the N-gon.
///
/// Monomials are well conditioned here: the N-gon has edge length 1 and its centre is the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanePolynomial {
    degree: usize,
    coefficients: Vec<DVec2>,
}

impl PlanePolynomial {
    /// Largest total degree: that of the maps with correspondence of highest order.
    pub const MAX_DEGREE: usize = 4;

    /// A polynomial from its `(n + 1)(n + 2)/2` coefficients; `None` when the count or the degree does not fit.
    pub fn new(degree: usize, coefficients: Vec<DVec2>) -> Option<Self> {
        let fits = degree <= Self::MAX_DEGREE
            && coefficients.len() == (degree + 1) * (degree + 2) / 2
            && coefficients.iter().all(|c| c.is_finite());
        fits.then_some(Self { degree, coefficients })
    }

    /// The affine map `P ↦ origin + P.x · x + P.y · y`.
    pub fn affine(origin: DVec2, x: DVec2, y: DVec2) -> Self {
        Self { degree: 1, coefficients: vec![origin, x, y] }
    }

    /// Total degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Coefficients in the order of the type's documentation.
    pub fn coefficients(&self) -> &[DVec2] {
        &self.coefficients
    }

    /// Value and partials to second order at `at`.
    pub fn jet(&self, at: DVec2) -> Jet2<DVec2> {
        let powers = |x: f64| {
            let mut p = [[0.0; 3]; Self::MAX_DEGREE + 1];
            let mut value = 1.0;
            for k in 0..=self.degree {
                p[k][0] = value;
                p[k][1] = if k > 0 { k as f64 * p[k - 1][0] } else { 0.0 };
                p[k][2] = if k > 0 { k as f64 * p[k - 1][1] } else { 0.0 };
                value *= x;
            }
            p
        };
        let (u, v) = (powers(at.x), powers(at.y));
        let mut jet = Jet2::default();
        let mut next = self.coefficients.iter();
        for total in 0..=self.degree {
            for j in 0..=total {
                let (a, b) = (&u[total - j], &v[j]);
                if let Some(&c) = next.next() {
                    jet = jet.add(Jet2 {
                        p: c * (a[0] * b[0]),
                        du: c * (a[1] * b[0]),
                        dv: c * (a[0] * b[1]),
                        duu: c * (a[2] * b[0]),
                        duv: c * (a[1] * b[1]),
                        dvv: c * (a[0] * b[2]),
                    });
                }
            }
        }
        jet
    }
}
