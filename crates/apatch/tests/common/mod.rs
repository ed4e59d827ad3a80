//! Meshes and measures that tests and examples share.
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

/// Largest jumps of `F` and its gradient across walls.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jumps {
    pub(crate) value: f64,
    pub(crate) gradient: f64,
    pub(crate) walls: usize,
}

/// Largest relative jumps of `F` and its gradient across walls shared by two cells, and the number of walls.
pub(crate) fn wall_jumps(surface: &ApatchSurface) -> Jumps {
    // A wall by its corners in one order, with their places in the cell.
    let mut walls: Vec<([[u64; 3]; 3], Cell, [usize; 3])> = Vec::new();
    for cell in surface.cells() {
        let Some(v) = surface.cell_vertices(cell) else { continue };
        for skip in 0..4 {
            let mut corners = [1, 2, 3]
                .map(|i| (skip + i) % 4)
                .map(|i| ((v[i] + DVec3::ZERO).to_array().map(f64::to_bits), i));
            corners.sort_unstable();
            walls.push((corners.map(|c| c.0), cell, corners.map(|c| c.1)));
        }
    }
    walls.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut value, mut gradient, mut count) = (0.0_f64, 0.0_f64, 0);
    for pair in walls.windows(2).filter(|p| p[0].0 == p[1].0) {
        count += 1;
        let Some(v) = surface.cell_vertices(pair[0].1) else { continue };
        let c = pair[0].2.map(|i| v[i]);
        let size = c[0].distance(c[1]).max(c[0].distance(c[2])).max(c[1].distance(c[2]));
        let (mut scale, mut worst) = (0.0_f64, [0.0_f64; 2]);
        for i in 0..=5 {
            for j in 0..=5 - i {
                let (x, y) = (f64::from(i) / 5.0, f64::from(j) / 5.0);
                let at = |(_, cell, places): &([[u64; 3]; 3], Cell, [usize; 3])| {
                    let mut barycentric = [0.0; 4];
                    for (place, w) in places.iter().zip([1.0 - x - y, x, y]) {
                        barycentric[*place] = w;
                    }
                    surface.value(Location { cell: *cell, barycentric })
                };
                let (Some(f), Some(g)) = (at(&pair[0]), at(&pair[1])) else { continue };
                scale = scale.max(f.1.length());
                worst = [worst[0].max((f.0 - g.0).abs()), worst[1].max(f.1.distance(g.1))];
            }
        }
        value = value.max(worst[0] / (scale * size));
        gradient = gradient.max(worst[1] / scale);
    }
    Jumps { value, gradient, walls: count }
}

pub(crate) fn sides() -> [Side; 2] {
    [Side::Positive, Side::Negative]
}
