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

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(j: &Jet2<f64>) -> [f64; 6] {
        [j.p, j.du, j.dv, j.duu, j.duv, j.dvv]
    }

    #[track_caller]
    fn check_near(got: &Jet2<f64>, want: &Jet2<f64>) {
        for (g, w) in entries(got).into_iter().zip(entries(want)) {
            // Second derivatives of the weights reach about 50.
            assert!((g - w).abs() < 1e-11, "{got:?} ≠ {want:?}");
        }
    }

    #[test]
    fn strip_weights_are_the_smoothest_step() {
        let [down, up] = strip(0.0);
        assert_eq!((entries(&down), entries(&up)), ([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6]));
        for v in [0.0, 1e-3, 0.2, 0.5, 0.9, 1.0] {
            let ([a, b], [c, d]) = (strip(v), strip(1.0 - v));
            assert_eq!(a.p + b.p, 1.0);
            assert!((a.p - d.p).abs() < 1e-15 && (b.p - c.p).abs() < 1e-15 && (a.dv + d.dv).abs() < 1e-13);
        }
        // ∫ (v³ (1 − v)³) normalised: H↑(v) = v⁴ (35 − 84 v + 70 v² − 20 v³).
        let v: f64 = 0.3;
        let want = v.powi(4) * (35.0 - 84.0 * v + 70.0 * v * v - 20.0 * v.powi(3));
        assert!((strip(v)[1].p - want).abs() < 1e-15);
    }

    #[test]
    fn n_blend_weights_sum_to_one() {
        for n in 3..=8 {
            for k in 0..40 {
                let at = DVec2::from_angle(0.37 * f64::from(k)) * (0.012 * f64::from(k));
                let sum = n_blend(n, at)[..n].iter().fold(Jet2::default(), |s, w| s.add(*w));
                check_near(&sum, &Jet2::constant(1.0));
            }
        }
    }

    #[test]
    fn n_blend_weights_turn_and_mirror() {
        for n in 3..=8 {
            let at = DVec2::new(0.13, 0.21);
            let here = n_blend(n, at);
            let turned = n_blend(n, gon::rotation(n, 1).rotate(at));
            let mirrored = n_blend(n, DVec2::new(-at.x, at.y));
            for i in 0..n {
                assert!((here[i].p - turned[(i + 1) % n].p).abs() < 1e-14, "H24, N = {n}");
                assert!((here[i].p - mirrored[(n - i) % n].p).abs() < 1e-14, "H25, N = {n}");
            }
        }
    }

    #[test]
    fn n_blend_weights_are_those_of_the_strips_on_the_edges() {
        for n in 3..=8 {
            let r = gon::corners(n);
            for j in 0..n {
                let (a, b) = (r[j], r[(j + 1) % n]);
                let inward = -(a + b).normalize();
                for k in 0..=10 {
                    let t = f64::from(k) / 10.0;
                    // The strip there has V = 0 at R_{j+1}, whose surface is its ↓.
                    let want = strip(1.0 - t);
                    let got = n_blend(n, a * (1.0 - t) + b * t);
                    for i in 0..n {
                        let value = match i {
                            i if i == (j + 1) % n => want[0].p,
                            i if i == j => want[1].p,
                            _ => 0.0,
                        };
                        assert!((got[i].p - value).abs() < 1e-14, "H16, N = {n}, edge {j}, weight {i}");
                        let first = got[i].du * inward.x + got[i].dv * inward.y;
                        let second = got[i].duu * inward.x * inward.x
                            + 2.0 * got[i].duv * inward.x * inward.y
                            + got[i].dvv * inward.y * inward.y;
                        assert!(
                            first.abs() < 1e-12 && second.abs() < 1e-10,
                            "H17, H18: {first:e} {second:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn n_blend_weights_are_c2_inside() {
        for n in 3..=8 {
            for j in 0..n {
                let ray = gon::rotation(n, j).rotate(DVec2::Y);
                for radius in [0.0, 0.1, 0.3, 0.45] {
                    let side = |turn: f64| n_blend(n, DVec2::from_angle(turn).rotate(ray * radius));
                    let (a, b) = (side(-1e-14), side(1e-14));
                    for i in 0..n {
                        check_near(&a[i], &b[i]);
                    }
                }
            }
        }
    }
}
