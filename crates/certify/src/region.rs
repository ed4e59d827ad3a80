//! A domain flattened to line segments: containment, nearest boundary point, interior samples.

use glam::DVec2;
use suture_surface::{Domain, EdgeCurve};

/// Segments per curved boundary edge.
const FLAT: usize = 16;

/// One segment of a flattened boundary edge.
#[derive(Clone, Copy, Debug)]
struct Piece {
    a: DVec2,
    b: DVec2,
    edge: usize,
    t: [f64; 2],
}

/// A point of the boundary of a domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundaryPoint {
    pub(crate) edge: usize,
    pub(crate) t: f64,
    pub(crate) at: DVec2,
}

/// A domain as its boundary segments.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pieces: Vec<Piece>,
    /// Corners of a rectangle or polygon; empty for a trimmed domain.
    corners: Vec<DVec2>,
    domain: Domain,
}

impl Region {
    pub(crate) fn new(domain: Domain) -> Self {
        let mut pieces = Vec::new();
        let mut corners = Vec::new();
        for edge in 0..domain.edge_count() {
            let Some(curve) = domain.edge(edge) else { continue };
            let count = match &curve {
                EdgeCurve::Line([a, _]) => {
                    corners.push(*a);
                    1
                }
                EdgeCurve::Bezier(curve) => {
                    if curve.degree() > 1 {
                        FLAT
                    } else {
                        1
                    }
                }
            };
            let at = |i: usize| i as f64 / count as f64;
            pieces.extend((0..count).map(|i| Piece {
                a: curve.point(at(i)),
                b: curve.point(at(i + 1)),
                edge,
                t: [at(i), at(i + 1)],
            }));
        }
        Self { pieces, corners, domain }
    }

    pub(crate) fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Whether the domain is a rectangle or a convex polygon, where [`contains`](Self::contains) is exact.
    pub(crate) fn is_convex(&self) -> bool {
        !self.corners.is_empty()
    }

    /// Whether `x` lies inside; for trimmed domains by the winding number of the flattened boundary.
    pub(crate) fn contains(&self, x: DVec2) -> bool {
        let left = |p: &Piece| (p.b - p.a).perp_dot(x - p.a);
        if self.is_convex() {
            return self.pieces.iter().all(|p| left(p) >= 0.0);
        }
        let mut winding = 0;
        for p in &self.pieces {
            if p.a.y <= x.y && p.b.y > x.y && left(p) > 0.0 {
                winding += 1;
            } else if p.a.y > x.y && p.b.y <= x.y && left(p) < 0.0 {
                winding -= 1;
            }
        }
        winding > 0
    }

    /// The boundary point nearest to `x`; `None` for a domain without edges or an `x` that is not finite.
    pub(crate) fn nearest(&self, x: DVec2) -> Option<BoundaryPoint> {
        let (mut best, mut least) = (None, f64::INFINITY);
        for p in &self.pieces {
            let d = p.b - p.a;
            let s = ((x - p.a).dot(d) / d.length_squared()).clamp(0.0, 1.0);
            let s = if s.is_nan() { 0.0 } else { s };
            let distance = (p.a + d * s).distance_squared(x);
            if distance < least {
                least = distance;
                best = Some((p.edge, p.t[0] + (p.t[1] - p.t[0]) * s));
            }
        }
        let (edge, t) = best?;
        Some(BoundaryPoint { edge, t, at: self.domain.edge(edge)?.point(t) })
    }

    /// About `n²` points of the closed domain, boundary included, the same for every call.
    pub(crate) fn samples(&self, n: usize) -> Vec<DVec2> {
        match &self.domain {
            Domain::Rectangle { min, max } => grid(*min, *max, n).collect(),
            Domain::Polygon(corners) => fan(corners, n),
            Domain::Trimmed(_) => self.trimmed_samples(n),
        }
    }

    /// A grid over the bounding box, without the points so near to the boundary that its flattening could misjudge them, and the
    /// quarter points of every edge.
    fn trimmed_samples(&self, n: usize) -> Vec<DVec2> {
        let mut out: Vec<DVec2> = (0..self.domain.edge_count())
            .filter_map(|e| self.domain.edge(e))
            .flat_map(|curve| [0.0, 0.25, 0.5, 0.75].map(|t| curve.point(t)))
            .collect();
        let Some(&first) = out.first() else { return out };
        let (lo, hi) = self.pieces.iter().fold((first, first), |(lo, hi), p| (lo.min(p.a), hi.max(p.a)));
        // Trimmed domains are rarely rectangles: twice as fine, so that those half empty still hold n² points.
        let margin = 0.125 * (hi - lo).min_element() / n as f64;
        let clear =
            |x: &DVec2| self.contains(*x) && self.nearest(*x).is_some_and(|b| b.at.distance(*x) > margin);
        out.extend(grid(lo, hi, 2 * n).filter(clear));
        out
    }
}

fn grid(lo: DVec2, hi: DVec2, n: usize) -> impl Iterator<Item = DVec2> {
    let mix = move |i: usize| i as f64 / n as f64;
    let line = move |a: f64, b: f64, s: f64| a * (1.0 - s) + b * s;
    (0..=n).flat_map(move |i| {
        (0..=n).map(move |j| DVec2::new(line(lo.x, hi.x, mix(i)), line(lo.y, hi.y, mix(j))))
    })
}

/// Barycentric grids over the triangles between the centroid and the edges.
fn fan(corners: &[DVec2], n: usize) -> Vec<DVec2> {
    let m = corners.len();
    let centre = corners.iter().sum::<DVec2>() / m.max(1) as f64;
    let mut out: Vec<DVec2> = corners.iter().copied().take(1).map(|_| centre).collect();
    let half = n.div_ceil(2);
    for e in 0..m {
        let (a, b) = (corners[e], corners[(e + 1) % m]);
        for i in 1..=half {
            let ring = i as f64 / half as f64;
            out.extend((0..i).map(|j| {
                let s = j as f64 / i as f64;
                centre * (1.0 - ring) + (a * (1.0 - s) + b * s) * ring
            }));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use suture_bernstein::BezierCurve;

    use super::*;

    /// A disc-like loop of four cubic arcs of radius 1, and a square hole of half width 0.25.
    fn ring() -> Region {
        let k = 0.552_284_749_830_793_6;
        let arc = |a: DVec2| {
            let b = a.perp();
            BezierCurve::new(vec![a, a + b * k, b + a * k, b]).unwrap()
        };
        let outer = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(arc).to_vec();
        let h = [(0.25, 0.25), (0.25, -0.25), (-0.25, -0.25), (-0.25, 0.25)].map(DVec2::from);
        let hole = (0..4).map(|i| BezierCurve::new(vec![h[i], h[(i + 1) % 4]]).unwrap()).collect();
        Region::new(Domain::Trimmed(vec![outer, hole]))
    }

    #[test]
    fn a_hole_is_outside() {
        let ring = ring();
        assert!(!ring.is_convex());
        assert!(ring.contains(DVec2::new(0.5, 0.5)) && ring.contains(DVec2::new(0.3, 0.0)));
        assert!(!ring.contains(DVec2::new(0.2, 0.0)) && !ring.contains(DVec2::new(0.8, 0.8)));
        let b = ring.nearest(DVec2::new(0.1, 0.2)).unwrap();
        assert!(b.edge == 7 && b.at.distance(DVec2::new(0.1, 0.25)) < 1e-15);
    }

    #[test]
    fn samples_lie_in_the_closed_domain() {
        let ring = ring();
        let samples = ring.samples(8);
        assert!(samples.len() > 100, "{}", samples.len());
        for x in samples {
            assert!(x.length() < 1.001 && x.abs().max_element() > 0.25 - 1e-12, "{x}");
        }
        let corners = vec![DVec2::ZERO, DVec2::X, DVec2::new(1.0, 2.0)];
        let triangle = Region::new(Domain::Polygon(corners.clone()));
        let samples = triangle.samples(8);
        for c in corners {
            assert!(samples.iter().any(|x| x.distance(c) < 1e-15));
        }
        for x in samples {
            assert!(x.y >= -1e-15 && x.x <= 1.0 + 1e-15 && x.y <= 2.0 * x.x + 1e-15);
        }
        assert!(Region::new(Domain::Polygon(vec![])).samples(4).is_empty());
    }
}
