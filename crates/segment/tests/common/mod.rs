//! Meshes of the test data.

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

/// A file of the shared data, or `None` with a printed reason.
pub fn data(path: &str) -> Option<String> {
    let full = format!("{}/../../../shared/data/{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&full).inspect_err(|e| println!("skipped: {full}: {e}")).ok()
}

/// A triangle mesh from an OBJ or OFF file, and its adjacency.
#[allow(dead_code, reason = "not every test file reads meshes")]
pub fn mesh(path: &str) -> Option<(TriMesh, Topology)> {
    let text = data(path)?;
    let mesh = if path.ends_with(".obj") { obj(&text) } else { off(&text) };
    let topology = Topology::build(&mesh).unwrap();
    Some((mesh, topology))
}

fn obj(text: &str) -> TriMesh {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let x: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
                positions.push(DVec3::new(x[0], x[1], x[2]));
            }
            Some("f") => {
                let v: Vec<u32> =
                    words.map(|w| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                faces.extend((1..v.len() - 1).map(|i| [v[0], v[i], v[i + 1]]));
            }
            _ => {}
        }
    }
    TriMesh::new(positions, faces)
}

fn off(text: &str) -> TriMesh {
    let mut words =
        text.lines().flat_map(|l| l.split('#').next().unwrap().split_whitespace()).filter(|w| *w != "OFF");
    let mut number = || words.next().unwrap().parse::<f64>().unwrap();
    let (vertices, faces) = (number() as usize, number() as usize);
    number();
    let positions = (0..vertices).map(|_| DVec3::new(number(), number(), number())).collect();
    let mut triangles = Vec::new();
    for _ in 0..faces {
        let n = number() as usize;
        let v: Vec<u32> = (0..n).map(|_| number() as u32).collect();
        triangles.extend((1..n - 1).map(|i| [v[0], v[i], v[i + 1]]));
    }
    TriMesh::new(positions, triangles)
}
