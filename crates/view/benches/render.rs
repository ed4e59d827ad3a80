//! Time of a picture against its size.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_tessellate::{TessellationOptions, tessellate};
use suture_view::{Shade, ViewOptions, render};

#[path = "../tests/common/mod.rs"]
mod common;

fn size(c: &mut Criterion) {
    let surface = common::torus(12, 6);
    let options = TessellationOptions { chord: 1e-5, ..Default::default() };
    let Ok(tessellation) = tessellate(&surface, &options) else { return };
    let mut group = c.benchmark_group("render");
    group.sample_size(10).warm_up_time(std::time::Duration::from_millis(300));
    group.measurement_time(std::time::Duration::from_secs(1));
    for width in [200, 400, 800] {
        for shade in [Shade::Patches, Shade::Reflection] {
            let options = ViewOptions { width, height: width * 3 / 4, shade, ..Default::default() };
            group.throughput(Throughput::Elements(u64::from(width * width * 3 / 4)));
            group.bench_with_input(BenchmarkId::new(format!("{shade:?}"), width), &options, |b, options| {
                b.iter(|| render(black_box(&tessellation), &surface, options));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, size);
criterion_main!(benches);
