//! Adjacency, check and welding, by the number of triangles.

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_mesh::{Topology, TriMesh, check, repair, shapes, subdivide_midpoint};

fn adjacency(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh");
    group.sample_size(10).measurement_time(std::time::Duration::from_secs(1));
    for level in [3, 5, 6, 7] {
        let mesh = shapes::sphere(level);
        let n = mesh.faces.len();
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::new("topology", n), |b| {
            b.iter(|| Topology::build(black_box(&mesh)))
        });
        group.bench_function(BenchmarkId::new("check", n), |b| b.iter(|| check(black_box(&mesh))));
        group.bench_function(BenchmarkId::new("subdivide", n), |b| {
            b.iter(|| subdivide_midpoint(black_box(&mesh)));
        });
        let soup = TriMesh::new(
            (0..n).flat_map(|f| mesh.corners(f)).collect(),
            (0..n as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect(),
        );
        group.bench_function(BenchmarkId::new("weld", n), |b| {
            b.iter_batched_ref(|| soup.clone(), repair::weld_coincident, BatchSize::LargeInput);
        });
        group.bench_function(BenchmarkId::new("weld-within", n), |b| {
            b.iter_batched_ref(|| soup.clone(), |m| repair::weld_within(m, 1e-6), BatchSize::LargeInput);
        });
    }
    group.finish();
}

criterion_group!(benches, adjacency);
criterion_main!(benches);
