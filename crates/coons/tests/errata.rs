//! Every erratum of the specification as a test with its negative control.

mod common;

use std::f64::consts::PI;
use std::sync::Arc;

use common::{Case, Sheet, blends, case_a, case_a_borders, case_a_sheets, edge_maxima};
use glam::{DVec2, DVec3};
use suture_coons::{
    Analytic, Blend, BlendFunction, BlendFunction::*, CoonsError, CurveData, FillOptions, FourSided, Map,
    Mapped, Order, Shape, ThreeSided, border_curves, constituent_fn, curve_fn, remark_2,
};
use suture_surface::{Jet2, Patch};

/// Maxima of |f − r| and the five partials along v = 0 and v = 1.
fn both_edges(fill: &FourSided, r: &[Sheet; 2], n: u32) -> [[f64; 6]; 2] {
    [0, 1].map(|k: usize| edge_maxima(&|at| fill.jet(at), &|at| r[k].jet(at), |u| DVec2::new(u, k as f64), n))
}

#[track_caller]
fn near(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance * (1.0 + want.abs()), "{got} ≠ {want}");
}

/// E1: the printed s is right and all six jets agree; scaled to s″ = 1 it leaves 1 − 2/π² of what no correction leaves.
#[test]
fn e1_the_printed_correction_is_right_and_its_proof_is_not() {
    let r = case_a_sheets();
    let good = both_edges(&case_a(Trigonometric(1), Trigonometric(2)), &r, 400);
    assert!(good.iter().flatten().all(|d| *d < 2e-13), "{good:?}");
    let none = both_edges(&case_a(Trigonometric(1), Trigonometric(1)), &r, 400);
    let scaled = both_edges(&case_a(Trigonometric(1), TrigonometricScaled), &r, 400);
    for k in 0..2 {
        assert!(none[k][..5].iter().chain(&scaled[k][..5]).all(|d| *d < 2e-13));
        assert!(none[k][5] > 0.1);
        near(scaled[k][5] / none[k][5], 1.0 - 2.0 / (PI * PI), 1e-10);
    }
}

/// E2: the printed s on the rational form leaves 0.1448 and 0.2175; its own correction leaves nothing.
#[test]
fn e2_the_rational_form_needs_a_correction_of_its_own() {
    let r = case_a_sheets();
    let bad = both_edges(&case_a(Rational(1), RationalAsPrinted), &r, 4000);
    near(bad[0][5], 0.144772142000, 1e-6);
    near(bad[1][5], 0.217547712414, 1e-6);
    let good = both_edges(&case_a(Rational(1), Rational(2)), &r, 400);
    assert!(good.iter().flatten().all(|d| *d < 2e-13), "{good:?}");
    let largest = (0..=100_000).map(|i| RationalAsPrinted.jet(f64::from(i) / 1e5)[0]).fold(0.0, f64::max);
    near(largest, 1.001988146591, 1e-9);
    // A fill that asks for C² does not take it.
    let borders = case_a_borders();
    let e = FourSided::fill_with(r, borders, blends(Rational(2), RationalAsPrinted), &FillOptions::default());
    assert!(matches!(e, Err(CoonsError::Blend { flat: 1, asked: Order::C2 })), "{e:?}");
}

/// E3: not a change of parameters: heights over the same y differ.
#[test]
fn e3_the_rational_form_is_another_surface() {
    let plane =
        |z: f64| -> Sheet { Arc::new(Analytic { origin: DVec3::Z * z, ..Analytic::new(Shape::Plane) }) };
    let height = |b: BlendFunction| {
        let r = [plane(0.0), plane(1.0)];
        let borders = [0.0, 1.0].map(|u| {
            curve_fn(move |v| {
                let b = b.jet(v);
                [DVec3::new(u, v, b[0]), DVec3::new(0.0, 1.0, b[1]), DVec3::new(0.0, 0.0, b[2])]
            })
        });
        FourSided::raw(r, borders, blends(b, b)).jet(DVec2::splat(0.5)).p
    };
    let (a, b) = (height(Trigonometric(1)), height(Rational(1)));
    near(a.z, 0.5, 1e-15);
    near(b.z, 0.64, 1e-15);
    assert_eq!(a.y, b.y);
}

fn case_d(b: BlendFunction) -> ThreeSided {
    ThreeSided::raw([Case::T1, Case::T2, Case::T3].map(Case::sheet), blends(b, b))
}

/// E4: near the tip both forms lose the same digits.
#[test]
fn e4_the_rational_form_is_no_more_stable() {
    for b in [Trigonometric(1), Rational(1)] {
        let fill = case_d(b);
        for u in [1e-1, 1e-3, 1e-6, 1e-9] {
            let n = fill.normal(DVec2::new(u, 0.4)).unwrap();
            let limit = fill.normal(DVec2::new(0.0, 0.4)).unwrap();
            assert!(n.distance(limit) < 3.0 * u + 1e-9, "{b:?} {u} {}", n.distance(limit));
        }
    }
}

/// A surface ruled along y with speed ρ(u), over a bent profile.
fn ruled(rho: fn(f64) -> [f64; 3]) -> Sheet {
    constituent_fn(move |at| {
        let [r, dr, ddr] = rho(at.x);
        let (s, c) = at.x.sin_cos();
        Jet2 {
            p: DVec3::new(s, r * at.y, c),
            du: DVec3::new(c, dr * at.y, -s),
            dv: DVec3::Y * r,
            duu: DVec3::new(-s, ddr * at.y, -c),
            duv: DVec3::Y * dr,
            dvv: DVec3::ZERO,
        }
    })
}

fn leaving(lambda: f64) -> suture_coons::SplineCurve {
    let net = vec![DVec3::ZERO, DVec3::Y * lambda];
    suture_coons::SplineCurve::new(
        suture_bernstein::BSplineCurve::new(1, vec![0.0, 0.0, 1.0, 1.0], net).unwrap(),
    )
}

/// E5: parallel is not enough on a ruled edge.
#[test]
fn e5_orientation_along_a_ruled_edge() {
    let one = ruled(|_| [1.0, 0.0, 0.0]);
    let check = |r: &Sheet, a: f64, b: f64, alpha: BlendFunction| {
        remark_2(r.as_ref(), [&leaving(a), &leaving(b)], &alpha, 0)
    };
    let good = check(&one, 0.2, 3.0, Trigonometric(1)).unwrap();
    assert!(good.smallest > 0.19 && good.aslant < 1e-15);
    // λ3 = −1, λ4 = 1: k(1/2) = 0, k(1/4) = −0.7071, k(0) = −1.
    let e = check(&one, -1.0, 1.0, Trigonometric(1)).unwrap_err();
    assert!(
        matches!(e, CoonsError::Folds { edge: 0, side: 0.0, speed } if (speed + 1.0).abs() < 1e-15),
        "{e}"
    );
    let k = |u: f64, l: f64| {
        let a = Trigonometric(1).jet(u)[0];
        1.0 + (1.0 - a) * (l - 1.0)
    };
    near(k(0.5, -1.0), 0.0, 1e-15);
    near(k(0.25, -1.0), -(0.5f64.sqrt()), 1e-15);
    // ρ = 1 − 3.6 u (1 − u), λ = 0.05 at both ends: k(1/2) = −0.85.
    let dip = ruled(|u| [1.0 - 3.6 * u * (1.0 - u), -3.6 + 7.2 * u, 7.2]);
    let e = check(&dip, 0.05, 0.05, Trigonometric(1)).unwrap_err();
    let CoonsError::Folds { side, speed, .. } = e else { panic!("{e}") };
    assert!((side - 0.5).abs() < 0.4 && speed < 0.0);
    let rho: f64 = 1.0 - 0.9;
    near(rho + (0.05 - 1.0), -0.85, 1e-15);
    // Positive everywhere, and yet one curve leaves backwards: the reparametrisation refuses it.
    let r = [one, Case::S2.sheet()];
    let borders: [common::Border; 2] = [Arc::new(leaving(-1.0)), Arc::new(leaving(1.0))];
    let options = FillOptions { order: Order::G1, ..Default::default() };
    let e = FourSided::fill(r, borders, &options);
    assert!(matches!(e, Err(CoonsError::Folds { edge: 0, .. })), "{e:?}");
}

/// E6: Theorem 6 needs (1 − A) + A λ > 0: with r3 running the other way along v = 0 it is refused.
#[test]
fn e6_orientation_along_the_edges_of_a_hole() {
    let options =
        FillOptions { order: Order::G1, family: suture_coons::Family::Trigonometric, ..Default::default() };
    let good = ThreeSided::fill([Case::T1, Case::T2, Case::T3].map(Case::sheet), &options).unwrap();
    assert_eq!(good.certificate.reached, Order::G1);
    assert!(good.certificate.jumps.iter().flatten().all(|j| *j < 1e-15), "{:?}", good.certificate);
    // r3 mirrored in y: r3_v(u, 0) = −λ r1_v(u, 0).
    let mirrored = constituent_fn(|at| {
        let flip = DVec3::new(1.0, -1.0, 1.0);
        suture_coons::Constituent::jet(&Case::T3, at).map(|p: DVec3| p * flip)
    });
    let e = ThreeSided::fill([Case::T1.sheet(), Case::T2.sheet(), mirrored], &options);
    assert!(matches!(e, Err(CoonsError::Folds { edge: 0, .. })), "{e:?}");
}

fn cap(azimuth: [f64; 2]) -> Sheet {
    let sphere = Arc::new(Analytic::new(Shape::Sphere { radius: 1.0 }));
    let map = Map::Affine {
        origin: DVec2::new(azimuth[0], 0.0),
        u: DVec2::new(0.0, 0.5 * PI),
        v: DVec2::new(azimuth[1] - azimuth[0], 0.0),
    };
    Arc::new(Mapped { inner: sphere, map })
}

/// E7, E8: the tip. Case D has the printed values of (U × U')_z; the reflex corner and the surface that runs backwards are refused.
#[test]
fn e7_the_tip_folds_unless_u_turns_one_way() {
    let options =
        FillOptions { order: Order::G1, family: suture_coons::Family::Trigonometric, ..Default::default() };
    let fill = ThreeSided::fill([Case::T1, Case::T2, Case::T3].map(Case::sheet), &options).unwrap();
    let tip = fill.certificate.tip.unwrap();
    near(tip.smallest, 3.10062766803, 1e-11);
    assert!(tip.at == 0.0 && tip.turning < PI && tip.normal.distance(DVec3::Z) < 1e-15);
    for i in 0..=8 {
        let n = fill.patch.normal(DVec2::new(0.0, f64::from(i) / 8.0)).unwrap();
        assert!(n.distance(DVec3::Z) < 1e-14);
    }
    // Third surface: anything that fits at the corners.
    let refused = |a: [f64; 2], b: [f64; 2]| {
        let options = FillOptions {
            order: Order::C0,
            family: suture_coons::Family::Trigonometric,
            ..Default::default()
        };
        let (r1, r2) = (cap(a), cap(b));
        let (p, q) = (r1.jet(DVec2::X).p, r2.jet(DVec2::ONE).p);
        let r3 =
            constituent_fn(move |at| Jet2 { p: p * (1.0 - at.y) + q * at.y, dv: q - p, ..Jet2::default() });
        let blend: Arc<dyn Blend> = Arc::new(Trigonometric(1));
        ThreeSided::fill_with([r1, r2, r3], [Arc::clone(&blend), blend], &options)
    };
    let quarter = 0.5 * PI;
    let e = refused([0.0, quarter], [PI, 3.0 * quarter]).unwrap_err();
    assert!(matches!(e, CoonsError::Tip { value, .. } if value < 1e-12), "{e}");
    let e = refused([0.0, quarter], [3.0 * quarter, quarter]).unwrap_err();
    assert!(matches!(e, CoonsError::Tip { value, .. } if (value + 7.75157).abs() < 1e-4), "{e}");
    assert!(refused([0.0, quarter], [0.0, quarter]).is_ok());
}

/// E9: parts of one sphere in different parametrisations do not give the sphere; the same parametrisation gives any surface.
#[test]
fn e9_reproduction_needs_the_same_functions() {
    let same = cap([0.0, 0.5 * PI]);
    let squared = constituent_fn({
        let same = Arc::clone(&same);
        move |at| {
            let map = Jet2 {
                p: DVec2::new(at.x, at.y * at.y),
                du: DVec2::X,
                dv: DVec2::new(0.0, 2.0 * at.y),
                dvv: DVec2::new(0.0, 2.0),
                ..Jet2::default()
            };
            same.jet(map.p).compose(&map)
        }
    });
    let fill = |r2: Sheet| {
        ThreeSided::raw(
            [Arc::clone(&same), r2, Arc::clone(&same)],
            blends(Trigonometric(1), Trigonometric(1)),
        )
    };
    let bad = fill(squared).jet(DVec2::splat(0.5)).p.length();
    near(bad, 0.992838059477, 1e-11);
    for i in 0..=10 {
        let at = DVec2::new(f64::from(i) / 10.0, 0.37);
        near(fill(Arc::clone(&same)).jet(at).p.length(), 1.0, 1e-15);
    }
}

/// E10: an affine combination, not a convex one: constituents between z = 0 and z = 1 give z = −1.
#[test]
fn e10_no_convex_hull() {
    let tent = |inside: f64| {
        // 0 on the sides u = 0, 1 or 1 there: the correction subtracts what the sides have.
        constituent_fn(move |at| {
            Jet2::constant(DVec3::new(at.x, at.y, inside + (1.0 - inside) * (2.0 * at.x - 1.0).powi(2)))
        })
    };
    let flat = |u: f64| curve_fn(move |v| [DVec3::new(u, v, 0.0), DVec3::Y, DVec3::ZERO]);
    let fill = FourSided::raw(
        [tent(0.0), tent(0.0)],
        [flat(0.0), flat(1.0)],
        blends(Trigonometric(1), Trigonometric(1)),
    );
    near(fill.jet(DVec2::splat(0.5)).p.z, -1.0, 1e-15);
}

/// E11: r3 needs two corners only; the other two may lie anywhere.
#[test]
fn e11_two_corners_are_enough() {
    let t3 = suture_coons::Constituent::jet(&Case::T3, DVec2::ZERO).p;
    let t1 = suture_coons::Constituent::jet(&Case::T1, DVec2::ZERO).p;
    assert!(t3.distance(t1) > 0.5);
    let fill = case_d(Trigonometric(1));
    for i in 0..=10 {
        let t = f64::from(i) / 10.0;
        for (at, case) in
            [(DVec2::new(t, 0.0), Case::T1), (DVec2::new(t, 1.0), Case::T2), (DVec2::new(1.0, t), Case::T3)]
        {
            assert!(fill.jet(at).p.distance(suture_coons::Constituent::jet(&case, at).p) < 1e-15);
        }
    }
}

/// E12: the printed blend is flat of order 2 only; a C³ fill needs another.
#[test]
fn e12_c3_needs_more() {
    near(Trigonometric(2).jet(0.0)[3], 9.0 * PI * PI, 1e-12);
    let r = case_a_sheets();
    let borders = border_curves(&r, Order::C3).unwrap();
    let options = FillOptions { order: Order::C3, ..Default::default() };
    let e = FourSided::fill_with(
        r.clone(),
        borders.clone(),
        blends(Trigonometric(2), Trigonometric(2)),
        &options,
    );
    assert!(matches!(e, Err(CoonsError::Blend { flat: 2, .. })));
    let fill = FourSided::fill(r.clone(), borders.clone(), &options).unwrap();
    assert_eq!(fill.certificate.reached, Some(Order::C3));
    let worst = |patch: &FourSided| {
        (0..=50).fold([0.0f64; 4], |mut w, i| {
            let at = DVec2::new(f64::from(i) / 50.0, 0.0);
            let f = patch.partials(at).unwrap();
            let s = r[0].expand(&suture_coons::Expansion::u(at.x), &suture_coons::Expansion::v(0.0)).unwrap();
            for j in 0..4 {
                let want = DVec3::new(s[0].partial(0, j), s[1].partial(0, j), s[2].partial(0, j));
                w[j] = w[j].max(f[0][j].distance(want));
            }
            w
        })
    };
    let good = worst(&fill.patch);
    assert!(good.iter().all(|d| *d < 1e-11), "{good:?}");
    let bad = worst(&FourSided::raw(r.clone(), borders, blends(Trigonometric(2), Trigonometric(2))));
    assert!(bad[2] < 1e-12 && bad[3] > 1.0, "{bad:?}");
}

/// Case M: mismatched corners are refused with the place; the maxima are the specification's; repair moves the curve by no more than
/// the bound.
#[test]
fn case_m_mismatched_corners() {
    let r = case_a_sheets();
    let [c3, c4] = case_a_borders();
    let moved = Arc::clone(&c3);
    let c3 = curve_fn(move |v| {
        let [p, d, dd] = moved.jet(v);
        let (s, c) = v.sin_cos();
        let (s3, k3) = (3.0 * v).sin_cos();
        let e = v.exp();
        [
            p + DVec3::new(0.01 * c, 0.02 * s3, 0.03 * e),
            d + DVec3::new(-0.01 * s, 0.06 * k3, 0.03 * e),
            dd + DVec3::new(-0.01 * c, -0.18 * s3, 0.03 * e),
        ]
    });
    let raw =
        FourSided::raw(r.clone(), [Arc::clone(&c3), Arc::clone(&c4)], blends(Polynomial(2), Polynomial(2)));
    let want = [
        [
            0.03162277660168,
            0.05929270612816,
            0.06708203932499,
            0.1825741858351,
            0.1257788237344,
            0.03162277660168,
        ],
        [
            0.08177596890212,
            0.1533299416915,
            0.1012386504594,
            0.4721337765888,
            0.1898224696113,
            0.08558378645207,
        ],
    ];
    let got = both_edges(&raw, &r, 20000);
    for k in 0..2 {
        (0..6).for_each(|i| near(got[k][i], want[k][i], 1e-8));
    }
    // The sides are met whatever the corners do.
    for i in 0..=10 {
        let v = f64::from(i) / 10.0;
        assert_eq!(raw.jet(DVec2::new(0.0, v)).p, c3.jet(v)[0]);
    }
    let certificate = raw.certificate(2, 1e-9).unwrap();
    assert_eq!(certificate.reached, None);
    let l = certificate.diagonal;
    for k in 0..2 {
        // The certificate bounds what sampling finds, and is attained by the position.
        let (p, d, dd) = (got[k][0], got[k][1].max(got[k][2]), got[k][3].max(got[k][4]).max(got[k][5]));
        assert!(p <= certificate.jumps[0] * l * (1.0 + 1e-12));
        assert!(
            d <= certificate.jumps[1] * l * (1.0 + 1e-8) && dd <= certificate.jumps[2] * l * (1.0 + 1e-8)
        );
    }
    near(certificate.jumps[0] * l, want[1][0], 1e-12);
    let refused = FourSided::fill(r.clone(), [Arc::clone(&c3), Arc::clone(&c4)], &FillOptions::default());
    let Err(CoonsError::Corner { edge: 0, side: 0, order: 0, size, .. }) = refused else {
        panic!("{refused:?}")
    };
    near(size * l, want[0][0], 1e-12);
    let options = FillOptions { repair: true, ..Default::default() };
    let repaired = FourSided::fill(r.clone(), [c3, c4], &options).unwrap();
    near(repaired.moved[0] * l, 0.08177596890212, 1e-9);
    assert!(repaired.moved[1] < 1e-14);
    let got = both_edges(&repaired.patch, &r, 100);
    assert!(got.iter().flatten().all(|d| *d < 2e-13), "{got:?}");
}

/// The C⁰ case: C3 leaves at another slope.
#[test]
fn c0_case() {
    let r = case_a_sheets();
    let [c3, c4] = case_a_borders();
    // H1(v) (0.1, 0.2, −0.3): raises r3'(0) alone.
    let d = DVec3::new(0.1, 0.2, -0.3);
    let net = vec![DVec3::ZERO, d / 5.0, d * (2.0 / 5.0), DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
    let slope = CurveData::Bezier { net }.build().unwrap();
    let c3: common::Border = {
        let (a, b) = (c3, slope);
        curve_fn(move |v| {
            let (a, b) = (a.jet(v), b.jet(v));
            [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
        })
    };
    let fill = FourSided::raw(r.clone(), [c3, c4], blends(Polynomial(2), Polynomial(2)));
    let got = both_edges(&fill, &r, 20000)[0];
    near(got[2], 0.374165738677, 1e-9);
    near(got[4], 0.701560760020, 1e-8);
    let angle = |u: f64| {
        let at = DVec2::new(u, 0.0);
        let (a, b) = (fill.normal(at).unwrap(), r[0].jet(at).normal().unwrap());
        a.cross(b).length().atan2(a.dot(b))
    };
    near(angle(0.038798565), 0.244808260783, 1e-9);
    let largest = (0..=5000).map(|i| angle(f64::from(i) / 5000.0)).fold(0.0, f64::max);
    assert!(largest <= 0.244808260783 + 1e-9);
}

/// Specification §2.4: the reparametrised constituent makes G² of curves that fit no parameter line; without it the curvature jumps.
#[test]
fn g2_by_reparametrisation() {
    let r = case_a_sheets();
    let map =
        Map::Edge { at: 0.0, psi: [0.3, -0.2], lambda: [1.7, 0.6], chi: [0.0, 0.0], kappa: [0.8, -0.5] };
    let hat: Sheet = Arc::new(Mapped { inner: Arc::clone(&r[0]), map });
    let borders = border_curves(&[Arc::clone(&hat), Arc::clone(&r[1])], Order::C2).unwrap();
    let bend = |fill: &FourSided| -> [f64; 3] {
        (0..=50).fold([0.0f64; 3], |w, i| {
            let at = DVec2::new(f64::from(i) / 50.0, 0.0);
            let (a, b) = (shape(&fill.jet(at)), shape(&r[0].jet(at)));
            [w[0].max(a.0.distance(b.0)), w[1].max((a.1 - b.1).abs()), w[2].max((a.2 - b.2).abs())]
        })
    };
    let options = FillOptions { order: Order::G2, ..Default::default() };
    let fill = FourSided::fill(r.clone(), borders.clone(), &options).unwrap();
    let got = bend(&fill.patch);
    assert!(got.iter().all(|d| *d < 1e-12), "{got:?}");
    let raw = FourSided::raw(r.clone(), borders.clone(), blends(Polynomial(2), Polynomial(2)));
    let got = bend(&raw);
    near(got[0], 0.059422590213, 1e-10);
    near(got[1], 0.0842908989195, 1e-10);
    near(got[2], 0.0734052274172, 1e-10);
    assert!(FourSided::fill(r.clone(), borders.clone(), &FillOptions::default()).is_err());
    // A curve that is only G¹: r3''(0) raised by (.5, .5, .5).
    let d = DVec3::splat(0.5);
    let net = [0.0, 0.0, 1.0 / 20.0, 0.0, 0.0, 0.0].iter().map(|w| d * *w).collect();
    let raised = CurveData::Sum { of: Box::new([borders[0].data().unwrap(), CurveData::Bezier { net }]) };
    let borders = [raised.build().unwrap(), Arc::clone(&borders[1])];
    let only_g1 =
        FourSided::raw([hat, Arc::clone(&r[1])], borders.clone(), blends(Polynomial(2), Polynomial(2)));
    let got = bend(&only_g1);
    assert!(got[0] < 1e-12);
    near(got[1], 0.0536237605545, 1e-10);
    near(got[2], 0.0651189474494, 1e-10);
    let e = FourSided::fill(r.clone(), borders.clone(), &options);
    assert!(matches!(e, Err(CoonsError::Corner { edge: 0, side: 0, order: 2, .. })), "{e:?}");
    let g1 =
        FourSided::fill(r.clone(), borders, &FillOptions { order: Order::G1, ..Default::default() }).unwrap();
    assert!(bend(&g1.patch)[0] < 1e-12);
}

/// Normal, Gauss and mean curvature.
fn shape(j: &Jet2) -> (DVec3, f64, f64) {
    let n = j.normal().unwrap();
    let (e, f, g) = (j.du.dot(j.du), j.du.dot(j.dv), j.dv.dot(j.dv));
    let (l, m, k) = (j.duu.dot(n), j.duv.dot(n), j.dvv.dot(n));
    let w = e * g - f * f;
    (n, (l * k - m * m) / w, (e * k - 2.0 * f * m + g * l) / (2.0 * w))
}

/// Specification §3: the C² three-sided version, and what a blend that is flat of order 1 leaves.
#[test]
fn c2_three_sided() {
    let third = constituent_fn(|at| {
        let b = Polynomial(2).jet(at.y);
        let b = Jet2 { p: b[0], dv: b[1], dvv: b[2], ..Jet2::default() };
        let a = Jet2 { p: 1.0 - b.p, dv: -b.dv, dvv: -b.dvv, ..Jet2::default() };
        let (s1, s2) =
            (suture_coons::Constituent::jet(&Case::S1, at), suture_coons::Constituent::jet(&Case::S2, at));
        let v = at.y;
        let w = v * (1.0 - v);
        let (q, dq) = (1.0 - 2.0 * v, -2.0);
        let (h, dh, ddh) = (w * w * w, 3.0 * w * w * q, 6.0 * w * q * q + 3.0 * w * w * dq);
        let (s, c) = (2.0 * at.x).sin_cos();
        let d = DVec3::new(1.0, 2.0, -3.0);
        let extra = Jet2 {
            p: h * s,
            du: 2.0 * h * c,
            dv: dh * s,
            duu: -4.0 * h * s,
            duv: 2.0 * dh * c,
            dvv: ddh * s,
        };
        s1.weighted(&a).add(s2.weighted(&b)).add(extra.map(|x| d * x))
    });
    let r = [Case::S1.sheet(), Case::S2.sheet(), third];
    let maxima = |patch: &ThreeSided| {
        let edges: [fn(f64) -> DVec2; 3] =
            [|t| DVec2::new(t, 0.0), |t| DVec2::new(t, 1.0), |t| DVec2::new(1.0, t)];
        [0, 1, 2].map(|k: usize| {
            edge_maxima(&|at| patch.jet(at), &|at| r[k].jet(at), edges[k], 40).into_iter().fold(0.0, f64::max)
        })
    };
    for family in [
        suture_coons::Family::Polynomial,
        suture_coons::Family::Trigonometric,
        suture_coons::Family::Rational,
    ] {
        let fill = ThreeSided::fill(r.clone(), &FillOptions { family, ..Default::default() }).unwrap();
        assert!(fill.certificate.tip.is_none());
        let got = maxima(&fill.patch);
        assert!(got.iter().all(|d| *d < 1e-13), "{family:?} {got:?}");
    }
    let got = maxima(&ThreeSided::raw(r.clone(), blends(Trigonometric(1), Trigonometric(1))));
    let want = [0.527, 0.664, 0.271];
    (0..3).for_each(|k| assert!((got[k] - want[k]).abs() < 1e-3, "{got:?}"));
}
