//! Interior points of a freely triangulated patch: the corners of a quadtree that follows curvature and the boundary.
//!
//! Works in a plane where the boundary fits into the unit square and lengths are, on average, lengths in space divided by `unit`.

use std::collections::HashMap;

use glam::DVec2;

use crate::{
    TessellateError,
    demand::{Sample, angle},
    options::Limits,
};

/// A region bounded by a polyline, with rows for quick point location.
pub(crate) struct Region {
    segments: Vec<[DVec2; 2]>,
    lo: DVec2,
    side: f64,
    rows: Vec<Vec<u32>>,
}

impl Region {
    /// The region on the left of `segments`, which form closed loops.
    pub(crate) fn new(segments: Vec<[DVec2; 2]>) -> Self {
        let all = || segments.iter().flatten();
        let lo = all().fold(DVec2::INFINITY, |a, &b| a.min(b));
        let hi = all().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b));
        let side = (hi - lo).max_element();
        let count = segments.len().clamp(1, 256);
        let mut rows = vec![Vec::new(); count];
        let row = |y: f64| row(y, lo.y, side, count);
        for (i, [a, b]) in segments.iter().enumerate() {
            for r in row(a.y.min(b.y))..=row(a.y.max(b.y)) {
                rows[r].push(i as u32);
            }
        }
        Self { segments, lo, side, rows }
    }

    /// Whether `p` is inside, by the parity of the segments to its right.
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        let row = &self.rows[row(p.y, self.lo.y, self.side, self.rows.len())];
        let crossings = row.iter().filter(|&&s| {
            let [a, b] = self.segments[s as usize];
            (a.y <= p.y) != (b.y <= p.y) && {
                let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
                (high - low).perp_dot(p - low) > 0.0
            }
        });
        crossings.count() % 2 == 1
    }

    /// Corner and side of the square around the region.
    pub(crate) fn square(&self) -> (DVec2, f64) {
        (self.lo, self.side)
    }
}

fn row(y: f64, lo: f64, side: f64, count: usize) -> usize {
    // The cast saturates, also for NaN.
    (((y - lo) / side * count as f64) as usize).min(count - 1)
}

/// One square of the quadtree with the boundary segments near it.
struct Cell {
    level: u32,
    x: u32,
    y: u32,
    near: Vec<u32>,
}

/// The points, in the order of the quadtree. `unit` is the length in space of a length 1 of the plane.
pub(crate) fn sites(
    region: &Region,
    unit: f64,
    limits: &Limits,
    sample: impl Fn(DVec2) -> Result<Sample, TessellateError>,
) -> Result<Vec<DVec2>, TessellateError> {
    let deepest = limits.segments.next_power_of_two().trailing_zeros();
    let finest = 1u32 << (deepest + 1);
    let (lo, side) = region.square();
    let point = |x: u32, y: u32| lo + DVec2::new(x as f64, y as f64) * (side / finest as f64);
    let mut samples: HashMap<(u32, u32), Option<Sample>> = HashMap::new();
    let mut corners: HashMap<(u32, u32), usize> = HashMap::new();
    let mut sites = Vec::new();
    let mut stack = vec![Cell { level: 0, x: 0, y: 0, near: (0..region.segments.len() as u32).collect() }];
    while let Some(mut cell) = stack.pop() {
        let step = finest >> cell.level;
        let width = side / f64::from(1u32 << cell.level);
        let (x, y) = (cell.x * step, cell.y * step);
        let centre = point(x + step / 2, y + step / 2);
        cell.near.retain(|&s| {
            let [a, b] = region.segments[s as usize];
            let reach = DVec2::splat(width);
            a.min(b).cmple(centre + reach).all() && a.max(b).cmpge(centre - reach).all()
        });
        if cell.near.is_empty() && !region.contains(centre) {
            continue;
        }
        let length = |s: &u32| {
            let [a, b] = region.segments[*s as usize];
            a.distance(b)
        };
        let shortest = cell.near.iter().map(length).fold(f64::INFINITY, f64::min);
        let mut split = cell.level < deepest && (width * unit > limits.edge || width > 2.0 * shortest);
        if cell.level < deepest && !split {
            let mut nine = [None; 9];
            for k in 0..9u32 {
                let key = (x + k % 3 * (step / 2), y + k / 3 * (step / 2));
                nine[k as usize] = match samples.get(&key) {
                    Some(known) => *known,
                    None => {
                        let p = point(key.0, key.1);
                        let new = if region.contains(p) { Some(sample(p)?) } else { None };
                        samples.insert(key, new);
                        new
                    }
                };
            }
            split = bends(&nine, limits);
        }
        if split {
            // Pushed in reverse, so that the quadrants are visited in their order.
            for k in (0..4).rev() {
                let (x, y) = (2 * cell.x + k % 2, 2 * cell.y + k / 2);
                stack.push(Cell { level: cell.level + 1, x, y, near: cell.near.clone() });
            }
            continue;
        }
        for key in [(x, y), (x + step, y), (x + step, y + step), (x, y + step)] {
            let p = point(key.0, key.1);
            if corners.contains_key(&key) || !region.contains(p) {
                continue;
            }
            let clear = |&s: &u32| distance(p, region.segments[s as usize]) >= 0.5 * width;
            if cell.near.iter().all(clear) {
                corners.insert(key, sites.len());
                sites.push(p);
            }
        }
    }
    Ok(sites)
}

/// Whether a cell with the given 3 × 3 samples (`None` outside the region) exceeds the limits.
fn bends(nine: &[Option<Sample>; 9], limits: &Limits) -> bool {
    // Rows, columns, diagonals: three samples across the whole cell.
    const LINES: [[usize; 3]; 8] =
        [[0, 1, 2], [3, 4, 5], [6, 7, 8], [0, 3, 6], [1, 4, 7], [2, 5, 8], [0, 4, 8], [2, 4, 6]];
    LINES.iter().any(|line| {
        let s = line.map(|i| nine[i]);
        let turn = |a: Option<Sample>, b: Option<Sample>| match (a.and_then(|s| s.n), b.and_then(|s| s.n)) {
            (Some(a), Some(b)) => angle(a, b),
            _ => 0.0,
        };
        let bend = match s {
            [Some(a), Some(Sample { p, n: Some(n) }), Some(c)] => n.dot(0.5 * (a.p + c.p) - p).abs(),
            _ => 0.0,
        };
        2.0 * turn(s[0], s[1]).max(turn(s[1], s[2])) > limits.angle || bend > limits.chord
    })
}

fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let d = b - a;
    let t = if d == DVec2::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + d * t)
}
