//! Errors on the unit sphere against those of the specification.

use glam::DVec2;
use suture_bubble::{BubbleOptions, PolyMesh, bubble};
use suture_surface::Patch;

#[test]
fn errors_on_the_sphere_are_those_of_the_specification() {
    // By order: levels 0, 1, 2 of the icosphere; the specification's samples are sparser than these.
    for (order, wanted) in [(1, [9.5e-3, 3.4e-4, 6.7e-6]), (2, [4.5e-4, 2.0e-6, 3.2e-9])] {
        for (level, want) in (0..).zip(wanted) {
            let mesh = suture_mesh::shapes::sphere(level);
            let poly = PolyMesh::from_triangles(&mesh, &mesh.positions).unwrap();
            let surface = bubble(&poly, &BubbleOptions { order, ..Default::default() }).unwrap();
            let mut worst = 0.0_f64;
            for patch in surface.patches() {
                for i in 0..13 {
                    for j in 0..13 - i {
                        let p = patch.jet(DVec2::new(f64::from(i), f64::from(j)) / 12.0).p;
                        worst = worst.max((p.length() - 1.0).abs());
                    }
                }
            }
            assert!(
                (0.9..1.06).contains(&(worst / want)),
                "n = {order}, level {level}: {worst:e} ≠ {want:e}"
            );
        }
    }
}
