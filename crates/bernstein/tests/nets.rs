//! Operations on nets leave the polynomial as it is, or make the one they promise.

mod common;

use common::{at, barycentric, curve, near, patch, spline, surface, triangle};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use suture_bernstein::{
    Axis, BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle, MAX_DEGREE, NetError,
};

/// The barycentric point with coordinates `w` with respect to `corners`.
fn mix(corners: [[f64; 3]; 3], w: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| (0..3).map(|i| w[i] * corners[i][c]).sum())
}

proptest! {
    #[test]
    fn splitting_and_restricting_curves(c in curve(12), t in 0.0..=1.0, s in 0.0..=1.0, x in 0.0..=1.0) {
        let [left, right] = c.split(t).unwrap();
        near(left.point(x), c.point(x * t), 1e-14);
        near(right.point(x), c.point(t + x * (1.0 - t)), 1e-14);
        prop_assert_eq!(left.net()[c.degree()], right.net()[0]);
        let part = c.restrict([t, s]).unwrap();
        near(part.point(x), c.point(at([t, s], x)), 1e-14);
    }

    #[test]
    fn splitting_and_restricting_patches(p in patch(12), t in 0.0..=1.0, s in 0.0..=1.0, x in 0.0..=1.0, y in 0.0..=1.0) {
        for axis in Axis::BOTH {
            let (other, d) = (DVec2::splat(y), axis.index());
            let uv = |along: f64| { let mut uv = other; uv[d] = along; uv };
            let [lower, upper] = p.split(axis, t).unwrap();
            near(lower.point(uv(x)), p.point(uv(x * t)), 1e-14);
            near(upper.point(uv(x)), p.point(uv(t + x * (1.0 - t))), 1e-14);
            prop_assert_eq!(lower.point(uv(1.0)), upper.point(uv(0.0)));
            near(p.restrict(axis, [t, s]).unwrap().point(uv(x)), p.point(uv(at([t, s], x))), 1e-14);
        }
    }

    #[test]
    fn restricting_triangles(t in triangle(9), a in barycentric(), b in barycentric(), c in barycentric(), w in barycentric()) {
        let part = t.restrict([a, b, c]).unwrap();
        near(part.point(w), t.point(mix([a, b, c], w)), 1e-14);
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        prop_assert_eq!(&t.restrict(unit).unwrap(), &t);
    }

    #[test]
    fn borders_of_triangles(t in triangle(12), x in 0.0..=1.0) {
        let y = 1.0 - x;
        near(t.border(0).point(x), t.point([0.0, y, x]), 1e-14);
        near(t.border(1).point(x), t.point([x, 0.0, y]), 1e-14);
        near(t.border(2).point(x), t.point([y, x, 0.0]), 1e-14);
    }

    #[test]
    fn elevation_changes_nothing(c in curve(12), p in patch(9), t in triangle(9), by in 0..=5_usize, x in 0.0..=1.0, w in barycentric()) {
        let high = c.elevate(by).unwrap();
        prop_assert_eq!(high.degree(), c.degree() + by);
        near(high.point(x), c.point(x), 1e-14);
        prop_assert_eq!(high.point(1.0), c.point(1.0));
        let uv = DVec2::new(x, w[0]);
        for axis in Axis::BOTH {
            near(p.elevate(axis, by).unwrap().point(uv), p.point(uv), 1e-14);
        }
        near(t.elevate(by).unwrap().point(w), t.point(w), 1e-14);
    }

    #[test]
    fn hodographs_are_derivatives(c in curve(12), p in patch(12), t in triangle(12), x in 0.0..=1.0, w in barycentric()) {
        near(c.derivative().unwrap().point(x), c.jet::<2>(x)[1], 1e-12);
        let uv = DVec2::new(x, w[1]);
        let jet = p.jet(uv);
        let [du, dv] = Axis::BOTH.map(|axis| p.derivative(axis).unwrap());
        near(du.point(uv), jet.du, 1e-12);
        near(dv.point(uv), jet.dv, 1e-12);
        near(du.derivative(Axis::V).unwrap().point(uv), jet.duv, 1e-10);
        let at = DVec2::new(w[1], w[2]);
        let jet = t.jet([DVec2::ZERO, DVec2::X, DVec2::Y], at);
        let (du, dv) = (t.derivative([-1.0, 1.0, 0.0]).unwrap(), t.derivative([-1.0, 0.0, 1.0]).unwrap());
        near(du.point(w), jet.du, 1e-12);
        near(dv.point(w), jet.dv, 1e-12);
        near(dv.derivative([-1.0, 0.0, 1.0]).unwrap().point(w), jet.dvv, 1e-10);
    }

    #[test]
    fn spline_hodographs_are_derivatives(s in spline(12), q in surface(5), x in 0.0..=1.0, y in 0.0..=1.0) {
        let t = at(s.domain(), x);
        // Random intervals down to 0.1, degree 12: derivatives as large as 240.
        near(s.derivative().unwrap().point(t), s.jet::<2>(t)[1], 1e-11);
        let [lower, upper] = q.domain();
        let uv = lower + (upper - lower) * DVec2::new(x, y);
        let jet = q.jet(uv);
        let [du, dv] = Axis::BOTH.map(|axis| q.derivative(axis).unwrap());
        near(du.point(uv), jet.du, 1e-11);
        near(dv.point(uv), jet.dv, 1e-11);
        near(du.derivative(Axis::V).unwrap().point(uv), jet.duv, 1e-10);
        near(du.derivative(Axis::U).unwrap().point(uv), jet.duu, 1e-10);
    }

    #[test]
    fn knot_insertion_changes_nothing(
        s in spline(12), q in surface(5), new in prop::collection::vec(0.0..=1.0, 1..5), x in 0.0..=1.0, y in 0.0..=1.0
    ) {
        let finer: Vec<f64> = new.iter().map(|&n| at(s.domain(), n)).collect();
        let t = at(s.domain(), x);
        let fine = s.insert(&finer).unwrap();
        prop_assert_eq!(fine.net().len(), s.net().len() + new.len());
        prop_assert_eq!(fine.domain(), s.domain());
        near(fine.point(t), s.point(t), 1e-13);
        let [lower, upper] = q.domain();
        let uv = lower + (upper - lower) * DVec2::new(x, y);
        for axis in Axis::BOTH {
            let d = axis.index();
            let finer: Vec<f64> = new.iter().map(|&n| at([lower[d], upper[d]], n)).collect();
            let fine = q.insert(axis, &finer).unwrap();
            prop_assert_eq!(fine.domain(), q.domain());
            near(fine.point(uv), q.point(uv), 1e-13);
            near(fine.jet(uv).du, q.jet(uv).du, 1e-9);
        }
    }

    #[test]
    fn knots_of_the_domain_can_be_filled_up(s in spline(6), x in 0.0..=1.0) {
        let mut full = s.clone();
        let knots: Vec<f64> = s.knots().to_vec();
        for k in knots {
            while let Ok(finer) = full.insert(&[k]) {
                full = finer;
                prop_assert!(full.net().len() < 1000);
            }
        }
        let t = at(s.domain(), x);
        near(full.point(t), s.point(t), 1e-13);
        // Full at both ends: clamped, and the net interpolates.
        let at_end = full.knots().iter().filter(|&&k| k == s.domain()[1]).count();
        prop_assert_eq!(at_end, s.degree() + 1);
    }

    #[test]
    fn extraction_agrees_with_the_spline(s in spline(12), x in 0.0..=1.0) {
        let pieces = s.extract();
        prop_assert_eq!(pieces[0].0[0], s.domain()[0]);
        prop_assert_eq!(pieces[pieces.len() - 1].0[1], s.domain()[1]);
        for (interval, piece) in &pieces {
            let t = at(*interval, x);
            let want: [DVec3; 2] = if t < interval[1] { s.jet(t) } else { piece.jet::<2>(1.0).map(|p| p) };
            near(piece.point(x), want[0], 1e-13);
        }
        for w in pieces.windows(2) {
            prop_assert_eq!(w[0].0[1], w[1].0[0]);
            let multiplicity = s.knots().iter().filter(|&&k| k == w[0].0[1]).count();
            if multiplicity <= s.degree() {
                prop_assert_eq!(w[0].1.net().last(), w[1].1.net().first());
            }
        }
    }

    #[test]
    fn extraction_agrees_with_the_surface(q in surface(5), x in 0.0..0.999, y in 0.0..0.999) {
        let grid = q.extract();
        let [rows, columns] = grid.cells();
        prop_assert_eq!(grid.iter().count(), rows * columns);
        prop_assert!(grid.get([rows, 0]).is_none() && grid.get([0, columns]).is_none());
        for ([lower, upper], patch) in grid.iter() {
            let local = DVec2::new(x, y);
            let (got, want) = (patch.jet(local), q.jet(lower + (upper - lower) * local));
            near(got.p, want.p, 1e-13);
            near(got.du / (upper.x - lower.x), want.du, 1e-10);
            near(got.dvv / (upper.y - lower.y).powi(2), want.dvv, 1e-8);
        }
        // Neighbours share the bits of their common border wherever the surface is continuous.
        let [p, n] = q.degree();
        for i in 1..rows {
            let line = grid.breaks()[0][i];
            if q.knots()[0].iter().filter(|&&k| k == line).count() <= p {
                for j in 0..columns {
                    let (below, above) = (grid.get([i - 1, j]).unwrap().1, grid.get([i, j]).unwrap().1);
                    prop_assert_eq!(&below.net()[p * (n + 1)..], &above.net()[..n + 1]);
                }
            }
        }
    }

    #[test]
    fn products_are_products(
        (a, b) in (curve(12), curve(12)), (p, q) in (patch(5), patch(5)), (s, t) in (triangle(6), triangle(6)),
        x in 0.0..=1.0, w in barycentric()
    ) {
        near(a.product(&b, DVec3::cross).unwrap().point(x), a.point(x).cross(b.point(x)), 1e-14);
        let uv = DVec2::new(x, w[0]);
        let dot = p.product(&q, DVec3::dot).unwrap();
        prop_assert!((dot.point(uv) - p.point(uv).dot(q.point(uv))).abs() < 1e-14);
        let scaled = p.product(&dot, |p, w| p * w).unwrap();
        near(scaled.point(uv), p.point(uv) * dot.point(uv), 1e-14);
        near(s.product(&t, DVec3::cross).unwrap().point(w), s.point(w).cross(t.point(w)), 1e-14);
    }
}

#[test]
fn what_cannot_be_done_is_refused() {
    let net = |n: usize| vec![1.0; n];
    let high = BezierCurve::new(net(MAX_DEGREE + 1)).unwrap();
    assert_eq!(high.elevate(1).unwrap_err(), NetError::Degree { degree: 32 });
    assert_eq!(high.elevate(usize::MAX).unwrap_err(), NetError::Degree { degree: usize::MAX });
    assert_eq!(high.product(&high, |a, b| a * b).unwrap_err(), NetError::Degree { degree: 62 });
    assert!(matches!(high.split(f64::NAN), Err(NetError::NotFinite { .. })));
    assert!(matches!(high.restrict([0.0, f64::INFINITY]), Err(NetError::NotFinite { .. })));
    let patch = BezierPatch::new([31, 1], net(64)).unwrap();
    assert_eq!(patch.elevate(Axis::U, 1).unwrap_err(), NetError::Degree { degree: 32 });
    assert!(patch.elevate(Axis::V, 30).is_ok());
    let triangle = BezierTriangle::new(31, net(528)).unwrap();
    assert_eq!(triangle.elevate(1).unwrap_err(), NetError::Degree { degree: 32 });
    assert!(triangle.restrict([[f64::NAN; 3]; 3]).is_err());
    assert!(matches!(
        BezierCurve::new(vec![f64::MAX, -f64::MAX]).unwrap().derivative(),
        Err(NetError::NotFinite { index: 0 })
    ));
    let knots = vec![0.0, 0.0, 1.0, 2.0, 2.0];
    let spline = BSplineCurve::new(1, knots.clone(), net(3)).unwrap();
    let refused = |knot, multiplicity| NetError::Insertion { knot, domain: [0.0, 2.0], multiplicity };
    assert_eq!(spline.insert(&[2.5]).unwrap_err(), refused(2.5, 0));
    assert_eq!(spline.insert(&[2.0]).unwrap_err(), refused(2.0, 2));
    assert!(matches!(spline.insert(&[f64::NAN]), Err(NetError::Insertion { .. })));
    assert_eq!(spline.insert(&[1.0, 1.0]).unwrap_err(), refused(1.0, 2));
    let surface = BSplineSurface::new([1, 1], [knots.clone(), knots], net(9)).unwrap();
    assert_eq!(surface.insert(Axis::V, &[-1.0]).unwrap_err(), refused(-1.0, 0));
}

#[test]
fn a_triangle_subdivides_at_a_point_without_gaps() {
    let net = (0..15).map(|i| DVec3::new((i as f64).sin(), (i as f64).cos(), i as f64)).collect();
    let triangle = BezierTriangle::new(4, net).unwrap();
    let e = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let x = [0.25, 0.25, 0.5];
    let [a, b, c] =
        [[x, e[1], e[2]], [e[0], x, e[2]], [e[0], e[1], x]].map(|w| triangle.restrict(w).unwrap());
    for (t, opposite) in [(&a, 0), (&b, 1), (&c, 2)] {
        assert_eq!(t.border(opposite), triangle.border(opposite));
    }
    for (got, want) in b.border(0).net().iter().zip(a.border(1).net().iter().rev()) {
        near(*got, *want, 1e-14);
    }
    near(c.point([0.0, 0.0, 1.0]), triangle.point(x), 1e-15);
}
