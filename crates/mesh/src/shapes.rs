//! Meshes made by formula: for tests, for examples and as the shape shown when nothing else is given.
//!
//! All are deterministic to the bit on one machine; all but [`torus`] use only arithmetic and square roots and are the same
//! everywhere. Faces are counter-clockwise seen from outside; the meshes have no normals.

use std::collections::HashMap;

use glam::DVec3;

use crate::TriMesh;

/// Highest level of [`sphere`]: 5 242 880 triangles.
pub const MAX_SPHERE_LEVEL: u32 = 9;

/// Largest number of parts per edge in the other shapes.
pub const MAX_PARTS: u32 = 256;

/// Unit sphere: an icosahedron, each face divided into `4^level` triangles (20, 80, 320, 1280, …). Levels above
/// [`MAX_SPHERE_LEVEL`] are taken as that.
pub fn sphere(level: u32) -> TriMesh {
    geodesic(1 << level.min(MAX_SPHERE_LEVEL))
}

/// Torus around the z axis with `nu` quads around the axis and `nv` around the tube, each cut in two; radii `major` (of the centre
/// line) and `minor` (of the tube). Numbers are clamped to 3..=[`MAX_PARTS`]; genus 1.
pub fn torus(major: f64, minor: f64, nu: u32, nv: u32) -> TriMesh {
    let (nu, nv) = (nu.clamp(3, MAX_PARTS), nv.clamp(3, MAX_PARTS));
    let turn = |k: u32, n: u32| (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
    let mut positions = Vec::with_capacity((nu * nv) as usize);
    let mut faces = Vec::with_capacity(2 * (nu * nv) as usize);
    for i in 0..nu {
        let (su, cu) = turn(i, nu);
        for j in 0..nv {
            let (sv, cv) = turn(j, nv);
            let r = major + minor * cv;
            positions.push(DVec3::new(r * cu, r * su, minor * sv));
            let at = |i: u32, j: u32| (i % nu) * nv + j % nv;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriMesh::new(positions, faces)
}

/// Box around the origin with edges of length `size`, each divided into `n` parts: `12 n²` triangles. `n` is clamped to
/// 1..=[`MAX_PARTS`].
pub fn cuboid(size: DVec3, n: u32) -> TriMesh {
    let n = n.clamp(1, MAX_PARTS);
    grid_surface([n; 3], |_| true, |p| (p / f64::from(n) - 0.5) * size)
}

/// Box with edges of length 2 around the origin, its edges and corners rounded with radius 1/2: G¹, with flat sides, `12 n²`
/// triangles. `n` is clamped to 1..=[`MAX_PARTS`].
pub fn rounded_box(n: u32) -> TriMesh {
    const CORE: f64 = 0.5;
    let mut mesh = cuboid(DVec3::splat(2.0), n);
    for p in &mut mesh.positions {
        let core = p.clamp(DVec3::splat(-CORE), DVec3::splat(CORE));
        *p = core + (1.0 - CORE) * (*p - core).normalize();
    }
    mesh
}

/// A smooth stone without symmetry, about two units across: genus 0, 2880 triangles.
pub fn pebble() -> TriMesh {
    let mut mesh = geodesic(12);
    for p in &mut mesh.positions {
        let DVec3 { x, y, z } = *p;
        // Low harmonics of the radius, an ellipsoid, then a bend: each invertible and smooth.
        let r =
            1.0 + 0.12 * x * y + 0.09 * z * (1.0 - 2.0 * x * x) + 0.07 * y * (y * y - 3.0 * z * x) - 0.05 * x;
        let q = DVec3::new(1.25 * x, 0.95 * y, 0.7 * z) * r;
        *p = DVec3::new(
            q.x + 0.12 * q.y * q.y,
            q.y + 0.10 * q.z * q.x,
            q.z + 0.16 * q.x * q.x - 0.08 * q.x * q.y,
        );
    }
    mesh
}

/// A smooth solid figure eight, about five units long: genus 2. Each unit of length is divided into `n` parts, clamped to 2..=32;
/// `100 n²` triangles.
pub fn double_torus(n: u32) -> TriMesh {
    let n = n.clamp(2, 32);
    let hole = |i: u32| i / n == 1 || i / n == 3;
    let filled = |[i, j, _]: [u32; 3]| !(hole(i) && j / n == 1);
    let centre = DVec3::new(2.5, 1.5, 0.5);
    let mut mesh = grid_surface([5 * n, 3 * n, n], filled, |p| p / f64::from(n) - centre);
    // Averaging rounds the edges off; as many rounds as it takes at this resolution.
    for _ in 0..2 * n * n {
        average(&mut mesh);
    }
    mesh
}

/// Moves every vertex half way to the mean of its neighbours.
fn average(mesh: &mut TriMesh) {
    let mut sums = vec![(DVec3::ZERO, 0.0); mesh.positions.len()];
    for face in &mesh.faces {
        for k in 0..3 {
            // In a closed mesh every edge is met once from each end.
            let (a, b) = (face[k] as usize, face[(k + 1) % 3] as usize);
            sums[a].0 += mesh.positions[b];
            sums[a].1 += 1.0;
        }
    }
    for (p, (sum, count)) in mesh.positions.iter_mut().zip(sums) {
        *p = 0.5 * *p + 0.5 * sum / count;
    }
}

/// Icosahedron with edges divided into `n` parts, projected to the unit sphere: `20 n²` triangles.
fn geodesic(n: u32) -> TriMesh {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let mut corners = Vec::with_capacity(12);
    for (s, t) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        corners.extend([DVec3::new(0.0, s, t), DVec3::new(s, t, 0.0), DVec3::new(t, 0.0, s)]);
    }
    // Three corners at mutual distance 2 are a face.
    let near = |a: usize, b: usize| (corners[a].distance_squared(corners[b]) - 4.0).abs() < 1e-9;
    let mut mesh = TriMesh::default();
    let mut known = HashMap::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if !(near(a, b) && near(b, c) && near(c, a)) {
                    continue;
                }
                let [p, q, r] = [corners[a], corners[b], corners[c]];
                let outwards = (q - p).cross(r - p).dot(p) > 0.0;
                let (b, c) = if outwards { (b, c) } else { (c, b) };
                // A grid point by its weights at the corners, those of weight zero left out: neighbours find it again.
                let mut vertex = |i: u32, j: u32| {
                    let mut key =
                        [(a, n - i - j), (b, i), (c, j)].map(|(k, w)| if w > 0 { (k, w) } else { (0, 0) });
                    key.sort_unstable();
                    *known.entry(key).or_insert_with(|| {
                        let sum: DVec3 = key.iter().map(|&(k, w)| corners[k] * f64::from(w)).sum();
                        mesh.positions.push(sum.normalize());
                        mesh.positions.len() as u32 - 1
                    })
                };
                let mut faces = Vec::with_capacity((n * n) as usize);
                for i in 0..n {
                    for j in 0..n - i {
                        faces.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                        if i + j + 2 <= n {
                            faces.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                        }
                    }
                }
                mesh.faces.extend(faces);
            }
        }
    }
    mesh
}

/// Border of the filled cells of a grid, two triangles per square, with `place` taking grid points to space.
fn grid_surface(
    cells: [u32; 3],
    filled: impl Fn([u32; 3]) -> bool,
    place: impl Fn(DVec3) -> DVec3,
) -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut known = HashMap::new();
    let inside =
        |c: [i64; 3]| (0..3).all(|k| (0..i64::from(cells[k])).contains(&c[k])) && filled(c.map(|x| x as u32));
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for w in 0..=i64::from(cells[axis]) {
            for i in 0..i64::from(cells[u]) {
                for j in 0..i64::from(cells[v]) {
                    let at = |w: i64, i: i64, j: i64| {
                        let mut c = [0; 3];
                        (c[axis], c[u], c[v]) = (w, i, j);
                        c
                    };
                    let (below, above) = (inside(at(w - 1, i, j)), inside(at(w, i, j)));
                    if below == above {
                        continue;
                    }
                    let mut vertex = |di: i64, dj: i64| {
                        let c = at(w, i + di, j + dj);
                        *known.entry(c).or_insert_with(|| {
                            mesh.positions.push(place(DVec3::from(c.map(|x| x as f64))));
                            mesh.positions.len() as u32 - 1
                        })
                    };
                    let (a, b, c, d) = (vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1));
                    mesh.faces.extend(if above { [[c, b, a], [c, a, d]] } else { [[a, b, c], [a, c, d]] });
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Topology, check};

    #[track_caller]
    fn verify(mesh: &TriMesh, faces: usize, genus: usize) {
        assert_eq!(mesh.faces.len(), faces);
        Topology::build(mesh).unwrap();
        let report = check(mesh);
        assert!(report.is_sound(), "{report:?}");
        assert!(report.closed && report.inside_out == 0);
        assert_eq!((report.genus, report.components.total), (Some(genus), 1));
    }

    #[test]
    fn all_are_closed_oriented_and_of_their_genus() {
        verify(&sphere(0), 20, 0);
        verify(&sphere(3), 1280, 0);
        verify(&torus(2.0, 0.5, 16, 8), 256, 1);
        verify(&torus(2.0, 0.5, 0, 0), 18, 1);
        verify(&cuboid(DVec3::ONE, 3), 108, 0);
        verify(&rounded_box(6), 432, 0);
        verify(&rounded_box(1), 12, 0);
        verify(&pebble(), 2880, 0);
        verify(&double_torus(4), 1600, 2);
    }

    #[test]
    fn volumes_are_those_of_the_formulas() {
        let near = |mesh: &TriMesh, volume: f64, tolerance: f64| {
            let measured = check(mesh).volume;
            assert!((measured / volume - 1.0).abs() < tolerance, "{measured} ≠ {volume}");
        };
        let pi = std::f64::consts::PI;
        near(&sphere(5), 4.0 / 3.0 * pi, 1e-3);
        near(&torus(2.0, 0.5, 128, 64), pi * pi, 4e-3);
        near(&cuboid(DVec3::new(1.0, 2.0, 3.0), 4), 6.0, 1e-14);
        // Cube of side 1, six slabs, twelve quarter cylinders and one sphere of radius 1/2.
        near(&rounded_box(64), 1.0 + 3.0 + 3.0 * pi * 0.25 + pi / 6.0, 1e-3);
    }

    #[test]
    fn the_pebble_is_smooth() {
        let mesh = pebble();
        let topology = Topology::build(&mesh).unwrap();
        for h in 0..topology.half_edge_count() as u32 {
            assert!(crate::dihedral_angle(&topology, &mesh, h).unwrap().abs() < 0.35);
        }
    }
}
