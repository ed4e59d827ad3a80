//! Gauss–Legendre quadrature on `[0, 1]`.

use std::f64::consts::PI;

/// Nodes (rising) and weights of the rule with `points` nodes: exact to rounding for polynomials of degree `2 points − 1`.
///
/// Newton's method on the Legendre polynomial, from Tricomi's guess; symmetric to the bit in the weights.
///
/// # References
/// P. J. Davis, P. Rabinowitz, *Methods of Numerical Integration*, 2nd ed., 1984, section 2.7.
pub fn gauss_legendre(points: usize) -> Vec<[f64; 2]> {
    let mut rule = vec![[0.5, 1.0]; points];
    for i in 0..points / 2 {
        let mut x = (PI * (i as f64 + 0.75) / (points as f64 + 0.5)).cos();
        // Quadratic convergence from four digits; the fixed number of steps keeps every machine on the same path.
        for _ in 0..6 {
            let [p, d] = legendre(points, x);
            x -= p / d;
        }
        let slope = legendre(points, x)[1];
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = [0.5 - 0.5 * x, weight];
        rule[points - 1 - i] = [0.5 + 0.5 * x, weight];
    }
    if points % 2 == 1 {
        let slope = legendre(points, 0.0)[1];
        rule[points / 2] = [0.5, 1.0 / (slope * slope)];
    }
    rule
}

/// The Legendre polynomial of degree `n ≥ 1` and its derivative at `x` in `(−1, 1)`.
fn legendre(n: usize, x: f64) -> [f64; 2] {
    let (mut before, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    [p, n as f64 * (before - x * p) / (1.0 - x * x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_integrates_the_powers_it_must() {
        for points in 1..=40 {
            let rule = gauss_legendre(points);
            assert!(rule.windows(2).all(|w| w[0][0] < w[1][0]));
            for power in 0..2 * points {
                let sum: f64 = rule.iter().map(|[x, w]| w * x.powi(power as i32)).sum();
                let want = 1.0 / (power + 1) as f64;
                assert!((sum - want).abs() < 4e-15, "{points} points, power {power}: {sum} ≠ {want}");
            }
        }
        assert!(gauss_legendre(0).is_empty());
    }
}
