//! Time of a tessellation against the tolerance of its chords.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_tessellate::{TessellationOptions, tessellate};

#[path = "../tests/common/mod.rs"]
mod common;

fn chord(c: &mut Criterion) {
    let surface = common::blended_sphere(4, 1.0);
    let mut group = c.benchmark_group("tessellate");
    group.sample_size(10).warm_up_time(std::time::Duration::from_millis(300));
    group.measurement_time(std::time::Duration::from_secs(1));
    for chord in [1e-3, 1e-4, 1e-5] {
        let options = TessellationOptions { chord, ..Default::default() };
        let triangles = tessellate(&surface, &options).map_or(0, |t| t.mesh.faces.len());
        group.throughput(Throughput::Elements(triangles as u64));
        group.bench_with_input(BenchmarkId::new("chord", format!("{chord:e}")), &options, |b, options| {
            b.iter(|| tessellate(black_box(&surface), options));
        });
    }
    group.finish();
}

criterion_group!(benches, chord);
criterion_main!(benches);
