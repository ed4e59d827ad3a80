//! Which cells of a grid carry unknowns.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::Grid;

/// A set of cells of a [`Grid`]. Outside them the net is only filled in, and the surface means nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cells {
    grid: Grid,
    active: Vec<bool>,
}

impl Cells {
    /// All cells of the rectangle.
    pub fn all(grid: Grid) -> Self {
        Self { grid, active: vec![true; grid.cells[0] * grid.cells[1]] }
    }

    /// The cells within `reach` plus one cell of the region covered by `triangles`.
    ///
    /// Distances are measured between cells, so that a few more may be taken, never fewer.
    pub fn around(grid: Grid, params: &[DVec2], triangles: &[[u32; 3]], reach: f64) -> Self {
        let [p, q] = grid.cells;
        let mut covered = vec![false; p * q];
        for t in triangles {
            let corner = t.map(|v| (params[v as usize] - grid.lower) / grid.step);
            cover(grid.cells, corner, &mut covered);
        }
        let far = reach.max(0.0) + grid.step.max_element();
        let radius = [0, 1].map(|d| ((far / grid.step[d]) as usize).saturating_add(1).min(grid.cells[d]));
        // Only cells with an uncovered neighbour can add anything: the others are surrounded by covered ones.
        let mut active = covered.clone();
        for i in 0..p {
            for j in 0..q {
                let inner = i > 0
                    && j > 0
                    && i + 1 < p
                    && j + 1 < q
                    && (i - 1..=i + 1).all(|a| (j - 1..=j + 1).all(|b| covered[a * q + b]));
                if !covered[i * q + j] || inner {
                    continue;
                }
                for a in i.saturating_sub(radius[0])..=(i + radius[0]).min(p - 1) {
                    let du = a.abs_diff(i).saturating_sub(1) as f64 * grid.step.x;
                    for b in j.saturating_sub(radius[1])..=(j + radius[1]).min(q - 1) {
                        let dv = b.abs_diff(j).saturating_sub(1) as f64 * grid.step.y;
                        if du.hypot(dv) <= far {
                            active[a * q + b] = true;
                        }
                    }
                }
            }
        }
        Self { grid, active }
    }

    /// The grid.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Whether cell `(i, j)` is active; `false` outside the grid.
    pub fn contains(&self, [i, j]: [usize; 2]) -> bool {
        i < self.grid.cells[0] && j < self.grid.cells[1] && self.active[i * self.grid.cells[1] + j]
    }

    /// Whether `at` lies in the rectangle and in an active cell: only there may the surface be evaluated.
    pub fn covers(&self, at: DVec2) -> bool {
        // A rounding error beyond the rectangle is still on its border.
        let slack = self.grid.step * 1e-9;
        at.cmpge(self.grid.lower - slack).all()
            && at.cmple(self.grid.upper() + slack).all()
            && self.contains(self.grid.locate(at).0)
    }

    /// The active cells in order, second index fastest.
    pub fn iter(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let q = self.grid.cells[1];
        self.active.iter().enumerate().filter(|&(_, &a)| a).map(move |(k, _)| [k / q, k % q])
    }
}

/// Marks the unit cells that a triangle meets (separating axes: those of the box and the triangle's edges).
fn cover(cells: [usize; 2], corner: [DVec2; 3], covered: &mut [bool]) {
    let low = corner[0].min(corner[1]).min(corner[2]);
    let high = corner[0].max(corner[1]).max(corner[2]);
    let range = |d: usize| {
        let last = cells[d] - 1;
        ((low[d].max(0.0) as usize).min(last), (high[d].max(0.0) as usize).min(last))
    };
    let (u, v) = (range(0), range(1));
    let ccw = (corner[1] - corner[0]).perp_dot(corner[2] - corner[0]) >= 0.0;
    let corner = if ccw { corner } else { [corner[0], corner[2], corner[1]] };
    for i in u.0..=u.1 {
        for j in v.0..=v.1 {
            let centre = DVec2::new(i as f64 + 0.5, j as f64 + 0.5);
            let apart = (0..3).any(|k| {
                let edge = corner[(k + 1) % 3] - corner[k];
                let reach = 0.5 * (edge.x.abs() + edge.y.abs());
                edge.perp_dot(centre - corner[k]) < -reach
            });
            if !apart {
                covered[i * cells[1] + j] = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::new(DVec2::ZERO, DVec2::splat(20.0), [20, 20]).unwrap()
    }

    #[test]
    fn a_triangle_covers_the_cells_it_meets_and_their_ring() {
        let params = [DVec2::new(10.2, 10.2), DVec2::new(10.8, 10.2), DVec2::new(10.2, 10.8)];
        let cells = Cells::around(grid(), &params, &[[0, 1, 2]], 0.0);
        // One covered cell; gap ≤ one cell: two rings without the four corners at distance √2.
        assert_eq!(cells.iter().count(), 21);
        assert!(cells.covers(DVec2::new(8.5, 10.5)) && !cells.covers(DVec2::new(8.5, 8.5)));
        assert!(!cells.covers(DVec2::new(-1.0, 10.5)));
    }

    #[test]
    fn every_point_within_reach_is_covered() {
        let params = [DVec2::new(4.1, 4.3), DVec2::new(9.7, 5.2), DVec2::new(6.5, 9.9)];
        for reach in [0.0, 0.7, 2.5, 100.0] {
            let cells = Cells::around(grid(), &params, &[[0, 1, 2]], reach);
            for k in 0..60 {
                let (s, c) = (0.1 * k as f64).sin_cos();
                for p in params {
                    let at = (p + DVec2::new(c, s) * reach).clamp(DVec2::ZERO, DVec2::splat(20.0));
                    assert!(cells.covers(at), "{reach} {at}");
                }
            }
        }
    }
}
