//! Paths through way points.

mod common;

use common::{cube, sphere};
use glam::DVec3;
use suture_mesh::{Topology, TriMesh};
use suture_segment::{Segment, SegmentError, Segmentation, WaypointOptions, Waypoints, read_paths};

fn segment(mesh: &TriMesh, paths: &[&[u32]], exponent: f64) -> Result<Segmentation, SegmentError> {
    let options = WaypointOptions { exponent, ..WaypointOptions::default() };
    let paths = paths.iter().map(|p| p.to_vec()).collect();
    Waypoints { paths, options }.segment(mesh, &Topology::build(mesh).unwrap())
}

fn at(mesh: &TriMesh, x: f64, y: f64, z: f64) -> u32 {
    mesh.positions.iter().position(|p| *p == DVec3::new(x, y, z)).unwrap() as u32
}

#[test]
fn meridians_and_the_equator_cut_a_sphere_into_octants() {
    let mesh = sphere(3);
    let s =
        segment(&mesh, &[&[1, 2, 3, 4, 1], &[1, 0, 3], &[2, 0], &[0, 4], &[1, 5, 3], &[2, 5], &[5, 4]], 1.0)
            .unwrap();
    assert_eq!((s.charts.len(), s.corners.len(), s.arcs.len()), (8, 6, 12));
    assert!(s.corners.iter().all(|c| c.arcs.len() == 4));
    assert!(s.charts.iter().all(|c| c.faces.len() == 64), "great circles are the shortest paths");
}

#[test]
fn a_path_that_ends_on_an_arc_makes_a_corner_of_valence_three() {
    let mesh = sphere(3);
    let s = segment(&mesh, &[&[1, 2, 3, 4, 1], &[1, 0, 3], &[2, 5, 4]], 1.0).unwrap();
    assert_eq!((s.charts.len(), s.arcs.len()), (4, 6));
    assert_eq!(s.corners.iter().map(|c| c.vertex).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert!(s.corners.iter().all(|c| c.arcs.len() == 3));
}

/// From corner to opposite corner of the top it is √2 n across and 2 n · ½^q along two right-angled creases: the creases win for
/// q > ½.
#[test]
fn creases_attract_paths_according_to_the_exponent() {
    let mesh = cube(4);
    let [a, b, c, d] = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| at(&mesh, x, y, 0.0));
    let [e, f, g, h] = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| at(&mesh, x, y, 4.0));
    let paths: &[&[u32]] = &[&[e, g], &[g, e], &[a, b, c, d, a], &[a, e], &[b, f], &[c, g], &[d, h]];
    for exponent in [0.55, 1.0, 3.0] {
        let s = segment(&mesh, paths, exponent).unwrap();
        assert_eq!((s.charts.len(), s.corners.len()), (6, 8));
        assert!(s.charts.iter().all(|c| c.faces.len() == 32), "the charts are the sides");
    }
    for exponent in [0.0, 0.45] {
        assert!(
            matches!(segment(&mesh, paths, exponent), Err(SegmentError::DanglingPath { .. })),
            "{exponent}"
        );
    }
}

#[test]
fn what_is_wrong_with_the_paths_is_said() {
    use SegmentError::*;
    let mesh = sphere(2);
    let refused = |paths: &[&[u32]]| segment(&mesh, paths, 1.0).unwrap_err();
    let equator: &[u32] = &[1, 2, 3, 4, 1];
    assert_eq!(refused(&[equator, &[0, 5]]), PathBlocked { path: 1, from: 0, to: 5 });
    assert_eq!(refused(&[equator, &[1, 0]]), DanglingPath { vertex: 0 });
    assert_eq!(refused(&[equator, &[1]]), PathTooShort { path: 1, vertex: None });
    assert_eq!(refused(&[&[1, 1]]), PathTooShort { path: 0, vertex: Some(1) });
    assert_eq!(refused(&[&[1, 66]]), PathVertex { path: 0, vertex: 66, vertices: 66 });
    assert!(matches!(refused(&[equator]), ClosedCurveWithoutCorner { .. }));
    assert!(matches!(refused(&[]), ChartNotDisc { loops: 0, .. }));
    assert!(matches!(refused(&[equator, &[1, 0, 3]]), ChartCorners { corners: 2, .. }));
    // A closed curve hung on the equator by one path: the northern chart has both sides of the path.
    let ring: Vec<u32> = {
        let topology = Topology::build(&mesh).unwrap();
        let mut ring: Vec<u32> = topology.outgoing(0).map(|h| topology.head(h)).collect();
        ring.push(ring[0]);
        ring
    };
    assert!(matches!(refused(&[equator, &ring, &[1, ring[0]]]), PathInsideChart { .. }));
}

#[test]
fn path_files_are_read_and_refused_with_the_line() {
    let text = "\u{feff}# cube\r\n0 1 2\r\n\r\n3, 4 # back\n";
    assert_eq!(read_paths(text), Ok(vec![vec![0, 1, 2], vec![3, 4]]));
    assert_eq!(read_paths("1 2\n3 x4\n"), Err(SegmentError::Path { line: 2, text: "x4".into() }));
}

#[test]
fn scaling_and_weird_exponents_change_nothing_or_fail_quietly() {
    let mesh = sphere(3);
    let paths: &[&[u32]] = &[&[1, 2, 3, 4, 1], &[1, 0, 3], &[2, 0, 4], &[1, 5, 3]];
    let expected = segment(&mesh, paths, 1.0).unwrap();
    for scale in [2f64.powi(20), 2f64.powi(-20)] {
        let scaled = TriMesh::new(mesh.positions.iter().map(|p| *p * scale).collect(), mesh.faces.clone());
        assert_eq!(segment(&scaled, paths, 1.0).unwrap(), expected);
    }
    for exponent in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let _ = segment(&mesh, paths, exponent);
    }
    let mut nan = mesh.clone();
    nan.positions[3].x = f64::NAN;
    let _ = segment(&nan, paths, 1.0);
}
