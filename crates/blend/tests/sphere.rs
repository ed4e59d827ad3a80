//! A sphere in six central charts: the whole construction against what must hold exactly.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;
use suture_blend::*;
use suture_surface::PatchKind;

mod common;
use common::{jumps, shape};

/// Right-handed frame of the chart around the axis `face / 2`, on its positive or negative side.
fn frame(face: usize) -> [DVec3; 3] {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let (a, sign) = (face / 2, [1.0, -1.0][face % 2]);
    let n = axes[a] * sign;
    let u = axes[(a + 1) % 3];
    [u, n.cross(u), n]
}

/// Central projection: the sphere point over (u, v) in the tangent plane of the face.
fn point(face: usize, p: DVec2) -> DVec3 {
    let [u, v, n] = frame(face);
    (u * p.x + v * p.y + n).normalize()
}

fn parameter(face: usize, x: DVec3) -> DVec2 {
    let [u, v, n] = frame(face);
    DVec2::new(x.dot(u), x.dot(v)) / x.dot(n)
}

/// A bicubic spline near the sphere (control points beyond it by the second-order term of the quasi-interpolant), skewed in its
/// parameters so that no chart is isometric by luck.
fn spline(face: usize) -> BSplineSurface<DVec3> {
    scaled_spline(face, |_| 1.0)
}

/// The same with every point scaled by a function of its parameter.
fn scaled_spline(face: usize, scale: impl Fn(DVec2) -> f64) -> BSplineSurface<DVec3> {
    let (cells, h) = (24, 0.15);
    let count = cells + 3;
    let knots = || (0..count + 4).map(|i| (i as f64 - 3.0) * h - 0.5 * cells as f64 * h).collect::<Vec<_>>();
    let f = |i: isize, j: isize| {
        let g = |k: isize| (k as f64 - 1.0) * h - 0.5 * cells as f64 * h;
        let at = DVec2::new(g(i), g(j));
        point(face, at) * scale(at)
    };
    let net = (0..count as isize)
        .flat_map(|i| (0..count as isize).map(move |j| (i, j)))
        .map(|(i, j)| {
            // c = f − (h²/6) Δf removes the error of order h² of the control points f(Greville).
            let laplace = f(i + 1, j) + f(i - 1, j) + f(i, j + 1) + f(i, j - 1) - 4.0 * f(i, j);
            f(i, j) - laplace / 6.0
        })
        .collect();
    BSplineSurface::new([3, 3], [knots(), knots()], net).unwrap()
}

fn cube() -> Network {
    let corner_points: Vec<DVec3> =
        (0..8).map(|i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)).normalize()).collect();
    fn sign(i: usize, b: usize) -> f64 {
        if i >> b & 1 == 0 { 1.0 } else { -1.0 }
    }
    // Faces as loops of corners, counter-clockwise in their own chart.
    let faces: Vec<Vec<usize>> = (0..6)
        .map(|f| {
            let n = frame(f)[2];
            let mut c: Vec<usize> = (0..8).filter(|&i| corner_points[i].dot(n) > 0.1).collect();
            c.sort_by(|&a, &b| {
                let angle = |i: usize| parameter(f, corner_points[i]).to_angle();
                angle(a).total_cmp(&angle(b))
            });
            c
        })
        .collect();
    let mut arcs: Vec<ArcCurve> = Vec::new();
    for (f, loop_) in faces.iter().enumerate() {
        for k in 0..4 {
            let (a, b) = (loop_[k], loop_[(k + 1) % 4]);
            if a > b {
                continue;
            }
            let right = (0..6).find(|&g| g != f && faces[g].contains(&a) && faces[g].contains(&b)).unwrap();
            let samples = (0..=64)
                .map(|i| {
                    let t = i as f64 / 64.0;
                    let x = (corner_points[a] * (1.0 - t) + corner_points[b] * t).normalize();
                    ArcSample { position: x, left: parameter(f, x), right: parameter(right, x) }
                })
                .collect();
            arcs.push(ArcCurve { corners: [a, b], left: f, right, samples });
        }
    }
    let corners = (0..8)
        .map(|c| {
            // Counter-clockwise: the arc whose left segment is the right one of the next arc.
            let ends: Vec<ArcEnd> = arcs
                .iter()
                .enumerate()
                .filter(|(_, a)| a.corners.contains(&c))
                .map(|(arc, a)| ArcEnd { arc, starts: a.corners[0] == c })
                .collect();
            let left = |e: &ArcEnd| if e.starts { arcs[e.arc].left } else { arcs[e.arc].right };
            let right = |e: &ArcEnd| if e.starts { arcs[e.arc].right } else { arcs[e.arc].left };
            let mut ordered = vec![ends[0]];
            while ordered.len() < ends.len() {
                let next = ends.iter().find(|e| right(e) == left(ordered.last().unwrap())).unwrap();
                ordered.push(*next);
            }
            Corner { arcs: ordered, widest: f64::INFINITY }
        })
        .collect();
    Network {
        surfaces: (0..6).map(|f| Arc::new(spline(f))).collect(),
        corners,
        arcs,
        diagonal: 12.0_f64.sqrt(),
    }
}

#[track_caller]
fn check_c2(options: WidthOptions) {
    let blend = blend(&cube(), &PaperMaps, &options).unwrap();
    let [position, normal, curvature] = jumps(&blend.surface);
    // The bounds of the specification for the sphere in eight charts.
    assert!(
        position <= 4e-15 && normal <= 5e-12 && curvature <= 1e-9,
        "{position:e} {normal:e} {curvature:e}"
    );
    let edges: usize = blend.surface.patches().iter().map(|p| p.domain().edge_count()).sum();
    assert_eq!(edges, 2 * blend.surface.seams().len(), "an edge has no seam");
}

#[test]
fn fidelity_is_c2() {
    check_c2(WidthOptions::default());
}

#[test]
fn fillet_is_c2() {
    check_c2(WidthOptions { intent: Intent::Fillet, ..WidthOptions::default() });
}

#[test]
fn unequal_widths_are_c2() {
    let mut network = cube();
    // One short arc narrows two corners; the widths vary along the arcs that leave them.
    for s in &mut network.arcs[0].samples {
        s.position *= 0.1;
    }
    let blend = blend(&network, &PaperMaps, &WidthOptions::default()).unwrap();
    assert!(blend.widths.corner.iter().any(|w| *w < 0.9 * blend.widths.corner[7]));
    let [position, normal, curvature] = jumps(&blend.surface);
    assert!(
        position <= 4e-15 && normal <= 5e-12 && curvature <= 1e-8,
        "{position:e} {normal:e} {curvature:e}"
    );
}

#[test]
fn the_blend_stays_on_the_sphere() {
    let blend =
        blend(&cube(), &PaperMaps, &WidthOptions { wanted: 0.04, ..WidthOptions::default() }).unwrap();
    for patch in blend.surface.patches() {
        if let PatchKind::NBlend { .. } | PatchKind::AdjacentStrip | PatchKind::Strip { .. } = patch.kind() {
            let at = match patch.kind() {
                PatchKind::NBlend { .. } => DVec2::ZERO,
                _ => DVec2::splat(0.5),
            };
            let jet = patch.jet(at);
            let (n, form) = shape(&jet);
            // Spline error about 2e-5, paper maps add κδ²/8.
            assert!((jet.p.length() - 1.0).abs() < 2e-4, "{}", jet.p.length());
            assert!(n.dot(jet.p) > 0.99, "normals point outwards");
            let mean = -0.5 * (form.x_axis.x + form.y_axis.y + form.z_axis.z);
            assert!((mean - 1.0).abs() < 0.06, "{mean}");
        }
    }
}

#[test]
fn blends_keep_away_from_where_a_surface_flies_off() {
    let options = WidthOptions { wanted: 0.06, ..WidthOptions::default() };
    let clean = blend(&cube(), &PaperMaps, &options).unwrap().widths;
    let mut network = cube();
    // The first segment ends at 1; its surface leaves the sphere where only the widest blends reach.
    let flight = |p: DVec2| 1.0 + 100.0 * (p.abs().max_element() - 1.05).max(0.0).powi(2);
    network.surfaces[0] = Arc::new(scaled_spline(0, flight));
    let wild = blend(&network, &PaperMaps, &options).unwrap().widths;
    for (c, corner) in network.corners.iter().enumerate() {
        let beside =
            corner.arcs.iter().any(|e| [network.arcs[e.arc].left, network.arcs[e.arc].right].contains(&0));
        assert_eq!(wild.corner[c] < clean.corner[c], beside, "{c}: {} {}", wild.corner[c], clean.corner[c]);
    }
}

#[test]
fn too_wide_is_refused_with_the_arc() {
    let options = WidthOptions { d_in: Some(0.4), ..WidthOptions::default() };
    let error = blend(&cube(), &PaperMaps, &options).unwrap_err();
    let BlendError::Obstacles { first, arcs, .. } = &error else { panic!("{error}") };
    let BlendError::ArcTooShort { arc, .. } = **first else { panic!("{first}") };
    assert!(arcs.contains(&arc), "{arcs:?}");
}

/// A point of every blending patch.
fn points(blend: &Blend) -> Vec<DVec3> {
    let blends = blend.surface.patches().iter().filter(|p| p.kind() != PatchKind::Trimmed);
    blends.map(|p| p.jet(DVec2::new(0.2, 0.1)).p).collect()
}

#[test]
fn redrawn_arcs_give_what_a_fresh_start_gives() {
    let options = WidthOptions { wanted: 0.06, ..WidthOptions::default() };
    let maps = Correspondence::default();
    let mut sewing = Sewing::new(cube(), &maps, &options).unwrap();
    let first = points(&sewing.sew().unwrap());
    let mut other = cube();
    let mut k = 0;
    other.arcs[0].samples.retain(|_| {
        k += 1;
        k % 8 != 3
    });
    sewing.redraw(other.clone()).unwrap();
    let again = points(&sewing.sew().unwrap());
    let fresh = points(&blend(&other, &maps, &options).unwrap());
    assert!(again == fresh && again != first);
    let mut fewer = cube();
    fewer.arcs.pop();
    assert!(sewing.redraw(fewer).is_err());
}

#[test]
fn blends_that_fold_are_named_to_those_who_are_strict() {
    let options = WidthOptions { wanted: 0.06, ..WidthOptions::default() };
    let mut network = cube();
    // Both sides meet far beyond the arc: the strips run back and forth although no map folds.
    let last = (network.arcs[0].samples.len() - 1) as f64;
    for (k, sample) in network.arcs[0].samples.iter_mut().enumerate() {
        let t = k as f64 / last;
        let beyond = 1.0 + 0.12 * (4.0 * t * (1.0 - t)).powi(3);
        sample.left *= beyond;
        sample.right *= beyond;
    }
    let mut sewing = Sewing::new(network, &PaperMaps, &options).unwrap();
    sewing.be_strict(true);
    let error = sewing.sew().unwrap_err();
    let BlendError::Obstacles { first, arcs, .. } = &error else { panic!("{error}") };
    assert!(matches!(**first, BlendError::Crumpled { .. }) && *arcs == [0], "{error} {arcs:?}");
    sewing.be_strict(false);
    assert!(sewing.sew().is_ok());
}
