//! Which triangle each sample shows.
//!
//! Corners are rounded to a grid of 1/256 sample and the edge functions are exact integers, so that neighbours never leave a gap; where
//! two triangles are equally deep, the first one wins.

use glam::DVec3;
use suture_mesh::TriMesh;

use crate::camera::View;

/// Steps of the grid per sample.
const GRID: f64 = 256.0;
/// Largest coordinate on the grid whose products fit into 64 bits.
const FARTHEST: f64 = (1u32 << 29) as f64;

/// No triangle.
pub(crate) const NOTHING: u32 = u32::MAX;

/// A triangle of the picture: one of the mesh, or a part of one that crosses the near plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// The triangle of the mesh.
    pub(crate) triangle: u32,
    /// Whether its front faces the eye.
    pub(crate) front: bool,
    /// Corners on the grid, counter-clockwise on paper (y down).
    xy: [[i64; 2]; 3],
    /// Reciprocal depths.
    inverse: [f64; 3],
    /// Barycentric coordinates of the corners in the triangle of the mesh.
    corners: [DVec3; 3],
    area: f64,
}

/// Projects all triangles; `scale` is the number of samples per pixel along an axis.
pub(crate) fn pieces(mesh: &TriMesh, view: &View, scale: f64) -> Vec<Piece> {
    let local: Vec<[f64; 3]> = mesh.positions.iter().map(|&p| view.local(p)).collect();
    let mut pieces = Vec::with_capacity(mesh.faces.len());
    for (f, face) in mesh.faces.iter().enumerate() {
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        let corners: [([f64; 3], DVec3); 3] = [0, 1, 2].map(|k| (local[face[k] as usize], unit[k]));
        let ring = clip(&corners, view.near);
        for k in 2..ring.len() {
            pieces.extend(piece(f as u32, [ring[0], ring[k - 1], ring[k]], view, scale));
        }
    }
    pieces
}

/// The part of a triangle in front of the near plane: a ring of up to four corners.
fn clip(corners: &[([f64; 3], DVec3); 3], near: f64) -> Vec<([f64; 3], DVec3)> {
    if corners.iter().all(|c| c.0[2] >= near) {
        return corners.to_vec();
    }
    let mut ring = Vec::with_capacity(4);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if a.0[2] >= near {
            ring.push(a);
        }
        if (a.0[2] >= near) != (b.0[2] >= near) {
            let t = (near - a.0[2]) / (b.0[2] - a.0[2]);
            let mix = |i: usize| a.0[i] + t * (b.0[i] - a.0[i]);
            ring.push(([mix(0), mix(1), near], a.1.lerp(b.1, t)));
        }
    }
    ring
}

fn piece(triangle: u32, ring: [([f64; 3], DVec3); 3], view: &View, scale: f64) -> Option<Piece> {
    let mut xy = [[0; 2]; 3];
    let mut inverse = [0.0; 3];
    for k in 0..3 {
        let [x, y, depth] = view.pixels(ring[k].0);
        let grid = [x, y].map(|c| (c * scale * GRID).round());
        // Only triangles that all but touch the eye reach so far, or have corners that are not finite.
        if !grid.iter().all(|c| c.abs() < FARTHEST) {
            return None;
        }
        xy[k] = grid.map(|c| c as i64);
        inverse[k] = 1.0 / depth;
    }
    let mut corners = ring.map(|c| c.1);
    let twice = cross(xy[0], xy[1], xy[2]);
    if twice == 0 {
        return None;
    }
    // y points down: what is counter-clockwise in space has a negative area here.
    let front = twice < 0;
    if front {
        xy.swap(1, 2);
        inverse.swap(1, 2);
        corners.swap(1, 2);
    }
    Some(Piece { triangle, front, xy, inverse, corners, area: twice.unsigned_abs() as f64 })
}

fn cross(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// The grid coordinate of the middle of sample `i`.
fn middle(i: usize) -> i64 {
    i as i64 * GRID as i64 + GRID as i64 / 2
}

impl Piece {
    /// First and last row of samples that it may cover, within `rows` rows.
    pub(crate) fn rows(&self, rows: usize) -> std::ops::Range<usize> {
        range(self.xy.map(|p| p[1]), 0..rows)
    }

    /// The barycentric coordinates, in the triangle of the mesh, of sample `(x, y)`, and the reciprocal depth.
    pub(crate) fn at(&self, x: usize, y: usize) -> (DVec3, f64) {
        let p = [middle(x), middle(y)];
        let weight = |k: usize| cross(self.xy[(k + 1) % 3], self.xy[(k + 2) % 3], p) as f64 / self.area;
        let w = [0, 1, 2].map(|k| weight(k) * self.inverse[k]);
        let inverse = w[0] + w[1] + w[2];
        ((self.corners[0] * w[0] + self.corners[1] * w[1] + self.corners[2] * w[2]) / inverse, inverse)
    }
}

/// The samples whose middles lie between the smallest and largest coordinate.
fn range(c: [i64; 3], all: std::ops::Range<usize>) -> std::ops::Range<usize> {
    let (step, half) = (GRID as i64, GRID as i64 / 2);
    let low = (c[0].min(c[1]).min(c[2]) - half).div_euclid(step);
    let high = (c[0].max(c[1]).max(c[2]) - half).div_euclid(step) + 1;
    let clamp = |i: i64| i.clamp(all.start as i64, all.end as i64) as usize;
    clamp(low)..clamp(high)
}

/// Draws `pieces` (by number, ascending) into the rows `rows` of samples, `width` wide: the number of the piece that each sample shows.
pub(crate) fn draw(pieces: &[Piece], order: &[u32], width: usize, rows: std::ops::Range<usize>) -> Vec<u32> {
    let mut shown = vec![NOTHING; width * rows.len()];
    let mut nearest = vec![0.0_f64; shown.len()];
    for &number in order {
        let piece = &pieces[number as usize];
        let [a, b, c] = piece.xy;
        let columns = range([a[0], b[0], c[0]], 0..width);
        for y in range([a[1], b[1], c[1]], rows.clone()) {
            let row = (y - rows.start) * width;
            let p = [middle(columns.start), middle(y)];
            let mut e = [cross(b, c, p), cross(c, a, p), cross(a, b, p)];
            let step = [c[1] - b[1], a[1] - c[1], b[1] - a[1]].map(|d| d * GRID as i64);
            for x in columns.clone() {
                if e[0] >= 0 && e[1] >= 0 && e[2] >= 0 {
                    let w = |k: usize| e[k] as f64 / piece.area * piece.inverse[k];
                    let inverse = w(0) + w(1) + w(2);
                    if inverse > nearest[row + x] {
                        nearest[row + x] = inverse;
                        shown[row + x] = number;
                    }
                }
                for k in 0..3 {
                    e[k] -= step[k];
                }
            }
        }
    }
    shown
}
