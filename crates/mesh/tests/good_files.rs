//! Statistics of good files, against their table and against counts made naively.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::PathBuf,
};

use suture_mesh::{Topology, TriMesh, check, components, io};

fn good() -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/good"));
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: there is no folder with good test data beside the workspace");
    None
}

/// Vertices, triangles, Euler characteristic, genus, boundary loops (one component each).
const TABLE: [(&str, usize, usize, i64, usize, usize); 24] = [
    ("spot.obj", 2930, 5856, 2, 0, 0),
    ("fish.obj", 10786, 21568, 2, 0, 0),
    ("blobby.off", 2027, 4050, 2, 0, 0),
    ("hand.off", 1197, 2390, 2, 0, 0),
    ("cow.off", 2904, 5804, 2, 0, 0),
    ("fandisk.off", 6475, 12946, 2, 0, 0),
    ("anchor_dense.off", 3793, 7598, -6, 4, 0),
    ("couplingdown.off", 1841, 3714, -16, 9, 0),
    ("part.off", 175, 346, 2, 0, 0),
    ("wingnut.obj", 3047, 6090, 2, 0, 0),
    ("torus.obj", 2304, 4608, 0, 1, 0),
    ("knot1.off", 3200, 6400, 0, 1, 0),
    ("eight.off", 315, 634, -2, 2, 0),
    ("elephant.off", 2775, 5558, -4, 3, 0),
    ("turbine.off", 9210, 18460, -20, 11, 0),
    ("sphere.obj", 642, 1280, 2, 0, 0),
    ("demosthenes-low-res.obj", 8394, 16719, 1, 0, 1),
    ("hand_lowres.obj", 810, 1602, 1, 0, 1),
    ("mannequin-devil.off", 12977, 25888, 1, 0, 1),
    ("nefertiti_coarse.off", 299, 562, 1, 0, 1),
    ("three_peaks.off", 1907, 3671, 1, 0, 1),
    ("holes.off", 4291, 8288, -5, 0, 7),
    ("lion.off", 7529, 14859, -3, 0, 5),
    ("skull_100k.ply", 49999, 100002, -2, 2, 0),
];

/// Used vertices − edges + faces, loops and components, by sets and flooding, sharing no code with the crate.
fn naive(mesh: &TriMesh) -> (i64, usize, usize) {
    let mut used: BTreeSet<u32> = BTreeSet::new();
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for f in &mesh.faces {
        used.extend(f);
        for [a, b] in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let parts = |edges: &mut dyn Iterator<Item = &[u32; 2]>| {
        let mut neighbours: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[a, b] in edges {
            neighbours.entry(a).or_default().push(b);
            neighbours.entry(b).or_default().push(a);
        }
        let mut seen = BTreeSet::new();
        let mut count = 0;
        for &start in neighbours.keys() {
            let mut stack = vec![start];
            count += usize::from(!seen.contains(&start));
            while let Some(v) = stack.pop() {
                if seen.insert(v) {
                    stack.extend(&neighbours[&v]);
                }
            }
        }
        count
    };
    let euler = used.len() as i64 - edges.len() as i64 + mesh.faces.len() as i64;
    // Boundaries of manifolds meet themselves nowhere: their connected parts are the loops.
    let loops = parts(&mut edges.iter().filter(|(_, n)| **n == 1).map(|(e, _)| e));
    (euler, loops, parts(&mut edges.keys()))
}

#[test]
fn statistics_are_those_of_the_table_and_of_a_naive_count() {
    let Some(folder) = good() else { return };
    for (file, vertices, faces, euler, genus, loops) in TABLE {
        let mesh = io::read(folder.join(file)).unwrap_or_else(|e| panic!("{file}: {e}")).mesh;
        let report = check(&mesh);
        assert!(report.manifold && report.oriented, "{file}: {report}");
        assert_eq!((report.vertices, report.faces), (vertices, faces), "{file}");
        assert_eq!((report.euler_characteristic, report.genus), (euler, Some(genus)), "{file}");
        assert_eq!((report.boundary_loops.total, report.components.total), (loops, 1), "{file}");
        assert_eq!(naive(&mesh), (euler, loops, 1), "{file}");
        assert_eq!(report.coincident.total, usize::from(file == "cow.off"), "{file}");
        assert_eq!(report.closed, loops == 0, "{file}");
        assert!(Topology::build(&mesh).unwrap().is_closed() == report.closed);
        assert_eq!(components(&mesh).len(), 1);
    }
}

/// Every file again in every format and back.
#[test]
fn good_files_survive_a_round_trip() {
    let Some(folder) = good() else { return };
    let temporary = tempfile::tempdir().unwrap();
    for file in ["spot.obj", "cow.off", "sphere.obj"] {
        let mesh = io::read(folder.join(file)).unwrap().mesh;
        for extension in ["obj", "ply", "off"] {
            let path = temporary.path().join(format!("Größe, mm – été {file}.{extension}"));
            io::write(&path, &mesh).unwrap();
            assert_eq!(io::read(&path).unwrap().mesh, mesh, "{file} as {extension}");
            fs::remove_file(path).unwrap();
        }
    }
    assert_eq!(fs::read_dir(temporary.path()).unwrap().count(), 0);
}
