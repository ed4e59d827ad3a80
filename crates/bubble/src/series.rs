//! Truncated power series in one and two variables.
//!
//! All of fixed length: coefficients of order `k` of every result depend on orders up to `k` of the operands alone, so that a
//! coefficient that is not known (the last one of a derivative) never reaches a lower one.

/// Coefficients of `1, t, …, t^(L−1)`.
pub(crate) type Series<const L: usize> = [f64; L];

/// The constant `c`.
#[inline(always)]
pub(crate) fn constant<const L: usize>(c: f64) -> Series<L> {
    let mut out = [0.0; L];
    out[0] = c;
    out
}

#[inline(always)]
pub(crate) fn add<const L: usize>(a: &Series<L>, b: &Series<L>) -> Series<L> {
    std::array::from_fn(|k| a[k] + b[k])
}

#[inline(always)]
pub(crate) fn sub<const L: usize>(a: &Series<L>, b: &Series<L>) -> Series<L> {
    std::array::from_fn(|k| a[k] - b[k])
}

#[inline(always)]
pub(crate) fn scale<const L: usize>(a: &Series<L>, c: f64) -> Series<L> {
    a.map(|x| x * c)
}

#[inline(always)]
pub(crate) fn mul<const L: usize>(a: &Series<L>, b: &Series<L>) -> Series<L> {
    let mut out = [0.0; L];
    mul_add(&mut out, a, b);
    out
}

/// `out += a b`.
#[inline(always)]
pub(crate) fn mul_add<const L: usize>(out: &mut Series<L>, a: &Series<L>, b: &Series<L>) {
    for k in 0..L {
        for i in 0..k + 1 {
            out[k] += a[i] * b[k - i];
        }
    }
}

#[inline(always)]
pub(crate) fn dot<const L: usize>(a: &[Series<L>; 3], b: &[Series<L>; 3]) -> Series<L> {
    let mut out = mul(&a[0], &b[0]);
    mul_add(&mut out, &a[1], &b[1]);
    mul_add(&mut out, &a[2], &b[2]);
    out
}

/// `1 / a`; infinite or NaN where `a` vanishes.
#[inline(always)]
pub(crate) fn recip<const L: usize>(a: &Series<L>) -> Series<L> {
    let inverse = 1.0 / a[0];
    let mut out = [0.0; L];
    out[0] = inverse;
    for k in 1..L {
        let mut sum = 0.0;
        for i in 1..k + 1 {
            sum += a[i] * out[k - i];
        }
        out[k] = -sum * inverse;
    }
    out
}

/// The derivative; its last coefficient is not known and set to zero.
#[inline(always)]
pub(crate) fn derivative<const L: usize>(a: &Series<L>) -> Series<L> {
    std::array::from_fn(|k| if k + 1 < L { (k + 1) as f64 * a[k + 1] } else { 0.0 })
}

/// Coefficients of `x^i y^j`, `i + j < L`, as `[i][j]`; the others are never read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane<const L: usize>(pub(crate) [[f64; L]; L]);

impl<const L: usize> Plane<L> {
    pub(crate) const ZERO: Self = Self([[0.0; L]; L]);

    /// `c + a x + b y`.
    #[inline]
    pub(crate) fn linear(c: f64, a: f64, b: f64) -> Self {
        let mut out = Self::ZERO;
        out.0[0][0] = c;
        if L > 1 {
            out.0[1][0] = a;
            out.0[0][1] = b;
        }
        out
    }

    pub(crate) fn add(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| add(&self.0[i], &other.0[i])))
    }

    pub(crate) fn scale(&self, c: f64) -> Self {
        Self(self.0.map(|row| scale(&row, c)))
    }

    pub(crate) fn mul(&self, other: &Self) -> Self {
        let mut out = Self::ZERO;
        for i in 0..L {
            for k in 0..L - i {
                let x = self.0[i][k];
                if x != 0.0 {
                    for j in 0..L - i - k {
                        for l in 0..L - i - k - j {
                            out.0[i + j][k + l] += x * other.0[j][l];
                        }
                    }
                }
            }
        }
        out
    }

    /// `1 / self`; infinite or NaN where it vanishes.
    pub(crate) fn recip(&self) -> Self {
        // 1/(c (1 + e)) = (1 − e + e² − …)/c, exact in the ring of truncated series.
        let inverse = 1.0 / self.0[0][0];
        let mut minus_e = self.scale(-inverse);
        minus_e.0[0][0] = 0.0;
        let one = Self::linear(1.0, 0.0, 0.0);
        let mut sum = one;
        for _ in 1..L {
            sum = one.add(&minus_e.mul(&sum));
        }
        sum.scale(inverse)
    }

    /// `Σ c_k (self − self(0))^k`: the series with coefficients `c` about the constant term of `self`.
    pub(crate) fn substitute(&self, c: &[f64]) -> Self {
        let mut shift = *self;
        shift.0[0][0] = 0.0;
        let mut out = Self::ZERO;
        for &c in c.iter().rev() {
            out = out.mul(&shift);
            out.0[0][0] += c;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_of_known_functions() {
        // e^t · e^−t = 1 and 1/(1 − t) = Σ tᵏ.
        let (e, f) = ([1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0], [1.0, -1.0, 0.5, -1.0 / 6.0, 1.0 / 24.0]);
        let product = mul(&e, &f);
        assert!((0..5).all(|k| (product[k] - f64::from(u8::from(k == 0))).abs() < 1e-16));
        assert_eq!(recip(&[1.0, -1.0, 0.0, 0.0]), [1.0; 4]);
        assert_eq!(derivative(&e)[..4], e[..4]);
    }

    #[test]
    fn plane_series_of_known_functions() {
        // 1/(2 − x − y) has the coefficients C(i + j, i)/2^(i+j+1).
        let r = Plane::<5>::linear(2.0, -1.0, -1.0).recip();
        assert!((r.0[2][1] - 3.0 / 16.0).abs() < 1e-16 && (r.0[2][2] - 6.0 / 32.0).abs() < 1e-16);
        // (x + y)³ through substitution into (1 + s)³ about s = 1.
        let cube = Plane::<4>::linear(1.0, 1.0, 1.0).substitute(&[1.0, 3.0, 3.0, 1.0]);
        assert_eq!((cube.0[0][0], cube.0[1][0], cube.0[1][1], cube.0[2][1]), (1.0, 3.0, 6.0, 3.0));
    }
}
