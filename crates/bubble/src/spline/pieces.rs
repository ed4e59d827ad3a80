//! Functions of one variable that are polynomial on uniform intervals of `[0, 1]`, by their Bernstein coefficients.

use suture_bernstein::bernstein::binomial;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pieces {
    degree: usize,
    /// `degree + 1` coefficients per interval.
    net: Vec<f64>,
}

impl Pieces {
    pub(crate) fn new(degree: usize, net: Vec<f64>) -> Self {
        Self { degree, net }
    }

    pub(crate) fn degree(&self) -> usize {
        self.degree
    }

    fn intervals(&self) -> usize {
        self.net.len() / (self.degree + 1)
    }

    /// The linear function from `a` at 0 to `b` at 1.
    pub(crate) fn linear(intervals: usize, a: f64, b: f64) -> Self {
        let at = |j: usize| {
            let t = j as f64 / intervals as f64;
            a * (1.0 - t) + b * t
        };
        Self { degree: 1, net: (0..intervals).flat_map(|j| [at(j), at(j + 1)]).collect() }
    }

    pub(crate) fn constant(intervals: usize, c: f64) -> Self {
        Self { degree: 0, net: vec![c; intervals] }
    }

    /// The polynomial with monomial coefficients `c`.
    pub(crate) fn polynomial(intervals: usize, c: &[f64]) -> Self {
        let t = Self::linear(intervals, 0.0, 1.0);
        let (last, lower) = c.split_last().unwrap_or((&0.0, &[]));
        let start = Self::constant(intervals, *last);
        lower.iter().rev().fold(start, |sum, &c| sum.mul(&t).add(&Self::constant(intervals, c)))
    }

    /// `self^n`.
    pub(crate) fn power(&self, n: usize) -> Self {
        (0..n).fold(Self::constant(self.intervals(), 1.0), |p, _| p.mul(self))
    }

    pub(crate) fn scale(&self, c: f64) -> Self {
        Self { degree: self.degree, net: self.net.iter().map(|x| x * c).collect() }
    }

    /// The function of `1 − t`.
    pub(crate) fn reverse(&self) -> Self {
        Self { degree: self.degree, net: self.net.iter().rev().copied().collect() }
    }

    pub(crate) fn mul(&self, other: &Self) -> Self {
        let (p, q) = (self.degree, other.degree);
        let mut net = vec![0.0; self.intervals() * (p + q + 1)];
        let blocks = self.net.chunks_exact(p + 1).zip(other.net.chunks_exact(q + 1));
        for (out, (a, b)) in net.chunks_exact_mut(p + q + 1).zip(blocks) {
            for (i, a) in a.iter().enumerate() {
                for (j, b) in b.iter().enumerate() {
                    out[i + j] += a * b * (binomial(p, i) * binomial(q, j) / binomial(p + q, i + j));
                }
            }
        }
        Self { degree: p + q, net }
    }

    pub(crate) fn elevate(&self, degree: usize) -> Self {
        let by = degree.saturating_sub(self.degree);
        if by == 0 {
            return self.clone();
        }
        let one = Self { degree: by, net: vec![1.0; self.intervals() * (by + 1)] };
        self.mul(&one)
    }

    pub(crate) fn add(&self, other: &Self) -> Self {
        let degree = self.degree.max(other.degree);
        let (a, b) = (self.elevate(degree), other.elevate(degree));
        Self { degree, net: a.net.iter().zip(&b.net).map(|(a, b)| a + b).collect() }
    }

    /// Knots of C² splines of this degree (of polynomial pieces where it is less than 3): inner ones `degree − 2` times.
    pub(crate) fn knots(degree: usize, intervals: usize) -> Vec<f64> {
        let inner = degree.saturating_sub(2).max(1);
        let mut out = vec![0.0; degree + 1];
        for j in 1..intervals {
            out.extend(std::iter::repeat_n(j as f64 / intervals as f64, inner));
        }
        out.extend(vec![1.0; degree + 1]);
        out
    }

    /// The coefficients over [`knots`](Self::knots), by blossoms: right for functions that are C².
    pub(crate) fn spline(&self) -> Vec<f64> {
        let d = self.degree;
        let k = self.intervals();
        let knots = Self::knots(d, k);
        let count = knots.len() - d - 1;
        let mut out = Vec::with_capacity(count);
        for i in 0..count {
            let arguments = &knots[i + 1..i + d + 1];
            // The piece that begins at the first argument: at most two lie beyond its end, where the next one agrees to second order.
            let j = ((arguments[0] * k as f64 + 0.5) as usize).min(k - 1);
            let mut c = self.net[j * (d + 1)..(j + 1) * (d + 1)].to_vec();
            for (step, x) in arguments.iter().enumerate() {
                let local = x * k as f64 - j as f64;
                for r in 0..d - step {
                    c[r] = c[r] * (1.0 - local) + c[r + 1] * local;
                }
            }
            out.push(c[0]);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::cubic::Cubic;
    use suture_bernstein::BSplineCurve;

    #[test]
    fn products_of_splines_are_splines() {
        let f = |t: f64| (2.0 * t).cos();
        let ends = [[1.0, 0.0, 0.0], [f(1.0), -2.0 * 2f64.sin(), 0.0]];
        let s = Cubic::new(5, ends, false, f);
        let p = s
            .pieces()
            .mul(&Pieces::linear(5, 1.0, -0.5).power(4))
            .add(&Pieces::polynomial(5, &[0.1, 0.0, 3.0]));
        assert_eq!(p.degree(), 7);
        let curve = BSplineCurve::new(7, Pieces::knots(7, 5), p.spline()).unwrap();
        for t in [0.0, 0.13, 0.2, 0.5, 0.81, 1.0] {
            let want = s.jet(t)[0] * (1.0 - 1.5 * t).powi(4) + 0.1 + 3.0 * t * t;
            assert!((curve.point(t) - want).abs() < 1e-12, "{t}");
        }
    }
}
