//! The numbers of the specification, section 13.

mod common;

use common::{figure, wall_jumps};
use glam::DVec3;
use suture_apatch::{ApatchOptions, ApexWeight, Class, Side, apatch};

fn paper() -> ApatchOptions {
    ApatchOptions { weight: ApexWeight::Paper, refinements: 0, ..ApatchOptions::default() }
}

#[track_caller]
fn near(got: DVec3, want: [f64; 3]) {
    let want = DVec3::from_array(want);
    assert!((got - want).abs().max_element() < 1e-10, "{got} ≠ {want}");
}

#[test]
fn figure_6_has_the_points_of_the_table() {
    let (mesh, normals) = figure(6);
    let s = apatch(&mesh, &normals, &paper()).unwrap();
    assert_eq!(s.face_classes(), [Class::Positive; 2]);
    let (apex, weight) = s.apex(0, Side::Positive).unwrap();
    near(apex, [0.0, 2.41666666666667, 4.0]);
    assert!((weight - 3.30555555555556).abs() < 1e-11);
    let bound = s.face_bound(0, Side::Positive, 1e-4, 100_000).unwrap();
    assert!((bound.attained + 1.0).abs() < 1e-3 && (bound.proven + 1.0).abs() < 1e-3, "{bound:?}");
    let table: [([f64; 3], [f64; 3], [f64; 3]); 4] = [
        (
            [0.5, 0.3, 0.2],
            [-0.302466450833, 1.19419809455, 0.824102266251],
            [-0.149925653704, 0.284825349069, 0.946782350326],
        ),
        ([1.0 / 3.0; 3], [0.0, 1.59343889628, 0.707088918462], [0.0, 0.375567125003, 0.926795195616]),
        ([0.2, 0.2, 0.6], [0.0, 2.40323946131, 0.294091322689], [0.0, 0.523148472918, 0.852241559233]),
        ([0.5, 0.5, 0.0], [0.0, 0.593049470076, 0.981599122885], [0.0, 0.14198738433, 0.989868467369]),
    ];
    for (q, p, n) in table {
        let point = s.face_point(0, q).unwrap();
        near(point.position, p);
        near(point.normal(), n);
        // The other face is the first one turned by half a turn.
        let point = s.face_point(1, q).unwrap();
        near(point.position, [-p[0], -p[1], p[2]]);
        near(point.normal(), [-n[0], -n[1], n[2]]);
    }
    let e = (0..s.edge_count()).find(|&e| s.edge_vertices(e) == Some([0, 1])).unwrap();
    let table = [
        (0.5, 0.5, [0.0, 0.0, 1.02417658979], [0.0, 0.0, 1.0]),
        (
            0.3,
            0.25,
            [0.616933743453, -0.276506324993, 0.915331282735],
            [0.305934921227, -0.0633281844599, 0.949943874672],
        ),
        (
            0.8,
            0.7,
            [-0.967218188157, 0.187518681762, 0.775939372808],
            [-0.447960037052, 0.0401107514232, 0.893153364672],
        ),
    ];
    for (x, y, p, n) in table {
        let point = s.edge_point(e, 1.0 - x, y).unwrap();
        near(point.position, p);
        near(point.normal(), n);
    }
}

#[test]
fn walls_are_c1() {
    for number in [6, 7, 9, 10] {
        let (mesh, normals) = figure(number);
        let s = apatch(&mesh, &normals, &paper()).unwrap();
        let jumps = wall_jumps(&s);
        assert!(jumps.value < 1e-12 && jumps.gradient < 1e-11, "figure {number}: {jumps:?}");
        println!("{number} {jumps:?} {:?}", s.report());
    }
}
