//! Reflection lines across seams: the reflection angle and its derivative are continuous to the order that the certificate claims.
//!
//! The angle `θ = asin(r · l)` of the mirrored line of sight `r = 2 (n · v) n − v` with the axis `l` of the light depends on the normal, its
//! derivative across a seam on the shape operator: lines meet where tangent planes do, and have no kinks where curvatures agree.

use glam::DVec3;
use suture::apatch::ApatchOptions;
use suture::bubble::BubbleOptions;
use suture::mesh::{TriMesh, shapes};
use suture::surface::{Continuity, Jet2, Seam, Surface};
use suture::{NormalSource, SewOptions, Unwatched, sew_apatch, sew_bubble, vertex_normals};
use suture_tests::{labels, mesh, own, run};

/// Eyes and axes of light; general, so that no symmetry hides a jump.
const SCENES: [[[f64; 3]; 2]; 3] = [
    [[9.0, 4.0, 6.0], [0.3, -0.2, 0.9]],
    [[-7.0, 8.0, -3.0], [0.9, 0.4, 0.1]],
    [[1.0, -11.0, 5.0], [-0.5, 0.7, 0.5]],
];

/// Largest jumps over all seams that claim an order.
#[derive(Debug, Default)]
struct Jumps {
    seams: usize,
    samples: usize,
    /// Radians.
    angle: f64,
    /// Of the derivative across the seam, relative to the largest curvature beside it.
    derivative: f64,
}

/// The reflection angle at a jet and its derivative in the direction `d`, per unit of length; `None` where the patch is singular or the
/// line of sight is mirrored along the light, where the angle has a corner whatever the surface.
fn reflection(jet: &Jet2, outward: f64, eye: DVec3, light: DVec3, d: DVec3) -> Option<(f64, f64, f64)> {
    let n = jet.normal()? * outward;
    let w = jet.du.cross(jet.dv) * outward;
    // d = a S_u + b S_v in the tangent plane.
    let (au, av) = (jet.dv.cross(n) / w.length(), n.cross(jet.du) / w.length());
    let (a, b) = (d.dot(au) * outward, d.dot(av) * outward);
    let dw = (jet.duu.cross(jet.dv) + jet.du.cross(jet.duv)) * a
        + (jet.duv.cross(jet.dv) + jet.du.cross(jet.dvv)) * b;
    let dw = dw * outward;
    let dn = (dw - n * n.dot(dw)) / w.length();
    let sight = eye - jet.p;
    let (v, far) = (sight.normalize(), sight.length());
    let dp = jet.du * a + jet.dv * b;
    let dv = -(dp - v * v.dot(dp)) / far;
    let r = n * (2.0 * n.dot(v)) - v;
    let dr = n * (2.0 * (dn.dot(v) + n.dot(dv))) + dn * (2.0 * n.dot(v)) - dv;
    let s = r.dot(light);
    let cos = (1.0 - s * s).sqrt();
    (cos > 0.1).then(|| (s.asin(), dr.dot(light) / cos, dn.length()))
}

fn jumps(surface: &Surface, claim: impl Fn(Continuity) -> bool, diagonal: f64) -> Jumps {
    let mut found = Jumps::default();
    for seam in surface.seams().iter().filter(|s| claim(s.claimed)) {
        found.seams += 1;
        for t in [0.03, 0.2, 0.5, 0.71, 0.96] {
            measure(surface, seam, t, diagonal, &mut found);
        }
    }
    found
}

fn measure(surface: &Surface, seam: &Seam, t: f64, diagonal: f64, found: &mut Jumps) {
    let jet = |edge: suture::surface::EdgeRef, t: f64| {
        let patch = surface.patch(edge.patch).unwrap();
        let at = patch.domain().edge(edge.edge as usize).unwrap().jet(t);
        let jet = patch.jet(at[0]);
        let along = jet.du * at[1].x + jet.dv * at[1].y;
        (jet, along)
    };
    let ((a, along), (b, _)) = (jet(seam.a, t), jet(seam.b, seam.opposite(t)));
    let Some(n) = a.normal() else { return };
    let across = n.cross(along).normalize();
    let flip = if seam.same_direction { -1.0 } else { 1.0 };
    for [eye, light] in SCENES {
        let (eye, light) = (DVec3::from(eye) * diagonal, DVec3::from(light).normalize());
        let sides = (reflection(&a, 1.0, eye, light, across), reflection(&b, flip, eye, light, across));
        if let (Some((x, dx, ka)), Some((y, dy, kb))) = sides {
            found.samples += 1;
            found.angle = found.angle.max((x - y).abs());
            found.derivative = found.derivative.max((dx - dy).abs() / ka.max(kb).max(1.0 / diagonal));
        }
    }
}

/// A closed mesh without symmetry.
fn blob() -> TriMesh {
    let mut mesh = shapes::sphere(1);
    for p in &mut mesh.positions {
        *p *= 1.0 + 0.3 * (2.0 * p.x + p.y).sin() * (1.5 * p.z).cos();
    }
    mesh
}

#[track_caller]
fn smooth(j: &Jumps, angle: f64, derivative: f64) {
    assert!(j.seams > 10 && j.samples > 5 * j.seams, "{j:?}");
    assert!(j.angle < angle && j.derivative < derivative, "{j:?}");
}

#[test]
fn reconstructions_reflect_without_kinks() {
    for name in ["sphere_320", "deformed_octahedron", "torus_2304"] {
        let input = mesh(&own(&format!("paper/{name}.obj")));
        let made = run(&input, Box::new(labels(&own(&format!("paper/{name}.labels"))))).unwrap();
        let j = jumps(&made.blend.surface, |c| c == Continuity::C2, input.diagonal());
        println!("{name}: {j:?}");
        smooth(&j, 1e-9, 1e-7);
        assert_eq!(j.seams, made.blend.surface.seams().len());
    }
}

#[test]
fn lines_meet_on_a_patches_and_have_kinks() {
    let input = blob();
    let normals = vertex_normals(&input, NormalSource::Best).unwrap();
    let made =
        sew_apatch(&input, &normals, &ApatchOptions::default(), &SewOptions::default(), &Unwatched).unwrap();
    let j = jumps(&made.surface, |c| c == Continuity::C1, input.diagonal());
    println!("A-patches: {j:?}");
    smooth(&j, 1e-9, f64::INFINITY);
    // The claim is C¹, and no more is there: the test can tell.
    assert!(j.derivative > 1e-2, "{j:?}");
}

#[test]
fn bubble_surfaces_reflect_to_the_order_they_claim() {
    let input = blob();
    let normals = vertex_normals(&input, NormalSource::Best).unwrap();
    for order in 0..=3 {
        let bubbles = BubbleOptions { order, ..BubbleOptions::default() };
        let made = sew_bubble(&input, &normals, &bubbles, &SewOptions::default(), &Unwatched).unwrap();
        let j = jumps(&made.surface, |_| true, input.diagonal());
        println!("bubble, order {order}: {j:?}");
        match order {
            0 => assert!(j.angle > 1e-3, "{j:?}"),
            1 => {
                smooth(&j, 1e-8, f64::INFINITY);
                assert!(j.derivative > 1e-3, "{j:?}");
            }
            _ => smooth(&j, 1e-8, 1e-6),
        }
    }
}

#[test]
fn the_derivative_is_that_of_differences() {
    // On a sphere of radius 2 from parameters that are neither orthogonal nor of unit speed.
    let jet = |u: f64, v: f64| {
        let (x, y) = (u + 0.3 * v, 1.7 * v);
        let ((s, c), (t, d)) = (x.sin_cos(), y.sin_cos());
        let (px, py, pz) =
            (DVec3::new(-s * d, c * d, 0.0), DVec3::new(-c * t, -s * t, d), DVec3::new(c * d, s * d, t));
        let (xx, xy, yy) = (DVec3::new(-c * d, -s * d, 0.0), DVec3::new(s * t, -c * t, 0.0), -pz);
        Jet2 {
            p: pz * 2.0,
            du: px * 2.0,
            dv: (px * 0.3 + py * 1.7) * 2.0,
            duu: xx * 2.0,
            duv: (xx * 0.3 + xy * 1.7) * 2.0,
            dvv: (xx * 0.09 + xy * 1.02 + yy * 2.89) * 2.0,
        }
    };
    let (eye, light) = (DVec3::new(9.0, 4.0, 6.0), DVec3::new(0.3, -0.2, 0.9).normalize());
    let at = jet(0.4, 0.3);
    let h = 1e-6;
    for (a, b) in [(1.0, 0.0), (0.0, 1.0), (0.6, -0.8)] {
        let d = at.du * a + at.dv * b;
        let [(x, _, _), (y, _, _)] =
            [-h, h].map(|h| reflection(&jet(0.4 + h * a, 0.3 + h * b), 1.0, eye, light, d).unwrap());
        let (_, slope, _) = reflection(&at, 1.0, eye, light, d).unwrap();
        assert!(((y - x) / (2.0 * h) - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{slope}");
    }
}
