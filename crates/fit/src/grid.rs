//! The uniform grid of a bicubic B-spline and evaluation over it.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_bernstein::{BSplineSurface, Jet2};

use crate::FitError;

/// `P × Q` cells over a parameter rectangle; knot `i` of direction `d` is `lower[d] + (i − 3) step[d]`.
///
/// Carries `(P + 3)(Q + 3)` coefficients, second index fastest; cell `(i, j)` uses the coefficients `i..=i + 3` × `j..=j + 3`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Lower corner of the rectangle.
    pub lower: DVec2,
    /// Size of one cell.
    pub step: DVec2,
    /// Number of cells in `u` and `v`.
    pub cells: [usize; 2],
}

impl Grid {
    /// A grid of `cells` over the rectangle from `lower` to `upper`.
    ///
    /// # Errors
    /// [`FitError::Value`] when a side is not positive and finite or a number of cells is zero.
    pub fn new(lower: DVec2, upper: DVec2, cells: [usize; 2]) -> Result<Self, FitError> {
        let size = upper - lower;
        let side = size.min_element();
        if !(side > 0.0 && size.is_finite() && lower.is_finite()) {
            return Err(FitError::Value {
                name: "rectangle side",
                value: side,
                expected: "positive, finite",
            });
        }
        if cells[0] == 0 || cells[1] == 0 {
            return Err(FitError::Value {
                name: "cells",
                value: 0.0,
                expected: "at least 1 in either direction",
            });
        }
        Ok(Self { lower, step: size / DVec2::new(cells[0] as f64, cells[1] as f64), cells })
    }

    /// Number of coefficients in `u` and `v`.
    pub fn count(&self) -> [usize; 2] {
        [self.cells[0] + 3, self.cells[1] + 3]
    }

    /// Number of coefficients.
    pub fn coefficients(&self) -> usize {
        self.count()[0] * self.count()[1]
    }

    /// Geometric mean of the two steps: the `h` of every formula.
    pub fn spacing(&self) -> f64 {
        self.step.x.sqrt() * self.step.y.sqrt()
    }

    /// Upper corner of the rectangle.
    pub fn upper(&self) -> DVec2 {
        self.lower + self.step * DVec2::new(self.cells[0] as f64, self.cells[1] as f64)
    }

    /// Cell of `at` and position in it; parameters outside the rectangle belong to the nearest cell of their row or column.
    pub fn locate(&self, at: DVec2) -> ([usize; 2], DVec2) {
        let s = (at - self.lower) / self.step;
        let cell = [0, 1].map(|d| (s[d].max(0.0) as usize).min(self.cells[d].saturating_sub(1)));
        (cell, s - DVec2::new(cell[0] as f64, cell[1] as f64))
    }

    /// Value and partials to second order of the surface with coefficients `net` (`coefficients()` of them).
    pub fn jet(&self, net: &[DVec3], at: DVec2) -> Jet2 {
        let ([i, j], t) = self.locate(at);
        let (u, v) = (basis(t.x), basis(t.y));
        let columns = self.count()[1];
        let mut jet = Jet2::default();
        for a in 0..4 {
            let row = &net[(i + a) * columns + j..][..4];
            let mut r = [DVec3::ZERO; 3];
            for (p, v) in row.iter().zip(&v) {
                for d in 0..3 {
                    r[d] += *p * v[d];
                }
            }
            jet.p += r[0] * u[a][0];
            jet.du += r[0] * u[a][1];
            jet.dv += r[1] * u[a][0];
            jet.duu += r[0] * u[a][2];
            jet.duv += r[1] * u[a][1];
            jet.dvv += r[2] * u[a][0];
        }
        let h = self.step;
        jet.du /= h.x;
        jet.dv /= h.y;
        jet.duu /= h.x * h.x;
        jet.duv /= h.x * h.y;
        jet.dvv /= h.y * h.y;
        jet
    }

    /// The surface with coefficients `net`.
    ///
    /// # Errors
    /// [`FitError::Net`].
    pub fn surface(&self, net: Vec<DVec3>) -> Result<BSplineSurface<DVec3>, FitError> {
        let knots = [0, 1].map(|d| {
            (0..self.cells[d] + 7).map(|i| self.lower[d] + (i as f64 - 3.0) * self.step[d]).collect()
        });
        Ok(BSplineSurface::new([3, 3], knots, net)?)
    }
}

/// The four uniform cubic B-splines of a cell at `t ∈ [0, 1]`, as coefficients of `1, t, t², t³`.
pub(crate) const CUBIC: [[f64; 4]; 4] = [
    [1.0 / 6.0, -0.5, 0.5, -1.0 / 6.0],
    [2.0 / 3.0, 0.0, -1.0, 0.5],
    [1.0 / 6.0, 0.5, 0.5, -0.5],
    [0.0, 0.0, 0.0, 1.0 / 6.0],
];

/// Value, first and second derivative (per cell) of the four functions at `t`.
pub(crate) fn basis(t: f64) -> [[f64; 3]; 4] {
    let s = 1.0 - t;
    // Factored at both ends rather than expanded: b0 and b3 keep full relative accuracy where they vanish.
    [
        [s * s * s / 6.0, -0.5 * s * s, s],
        [(4.0 + t * t * (3.0 * t - 6.0)) / 6.0, t * (1.5 * t - 2.0), 3.0 * t - 2.0],
        [(4.0 + s * s * (3.0 * s - 6.0)) / 6.0, -s * (1.5 * s - 2.0), 3.0 * s - 2.0],
        [t * t * t / 6.0, 0.5 * t * t, t],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_local_evaluation_is_that_of_the_surface() {
        let grid = Grid::new(DVec2::new(-1.0, 2.0), DVec2::new(3.0, 5.0), [5, 4]).unwrap();
        let net: Vec<DVec3> = (0..grid.coefficients())
            .map(|i| DVec3::new((i as f64).sin(), (1.3 * i as f64).cos(), (0.7 * i as f64).sin()))
            .collect();
        let surface = grid.surface(net.clone()).unwrap();
        for at in [DVec2::new(-1.0, 2.0), DVec2::new(0.3, 3.9), DVec2::new(3.0, 5.0), DVec2::new(2.2, 2.75)] {
            let (a, b) = (grid.jet(&net, at), surface.jet(at));
            for (a, b) in
                [(a.p, b.p), (a.du, b.du), (a.dv, b.dv), (a.duu, b.duu), (a.duv, b.duv), (a.dvv, b.dvv)]
            {
                assert!(a.distance(b) < 1e-12, "{a} {b}");
            }
        }
        assert!(surface.domain()[1].distance(grid.upper()) < 1e-14);
    }

    #[test]
    fn the_monomial_table_is_the_basis() {
        for t in [0.0, 0.2, 0.7, 1.0] {
            for (c, b) in CUBIC.iter().zip(basis(t)) {
                let value = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
                assert!((value - b[0]).abs() < 1e-15);
                assert!((c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]) - b[1]).abs() < 1e-15);
                assert!((2.0 * c[2] + 6.0 * t * c[3] - b[2]).abs() < 1e-15);
            }
        }
    }
}
