//! Evaluation of every net, swept over degree: nanoseconds per jet at scattered parameters.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use suture_bernstein::{BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle};

/// Parameters of one measured pass; scattered, so that branches are predicted no better than in use.
const POINTS: usize = 64;

/// Point `i` of the additive (golden) sequence in the unit square.
fn scattered(i: usize) -> DVec2 {
    let f = |a: f64| (i as f64 * a).fract();
    DVec2::new(f(0.754_877_666_246_692_8), f(0.569_840_290_998_053_3))
}

fn points() -> Vec<DVec2> {
    (0..POINTS).map(scattered).collect()
}

fn net(count: usize) -> Vec<DVec3> {
    (0..count).map(|i| scattered(i).extend((i as f64).sin())).collect()
}

fn knots(degree: usize, cells: usize) -> Vec<f64> {
    (0..cells + 2 * degree + 1).map(|i| (i as f64 - degree as f64) / cells as f64).collect()
}

/// Time of `f` at one point, averaged over the scattered points.
fn measure(c: &mut Criterion, group: &str, id: String, mut f: impl FnMut(DVec2)) {
    let points = points();
    let mut group = c.benchmark_group(group);
    group
        .warm_up_time(Duration::from_millis(150))
        .measurement_time(Duration::from_millis(400))
        .sample_size(20);
    group.throughput(criterion::Throughput::Elements(POINTS as u64));
    group.bench_function(BenchmarkId::from_parameter(id), |b| {
        b.iter(|| points.iter().for_each(|&p| f(black_box(p))));
    });
    group.finish();
}

fn surfaces(c: &mut Criterion) {
    for degree in [[2, 2], [3, 3], [4, 4], [5, 5], [3, 5]] {
        let cells = 24;
        let net = net(degree.iter().map(|d| d + cells).product());
        let surface = BSplineSurface::new(degree, degree.map(|d| knots(d, cells)), net).unwrap();
        measure(c, "surface", format!("{}x{}", degree[0], degree[1]), |p| {
            black_box(surface.jet(p));
        });
    }
}

fn patches(c: &mut Criterion) {
    for degree in [[1, 1], [3, 3], [5, 1], [5, 2], [5, 3], [7, 7], [12, 12]] {
        let net = net(degree.iter().map(|d| d + 1).product());
        let patch = BezierPatch::new(degree, net).unwrap();
        measure(c, "patch", format!("{}x{}", degree[0], degree[1]), |p| {
            black_box(patch.jet(p));
        });
    }
}

fn triangles(c: &mut Criterion) {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
    for degree in [1, 3, 5, 7, 9, 12] {
        let net = net((degree + 1) * (degree + 2) / 2);
        let scalar = BezierTriangle::new(degree, net.iter().map(|p| p.z).collect()).unwrap();
        let vector = BezierTriangle::new(degree, net).unwrap();
        measure(c, "triangle of numbers", degree.to_string(), |p| {
            black_box(scalar.jet(corners, p));
        });
        measure(c, "triangle of points", degree.to_string(), |p| {
            black_box(vector.jet(corners, p));
        });
    }
}

fn curves(c: &mut Criterion) {
    for degree in [1, 3, 5, 7, 12] {
        let bezier = BezierCurve::new(net(degree + 1)).unwrap();
        let spline = BSplineCurve::new(degree, knots(degree, 24), net(24 + degree)).unwrap();
        measure(c, "curve", degree.to_string(), |p| {
            black_box(bezier.jet::<3>(p.x));
        });
        measure(c, "spline curve", degree.to_string(), |p| {
            black_box(spline.jet::<3>(p.x));
        });
    }
}

criterion_group!(benches, surfaces, patches, triangles, curves);
criterion_main!(benches);
