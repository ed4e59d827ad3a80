//! Bézier extraction: a B-spline as its polynomial pieces.
//!
//! The control points of a piece are the blossom of the spline at every choice, with repetition, of the two ends of its
//! interval. All steps are convex combinations; where the spline is continuous, neighbours share the bits of their common
//! control points, so that the pieces leave no gap.
//!
//! # References
//! L. Ramshaw, *Blossoms are polar forms*, Computer Aided Geometric Design 6 (1989).

use glam::DVec2;

use crate::{BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, MAX_DEGREE, Vector};

/// The polynomial pieces of a B-spline surface: a grid of patches between break lines.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierGrid<T> {
    breaks: [Vec<f64>; 2],
    patches: Vec<BezierPatch<T>>,
}

impl<T: Vector> BezierGrid<T> {
    /// The strictly rising parameters, in `u` and in `v`, between which the patches lie.
    pub fn breaks(&self) -> [&[f64]; 2] {
        [&self.breaks[0], &self.breaks[1]]
    }

    /// Number of patches in `u` and `v`.
    pub fn cells(&self) -> [usize; 2] {
        [0, 1].map(|d| self.breaks[d].len() - 1)
    }

    /// The patches, second index fastest.
    pub fn patches(&self) -> &[BezierPatch<T>] {
        &self.patches
    }

    /// Patch `[i, j]` with the lower and upper corner of its rectangle, if there is one.
    pub fn get(&self, [i, j]: [usize; 2]) -> Option<([DVec2; 2], &BezierPatch<T>)> {
        let cells = self.cells();
        if i >= cells[0] || j >= cells[1] {
            return None;
        }
        let corner = |i: usize, j: usize| DVec2::new(self.breaks[0][i], self.breaks[1][j]);
        Some(([corner(i, j), corner(i + 1, j + 1)], &self.patches[i * cells[1] + j]))
    }

    /// All rectangles (lower and upper corner) with their patches, second index fastest.
    pub fn iter(&self) -> impl Iterator<Item = ([DVec2; 2], &BezierPatch<T>)> {
        let columns = self.cells()[1];
        (0..self.patches.len()).filter_map(move |c| self.get([c / columns, c % columns]))
    }
}

impl<T: Vector> BSplineCurve<T> {
    /// The polynomial pieces in order, each with its interval.
    pub fn extract(&self) -> Vec<([f64; 2], BezierCurve<T>)> {
        let p = self.degree();
        spans(p, self.knots())
            .into_iter()
            .map(|k| {
                let piece = extract_line(p, self.knots(), k, &self.net()[k - p..=k]);
                ([self.knots()[k], self.knots()[k + 1]], BezierCurve::from_checked(piece))
            })
            .collect()
    }
}

impl<T: Vector> BSplineSurface<T> {
    /// The polynomial pieces with their rectangles.
    pub fn extract(&self) -> BezierGrid<T> {
        let [p, q] = self.degree();
        let [ku, kv] = self.knots();
        let columns = self.count()[1];
        let (us, vs) = (spans(p, ku), spans(q, kv));
        let mut patches = Vec::with_capacity(us.len() * vs.len());
        for &k in &us {
            // The strip of Bézier rows over this span of u, still B-spline in v.
            let mut strip = vec![T::default(); (p + 1) * columns];
            for j in 0..columns {
                let line: Vec<T> = (k - p..=k).map(|i| self.net()[i * columns + j]).collect();
                for (i, c) in extract_line(p, ku, k, &line).into_iter().enumerate() {
                    strip[i * columns + j] = c;
                }
            }
            for &l in &vs {
                let rows = strip.chunks_exact(columns);
                let net = rows.flat_map(|row| extract_line(q, kv, l, &row[l - q..=l])).collect();
                patches.push(BezierPatch::from_checked([p, q], net));
            }
        }
        BezierGrid { breaks: [breaks(ku, &us), breaks(kv, &vs)], patches }
    }
}

/// The spans of the domain that are not empty.
pub(crate) fn spans(degree: usize, knots: &[f64]) -> Vec<usize> {
    (degree..knots.len() - degree - 1).filter(|&k| knots[k] < knots[k + 1]).collect()
}

fn breaks(knots: &[f64], spans: &[usize]) -> Vec<f64> {
    let last = spans.last().map(|&k| knots[k + 1]);
    spans.iter().map(|&k| knots[k]).chain(last).collect()
}

/// The Bézier points of the piece over `span`, `line` being its `degree + 1` control points.
fn extract_line<T: Vector>(degree: usize, knots: &[f64], span: usize, line: &[T]) -> Vec<T> {
    let ends = [knots[span], knots[span + 1]];
    (0..=degree)
        .map(|j| {
            let mut c = [T::default(); MAX_DEGREE + 1];
            c[..=degree].copy_from_slice(line);
            for r in 1..=degree {
                let x = ends[usize::from(r <= j)];
                // Entry i belongs to the control point span − degree + i; downward, so that nothing is read after its turn.
                for i in (r..=degree).rev() {
                    let (a, b) = (knots[span - degree + i], knots[span + 1 + i - r]);
                    let w = (x - a) / (b - a);
                    c[i] = c[i - 1] * (1.0 - w) + c[i] * w;
                }
            }
            c[degree]
        })
        .collect()
}
