//! Meshes for the tests.
#![allow(dead_code)]

use glam::{DQuat, DVec2, DVec3};
use suture_mesh::{Topology, TriMesh};
use suture_param::{CollarOptions, Disc, disc_with_collar};

/// A file of the public test data, or `None` (with a printed reason) where the data is not installed.
pub(crate) fn data(name: &str) -> Option<String> {
    let path = format!("{}/../../../shared/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path);
    if let Err(e) = &text {
        println!("skipped: {path}: {e}");
    }
    text.ok()
}

/// OFF and OBJ files of triangles, in the numbering of the file.
pub(crate) fn mesh(name: &str) -> Option<TriMesh> {
    let text = data(name)?;
    let mut lines = text.lines().map(|l| l.split('#').next().unwrap()).filter(|l| !l.trim().is_empty());
    let words = |l: &str| l.split_whitespace().map(str::to_string).collect::<Vec<_>>();
    let point =
        |w: &[String]| DVec3::from_slice(&w[..3].iter().map(|s| s.parse().unwrap()).collect::<Vec<_>>());
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    if name.ends_with(".off") {
        lines.next();
        let counts = words(lines.next().unwrap());
        let [n, m] = [0, 1].map(|i| counts[i].parse::<usize>().unwrap());
        positions.extend(lines.by_ref().take(n).map(|l| point(&words(l))));
        faces.extend(lines.take(m).map(|l| {
            let w = words(l);
            [1, 2, 3].map(|i| w[i].parse().unwrap())
        }));
    } else {
        for line in lines {
            let w = words(line);
            match w[0].as_str() {
                "v" => positions.push(point(&w[1..])),
                "f" => {
                    let index = |i: usize| w[i].split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                    faces.extend((2..w.len() - 1).map(|i| [index(1), index(i), index(i + 1)]));
                }
                _ => {}
            }
        }
    }
    Some(TriMesh::new(positions, faces))
}

/// Faces of every label, ascending.
pub(crate) fn segments(name: &str) -> Option<Vec<Vec<u32>>> {
    let text = data(name)?;
    let mut segments: Vec<Vec<u32>> = Vec::new();
    for (f, label) in text.split_whitespace().enumerate() {
        let label: usize = label.parse().unwrap();
        segments.resize(segments.len().max(label + 1), Vec::new());
        segments[label].push(f as u32);
    }
    segments.retain(|s| !s.is_empty());
    Some(segments)
}

/// The whole of an open mesh.
pub(crate) fn whole(mesh: &TriMesh) -> Disc {
    let all: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    disc(mesh, &all, 0)
}

pub(crate) fn disc(mesh: &TriMesh, segment: &[u32], max_rings: usize) -> Disc {
    let topology = Topology::build(mesh).unwrap();
    disc_with_collar(mesh, &topology, segment, &CollarOptions { max_rings, ..smooth() }).unwrap()
}

/// Collars that cross every edge.
pub(crate) fn smooth() -> CollarOptions {
    CollarOptions { sharp: std::f64::consts::PI, ..Default::default() }
}

/// An `m × n` grid of quads over [0, m] × [0, n], cut alternately, mapped into space.
pub(crate) fn grid(m: u32, n: u32, map: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let at = |i: u32, j: u32| j * (m + 1) + i;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for j in 0..=n {
        for i in 0..=m {
            positions.push(map(i as f64, j as f64));
            if i < m && j < n {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                faces.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
            }
        }
    }
    TriMesh::new(positions, faces)
}

/// A closed `m × n` torus, every quad cut the same way.
pub(crate) fn torus(m: u32, n: u32) -> TriMesh {
    let at = |i: u32, j: u32| (j % n) * m + i % m;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for j in 0..n {
        for i in 0..m {
            let [a, b] = [i as f64 / m as f64, j as f64 / n as f64].map(|t| t * std::f64::consts::TAU);
            let r = 1.0 + 0.4 * b.cos();
            positions.push(DVec3::new(r * a.cos(), r * a.sin(), 0.4 * b.sin()));
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriMesh::new(positions, faces)
}

/// An octahedron, refined and pushed onto the unit sphere.
pub(crate) fn sphere(levels: u32) -> TriMesh {
    let mut positions = vec![DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut faces: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middle = std::collections::HashMap::new();
        let mut split = |a: u32, b: u32| {
            *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (d, e, f) = (split(a, b), split(b, c), split(c, a));
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    TriMesh::new(positions, faces)
}

/// Numbers of a fixed sequence.
pub(crate) struct Numbers(pub u64);

impl Numbers {
    /// Uniform in [0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A permutation of 0 … n − 1.
    pub(crate) fn permutation(&mut self, n: usize) -> Vec<u32> {
        let mut p: Vec<u32> = (0..n as u32).collect();
        for i in (1..n).rev() {
            p.swap(i, (self.next() * (i + 1) as f64) as usize);
        }
        p
    }
}

/// The same mesh under another numbering of vertices and faces, and with other first corners: new numbers of old vertices and
/// faces.
pub(crate) fn renumbered(mesh: &TriMesh, seed: u64) -> (TriMesh, Vec<u32>, Vec<u32>) {
    let mut numbers = Numbers(seed);
    let vertices = numbers.permutation(mesh.positions.len());
    let faces = numbers.permutation(mesh.faces.len());
    let mut new = mesh.clone();
    for (v, &w) in vertices.iter().enumerate() {
        new.positions[w as usize] = mesh.positions[v];
    }
    for (f, &g) in faces.iter().enumerate() {
        let mut face = mesh.faces[f].map(|v| vertices[v as usize]);
        face.rotate_left((numbers.next() * 3.0) as usize);
        new.faces[g as usize] = face;
    }
    (new, vertices, faces)
}

pub(crate) fn mapped(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    TriMesh::new(mesh.positions.iter().map(|&p| map(p)).collect(), mesh.faces.clone())
}

pub(crate) fn turn() -> DQuat {
    DQuat::from_axis_angle(DVec3::new(0.3, -0.5, 0.7).normalize(), 1.234)
}

/// Largest distance between corresponding points after the best similarity of `from` onto `to`, relative to the extent of `to`.
#[track_caller]
pub(crate) fn similarity_error(from: &[DVec2], to: &[DVec2]) -> f64 {
    assert_eq!(from.len(), to.len());
    let n = from.len() as f64;
    let mean = |p: &[DVec2]| p.iter().copied().sum::<DVec2>() / n;
    let (a, b) = (mean(from), mean(to));
    let mut z = DVec2::ZERO;
    let mut square = 0.0;
    for (p, q) in from.iter().zip(to) {
        let (p, q) = (*p - a, *q - b);
        z += DVec2::new(p.dot(q), p.perp_dot(q));
        square += p.length_squared();
    }
    z /= square;
    let extent = to.iter().map(|q| (*q - b).length()).fold(0.0, f64::max);
    from.iter().zip(to).map(|(p, q)| (z.rotate(*p - a) - (*q - b)).length()).fold(0.0, f64::max) / extent
}
