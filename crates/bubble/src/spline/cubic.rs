//! C² cubic splines over uniform intervals of `[0, 1]`.

use super::pieces::Pieces;

/// Values and slopes (per interval) at the knots.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cubic {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Cubic {
    /// The spline with value, first and (where `second`) second derivative `ends` at both ends, all in the direction of `t`, and with the values
    /// `at` the knots; with second derivatives given, the knots next to the ends are free.
    pub(crate) fn new(intervals: usize, ends: [[f64; 3]; 2], second: bool, at: impl Fn(f64) -> f64) -> Self {
        let k = intervals;
        let h = 1.0 / k as f64;
        let mut f: Vec<f64> = (0..k + 1)
            .map(|j| match j {
                0 => ends[0][0],
                _ if j == k => ends[1][0],
                _ if second && (j == 1 || j == k - 1) => 0.0,
                _ => at(j as f64 * h),
            })
            .collect();
        // Slopes per interval: m_{j−1} + 4 m_j + m_{j+1} = 3 (f_{j+1} − f_{j−1}).
        let (start, end) = (ends[0][1] * h, ends[1][1] * h);
        let (bend, tail) = (ends[0][2] * h * h, ends[1][2] * h * h);
        // Where second derivatives are given, f_1 = a + m_1/3 and f_{K−1} = b − m_{K−1}/3.
        let a = f[0] + start * 2.0 / 3.0 + bend / 6.0;
        let b = f[k] - end * 2.0 / 3.0 + tail / 6.0;
        let mut rows: Vec<[f64; 4]> = (1..k)
            .map(|j| {
                let mut row = [1.0, 4.0, 1.0, 3.0 * (f[j + 1] - f[j - 1])];
                if second && j == 2 {
                    (row[0], row[3]) = (2.0, row[3] - 3.0 * a);
                }
                if second && j + 2 == k {
                    (row[2], row[3]) = (2.0, row[3] + 3.0 * b);
                }
                row
            })
            .collect();
        rows[0][3] -= start;
        rows[k - 2][3] -= end;
        for j in 1..k - 1 {
            let factor = rows[j][0] / rows[j - 1][1];
            rows[j][1] -= factor * rows[j - 1][2];
            rows[j][3] -= factor * rows[j - 1][3];
        }
        let mut m = vec![0.0; k + 1];
        (m[0], m[k]) = (start, end);
        for j in (1..k).rev() {
            let next = if j + 1 < k { rows[j - 1][2] * m[j + 1] } else { 0.0 };
            m[j] = (rows[j - 1][3] - next) / rows[j - 1][1];
        }
        if second {
            f[1] = a + m[1] / 3.0;
            f[k - 1] = b - m[k - 1] / 3.0;
        }
        Self { values: f, slopes: m }
    }

    /// Value and first two derivatives.
    pub(crate) fn jet(&self, t: f64) -> [f64; 3] {
        let k = self.values.len() - 1;
        let s = t * k as f64;
        let j = (s.floor().max(0.0) as usize).min(k - 1);
        let (x, scale) = (s - j as f64, k as f64);
        let (f, g, m, n) = (self.values[j], self.values[j + 1], self.slopes[j], self.slopes[j + 1]);
        let (c, d) = (3.0 * (g - f) - 2.0 * m - n, 2.0 * (f - g) + m + n);
        [
            f + x * (m + x * (c + x * d)),
            scale * (m + x * (2.0 * c + 3.0 * x * d)),
            scale * scale * (2.0 * c + 6.0 * x * d),
        ]
    }

    /// As Bernstein coefficients by interval.
    pub(crate) fn pieces(&self) -> Pieces {
        let net = self.values.windows(2).zip(self.slopes.windows(2));
        Pieces::new(3, net.flat_map(|(f, m)| [f[0], f[0] + m[0] / 3.0, f[1] - m[1] / 3.0, f[1]]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_kept_and_quintics_met_with_order_four() {
        let cubic = |t: f64| 1.0 + t * (2.0 + t * (-3.0 + 0.5 * t));
        let ends = [[1.0, 2.0, -6.0], [0.5, -2.5, -3.0]];
        for second in [false, true] {
            for k in [4, 5, 9] {
                let s = Cubic::new(k, ends, second, cubic);
                for t in [0.0, 0.1, 0.37, 0.5, 0.93, 1.0] {
                    let want = [cubic(t), 2.0 - 6.0 * t + 1.5 * t * t, -6.0 + 3.0 * t];
                    let got = s.jet(t);
                    assert!((0..3).all(|d| (got[d] - want[d]).abs() < 1e-11), "{k} {t} {got:?} {want:?}");
                }
            }
            let f = |t: f64| (3.0 * t).sin();
            let ends = [[0.0, 3.0, 0.0], [f(1.0), 3.0 * 3f64.cos(), -9.0 * f(1.0)]];
            let error = |k: usize| {
                let s = Cubic::new(k, ends, second, f);
                (0..200)
                    .map(|i| (s.jet(f64::from(i) / 200.0)[0] - f(f64::from(i) / 200.0)).abs())
                    .fold(0.0, f64::max)
            };
            assert!((error(16) / error(32)).log2() > 3.5, "{second}");
        }
    }
}
