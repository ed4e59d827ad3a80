//! The blending functions: how much of each surface goes into a blend (Wagner et al. 2003, Section 5 and Appendix A).

use glam::DVec2;
use suture_bernstein::{Jet2, bernstein};

use crate::gon::{self, MAX_VALENCE};
use crate::tables::n_blend;

/// Degree of all blending functions: the lowest for which (H1)–(H25) have a solution.
pub(crate) const DEGREE: usize = 7;
const NET: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// Weights `H↓(V)`, `H↑(V)` of a strip, their first and second derivatives: degree 7 with the net (1, 1, 1, 1, 0, 0, 0, 0), the
/// smoothest symmetric step (Appendix A.1). `H↑` is computed as `1 − H↓`, so that the two sum to 1 to the bit.
pub fn strip(v: f64) -> [Jet2<f64>; 2] {
    let mut basis = [[0.0; 3]; DEGREE + 1];
    bernstein::jets(DEGREE, v, &mut basis);
    let sum = |half: &[[f64; 3]], d: usize| half[0][d] + half[1][d] + half[2][d] + half[3][d];
    let (low, high) = basis.split_at(4);
    // Summed from the smaller half: the weights end at 0 and 1 exactly, with relative accuracy beside the end.
    let down = if v <= 0.5 { 1.0 - sum(high, 0) } else { sum(low, 0) };
    let (d, dd) = (sum(low, 1), sum(low, 2));
    let jet = |p, d, dd| Jet2 { p, dv: d, dvv: dd, ..Jet2::default() };
    [jet(down, d, dd), jet(1.0 - down, -d, -dd)]
}

/// Weights `H^{N,1} … H^{N,N}` of an N-blend at `at`, with their partials in the plane of the N-gon; the first `n` entries count.
///
/// The `i`-th function is the first one turned by `2π(i − 1)/N` (H24), hence on triangle `α` it is the net of triangle
/// `α − i + 1` of the table over the same barycentric coordinates: one evaluation of the basis serves all of them.
///
/// Outside `3..=8` all weights are 0: [`crate::Network`] admits no such corner.
pub fn n_blend(n: usize, at: DVec2) -> [Jet2<f64>; MAX_VALENCE] {
    let mut weights = [Jet2::default(); MAX_VALENCE];
    let Some(table) = n_blend::table(n) else {
        return weights;
    };
    let alpha = gon::triangle(n, at);
    let basis = triangle_basis(n, alpha, at);
    for (i, weight) in weights.iter_mut().enumerate().take(n) {
        let net = &table[(alpha + n - i) % n];
        for (b, &h) in basis.iter().zip(net) {
            weight.p += h * b.p;
            weight.du += h * b.du;
            weight.dv += h * b.dv;
            weight.duu += h * b.duu;
            weight.duv += h * b.duv;
            weight.dvv += h * b.dvv;
        }
    }
    weights
}

/// Jets in (U, V) of all Bernstein polynomials of degree 7 over the triangle `(R_α, R_{α+1}, O)`, in the order of the tables.
fn triangle_basis(n: usize, alpha: usize, at: DVec2) -> [Jet2<f64>; NET] {
    let turn = |i: usize| gon::rotation(n, i).rotate(DVec2::new(0.0, gon::circumradius(n)));
    let (r, s) = (turn(alpha), turn((alpha + 1) % n));
    let area = r.perp_dot(s);
    let (rho, sigma) = (at.perp_dot(s) / area, r.perp_dot(at) / area);
    let bary = [rho, sigma, 1.0 - rho - sigma];
    let (grad_rho, grad_sigma) = (DVec2::new(s.y, -s.x) / area, DVec2::new(-r.y, r.x) / area);
    let grad = [grad_rho, grad_sigma, -grad_rho - grad_sigma];

    // powers[c][e] = bary_c^e
    let mut powers = [[1.0; DEGREE + 1]; 3];
    for c in 0..3 {
        for e in 1..=DEGREE {
            powers[c][e] = powers[c][e - 1] * bary[c];
        }
    }
    let mut out = [Jet2::default(); NET];
    let mut index = 0;
    for k in 0..=DEGREE {
        for j in 0..=DEGREE - k {
            let e = [DEGREE - j - k, j, k];
            let m = multinomial(e);
            // Partial derivatives by the barycentric coordinates, `down[c]` = how often coordinate c is differentiated.
            let partial = |down: [usize; 3]| {
                let mut f = m;
                for c in 0..3 {
                    if e[c] < down[c] {
                        return 0.0;
                    }
                    for q in 0..down[c] {
                        f *= (e[c] - q) as f64;
                    }
                    f *= powers[c][e[c] - down[c]];
                }
                f
            };
            let unit = |c: usize| {
                let mut d = [0; 3];
                d[c] += 1;
                d
            };
            let mut jet = Jet2 { p: partial([0; 3]), ..Jet2::default() };
            for a in 0..3 {
                let first = partial(unit(a));
                jet.du += first * grad[a].x;
                jet.dv += first * grad[a].y;
                for b in 0..3 {
                    let mut d = unit(a);
                    d[b] += 1;
                    let second = partial(d);
                    jet.duu += second * grad[a].x * grad[b].x;
                    jet.duv += second * grad[a].x * grad[b].y;
                    jet.dvv += second * grad[a].y * grad[b].y;
                }
            }
            out[index] = jet;
            index += 1;
        }
    }
    out
}

fn multinomial([i, j, k]: [usize; 3]) -> f64 {
    const FACTORIAL: [f64; DEGREE + 1] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0];
    FACTORIAL[i + j + k] / (FACTORIAL[i] * FACTORIAL[j] * FACTORIAL[k])
}
