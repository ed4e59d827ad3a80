//! What holds for all surfaces: reproduction, affine invariance, exchange of the sides.

mod common;

use std::sync::Arc;

use common::{Border, Sheet, blends, entries};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use proptest::prelude::*;
use suture_bernstein::BSplineSurface;
use suture_coons::{
    BlendFunction, Constituent, Family, FillOptions, FourSided, Map, Mapped, Order, Spline, ThreeSided,
    border_curves, curve_fn,
};
use suture_surface::{Jet2, Patch};

fn spline(net: &[DVec3]) -> Arc<BSplineSurface<DVec3>> {
    Arc::new(BSplineSurface::uniform([3, 3], DVec2::ZERO, DVec2::splat(0.5), [2, 2], net.to_vec()).unwrap())
}

fn net() -> impl Strategy<Value = Vec<DVec3>> {
    prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 25).prop_map(|rough| {
        let place = |i: usize| DVec3::new((i / 5) as f64, (i % 5) as f64, 0.0);
        rough.into_iter().enumerate().map(|(i, x)| place(i) + DVec3::from(x) * 0.7).collect()
    })
}

fn family() -> impl Strategy<Value = Family> {
    prop::sample::select(vec![
        Family::Polynomial,
        Family::Trigonometric,
        Family::Rational,
        Family::SymmetricRational,
    ])
}

fn order() -> impl Strategy<Value = Order> {
    prop::sample::select(vec![Order::C0, Order::C1, Order::C2, Order::C3])
}

fn sheet(s: &Arc<BSplineSurface<DVec3>>) -> Sheet {
    Arc::new(Spline(Arc::clone(s)))
}

fn mapped(inner: Sheet, map: Map) -> Sheet {
    Arc::new(Mapped { inner, map })
}

#[track_caller]
fn same(a: &Jet2, b: &Jet2, tolerance: f64) {
    for (x, y) in entries(a).into_iter().zip(entries(b)) {
        assert!(x.distance(y) <= tolerance * (1.0 + y.length()), "{a:?} ≠ {b:?}");
    }
}

fn place() -> impl Strategy<Value = DVec2> {
    (0.0..=1.0f64, 0.0..=1.0f64).prop_map(|(u, v)| DVec2::new(u, v))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_same_surface_twice_is_reproduced(net in net(), family in family(), k in 0..4usize, at in place()) {
        let r = sheet(&spline(&net));
        let b = family.flat(k);
        let border = |u: f64| -> Border {
            let r = Arc::clone(&r);
            curve_fn(move |v| {
                let j = r.jet(DVec2::new(u, v));
                [j.p, j.dv, j.dvv]
            })
        };
        let four = FourSided::raw([Arc::clone(&r), Arc::clone(&r)], [border(0.0), border(1.0)], blends(b, b));
        same(&four.jet(at), &r.jet(at), 1e-11);
        let three = ThreeSided::raw([Arc::clone(&r), Arc::clone(&r), Arc::clone(&r)], blends(b, b));
        same(&three.jet(at), &r.jet(at), 1e-11);
    }

    #[test]
    fn fills_join_as_asked(a in net(), b in net(), family in family(), order in order()) {
        let r = [sheet(&spline(&a)), sheet(&spline(&b))];
        let borders = border_curves(&r, order).unwrap();
        let fill = FourSided::fill(r.clone(), borders, &FillOptions { order, family, ..Default::default() }).unwrap();
        let k = order.derivatives();
        prop_assert_eq!(fill.certificate.reached, Some(order));
        let proven = fill.certificate.proven_jumps.as_ref().unwrap();
        // Interval arithmetic overestimates, and yet keeps what is measured below.
        let limits = [1e-14, 1e-13, 1e-12, 1e-11];
        for n in 0..=k {
            // The proof is of the surfaces themselves; what machine numbers see may have rounding on top.
            prop_assert!(fill.certificate.jumps[n] < limits[n] && proven[n] < limits[n], "{:?}", proven);
        }
        for i in 0..=8 {
            for (edge, r) in r.iter().enumerate() {
                let at = DVec2::new(f64::from(i) / 8.0, edge as f64);
                let (f, g) = (entries(&fill.patch.jet(at)), entries(&r.jet(at)));
                let orders = [0, 1, 1, 2, 2, 2];
                for x in (0..6).filter(|&x| orders[x] <= k) {
                    let size = f[x].distance(g[x]) / fill.certificate.diagonal;
                    prop_assert!(size <= [1e-14, 1e-13, 1e-12][orders[x]], "{x}: {size}");
                }
            }
        }
    }

    #[test]
    fn fills_follow_affine_maps(
        a in net(), b in net(), order in order(), at in place(),
        m in prop::array::uniform9(-1.0..1.0f64), t in prop::array::uniform3(-9.0..9.0f64), exponent in -20..=20i32,
    ) {
        let map = DAffine3::from_mat3_translation(DMat3::from_cols_array(&m), DVec3::from(t));
        let scale = 2f64.powi(exponent);
        let moved = |net: &[DVec3]| net.iter().map(|p| map.transform_point3(*p) * scale).collect::<Vec<_>>();
        let make = |a: &[DVec3], b: &[DVec3]| {
            let r = [sheet(&spline(a)), sheet(&spline(b))];
            let borders = border_curves(&r, order).unwrap();
            FourSided::fill(r, borders, &FillOptions { order, ..Default::default() }).unwrap().patch
        };
        let (f, g) = (make(&a, &b).jet(at), make(&moved(&a), &moved(&b)).jet(at));
        let image = Jet2 { p: map.transform_point3(f.p), ..f.map(|d| map.transform_vector3(d)) };
        same(&g.map(|d| d * scale.recip()), &image, 1e-11);
    }

    #[test]
    fn sides_may_be_exchanged(a in net(), b in net(), k in 0..4u8, at in place()) {
        // Every symmetric family: β(1 − t) = 1 − β(t).
        for blend in [BlendFunction::Polynomial(k), BlendFunction::Trigonometric(k), BlendFunction::SymmetricRational(k)] {
            let r = [sheet(&spline(&a)), sheet(&spline(&b))];
            let borders = border_curves(&r, Order::C2).unwrap();
            let fill = FourSided::raw(r.clone(), borders.clone(), blends(blend, blend));
            // u ↔ 1 − u.
            let turn = Map::Affine { origin: DVec2::X, u: -DVec2::X, v: DVec2::Y };
            let turned = FourSided::raw(
                r.clone().map(|r| mapped(r, turn)),
                [Arc::clone(&borders[1]), Arc::clone(&borders[0])],
                blends(blend, blend),
            );
            let there = turned.jet(DVec2::new(1.0 - at.x, at.y));
            same(&Jet2 { du: -there.du, duv: -there.duv, ..there }, &fill.jet(at), 1e-10);
            // v ↔ 1 − v.
            let turn = Map::Affine { origin: DVec2::Y, u: DVec2::X, v: -DVec2::Y };
            let back = |c: &Border| -> Border {
                let c = Arc::clone(c);
                curve_fn(move |v| {
                    let [p, d, dd] = c.jet(1.0 - v);
                    [p, -d, dd]
                })
            };
            let turned = FourSided::raw(
                [mapped(Arc::clone(&r[1]), turn), mapped(Arc::clone(&r[0]), turn)],
                [back(&borders[0]), back(&borders[1])],
                blends(blend, blend),
            );
            let there = turned.jet(DVec2::new(at.x, 1.0 - at.y));
            same(&Jet2 { dv: -there.dv, duv: -there.duv, ..there }, &fill.jet(at), 1e-10);
        }
    }
}
