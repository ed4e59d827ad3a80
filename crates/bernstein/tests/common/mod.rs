//! Random nets, knots and comparisons for the tests.
#![allow(dead_code, unreachable_pub, reason = "each test program uses a part")]

use glam::DVec3;
use proptest::prelude::*;
use suture_bernstein::{BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle};

pub fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0).prop_map(DVec3::from_array)
}

pub fn points(count: usize) -> impl Strategy<Value = Vec<DVec3>> {
    prop::collection::vec(point(), count)
}

/// Knots for `degree` with 1 to 6 random intervals, multiplicities 1 to `degree + 1` inside, any at the ends.
pub fn knots(degree: usize) -> impl Strategy<Value = Vec<f64>> {
    let interval = (0.1..1.0_f64, 1..=degree + 1);
    (prop::collection::vec(interval, 1..=6), 0..=degree, 0..=degree, -2.0..2.0_f64).prop_map(
        move |(intervals, before, after, start)| {
            let mut t = start;
            // `before` of the first degree knots lie before the start of the domain, the others at it.
            let mut knots: Vec<f64> = (0..before).map(|i| start - 0.3 * (before - i) as f64).collect();
            knots.resize(degree + 1, t);
            let last = intervals.len() - 1;
            for (i, (width, multiplicity)) in intervals.into_iter().enumerate() {
                t += width;
                knots.extend(std::iter::repeat_n(
                    t,
                    if i == last { degree + 1 - after } else { multiplicity },
                ));
            }
            knots.extend((0..after).map(|i| t + 0.2 * (i + 1) as f64));
            knots
        },
    )
}

pub fn spline(max: usize) -> impl Strategy<Value = BSplineCurve<DVec3>> {
    (0..=max).prop_flat_map(|p| (Just(p), knots(p))).prop_flat_map(|(p, knots)| {
        points(knots.len() - p - 1).prop_map(move |net| BSplineCurve::new(p, knots.clone(), net).unwrap())
    })
}

pub fn surface(max: usize) -> impl Strategy<Value = BSplineSurface<DVec3>> {
    (0..=max, 0..=max).prop_flat_map(|(p, q)| (Just([p, q]), knots(p), knots(q))).prop_flat_map(
        |(degree, u, v)| {
            let count = (u.len() - degree[0] - 1) * (v.len() - degree[1] - 1);
            points(count)
                .prop_map(move |net| BSplineSurface::new(degree, [u.clone(), v.clone()], net).unwrap())
        },
    )
}

pub fn curve(max: usize) -> impl Strategy<Value = BezierCurve<DVec3>> {
    (0..=max).prop_flat_map(|n| points(n + 1)).prop_map(|net| BezierCurve::new(net).unwrap())
}

pub fn patch(max: usize) -> impl Strategy<Value = BezierPatch<DVec3>> {
    (0..=max, 0..=max).prop_flat_map(|(m, n)| {
        points((m + 1) * (n + 1)).prop_map(move |net| BezierPatch::new([m, n], net).unwrap())
    })
}

pub fn triangle(max: usize) -> impl Strategy<Value = BezierTriangle<DVec3>> {
    (0..=max).prop_flat_map(|n| {
        points((n + 1) * (n + 2) / 2).prop_map(move |net| BezierTriangle::new(n, net).unwrap())
    })
}

/// Barycentric coordinates of a point inside a triangle.
pub fn barycentric() -> impl Strategy<Value = [f64; 3]> {
    (0.0..=1.0, 0.0..=1.0).prop_map(|(a, b): (f64, f64)| {
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        [1.0 - a - b, a, b]
    })
}

/// The point at fraction `x` of an interval.
pub fn at([a, b]: [f64; 2], x: f64) -> f64 {
    a + (b - a) * x
}

#[track_caller]
pub fn near(got: DVec3, want: DVec3, tolerance: f64) {
    assert!(got.distance(want) <= tolerance, "{got} ≠ {want}, tolerance {tolerance:e}");
}

/// Relative to the larger of the wanted value and `scale`.
#[track_caller]
pub fn close(got: f64, want: f64, tolerance: f64, scale: f64) {
    assert!(
        (got - want).abs() <= tolerance * scale.max(want.abs()),
        "{got} ≠ {want}, tolerance {tolerance:e}"
    );
}
