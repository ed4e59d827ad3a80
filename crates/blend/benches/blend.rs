//! Evaluation of the weights, swept over the valence.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec2;
use suture_blend::weights;

fn evaluate(c: &mut Criterion) {
    let mut group = c.benchmark_group("weights");
    group.bench_function("strip", |b| b.iter(|| weights::strip(black_box(0.3))));
    for n in 3..=8 {
        group.bench_with_input(BenchmarkId::new("n_blend", n), &n, |b, &n| {
            b.iter(|| weights::n_blend(n, black_box(DVec2::new(0.1, 0.2))));
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
