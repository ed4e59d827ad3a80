//! Meshes: the shared test data, and shapes with known answers.

#![allow(dead_code, reason = "every test file uses some of these")]

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

/// A file of the shared data, or `None` with a printed reason.
pub(crate) fn data(path: &str) -> Option<String> {
    let full = format!("{}/../../../shared/data/{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&full).inspect_err(|e| println!("skipped: {full}: {e}")).ok()
}

/// A triangle mesh from an OBJ or OFF file, and its adjacency.
pub(crate) fn mesh(path: &str) -> Option<(TriMesh, Topology)> {
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

/// The surface of the cube [0, n]³ in unit squares, every square cut from its lower to its upper corner.
pub(crate) fn cube(n: i32) -> TriMesh {
    let mut index = std::collections::HashMap::new();
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut vertex = |p: [i32; 3]| {
        *index.entry(p).or_insert_with(|| {
            positions.push(DVec3::from_array(p.map(f64::from)));
            positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        for side in [0, n] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let mut at = |u: i32, v: i32| {
                    let mut p = [side; 3];
                    p[(axis + 1) % 3] = u;
                    p[(axis + 2) % 3] = v;
                    vertex(p)
                };
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let outward = [[a, b, c], [a, c, d]];
                faces.extend(if side == n { outward } else { outward.map(|[p, q, r]| [p, r, q]) });
            }
        }
    }
    TriMesh::new(positions, faces)
}

/// The octahedron, subdivided 1:4 `levels` times and put on the unit sphere. Vertex 0 is +z, 5 is −z, 1 to 4 the equator.
pub(crate) fn sphere(levels: usize) -> TriMesh {
    let mut positions = vec![DVec3::Z, DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let mut faces: Vec<[u32; 3]> =
        (0..4).flat_map(|i| [[0, 1 + i, 1 + (i + 1) % 4], [5, 1 + (i + 1) % 4, 1 + i]]).collect();
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (p, q, r) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
            })
            .collect();
    }
    TriMesh::new(positions, faces)
}

/// A torus of radii 1 and 0.25: `m` squares around the axis, `n` around the tube, two faces each, row by row around the axis.
pub(crate) fn torus(m: u32, n: u32) -> TriMesh {
    let turn = |i: u32, n: u32| (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
    let positions = (0..m * n)
        .map(|k| {
            let ((s, c), (z, r)) = (turn(k / n, m), turn(k % n, n));
            DVec3::new((1.0 + 0.25 * r) * c, (1.0 + 0.25 * r) * s, 0.25 * z)
        })
        .collect();
    let at = |i: u32, j: u32| (i % m) * n + j % n;
    let faces = (0..m * n)
        .flat_map(|k| {
            let (i, j) = (k / n, k % n);
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriMesh::new(positions, faces)
}
