//! Integrals against known rationals and against each other.

mod common;

use common::{close, knots, near, patch, spline, surface, triangle};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use suture_bernstein::bernstein::product_integral;
use suture_bernstein::{
    Axis, BSplineSurface, BezierCurve, BezierTriangle, Gram, NetError, span_gram, triangle_product_integral,
};

fn unit(n: usize, i: usize) -> Vec<f64> {
    (0..n).map(|k| f64::from(u8::from(k == i))).collect()
}

#[test]
fn integrals_of_bernstein_products_are_those_of_the_product_nets() {
    for (m, n) in [(0, 0), (1, 3), (5, 2), (12, 12)] {
        for i in 0..=m {
            for j in 0..=n {
                let (a, b) =
                    (BezierCurve::new(unit(m + 1, i)).unwrap(), BezierCurve::new(unit(n + 1, j)).unwrap());
                let want = a.product(&b, |a, b| a * b).unwrap().integral();
                close(product_integral(m, i, n, j), want, 1e-15, 0.0);
            }
        }
    }
}

#[test]
fn integrals_of_triangle_products_are_those_of_the_product_nets() {
    // Area 1: the mean of linear coordinates squared is 1/6, of two different ones 1/12.
    assert_eq!(triangle_product_integral([1, 0, 0], [1, 0, 0]), 1.0 / 6.0);
    assert_eq!(triangle_product_integral([1, 0, 0], [0, 0, 1]), 1.0 / 12.0);
    let corners = [DVec2::ZERO, DVec2::X * 2.0, DVec2::Y];
    let entries = |n: usize| (0..=n).flat_map(move |k| (0..=n - k).map(move |j| [n - j - k, j, k]));
    let single = |[i, j, k]: [usize; 3]| {
        let n = i + j + k;
        let net = unit((n + 1) * (n + 2) / 2, BezierTriangle::<f64>::index(n, j, k));
        BezierTriangle::new(n, net).unwrap()
    };
    for a in entries(3) {
        for b in entries(4) {
            let want = single(a).product(&single(b), |a, b| a * b).unwrap().integral(corners);
            close(triangle_product_integral(a, b), want, 1e-15, 0.0);
        }
    }
}

#[test]
fn the_cubic_gram_matrices_are_the_published_ones() {
    // Uniform cubic B-splines, unit knots, inner rows: classical finite-element values.
    let knots: Vec<f64> = (0..24).map(f64::from).collect();
    let rows: [([usize; 2], [f64; 4]); 3] = [
        ([0, 0], [2416.0 / 5040.0, 1191.0 / 5040.0, 120.0 / 5040.0, 1.0 / 5040.0]),
        ([1, 1], [80.0 / 120.0, -15.0 / 120.0, -24.0 / 120.0, -1.0 / 120.0]),
        ([2, 2], [16.0 / 6.0, -9.0 / 6.0, 0.0, 1.0 / 6.0]),
    ];
    for (orders, want) in rows {
        let gram = Gram::new(3, &knots, orders).unwrap();
        assert_eq!((gram.count(), gram.bandwidth()), (20, 3));
        for (distance, want) in want.into_iter().enumerate() {
            close(gram.get(10, 10 + distance), want, 1e-14, 1.0);
            close(gram.get(10 + distance, 10), want, 1e-14, 1.0);
        }
        assert_eq!(gram.get(10, 14), 0.0);
        assert_eq!(gram.get(10, 99), 0.0);
        assert_eq!(gram.row(1).map(|(j, _)| j).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
    }
    // The energy matrix of one cell, third differences: ∫ b‴ b‴ᵀ of the outer product of (−1, 3, −3, 1).
    let mut cell = [0.0; 16];
    span_gram(3, &knots, 5, [3, 3], &mut cell);
    let third = [-1.0, 3.0, -3.0, 1.0];
    for i in 0..4 {
        for j in 0..4 {
            close(cell[i * 4 + j], third[i] * third[j], 1e-14, 1.0);
        }
    }
}

#[test]
fn orders_beyond_the_degree_integrate_to_zero() {
    let knots = [0.0, 0.0, 1.0, 1.0];
    for orders in [[2, 0], [0, 2], [usize::MAX, usize::MAX]] {
        let gram = Gram::new(1, &knots, orders).unwrap();
        assert!((0..2).all(|i| gram.row(i).all(|(_, g)| g == 0.0)));
    }
    assert_eq!(Gram::new(3, &knots, [0, 0]).unwrap_err(), NetError::Count { given: 4, needed: 8 });
    assert!(Gram::new(usize::MAX, &[], [0, 0]).is_err());
}

proptest! {
    #[test]
    fn mass_matrices_sum_to_the_domain(
        (p, knots) in (0..=12_usize).prop_flat_map(|p| (Just(p), knots(p))), orders in prop::array::uniform2(0..3_usize)
    ) {
        let gram = Gram::new(p, &knots, orders).unwrap();
        let transposed = Gram::new(p, &knots, [orders[1], orders[0]]).unwrap();
        let (mut sum, mut size) = (0.0, 0.0);
        for i in 0..gram.count() {
            for (j, g) in gram.row(i) {
                sum += g;
                size += g.abs();
                prop_assert_eq!(g, transposed.get(j, i));
            }
        }
        // The functions sum to one, their derivatives to zero.
        let want = if orders == [0, 0] { knots[knots.len() - p - 1] - knots[p] } else { 0.0 };
        close(sum, want, 1e-13, size);
    }

    #[test]
    fn spline_integrals_are_the_sums_of_their_pieces(s in spline(12), q in surface(5)) {
        let pieces = s.extract();
        let want = pieces.iter().map(|([a, b], c)| c.integral() * (b - a)).sum::<DVec3>();
        near(s.integral(), want, 1e-13);
        let want = q.extract().iter().map(|([a, b], p)| p.integral() * (b - a).element_product()).sum::<DVec3>();
        near(q.integral(), want, 1e-12);
    }

    #[test]
    fn integrals_of_derivatives_are_differences(p in patch(12), t in triangle(12)) {
        let by_parts = p.derivative(Axis::U).unwrap().derivative(Axis::V).unwrap().integral();
        let corner = |u, v| p.point(DVec2::new(u, v));
        near(by_parts, corner(1.0, 1.0) - corner(1.0, 0.0) - corner(0.0, 1.0) + corner(0.0, 0.0), 1e-12);
        // Gauss's theorem for ∂/∂x on the triangle with corners 0, X, Y.
        let inside = t.derivative([-1.0, 1.0, 0.0]).unwrap().integral([DVec2::ZERO, DVec2::X, DVec2::Y]);
        near(inside, t.border(0).integral() - t.border(1).integral(), 1e-12);
    }

    #[test]
    fn gram_matrices_are_the_energy_of_splines(q in surface(4)) {
        // ∫∫ |S_u|² by the Gram matrices against the integral of the product of the pieces' hodographs.
        let [p, n] = q.degree();
        let (gu, gv) = (Gram::new(p, q.knots()[0], [1, 1]).unwrap(), Gram::new(n, q.knots()[1], [0, 0]).unwrap());
        let columns = q.count()[1];
        let mut energy = 0.0;
        for i in 0..gu.count() {
            for (k, a) in gu.row(i) {
                for j in 0..gv.count() {
                    for (l, b) in gv.row(j) {
                        energy += a * b * q.net()[i * columns + j].dot(q.net()[k * columns + l]);
                    }
                }
            }
        }
        let want: f64 = q.extract().iter().map(|([lower, upper], patch)| {
            let size = upper - lower;
            let du = patch.derivative(Axis::U).unwrap();
            du.product(&du, DVec3::dot).unwrap().integral() * size.y / size.x
        }).sum();
        close(energy, want, 1e-11, 1.0);
    }
}

#[test]
fn uniform_surfaces_of_one_integrate_to_their_area() {
    let surface =
        BSplineSurface::uniform([3, 3], DVec2::ZERO, DVec2::new(0.5, 0.25), [4, 8], vec![1.0; 7 * 11])
            .unwrap();
    close(surface.integral(), 4.0, 1e-14, 1.0);
}
