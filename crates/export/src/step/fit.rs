//! Blocks as biquintic splines: values at all nodes, derivatives to order (2, 2) at the breaks.

use glam::DVec3;
use suture_bernstein::{BSplineCurve, BSplineSurface, Jet2};
use suture_surface::Surface;

use super::layout::{Block, Layout};
use super::quintic::{DEGREE, Quintic};
use crate::ExportError;

/// Step of the differences for derivatives beyond a jet, in intervals of the patch's own parameters. They only steer the corners of
/// cross derivatives: four digits would do.
const STEP: f64 = 2e-3;

/// Fits block `number`.
///
/// # Errors
/// [`ExportError::StepPatch`] when the patch is not finite there.
pub(crate) fn fit(
    surface: &Surface,
    layout: &Layout,
    number: usize,
) -> Result<BSplineSurface<DVec3>, ExportError> {
    let block = &layout.blocks[number];
    let [a, b] = layout.nodes(block).map(Quintic::new);
    let (sites_a, sites_b) = (a.sites(), b.sites());
    let columns = sites_b.len();
    let mut data = vec![DVec3::ZERO; sites_a.len() * columns];
    for (i, &(x, order_a)) in sites_a.iter().enumerate() {
        if order_a > 0 {
            continue;
        }
        let rows = if sites_a.get(i + 1).is_some_and(|s| s.1 == 1) { 3 } else { 1 };
        for (j, &(y, order_b)) in sites_b.iter().enumerate() {
            if order_b > 0 {
                continue;
            }
            let cols = if sites_b.get(j + 1).is_some_and(|s| s.1 == 1) { 3 } else { 1 };
            let jet = block.jet(surface, block.piece(x), x, y);
            if !jet.finite() {
                let patch = block.pieces[block.piece(x)].patch;
                return Err(ExportError::StepPatch {
                    patch,
                    reason: "it has no finite derivatives everywhere",
                });
            }
            let mut put = |di: usize, dj: usize, value: DVec3| data[(i + di) * columns + j + dj] = value;
            put(0, 0, jet.p);
            if rows == 3 {
                put(1, 0, jet.du);
                put(2, 0, jet.duu);
            }
            if cols == 3 {
                put(0, 1, jet.dv);
                put(0, 2, jet.dvv);
            }
            if rows == 3 && cols == 3 {
                let [d21, d12, d22] = mixed(surface, block, x, y);
                put(1, 1, jet.duv);
                put(2, 1, d21);
                put(1, 2, d12);
                put(2, 2, d22);
            }
        }
    }
    if block.height < 1.0 {
        for side in 0..4 {
            match_cross(surface, block, [&a, &b], side, &mut data)?;
        }
    }
    // Along b first, then along a.
    let half: Vec<Vec<DVec3>> = data.chunks_exact(columns).map(|row| b.apply(row)).collect();
    let mut net = vec![DVec3::ZERO; a.count() * b.count()];
    for j in 0..b.count() {
        let column: Vec<DVec3> = half.iter().map(|row| row[j]).collect();
        for (i, p) in a.apply(&column).into_iter().enumerate() {
            net[i * b.count() + j] = p;
        }
    }
    let knots = [a.knots().to_vec(), b.knots().to_vec()];
    BSplineSurface::new([DEGREE, DEGREE], knots, net)
        .map_err(|source| ExportError::Spline { index: number, source })
}

/// The derivatives of orders (2, 1), (1, 2) and (2, 2) at a break, by one-sided differences of fourth order of exact second
/// derivatives. Across `a` pieces join C², so that differences along `b` are the same on both sides of a break of `a`; on kites, which have
/// no such breaks and two sides at every corner that are alike, they are the mean of the differences along either side.
fn mixed(surface: &Surface, block: &Block, a: f64, b: f64) -> [DVec3; 3] {
    let k = block.piece(a);
    let [from, to] = block.pieces[k].span;
    let hb = step(b, 0.0, block.height);
    let along_b = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|i| block.jet(surface, k, a, b + i * hb));
    let (d21, d12, d22) =
        (first(&along_b, hb, |j| j.duu), first(&along_b, hb, |j| j.duv), second(&along_b, hb, |j| j.duu));
    if block.height == 1.0 {
        return [d21, d12, d22];
    }
    let ha = step(a, from, to);
    let along_a = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|i| block.jet(surface, k, a + i * ha, b));
    let (e21, e12, e22) =
        (first(&along_a, ha, |j| j.duv), first(&along_a, ha, |j| j.dvv), second(&along_a, ha, |j| j.dvv));
    [(d21 + e21) * 0.5, (d12 + e12) * 0.5, (d22 + e22) * 0.5]
}

/// The step of differences at `at`, away from the nearer end.
fn step(at: f64, from: f64, to: f64) -> f64 {
    let h = STEP * (to - from);
    if at - from < to - at { h } else { -h }
}

/// Derivatives across a side of a kite, at the nodes between its ends.
///
/// The kite leaves its side in a direction that turns, what lies on the other side in another one. The exact derivatives in both
/// directions belong together, but along the side a spline has other derivatives than what it interpolates. So both sides take their
/// data from the same three splines: position, first and second derivative normal to the side in the plane of the polygon; for a
/// rectangle on the other side its own are these. What remains between the nodes falls with the first power of the interval in the
/// second derivatives where knot lines of the surface beneath cross the side.
fn match_cross(
    surface: &Surface,
    block: &Block,
    axes: [&Quintic; 2],
    side: usize,
    data: &mut [DVec3],
) -> Result<(), ExportError> {
    let piece = &block.pieces[0];
    let patch = &surface.patches()[piece.patch];
    let [q00, q10, q11, q01] = piece.quad;
    // From one end of the side to the other, and the directions across at the ends; all per unit of `a` or `b`, which have one length.
    let (ends, across) = match side {
        0 => ([q00, q10], [q01 - q00, q11 - q10]),
        1 => ([q10, q11], [q10 - q00, q11 - q01]),
        2 => ([q01, q11], [q01 - q00, q11 - q10]),
        _ => ([q00, q01], [q10 - q00, q11 - q01]),
    };
    let length = block.height;
    let along = (ends[1] - ends[0]) / length;
    let normal = along.perp();
    let at = |s: f64| {
        let x = s / length;
        // In the frame of the side: u along it, v normal to it.
        let map = Jet2 { p: ends[0] * (1.0 - x) + ends[1] * x, du: along, dv: normal, ..Jet2::default() };
        patch.jet(map.p).compose(&map)
    };
    let axis = axes[side % 2];
    let sites = axis.sites();
    let mut fields = [const { Vec::new() }; 3];
    for &(s, order) in &sites {
        let jet = at(s);
        let h = step(s, 0.0, length);
        let line = || [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|i| at(s + i * h));
        let found = match order {
            0 => [jet.p, jet.dv, jet.dvv],
            1 => [jet.du, jet.duv, first(&line(), h, |j| j.dvv)],
            _ => [jet.duu, first(&line(), h, |j| j.duv), second(&line(), h, |j| j.dvv)],
        };
        (0..3).for_each(|k| fields[k].push(found[k]));
    }
    let wrong = |source| ExportError::Spline { index: piece.patch, source };
    let spline =
        |field: &[DVec3]| BSplineCurve::new(DEGREE, axis.knots().to_vec(), axis.apply(field)).map_err(wrong);
    let [point, first, second] = [spline(&fields[0])?, spline(&fields[1])?, spline(&fields[2])?];
    let columns = axes[1].count();
    let last = axes[1 - side % 2].count() - 3;
    for (i, &(s, order)) in sites.iter().enumerate() {
        if order > 0 || s == 0.0 || s == length {
            continue;
        }
        let c = across[0].lerp(across[1], s / length) / length;
        let (t, n) = (c.dot(along) / along.length_squared(), c.dot(normal) / normal.length_squared());
        let [_, dp, ddp]: [DVec3; 3] = point.jet(s);
        let [f, df]: [DVec3; 2] = first.jet(s);
        let [g]: [DVec3; 1] = second.jet(s);
        let cross = [f * n + dp * t, g * (n * n) + df * (2.0 * n * t) + ddp * (t * t)];
        for (k, value) in cross.into_iter().enumerate() {
            let across = if side == 0 || side == 3 { k + 1 } else { last + k + 1 };
            let slot = if side.is_multiple_of(2) { i * columns + across } else { across * columns + i };
            data[slot] = value;
        }
    }
    Ok(())
}

fn first(jets: &[Jet2; 6], h: f64, of: impl Fn(&Jet2) -> DVec3) -> DVec3 {
    let weights = [-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25, 0.0];
    jets.iter().zip(weights).map(|(j, w)| of(j) * w).sum::<DVec3>() / h
}

fn second(jets: &[Jet2; 6], h: f64, of: impl Fn(&Jet2) -> DVec3) -> DVec3 {
    let weights = [15.0 / 4.0, -77.0 / 6.0, 107.0 / 6.0, -13.0, 61.0 / 12.0, -5.0 / 6.0];
    jets.iter().zip(weights).map(|(j, w)| of(j) * w).sum::<DVec3>() / (h * h)
}

/// The part of a side of a fitted block between two of its parameters, in rising order.
///
/// # Errors
/// [`ExportError::Spline`] when the interval is not one of the side.
pub(crate) fn side(
    fitted: &BSplineSurface<DVec3>,
    side: usize,
    interval: [f64; 2],
) -> Result<BSplineCurve<DVec3>, ExportError> {
    let wrong = |source| ExportError::Spline { index: 0, source };
    let [rows, columns] = fitted.count();
    let net: Vec<DVec3> = match side {
        0 => fitted.net().iter().step_by(columns).copied().collect(),
        1 => fitted.net()[(rows - 1) * columns..].to_vec(),
        2 => fitted.net()[columns - 1..].iter().step_by(columns).copied().collect(),
        _ => fitted.net()[..columns].to_vec(),
    };
    let curve = BSplineCurve::new(DEGREE, fitted.knots()[side % 2].to_vec(), net).map_err(wrong)?;
    if curve.domain() == interval {
        return Ok(curve);
    }
    let mut new = Vec::new();
    for t in interval {
        let present = curve.knots().iter().filter(|&&k| k == t).count();
        new.extend(std::iter::repeat_n(t, (DEGREE + 1).saturating_sub(present)));
    }
    let curve = curve.insert(&new).map_err(wrong)?;
    let from = curve.knots().partition_point(|&k| k < interval[0]);
    let to = curve.knots().partition_point(|&k| k <= interval[1]);
    let knots = curve.knots()[from..to].to_vec();
    let net = curve.net()[from..from + knots.len() - DEGREE - 1].to_vec();
    BSplineCurve::new(DEGREE, knots, net).map_err(wrong)
}
