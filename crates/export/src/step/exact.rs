//! Faces that leave as they are: their B-spline cut to the part that is used, and curves in their parameter plane.

use glam::{DVec2, DVec3};
use suture_bernstein::{Axis, BSplineCurve, BSplineSurface, BezierCurve};
use suture_surface::{Domain, EdgeCurve, Surface};

use super::brep::Pcurve;
use super::layout::Layout;
use super::quintic::{DEGREE, Quintic};
use crate::ExportError;

/// How much of the width of the used part stays around it.
const MARGIN: f64 = 0.02;

/// Error of curves in space, relative to their length, and the most intervals they get for it.
const CURVE: f64 = 1e-8;
const MOST_INTERVALS: usize = 256;

/// How far, relative to their derivatives, curves may be from continuing each other C².
const JOIN: f64 = 1e-9;

/// The part of `spline` around `domain`, its ends clamped: the same polynomials, without what lies beyond the data.
pub(crate) fn crop(
    spline: &BSplineSurface<DVec3>,
    domain: &Domain,
) -> Result<BSplineSurface<DVec3>, ExportError> {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for edge in (0..domain.edge_count()).filter_map(|e| domain.edge(e)) {
        // A Bézier curve lies in the hull of its net.
        for p in net(&edge) {
            (low, high) = (low.min(p), high.max(p));
        }
    }
    let margin = (high - low) * MARGIN;
    let [first, last] = spline.domain();
    let (low, high) = ((low - margin).max(first), (high + margin).min(last));
    let mut spline = clamp(spline, Axis::U, [low.x, high.x])?;
    spline = clamp(&spline, Axis::V, [low.y, high.y])?;
    Ok(spline)
}

/// `spline` between two parameters, with full knots there.
fn clamp(
    spline: &BSplineSurface<DVec3>,
    axis: Axis,
    interval: [f64; 2],
) -> Result<BSplineSurface<DVec3>, ExportError> {
    let d = axis.index();
    let degree = spline.degree()[d];
    let mut new = Vec::new();
    for t in interval {
        let present = spline.knots()[d].iter().filter(|&&k| k == t).count();
        new.extend(std::iter::repeat_n(t, (degree + 1).saturating_sub(present)));
    }
    let spline = spline.insert(axis, &new).map_err(|source| ExportError::Spline { index: 0, source })?;
    let knots = spline.knots();
    let from = knots[d].partition_point(|&k| k < interval[0]);
    let to = knots[d].partition_point(|&k| k <= interval[1]);
    let cut = knots[d][from..to].to_vec();
    let count = spline.count();
    let kept = cut.len() - degree - 1;
    let columns = count[1];
    let net = match axis {
        Axis::U => spline.net()[from * columns..(from + kept) * columns].to_vec(),
        Axis::V => {
            spline.net().chunks_exact(columns).flat_map(|row| row[from..from + kept].to_vec()).collect()
        }
    };
    let knots = match axis {
        Axis::U => [cut, knots[1].to_vec()],
        Axis::V => [knots[0].to_vec(), cut],
    };
    BSplineSurface::new(spline.degree(), knots, net)
        .map_err(|source| ExportError::Spline { index: 0, source })
}

fn net(edge: &EdgeCurve<'_>) -> Vec<DVec2> {
    match edge {
        EdgeCurve::Line(ends) => ends.to_vec(),
        EdgeCurve::Bezier(curve) => curve.net().to_vec(),
    }
}

/// Edges of a domain, one after the other, each from one of its parameters to another, as one curve over `joints`. Curves of at most the
/// fifth degree that continue each other C² become a spline with triple knots, others one that is continuous.
///
/// # Errors
/// [`ExportError::Spline`] when a curve is not finite.
pub(crate) fn pcurve(
    domain: &Domain,
    parts: &[(usize, [f64; 2])],
    joints: &[f64],
) -> Result<Pcurve, ExportError> {
    let wrong = |source| ExportError::Spline { index: 0, source };
    let mut pieces: Vec<BezierCurve<DVec2>> = Vec::with_capacity(parts.len());
    for &(edge, [from, to]) in parts {
        let mut points = domain.edge(edge).map(|e| net(&e)).unwrap_or_default();
        let (mut low, mut high) = (from, to);
        if from > to {
            points.reverse();
            (low, high) = (1.0 - from, 1.0 - to);
        }
        let mut curve = BezierCurve::new(points).map_err(wrong)?;
        if [low, high] != [0.0, 1.0] {
            curve = curve.restrict([low, high]).map_err(wrong)?;
        }
        pieces.push(curve);
    }
    let degree = pieces.iter().map(BezierCurve::degree).max().unwrap_or(1).max(DEGREE);
    let lengths: Vec<f64> = joints.windows(2).map(|w| w[1] - w[0]).collect();
    let jet = |k: usize, t: f64| -> [DVec2; 3] {
        let [p, d, dd]: [DVec2; 3] = pieces[k].jet(t);
        [p, d / lengths[k], dd / (lengths[k] * lengths[k])]
    };
    let smooth = (1..pieces.len()).all(|k| {
        let (a, b) = (jet(k - 1, 1.0), jet(k, 0.0));
        let size = a[1].length() * (lengths[k] + lengths[k - 1]);
        a[1].distance(b[1]) <= JOIN * a[1].length()
            && a[2].distance(b[2]) * lengths[k] * lengths[k] <= JOIN * size
    });
    if degree == DEGREE && smooth {
        let spline = Quintic::new(joints.windows(2).map(<[f64]>::to_vec).collect());
        let mut data = Vec::with_capacity(spline.count());
        for k in 0..=pieces.len() {
            let sides = [(k > 0).then(|| jet(k - 1, 1.0)), (k < pieces.len()).then(|| jet(k, 0.0))];
            let found: Vec<[DVec2; 3]> = sides.into_iter().flatten().collect();
            let mean = |i: usize| found.iter().map(|j| j[i]).sum::<DVec2>() / found.len() as f64;
            data.extend([mean(0), mean(1), mean(2)]);
        }
        let curve = BSplineCurve::new(DEGREE, spline.knots().to_vec(), spline.apply(&data)).map_err(wrong)?;
        return Ok(Pcurve::Spline(curve));
    }
    let mut knots = vec![joints[0]];
    let mut points: Vec<DVec2> = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        let piece = piece.elevate(degree - piece.degree()).map_err(wrong)?;
        points.extend(&piece.net()[usize::from(k > 0)..]);
        knots.extend(std::iter::repeat_n(joints[k], degree));
    }
    let end = joints[joints.len() - 1];
    knots.extend(std::iter::repeat_n(end, degree + 1));
    BSplineCurve::new(degree, knots, points).map(Pcurve::Spline).map_err(wrong)
}

/// The curve in space along edges of the domain of an exact face, over `joints`: a quintic with exact derivatives at so many nodes that
/// more would not help.
///
/// # Errors
/// [`ExportError::Spline`] when the surface is not finite there.
pub(crate) fn curve(
    surface: &Surface,
    layout: &Layout,
    face: usize,
    parts: &[(usize, [f64; 2])],
    joints: &[f64],
) -> Result<BSplineCurve<DVec3>, ExportError> {
    let exact = &layout.exact[face];
    let domain = &layout.domains[exact.patch];
    let patch = &surface.patches()[exact.patch];
    let jet = |k: usize, t: f64| -> [DVec3; 3] {
        let (edge, [from, to]) = parts[k];
        let rate = (to - from) / (joints[k + 1] - joints[k]);
        let Some(curve) = domain.edge(edge) else { return [DVec3::ZERO; 3] };
        let [p, d, dd] = curve.jet(from + rate * (t - joints[k]));
        let jet = patch.jet(p);
        let first = jet.du * d.x + jet.dv * d.y;
        let second = jet.duu * (d.x * d.x) + jet.duv * (2.0 * d.x * d.y) + jet.dvv * (d.y * d.y);
        [jet.p, first * rate, (second + jet.du * dd.x + jet.dv * dd.y) * (rate * rate)]
    };
    let wrong = |source| ExportError::Spline { index: exact.patch, source };
    let mut before: Option<BSplineCurve<DVec3>> = None;
    let mut intervals = 2;
    loop {
        let mut pieces = Vec::new();
        for span in joints.windows(2) {
            let at = |i: usize| {
                if i == intervals {
                    span[1]
                } else {
                    span[0] + (span[1] - span[0]) * (i as f64 / intervals as f64)
                }
            };
            pieces.extend((0..intervals).map(|i| vec![at(i), at(i + 1)]));
        }
        let spline = Quintic::new(pieces);
        let part = |t: f64| joints[1..].partition_point(|&j| j <= t).min(parts.len() - 1);
        let data: Vec<DVec3> = spline.sites().into_iter().map(|(t, order)| jet(part(t), t)[order]).collect();
        let curve = BSplineCurve::new(DEGREE, spline.knots().to_vec(), spline.apply(&data)).map_err(wrong)?;
        // Nodes between those of the coarser curve show its error.
        let error = before.as_ref().map(|coarse| {
            spline
                .sites()
                .into_iter()
                .map(|(t, _)| coarse.point(t).distance(curve.point(t)))
                .fold(0.0, f64::max)
        });
        let size = curve.net().windows(2).map(|p| p[0].distance(p[1])).sum::<f64>();
        if error.is_some_and(|e| e <= CURVE * size) || intervals >= MOST_INTERVALS {
            return Ok(before.unwrap_or(curve));
        }
        before = Some(curve);
        intervals *= 2;
    }
}
