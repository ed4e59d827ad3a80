//! Parameter domains and their boundary edges.

use glam::DVec2;
use suture_bernstein::BezierCurve;

/// The parameter domain of a patch: a region of the plane bounded by closed loops of edges.
#[derive(Clone, Debug, PartialEq)]
pub enum Domain {
    /// An axis-parallel rectangle; edges: bottom (`v` = min), right, top, left, counter-clockwise from the lower left corner.
    Rectangle {
        /// Lower left corner.
        min: DVec2,
        /// Upper right corner.
        max: DVec2,
    },
    /// A convex polygon, corners counter-clockwise; edge `i` runs from corner `i` to the next one.
    Polygon(Vec<DVec2>),
    /// A region bounded by Bézier curves: one outer loop counter-clockwise, then holes clockwise. The edges are numbered through,
    /// loop by loop; each edge starts, to the bit, where the one before it in its loop ends.
    Trimmed(Vec<Vec<BezierCurve<DVec2>>>),
}

/// A boundary edge of a domain: a curve in the parameter plane on `[0, 1]`, the domain on its left.
#[derive(Clone, Debug, PartialEq)]
pub enum EdgeCurve<'a> {
    /// The straight line between two points.
    Line([DVec2; 2]),
    /// A Bézier curve of a trimmed domain.
    Bezier(&'a BezierCurve<DVec2>),
}

impl EdgeCurve<'_> {
    /// Position and first two derivatives at `t`; exact at both ends.
    pub fn jet(&self, t: f64) -> [DVec2; 3] {
        match self {
            Self::Line([a, b]) => [*a * (1.0 - t) + *b * t, *b - *a, DVec2::ZERO],
            Self::Bezier(curve) => curve.jet(t),
        }
    }

    /// Position at `t`.
    pub fn point(&self, t: f64) -> DVec2 {
        self.jet(t)[0]
    }
}

impl Domain {
    /// Number of boundary edges over all loops.
    pub fn edge_count(&self) -> usize {
        match self {
            Self::Rectangle { .. } => 4,
            Self::Polygon(corners) => corners.len(),
            Self::Trimmed(loops) => loops.iter().map(Vec::len).sum(),
        }
    }

    /// Boundary edge `i`; `None` beyond [`edge_count`](Self::edge_count).
    pub fn edge(&self, i: usize) -> Option<EdgeCurve<'_>> {
        match self {
            Self::Rectangle { min, max } => {
                let corners = rectangle_corners(*min, *max);
                (i < 4).then(|| EdgeCurve::Line([corners[i], corners[(i + 1) % 4]]))
            }
            Self::Polygon(corners) => {
                (i < corners.len()).then(|| EdgeCurve::Line([corners[i], corners[(i + 1) % corners.len()]]))
            }
            Self::Trimmed(loops) => loops.iter().flatten().nth(i).map(EdgeCurve::Bezier),
        }
    }

    /// The edge numbers of every loop, the outer one first.
    pub fn loops(&self) -> Vec<std::ops::Range<usize>> {
        match self {
            Self::Trimmed(loops) => {
                let mut first = 0;
                loops
                    .iter()
                    .map(|edges| {
                        let range = first..first + edges.len();
                        first = range.end;
                        range
                    })
                    .collect()
            }
            _ => std::iter::once(0..self.edge_count()).collect(),
        }
    }

    /// The edge that follows edge `i` in its loop.
    pub fn next_edge(&self, i: usize) -> usize {
        self.loops()
            .into_iter()
            .find(|l| l.contains(&i))
            .map_or(i, |l| if i + 1 < l.end { i + 1 } else { l.start })
    }
}

fn rectangle_corners(min: DVec2, max: DVec2) -> [DVec2; 4] {
    [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
}
