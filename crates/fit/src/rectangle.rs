//! The minimum-area rectangle of a set of parameters and the rigid motion that makes it axis-parallel.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A rigid motion of the parameter plane: the surface's parameters are `apply` of the chart's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// The point of the chart's plane that becomes the origin.
    pub centre: DVec2,
    /// The unit vector of the chart's plane that becomes the direction of `u`.
    pub axis: DVec2,
}

impl Frame {
    /// From the chart's parameters to the surface's.
    pub fn apply(&self, p: DVec2) -> DVec2 {
        let d = p - self.centre;
        DVec2::new(self.axis.dot(d), self.axis.perp_dot(d))
    }

    /// From the surface's parameters to the chart's.
    pub fn invert(&self, q: DVec2) -> DVec2 {
        self.centre + self.axis * q.x + self.axis.perp() * q.y
    }
}

/// Relative difference of areas and sides that counts as a tie.
const TIE: f64 = 1e-9;

/// The frame centred in the minimum-area rectangle of `points`, `u` along its longer side, and the rectangle's sides.
///
/// Among equal rectangles the one that rotates least wins, and the axis points into the right half plane: the result
/// depends on the points as a set, not on their order.
///
/// # References
/// Freeman, Shapira: Determining the minimum-area encasing rectangle for an arbitrary closed curve, CACM 18 (1975): one side
/// lies on an edge of the convex hull.
pub(crate) fn minimum_area_rectangle(points: &[DVec2]) -> (Frame, DVec2) {
    let hull = convex_hull(points);
    let mut best: Option<(f64, f64, Frame, DVec2)> = None;
    for k in 0..hull.len() {
        let edge = hull[(k + 1) % hull.len()] - hull[k];
        let Some(edge) = edge.try_normalize() else { continue };
        for axis in [edge, edge.perp()] {
            let right = axis.x > 0.0 || (axis.x == 0.0 && axis.y > 0.0);
            let axis = if right { axis } else { -axis };
            let (frame, size) = bound(&hull, axis);
            if size.x < size.y * (1.0 - TIE) {
                continue;
            }
            let (area, turn) = (size.x * size.y, axis.y.abs());
            let better = best.as_ref().is_none_or(|&(a, t, f, _)| {
                area < a * (1.0 - TIE)
                    || (area <= a * (1.0 + TIE)
                        && (turn < t - TIE || (turn < t + TIE && axis.y > f.axis.y + TIE)))
            });
            if better {
                best = Some((area, turn, frame, size));
            }
        }
    }
    let (_, _, frame, size) = best.unwrap_or_else(|| {
        let centre = points.first().copied().unwrap_or(DVec2::ZERO);
        (0.0, 0.0, Frame { centre, axis: DVec2::X }, DVec2::ZERO)
    });
    (frame, size)
}

fn bound(hull: &[DVec2], axis: DVec2) -> (Frame, DVec2) {
    let frame = Frame { centre: hull[0], axis };
    let (mut low, mut high) = (DVec2::ZERO, DVec2::ZERO);
    for &p in hull {
        let q = frame.apply(p);
        low = low.min(q);
        high = high.max(q);
    }
    (Frame { centre: frame.invert((low + high) / 2.0), axis }, high - low)
}

/// Corners of the convex hull, counter-clockwise from the leftmost (Andrew 1979, monotone chain).
fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull: Vec<DVec2> = Vec::with_capacity(2 * sorted.len());
    for pass in 0..2 {
        let start = hull.len();
        for i in 0..sorted.len() {
            let p = sorted[if pass == 0 { i } else { sorted.len() - 1 - i }];
            while hull.len() >= start + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(p - a) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotated(angle: f64) -> Vec<DVec2> {
        let (s, c) = angle.sin_cos();
        let mut points = Vec::new();
        for i in 0..=20 {
            for j in 0..=10 {
                let p = DVec2::new(0.2 * i as f64, 0.1 * j as f64);
                points.push(DVec2::new(c * p.x - s * p.y + 7.0, s * p.x + c * p.y - 3.0));
            }
        }
        points
    }

    #[test]
    fn a_rotated_rectangle_is_found_with_its_longer_side_along_u() {
        for angle in [0.0, 0.3, 1.2, 2.0, -0.7] {
            let points = rotated(angle);
            let (frame, size) = minimum_area_rectangle(&points);
            assert!(size.distance(DVec2::new(4.0, 1.0)) < 1e-12, "{size}");
            for p in points {
                let q = frame.apply(p);
                assert!(q.x.abs() < 2.0 + 1e-12 && q.y.abs() < 0.5 + 1e-12);
                assert!(frame.invert(q).distance(p) < 1e-14 * 10.0);
            }
        }
    }

    #[test]
    fn a_square_is_not_turned_and_order_does_not_matter() {
        let mut points: Vec<DVec2> = (0..100).map(|k| DVec2::new((k % 10) as f64, (k / 10) as f64)).collect();
        let a = minimum_area_rectangle(&points);
        assert_eq!(a.0.axis, DVec2::X);
        points.reverse();
        assert_eq!(a, minimum_area_rectangle(&points));
    }

    #[test]
    fn points_on_a_line_have_no_width() {
        let points: Vec<DVec2> = (0..5).map(|k| DVec2::new(k as f64, 2.0 * k as f64)).collect();
        assert!(minimum_area_rectangle(&points).1.y < 1e-14);
        assert_eq!(minimum_area_rectangle(&[]).1, DVec2::ZERO);
    }
}
