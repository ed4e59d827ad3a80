//! Meshes and measures that several tests share.
#![allow(dead_code)]

use glam::DVec3;
use suture_apatch::{ApatchSurface, Cell, Location, Side};
use suture_mesh::TriMesh;

/// One of the two-triangle figures of the paper: 6, 7, 9 or 10, with its gradients.
pub(crate) fn figure(number: u32) -> (TriMesh, Vec<DVec3>) {
    let v = DVec3::new;
    let last = if number == 10 { v(0.0, -4.0, 0.0) } else { v(0.0, -4.0, -1.0) };
    let positions = vec![v(-2.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 4.0, -1.0), last];
    let normals = match number {
        6 => [v(-1.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0), v(0.0, -1.0, 1.0)],
        7 => [v(-1.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.5), v(0.0, 1.0, 1.5)],
        9 => [v(1.0, 0.0, 1.0), v(1.0, 0.0, 1.0), v(0.0, -1.0, 1.5), v(0.0, 1.0, 1.5)],
        _ => [DVec3::Z, DVec3::Z, v(0.0, -1.0, 1.5), DVec3::Z],
    };
    (TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]), normals.to_vec())
}

pub(crate) fn octahedron() -> TriMesh {
    let positions = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|a| [a, -a]).collect();
    let mut faces = Vec::new();
    for x in [0u32, 1] {
        for y in [2u32, 3] {
            for z in [4u32, 5] {
                let even = (x + y + z) % 2 == 0;
                faces.push(if even { [x, y, z] } else { [y, x, z] });
            }
        }
    }
    TriMesh::new(positions, faces)
}

/// Largest jumps of `F` and its gradient across walls, relative to the largest gradient (times the largest edge for values).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jumps {
    pub(crate) value: f64,
    pub(crate) gradient: f64,
    pub(crate) walls: usize,
}

/// Compares all pairs of cells that share a wall: three vertices at the same place.
pub(crate) fn wall_jumps(surface: &ApatchSurface) -> Jumps {
    let cells = surface.cells();
    let mut walls: Vec<([[u64; 3]; 3], Cell, [DVec3; 3])> = Vec::new();
    for &cell in &cells {
        let v = surface.cell_vertices(cell).unwrap();
        for skip in 0..4 {
            let w: Vec<DVec3> = (0..4).filter(|&i| i != skip).map(|i| v[i]).collect();
            let mut key = [0, 1, 2].map(|i| (w[i] + DVec3::ZERO).to_array().map(f64::to_bits));
            key.sort_unstable();
            walls.push((key, cell, [w[0], w[1], w[2]]));
        }
    }
    walls.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut jumps = Jumps::default();
    for pair in walls.windows(2).filter(|p| p[0].0 == p[1].0) {
        jumps.walls += 1;
        let (a, b) = (pair[0].1, pair[1].1);
        let corners = pair[0].2;
        let size = corners[0].distance(corners[1]).max(corners[0].distance(corners[2]));
        let n = 6;
        let mut samples = Vec::new();
        let mut scale = 0.0_f64;
        for i in 0..=n {
            for j in 0..=n - i {
                let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                let p = corners[0] * (1.0 - x - y) + corners[1] * x + corners[2] * y;
                let at = |cell: Cell| {
                    let barycentric = surface.barycentric(cell, p).unwrap();
                    surface.value(Location { cell, barycentric }).unwrap()
                };
                let (f, g) = (at(a), at(b));
                scale = scale.max(f.1.length());
                samples.push((f.0 - g.0, f.1 - g.1));
            }
        }
        for (f, g) in samples {
            jumps.value = jumps.value.max(f.abs() / (scale * size));
            jumps.gradient = jumps.gradient.max(g.length() / scale);
        }
    }
    jumps
}

pub(crate) fn sides() -> [Side; 2] {
    [Side::Positive, Side::Negative]
}
