//! Automatic segmentation of real meshes and of shapes with known answers.

mod common;

use common::{cube, mesh, sphere, torus};
use glam::DVec3;
use suture_mesh::{Topology, TriMesh};
use suture_segment::{
    Automatic, AutomaticOptions, Limits, NormalSpread, Segment, SegmentError, Segmentation,
};

fn segment(mesh: &TriMesh, options: AutomaticOptions) -> Result<Segmentation, SegmentError> {
    Automatic { options, ..Automatic::default() }.segment(mesh, &Topology::build(mesh).unwrap())
}

fn least(widths: &[f64]) -> f64 {
    widths.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Whether edges of more than 42° end at a vertex: where creases hold both ends of an arc, a third of the width is enough.
fn creased(mesh: &TriMesh, topology: &Topology) -> Vec<bool> {
    let mut creased = vec![false; mesh.positions.len()];
    for h in 0..topology.half_edge_count() as u32 {
        if suture_mesh::dihedral_angle(topology, mesh, h)
            .is_some_and(|angle| angle.abs() > 42f64.to_radians())
        {
            [topology.tail(h), topology.head(h)].into_iter().for_each(|v| creased[v as usize] = true);
        }
    }
    creased
}

/// Valid (the constructor checks that), at most `charts`, no arc narrower than `width`, between creases than a third of it.
#[track_caller]
fn check(name: &str, charts: usize, width: f64) {
    let Some((mesh, topology)) = mesh(name) else { return };
    let s = Automatic::default().segment(&mesh, &topology).unwrap_or_else(|e| panic!("{name}: {e}"));
    let creased = creased(&mesh, &topology);
    let held = |arc: &suture_segment::Arc| arc.corners.iter().all(|&c| creased[s.corners[c].vertex as usize]);
    let w: Vec<f64> = (s.arcs.iter().zip(s.arc_widths(&mesh)))
        .map(|(arc, width)| if held(arc) { 3.0 * width } else { width })
        .collect();
    let w = least(&w);
    assert!(s.charts.len() <= charts && w >= width, "{name}: {} charts, width {w:.4}", s.charts.len());
    assert!(s.corners.iter().all(|c| c.arcs.len() <= 6));
    let euler = mesh.faces.iter().flatten().collect::<std::collections::BTreeSet<_>>().len() as i64
        - mesh.faces.len() as i64 / 2;
    assert_eq!((s.corners.len() + s.charts.len()) as i64 - s.arcs.len() as i64, euler, "{name}");
}

#[test]
fn organic_shapes() {
    for (name, charts, width) in [
        ("spot.obj", 12, 0.008),
        ("fish.obj", 10, 0.012),
        ("hand.off", 28, 0.012),
        ("knot1.off", 30, 0.012),
        ("eight.off", 20, 0.012),
    ] {
        check(&format!("good/{name}"), charts, width);
    }
}

/// The hardest of them: horns, ears and udder need small charts.
#[test]
fn a_cow() {
    check("good/cow.off", 67, 0.0148);
}

#[test]
fn mechanical_shapes() {
    for (name, charts, width) in
        [("wingnut.obj", 14, 0.011), ("anchor_dense.off", 30, 0.0138), ("part.off", 14, 0.012)]
    {
        check(&format!("good/{name}"), charts, width);
    }
}

#[test]
fn coarse_shapes_of_the_paper() {
    for (name, charts, width) in [
        ("deformed_octahedron.obj", 8, 0.05),
        ("deformed_tetrahedron.obj", 5, 0.1),
        ("l_shape.obj", 12, 0.08),
        ("sphere_320.obj", 6, 0.05),
        ("torus_2304.obj", 12, 0.02),
    ] {
        check(&format!("paper/{name}"), charts, width);
    }
}

#[test]
fn a_cube_falls_into_its_sides() {
    let mesh = cube(8);
    let s = segment(&mesh, AutomaticOptions::default()).unwrap();
    assert_eq!((s.charts.len(), s.corners.len(), s.arcs.len()), (6, 8, 12));
    assert!(s.charts.iter().all(|c| c.faces.len() == 128));
}

#[test]
fn the_smallest_meshes_work() {
    let tetrahedron = TriMesh::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    );
    assert_eq!(segment(&tetrahedron, AutomaticOptions::default()).unwrap().charts.len(), 4);
    assert!(segment(&sphere(0), AutomaticOptions::default()).unwrap().charts.len() >= 4);
}

#[test]
fn powers_of_two_change_nothing() {
    let mesh = torus(40, 12);
    // Coordinates of few bits, so that moving them is exact.
    let coarse = |p: DVec3| (p * 2f64.powi(20)).round() * 2f64.powi(-20);
    let rounded = TriMesh::new(mesh.positions.iter().map(|&p| coarse(p)).collect(), mesh.faces.clone());
    let moved = |scale: f64, shift: DVec3| {
        let positions = rounded.positions.iter().map(|&p| p * scale + shift).collect();
        segment(&TriMesh::new(positions, mesh.faces.clone()), AutomaticOptions::default()).unwrap()
    };
    let plain = moved(1.0, DVec3::ZERO);
    assert_eq!(moved(2f64.powi(20), DVec3::ZERO), plain);
    assert_eq!(moved(2f64.powi(-20), DVec3::ZERO), plain);
    assert_eq!(moved(1.0, DVec3::new(1024.0, -64.0, 0.5)), plain);
}

#[test]
fn the_number_of_charts_can_be_steered() {
    let mesh = torus(64, 16);
    let with =
        |charts| segment(&mesh, AutomaticOptions { charts: Some(charts), ..Default::default() }).unwrap();
    let many = with(40);
    // Short arcs may still be merged away after the number is reached.
    assert!((20..=40).contains(&many.charts.len()), "{}", many.charts.len());
    assert!(with(14).charts.len() <= 14);
}

#[test]
fn valences_keep_their_limit() {
    for max_valence in [3, 4, 6] {
        let options = AutomaticOptions { limits: Limits { max_valence }, ..Default::default() };
        match segment(&torus(40, 12), options) {
            Ok(s) => assert!(s.corners.iter().all(|c| c.arcs.len() <= max_valence)),
            Err(e) => assert!(matches!(e, SegmentError::CornerValence { limit, .. } if limit == max_valence)),
        }
    }
}

#[test]
fn a_flattening_that_refuses_everything_leaves_flat_charts() {
    let mesh = sphere(4);
    let strict = Automatic { flatten: Box::new(NormalSpread { limit: 0.0 }), ..Automatic::default() };
    let s = strict.segment(&mesh, &Topology::build(&mesh).unwrap()).unwrap();
    let free = segment(&mesh, AutomaticOptions::default()).unwrap();
    assert!(s.charts.len() > free.charts.len());
}

#[test]
fn what_cannot_be_segmented_is_refused() {
    let mut flat = sphere(2);
    flat.positions.fill(DVec3::ONE);
    assert!(matches!(segment(&flat, AutomaticOptions::default()), Err(SegmentError::NotFinite { .. })));
    let mut nan = sphere(2);
    nan.positions[7].y = f64::NAN;
    assert!(matches!(segment(&nan, AutomaticOptions::default()), Err(SegmentError::NotFinite { .. })));
    let mut huge = sphere(2);
    huge.positions[7].y = f64::MAX;
    let _ = segment(&huge, AutomaticOptions::default());
    let mut open = sphere(2);
    open.faces.pop();
    assert!(matches!(segment(&open, AutomaticOptions::default()), Err(SegmentError::Open { .. })));
}

/// Prints the table of all meshes: `MESHES="good/spot.obj good/cow.off" cargo test … -- --ignored --nocapture`.
#[test]
#[ignore = "prints measurements"]
fn table() {
    let names =
        std::env::var("MESHES").unwrap_or_else(|_| "good/spot.obj good/hand.off good/knot1.off".into());
    println!("mesh | faces | charts | corners N3/N4/N5/N6 | width min/median | E median/max | seconds");
    for name in names.split_whitespace() {
        let Some((mesh, topology)) = mesh(name) else { continue };
        let start = std::time::Instant::now();
        let s = match Automatic::default().segment(&mesh, &topology) {
            Ok(s) => s,
            Err(e) => {
                println!("{name} | {e}");
                continue;
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let mut valence = [0; 9];
        s.corners.iter().for_each(|c| valence[c.arcs.len()] += 1);
        let mut w = s.arc_widths(&mesh);
        w.sort_by(f64::total_cmp);
        let mut spread: Vec<f64> = s.charts.iter().map(|c| NormalSpread::spread(&mesh, &c.faces)).collect();
        spread.sort_by(f64::total_cmp);
        println!(
            "{name} | {} | {} | {:?} | {:.4}/{:.4} | {:.2}/{:.2} | {seconds:.2}",
            mesh.faces.len(),
            s.charts.len(),
            &valence[3..7],
            w[0],
            w[w.len() / 2],
            spread[spread.len() / 2],
            spread[spread.len() - 1],
        );
    }
}
