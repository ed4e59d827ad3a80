//! Readers, checks and repairs on random input; writers there and back.

use glam::DVec3;
use proptest::prelude::*;
use suture_mesh::{
    MeshError, Topology, TriMesh, check, components,
    io::{self, MeshFormat, WriteOptions},
    median_edge_length, repair, shapes, subdivide_midpoint, vertex_normals_area_weighted,
};

const FORMATS: [MeshFormat; 4] = [MeshFormat::Obj, MeshFormat::Stl, MeshFormat::Ply, MeshFormat::Off];

/// What a reader lets through must be a mesh that all else can take.
fn feed(bytes: &[u8]) {
    let _ = MeshFormat::sniff(bytes);
    for format in FORMATS {
        if let Ok(loaded) = io::read_from(bytes, format) {
            exercise(&loaded.mesh);
            let n = loaded.mesh.positions.len();
            assert!(!loaded.mesh.faces.is_empty());
            assert!(loaded.mesh.faces.iter().flatten().all(|&v| (v as usize) < n));
            assert!(loaded.mesh.positions.iter().all(|p| p.is_finite()));
            assert!(loaded.mesh.normals.is_none_or(|normals| normals.len() == n));
            assert!(n <= bytes.len() && loaded.mesh.faces.len() <= bytes.len());
            loaded.notices.iter().for_each(|notice| assert!(notice.to_string().len() < 300));
        }
    }
}

fn exercise(mesh: &TriMesh) {
    let report = check(mesh);
    let _ = report.to_string();
    assert_eq!(
        Topology::build(mesh).is_ok(),
        report.manifold
            && report.oriented
            && report.repeated_vertices.is_empty()
            && report.bad_indices.is_empty()
    );
    assert_eq!(components(mesh).len(), report.components.total);
    let _ = (subdivide_midpoint(mesh), vertex_normals_area_weighted(mesh), median_edge_length(mesh));
    let mut mended = mesh.clone();
    repair::weld_within(&mut mended, 1e-3).unwrap();
    repair::weld_coincident(&mut mended);
    repair::drop_degenerate_faces(&mut mended);
    repair::drop_duplicate_faces(&mut mended);
    repair::drop_isolated_vertices(&mut mended);
    let oriented = repair::orient(&mut mended);
    let report = check(&mended);
    assert!(report.bad_indices.is_empty() && report.repeated_vertices.is_empty());
    assert!(report.duplicate_faces.is_empty() && report.isolated.is_empty());
    if oriented.non_orientable.is_empty() {
        assert!(report.misoriented.is_empty());
    }
    let fixed = mended.clone();
    repair::orient(&mut mended);
    assert_eq!(format!("{mended:?}"), format!("{fixed:?}"));
}

/// Words of all formats: text made of them gets far into the readers.
fn words() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        6 => prop::sample::select(vec!["0", "1", "2", "3", "-1", "4", "1e308", "-0", "nan", "7.5", "99999999999999999999"]),
        3 => prop::sample::select(vec!["\n", "\r\n", " ", "\t", "\\\n", "#", "\r"]),
        2 => prop::sample::select(vec!["v", "\nv", "vn", "\nf", "f", "l", "1/2/3", "1//1", "-1/", "\u{feff}", "/"]),
        1 => prop::sample::select(vec!["OFF", "COFF", "NOFF", "3 0 1 2"]),
        1 => prop::sample::select(vec![
            "solid", "facet normal 0 0 0 outer loop", "vertex 1 2 3", "endloop endfacet", "endsolid"
        ]),
        2 => prop::sample::select(vec![
            "ply\nformat ascii 1.0\n", "ply\nformat binary_big_endian 1.0\n", "element vertex 3\n", "element face 1\n",
            "property float x\nproperty float y\nproperty float z\n", "property list uchar int vertex_indices\n",
            "property double q\n", "end_header\n",
        ]),
    ];
    prop::collection::vec(word, 0..60).prop_map(|words| words.join(" ").into_bytes())
}

fn valid(format: MeshFormat, ascii: bool) -> Vec<u8> {
    let mut mesh = shapes::sphere(1);
    mesh.normals = Some(mesh.positions.clone());
    let mut bytes = Vec::new();
    io::write_to(&mut bytes, &mesh, format, WriteOptions { ascii, ..WriteOptions::default() }).unwrap();
    bytes
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<i8>().prop_map(f64::from),
        prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
    ]
}

prop_compose! {
    fn meshes()(n in 1..12u32)(
        positions in prop::collection::vec([coordinate(), coordinate(), coordinate()].prop_map(DVec3::from), n as usize),
        faces in prop::collection::vec([0..n, 0..n, 0..n], 1..20),
        normals in prop::option::of(prop::collection::vec([coordinate(), coordinate(), coordinate()].prop_map(DVec3::from), n as usize)),
    ) -> TriMesh {
        TriMesh { positions, faces, normals }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        feed(&bytes);
    }

    #[test]
    fn random_words_never_panic(bytes in words()) {
        feed(&bytes);
    }

    #[test]
    fn damaged_files_never_panic(
        format in prop::sample::select(FORMATS.to_vec()),
        ascii in any::<bool>(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = valid(format, ascii);
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        feed(&bytes);
    }

    #[test]
    fn any_mesh_is_survived(mut mesh in meshes(), wild in prop::collection::vec(any::<[u32; 3]>(), 0..3), nan in any::<bool>()) {
        mesh.faces.extend(wild);
        if nan {
            mesh.positions[0].x = f64::NAN;
        }
        exercise(&mesh);
    }

    #[test]
    fn written_meshes_come_back_to_the_bit(mesh in meshes()) {
        for (format, ascii) in [(MeshFormat::Ply, false), (MeshFormat::Ply, true), (MeshFormat::Off, false), (MeshFormat::Obj, false)] {
            let mut bytes = Vec::new();
            io::write_to(&mut bytes, &mesh, format, WriteOptions { ascii, ..WriteOptions::default() }).unwrap();
            let mut expected = mesh.clone();
            if format == MeshFormat::Obj {
                // OBJ names normals in faces only: those of isolated vertices are lost.
                let used: std::collections::BTreeSet<u32> = mesh.faces.iter().flatten().copied().collect();
                for (v, n) in expected.normals.iter_mut().flatten().enumerate() {
                    if !used.contains(&(v as u32)) {
                        *n = DVec3::ZERO;
                    }
                }
            }
            let read = io::read_from(&bytes, format).unwrap().mesh;
            // Bits, so that −0 counts.
            prop_assert_eq!(format!("{:?}", read), format!("{:?}", expected), "{}", format);
        }
    }
}

#[test]
fn stl_rounds_to_32_bits_and_shares_vertices_again() {
    let mesh = shapes::pebble();
    for ascii in [false, true] {
        let mut bytes = Vec::new();
        io::write_to(&mut bytes, &mesh, MeshFormat::Stl, WriteOptions { ascii, ..WriteOptions::default() })
            .unwrap();
        assert_eq!(MeshFormat::sniff(&bytes), Some(MeshFormat::Stl));
        let read = io::read_from(&bytes, MeshFormat::Stl).unwrap().mesh;
        assert_eq!((read.positions.len(), read.faces.len()), (mesh.positions.len(), mesh.faces.len()));
        for f in 0..mesh.faces.len() {
            assert_eq!(read.corners(f), mesh.corners(f).map(|p| p.as_vec3().as_dvec3()));
        }
    }
}

#[test]
fn the_extension_decides_in_any_case_and_the_content_where_it_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = shapes::sphere(1);
    for (name, format) in [
        ("Größe 5 mm – été.OBJ", MeshFormat::Obj),
        ("名前 1.Ply", MeshFormat::Ply),
        ("a.oFF", MeshFormat::Off),
        ("b.mesh", MeshFormat::Obj),
        ("c.mesh", MeshFormat::Ply),
        ("d", MeshFormat::Off),
        ("e.model", MeshFormat::Stl),
    ] {
        let path = folder.path().join(name);
        io::write_with(&path, &mesh, WriteOptions { format: Some(format), ascii: false }).unwrap();
        assert_eq!(io::read(&path).unwrap().mesh.faces.len(), 80, "{name}");
    }
    let path = folder.path().join("f.txt");
    std::fs::write(&path, "hello").unwrap();
    assert!(matches!(io::read(&path), Err(MeshError::UnknownFormat { .. })));
    assert!(matches!(io::write(&path, &mesh), Err(MeshError::UnknownFormat { .. })));
    assert!(matches!(io::read(folder.path().join("none.obj")), Err(MeshError::Io { .. })));
    assert!(matches!(io::read(folder.path()), Err(MeshError::Io { .. })));
}

#[test]
fn writers_refuse_what_readers_would() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    let good = shapes::sphere(0);
    let refuse = |change: fn(&mut TriMesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        io::write(&path, &mesh).unwrap_err()
    };
    assert!(matches!(refuse(|m| m.faces.clear()), MeshError::NoFaces { vertices: 12, .. }));
    assert!(matches!(refuse(|m| m.faces[3][1] = 12), MeshError::VertexIndex { face: 3, vertex: 12, .. }));
    assert!(matches!(refuse(|m| m.positions[2].y = f64::NAN), MeshError::NotWritable { vertex: 2, .. }));
    assert!(matches!(
        refuse(|m| m.positions[2].y = 1e39),
        MeshError::NotWritable { precision: "32-bit", .. }
    ));
    assert!(matches!(refuse(|m| m.normals = Some(Vec::new())), MeshError::NormalCount { normals: 0, .. }));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A few bytes that claim much must cost little: the time is bounded, and with it the memory that could have been touched.
#[test]
fn lying_counts_are_cheap() {
    let mut cases: Vec<Vec<u8>> = vec![
        b"OFF\n18446744073709551615 1 0\n".to_vec(),
        b"OFF\n3 4000000000 0\n0 0 0\n1 0 0\n0 1 0\n".to_vec(),
        b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n".to_vec(),
        b"ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nend_header\n".to_vec(),
        b"ply\nformat binary_little_endian 1.0\nelement a 18446744073709551615\nproperty list uint double b\nend_header\n\xff\xff\xff\xff".to_vec(),
        b"ply\nformat ascii 1.0\nelement a 1\nproperty list uint64 double b\nend_header\n18446744073709551615 1".to_vec(),
    ];
    let mut stl = vec![0; 84 + 50];
    stl[80..84].fill(0xff);
    cases.push(stl);
    let start = std::time::Instant::now();
    for bytes in &cases {
        for format in FORMATS {
            assert!(io::read_from(bytes, format).is_err());
        }
    }
    assert!(start.elapsed() < std::time::Duration::from_secs(1));
}
