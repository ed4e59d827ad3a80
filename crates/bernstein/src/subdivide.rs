//! De Casteljau's algorithm: subdivision and restriction of Bézier nets.
//!
//! `split` cuts at a parameter, `restrict` reparametrises a net over another interval or triangle; both describe the same
//! polynomial. Inside the domain every step is a convex combination; outside it the net is continued.
//!
//! # References
//! G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, sections 4.6 (blossoms), 5.4 and 17.4 (subdivision).

use crate::axis::map_lines;
use crate::triangle::index;
use crate::{Axis, BezierCurve, BezierPatch, BezierTriangle, NetError, Vector};

impl<T: Vector> BezierCurve<T> {
    /// Cuts at `t`: the curve over `[0, t]` and over `[t, 1]`, each on `[0, 1]` again. They share the bits of the cut.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when `t` is not finite or so far outside `[0, 1]` that the net overflows.
    pub fn split(&self, t: f64) -> Result<[Self; 2], NetError> {
        let [left, right] = split_line(self.net(), t);
        Ok([Self::new(left)?, Self::new(right)?])
    }

    /// The curve over `interval` `[a, b]`, on `[0, 1]` again; `b < a` turns it round.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] as for [`split`](Self::split).
    pub fn restrict(&self, interval: [f64; 2]) -> Result<Self, NetError> {
        Self::new(restrict_line(self.net(), interval))
    }
}

impl<T: Vector> BezierPatch<T> {
    /// Cuts along the line where the parameter of `axis` is `t`: below and above it, each on `[0, 1]²` again. They share the
    /// bits of the cut.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when `t` is not finite or so far outside `[0, 1]` that the net overflows.
    pub fn split(&self, axis: Axis, t: f64) -> Result<[Self; 2], NetError> {
        let half = |side: usize| {
            let net = map_lines(self.net(), self.count(), axis, |line| {
                let [left, right] = split_line(line, t);
                if side == 0 { left } else { right }
            });
            Self::new(self.degree(), net)
        };
        Ok([half(0)?, half(1)?])
    }

    /// The patch over `interval` `[a, b]` of the parameter of `axis`, on `[0, 1]²` again; `b < a` turns it round.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] as for [`split`](Self::split).
    pub fn restrict(&self, axis: Axis, interval: [f64; 2]) -> Result<Self, NetError> {
        let net = map_lines(self.net(), self.count(), axis, |line| restrict_line(line, interval));
        Self::new(self.degree(), net)
    }
}

impl<T: Vector> BezierTriangle<T> {
    /// The triangle over the triangle with barycentric `corners` (each of sum 1): subdivision at a point or across an edge,
    /// into four by edge midpoints, a turn or a continuation, by the choice of corners.
    ///
    /// # Errors
    /// [`NetError::NotFinite`] when a coordinate is not finite or so large that the net overflows.
    pub fn restrict(&self, corners: [[f64; 3]; 3]) -> Result<Self, NetError> {
        let n = self.degree();
        let mut net = vec![T::default(); self.net().len()];
        // The control points are the blossom at every choice, with repetition, of n corners.
        let mut after_r = self.net().to_vec();
        for i in 0..=n {
            let mut after_s = after_r.clone();
            for j in 0..=n - i {
                let k = n - i - j;
                let mut after_t = after_s.clone();
                (1..=k).rev().for_each(|m| step_triangle(&mut after_t, m, corners[2]));
                net[index(n, j, k)] = after_t[0];
                if k > 0 {
                    step_triangle(&mut after_s, k, corners[1]);
                }
            }
            if i < n {
                step_triangle(&mut after_r, n - i, corners[0]);
            }
        }
        Self::new(n, net)
    }

    /// The boundary curve opposite corner `opposite % 3`: from corner 1 to 2, 2 to 0, or 0 to 1.
    pub fn border(&self, opposite: usize) -> BezierCurve<T> {
        let n = self.degree();
        let at = |e: usize| match opposite % 3 {
            0 => index(n, n - e, e),
            1 => index(n, 0, n - e),
            _ => index(n, e, 0),
        };
        BezierCurve::from_checked((0..=n).map(|e| self.net()[at(e)]).collect())
    }
}

/// One step of de Casteljau's algorithm on a line, in place: the result is one shorter.
fn step_line<T: Vector>(line: &mut [T], t: f64) {
    let s = 1.0 - t;
    for i in 1..line.len() {
        line[i - 1] = line[i - 1] * s + line[i] * t;
    }
}

fn split_line<T: Vector>(line: &[T], t: f64) -> [Vec<T>; 2] {
    let mut right = line.to_vec();
    let left = (0..line.len())
        .map(|d| {
            let first = right[0];
            step_line(&mut right[..line.len() - d], t);
            first
        })
        .collect();
    [left, right]
}

fn restrict_line<T: Vector>(line: &[T], [a, b]: [f64; 2]) -> Vec<T> {
    let n = line.len() - 1;
    let mut after_b = line.to_vec();
    (0..=n)
        .map(|j| {
            let mut after_a = after_b[..=n - j].to_vec();
            (0..n - j).for_each(|d| step_line(&mut after_a[..=n - j - d], a));
            step_line(&mut after_b[..=n - j], b);
            after_a[0]
        })
        .collect()
}

/// One step of de Casteljau's algorithm on a net of degree `m ≥ 1`, in place: the result is a net of degree `m − 1`.
fn step_triangle<T: Vector>(net: &mut [T], m: usize, w: [f64; 3]) {
    for k in 0..m {
        for j in 0..m - k {
            // The smaller net is written in rising order, and no entry lies behind one that it is made of.
            let (a, b, c) = (net[index(m, j, k)], net[index(m, j + 1, k)], net[index(m, j, k + 1)]);
            net[index(m - 1, j, k)] = a * w[0] + b * w[1] + c * w[2];
        }
    }
}
