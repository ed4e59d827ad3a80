//! Flattening against closed forms, an independent least squares solution, and its invariances.

mod common;

use common::*;
use glam::{DVec2, DVec3};
use suture_mesh::TriMesh;
use suture_param::*;

fn conformal() -> Vec<(&'static str, Box<dyn Parameterize>)> {
    vec![
        ("lscm", Box::new(Lscm::default())),
        ("spectral", Box::new(Spectral::default())),
        ("boundary scale 1", Box::new(BoundaryScaleOne)),
        ("recommended", Box::new(Recommended::default())),
    ]
}

fn all() -> Vec<(&'static str, Box<dyn Parameterize>)> {
    let mut all = conformal();
    all.push(("tutte", Box::new(Tutte)));
    all.push(("symmetric Dirichlet", Box::new(SymmetricDirichlet::default())));
    all
}

/// An irregular planar sheet: jittered grid.
fn plane() -> TriMesh {
    let mut numbers = Numbers(5);
    let mut mesh = grid(9, 7, |x, y| DVec3::new(x, y, 0.0));
    for p in &mut mesh.positions {
        *p += 0.3 * DVec3::new(numbers.next() - 0.5, numbers.next() - 0.5, 0.0);
    }
    mesh
}

/// A bumpy sheet far from developable, but without flips for any method.
fn bump() -> TriMesh {
    grid(12, 10, |x, y| {
        let d = (x - 5.3).powi(2) + (y - 4.6).powi(2);
        DVec3::new(x + 0.2 * (1.3 * y).sin(), y + 0.1 * (0.7 * x).cos(), 3.0 * (-d / 9.0).exp())
    })
}

fn chart(mesh: &TriMesh, method: &impl Parameterize) -> Chart {
    Chart::flatten(whole(mesh), method, &Limits::default()).unwrap()
}

#[test]
fn planar_sheets_are_reproduced() {
    let flat = plane();
    let truth: Vec<DVec2> = flat.positions.iter().map(|p| p.truncate()).collect();
    let tilted = mapped(&flat, |p| turn() * p + DVec3::new(3.0, -2.0, 1.0));
    for (name, method) in conformal() {
        let uv = method.parameterize(&tilted.positions, &tilted.faces).unwrap();
        let error = similarity_error(&uv, &truth);
        assert!(error < if name == "spectral" { 1e-6 } else { 1e-11 }, "{name}: {error:e}");
        let chart = chart(&tilted, &method);
        let stretch = chart.distortion.stretch - 1.0;
        assert!(
            chart.distortion.accepted && stretch < if name == "spectral" { 1e-5 } else { 1e-10 },
            "{name}"
        );
    }
}

#[test]
fn cylinders_and_cones_unroll() {
    let (m, n) = (24, 10);
    let cylinder = grid(m, n, |x, y| DVec3::new((0.08 * x).cos(), (0.08 * x).sin(), 0.1 * y));
    // The facets of a prism unroll exactly, with chords for arcs.
    let chord = 2.0 * (0.04f64).sin();
    let flat = grid(m, n, |x, y| DVec3::new(chord * x, 0.1 * y, 0.0));
    let cone = grid(m, n, |x, y| {
        let r = 1.0 + 0.1 * y;
        DVec3::new(0.6 * r * (0.1 * x).cos(), 0.6 * r * (0.1 * x).sin(), 0.8 * r)
    });
    // Facets of the pyramid: apex angle with 2 sin(α/2) = 0.6 · 2 sin(0.05).
    let alpha = 2.0 * (0.6 * (0.05f64).sin()).asin();
    let fan = grid(m, n, |x, y| ((1.0 + 0.1 * y) * DVec2::from_angle(alpha * x)).extend(0.0));
    for (surface, flat) in [(cylinder, flat), (cone, fan)] {
        let truth: Vec<DVec2> = flat.positions.iter().map(|p| p.truncate()).collect();
        for (name, method) in conformal() {
            let uv = method.parameterize(&surface.positions, &surface.faces).unwrap();
            // The fan is clockwise seen from outside or not: compare with the truth or its mirror image.
            let mirror: Vec<DVec2> = truth.iter().map(|p| DVec2::new(p.x, -p.y)).collect();
            let error = similarity_error(&uv, &truth).min(similarity_error(&uv, &mirror));
            assert!(error < if name == "spectral" { 1e-6 } else { 1e-10 }, "{name}: {error:e}");
        }
    }
}

/// Lévy's own formulation: least squares of Σ_j W_j U_j = 0 per triangle, by dense normal equations.
fn dense_lscm(mesh: &TriMesh, pins: [usize; 2], pin_uv: [DVec2; 2]) -> Vec<DVec2> {
    let n = mesh.positions.len();
    let mut a = vec![vec![0.0; 2 * n]; 2 * n];
    let mut rhs = vec![0.0; 2 * n];
    for face in &mesh.faces {
        let [p, q, r] = face.map(|v| mesh.positions[v as usize]);
        let e = (q - p).normalize();
        let f = (q - p).cross(r - p).normalize().cross(e);
        let z = [DVec2::ZERO, DVec2::new((q - p).dot(e), 0.0), DVec2::new((r - p).dot(e), (r - p).dot(f))];
        let area = 0.5 * (z[1] - z[0]).perp_dot(z[2] - z[0]);
        let w = [z[2] - z[1], z[0] - z[2], z[1] - z[0]].map(|w| w / (2.0 * area).sqrt());
        let mut rows = [vec![], vec![]];
        for k in 0..3 {
            let v = face[k] as usize;
            rows[0].extend([(2 * v, w[k].x), (2 * v + 1, -w[k].y)]);
            rows[1].extend([(2 * v, w[k].y), (2 * v + 1, w[k].x)]);
        }
        for row in rows {
            for &(i, x) in &row {
                for &(j, y) in &row {
                    a[i][j] += x * y;
                }
            }
        }
    }
    for (pin, uv) in pins.into_iter().zip(pin_uv) {
        for (i, value) in [(2 * pin, uv.x), (2 * pin + 1, uv.y)] {
            for j in 0..2 * n {
                rhs[j] -= a[j][i] * value;
                a[j][i] = 0.0;
                a[i][j] = 0.0;
            }
            a[i][i] = 1.0;
            rhs[i] = value;
        }
        for (other, uv) in pins.into_iter().zip(pin_uv) {
            (rhs[2 * other], rhs[2 * other + 1]) = (uv.x, uv.y);
        }
    }
    // Gaussian elimination; the matrix is positive definite.
    for k in 0..2 * n {
        for i in k + 1..2 * n {
            let factor = a[i][k] / a[k][k];
            if factor != 0.0 {
                for j in k..2 * n {
                    a[i][j] -= factor * a[k][j];
                }
                rhs[i] -= factor * rhs[k];
            }
        }
    }
    for k in (0..2 * n).rev() {
        let sum: f64 = (k + 1..2 * n).map(|j| a[k][j] * rhs[j]).sum();
        rhs[k] = (rhs[k] - sum) / a[k][k];
    }
    rhs.chunks(2).map(DVec2::from_slice).collect()
}

#[test]
fn lscm_is_the_least_squares_solution_with_these_pins() {
    let mesh = bump();
    for (pins, pin_uv) in [
        ([0, 142], [DVec2::ZERO, DVec2::X]),
        ([17, 100], [DVec2::new(3.0, -1.0), DVec2::new(-2.0, 5.0)]),
        ([140, 3], [DVec2::new(1e3, 0.0), DVec2::new(1e3, 1.0)]),
    ] {
        let uv = Lscm { pins: Some(pins), pin_uv: Some(pin_uv) }
            .parameterize(&mesh.positions, &mesh.faces)
            .unwrap();
        let truth = dense_lscm(&mesh, pins, pin_uv);
        let size = pin_uv[0].distance(pin_uv[1]);
        for (p, q) in uv.iter().zip(&truth) {
            assert!(p.distance(*q) < 1e-8 * size.max(1e-3 * q.length()), "{p} {q}");
        }
        assert_eq!([uv[pins[0]], uv[pins[1]]], pin_uv);
    }
    let bad = |pins, pin_uv| Lscm { pins, pin_uv }.parameterize(&mesh.positions, &mesh.faces);
    assert!(matches!(bad(Some([3, 3]), None), Err(ParamError::Pins { .. })));
    assert!(matches!(bad(Some([3, 143]), None), Err(ParamError::Pins { .. })));
    assert!(matches!(bad(None, Some([DVec2::ONE; 2])), Err(ParamError::Pins { .. })));
}

/// Conformal energy per area of parameters: (s₁ − s₂)² summed, relative to s₁² + s₂².
fn conformal_energy(mesh: &TriMesh, uv: &[DVec2]) -> f64 {
    let (mut difference, mut sum) = (0.0, 0.0);
    for f in &mesh.faces {
        let [p, q, r] = f.map(|v| mesh.positions[v as usize]);
        let [a, b, c] = f.map(|v| uv[v as usize]);
        let cot = |u: DVec3, v: DVec3| u.dot(v) / u.cross(v).length();
        let dirichlet = 0.25
            * (cot(q - p, r - p) * b.distance_squared(c)
                + cot(r - q, p - q) * c.distance_squared(a)
                + cot(p - r, q - r) * a.distance_squared(b));
        difference += dirichlet - 0.5 * (b - a).perp_dot(c - a);
        sum += dirichlet;
    }
    difference / sum
}

#[test]
fn conformal_maps_are_nearly_conformal_and_boundary_scale_one_has_boundary_scale_one() {
    let mesh = bump();
    for (name, method) in &conformal()[..3] {
        let uv = method.parameterize(&mesh.positions, &mesh.faces).unwrap();
        let energy = conformal_energy(&mesh, &uv);
        assert!(energy > 0.0 && energy < 4e-3, "{name}: {energy:e}");
    }
    let tutte = Tutte.parameterize(&mesh.positions, &mesh.faces).unwrap();
    assert!(conformal_energy(&mesh, &tutte) > 1e-2);
    let uv = BoundaryScaleOne.parameterize(&mesh.positions, &mesh.faces).unwrap();
    let boundary = whole(&mesh).boundary().unwrap();
    for (i, &v) in boundary.iter().enumerate() {
        let w = boundary[(i + 1) % boundary.len()];
        let [v, w] = [v, w].map(|v| v as usize);
        let scale = uv[v].distance(uv[w]) / mesh.positions[v].distance(mesh.positions[w]);
        assert!((scale - 1.0).abs() < 2e-2, "{scale}");
    }
}

#[test]
fn a_hemisphere_becomes_the_stereographic_disc() {
    // Conformal with constant boundary scale: the stereographic projection, whose scale is 2 / (1 + z).
    let mesh = sphere(5);
    let upper: Vec<u32> = (0..mesh.faces.len() / 2).map(|f| f as u32).collect();
    let disc = disc(&mesh, &upper, 0);
    let truth: Vec<DVec2> = disc.positions.iter().map(|p| p.truncate() / (1.0 + p.z)).collect();
    let chart = Chart::flatten(disc, &BoundaryScaleOne, &Limits::default()).unwrap();
    let error = similarity_error(&chart.uv, &truth);
    assert!(error < 2e-3, "{error:e}");
    // Scales 2 at the centre and 1 at the rim, in this normalisation both divided by √2: area ratio 4.
    assert!((chart.distortion.area_ratio - 4.0).abs() < 0.15, "{:?}", chart.distortion);
    let area: f64 = chart
        .disc
        .faces
        .iter()
        .map(|f| f.map(|v| chart.uv[v as usize]))
        .map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a))
        .sum();
    let space: f64 = upper.iter().map(|&f| mesh.area_vector(f as usize).length()).sum();
    assert!((area / space - 1.0).abs() < 1e-12);
}

#[test]
fn symmetric_dirichlet_never_flips_and_its_energy_falls() {
    let mesh = grid(14, 14, |x, y| {
        let d = (x - 7.0).powi(2) + (y - 7.0).powi(2);
        DVec3::new(x, y, 25.0 * (-d / 8.0).exp())
    });
    let mut last = f64::INFINITY;
    for start in [Start::Tutte, Start::Conformal] {
        let mut energies = Vec::new();
        for iterations in [0, 1, 2, 3, 5, 10, 20] {
            let chart = chart(&mesh, &SymmetricDirichlet { start: start.clone(), iterations });
            assert_eq!(chart.distortion.flips, 0);
            energies.push(chart.distortion.energy);
        }
        assert!(energies.windows(2).all(|w| w[1] <= w[0] * (1.0 + 1e-9)), "{energies:?}");
        assert!(energies[6] >= 4.0);
        // Both starts lead to one minimum here.
        if last.is_finite() {
            assert!((energies[6] - last).abs() < 0.02 * last, "{last} {energies:?}");
        }
        last = energies[6];
    }
    let mut uv = Tutte.parameterize(&mesh.positions, &mesh.faces).unwrap();
    uv.iter_mut().for_each(|p| p.x = -p.x);
    let error = SymmetricDirichlet { start: Start::Given(uv), iterations: 3 }
        .parameterize(&mesh.positions, &mesh.faces)
        .unwrap_err();
    assert!(matches!(error, ParamError::Flips { count: 392, .. }), "{error}");
}

#[test]
fn sizes_places_turns_and_numbers_do_not_matter() {
    let mesh = bump();
    let (other, vertices, _) = renumbered(&mesh, 3);
    for (name, method) in all() {
        // Parameters by mesh vertex: a chart numbers its vertices as its faces name them.
        let by_vertex = |mesh: &TriMesh| {
            let chart = chart(mesh, &method);
            let mut uv = vec![DVec2::ZERO; chart.uv.len()];
            for (p, &v) in chart.uv.iter().zip(&chart.disc.vertices) {
                uv[v as usize] = *p;
            }
            uv
        };
        let base = by_vertex(&mesh);
        let extent = base.iter().map(|p| p.length()).fold(0.0, f64::max);
        let check = |what: &str, uv: &[DVec2], tolerance: f64| {
            let error = base.iter().zip(uv).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max) / extent;
            assert!(error <= tolerance, "{name}, {what}: {error:e}");
        };
        for s in [2f64.powi(20), 2f64.powi(-20)] {
            let uv = by_vertex(&mapped(&mesh, |p| p * s));
            let uv: Vec<DVec2> = uv.iter().map(|p| *p / s).collect();
            check("scale", &uv, 0.0);
        }
        let loose = if name == "spectral" { 1e-6 } else { 1e-9 };
        check("turn", &by_vertex(&mapped(&mesh, |p| turn() * p)), loose);
        check("offset", &by_vertex(&mapped(&mesh, |p| p + DVec3::new(1e8, -1e8, 1e8))), 1e-5);
        let uv = by_vertex(&other);
        let uv: Vec<DVec2> = vertices.iter().map(|&v| uv[v as usize]).collect();
        check("numbers", &uv, loose);
    }
}

#[test]
fn single_triangles_and_slivers_survive() {
    let one = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    let collapsed = TriMesh::new(vec![DVec3::ONE; 3], vec![[0, 1, 2]]);
    // A row of needles: heights 1e-3 … 1e-18 of the width, the last ones degenerate in f64.
    let needles = grid(1, 18, |x, y| DVec3::new(x, 10f64.powf(-y), 1e-3 * x * y));
    // A sheet with coinciding vertices.
    let mut pinched = bump();
    pinched.positions[40] = pinched.positions[41];
    pinched.positions[80] = pinched.positions[81];
    pinched.positions[82] = pinched.positions[81];
    for (name, method) in all() {
        let chart = chart(&one, &method);
        let area = 0.5 * (chart.uv[1] - chart.uv[0]).perp_dot(chart.uv[2] - chart.uv[0]);
        assert!((area - 0.5).abs() < 1e-9, "{name}");
        assert!(method.parameterize(&collapsed.positions, &collapsed.faces).is_err());
        for mesh in [&needles, &pinched] {
            match method.parameterize(&mesh.positions, &mesh.faces) {
                Ok(uv) => assert!(uv.iter().all(|p| p.is_finite()), "{name}"),
                Err(e) => println!("{name}: {e}"),
            }
        }
    }
    let chart = chart(&pinched, &Recommended::default());
    assert_eq!(chart.distortion.flips, 0);
}

#[test]
fn hopeless_input_is_an_error() {
    let mesh = bump();
    let mut broken = mesh.positions.clone();
    broken[7].y = f64::INFINITY;
    let closed = torus(5, 5);
    for (name, method) in all() {
        let error = method.parameterize(&broken, &mesh.faces).unwrap_err();
        assert!(matches!(error, ParamError::NotFinite { vertex: 7, .. }), "{name}");
        let error = method.parameterize(&closed.positions, &closed.faces).unwrap_err();
        assert!(matches!(error, ParamError::NotDisc { .. }), "{name}");
        assert_eq!(method.parameterize(&[], &[]).unwrap_err(), ParamError::Empty);
        let huge: Vec<DVec3> = mesh.positions.iter().map(|p| *p * 1e307).collect();
        let _ = method.parameterize(&huge, &mesh.faces);
        let tiny: Vec<DVec3> = mesh.positions.iter().map(|p| *p * 1e-320).collect();
        let _ = method.parameterize(&tiny, &mesh.faces);
    }
}

#[test]
fn charts_find_their_copies_and_survive_json() {
    let mesh = torus(7, 5);
    let chart =
        Chart::flatten(disc(&mesh, &[0, 1, 2, 3], 6), &Recommended::default(), &Limits::default()).unwrap();
    let mut found = 0;
    for f in 0..mesh.faces.len() as u32 {
        for c in chart.copies(f) {
            assert_eq!(chart.disc.mesh_faces[c], f);
            found += 1;
        }
    }
    assert_eq!(found, chart.disc.faces.len());
    assert!(chart.copies(0).count() > 1 && chart.disc.in_segment[chart.copies(0).next().unwrap()]);
    assert_eq!(chart.copies(1000).count(), 0);
    let [a, b, c] = chart.corners(5);
    assert!(chart.at(5, [0.2, 0.3, 0.5]).distance(0.2 * a + 0.3 * b + 0.5 * c) < 1e-15);
    assert_eq!(chart.at(5, [1.0, 0.0, 0.0]), a);

    let json = serde_json::to_string(&chart).unwrap();
    let again: Chart = serde_json::from_str(&json).unwrap();
    assert!(again == chart, "floats must survive to the bit");
    let broken = json.replacen("\"uv\":[[", "\"uv\":[[1.0,2.0],[", 1);
    let error = serde_json::from_str::<Chart>(&broken).unwrap_err().to_string();
    assert!(error.contains("parameters"), "{error}");

    let mirrored = chart.uv.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
    let n = chart.disc.faces.len();
    let flipped = chart.with_uv(mirrored).unwrap();
    assert_eq!(flipped.distortion.flips, n);
    assert!(matches!(flipped.with_uv(vec![]), Err(ParamError::Length { .. })));
}

/// Two open discs of the public data on which plain LSCM fails.
#[test]
fn plain_lscm_fails_where_the_recommended_method_does_not() {
    if let Some(mesh) = mesh("good/three_peaks.off") {
        let plain = chart(&mesh, &Lscm::default()).distortion;
        println!("three_peaks, LSCM: {plain:?}");
        let good = chart(&mesh, &Recommended::default()).distortion;
        println!("three_peaks, recommended: {good:?}");
        assert!(plain.flips > 0);
        assert_eq!(good.flips, 0);
    }
    if let Some(mesh) = mesh("good/hand_lowres.obj") {
        match Chart::flatten(whole(&mesh), &Lscm::default(), &Limits::default()) {
            Ok(c) => {
                println!("hand_lowres, LSCM: {:?}", c.distortion);
                assert!(c.distortion.flips > 0 || c.distortion.area_ratio > 1e4);
            }
            Err(e) => println!("hand_lowres, LSCM: {e}"),
        }
        let good = chart(&mesh, &Recommended::default()).distortion;
        println!("hand_lowres, recommended: {good:?}");
        assert_eq!(good.flips, 0);
    }
}
