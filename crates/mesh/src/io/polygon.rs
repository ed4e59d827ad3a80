//! Cutting a polygon into triangles.
//!
//! The polygon is projected along the coordinate axis closest to its normal, which keeps its coordinates exact, and its ears are
//! clipped, best shaped first, by exact orientation tests.
//!
//! # References
//! G. Meisters, *Polygons have ears*, 1975; normal after M. Newell (I. Sutherland et al. 1974); J. Shewchuk, *Adaptive precision
//! floating-point arithmetic and fast robust geometric predicates*, 1997.

use std::{cmp::Reverse, collections::BinaryHeap};

use glam::DVec3;
use robust::{Coord, orient2d};

use crate::measure::power_of_two_below;

/// Triangles over the corners of a polygon, in its orientation.
#[derive(Debug)]
pub(super) struct Cut {
    pub(super) triangles: Vec<[usize; 3]>,
    /// Whether every triangle has positive area in the plane of the polygon. If not, the polygon crosses itself or spans no area,
    /// and the triangles are merely a disc with its border.
    pub(super) simple: bool,
}

/// Largest `corners × reflex corners`: the cost of clipping is proportional to it, and files come from strangers.
const LIMIT: usize = 1 << 24;

/// Cuts a polygon with at least three corners into `corners − 2` triangles.
///
/// # Errors
/// The number of reflex corners, where clipping would take too long.
pub(super) fn triangulate(corners: &[DVec3]) -> Result<Cut, usize> {
    let Some(outline) = project(corners) else {
        return Ok(Cut { triangles: fan(&(0..corners.len()).collect::<Vec<_>>()), simple: false });
    };
    let ring = Ring::new(corners, outline);
    let reflex = ring.blockers.len();
    if reflex.saturating_mul(corners.len()) > LIMIT {
        return Err(reflex);
    }
    Ok(ring.clip())
}

/// The corners in the coordinate plane closest to theirs, counter-clockwise, scaled by a power of two so that products neither
/// overflow nor vanish. `None` where they span no area.
fn project(corners: &[DVec3]) -> Option<Vec<Coord<f64>>> {
    let origin = *corners.first()?;
    let extent = corners.iter().fold(0.0_f64, |e, &p| e.max((p - origin).abs().max_element()));
    let largest = corners.iter().fold(0.0_f64, |e, &p| e.max(p.abs().max_element()));
    if !(extent > 0.0 && extent.is_finite() && largest.is_finite()) {
        return None;
    }
    let local = |k: usize| (corners[k % corners.len()] - origin) / extent;
    let normal = (0..corners.len()).fold(DVec3::ZERO, |n, k| n + local(k).cross(local(k + 1)));
    let axis = normal.abs().max_position();
    if normal[axis] == 0.0 {
        return None;
    }
    let scale = power_of_two_below(largest);
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    let (x, y) = if normal[axis] > 0.0 { (x, y) } else { (y, x) };
    Some(corners.iter().map(|p| Coord { x: p[x] / scale, y: p[y] / scale }).collect())
}

fn fan(ring: &[usize]) -> Vec<[usize; 3]> {
    ring.windows(2).skip(1).map(|w| [ring[0], w[0], w[1]]).collect()
}

/// The polygon that is left.
struct Ring<'a> {
    corners: &'a [DVec3],
    outline: Vec<Coord<f64>>,
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Corners that are or were not strictly convex: only these can lie in an ear.
    blockers: Vec<usize>,
    clipped: Vec<bool>,
}

impl<'a> Ring<'a> {
    fn new(corners: &'a [DVec3], outline: Vec<Coord<f64>>) -> Self {
        let n = corners.len();
        let mut ring = Self {
            corners,
            outline,
            previous: (0..n).map(|k| (k + n - 1) % n).collect(),
            next: (0..n).map(|k| (k + 1) % n).collect(),
            blockers: Vec::new(),
            clipped: vec![false; n],
        };
        ring.blockers = (0..n).filter(|&k| ring.turn(k) <= 0.0).collect();
        ring
    }

    fn clip(mut self) -> Cut {
        let n = self.corners.len();
        // Ears go stale when a neighbour is clipped; the version tells.
        let mut version = vec![0u32; n];
        let mut ears: BinaryHeap<_> = (0..n).filter_map(|k| Some((self.ear(k)?, Reverse(k), 0))).collect();
        let mut triangles = Vec::with_capacity(n - 2);
        let mut last = 0;
        let mut left = n;
        while left > 3 {
            let Some((_, Reverse(k), v)) = ears.pop() else { break };
            if self.clipped[k] || version[k] != v {
                continue;
            }
            let (p, q) = (self.previous[k], self.next[k]);
            triangles.push([p, k, q]);
            self.clipped[k] = true;
            (self.next[p], self.previous[q]) = (q, p);
            (last, left) = (p, left - 1);
            let (turn_p, turn_q) = (self.turn(p), self.turn(q));
            self.blockers.retain(|&b| b != k && !(b == p && turn_p > 0.0) && !(b == q && turn_q > 0.0));
            for e in [p, q] {
                version[e] += 1;
                ears.extend(self.ear(e).map(|quality| (quality, Reverse(e), version[e])));
            }
        }
        let rest: Vec<usize> =
            std::iter::successors(Some(last), |&k| Some(self.next[k])).take(left).collect();
        let simple = left == 3 && self.turn(last) > 0.0;
        triangles.extend(fan(&rest));
        Cut { triangles, simple }
    }

    /// Positive where the ring turns left at `k`; exact.
    fn turn(&self, k: usize) -> f64 {
        orient2d(self.outline[self.previous[k]], self.outline[k], self.outline[self.next[k]])
    }

    /// The quality of the triangle that clipping `k` would cut off, in the order of numbers; `None` where it may not be clipped.
    fn ear(&self, k: usize) -> Option<u64> {
        if self.turn(k) <= 0.0 {
            return None;
        }
        let triangle = [self.previous[k], k, self.next[k]];
        let [a, b, c] = triangle.map(|k| self.outline[k]);
        let blocked = self.blockers.iter().any(|&r| {
            let q = self.outline[r];
            let inside = || orient2d(a, b, q) >= 0.0 && orient2d(b, c, q) >= 0.0 && orient2d(c, a, q) >= 0.0;
            // A point visited twice (a slit, a bridge to a hole) touches the ear without blocking it.
            let touches = || [a, b, c].iter().any(|p| p.x == q.x && p.y == q.y);
            !triangle.contains(&r) && inside() && !touches()
        });
        (!blocked).then(|| quality(triangle.map(|k| self.corners[k])).to_bits())
    }
}

/// Area over the sum of the squared edges: 0 for a degenerate triangle, largest for an equilateral one, without units.
fn quality([a, b, c]: [DVec3; 3]) -> f64 {
    let longest = (b - a).abs().max((c - a).abs()).max((c - b).abs()).max_element();
    let (u, v) = ((b - a) / longest, (c - a) / longest);
    let q = u.cross(v).length() / (u.length_squared() + v.length_squared() + (v - u).length_squared());
    if q.is_finite() { q } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    fn area(corners: &[DVec3], t: [usize; 3]) -> DVec3 {
        let [a, b, c] = t.map(|k| corners[k]);
        0.5 * (b - a).cross(c - a)
    }

    /// All triangles positive, areas sum up to the polygon's, in every coordinate plane, both orientations, from every start.
    #[track_caller]
    fn check(points: &[[f64; 2]]) {
        for turn in 0..points.len() {
            for axes in 0..6 {
                let corners: Vec<DVec3> = (0..points.len())
                    .map(|k| points[(k + turn) % points.len()])
                    .map(|[x, y]| match axes {
                        0 => DVec3::new(x, y, 5.0),
                        1 => DVec3::new(5.0, x, y),
                        2 => DVec3::new(y, 5.0, x),
                        3 => DVec3::new(y, x, 5.0),
                        4 => DVec3::new(5.0, y, x) * 2f64.powi(600),
                        _ => DVec3::new(x, 5.0, y) * 2f64.powi(-600),
                    })
                    .collect();
                let n = corners.len();
                let cut = triangulate(&corners).unwrap();
                assert!(cut.simple, "start {turn}, axes {axes}");
                assert_eq!(cut.triangles.len(), n - 2);
                if axes < 4 {
                    let whole = (1..n - 1).fold(DVec3::ZERO, |s, k| s + area(&corners, [0, k, k + 1]));
                    let mut sum = 0.0;
                    for &t in &cut.triangles {
                        assert!(area(&corners, t).dot(whole) > 0.0, "{t:?}");
                        sum += area(&corners, t).length();
                    }
                    assert!((sum - whole.length()).abs() < 1e-12 * sum);
                }
            }
        }
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        check(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.2], [0.0, 1.0]]);
        check(&[[0.0, 0.0], [4.0, 1.0], [0.0, 2.0], [1.0, 1.0]]);
        // A comb.
        check(&[
            [0.0, 0.0],
            [7.0, 0.0],
            [7.0, 3.0],
            [6.0, 1.0],
            [5.0, 3.0],
            [4.0, 1.0],
            [3.0, 3.0],
            [2.0, 1.0],
            [1.0, 3.0],
        ]);
    }

    #[test]
    fn corners_on_straight_sides_get_no_flat_triangles() {
        check(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0]]);
        check(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [1.0, 3.0],
            [0.0, 3.0],
            [0.0, 1.0],
        ]);
    }

    #[test]
    fn a_bridge_to_a_hole_is_crossed_twice() {
        check(&[
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ]);
    }

    #[test]
    fn polygons_without_area_become_a_disc_all_the_same() {
        for points in [[[1.0, 1.0]; 5], [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [1.5, 0.0]]] {
            let cut = triangulate(&flat(&points)).unwrap();
            assert_eq!((cut.triangles.len(), cut.simple), (3, false));
        }
        let nan = triangulate(&[DVec3::NAN; 6]).unwrap();
        assert_eq!((nan.triangles.len(), nan.simple), (4, false));
    }

    #[test]
    fn a_large_convex_polygon_is_quick_and_a_large_comb_is_refused() {
        let n = 100_000;
        let circle: Vec<_> = (0..n)
            .map(|k| (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos())
            .map(|(s, c)| DVec3::new(c, s, 0.0))
            .collect();
        assert!(triangulate(&circle).unwrap().simple);
        let teeth = (0..10_000).rev().map(|k| DVec3::new(f64::from(k), f64::from(1 + k % 2), 0.0));
        let comb: Vec<_> = [DVec3::ZERO, DVec3::X * 1e4].into_iter().chain(teeth).collect();
        assert!(triangulate(&comb).is_err());
    }
}
