//! The interpolant in exact rational arithmetic: polynomial precision 3n + 2, interpolation of all three edges, and the paper's printed
//! form (appendix A.3), which fails.

use num_bigint::BigInt;
use num_rational::BigRational as Q;
use num_traits::{One, Zero};

fn q(n: i64, d: i64) -> Q {
    Q::new(BigInt::from(n), BigInt::from(d))
}

fn power(x: &Q, k: usize) -> Q {
    (0..k).fold(Q::one(), |p, _| p * x)
}

fn factorial(k: usize) -> Q {
    (1..=k as i64).fold(Q::one(), |p, i| p * q(i, 1))
}

fn choose(n: usize, k: usize) -> Q {
    if k > n { Q::zero() } else { factorial(n) / factorial(k) / factorial(n - k) }
}

/// `Σ c[a][b] u^a v^b`.
#[derive(Clone)]
struct Plane(Vec<Vec<Q>>);

impl Plane {
    /// Small rationals without pattern (a linear congruence), all terms up to `degree`.
    fn random(degree: usize, seed: i64) -> Self {
        let mut state = seed;
        let mut next = || {
            state = (state * 1_103_515_245 + 12_345) % 2_147_483_648;
            q(state / 65_536 % 19 - 9, 7)
        };
        Self((0..=degree).map(|a| (0..=degree - a).map(|_| next()).collect()).collect())
    }

    /// `∂_u^i ∂_v^j` at a point.
    fn at(&self, i: usize, j: usize, u: &Q, v: &Q) -> Q {
        let mut sum = Q::zero();
        for (a, row) in self.0.iter().enumerate().skip(i) {
            for (b, c) in row.iter().enumerate().skip(j) {
                let falling = factorial(a) / factorial(a - i) * factorial(b) / factorial(b - j);
                sum += c * falling * power(u, a - i) * power(v, b - j);
            }
        }
        sum
    }
}

/// Coefficients of `H_{end,i}` of degree 2n + 1, from the conditions that define it.
fn hermite(n: usize, end: usize, i: usize) -> Vec<Q> {
    let size = 2 * n + 2;
    let mut m: Vec<Vec<Q>> = Vec::new();
    for k in 0..2 {
        for j in 0..=n {
            let mut row: Vec<Q> = (0..size)
                .map(|p| match (k, p.checked_sub(j)) {
                    (_, None) => Q::zero(),
                    (0, Some(0)) | (1, Some(_)) => factorial(p) / factorial(p - j),
                    _ => Q::zero(),
                })
                .collect();
            row.push(if k == end && j == i { Q::one() } else { Q::zero() });
            m.push(row);
        }
    }
    for c in 0..size {
        let pivot = (c..size).find(|&r| !m[r][c].is_zero()).unwrap();
        m.swap(c, pivot);
        let p = m[c][c].clone();
        m[c].iter_mut().for_each(|x| *x /= &p);
        for r in 0..size {
            if r != c && !m[r][c].is_zero() {
                let f = m[r][c].clone();
                for k in 0..=size {
                    let x = &f * &m[c][k];
                    m[r][k] -= x;
                }
            }
        }
    }
    m.into_iter().map(|row| row[size].clone()).collect()
}

fn value(p: &[Q], t: &Q) -> Q {
    p.iter().rev().fold(Q::zero(), |s, c| s * t + c)
}

fn slope(p: &[Q]) -> Vec<Q> {
    p.iter().enumerate().skip(1).map(|(k, c)| c * q(k as i64, 1)).collect()
}

/// Which of the formulas for `Q^(k)`.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Corrected,
    /// `Q^(0)` with the indices of H exchanged.
    Printed0,
    /// `Q^(1)` with `v` before everything and the undifferentiated terms.
    Printed1,
}

/// `(P₁ ⊕ P₂) h`.
fn interpolate(h: &Plane, n: usize, u: &Q, v: &Q, form: Form) -> Q {
    let (zero, one) = (Q::zero(), Q::one());
    let (cu, cv) = (&one - u, &one - v);
    let (s, r) = (v / &cu, u / &cv);
    let mut sum = Q::zero();
    for i in 0..=n {
        let (a, b) = (h.at(0, i, u, &zero), h.at(0, i, u, &cu));
        sum += power(&cu, i) * (value(&hermite(n, 0, i), &s) * a + value(&hermite(n, 1, i), &s) * b);
        let side = h.at(i, 0, &zero, v) - repair(h, n, i, v, form);
        sum += power(&cv, i) * value(&hermite(n, 0, i), &r) * side;
    }
    sum
}

/// `Q^(k)(v)`.
fn repair(h: &Plane, n: usize, k: usize, v: &Q, form: Form) -> Q {
    let (zero, one) = (Q::zero(), Q::one());
    let mut sum = Q::zero();
    for i in 0..=n {
        let hs = [hermite(n, 0, i), hermite(n, 1, i)];
        if k == 0 && form == Form::Printed0 {
            // H_{i,0} and H_{i,1} in place of H_{0,i} and H_{1,i}.
            sum += value(&hermite(n, i.min(1), 0), v) * h.at(0, i, &zero, &zero);
            sum += value(&hermite(n, i.min(1), 1.min(n)), v) * h.at(0, i, &zero, &one);
            continue;
        }
        let a = |k: usize| h.at(k, i, &zero, &zero);
        let b = |k: usize| {
            (0..=k).fold(Q::zero(), |s, l| {
                let sign = if l % 2 == 0 { one.clone() } else { -one.clone() };
                s + choose(k, l) * sign * h.at(k - l, i + l, &zero, &one)
            })
        };
        for l in 0..=k {
            let phi = |p: &[Q]| {
                let scaled: Vec<Q> = p
                    .iter()
                    .enumerate()
                    .map(|(e, c)| (0..l).fold(c.clone(), |c, s| c * q(e as i64 + s as i64 - i as i64, 1)))
                    .collect();
                value(&scaled, v)
            };
            let mut term = choose(k, l) * (phi(&hs[0]) * a(k - l) + phi(&hs[1]) * b(k - l));
            if form == Form::Printed1 && k == 1 {
                // v [ … ] around everything, with H_{0,i} undifferentiated for i = 0.
                let d = |p: &[Q]| if i == 0 { value(p, v) } else { value(&slope(p), v) };
                term = if l == 1 { v * (d(&hs[0]) * a(0) + d(&hs[1]) * b(0)) } else { v * term };
            }
            sum += term;
        }
    }
    sum
}

fn points() -> Vec<(Q, Q)> {
    [(1, 2, 3), (2, 3, 7), (1, 1, 9), (3, 3, 11)].map(|(a, b, d)| (q(a, 10), q(b, d) * q(1, 2))).to_vec()
}

#[test]
fn total_degree_precision_is_3n_plus_2() {
    for n in 0..3 {
        let exact = |degree: usize| {
            let h = Plane::random(degree, 7 + n as i64);
            points().iter().all(|(u, v)| interpolate(&h, n, u, v, Form::Corrected) == h.at(0, 0, u, v))
        };
        assert!(exact(3 * n + 2), "n = {n}");
        assert!(!exact(3 * n + 3), "n = {n}");
    }
}

#[test]
fn all_three_edges_are_interpolated_exactly() {
    let h = Plane::random(11, 3);
    let (zero, one) = (Q::zero(), Q::one());
    for n in 0..3 {
        for t in [q(1, 3), q(5, 7)] {
            let rest = &one - &t;
            for (u, v) in [(&t, &zero), (&zero, &t), (&t, &rest)] {
                assert_eq!(interpolate(&h, n, u, v, Form::Corrected), h.at(0, 0, u, v), "n = {n}");
            }
        }
    }
}

#[test]
fn the_printed_a3_fails() {
    let h = Plane::random(8, 5);
    let (zero, third) = (Q::zero(), q(1, 3));
    let on_edge = |form| interpolate(&h, 1, &zero, &third, form) == h.at(0, 0, &zero, &third);
    assert!(on_edge(Form::Corrected) && !on_edge(Form::Printed0));
    // The printed Q^(1) leaves the value alone and spoils the cross derivative: precision is lost inside.
    let low = Plane::random(5, 5);
    let inside = |form| interpolate(&low, 1, &q(1, 5), &third, form) == low.at(0, 0, &q(1, 5), &third);
    assert!(inside(Form::Corrected) && !inside(Form::Printed1));
}
