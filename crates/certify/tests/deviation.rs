//! Distances with closed forms.

mod common;

use common::*;
use glam::{DMat3, DVec2, DVec3};
use suture_bernstein::BezierCurve;
use suture_certify::{CertifyError, SurfaceSamples, deviation};
use suture_mesh::TriMesh;
use suture_surface::{Continuity, Domain, EdgeRef, Jet2, PatchId, Seam};

fn octahedron() -> TriMesh {
    let p = [DVec3::X, DVec3::Y, DVec3::Z];
    let positions = p.into_iter().chain(p.map(|p| -p)).collect();
    let faces = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    TriMesh::new(positions, faces)
}

/// The octahedron with every face split in four `n` times, its vertices on the sphere of `radius`.
fn ball(n: usize, radius: f64) -> TriMesh {
    let mut mesh = octahedron();
    for _ in 0..n {
        let mut positions = mesh.positions.clone();
        let mut known = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *known.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                positions.push((mesh.positions[a as usize] + mesh.positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let mut faces = Vec::new();
        for &[a, b, c] in &mesh.faces {
            let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
            faces.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
        }
        mesh = TriMesh::new(positions, faces);
    }
    mesh.positions.iter_mut().for_each(|p| *p *= radius);
    mesh
}

#[track_caller]
fn near(got: f64, want: f64, absolute: f64) {
    assert!((got - want).abs() <= absolute, "{got:e} is not {want:e}");
}

#[test]
fn an_octahedron_in_its_sphere_shows_the_sagitta() {
    let surface = sphere();
    let mesh = octahedron();
    let grid = Grid::of(&surface, 8);
    let d = deviation(&mesh, &surface, &grid.samples()).unwrap();
    assert!(d.mesh_to_surface.max < 1e-15, "{:?}", d.mesh_to_surface);
    assert_eq!(d.mesh_to_surface.count, 6);
    // The direction (1, 1, 1) is farthest from the facets, 1 − 1/√3, and a corner of the grid.
    near(d.surface_to_mesh.max, (1.0 - (1.0_f64 / 3.0).sqrt()) / mesh.diagonal(), 1e-15);
    let worst = d.surface_to_mesh.worst.unwrap();
    near(worst.point.abs().distance(DVec3::splat((1.0_f64 / 3.0).sqrt())), 0.0, 1e-15);
    assert_eq!(d.surface_to_mesh.count, grid.positions.len() + grid.triangles.len());
}

#[test]
fn the_fineness_of_the_tessellation_does_not_show() {
    let surface = sphere();
    for (radius, cells) in [(1.01, 2), (0.9, 2), (1.0 + 1e-9, 4), (1.5, 4)] {
        let mesh = ball(3, radius);
        let d = deviation(&mesh, &surface, &Grid::of(&surface, cells).samples()).unwrap();
        let want = (radius - 1.0).abs() / mesh.diagonal();
        for got in [d.mesh_to_surface.mean, d.mesh_to_surface.rms, d.mesh_to_surface.max] {
            near(got, want, 1e-14);
        }
        assert!(d.mesh_distances.iter().all(|x| (x - want).abs() < 1e-14));
    }
}

#[test]
fn units_and_the_order_of_vertices_do_not_matter() {
    let patches = sphere_patches();
    let mut mesh = ball(2, 1.0);
    mesh.positions.iter_mut().enumerate().for_each(|(i, p)| *p *= 1.0 + 0.01 * (i as f64).sin());
    let surface = sphere();
    let one = deviation(&mesh, &surface, &Grid::of(&surface, 5).samples()).unwrap();
    for power in [-20, 20] {
        let s = 2f64.powi(power);
        let scale = |p: &Analytic| p.moved(DMat3::from_diagonal(DVec3::splat(s)), DVec3::ZERO);
        let scaled = sewn(&patches, patches.iter().map(scale).collect(), Continuity::C2);
        let big = TriMesh::new(mesh.positions.iter().map(|p| *p * s).collect(), mesh.faces.clone());
        let other = deviation(&big, &scaled, &Grid::of(&scaled, 5).samples()).unwrap();
        assert_eq!(one.mesh_distances, other.mesh_distances);
        assert_eq!(one.vertex_distances, other.vertex_distances);
    }
    let n = mesh.positions.len() as u32;
    let turned = TriMesh::new(
        mesh.positions.iter().rev().copied().collect(),
        mesh.faces.iter().rev().map(|f| f.map(|v| n - 1 - v)).collect(),
    );
    let other = deviation(&turned, &surface, &Grid::of(&surface, 5).samples()).unwrap();
    for (a, b) in one.mesh_distances.iter().zip(other.mesh_distances.iter().rev()) {
        near(*a, *b, 1e-15);
    }
}

/// `z = 0.1 sin 5x cos 4y`.
fn waves(x: DVec2) -> Jet2<f64> {
    let ((s, c), (d, e)) = ((5.0 * x.x).sin_cos(), (4.0 * x.y).sin_cos());
    Jet2 {
        p: s * e,
        du: 5.0 * c * e,
        dv: -4.0 * s * d,
        duu: -25.0 * s * e,
        duv: -20.0 * c * d,
        dvv: -16.0 * s * e,
    }
    .map(|z: f64| 0.1 * z)
}

#[test]
fn foot_points_agree_with_brute_force_across_a_seam() {
    let surface = pair(waves, waves, Continuity::C2);
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    // Some beyond the border, some next to the seam y = 0.
    let points: Vec<DVec3> = (0..60)
        .map(|i| {
            let y = if i % 3 == 0 { 0.02 * (random() - 0.5) } else { 2.4 * random() - 1.2 };
            DVec3::new(1.2 * random() - 0.1, y, 0.3 * random() - 0.15)
        })
        .collect();
    let faces = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriMesh::new(points.clone(), faces);
    let d = deviation(&mesh, &surface, &Grid::of(&surface, 24).samples()).unwrap();
    for (p, got) in points.iter().zip(&d.mesh_distances) {
        // Down a pyramid of grids, each around the best point of the one before.
        let lift = |x: DVec2| {
            let x = x.clamp(DVec2::new(0.0, -1.0), DVec2::ONE);
            (x, p.distance(x.extend(waves(x).p)))
        };
        let mut best = lift(DVec2::ZERO);
        let (mut centre, mut half) = (DVec2::new(0.5, 0.0), 1.0);
        while half > 1e-9 {
            for i in -40..=40 {
                for j in -40..=40 {
                    let x = lift(centre + DVec2::new(f64::from(i), f64::from(j)) * (half / 40.0));
                    if x.1 < best.1 {
                        best = x;
                    }
                }
            }
            (centre, half) = (best.0, half * 0.1);
        }
        let got = got * mesh.diagonal();
        assert!((got - best.1).abs() < 1e-9, "{p}: {got}, by brute force {} at {}", best.1, best.0);
    }
}

/// The unit square in two trimmed halves that meet along a cubic, and a fan tessellation of each.
fn halves() -> (suture_surface::Surface, Grid) {
    let curve = [(0.5, 0.0), (0.9, 0.3), (0.1, 0.7), (0.5, 1.0)].map(DVec2::from);
    let line = |a: (f64, f64), b: (f64, f64)| BezierCurve::new(vec![a.into(), b.into()]).unwrap();
    let up = BezierCurve::new(curve.to_vec()).unwrap();
    let down = BezierCurve::new(curve.into_iter().rev().collect()).unwrap();
    let left =
        vec![up, line((0.5, 1.0), (0.0, 1.0)), line((0.0, 1.0), (0.0, 0.0)), line((0.0, 0.0), (0.5, 0.0))];
    let right =
        vec![down, line((0.5, 0.0), (1.0, 0.0)), line((1.0, 0.0), (1.0, 1.0)), line((1.0, 1.0), (0.5, 1.0))];
    let plane = |edges| {
        Analytic::new(Domain::Trimmed(vec![edges]), |x: DVec2| Jet2 {
            p: x.extend(0.0),
            du: DVec3::X,
            dv: DVec3::Y,
            ..Jet2::default()
        })
    };
    let patches = [plane(left), plane(right)];
    let mut grid = Grid::default();
    for (p, centre) in [(0, DVec2::new(0.25, 0.5)), (1, DVec2::new(0.75, 0.5))] {
        for e in 0..4 {
            let edge = patches[p].domain.edge(e).unwrap();
            for i in 0..6 {
                let at = [centre, edge.point(f64::from(i) / 6.0), edge.point(f64::from(i + 1) / 6.0)];
                let first = grid.positions.len() as u32;
                grid.positions.extend(at.map(|x| x.extend(0.0)));
                grid.triangles.push([first, first + 1, first + 2]);
                grid.triangle_patch.push(PatchId(p as u32));
                grid.corner_parameters.push(at);
            }
        }
    }
    let edge = |patch| EdgeRef { patch: PatchId(patch), edge: 0 };
    (surface(patches.to_vec(), vec![Seam::new(edge(0), edge(1), Continuity::C2)]), grid)
}

#[test]
fn trimmed_patches_share_the_foot_points_beside_their_seam() {
    let (surface, grid) = halves();
    let mut points = Vec::new();
    for i in 0..15 {
        for j in 0..15 {
            points.push(DVec3::new(f64::from(i) * 0.1 - 0.2, f64::from(j) * 0.1 - 0.2, 0.05));
        }
    }
    let faces = (0..75).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    // Three points of a column of the grid are collinear: a mesh of needles must not matter to its vertices …
    let mut mesh = TriMesh::new(points.clone(), faces);
    // … but one facet must have an area.
    mesh.faces.push([0, 15, 1]);
    let d = deviation(&mesh, &surface, &grid.samples()).unwrap();
    for (p, got) in points.iter().zip(&d.mesh_distances) {
        let q = p.clamp(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0));
        near(got * mesh.diagonal(), p.distance(q), 1e-12);
    }
    assert_eq!(d.kinds.len(), 1);
    assert_eq!(d.kinds[0].surface_to_mesh, d.surface_to_mesh);
}

#[test]
fn statistics_merge() {
    let surface = sphere();
    let d = deviation(&octahedron(), &surface, &Grid::of(&surface, 3).samples()).unwrap();
    let both = d.mesh_to_surface.merge(&d.surface_to_mesh);
    assert_eq!(both.count, d.mesh_to_surface.count + d.surface_to_mesh.count);
    assert_eq!((both.max, both.worst), (d.surface_to_mesh.max, d.surface_to_mesh.worst));
    let weight = d.surface_to_mesh.count as f64 / both.count as f64;
    near(both.mean, weight * d.surface_to_mesh.mean, 1e-15);
}

#[test]
fn what_is_no_mesh_and_no_tessellation_is_refused() {
    let surface = sphere();
    let grid = Grid::of(&surface, 2);
    let refused = |mesh: &TriMesh| deviation(mesh, &surface, &grid.samples()).unwrap_err();
    let mut mesh = octahedron();
    mesh.faces[3][1] = 77;
    let no_vertex = CertifyError::NoSuchVertex { of: "mesh", triangle: 3, vertex: 77, vertices: 6 };
    assert_eq!(refused(&mesh), no_vertex);
    let mut mesh = octahedron();
    mesh.positions[2].y = f64::NAN;
    assert_eq!(refused(&mesh), CertifyError::NotFinite { of: "mesh", vertex: 2 });
    let flat = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], vec![[0, 1, 2]]);
    assert_eq!(refused(&flat), CertifyError::NoArea { of: "mesh" });
    assert_eq!(refused(&TriMesh::default()), CertifyError::NoArea { of: "mesh" });
    let huge = TriMesh::new(octahedron().positions.iter().map(|p| *p * 1e308).collect(), octahedron().faces);
    assert!(matches!(refused(&huge), CertifyError::Diagonal { .. }));

    let refused = |samples: SurfaceSamples<'_>| deviation(&octahedron(), &surface, &samples).unwrap_err();
    let short = SurfaceSamples { triangle_patch: &grid.triangle_patch[1..], ..grid.samples() };
    assert!(matches!(refused(short), CertifyError::Length { name: "triangle_patch", .. }));
    let far = vec![PatchId(6); grid.triangles.len()];
    let far = SurfaceSamples { triangle_patch: &far, ..grid.samples() };
    assert_eq!(refused(far), CertifyError::NoSuchPatch { triangle: 0, patch: 6, patches: 6 });
    let none =
        SurfaceSamples { triangles: &[], triangle_patch: &[], corner_parameters: &[], ..grid.samples() };
    assert_eq!(refused(none), CertifyError::NoArea { of: "tessellation" });
}
