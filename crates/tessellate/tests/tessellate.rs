//! Closedness, shape, accuracy, determinism of whole surfaces.

mod common;

use common::{Map, blended_sphere, cube_sphere, patch, sew, single, trimmed};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use suture_bernstein::BezierCurve;
use suture_mesh::Topology;
use suture_surface::{Domain, PatchKind, Surface};
use suture_tessellate::{TessellateError, Tessellation, TessellationOptions, tessellate};

fn options(chord: f64, angle: f64) -> TessellationOptions {
    TessellationOptions { chord, angle, ..Default::default() }
}

/// Tessellates; the mesh must be a manifold of the given Euler characteristic, closed or not, positively oriented in every
/// parameter plane, every vertex where its patch says.
#[track_caller]
fn check(surface: &Surface, options: &TessellationOptions, closed: bool, euler: i64) -> Tessellation {
    let t = tessellate(surface, options).unwrap();
    let topology = Topology::build(&t.mesh).unwrap();
    assert_eq!(topology.is_closed(), closed);
    let edges: usize = (0..topology.half_edge_count() as u32)
        .filter(|&h| topology.opposite(h).is_none_or(|o| h < o))
        .count();
    assert_eq!(t.mesh.positions.len() as i64 - edges as i64 + t.mesh.faces.len() as i64, euler);
    assert_eq!(t.triangle_patch.len(), t.mesh.faces.len());
    assert_eq!(t.vertex_patch.len(), t.mesh.positions.len());
    let size = t.mesh.diagonal();
    for (f, [a, b, c]) in t.corner_parameters.iter().enumerate() {
        assert!((*b - *a).perp_dot(*c - *a) > 0.0, "triangle {f} is mirrored: {a} {b} {c}");
        let patch = surface.patch(t.triangle_patch[f]).unwrap();
        for (&at, p) in [a, b, c].into_iter().zip(t.mesh.corners(f)) {
            assert!(patch.jet(at).p.distance(p) < 1e-12 * size);
        }
    }
    for (v, p) in t.mesh.positions.iter().enumerate() {
        let patch = surface.patch(t.vertex_patch[v]).unwrap();
        assert_eq!(patch.jet(t.vertex_parameter[v]).p, *p);
    }
    t
}

/// Largest distance of edge midpoints and centroids from the unit sphere, relative to its diagonal.
fn sagitta(t: &Tessellation) -> f64 {
    (0..t.mesh.faces.len())
        .flat_map(|f| {
            let [a, b, c] = t.mesh.corners(f);
            [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]
        })
        .fold(0.0, |m: f64, p| m.max(1.0 - p.length()))
        / 12.0_f64.sqrt()
}

/// In degrees, over the triangles that `keep` selects.
fn smallest_angle(t: &Tessellation, keep: impl Fn(usize) -> bool) -> f64 {
    (0..t.mesh.faces.len())
        .filter(|&f| keep(f))
        .flat_map(|f| {
            let p = t.mesh.corners(f);
            [0, 1, 2].map(|k| (p[(k + 1) % 3] - p[k]).angle_between(p[(k + 2) % 3] - p[k]).to_degrees())
        })
        .fold(180.0, f64::min)
}

#[test]
fn six_rectangles_make_a_closed_sphere() {
    let t = check(&cube_sphere(1.0), &Default::default(), true, 2);
    for (p, n) in t.mesh.positions.iter().zip(t.mesh.normals.unwrap()) {
        assert!((p.length() - 1.0).abs() < 1e-15 && p.distance(n) < 1e-13);
    }
}

#[test]
fn trimmed_strips_and_blends_make_a_closed_sphere() {
    for pieces in [1, 2, 5] {
        let surface = blended_sphere(pieces, 1.0);
        let t = check(&surface, &Default::default(), true, 2);
        let kind = |f: usize| surface.patch(t.triangle_patch[f]).unwrap().kind();
        let [trimmed, regular] =
            [true, false].map(|free| smallest_angle(&t, |f| (kind(f) == PatchKind::Trimmed) == free));
        println!("{pieces}: {} triangles, {trimmed:.1}°, {regular:.1}°", t.mesh.faces.len());
        assert!(trimmed > 10.0 && regular > 3.0);
        // Patches that meet in one point share one vertex.
        let mut positions = t.mesh.positions.clone();
        positions.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
        assert!(positions.windows(2).all(|w| w[0].distance(w[1]) > 1e-6));
        assert!(surface.seams().iter().all(|s| !s.same_direction));
    }
}

#[test]
fn chords_stay_within_the_tolerance() {
    for surface in [cube_sphere(1.0), blended_sphere(3, 1.0)] {
        for chord in [1e-2, 1e-3, 1e-4, 1e-5] {
            let mut o = options(chord, 3.0);
            o.max_edge = 10.0;
            let t = check(&surface, &o, true, 2);
            println!("{chord:e}: {} triangles, {:.2e}", t.mesh.faces.len(), sagitta(&t));
            assert!(sagitta(&t) < 1.2 * chord, "{} > {chord}", sagitta(&t));
            // Nor wastefully finer: a factor 20 in the sagitta is 4.5 in the length of edges.
            assert!(chord > 2e-3 || sagitta(&t) > 0.05 * chord);
        }
    }
}

#[test]
fn normals_turn_by_no_more_than_the_angle() {
    for surface in [cube_sphere(1.0), blended_sphere(3, 1.0)] {
        for angle in [0.5, 0.1] {
            let t = check(&surface, &options(1.0, angle), true, 2);
            for f in 0..t.mesh.faces.len() {
                let [a, b, c] = t.mesh.corners(f);
                // Diagonals are longer than the edges of the grid.
                let turn = a.angle_between(b).max(b.angle_between(c)).max(c.angle_between(a));
                assert!(turn < 1.6 * angle, "{turn} at {angle}");
            }
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let surface = blended_sphere(4, 1.0);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| tessellate(&surface, &Default::default()).unwrap())
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn scaling_by_powers_of_two_scales_the_positions() {
    let one = tessellate(&blended_sphere(3, 1.0), &Default::default()).unwrap();
    for k in [-20, 20] {
        let scale = 2.0_f64.powi(k);
        let other = tessellate(&blended_sphere(3, scale), &Default::default()).unwrap();
        assert_eq!(one.mesh.faces, other.mesh.faces);
        assert_eq!(one.corner_parameters, other.corner_parameters);
        let scaled: Vec<DVec3> = one.mesh.positions.iter().map(|p| *p * scale).collect();
        assert_eq!(scaled, other.mesh.positions);
    }
}

#[test]
fn a_patch_sewn_to_itself_closes() {
    let (turn, pole) = (std::f64::consts::TAU, std::f64::consts::FRAC_PI_2);
    check(&single(Map::Torus, DVec2::ZERO, DVec2::ONE), &Default::default(), true, 0);
    // Coarse enough that the least number of segments decides.
    check(&single(Map::Torus, DVec2::ZERO, DVec2::ONE), &options(1.0, turn), true, 0);
    check(&single(Map::Torus, DVec2::ZERO, DVec2::new(1.0, 0.5)), &Default::default(), false, 0);
    let globe = single(Map::Globe, DVec2::new(0.0, -pole), DVec2::new(1.0, pole));
    let t = check(&globe, &Default::default(), true, 2);
    // The poles are one vertex each, with the mean normal.
    let poles: Vec<usize> =
        (0..t.mesh.positions.len()).filter(|&v| t.mesh.positions[v].z.abs() > 1.0 - 1e-12).collect();
    assert_eq!(poles.len(), 2);
    let normals = t.mesh.normals.as_ref().unwrap();
    assert!(poles.iter().all(|&v| normals[v].dot(t.mesh.positions[v]) > 0.99));
}

#[test]
fn a_trimmed_bump_is_refined_where_it_bends() {
    let square = |r: f64| vec![[-r, -r], [r, -r], [r, r], [-r, r]];
    let mut hole = square(0.1);
    hole.reverse();
    let surface = trimmed(Map::Bump, &[square(2.0), hole]);
    let t = check(&surface, &options(1e-4, 0.2), false, 0);
    println!("{} triangles, {:.1}°", t.mesh.faces.len(), smallest_angle(&t, |_| true));
    let area = |near: bool| {
        let (mut sum, mut count) = (0.0, 0.0);
        for [a, b, c] in &t.corner_parameters {
            if (((*a + *b + *c) / 3.0).length() < 0.8) == near {
                sum += 0.5 * (*b - *a).perp_dot(*c - *a);
                count += 1.0;
            }
        }
        (sum, sum / count)
    };
    assert!((area(true).0 + area(false).0 - (16.0 - 0.04)).abs() < 1e-9);
    assert!(area(true).1 < 0.2 * area(false).1);
    for [a, b, c] in &t.corner_parameters {
        for m in [(*a + *b) / 2.0, (*b + *c) / 2.0, (*c + *a) / 2.0] {
            let g = |p: DVec2| 0.5 * (-4.0 * p.length_squared()).exp();
            let [x, y] = if m == (*a + *b) / 2.0 {
                [*a, *b]
            } else if m == (*b + *c) / 2.0 {
                [*b, *c]
            } else {
                [*c, *a]
            };
            assert!((g(m) - 0.5 * (g(x) + g(y))).abs() < 2.0 * 1e-4 * 5.7, "{m}");
        }
    }
}

#[test]
fn opposite_edges_that_disagree_are_triangulated_freely() {
    // One edge with ten waves against a straight one.
    let wave: Vec<DVec2> =
        (0..=30).map(|i| DVec2::new(i as f64 / 30.0, if i % 2 == 0 { 0.0 } else { 3.0 })).collect();
    let straight = vec![DVec2::new(0.0, 5.0), DVec2::new(1.0, 5.0)];
    let curves = [BezierCurve::new(wave).unwrap(), BezierCurve::new(straight).unwrap()];
    let map = Map::Ruled([DVec3::ZERO, DVec3::X, DVec3::Y], Box::new(curves));
    let surface = sew(vec![patch(common::UNIT, map, false, PatchKind::Trimmed)], 1.0);
    let mut o = options(1e-5, 0.2);
    o.max_edge = 10.0;
    check(&surface, &o, false, 1);
}

#[test]
fn close_curves_are_refined_until_their_polylines_do_not_cross() {
    // A lens between two concentric arcs, much thinner than the sagitta of a coarse chord.
    let arc =
        |r: f64| vec![DVec2::new(-1.0, 0.0), DVec2::new(-1.0, r), DVec2::new(1.0, r), DVec2::new(1.0, 0.0)];
    let mut back = arc(1.05);
    back.reverse();
    let outer = [
        vec![DVec2::new(-1.0, 0.0), DVec2::new(-1.0, 1.0), DVec2::new(1.0, 1.0), DVec2::new(1.0, 0.0)],
        back,
    ];
    let curves = outer.map(|net| BezierCurve::new(net).unwrap()).to_vec();
    let map = Map::Affine([DVec3::ZERO, DVec3::X, DVec3::Y]);
    let surface = sew(vec![patch(Domain::Trimmed(vec![curves]), map, false, PatchKind::Trimmed)], 1.0);
    check(&surface, &options(0.5, 3.0), false, 1);
}

#[test]
fn defects_are_errors_with_their_place() {
    let flat = Map::Affine([DVec3::ZERO, DVec3::X, DVec3::Y]);
    let run = |surface: &Surface| tessellate(surface, &Default::default()).unwrap_err();
    let clockwise = trimmed(flat.clone(), &[vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]]);
    assert_eq!(run(&clockwise), TessellateError::Orientation { patch: 0, ring: 0, area: -1.0 });
    let crossed = trimmed(flat.clone(), &[vec![[0.0, 0.0], [2.0, 0.0], [0.5, 2.0], [1.0, -1.0]]]);
    assert!(matches!(run(&crossed), TessellateError::SelfIntersection { patch: 0, .. }));
    // A hole that touches the outer loop.
    let touching = trimmed(
        flat.clone(),
        &[vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], vec![[0.0, 1.0], [1.0, 1.5], [1.0, 0.5]]],
    );
    assert!(matches!(run(&touching), TessellateError::SelfIntersection { patch: 0, .. }));
    // A hole outside the outer loop.
    let outside = trimmed(
        flat,
        &[vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], vec![[3.0, 0.0], [3.0, 1.0], [4.0, 0.5]]],
    );
    assert!(matches!(run(&outside), TessellateError::SelfIntersection { patch: 0, .. }));
    let nan = single(Map::Affine([DVec3::splat(f64::NAN), DVec3::X, DVec3::Y]), DVec2::ZERO, DVec2::ONE);
    assert!(matches!(run(&nan), TessellateError::NotFinite { patch: 0, .. }));
    let point = single(Map::Affine([DVec3::ONE, DVec3::ZERO, DVec3::ZERO]), DVec2::ZERO, DVec2::ONE);
    assert_eq!(run(&point), TessellateError::Point);
    let inverted = single(Map::Torus, DVec2::ONE, DVec2::ZERO);
    assert!(matches!(run(&inverted), TessellateError::Domain { patch: 0, .. }));
    assert_eq!(run(&Surface::default()), TessellateError::Empty);
    for bad in [options(0.0, 0.2), options(f64::NAN, 0.2), options(1e-3, -1.0)] {
        assert!(matches!(tessellate(&cube_sphere(1.0), &bad), Err(TessellateError::Option { .. })));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_tolerances_close_the_sphere(
        chord in -4.0..0.0_f64, angle in -1.5..1.0_f64, edge in -1.5..1.0_f64, most in 4usize..64, pieces in 1usize..5,
    ) {
        let o = TessellationOptions {
            chord: 10f64.powf(chord), angle: 10f64.powf(angle), max_edge: 10f64.powf(edge), max_segments: most,
        };
        check(&blended_sphere(pieces, 1.0), &o, true, 2);
    }
}
