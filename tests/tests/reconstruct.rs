//! The main job on the project's own meshes, and on real ones where they are at hand.

use glam::DVec3;
use suture::certify::deviation;
use suture::mesh::TriMesh;
use suture::segment::Labels;
use suture::surface::{Continuity, PatchKind};
use suture::{Reconstruction, mesh::check, samples};
use suture_tests::{PAPER, labels, mapped, mesh, own, run, run_automatic, shared};

/// What every reconstruction must fulfil.
#[track_caller]
fn check_whole(name: &str, input: &TriMesh, r: &Reconstruction) {
    let c = &r.certificate;
    assert_eq!((c.claimed, c.measured, c.open_edges), (Continuity::C2, Some(Continuity::C2), 0), "{name}");
    assert!(c.position <= 1e-12 && c.normal <= 1e-9 && c.curvature <= 1e-6, "{name}: {c:?}");
    let t = check(&r.tessellation.mesh);
    assert!(t.closed && t.manifold && t.oriented, "{name}: {t}");
    assert_eq!(t.genus, check(input).genus, "{name}");
}

#[test]
fn paper_shapes_with_labels() {
    for (name, triangles, segments, gons, _) in PAPER {
        let input = mesh(&own(&format!("paper/{name}.obj")));
        let r = run(&input, Box::new(labels(&own(&format!("paper/{name}.labels"))))).unwrap();
        check_whole(name, &input, &r);
        let count =
            r.blend.surface.patches().iter().filter(|p| matches!(p.kind(), PatchKind::NBlend { .. })).count();
        assert_eq!(
            (input.faces.len(), r.segmentation.charts.len(), count),
            (triangles, segments, gons),
            "{name}"
        );
    }
}

#[test]
fn paper_shapes_without_labels() {
    for (name, ..) in PAPER {
        let input = mesh(&own(&format!("paper/{name}.obj")));
        let r = run_automatic(&input).unwrap_or_else(|e| panic!("{name}: {e}"));
        check_whole(name, &input, &r);
    }
}

/// Compares every tessellation vertex with a closed form that gives the distance from the true surface and its mean curvature.
#[track_caller]
fn check_closed_form(file: &str, label: &str, truth: impl Fn(DVec3) -> (f64, f64)) {
    let mut worst = 0.0_f64;
    let (Some(file), Some(label)) = (shared(file), shared(label)) else { return };
    let input = mesh(&file);
    let r = run(&input, Box::new(labels(&label))).unwrap();
    check_whole(&file.display().to_string(), &input, &r);
    for (p, patch) in r
        .tessellation
        .corner_parameters
        .iter()
        .flatten()
        .zip(r.tessellation.triangle_patch.iter().flat_map(|id| [id; 3]))
    {
        let j = r.blend.surface.patch(*patch).unwrap().jet(*p);
        let (distance, curvature) = truth(j.p);
        assert!(distance.abs() <= 1e-4 * input.diagonal(), "{distance:e}");
        let n = j.normal().unwrap();
        let (e, f, g) = (j.du.dot(j.du), j.du.dot(j.dv), j.dv.dot(j.dv));
        let (l, m, k) = (j.duu.dot(n), j.duv.dot(n), j.dvv.dot(n));
        let mean = -0.5 * (e * k - 2.0 * f * m + g * l) / (e * g - f * f);
        worst = worst.max((mean / curvature - 1.0).abs());
    }
    println!("largest relative error of the mean curvature: {worst:.3}");
    assert!(worst <= 0.05, "{worst}");
}

#[test]
fn a_sphere_is_a_sphere() {
    check_closed_form("good/sphere.obj", "labels/sphere.cube6.labels", |x| (x.length() - 1.0, 1.0));
}

#[test]
fn a_torus_is_a_torus() {
    check_closed_form("good/torus.obj", "labels/torus.grid8.labels", |x| {
        let (major, minor) = (1.0, 0.25);
        let around = x.x.hypot(x.z);
        let tube = (around - major).hypot(x.y);
        (tube - minor, 0.5 * (1.0 / minor + (around - major) / tube / around))
    });
}

#[test]
fn real_meshes_with_labels() {
    // The smaller ones: the whole collection is measured by `cargo run --release -p suture-tests --bin measure`.
    for (file, label, rms, max) in [
        ("good/torus.obj", "labels/torus.grid8.labels", 1e-4, 1e-3),
        ("good/blobby.off", "labels/blobby.vor.labels", 2e-3, 2e-2),
        ("good/spot.obj", "labels/spot.vor.labels", 2e-3, 2e-2),
    ] {
        let (Some(file), Some(label)) = (shared(file), shared(label)) else { return };
        let input = mesh(&file);
        let r = run(&input, Box::new(labels(&label))).unwrap();
        check_whole(&file.display().to_string(), &input, &r);
        let d = &r.deviation.mesh_to_surface;
        assert!(d.rms <= rms && d.max <= max, "{}: rms {:e}, max {:e}", file.display(), d.rms, d.max);
    }
}

/// Largest distance of points of the first reconstruction, taken along by `there`, from the surface of the second, relative to its size:
/// foot points on the smooth surface, so that neither the tessellations nor the numbering of the patches matter.
fn distance(a: &Reconstruction, b: &Reconstruction, there: impl Fn(DVec3) -> DVec3) -> f64 {
    assert_eq!(a.blend.surface.patches().len(), b.blend.surface.patches().len());
    let points = mapped(&a.tessellation.mesh, there);
    deviation(&points, &b.blend.surface, &samples(&b.tessellation)).unwrap().mesh_to_surface.max
}

fn tetrahedron() -> (TriMesh, Labels) {
    let file = |e: &str| own(&format!("paper/deformed_tetrahedron.{e}"));
    (mesh(&file("obj")), labels(&file("labels")))
}

#[test]
fn scaling_by_powers_of_two_scales_the_result() {
    let (input, given) = tetrahedron();
    let r = run(&input, Box::new(given.clone())).unwrap();
    let auto = run_automatic(&input).unwrap();
    for scale in [2.0_f64.powi(20), 2.0_f64.powi(-20)] {
        let scaled = mapped(&input, |p| p * scale);
        let s = run(&scaled, Box::new(given.clone())).unwrap();
        let d = distance(&r, &s, |p| p * scale);
        assert!(d <= 1e-9, "with labels, scale {scale:e}: {d:e}");
        let s = run_automatic(&scaled).unwrap();
        let d = distance(&auto, &s, |p| p * scale);
        assert!(d <= 1e-9, "without labels, scale {scale:e}: {d:e}");
    }
}

#[test]
fn moving_moves_the_result() {
    // Not turning: the bounding box, to which all lengths refer, does not turn with the mesh.
    let (input, given) = tetrahedron();
    let shift = DVec3::new(8.0, -4.0, 2.0);
    let moved = mapped(&input, |p| p + shift);
    let (a, b) = (run(&input, Box::new(given.clone())).unwrap(), run(&moved, Box::new(given)).unwrap());
    let d = distance(&a, &b, |p| p + shift);
    assert!(d <= 1e-9, "{d:e}");
}

#[test]
fn numbering_does_not_matter_with_labels() {
    let (input, given) = tetrahedron();
    let r = run(&input, Box::new(given.clone())).unwrap();
    let (v, f) = (input.positions.len(), input.faces.len());
    // Multiplication by a number prime to the size is a permutation.
    let (new_v, new_f) = (|i: usize| (i * 37 + 11) % v, |i: usize| (i * 53 + 5) % f);
    let mut shuffled = input.clone();
    let mut shuffled_labels = given.clone();
    for i in 0..v {
        shuffled.positions[new_v(i)] = input.positions[i];
    }
    for i in 0..f {
        let [a, b, c] = input.faces[i].map(|w| new_v(w as usize) as u32);
        shuffled.faces[new_f(i)] = [b, c, a];
        shuffled_labels.0[new_f(i)] = given.0[i];
    }
    let s = run(&shuffled, Box::new(shuffled_labels)).unwrap();
    let d = distance(&r, &s, |p| p);
    assert!(d <= 1e-9, "{d:e}");
}
