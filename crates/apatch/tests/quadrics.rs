//! Quadrics are reproduced from their points and gradients, without being told which they are.

mod common;

use common::{octahedron, wall_jumps};
use glam::DVec3;
use suture_apatch::{ApatchOptions, ApatchSurface, ApexWeight, apatch};
use suture_mesh::{TriMesh, shapes};

/// A graph or any other map of an `n × n` grid.
fn grid(n: u32, at: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let mut mesh = TriMesh::default();
    for j in 0..=n {
        for i in 0..=n {
            mesh.positions.push(at(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let v = |i: u32, j: u32| j * (n + 1) + i;
            mesh.faces
                .extend([[v(i, j), v(i + 1, j), v(i + 1, j + 1)], [v(i, j), v(i + 1, j + 1), v(i, j + 1)]]);
        }
    }
    mesh
}

/// Largest distance (first order) of sampled points from the quadric `value`, and angle of normals, over faces and edges.
fn error(surface: &ApatchSurface, value: impl Fn(DVec3) -> (f64, DVec3)) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    let mut take = |p: suture_apatch::SurfacePoint| {
        let (f, g) = value(p.position);
        assert!(p.simple);
        worst[0] = worst[0].max(f.abs() / g.length());
        worst[1] = worst[1].max(p.normal().cross(g.normalize()).length());
        assert!(p.normal().dot(g) > 0.0);
    };
    for f in 0..surface.mesh().faces.len() {
        for i in 0..=8 {
            for j in 0..=8 - i {
                let (x, y) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                take(surface.face_point(f, [1.0 - x - y, x, y]).unwrap());
            }
        }
    }
    for e in 0..surface.edge_count() {
        for i in 0..=8 {
            for j in 0..=4 {
                if let Some(p) = surface.edge_point(e, f64::from(i) / 8.0, f64::from(j) / 4.0) {
                    take(p);
                }
            }
        }
    }
    worst
}

#[track_caller]
fn check(name: &str, mesh: &TriMesh, quadric: impl Fn(DVec3) -> (f64, DVec3) + Copy) {
    let gradients: Vec<DVec3> = mesh.positions.iter().map(|&p| quadric(p).1).collect();
    let surface = apatch(mesh, &gradients, &ApatchOptions::default()).unwrap();
    let [distance, angle] = error(&surface, quadric);
    println!("{name}: {} faces, distance {distance:.1e}, angle {angle:.1e}", surface.mesh().faces.len());
    assert_eq!(surface.report().refinements, 0, "{name}");
    assert!(distance < 1e-14 * mesh.diagonal() && angle < 1e-13, "{name}: {distance:e} {angle:e}");
    let jumps = wall_jumps(&surface);
    assert!(jumps.value < 1e-13 && jumps.gradient < 1e-12, "{name}: {jumps:?}");
    // The default of the paper does not do that; a test that cannot fail would let it pass.
    let paper = ApatchOptions { weight: ApexWeight::Paper, ..ApatchOptions::default() };
    let [distance, _] = error(&apatch(mesh, &gradients, &paper).unwrap(), quadric);
    assert!(distance > 1e-6, "{name}: {distance:e}");
}

fn ellipsoid(radii: DVec3) -> impl Fn(DVec3) -> (f64, DVec3) + Copy {
    move |p: DVec3| {
        let q = p / radii;
        (q.length_squared() - 1.0, 2.0 * q / radii)
    }
}

fn scaled(mut mesh: TriMesh, radii: DVec3) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p *= radii);
    mesh
}

#[test]
fn spheres() {
    let sphere = ellipsoid(DVec3::ONE);
    check("octahedron", &octahedron(), sphere);
    check("icosahedron", &shapes::sphere(0), sphere);
    check("sphere of 80", &shapes::sphere(1), sphere);
    check("sphere of 320", &shapes::sphere(2), sphere);
}

#[test]
fn ellipsoids() {
    let radii = DVec3::new(1.0, 1.2, 0.8);
    check("ellipsoid of 20", &scaled(shapes::sphere(0), radii), ellipsoid(radii));
    check("ellipsoid of 80", &scaled(shapes::sphere(1), radii), ellipsoid(radii));
}

#[test]
fn paraboloids() {
    let elliptic = |p: DVec3| {
        let f = p.z - 0.5 * p.x * p.x - 0.3 * p.y * p.y;
        (f, DVec3::new(-p.x, -0.6 * p.y, 1.0))
    };
    let saddle = |p: DVec3| {
        let f = p.z - 0.5 * p.x * p.x + 0.3 * p.y * p.y;
        (f, DVec3::new(-p.x, 0.6 * p.y, 1.0))
    };
    let place = |a: f64, b: f64| [(x(a), y(b)); 1][0];
    fn x(a: f64) -> f64 {
        1.6 * a - 0.7
    }
    fn y(b: f64) -> f64 {
        1.4 * b - 0.8
    }
    let mesh = |sign: f64| {
        grid(3, move |a, b| {
            let (x, y) = place(a, b);
            DVec3::new(x, y, 0.5 * x * x + sign * 0.3 * y * y)
        })
    };
    check("elliptic paraboloid", &mesh(1.0), elliptic);
    check("hyperbolic paraboloid", &mesh(-1.0), saddle);
}

#[test]
fn hyperboloid_of_one_sheet() {
    let quadric =
        |p: DVec3| (p.x * p.x + p.y * p.y - p.z * p.z - 1.0, DVec3::new(2.0 * p.x, 2.0 * p.y, -2.0 * p.z));
    let mesh = grid(4, |a, b| {
        let (angle, z) = (1.5 * a + 0.1, 0.9 * b - 0.5);
        let r = (1.0 + z * z).sqrt();
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    });
    check("hyperboloid", &mesh, quadric);
}

#[test]
fn circular_cylinder() {
    let quadric = |p: DVec3| (p.x * p.x + p.y * p.y - 1.0, DVec3::new(2.0 * p.x, 2.0 * p.y, 0.0));
    let mesh = grid(4, |a, b| DVec3::new((1.7 * a).cos(), (1.7 * a).sin(), b));
    check("cylinder", &mesh, quadric);
}

/// Negative control: with unit normals the quadric is another one at every vertex.
#[test]
fn unit_normals_on_an_ellipsoid_are_not_gradients() {
    let radii = DVec3::new(1.0, 1.2, 0.8);
    let mesh = scaled(shapes::sphere(0), radii);
    let quadric = ellipsoid(radii);
    let normals: Vec<DVec3> = mesh.positions.iter().map(|&p| quadric(p).1.normalize()).collect();
    let surface = apatch(&mesh, &normals, &ApatchOptions::default()).unwrap();
    let [distance, _] = error(&surface, quadric);
    assert!(distance > 5e-3 && distance < 1e-2, "{distance:e}");
}

/// Icosahedron, section 13.
#[test]
fn the_numbers_of_the_icosahedron() {
    let mesh = shapes::sphere(0);
    let centre = [1.0 / 3.0; 3];
    let paper = ApatchOptions { weight: ApexWeight::Paper, ..ApatchOptions::default() };
    let s = apatch(&mesh, &mesh.positions, &paper).unwrap();
    for f in 0..20 {
        assert!((s.face_point(f, centre).unwrap().position.length() - 1.031467312).abs() < 1e-9);
        let (apex, weight) = s.apex(f, suture_apatch::Side::Positive).unwrap();
        assert!((weight - 0.414589803375).abs() < 1e-10);
        let c = mesh.corners(f).iter().sum::<DVec3>() / 3.0;
        assert!((apex.distance(c) - 0.811569675128).abs() < 1e-10);
        let bound = s.face_bound(f, suture_apatch::Side::Positive, 1e-4, 100_000).unwrap();
        assert!((bound.attained + 0.103647).abs() < 1e-4, "{bound:?}");
    }
    for e in 0..30 {
        let r = s.edge_point(e, 0.5, 0.5).unwrap().position.length();
        assert!((r - 1.01857818128).abs() < 1e-10, "{r}");
    }
    let s = apatch(&mesh, &mesh.positions, &ApatchOptions::default()).unwrap();
    for f in 0..20 {
        let (_, weight) = s.apex(f, suture_apatch::Side::Positive).unwrap();
        assert!((weight - 0.789978005877).abs() < 1e-10);
    }
}
