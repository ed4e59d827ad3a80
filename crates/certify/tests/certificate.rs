//! Seams of known jumps.

mod common;

use common::*;
use glam::{DMat3, DVec2, DVec3};
use suture_certify::{Certificate, CertifyError, CertifyOptions, Unmeasured, certify};
use suture_surface::{Continuity, EdgeRef, Jet2, PatchId, Seam, Surface};

/// The diagonal of the box around the unit sphere, 2√3.
const DIAGONAL: f64 = 3.464_101_615_137_754_6;

fn measured(surface: &Surface) -> Certificate {
    certify(surface, DIAGONAL, &CertifyOptions::default()).unwrap()
}

/// A sphere whose face `+X` was changed; seams are those of the whole one.
fn broken(change: impl Fn(&Analytic) -> Analytic) -> Certificate {
    let whole = sphere_patches();
    let mut patches = whole.clone();
    patches[0] = change(&whole[0]);
    measured(&sewn(&whole, patches, Continuity::C2))
}

#[track_caller]
fn near(got: f64, want: f64, relative: f64) {
    assert!((got - want).abs() <= relative * want.abs(), "{got:e} is not {want:e}");
}

#[test]
fn a_sphere_joins_to_rounding() {
    let c = measured(&sphere());
    assert_eq!((c.seams.len(), c.patches.len(), c.open_edges), (12, 6, 0));
    assert_eq!((c.claimed, c.measured), (Continuity::C2, Some(Continuity::C2)));
    assert!(c.position < 1e-15 && c.normal < 1e-14 && c.curvature < 1e-13, "{c:?}");
    // At the corners of a face its parameter lines meet at 60° or 120°.
    near(c.regularity, 0.75_f64.sqrt(), 1e-12);
    near(c.largest_curvature, DIAGONAL, 1e-12);
}

#[test]
fn a_shift_is_the_gap() {
    let c = broken(|p| p.moved(DMat3::IDENTITY, DVec3::new(0.6, 0.0, 0.8) * 1e-5));
    near(c.position, 1e-5 / DIAGONAL, 1e-9);
    assert!(c.normal < 1e-14 && c.curvature < 1e-13);
    assert_eq!(c.measured, None);
    assert_eq!(c.seams.iter().filter(|s| s.measured.is_none()).count(), 4);
}

#[test]
fn a_tilt_is_the_angle() {
    // About the tangent of an edge at its midpoint: the normal there turns by the whole angle, elsewhere by less.
    let c = broken(|p| p.moved(DMat3::from_rotation_z(1e-4), DVec3::ZERO));
    near(c.normal, 1e-4, 1e-9);
    let worst = &c.seams[c.worst.normal.unwrap()];
    assert!((worst.normal.t - 0.5).abs() < 1e-3, "{}", worst.normal.t);
    // Rigid motion about the centre keeps every curvature; the tilt must not be counted a second time.
    assert!(c.curvature < 1e-8 && c.curvature > 0.0, "{}", c.curvature);
}

#[test]
fn a_spin_opens_the_corners_most() {
    let angle = 1e-4;
    let c = broken(|p| p.moved(DMat3::from_rotation_x(angle), DVec3::ZERO));
    // The corners lie √(2/3) from the axis.
    let gap = 2.0 * (2.0_f64 / 3.0).sqrt() * (0.5 * angle).sin();
    near(c.position, gap / DIAGONAL, 1e-9);
    near(c.normal, 2.0 * (0.5 * gap).asin(), 1e-9);
}

#[test]
fn one_percent_of_curvature_is_one_percent() {
    // h = δ (p·m)² over the great circle p·m = 0 changes the curvature across it by 2δ and nothing else.
    let m = DVec3::new(1.0, -1.0, 0.0).normalize();
    let whole = sphere_patches();
    let mut patches = whole.clone();
    patches[0] = whole[0].bulged(0.005, m);
    let c = measured(&sewn(&whole, patches, Continuity::C2));
    let ends = |s: &Seam| {
        let curve = whole[s.a.patch.0 as usize].domain.edge(s.a.edge as usize).unwrap();
        [0.0, 1.0].map(|t| (whole[s.a.patch.0 as usize].map)(curve.point(t)).p)
    };
    let seam = c
        .seams
        .iter()
        .find(|s| s.seam.a.patch == PatchId(0) && ends(&s.seam).iter().all(|p| p.dot(m).abs() < 1e-12))
        .unwrap();
    near(seam.curvature.value, 0.01, 1e-9);
    assert!(seam.position.value < 1e-15 && seam.normal.value < 1e-14);
    assert_eq!(seam.measured, Some(Continuity::C1));
}

fn flat(_: DVec2) -> Jet2<f64> {
    Jet2::default()
}

fn measured_pair(above: impl Fn(DVec2) -> Jet2<f64> + Send + Sync + 'static) -> Certificate {
    certify(&pair(above, flat, Continuity::G2), 1.0, &CertifyOptions::default()).unwrap()
}

#[test]
fn a_plane_has_the_diagonal_as_its_unit() {
    let c = measured_pair(|_| Jet2 { dvv: 1e-3, ..Jet2::default() });
    near(c.curvature, 1e-3, 1e-12);
    assert_eq!(c.measured, Some(Continuity::G1));
    assert_eq!(c.open_edges, 6);
}

#[test]
fn an_angle_at_the_very_end_is_found() {
    // Slope ε x³⁰⁰⁰ across the seam: below ε/20 on all of [0, 0.999].
    let c = measured_pair(|x| Jet2 { dv: 1e-3 * x.x.powi(3000), ..Jet2::default() });
    near(c.normal, 1e-3_f64.atan(), 1e-9);
    assert_eq!(c.seams[0].normal.t, 1.0);
    let c = measured_pair(|x| Jet2 { dv: 1e-3 * (1.0 - x.x).powi(3000) * x.x.signum(), ..Jet2::default() });
    near(c.normal, 1e-3_f64.atan(), 1e-5);
}

#[test]
fn a_peak_between_samples_is_climbed() {
    let c = measured_pair(|x| Jet2 { p: 1e-3 * (-((x.x - 0.37) / 0.05).powi(2)).exp(), ..Jet2::default() });
    let jump = c.seams[0].position;
    assert!((jump.t - 0.37).abs() < 2e-4, "{}", jump.t);
    near(jump.value, 1e-3, 1e-5);
    assert!(jump.within >= 1e-3 - jump.value && jump.within < 1e-7, "{jump:?}");
}

#[test]
fn a_singular_side_is_reported_and_not_a_number_nowhere() {
    let edge = |patch, edge| EdgeRef { patch: PatchId(patch), edge };
    let cap = |p: &Analytic| {
        // (u, v) ↦ map(u, v³): the derivative across v = 0 vanishes there.
        let map = std::sync::Arc::clone(&p.map);
        Analytic::square(move |at| {
            let cube = |v: f64| [v * v * v, 3.0 * v * v, 6.0 * v];
            let [y, dy, ddy] = cube(at.y);
            map(DVec2::new(at.x, y)).compose(&Jet2 {
                p: DVec2::new(at.x, y),
                du: DVec2::X,
                dv: DVec2::Y * dy,
                dvv: DVec2::Y * ddy,
                ..Jet2::default()
            })
        })
    };
    let patches = vec![cap(&graph(DVec2::ZERO, flat)), graph(DVec2::new(0.0, -1.0), flat)];
    let surface = surface(patches, vec![Seam::new(edge(0, 0), edge(1, 2), Continuity::C2)]);
    let c = certify(&surface, 1.0, &CertifyOptions::default()).unwrap();
    assert_eq!(c.measured, Some(Continuity::C0));
    let spot = c.seams[0].blind_spot.unwrap();
    assert_eq!((spot.side, spot.t, spot.why), (edge(0, 0), 0.0, Unmeasured::Singular));
    assert_eq!((c.regularity, c.normal, c.curvature), (0.0, std::f64::consts::PI, f64::INFINITY));
    assert!(c.patches[0].singular_at.is_some() && c.patches[1].singular_at.is_none());
}

#[test]
fn what_is_not_finite_joins_nothing() {
    let c = measured_pair(|x| Jet2 { p: if x.x > 0.9 { f64::NAN } else { 0.0 }, ..Jet2::default() });
    assert_eq!((c.measured, c.position), (None, f64::INFINITY));
    assert_eq!(c.seams[0].blind_spot.unwrap().why, Unmeasured::NotFinite);
}

#[test]
fn sides_that_run_the_same_way_are_compared_from_the_same_side() {
    let bent = |x: DVec2| Jet2 { p: x.y * x.y, dv: 2.0 * x.y, dvv: 2.0, ..Jet2::default() };
    let edge = |patch, edge| EdgeRef { patch: PatchId(patch), edge };
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    let above = graph(DVec2::ZERO, bent);
    let below = above.moved(mirror, DVec3::ZERO);
    let seam = Seam { same_direction: true, ..Seam::new(edge(0, 0), edge(1, 0), Continuity::C2) };
    let c = certify(&surface(vec![above, below], vec![seam]), 1.0, &CertifyOptions::default()).unwrap();
    assert!(c.position == 0.0 && c.normal < 1e-15 && c.curvature < 1e-15, "{c:?}");
}

#[test]
fn units_and_sides_do_not_matter() {
    let whole = sphere_patches();
    let mut patches = whole.clone();
    patches[0] = patches[0].bulged(0.01, DVec3::Y).moved(DMat3::from_rotation_y(1e-3), DVec3::splat(1e-4));
    let one = measured(&sewn(&whole, patches.clone(), Continuity::C2));
    for power in [-20, 20] {
        let s = 2f64.powi(power);
        let scaled =
            patches.iter().map(|p| p.moved(DMat3::from_diagonal(DVec3::splat(s)), DVec3::ZERO)).collect();
        let other = certify(&sewn(&whole, scaled, Continuity::C2), DIAGONAL * s, &CertifyOptions::default());
        assert_eq!(one, other.unwrap(), "2^{power}");
    }
    let turned = sewn(&whole, patches, Continuity::C2);
    let seams: Vec<Seam> = turned.seams().iter().map(|s| Seam { a: s.b, b: s.a, ..*s }).collect();
    let mut patches = whole.clone();
    patches[0] = patches[0].bulged(0.01, DVec3::Y).moved(DMat3::from_rotation_y(1e-3), DVec3::splat(1e-4));
    let other = measured(&surface(patches, seams));
    near(other.position, one.position, 1e-9);
    near(other.normal, one.normal, 1e-9);
    near(other.curvature, one.curvature, 1e-9);
}

#[test]
fn arguments_are_checked() {
    let options = CertifyOptions::default;
    let refused = |diagonal, options| certify(&sphere(), diagonal, &options).unwrap_err();
    for diagonal in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(diagonal, options()), CertifyError::Diagonal { .. }));
    }
    let few = CertifyOptions { samples: 2, ..options() };
    assert!(matches!(refused(1.0, few), CertifyError::Option { name: "samples", value: 2, .. }));
    let mut limits = options();
    limits.limits.normal = f64::NAN;
    assert!(matches!(refused(1.0, limits), CertifyError::Limit { name: "normal", .. }));
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let whole = sphere_patches();
    let mut patches = whole.clone();
    patches[3] = patches[3].moved(DMat3::from_rotation_y(1e-3), DVec3::splat(1e-4));
    let surface = sewn(&whole, patches, Continuity::C2);
    let with =
        |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| measured(&surface));
    assert_eq!(with(1), with(5));
}
