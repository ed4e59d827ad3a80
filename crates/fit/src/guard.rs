//! The guards: does the surface stay where the chart is, and does it face the right way?

use glam::{DVec2, DVec3};

use crate::chart::Chart;
use crate::{Cells, GuardReport};

/// Samples per cell and direction.
const SAMPLES: usize = 4;
/// The chart's bounding box is inflated by this part of its diagonal.
const INFLATION: f64 = 0.25;

/// Samples the surface on 4 × 4 points of every active cell: inside the inflated bounding box of the chart everywhere, normal
/// not opposed to the mesh's inside the chart.
pub(crate) fn inspect(chart: &Chart<'_>, cells: &Cells, params: &[DVec2], net: &[DVec3]) -> GuardReport {
    let grid = cells.grid();
    let first = chart.points[0];
    let (low, high) = chart.points.iter().fold((first, first), |(l, h), &x| (l.min(x), h.max(x)));
    let margin = INFLATION * low.distance(high) + chart.reach * chart.stretch;
    let (low, high) = (low - margin, high + margin);
    let mut report = GuardReport::default();
    let mut worst = (0.0, None);
    let sample = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
    for cell in cells.iter() {
        for k in 0..SAMPLES * SAMPLES {
            let t = DVec2::new(cell[0] as f64 + sample(k / SAMPLES), cell[1] as f64 + sample(k % SAMPLES));
            let p = grid.jet(net, grid.lower + t * grid.step).p;
            let overshoot = if p.is_finite() { p.distance(p.clamp(low, high)) } else { f64::MAX };
            if overshoot > 0.0 {
                report.outside += 1;
                if overshoot > worst.0 {
                    worst = (overshoot, Some(cell));
                }
            }
        }
    }
    let mut flipped_cell = None;
    for t in chart.triangles {
        for (at, normal) in lattice(chart, cells, params, t) {
            let jet = grid.jet(net, at);
            if jet.du.cross(jet.dv).dot(normal) * chart.orientation <= 0.0 {
                report.flipped += 1;
                report.flipped_inside += usize::from(t.iter().all(|&v| chart.in_segment[v as usize]));
                flipped_cell = flipped_cell.or(Some(grid.locate(at).0));
            }
        }
    }
    report.overshoot = (worst.0 * chart.relative).min(f64::MAX);
    report.cell = worst.1.or(flipped_cell);
    report
}

/// The sample points inside one triangle with the interpolated vertex normal.
fn lattice(chart: &Chart<'_>, cells: &Cells, params: &[DVec2], t: &[u32; 3]) -> Vec<(DVec2, DVec3)> {
    let grid = cells.grid();
    let fine = grid.step / SAMPLES as f64;
    let corner = t.map(|v| (params[v as usize] - grid.lower) / fine - 0.5);
    let normal = t.map(|v| chart.normals[v as usize].normalize_or_zero());
    let area = (corner[1] - corner[0]).perp_dot(corner[2] - corner[0]);
    let low = corner[0].min(corner[1]).min(corner[2]).ceil().max(DVec2::ZERO);
    let high = corner[0].max(corner[1]).max(corner[2]).floor();
    let last = |d: usize| (grid.cells[d] * SAMPLES - 1) as f64;
    let high = high.min(DVec2::new(last(0), last(1)));
    let mut out = Vec::new();
    if area == 0.0 || low.cmpgt(high).any() {
        return out;
    }
    for i in low.x as usize..=high.x as usize {
        for j in low.y as usize..=high.y as usize {
            let p = DVec2::new(i as f64, j as f64);
            let weight = |k: usize| (corner[(k + 1) % 3] - p).perp_dot(corner[(k + 2) % 3] - p) / area;
            let w = [weight(0), weight(1), weight(2)];
            if w.iter().all(|&w| w >= 0.0) {
                let n = normal[0] * w[0] + normal[1] * w[1] + normal[2] * w[2];
                if n != DVec3::ZERO {
                    out.push((grid.lower + (p + 0.5) * fine, n));
                }
            }
        }
    }
    out
}
