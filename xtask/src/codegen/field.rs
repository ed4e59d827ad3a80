//! Exact arithmetic in the real number field `Q(c)`, `c = 2 cos(2π/N)`.
//!
//! The conditions on the N-blends and their energy have coefficients in this field, whose degree over `Q` is 1 for
//! `N` = 3, 4, 6, 2 for 5 and 8, and 3 for 7. An element is a polynomial in `c` of smaller degree with rational coefficients,
//! so that "is zero" is decided, not estimated.

use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// The field `Q(c)` of one `N`.
#[derive(Debug, PartialEq)]
pub(crate) struct Field {
    n: usize,
    /// `c^d = Σ power[k] c^k`, `d = power.len()`: the minimal polynomial of `c`, solved for its leading term.
    power: &'static [i64],
}

static FIELDS: [Field; 6] = [
    Field { n: 3, power: &[-1] },
    Field { n: 4, power: &[0] },
    Field { n: 5, power: &[1, -1] },
    Field { n: 6, power: &[1] },
    Field { n: 7, power: &[1, 2, -1] },
    Field { n: 8, power: &[2, 0] },
];

impl Field {
    /// The field of the regular `n`-gon, `None` outside `3..=8`.
    pub(crate) fn of(n: usize) -> Option<&'static Self> {
        FIELDS.iter().find(|f| f.n == n)
    }

    /// The number of corners of the polygon.
    pub(crate) fn n(&self) -> usize {
        self.n
    }

    /// `c = 2 cos(2π/N)`.
    pub(crate) fn c(&'static self) -> Elem {
        let mut x = vec![BigRational::zero(); self.power.len()];
        match x.get_mut(1) {
            Some(first) => *first = BigRational::one(),
            None => x[0] = integer(self.power[0]),
        }
        Elem { field: self, x }
    }

    /// The rational `p/q`.
    pub(crate) fn ratio(&'static self, p: i64, q: i64) -> Elem {
        let mut x = vec![BigRational::zero(); self.power.len()];
        x[0] = BigRational::new(p.into(), q.into());
        Elem { field: self, x }
    }

    /// The integer `p`.
    pub(crate) fn int(&'static self, p: i64) -> Elem {
        self.ratio(p, 1)
    }

    /// Two rationals around `c`, `2^−bits` apart.
    fn enclose_c(&self, bits: i32) -> [BigRational; 2] {
        // c is the largest root, and simple: the polynomial is negative just below it and positive from there on.
        let value = |x: &BigRational| {
            let lower = self.power.iter().rev().fold(BigRational::zero(), |v, &p| v * x + integer(p));
            num_traits::pow(x.clone(), self.power.len()) - lower
        };
        let start = 40;
        let near = (2.0 * (std::f64::consts::TAU / self.n as f64).cos() * f64::powi(2.0, start)).round();
        let at = |x: f64| BigRational::new(BigInt::from(x as i64), BigInt::one() << start);
        let [mut lo, mut hi] = [at(near - 1.0), at(near + 1.0)];
        assert!(value(&lo).is_negative() && value(&hi).is_positive(), "minimal polynomial of N = {}", self.n);
        for _ in start..=bits {
            let middle = (&lo + &hi) / integer(2);
            if value(&middle).is_negative() {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        [lo, hi]
    }
}

/// An element of a [`Field`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elem {
    field: &'static Field,
    x: Vec<BigRational>,
}

impl Elem {
    pub(crate) fn field(&self) -> &'static Field {
        self.field
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.x.iter().all(BigRational::is_zero)
    }

    /// The reciprocal, `None` of zero.
    pub(crate) fn inverse(&self) -> Option<Self> {
        // Column j of the matrix is self · c^j; the reciprocal solves  matrix · y = 1.
        let d = self.x.len();
        let mut columns = vec![self.clone()];
        for j in 1..d {
            columns.push(&columns[j - 1] * &self.field.c());
        }
        let mut rows: Vec<Vec<BigRational>> = (0..d)
            .map(|i| {
                let right = if i == 0 { BigRational::one() } else { BigRational::zero() };
                columns.iter().map(|c| c.x[i].clone()).chain([right]).collect()
            })
            .collect();
        for j in 0..d {
            let pivot = (j..d).find(|&i| !rows[i][j].is_zero())?;
            rows.swap(j, pivot);
            let scale = rows[j][j].recip();
            rows[j].iter_mut().for_each(|a| *a *= &scale);
            for i in (0..d).filter(|&i| i != j) {
                let factor = rows[i][j].clone();
                for k in j..=d {
                    let step = &factor * &rows[j][k];
                    rows[i][k] -= step;
                }
            }
        }
        Some(Self { field: self.field, x: rows.into_iter().map(|mut row| row.swap_remove(d)).collect() })
    }

    /// The nearest `f64` (ties to even).
    pub(crate) fn to_f64(&self) -> f64 {
        if self.x[1..].iter().all(BigRational::is_zero) {
            return nearest(&self.x[0]);
        }
        // An irrational number is no tie: the enclosure falls between two neighbouring ties in the end.
        let mut bits = 128;
        loop {
            let [lo, hi] = self.enclose(bits);
            let (lo, hi) = (nearest(&lo), nearest(&hi));
            if lo == hi {
                return lo;
            }
            bits *= 2;
        }
    }

    fn enclose(&self, bits: i32) -> [BigRational; 2] {
        let [lo, hi] = self.field.enclose_c(bits);
        let mut sum = [self.x[0].clone(), self.x[0].clone()];
        // Where the field is larger than Q, c > 0, and its powers keep the order of the two bounds.
        let mut power = [BigRational::one(), BigRational::one()];
        for x in &self.x[1..] {
            power = [&power[0] * &lo, &power[1] * &hi];
            let [a, b] = if x.is_negative() { [1, 0] } else { [0, 1] };
            sum = [&sum[0] + x * &power[a], &sum[1] + x * &power[b]];
        }
        sum
    }
}

impl Add for &Elem {
    type Output = Elem;
    fn add(self, other: &Elem) -> Elem {
        Elem { field: self.field, x: self.x.iter().zip(&other.x).map(|(a, b)| a + b).collect() }
    }
}

impl Sub for &Elem {
    type Output = Elem;
    fn sub(self, other: &Elem) -> Elem {
        Elem { field: self.field, x: self.x.iter().zip(&other.x).map(|(a, b)| a - b).collect() }
    }
}

impl Neg for &Elem {
    type Output = Elem;
    fn neg(self) -> Elem {
        Elem { field: self.field, x: self.x.iter().map(|a| -a).collect() }
    }
}

impl Mul for &Elem {
    type Output = Elem;
    fn mul(self, other: &Elem) -> Elem {
        let d = self.x.len();
        let mut x = vec![BigRational::zero(); 2 * d - 1];
        for (i, a) in self.x.iter().enumerate().filter(|(_, a)| !a.is_zero()) {
            for (j, b) in other.x.iter().enumerate().filter(|(_, b)| !b.is_zero()) {
                x[i + j] += a * b;
            }
        }
        for top in (d..x.len()).rev() {
            let lead = x.swap_remove(top);
            for (k, &p) in self.field.power.iter().enumerate() {
                x[top - d + k] += &lead * integer(p);
            }
        }
        Elem { field: self.field, x }
    }
}

fn integer(p: i64) -> BigRational {
    BigRational::from_integer(p.into())
}

/// The nearest `f64` (ties to even) of a rational whose nearest `f64` is zero or normal.
fn nearest(x: &BigRational) -> f64 {
    if x.is_zero() {
        return 0.0;
    }
    // A quotient of 65 or 66 bits whose last bit also says "or a little more", so that rounding it rounds x.
    let shift = 65 + x.denom().bits() as i64 - x.numer().bits() as i64;
    let (numer, denom) = if shift >= 0 {
        (x.numer().abs() << shift, x.denom().clone())
    } else {
        (x.numer().abs(), x.denom() << -shift)
    };
    let mut quotient = &numer / &denom;
    if &quotient * &denom != numer {
        quotient |= BigInt::one();
    }
    let quotient = quotient.to_u128().unwrap_or_default();
    let value = quotient as f64 * f64::powi(2.0, -shift as i32);
    if x.is_negative() { -value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn c_is_twice_the_cosine() {
        for n in 3..=8 {
            let c = Field::of(n).unwrap().c();
            let want = 2.0 * (std::f64::consts::TAU / n as f64).cos();
            assert!((c.to_f64() - want).abs() < 1e-15, "N = {n}: {} ≠ {want}", c.to_f64());
        }
    }

    #[test]
    fn every_element_but_zero_has_a_reciprocal() {
        for n in 3..=8 {
            let field = Field::of(n).unwrap();
            let x = &(&(&field.c() * &field.c()) + &field.ratio(-3, 7)) - &(&field.c() * &field.int(5));
            assert_eq!(&x * &x.inverse().unwrap(), field.int(1), "N = {n}");
            assert_eq!(field.int(0).inverse(), None);
        }
    }

    #[test]
    fn c_satisfies_its_chebyshev_relation() {
        // 2 cos(N t) = 2 with t = 2π/N: the recurrence a_{k+1} = c a_k − a_{k−1} returns to 2.
        for n in 3..=8 {
            let field = Field::of(n).unwrap();
            let [mut a, mut b] = [field.int(2), field.c()];
            for _ in 1..n {
                let next = &(&field.c() * &b) - &a;
                a = std::mem::replace(&mut b, next);
            }
            assert_eq!(b, field.int(2), "N = {n}");
        }
    }

    #[test]
    fn rounding_is_to_nearest_even() {
        // 1 + (1 + 2m)/2^53 lies halfway between two neighbours.
        let unit: BigInt = BigInt::one() << 53;
        let tie = |m: i64| BigRational::new(&unit + BigInt::from(1 + 2 * m), unit.clone());
        let a_little = BigRational::new(BigInt::one(), BigInt::one() << 300);
        assert_eq!(nearest(&tie(0)), 1.0);
        assert_eq!(nearest(&tie(1)), 1.0 + 2.0 * f64::EPSILON);
        assert_eq!(nearest(&(tie(0) + &a_little)), 1.0 + f64::EPSILON);
        assert_eq!(nearest(&(tie(1) - &a_little)), 1.0 + f64::EPSILON);
        assert_eq!(nearest(&-(tie(0) + &a_little)), -1.0 - f64::EPSILON);
        for (p, q) in [(1_i64, 3_i64), (2, 3), (-22, 7), (1, 1_000_000_007), (0, 5)] {
            // The division of two floats rounds once, too.
            assert_eq!(nearest(&BigRational::new(p.into(), q.into())), p as f64 / q as f64);
        }
    }
}
