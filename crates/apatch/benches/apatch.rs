//! Construction, evaluation and tessellation, swept over the number of faces.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_apatch::{ApatchOptions, Shooting, apatch};
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

criterion_group!(benches, build, evaluate);
criterion_main!(benches);
