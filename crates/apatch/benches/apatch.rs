//! Construction, evaluation and tessellation, swept over the number of faces.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_apatch::{ApatchOptions, Shooting, Side, apatch};
use suture_mesh::shapes;

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    let options = ApatchOptions { intersections: false, ..ApatchOptions::default() };
    for level in [2, 3, 4] {
        let mesh = shapes::sphere(level);
        group.throughput(Throughput::Elements(mesh.faces.len() as u64));
        group.bench_with_input(BenchmarkId::new("sphere", mesh.faces.len()), &mesh, |b, mesh| {
            b.iter(|| apatch(black_box(mesh), &mesh.positions, &options));
        });
    }
    group.finish();
}

fn evaluate(c: &mut Criterion) {
    let mesh = shapes::sphere(2);
    let Ok(surface) = apatch(&mesh, &mesh.positions, &ApatchOptions::default()) else { return };
    c.bench_function("face point", |b| {
        b.iter(|| surface.face_point(black_box(7), black_box([0.5, 0.3, 0.2])))
    });
    c.bench_function("edge point", |b| {
        b.iter(|| surface.edge_point(black_box(7), black_box(0.3), black_box(0.6)))
    });
    let mut group = c.benchmark_group("tessellate");
    group.sample_size(10);
    for n in [4, 8, 16] {
        group.bench_with_input(BenchmarkId::new("sphere of 320", n), &n, |b, &n| {
            b.iter(|| surface.tessellate(n, 2));
        });
    }
    group.finish();
    let shot = Shooting(black_box([-0.2, 0.4, 0.3, 0.5]));
    c.bench_function("root by Newton", |b| b.iter(|| black_box(shot).root()));
    c.bench_function("root by bisection", |b| b.iter(|| black_box(shot).bracketed()));
    c.bench_function("root by Cardano", |b| b.iter(|| black_box(shot).cardano()));
}

/// One apex weight changed: the forms of a face and its edges, and the points that follow.
fn weight(c: &mut Criterion) {
    let mut group = c.benchmark_group("weight of one face");
    group.sample_size(20);
    for level in [2, 4] {
        let mesh = shapes::sphere(level);
        let Ok(mut surface) = apatch(&mesh, &mesh.positions, &ApatchOptions::default()) else { return };
        let Some((_, before)) = surface.apex(7, Side::Positive) else { return };
        let mut weight = before;
        group.bench_function(BenchmarkId::new("set", mesh.faces.len()), |b| {
            b.iter(|| {
                weight += 1e-9;
                surface.set_weight(7, Side::Positive, black_box(weight))
            })
        });
    }
    let mesh = shapes::sphere(2);
    let Ok(surface) = apatch(&mesh, &mesh.positions, &ApatchOptions::default()) else { return };
    for n in [8, 24] {
        let Some(rays) = surface.weight_rays(7, Side::Positive, n, n.div_ceil(4)) else { return };
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(BenchmarkId::new("points", rays.len()), |b| {
            b.iter(|| rays.points(black_box(0.1)).map(|p| p.0).sum::<glam::DVec3>())
        });
    }
    group.finish();
}

criterion_group!(benches, build, evaluate, weight);
criterion_main!(benches);
