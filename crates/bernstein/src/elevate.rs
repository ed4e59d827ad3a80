//! Degree elevation of Bézier nets: the same polynomial in a higher basis.
//!
//! # References
//! G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, sections 6.1, 17.5.

use crate::axis::map_lines;
use crate::triangle::index;
use crate::{Axis, BezierCurve, BezierPatch, BezierTriangle, MAX_DEGREE, NetError, Vector};

impl<T: Vector> BezierCurve<T> {
    /// The same curve with `by` degrees more; its ends keep their bits.
    ///
    /// # Errors
    /// [`NetError::Degree`] beyond [`MAX_DEGREE`].
    pub fn elevate(&self, by: usize) -> Result<Self, NetError> {
        check(self.degree(), by)?;
        Self::new(elevate_line(self.net(), by))
    }
}

impl<T: Vector> BezierPatch<T> {
    /// The same patch with `by` degrees more along `axis`; its corners keep their bits.
    ///
    /// # Errors
    /// [`NetError::Degree`] beyond [`MAX_DEGREE`].
    pub fn elevate(&self, axis: Axis, by: usize) -> Result<Self, NetError> {
        let mut degree = self.degree();
        check(degree[axis.index()], by)?;
        degree[axis.index()] += by;
        Self::new(degree, map_lines(self.net(), self.count(), axis, |line| elevate_line(line, by)))
    }
}

impl<T: Vector> BezierTriangle<T> {
    /// The same triangle with `by` degrees more; its corners keep their bits.
    ///
    /// # Errors
    /// [`NetError::Degree`] beyond [`MAX_DEGREE`].
    pub fn elevate(&self, by: usize) -> Result<Self, NetError> {
        check(self.degree(), by)?;
        let mut net = self.net().to_vec();
        for n in self.degree() + 1..=self.degree() + by {
            let entry = |j: usize, k: usize| {
                let mut sum = T::default();
                let term =
                    |count: usize, j: usize, k: usize| net[index(n - 1, j, k)] * (count as f64 / n as f64);
                let i = n - j - k;
                for (count, dj, dk) in [(i, 0, 0), (j, 1, 0), (k, 0, 1)] {
                    if count > 0 {
                        sum = sum + term(count, j - dj, k - dk);
                    }
                }
                sum
            };
            net = (0..=n).flat_map(|k| (0..=n - k).map(move |j| (j, k))).map(|(j, k)| entry(j, k)).collect();
        }
        Self::new(self.degree() + by, net)
    }
}

fn check(degree: usize, by: usize) -> Result<(), NetError> {
    let degree = degree.saturating_add(by);
    if degree > MAX_DEGREE { Err(NetError::Degree { degree }) } else { Ok(()) }
}

fn elevate_line<T: Vector>(line: &[T], by: usize) -> Vec<T> {
    let mut line = line.to_vec();
    for _ in 0..by {
        let n = line.len();
        line.push(line[n - 1]);
        for i in (1..n).rev() {
            line[i] = line[i - 1] * (i as f64 / n as f64) + line[i] * ((n - i) as f64 / n as f64);
        }
    }
    line
}
