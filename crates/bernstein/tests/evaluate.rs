//! Evaluation against closed forms: powers of the parameters in every basis, the definition of the bases, invariances.

mod common;

use common::{at, barycentric, close, curve, knots, near, patch, spline, surface, triangle};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use proptest::prelude::*;
use suture_bernstein::bernstein::{self, binomial};
use suture_bernstein::{
    BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle, MAX_DEGREE, NetError, bspline,
};

/// Falling factorial times power: the `d`-th derivative of `t^k`.
fn power(k: usize, d: usize, t: f64) -> f64 {
    if d > k { 0.0 } else { (k - d + 1..=k).map(|f| f as f64).product::<f64>() * t.powi((k - d) as i32) }
}

/// Control points of `t^k` over Bernstein degree `n`.
fn bernstein_power(n: usize, k: usize) -> Vec<f64> {
    (0..=n).map(|i| binomial(i, k) / binomial(n, k)).collect()
}

/// Control points of `t^k` over knots (Marsden): mean of the products of `k` of the `degree` knots that a function sees.
fn spline_power(degree: usize, knots: &[f64], k: usize) -> Vec<f64> {
    (0..knots.len() - degree - 1)
        .map(|i| {
            let mut symmetric = vec![0.0; degree + 1];
            symmetric[0] = 1.0;
            for &t in &knots[i + 1..=i + degree] {
                (1..=degree).rev().for_each(|e| symmetric[e] += t * symmetric[e - 1]);
            }
            symmetric[k] / binomial(degree, k)
        })
        .collect()
}

#[test]
fn the_basis_is_its_definition() {
    for n in 0..=MAX_DEGREE {
        for t in [0.0_f64, 0.125, 0.3, 0.5, 0.99, 1.0] {
            let mut out = [0.0; MAX_DEGREE + 1];
            bernstein::values(n, t, &mut out);
            for i in 0..=n {
                let want = binomial(n, i) * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32);
                close(out[i], want, 1e-14, 0.0);
            }
        }
    }
}

#[test]
fn powers_in_the_bernstein_basis_have_their_derivatives() {
    for n in 0..=12 {
        for k in 0..=n {
            let curve = BezierCurve::new(bernstein_power(n, k)).unwrap();
            for t in [0.0, 0.25, 0.7, 1.0] {
                let jet: [f64; 5] = curve.jet(t);
                for d in 0..5 {
                    close(jet[d], power(k, d, t), 1e-13, power(n, d, 1.0));
                }
            }
        }
    }
}

#[test]
fn derivatives_beyond_the_degree_vanish() {
    let line = BezierCurve::new(vec![1.0, 3.0]).unwrap();
    assert_eq!(line.jet::<4>(0.25), [1.5, 2.0, 0.0, 0.0]);
    assert_eq!(line.jet::<0>(0.25), [0.0; 0]);
    let spline = BSplineCurve::new(0, vec![0.0, 1.0, 2.0], vec![5.0, 7.0]).unwrap();
    assert_eq!(spline.jet::<2>(1.0), [7.0, 0.0]);
    assert_eq!(spline.jet::<2>(2.0), [7.0, 0.0]);
    assert_eq!(BezierPatch::new([0, 0], vec![2.0]).unwrap().jet(DVec2::ONE).p, 2.0);
    let constant = BezierTriangle::new(0, vec![2.0]).unwrap();
    assert_eq!(constant.jet([DVec2::ZERO, DVec2::X, DVec2::Y], DVec2::ONE).p, 2.0);
}

#[test]
fn powers_on_patches_have_their_partials() {
    for [m, n] in [[3, 3], [5, 1], [5, 2], [5, 3], [2, 4], [7, 6], [9, 2], [12, 12]] {
        for (k, l) in [(0, 0), (1, 0), (0, 1), (1, 1), (2, 1), (1, 2), (m, n)] {
            if k > m || l > n {
                continue;
            }
            let (a, b) = (bernstein_power(m, k), bernstein_power(n, l));
            let net = a.iter().flat_map(|a| b.iter().map(move |b| a * b)).collect();
            let patch = BezierPatch::new([m, n], net).unwrap();
            let DVec2 { x: u, y: v } = DVec2::new(0.3, 0.8);
            let jet = patch.jet(DVec2::new(u, v));
            let scale = (m * m * n * n + 1) as f64;
            close(jet.p, power(k, 0, u) * power(l, 0, v), 1e-14, scale);
            close(jet.du, power(k, 1, u) * power(l, 0, v), 1e-14, scale);
            close(jet.dv, power(k, 0, u) * power(l, 1, v), 1e-14, scale);
            close(jet.duu, power(k, 2, u) * power(l, 0, v), 1e-14, scale);
            close(jet.duv, power(k, 1, u) * power(l, 1, v), 1e-14, scale);
            close(jet.dvv, power(k, 0, u) * power(l, 2, v), 1e-14, scale);
        }
    }
}

#[test]
fn surface_jets_are_sums_over_both_bases() {
    // Every degree to 9: the unrolled evaluations, the small and the large buffers.
    for (p, q) in (0..10).flat_map(|p| (0..10).map(move |q| (p, q))) {
        let knots = |degree: usize| -> Vec<f64> { (0..3 + 2 * degree + 1).map(|i| (i * i) as f64).collect() };
        let net: Vec<f64> = (0..(3 + p) * (3 + q)).map(|i| (i as f64).sin()).collect();
        let surface = BSplineSurface::new([p, q], [knots(p), knots(q)], net.clone()).unwrap();
        let [lower, upper] = surface.domain();
        let at = lower + (upper - lower) * DVec2::new(0.3, 0.9);
        let basis = |degree: usize, t: f64| {
            let knots = knots(degree);
            let span = bspline::span(degree, &knots, t);
            let mut out = [[0.0; 3]; 10];
            bspline::jets(degree, &knots, span, t, &mut out);
            (span - degree, out)
        };
        let ((i0, bu), (j0, bv)) = (basis(p, at.x), basis(q, at.y));
        let sum = |a: usize, b: usize| -> f64 {
            (0..=p)
                .flat_map(|i| (0..=q).map(move |j| (i, j)))
                .map(|(i, j)| net[(i0 + i) * (3 + q) + j0 + j] * bu[i][a] * bv[j][b])
                .sum()
        };
        let jet = surface.jet(at);
        let got = [jet.p, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
        let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
        for (got, (a, b)) in got.into_iter().zip(orders) {
            close(got, sum(a, b), 1e-14, 1.0);
        }
    }
}

#[test]
fn barycentric_powers_have_their_partials() {
    // ρ^a σ^b τ^c with a + b + c = n is one control point; its partials on a skew triangle by the chain rule.
    let corners = [DVec2::new(0.5, -1.0), DVec2::new(3.0, 0.25), DVec2::new(1.0, 2.0)];
    let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
    for n in 1..=12 {
        for k in 0..=n {
            for j in 0..=n - k {
                let exponents = [n - j - k, j, k];
                let mut net = vec![0.0; (n + 1) * (n + 2) / 2];
                net[BezierTriangle::<f64>::index(n, j, k)] = 1.0;
                let triangle = BezierTriangle::new(n, net).unwrap();
                let w = [0.2, 0.5, 0.3];
                let at = corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
                let ways = binomial(n, k) * binomial(n - k, j);
                // Partial derivative in the three coordinates taken as independent.
                let partial = |orders: [usize; 3]| {
                    ways * (0..3).map(|c| power(exponents[c], orders[c], w[c])).product::<f64>()
                };
                let g = [0, 1, 2].map(|c| {
                    let (a, b) = (corners[(c + 1) % 3], corners[(c + 2) % 3]);
                    DVec2::new(a.y - b.y, b.x - a.x) / area
                });
                let first = |d: [f64; 3]| {
                    d[0] * partial([1, 0, 0]) + d[1] * partial([0, 1, 0]) + d[2] * partial([0, 0, 1])
                };
                let second = |d: [f64; 3], e: [f64; 3]| {
                    let mut sum = 0.0;
                    for (a, x) in d.into_iter().enumerate() {
                        for (b, y) in e.into_iter().enumerate() {
                            let mut orders = [0; 3];
                            orders[a] += 1;
                            orders[b] += 1;
                            sum += x * y * partial(orders);
                        }
                    }
                    sum
                };
                let (gu, gv) = (g.map(|g| g.x), g.map(|g| g.y));
                let jet = triangle.jet(corners, at);
                let want =
                    [partial([0; 3]), first(gu), first(gv), second(gu, gu), second(gu, gv), second(gv, gv)];
                let got = [jet.p, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
                for (got, want) in got.into_iter().zip(want) {
                    close(got, want, 1e-13, (n * n) as f64);
                }
                close(triangle.point(w), want[0], 1e-14, 1.0);
            }
        }
    }
}

#[test]
fn uniform_knots_are_one_product_and_one_sum() {
    let (origin, cell) = (DVec2::new(0.1, -7.3), DVec2::new(0.3, 1e-3));
    let surface = BSplineSurface::uniform([3, 2], origin, cell, [4, 5], vec![1.0; 7 * 7]).unwrap();
    for (i, &k) in surface.knots()[0].iter().enumerate() {
        assert_eq!(k, origin.x + (i as f64 - 3.0) * cell.x);
    }
    assert_eq!(surface.knots().map(<[f64]>::len), [4 + 6 + 1, 5 + 4 + 1]);
    assert_eq!(surface.domain()[0], origin);
    assert!(surface.domain()[1].distance(origin + cell * DVec2::new(4.0, 5.0)) < 1e-14);
    let jet = surface.jet(DVec2::new(0.7, -7.2991));
    close(jet.p, 1.0, 1e-15, 1.0);
    assert!(jet.duu.abs() < 1e-13 && jet.dvv.abs() < 1e-8);
}

#[test]
fn bad_surfaces_are_refused() {
    let uniform = |cell, cells, net: usize| {
        BSplineSurface::uniform([3, 3], DVec2::ZERO, DVec2::splat(cell), cells, vec![0.0; net]).unwrap_err()
    };
    assert_eq!(uniform(1.0, [1, 1], 15), NetError::Count { given: 15, needed: 16 });
    assert!(matches!(uniform(1.0, [usize::MAX, 2], 15), NetError::Count { given: 15, .. }));
    assert_eq!(uniform(1.0, [0, 1], 12), NetError::Knots { index: 3 });
    assert!(matches!(uniform(0.0, [1, 1], 16), NetError::Knots { .. }));
    assert!(matches!(uniform(-1.0, [1, 1], 16), NetError::Knots { .. }));
    assert!(matches!(uniform(f64::NAN, [1, 1], 16), NetError::Knots { .. }));
    let huge = BSplineSurface::new([usize::MAX, 1], [vec![], vec![]], vec![0.0]).unwrap_err();
    assert_eq!(huge, NetError::Degree { degree: usize::MAX });
    assert_eq!(BezierCurve::<f64>::new(vec![]).unwrap_err(), NetError::Count { given: 0, needed: 1 });
    assert_eq!(BezierCurve::new(vec![0.0, f64::NAN]).unwrap_err(), NetError::NotFinite { index: 1 });
}

#[test]
fn parameters_that_are_no_numbers_do_no_harm() {
    let surface =
        BSplineSurface::uniform([3, 3], DVec2::ZERO, DVec2::ONE, [2, 2], vec![DVec3::ONE; 25]).unwrap();
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, f64::MAX] {
        assert!(!surface.jet(DVec2::new(x, 0.5)).finite());
    }
}

proptest! {
    #[test]
    fn spline_bases_sum_to_one_and_are_not_negative(
        (p, knots) in (0..=12_usize).prop_flat_map(|p| (Just(p), knots(p))), x in 0.0..=1.0
    ) {
        bspline::check(p, knots.len() - p - 1, &knots).unwrap();
        let t = at([knots[p], knots[knots.len() - p - 1]], x);
        let span = bspline::span(p, &knots, t);
        prop_assert!(knots[span] < knots[span + 1]);
        prop_assert!(knots[span] <= t && (t < knots[span + 1] || t >= knots[knots.len() - p - 1]));
        let mut out = [[0.0; 3]; 13];
        bspline::jets(p, &knots, span, t, &mut out);
        close(out[..=p].iter().map(|b| b[0]).sum(), 1.0, 1e-14, 1.0);
        prop_assert!(out[..=p].iter().all(|b| b[0] >= -1e-15));
        for d in 1..3 {
            let size = out[..=p].iter().map(|b| b[d].abs()).sum::<f64>();
            close(out[..=p].iter().map(|b| b[d]).sum(), 0.0, 1e-13, size);
        }
    }

    #[test]
    fn every_span_is_the_one_of_a_plain_search(
        (p, knots) in (0..=5_usize).prop_flat_map(|p| (Just(p), knots(p))), x in -0.5..=1.5, knot in 0..30_usize
    ) {
        let count = knots.len() - p - 1;
        for t in [at([knots[p], knots[count]], x), knots[knot % knots.len()]] {
            let pieces: Vec<usize> = (p..count).filter(|&k| knots[k] < knots[k + 1]).collect();
            let want = pieces.iter().rev().find(|&&k| knots[k] <= t).unwrap_or(&pieces[0]);
            prop_assert_eq!(bspline::span(p, &knots, t), *want);
        }
    }

    #[test]
    fn powers_over_random_knots_have_their_derivatives(
        (p, knots) in (0..=12_usize).prop_flat_map(|p| (Just(p), knots(p))), x in 0.0..=1.0
    ) {
        // Centred and scaled: powers of large parameters say more about rounding than about the basis.
        let count = knots.len() - p - 1;
        let (a, width) = (knots[p], knots[count] - knots[p]);
        let knots: Vec<f64> = knots.iter().map(|k| (k - a) / width).collect();
        // Differences over the smallest interval amplify rounding.
        let step = knots.windows(2).map(|w| w[1] - w[0]).filter(|&w| w > 0.0).fold(1.0, f64::min);
        for k in 0..=p.min(4) {
            let curve = BSplineCurve::new(p, knots.clone(), spline_power(p, &knots, k)).unwrap();
            let jet: [f64; 3] = curve.jet(x);
            for d in 0..3 {
                let scale = (p as f64 / step).powi(d as i32) * curve.net().iter().fold(1.0, |m, c| c.abs().max(m));
                close(jet[d], power(k, d, x), 1e-14, 4.0 * scale);
            }
        }
    }

    #[test]
    fn points_are_the_bits_of_jets(
        c in curve(12), s in spline(12), p in patch(12), q in surface(6), x in 0.0..=1.0, y in 0.0..=1.0
    ) {
        prop_assert_eq!(c.point(x), c.jet::<3>(x)[0]);
        let t = at(s.domain(), x);
        prop_assert_eq!(s.point(t), s.jet::<3>(t)[0]);
        prop_assert_eq!(p.point(DVec2::new(x, y)), p.jet(DVec2::new(x, y)).p);
        let [lower, upper] = q.domain();
        let uv = lower + (upper - lower) * DVec2::new(x, y);
        prop_assert_eq!(q.point(uv), q.jet(uv).p);
    }

    #[test]
    fn ends_and_corners_are_interpolated_to_the_bit(c in curve(12), p in patch(12), t in triangle(12)) {
        prop_assert_eq!(c.point(0.0), c.net()[0]);
        prop_assert_eq!(c.point(1.0), *c.net().last().unwrap());
        let [m, n] = p.degree();
        for (i, j) in [(0, 0), (0, n), (m, 0), (m, n)] {
            let uv = DVec2::new(f64::from(u8::from(i > 0)), f64::from(u8::from(j > 0)));
            prop_assert_eq!(p.jet(uv).p, p.net()[i * (n + 1) + j]);
        }
        let n = t.degree();
        for (w, (j, k)) in [([1.0, 0.0, 0.0], (0, 0)), ([0.0, 1.0, 0.0], (n, 0)), ([0.0, 0.0, 1.0], (0, n))] {
            prop_assert_eq!(t.point(w), t.net()[BezierTriangle::<DVec3>::index(n, j, k)]);
        }
    }

    #[test]
    fn clamped_ends_are_interpolated_to_the_bit(s in spline(12)) {
        let (p, count) = (s.degree(), s.net().len());
        let mut knots = s.knots().to_vec();
        let [a, b] = s.domain();
        knots[..p].fill(a);
        knots[count..].fill(b);
        let clamped = BSplineCurve::new(p, knots, s.net().to_vec()).unwrap();
        prop_assert_eq!(clamped.point(a), s.net()[0]);
        prop_assert_eq!(clamped.point(b), s.net()[count - 1]);
    }

    #[test]
    fn affine_maps_commute_with_evaluation(
        p in patch(12), q in surface(6), t in triangle(12), x in 0.0..=1.0, y in 0.0..=1.0, w in barycentric(),
        m in prop::array::uniform9(-1.0..1.0), shift in common::point(),
    ) {
        let map = DAffine3::from_mat3_translation(DMat3::from_cols_array(&m), shift);
        let moved = |net: &[DVec3]| net.iter().map(|&p| map.transform_point3(p)).collect::<Vec<_>>();
        let uv = DVec2::new(x, y);
        let image = BezierPatch::new(p.degree(), moved(p.net())).unwrap();
        near(image.point(uv), map.transform_point3(p.point(uv)), 1e-13);
        let image = BSplineSurface::new(q.degree(), q.knots().map(<[f64]>::to_vec), moved(q.net())).unwrap();
        let [lower, upper] = q.domain();
        let at = lower + (upper - lower) * uv;
        near(image.point(at), map.transform_point3(q.point(at)), 1e-13);
        let image = BezierTriangle::new(t.degree(), moved(t.net())).unwrap();
        near(image.point(w), map.transform_point3(t.point(w)), 1e-13);
    }

    #[test]
    fn powers_of_two_scale_every_bit(q in surface(4), x in 0.0..=1.0, y in 0.0..=1.0, e in -20..=20_i32) {
        let scale = 2.0_f64.powi(e);
        let [lower, upper] = q.domain();
        let at = lower + (upper - lower) * DVec2::new(x, y);
        let net = q.net().iter().map(|&p| p * scale).collect();
        let knots = q.knots().map(|k| k.iter().map(|k| k * scale).collect());
        let scaled = BSplineSurface::new(q.degree(), knots, net).unwrap().jet(at * scale);
        let jet = q.jet(at);
        prop_assert_eq!(scaled.p, jet.p * scale);
        prop_assert_eq!(scaled.du, jet.du);
        prop_assert_eq!(scaled.duv, jet.duv / scale);
    }
}
