//! The projection Π: samples of parameters → the nearest maps of the admissible space, the same operator for every chart.

use glam::DVec2;
use nalgebra::{DMatrix, Matrix3, Matrix3xX, Vector3};

use super::gon_lattice;
use crate::maps::Node;
use crate::polynomial::PlanePolynomial;
use crate::{BlendError, gon};

/// Sample lines per strip, across its direction.
pub(super) const LINES: usize = 8;

/// Least squares by plane polynomials of degree `n` on a lattice of the N-gon.
pub(super) struct GonProjection {
    degree: usize,
    pub(super) samples: Vec<DVec2>,
    operator: DMatrix<f64>,
}

impl GonProjection {
    pub(super) fn new(valence: usize, degree: usize) -> Result<Self, BlendError> {
        let samples = gon_lattice(valence, (2 * degree + 2).max(6));
        let scale = gon::circumradius(valence).recip();
        let powers: Vec<(usize, usize)> =
            (0..=degree).flat_map(|total| (0..=total).map(move |j| (total - j, j))).collect();
        let matrix = DMatrix::from_fn(samples.len(), powers.len(), |row, column| {
            let (p, (a, b)) = (samples[row] * scale, powers[column]);
            p.x.powi(a as i32) * p.y.powi(b as i32)
        });
        let mut operator = pseudo_inverse(matrix)?;
        for (mut row, (a, b)) in operator.row_iter_mut().zip(powers) {
            row *= scale.powi((a + b) as i32);
        }
        Ok(Self { degree, samples, operator })
    }

    /// The polynomial nearest to `values`, one per sample.
    pub(super) fn fit(&self, values: &[DVec2]) -> Option<PlanePolynomial> {
        // About their mean: parameters far from the origin would cost digits.
        let mean = values.iter().sum::<DVec2>() / values.len() as f64;
        let mut coefficients: Vec<DVec2> = self
            .operator
            .row_iter()
            .map(|row| row.iter().zip(values).map(|(&w, &v)| w * (v - mean)).sum())
            .collect();
        coefficients[0] += mean;
        PlanePolynomial::new(self.degree, coefficients)
    }
}

/// Least squares in `V` by Bernstein polynomials of degree `q` at given nodes.
pub(super) struct Across {
    pub(super) nodes: Vec<f64>,
    operator: DMatrix<f64>,
}

impl Across {
    /// At q + 4 Chebyshev nodes.
    pub(super) fn chebyshev(q: usize) -> Result<Self, BlendError> {
        let count = q + 4;
        let angle = |j: usize| (2 * j + 1) as f64 * std::f64::consts::PI / (2 * count) as f64;
        Self::new(q, (0..count).map(|j| 0.5 - 0.5 * angle(j).cos()).collect())
    }

    /// Interpolation at q + 1 equidistant nodes: exact for what has degree q.
    pub(super) fn interpolation(q: usize) -> Result<Self, BlendError> {
        Self::new(q, (0..=q).map(|j| j as f64 / q.max(1) as f64).collect())
    }

    fn new(q: usize, nodes: Vec<f64>) -> Result<Self, BlendError> {
        let mut matrix = DMatrix::zeros(nodes.len(), q + 1);
        let mut values = vec![0.0; q + 1];
        for (row, &v) in nodes.iter().enumerate() {
            suture_bernstein::bernstein::values(q, v, &mut values);
            values.iter().enumerate().for_each(|(j, &b)| matrix[(row, j)] = b);
        }
        let operator = if matrix.is_square() {
            matrix.try_inverse().ok_or_else(singular)?
        } else {
            pseudo_inverse(matrix)?
        };
        Ok(Self { nodes, operator })
    }

    /// Bézier points of the polynomial nearest to `values`, one per node.
    pub(super) fn fit(&self, values: &[DVec2]) -> Vec<DVec2> {
        self.operator.row_iter().map(|row| row.iter().zip(values).map(|(&w, &v)| w * v).sum()).collect()
    }
}

fn pseudo_inverse(matrix: DMatrix<f64>) -> Result<DMatrix<f64>, BlendError> {
    matrix.pseudo_inverse(1e-12).map_err(|_| singular())
}

fn singular() -> BlendError {
    BlendError::Inconsistent { what: "a projection onto maps is singular".into() }
}

/// Quintic Hermite functions at `u ∈ [0, 1]`: value, first and second derivative at the start, then at the end.
pub(super) fn hermite(u: f64) -> [[f64; 3]; 2] {
    let (u2, u3, u4, u5) = (u * u, u.powi(3), u.powi(4), u.powi(5));
    let end = 10.0 * u3 - 15.0 * u4 + 6.0 * u5;
    [
        [1.0 - end, u - 6.0 * u3 + 8.0 * u4 - 3.0 * u5, 0.5 * (u2 - 3.0 * u3 + 3.0 * u4 - u5)],
        [end, -4.0 * u3 + 7.0 * u4 - 3.0 * u5, 0.5 * (u3 - 2.0 * u4 + u5)],
    ]
}

/// The sample lines of a strip in `U`.
pub(super) fn lines() -> impl Iterator<Item = f64> {
    (0..LINES).map(|i| (i as f64 + 0.5) / LINES as f64)
}

/// Nodes of a chain of strips with the knots `t` from samples: `samples[k][i]` holds the Bézier points across strip `k` on its line
/// `i`, in one chart. The first and last node are given. Quintic Hermite functions, values and two derivatives free at every inner
/// node: a block tridiagonal system, the same for every chart.
pub(super) fn chain(
    t: &[f64],
    ends: [Node; 2],
    samples: &[Vec<Vec<DVec2>>],
    width: f64,
) -> Result<Vec<Node>, BlendError> {
    let strips = t.len() - 1;
    let columns = ends[0].p.len();
    let free = strips - 1;
    let scales = |k: usize| {
        let h = (t[k + 1] - t[k]) / width;
        Vector3::new(1.0, h, h * h)
    };
    let mut diagonal = vec![Matrix3::<f64>::zeros(); free];
    let mut upper = vec![Matrix3::<f64>::zeros(); free.saturating_sub(1)];
    let mut right = vec![Matrix3xX::<f64>::zeros(2 * columns); free];
    // Derivatives in units of the width, so that the blocks are well conditioned.
    let given = ends.each_ref().map(|node| {
        Matrix3xX::from_fn(2 * columns, |row, column| {
            let power = width.powi(row as i32);
            [&node.p, &node.d, &node.dd][row][column / 2][column % 2] * power
        })
    });
    for (k, lines_of_strip) in samples.iter().enumerate() {
        let scale = scales(k);
        for (u, values) in lines().zip(lines_of_strip) {
            let [a, e] = hermite(u).map(|h| Vector3::from(h).component_mul(&scale));
            let mut data =
                nalgebra::RowDVector::from_fn(2 * columns, |_, column| values[column / 2][column % 2]);
            if k == 0 {
                data -= a.transpose() * &given[0];
            }
            if k + 1 == strips {
                data -= e.transpose() * &given[1];
            }
            if k > 0 {
                diagonal[k - 1] += a * a.transpose();
                right[k - 1] += a * &data;
            }
            if k + 1 < strips {
                diagonal[k] += e * e.transpose();
                right[k] += e * &data;
            }
            if k > 0 && k + 1 < strips {
                upper[k - 1] += a * e.transpose();
            }
        }
    }
    for k in 1..free {
        let inverse = diagonal[k - 1].try_inverse().ok_or_else(singular)?;
        let eliminate = upper[k - 1].transpose() * inverse;
        diagonal[k] -= eliminate * upper[k - 1];
        let earlier = eliminate * &right[k - 1];
        right[k] -= earlier;
    }
    for k in (0..free).rev() {
        if k + 1 < free {
            let later = upper[k] * &right[k + 1];
            right[k] -= later;
        }
        right[k] = diagonal[k].try_inverse().ok_or_else(singular)? * &right[k];
    }
    let [first, last] = ends;
    let mut nodes = vec![first];
    nodes.extend(right.iter().map(|solution| {
        let row = |r: usize| {
            let power = width.powi(-(r as i32));
            (0..columns).map(|j| DVec2::new(solution[(r, 2 * j)], solution[(r, 2 * j + 1)]) * power).collect()
        };
        Node { p: row(0), d: row(1), dd: row(2) }
    }));
    nodes.push(last);
    Ok(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_reproduced() {
        for n in 3..=8 {
            for degree in 1..=3 {
                let projection = GonProjection::new(n, degree).unwrap();
                let wanted = PlanePolynomial::new(
                    degree,
                    (0..(degree + 1) * (degree + 2) / 2)
                        .map(|k| DVec2::new((k as f64 * 1.3).sin(), (k as f64 * 0.7).cos()))
                        .collect(),
                )
                .unwrap();
                let values: Vec<DVec2> = projection.samples.iter().map(|&p| wanted.jet(p).p).collect();
                let got = projection.fit(&values).unwrap();
                for (a, b) in got.coefficients().iter().zip(wanted.coefficients()) {
                    assert!((*a - *b).length() < 1e-13, "N = {n}, degree {degree}");
                }
            }
        }
    }

    #[test]
    fn chains_reproduce_quintics_of_arc_length() {
        let t = [0.1, 0.3, 0.45, 0.7, 1.1];
        let f = |t: f64, v: f64| DVec2::new(t.powi(5) - t * v * v, 2.0 * t.powi(3) * v + 1.0);
        let across = Across::chebyshev(2).unwrap();
        let exact = Across::interpolation(2).unwrap();
        let node = |t: f64| Node {
            p: exact.fit(&exact.nodes.iter().map(|&v| f(t, v)).collect::<Vec<_>>()),
            d: exact.fit(
                &exact
                    .nodes
                    .iter()
                    .map(|&v| DVec2::new(5.0 * t.powi(4) - v * v, 6.0 * t * t * v))
                    .collect::<Vec<_>>(),
            ),
            dd: exact.fit(
                &exact.nodes.iter().map(|&v| DVec2::new(20.0 * t.powi(3), 12.0 * t * v)).collect::<Vec<_>>(),
            ),
        };
        let samples: Vec<Vec<Vec<DVec2>>> = t
            .windows(2)
            .map(|w| {
                lines()
                    .map(|u| {
                        let at = w[0] + u * (w[1] - w[0]);
                        across.fit(&across.nodes.iter().map(|&v| f(at, v)).collect::<Vec<_>>())
                    })
                    .collect()
            })
            .collect();
        let nodes = chain(&t, [node(t[0]), node(t[4])], &samples, 0.2).unwrap();
        for (node_at, &t) in nodes.iter().zip(&t) {
            let wanted = node(t);
            for (got, want) in [(&node_at.p, &wanted.p), (&node_at.d, &wanted.d), (&node_at.dd, &wanted.dd)] {
                for (a, b) in got.iter().zip(want) {
                    assert!((*a - *b).length() < 1e-9, "{a} {b}");
                }
            }
        }
    }
}
