//! Quintic splines through values, with first and second derivatives at some nodes.
//!
//! The nodes are of two sorts: at *breaks*, both ends among them, value and first two derivatives are given and the knot is triple; at
//! the others the value alone is given and the knot is simple, so that the spline is C⁴ there. Two surfaces that share a side and apply the
//! same operator along it to the same data share the curve and, up to the interpolation error, all cross derivatives.
//!
//! The control points are blossoms: the one with the arguments (t, t, t, t + α, t + β) is `f + (α + β)/5 f′ + αβ/20 f″`.
//!
//! # References
//! L. Ramshaw, *Blossoms are polar forms*, Computer Aided Geometric Design 6 (1989); C. de Boor, *A Practical Guide to Splines* (1978),
//! chapter XIII: the collocation matrix is totally positive, elimination needs no pivots.

use suture_bernstein::{Vector, bspline};

/// The degree.
pub(crate) const DEGREE: usize = 5;

/// The operator from data to control points over fixed nodes.
#[derive(Clone, Debug)]
pub(crate) struct Quintic {
    knots: Vec<f64>,
    /// Nodes of every piece between breaks.
    pieces: Vec<Piece>,
    data: usize,
}

/// The part between two breaks.
#[derive(Clone, Debug)]
struct Piece {
    /// Position of its first node's value in the data.
    first: usize,
    nodes: Vec<f64>,
    /// Banded factors: row i holds columns i − 2 … i + 2 of the eliminated matrix of the inner nodes.
    rows: Vec<[f64; 5]>,
}

impl Quintic {
    /// Over strictly rising nodes per piece: piece k runs from the last node of piece k − 1, to the bit. At least one piece of two nodes.
    pub(crate) fn new(pieces: Vec<Vec<f64>>) -> Self {
        let mut knots = Vec::new();
        let mut data = 0;
        let mut built: Vec<Piece> = Vec::with_capacity(pieces.len());
        for (k, nodes) in pieces.into_iter().enumerate() {
            knots.extend(std::iter::repeat_n(nodes[0], if k == 0 { DEGREE + 1 } else { 3 }));
            knots.extend_from_slice(&nodes[1..nodes.len() - 1]);
            let rows = factorise(&nodes);
            built.push(Piece { first: data, rows, nodes });
            // Value and two derivatives of the break, values of the nodes after it.
            data += built[k].nodes.len() + 1;
        }
        let end = built.last().and_then(|p| p.nodes.last()).copied().unwrap_or_default();
        knots.extend(std::iter::repeat_n(end, DEGREE + 1));
        Self { knots, pieces: built, data: data + 3 }
    }

    /// The knot vector.
    pub(crate) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Number of data, and of control points.
    pub(crate) fn count(&self) -> usize {
        self.data
    }

    /// Where the data are taken, in their order: node and order of the derivative.
    pub(crate) fn sites(&self) -> Vec<(f64, usize)> {
        let mut sites = Vec::with_capacity(self.data);
        for piece in &self.pieces {
            sites.extend([(piece.nodes[0], 0), (piece.nodes[0], 1), (piece.nodes[0], 2)]);
            sites.extend(piece.nodes[1..piece.nodes.len() - 1].iter().map(|&t| (t, 0)));
        }
        if let Some(&end) = self.pieces.last().and_then(|p| p.nodes.last()) {
            sites.extend([(end, 0), (end, 1), (end, 2)]);
        }
        sites
    }

    /// The control points of the spline with these data.
    pub(crate) fn apply<T: Vector>(&self, data: &[T]) -> Vec<T> {
        let mut net: Vec<T> = Vec::with_capacity(self.data);
        let mut before: Option<f64> = None;
        for piece in &self.pieces {
            let n = piece.nodes.len() - 1;
            let part = piece.apply(&data[piece.first..piece.first + n + 5]);
            match before {
                None => net.extend(part),
                Some(left) => {
                    // The triple knot: what belongs to six-fold ends gives way to one blossom that sees both sides.
                    let [f, d, dd] = [0, 1, 2].map(|i| data[piece.first + i]);
                    net.truncate(net.len() - 2);
                    net.push(blossom(f, d, dd, -left, piece.nodes[1] - piece.nodes[0]));
                    net.extend_from_slice(&part[2..]);
                }
            }
            before = Some(piece.nodes[n] - piece.nodes[n - 1]);
        }
        net
    }
}

impl Piece {
    /// Distance from the first node to the third, or to the second where there is no third.
    fn second(&self) -> f64 {
        self.nodes[2.min(self.nodes.len() - 1)] - self.nodes[0]
    }

    /// Control points over six-fold ends.
    fn apply<T: Vector>(&self, data: &[T]) -> Vec<T> {
        let t = &self.nodes;
        let n = t.len() - 1;
        let [f, d, dd] = [data[0], data[1], data[2]];
        let mut net = vec![T::default(); n + 5];
        net[0] = f;
        net[1] = blossom(f, d, dd, 0.0, t[1] - t[0]);
        net[2] = blossom(f, d, dd, t[1] - t[0], self.second());
        let [f, d, dd] = [data[n + 2], data[n + 3], data[n + 4]];
        let (near, far) = (t[n - 1] - t[n], t[n.saturating_sub(2)] - t[n]);
        net[n + 4] = f;
        net[n + 3] = blossom(f, d, dd, 0.0, near);
        net[n + 2] = blossom(f, d, dd, near, if n > 1 { far } else { near });
        // Values at the inner nodes, less what the known control points contribute.
        let inner = n - 1;
        let mut right: Vec<T> = (0..inner).map(|i| data[3 + i]).collect();
        for i in 0..inner {
            for (k, &a) in collocation(t, i + 1).iter().enumerate() {
                let column = i + 1 + k;
                if !(3..n + 2).contains(&column) {
                    right[i] = right[i] + net[column] * -a;
                }
            }
        }
        for i in 0..inner {
            for back in (1..=2.min(i)).rev() {
                right[i] = right[i] + right[i - back] * -self.rows[i][2 - back];
            }
        }
        for i in (0..inner).rev() {
            for ahead in 1..=2.min(inner - 1 - i) {
                right[i] = right[i] + right[i + ahead] * -self.rows[i][2 + ahead];
            }
            right[i] = right[i] * (1.0 / self.rows[i][2]);
        }
        net[3..n + 2].copy_from_slice(&right);
        net
    }
}

/// The quintic blossom at (t, t, t, t + α, t + β).
fn blossom<T: Vector>(f: T, d: T, dd: T, alpha: f64, beta: f64) -> T {
    f + d * ((alpha + beta) / 5.0) + dd * (alpha * beta / 20.0)
}

/// Values at node `i` of the five functions `i … i + 4` that do not vanish there, over six-fold ends.
fn collocation(nodes: &[f64], i: usize) -> [f64; 5] {
    let n = nodes.len() - 1;
    let knot = |k: isize| nodes[k.clamp(0, n as isize) as usize];
    // The ten knots that the span right of node i sees.
    let local: Vec<f64> = (0..12).map(|k| knot(i as isize + k - 5)).collect();
    let mut out = [[0.0; 1]; DEGREE + 1];
    bspline::jets(DEGREE, &local, DEGREE, nodes[i], &mut out);
    [out[0][0], out[1][0], out[2][0], out[3][0], out[4][0]]
}

/// LU factors of the collocation matrix of the inner nodes, in place in its band.
fn factorise(nodes: &[f64]) -> Vec<[f64; 5]> {
    let inner = nodes.len().saturating_sub(2);
    // Node i + 1 meets the functions i + 1 … i + 5; the unknown ones are 3 …, so unknown c stands in column c − 3 = i + (k − 2).
    let mut rows: Vec<[f64; 5]> = (0..inner).map(|i| collocation(nodes, i + 1)).collect();
    for i in 0..inner {
        for below in 1..=2.min(inner - 1 - i) {
            let factor = rows[i + below][2 - below] / rows[i][2];
            rows[i + below][2 - below] = factor;
            for ahead in 1..=2 {
                rows[i + below][2 - below + ahead] -= factor * rows[i][2 + ahead];
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use suture_bernstein::BSplineCurve;

    use super::*;

    fn jet(t: f64) -> [f64; 3] {
        // A quintic: reproduced exactly.
        let c = [0.3, -1.0, 2.0, 0.5, -0.7, 0.4];
        let d = |k: usize| -> f64 {
            (k..6)
                .map(|i| c[i] * ((i - k + 1)..=i).map(|x| x as f64).product::<f64>() * t.powi((i - k) as i32))
                .sum()
        };
        [d(0), d(1), d(2)]
    }

    fn spline(pieces: Vec<Vec<f64>>, f: impl Fn(f64) -> [f64; 3]) -> BSplineCurve<f64> {
        let operator = Quintic::new(pieces);
        let data: Vec<f64> = operator.sites().into_iter().map(|(t, k)| f(t)[k]).collect();
        assert_eq!(data.len(), operator.count());
        BSplineCurve::new(DEGREE, operator.knots().to_vec(), operator.apply(&data)).unwrap()
    }

    #[test]
    fn quintics_are_reproduced() {
        for pieces in [
            vec![vec![0.0, 1.0]],
            vec![vec![0.0, 0.3, 1.0]],
            vec![vec![0.0, 0.2, 0.5, 0.6, 0.9, 1.0, 1.7]],
            vec![vec![0.0, 0.5], vec![0.5, 0.6, 1.0], vec![1.0, 1.25, 1.5, 1.75, 2.0]],
            vec![vec![0.0, 0.1, 0.2, 0.3, 0.5], vec![0.5, 1.0], vec![1.0, 2.0]],
        ] {
            let end = *pieces.last().unwrap().last().unwrap();
            let curve = spline(pieces.clone(), jet);
            for i in 0..=100 {
                let t = end * f64::from(i) / 100.0;
                let found: [f64; 3] = curve.jet(t);
                for k in 0..3 {
                    assert!(
                        (found[k] - jet(t)[k]).abs() < 1e-11,
                        "{pieces:?} {t} {k}: {} {}",
                        found[k],
                        jet(t)[k]
                    );
                }
            }
        }
    }

    #[test]
    fn the_error_falls_with_the_sixth_power() {
        let f = |t: f64| [(3.0 * t).sin(), 3.0 * (3.0 * t).cos(), -9.0 * (3.0 * t).sin()];
        let error = |n: usize| {
            let nodes = |a: f64| (0..=n).map(|i| a + i as f64 / n as f64).collect();
            let curve = spline(vec![nodes(0.0), nodes(1.0)], f);
            (0..=400)
                .map(|i| f64::from(i) / 200.0)
                .map(|t| (curve.point(t) - f(t)[0]).abs())
                .fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(8), error(16));
        assert!(coarse < 3e-7, "{coarse:e}");
        assert!((coarse / fine).log2() > 5.3, "{coarse:e} {fine:e}");
    }
}
