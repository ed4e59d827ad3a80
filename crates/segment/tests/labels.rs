//! Labels read as charts, corners and arcs.

mod common;

use common::{cube, data, mesh, sphere, torus};
use glam::DVec3;
use proptest::prelude::*;
use suture_mesh::{Topology, TriMesh};
use suture_segment::{Limits, SegmentError, Segmentation, read_labels, write_labels};

/// One chart per side of the cube.
fn sides(n: i32) -> Vec<u32> {
    (0..6u32).flat_map(|side| std::iter::repeat_n(side, (2 * n * n) as usize)).collect()
}

fn segment(mesh: &TriMesh, labels: &[u32]) -> Result<Segmentation, SegmentError> {
    Segmentation::from_labels(mesh, &Topology::build(mesh).unwrap(), labels)
}

/// Every statement in the documentation of `Segmentation`, read off the mesh again.
#[track_caller]
fn check(mesh: &TriMesh, topology: &Topology, s: &Segmentation) {
    let (v, e, f) = (mesh.positions.len(), topology.half_edge_count() / 2, mesh.faces.len());
    let used = (0..v as u32).filter(|&v| topology.outgoing(v).next().is_some()).count();
    let euler = |a: usize, b: usize, c: usize| a as i64 - b as i64 + c as i64;
    assert_eq!(euler(s.corners.len(), s.arcs.len(), s.charts.len()), euler(used, e, f), "Euler number");
    assert_eq!(s.charts.iter().map(|c| c.faces.len()).sum::<usize>(), f);
    for (r, chart) in s.charts.iter().enumerate() {
        assert!(chart.faces.iter().all(|&f| s.labels[f as usize] == r as u32));
        assert!(chart.arcs.len() >= 3);
        for (i, &end) in chart.arcs.iter().enumerate() {
            let (arc, next) = (&s.arcs[end.arc], chart.arcs[(i + 1) % chart.arcs.len()]);
            assert_eq!(if end.forward { arc.left } else { arc.right }, r as u32, "the chart is on the left");
            assert_eq!(arc.corners[usize::from(end.forward)], s.start(next), "the loop is a loop");
        }
    }
    for arc in &s.arcs {
        assert_ne!(arc.left, arc.right);
        assert_ne!(arc.corners[0], arc.corners[1]);
        assert_eq!(arc.vertices[0], s.corners[arc.corners[0]].vertex);
        assert_eq!(*arc.vertices.last().unwrap(), s.corners[arc.corners[1]].vertex);
        for pair in arc.vertices.windows(2) {
            let h = topology.half_edge(pair[0], pair[1]).expect("arcs run along mesh edges");
            assert_eq!(s.labels[h as usize / 3], arc.left);
            assert_eq!(s.labels[topology.opposite(h).unwrap() as usize / 3], arc.right);
        }
    }
    for (c, corner) in s.corners.iter().enumerate() {
        let segments = s.segments(c);
        assert!((3..=8).contains(&segments.len()));
        // The faces met on the way counter-clockwise around the vertex, from the first arc.
        let first = corner.arcs[0];
        let chain = &s.arcs[first.arc].vertices;
        let start = topology
            .half_edge(corner.vertex, if first.forward { chain[1] } else { chain[chain.len() - 2] })
            .unwrap();
        let around: Vec<u32> = topology.outgoing(corner.vertex).collect();
        let at = around.iter().position(|&h| h == start).unwrap();
        let mut met: Vec<u32> =
            (0..around.len()).map(|i| s.labels[around[(at + i) % around.len()] as usize / 3]).collect();
        met.dedup();
        assert_eq!(met, segments, "counter-clockwise");
    }
}

#[test]
fn a_cube_has_the_corners_and_arcs_of_a_cube() {
    let mesh = cube(3);
    let topology = Topology::build(&mesh).unwrap();
    let s = Segmentation::from_labels(&mesh, &topology, &sides(3)).unwrap();
    assert_eq!((s.charts.len(), s.corners.len(), s.arcs.len()), (6, 8, 12));
    assert!(s.arcs.iter().all(|a| a.vertices.len() == 4));
    check(&mesh, &topology, &s);
    // Straight arcs of a third of √3 diagonals between corners of valence three.
    for w in s.arc_widths(&mesh) {
        assert!((w - 3f64.sqrt().recip() / (23.0 / 6.0 / 3f64.sqrt() + 1.0)).abs() < 1e-15, "{w}");
    }
}

#[test]
fn labels_are_compacted_in_ascending_order() {
    let mesh = cube(2);
    let topology = Topology::build(&mesh).unwrap();
    let wild = [7i64, -5, 1 << 40, 3, 0, 9];
    let labels: Vec<i64> = sides(2).iter().map(|&l| wild[l as usize]).collect();
    let s = Segmentation::from_labels(&mesh, &topology, &labels).unwrap();
    let order = [3, 0, 5, 2, 1, 4];
    assert!(sides(2).iter().zip(&s.labels).all(|(&side, &r)| order[side as usize] == r));
}

#[test]
fn every_broken_invariant_is_named() {
    use SegmentError::*;
    // The octahedron's faces alternate between north and south, quadrant by quadrant.
    let octahedron = sphere(0);
    let refused = |mesh: &TriMesh, labels: &[u32]| segment(mesh, labels).unwrap_err();
    assert_eq!(refused(&octahedron, &[0, 9, 1, 9, 0, 9, 2, 9]), Pinch { chart: 0, vertex: 0 });
    assert_eq!(
        refused(&octahedron, &[4; 8]),
        ChartNotDisc { chart: 4, face: 0, components: 1, loops: 0, euler: 2 }
    );
    assert_eq!(
        refused(&octahedron, &[2, 1, 2, 1, 2, 1, 2, 1]),
        ClosedCurveWithoutCorner { vertex: 2, charts: [1, 2] }
    );
    assert_eq!(
        refused(&octahedron, &[0, 0, 1, 1, 2, 2, 3, 3]),
        ChartCorners { chart: 0, face: 0, corners: 2 }
    );
    assert_eq!(refused(&octahedron, &[0; 7]), LabelCount { labels: 7, faces: 8 });
    let ring: Vec<u32> = (0..128).map(|f| u32::from(f < 64)).collect();
    assert_eq!(
        refused(&torus(8, 8), &ring),
        ChartNotDisc { chart: 0, face: 64, components: 1, loops: 2, euler: 0 }
    );
    let mut apart = vec![0u32; 128];
    apart[70] = 1;
    apart[3] = 1;
    assert!(matches!(refused(&torus(8, 8), &apart), ChartNotDisc { chart: 0, loops: 2, euler: -2, .. }));

    let n = 9;
    let mut positions = vec![DVec3::Z, -DVec3::Z];
    positions.extend((0..n).map(|i| {
        let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
        DVec3::new(c, s, 0.0)
    }));
    let at = |i: u32| 2 + i % n;
    let faces = (0..n).flat_map(|i| [[0, at(i), at(i + 1)], [1, at(i + 1), at(i)]]).collect();
    let bipyramid = TriMesh::new(positions, faces);
    let each: Vec<u32> = (0..2 * n).collect();
    assert_eq!(refused(&bipyramid, &each), CornerValence { vertex: 0, valence: 9, limit: 8 });
    let topology = Topology::build(&bipyramid).unwrap();
    let limits = Limits { max_valence: 9 };
    assert!(Segmentation::from_labels_with(&bipyramid, &topology, &each, limits).is_ok());
}

#[test]
fn open_and_disconnected_meshes_are_refused() {
    let mut open = sphere(1);
    let [a, _, c] = open.faces.pop().unwrap();
    match segment(&open, &[0; 31]).unwrap_err() {
        SegmentError::Open { edge, .. } => assert!(edge.contains(&a) || edge.contains(&c)),
        other => panic!("{other}"),
    }
    let mut two = sphere(0);
    let shift = two.positions.len() as u32;
    let copy = two.clone();
    two.positions.extend(copy.positions.iter().map(|p| *p + 3.0 * DVec3::X));
    two.faces.extend(copy.faces.iter().map(|f| f.map(|v| v + shift)));
    assert_eq!(segment(&two, &[0; 16]).unwrap_err(), SegmentError::Disconnected { components: 2, face: 8 });
    let topology = Topology::build(&copy).unwrap();
    assert_eq!(
        Segmentation::from_labels(&two, &topology, &[0u32; 16]).unwrap_err(),
        SegmentError::MeshMismatch { faces: 16, adjacent: 8 }
    );
}

#[test]
fn label_files_are_read_back_and_refused_with_the_line() {
    let labels = vec![3, 0, u32::MAX, 7];
    assert_eq!(read_labels(&write_labels(&labels)), Ok(labels));
    assert_eq!(read_labels("\u{feff}1\r\n 2 \r\n\r\n"), Ok(vec![1, 2]));
    assert_eq!(read_labels(""), Ok(vec![]));
    for (text, line, word) in
        [("0\n-1\n", 2, "-1"), ("0\n\n1", 2, ""), ("1.5", 1, "1.5"), ("4294967296", 1, "4294967296")]
    {
        assert_eq!(read_labels(text), Err(SegmentError::Label { line, text: word.into() }), "{text:?}");
    }
}

/// Charts, corners, arcs and largest valence of the files in the table of the data; `None` marks invalid ones.
#[test]
fn the_label_files_are_judged_as_their_table_says() {
    let table = [
        ("sphere.obj", "sphere.cube6", Some((6, 8, 12, 3))),
        ("torus.obj", "torus.grid8", Some((8, 8, 16, 4))),
        ("fandisk.off", "fandisk.dihedral25_raw", Some((12, 20, 30, 3))),
        ("anchor_dense.off", "anchor_dense.dihedral30_raw", None),
        ("part.off", "part.dihedral30_raw", None),
        ("couplingdown.off", "couplingdown.dihedral30_raw", None),
        ("part.off", "part.dihedral30_discs", None),
        ("anchor_dense.off", "anchor_dense.dihedral30_discs", None),
        ("spot.obj", "spot.vor", Some((24, 42, 64, 4))),
        ("cow.off", "cow.vor", Some((39, 70, 107, 4))),
        ("blobby.off", "blobby.vor", Some((8, 11, 17, 4))),
        ("hand.off", "hand.vor", Some((26, 46, 70, 5))),
        ("knot1.off", "knot1.vor", Some((33, 66, 99, 3))),
        ("eight.off", "eight.vor", Some((12, 26, 40, 4))),
        ("elephant.off", "elephant.vor", Some((81, 163, 248, 4))),
        ("wingnut.obj", "wingnut.vor", Some((14, 24, 36, 3))),
        ("turbine.off", "turbine.vor", Some((194, 353, 567, 6))),
        ("fish.obj", "fish.vor", Some((18, 32, 48, 3))),
    ];
    for (file, name, expected) in table {
        let (Some((mesh, topology)), Some(text)) =
            (mesh(&format!("good/{file}")), data(&format!("labels/{name}.labels")))
        else {
            continue;
        };
        let result = Segmentation::from_labels(&mesh, &topology, &read_labels(&text).unwrap());
        let found = result.as_ref().ok().map(|s| {
            check(&mesh, &topology, s);
            let valence = s.corners.iter().map(|c| c.arcs.len()).max().unwrap();
            (s.charts.len(), s.corners.len(), s.arcs.len(), valence)
        });
        assert_eq!(found, expected, "{name}: {:?}", result.err());
    }
}

#[test]
fn the_shapes_of_the_paper_have_the_published_counts() {
    // Segments and N-blends of each shape.
    let table = [
        ("cylinder_2736", 6),
        ("deformed_octahedron", 8),
        ("deformed_tetrahedron", 4),
        ("l_shape", 12),
        ("sphere_320", 5),
        ("torus_2304", 8),
    ];
    for (name, charts) in table {
        let (Some((mesh, topology)), Some(text)) =
            (mesh(&format!("paper/{name}.obj")), data(&format!("paper/{name}.labels")))
        else {
            continue;
        };
        let s = Segmentation::from_labels(&mesh, &topology, &read_labels(&text).unwrap())
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(s.charts.len(), charts, "{name}");
        check(&mesh, &topology, &s);
    }
}

#[test]
fn the_bad_label_files_are_refused() {
    if let Some(text) = data("bad/labels_bad.labels") {
        assert!(matches!(read_labels(&text), Err(SegmentError::Label { .. })));
    }
    if let (Some(text), Some((mesh, topology))) =
        (data("bad/labels_short.labels"), mesh("bad/inside_out.obj"))
    {
        let labels = read_labels(&text).unwrap();
        let expected = SegmentError::LabelCount { labels: labels.len(), faces: mesh.faces.len() };
        assert_eq!(Segmentation::from_labels(&mesh, &topology, &labels), Err(expected));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Numbering of faces and vertices means nothing: the same charts, corners, arcs and widths come out.
    #[test]
    fn the_partition_does_not_depend_on_the_numbering(
        faces in Just((0..108usize).collect::<Vec<_>>()).prop_shuffle(),
        vertices in Just((0..56u32).collect::<Vec<_>>()).prop_shuffle(),
        turn in 0usize..3,
    ) {
        let (mesh, labels) = (cube(3), sides(3));
        let mut moved = TriMesh::new(vec![DVec3::ZERO; 56], Vec::new());
        for (v, &new) in vertices.iter().enumerate() {
            moved.positions[new as usize] = mesh.positions[v];
        }
        moved.faces = faces
            .iter()
            .map(|&f| [0, 1, 2].map(|k| vertices[mesh.faces[f][(k + turn) % 3] as usize]))
            .collect();
        let moved_labels: Vec<u32> = faces.iter().map(|&f| labels[f]).collect();
        let (a, b) = (segment(&mesh, &labels).unwrap(), segment(&moved, &moved_labels).unwrap());
        prop_assert!(faces.iter().enumerate().all(|(new, &f)| b.labels[new] == a.labels[f]));
        let key = |s: &Segmentation, name: &dyn Fn(u32) -> u32| {
            let mut arcs: Vec<(u32, u32, Vec<u32>)> = s.arcs.iter().map(|arc| {
                let mut chain: Vec<u32> = arc.vertices.iter().map(|&v| name(v)).collect();
                let (mut left, mut right) = (arc.left, arc.right);
                if left > right {
                    chain.reverse();
                    (left, right) = (right, left);
                }
                (left, right, chain)
            }).collect();
            arcs.sort();
            arcs
        };
        prop_assert_eq!(key(&a, &|v| vertices[v as usize]), key(&b, &|v| v));
    }
}
