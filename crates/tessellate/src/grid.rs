//! Regular grids of rectangles and polygons.
//!
//! No inner edge joins two boundary vertices (where both counts are at least 2): the diagonals at the corners start there. So
//! two patches that share several boundary vertices never share an inner edge by accident.

use glam::DVec2;

use crate::demand::bilinear;

/// A triangulated patch. Vertices `0..b` are the boundary points in the order of loops and edges, the rest is `interior`.
#[derive(Debug, Default)]
pub(crate) struct PatchMesh {
    /// Parameters of the interior vertices.
    pub(crate) interior: Vec<DVec2>,
    /// Triangles, counter-clockwise in the parameter plane.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// A cell of a grid: two ways to split it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// Vertices, counter-clockwise.
    pub(crate) corners: [u32; 4],
    /// `Some(true)`: the diagonal must run from corner 0 to 2; `Some(false)`: from 1 to 3.
    pub(crate) forced: Option<bool>,
}

/// A grid whose cells are not split yet.
#[derive(Debug, Default)]
pub(crate) struct Grid {
    pub(crate) interior: Vec<DVec2>,
    pub(crate) cells: Vec<Cell>,
}

/// The grid of `n[0] × n[1]` cells of a rectangle.
pub(crate) fn rectangle(min: DVec2, max: DVec2, n: [usize; 2]) -> Grid {
    let [nu, nv] = n;
    let around = 2 * (nu + nv);
    let vertex = |i: usize, j: usize| {
        let index = if j == 0 {
            i
        } else if i == nu {
            nu + j
        } else if j == nv {
            nu + nv + (nu - i)
        } else if i == 0 {
            around - j
        } else {
            around + (j - 1) * (nu - 1) + i - 1
        };
        index as u32
    };
    let mut grid = Grid::default();
    for j in 1..nv {
        for i in 1..nu {
            let (s, t) = (i as f64 / nu as f64, j as f64 / nv as f64);
            grid.interior.push(DVec2::new(min.x * (1.0 - s) + max.x * s, min.y * (1.0 - t) + max.y * t));
        }
    }
    for j in 0..nv {
        for i in 0..nu {
            let corners = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            let (left, right, low, high) = (i == 0, i + 1 == nu, j == 0, j + 1 == nv);
            let forced = match ((left && low) || (right && high), (right && low) || (left && high)) {
                (true, _) => Some(true),
                (_, true) => Some(false),
                _ => None,
            };
            grid.cells.push(Cell { corners, forced });
        }
    }
    grid
}

/// The grid of a convex polygon whose edges all have `n` (even) segments: one quadrilateral of `n/2 × n/2` cells per corner,
/// between the midpoints of its two edges and the centre.
pub(crate) fn polygon(corners: &[DVec2], n: usize) -> Grid {
    let sides = corners.len();
    let half = n / 2;
    let around = sides * n;
    let inner = half - 1;
    let quads = polygon_quads(corners);
    let mut grid = Grid::default();
    // Centre, then spokes from the midpoints of the edges inwards, then the quadrilaterals.
    grid.interior.push(quads.first().map_or(DVec2::ZERO, |q| q[2]));
    let at = |quad: usize, a: usize, b: usize| {
        bilinear(quads[quad], a as f64 / half as f64, b as f64 / half as f64)
    };
    for q in 0..sides {
        grid.interior.extend((1..half).map(|b| at(q, half, b)));
    }
    for q in 0..sides {
        for b in 1..half {
            grid.interior.extend((1..half).map(|a| at(q, a, b)));
        }
    }
    let vertex = |q: usize, a: usize, b: usize| {
        let before = (q + sides - 1) % sides;
        let index = if b == 0 {
            q * n + a
        } else if a == 0 {
            before * n + n - b
        } else if a == half && b == half {
            around
        } else if a == half {
            around + 1 + q * inner + b - 1
        } else if b == half {
            around + 1 + before * inner + a - 1
        } else {
            around + 1 + sides * inner + (q * inner + b - 1) * inner + a - 1
        };
        index as u32
    };
    for q in 0..sides {
        for b in 0..half {
            for a in 0..half {
                grid.cells.push(Cell {
                    corners: [
                        vertex(q, a, b),
                        vertex(q, a + 1, b),
                        vertex(q, a + 1, b + 1),
                        vertex(q, a, b + 1),
                    ],
                    forced: (a == 0 && b == 0).then_some(true),
                });
            }
        }
    }
    grid
}

/// The quadrilaterals (corner, midpoint of the next edge, centre, midpoint of the edge before) of a polygon.
pub(crate) fn polygon_quads(corners: &[DVec2]) -> Vec<[DVec2; 4]> {
    let n = corners.len();
    let centre = corners.iter().sum::<DVec2>() / n.max(1) as f64;
    (0..n)
        .map(|i| {
            let (before, after) = (corners[(i + n - 1) % n], corners[(i + 1) % n]);
            [corners[i], (corners[i] + after) * 0.5, centre, (before + corners[i]) * 0.5]
        })
        .collect()
}

impl Grid {
    /// Splits every cell along its shorter diagonal, where that is free; `distance` measures between two vertices.
    pub(crate) fn split(self, distance: impl Fn(u32, u32) -> f64) -> PatchMesh {
        let mut triangles = Vec::with_capacity(2 * self.cells.len());
        for Cell { corners: [a, b, c, d], forced } in self.cells {
            if forced.unwrap_or_else(|| distance(a, c) <= distance(b, d)) {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
        PatchMesh { interior: self.interior, triangles }
    }
}
