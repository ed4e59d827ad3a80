//! Time of assembly, factorisation and solution over the number of points.

#![allow(missing_docs)]

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use suture_fit::{Cells, EnergyOrder, Grid, System};

/// Quasi-random points in the unit square (additive recurrence with the plastic number).
fn points(n: usize) -> Vec<DVec2> {
    (0..n).map(|i| (DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053) * i as f64).fract()).collect()
}

fn sweep(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("system");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(700));
    for (n, side) in [(1_000, 15), (4_500, 32), (18_000, 64), (45_000, 128)] {
        let params = points(n);
        let x: Vec<DVec3> = params.iter().map(|p| p.extend((6.0 * p.x).sin() * p.y)).collect();
        let weights = vec![1.0 / n as f64; n];
        let cells = Cells::all(Grid::new(DVec2::ZERO, DVec2::ONE, [side, side]).expect("a grid"));
        let new =
            || System::new(cells.clone(), &params, &weights, 1.0, EnergyOrder::Third).expect("a system");
        let system = new();
        let lambda = system.lambda(1e-4);
        let factor = system.factor(lambda).expect("a factor");
        println!(
            "{n} points, {} unknowns: {:.0} values per row of the factor",
            system.unknowns(),
            system.factor_len() as f64 / system.unknowns() as f64
        );
        group.bench_function(BenchmarkId::new("design, assembly and symbolic", n), |b| {
            b.iter(|| black_box(new()))
        });
        group.bench_function(BenchmarkId::new("design and assembly", n), |b| {
            b.iter(|| black_box(system.relocate(&params, &weights).expect("a system")))
        });
        group.bench_function(BenchmarkId::new("factor", n), |b| {
            b.iter(|| black_box(system.factor(lambda).expect("a factor")))
        });
        group.bench_function(BenchmarkId::new("solve and refine", n), |b| {
            b.iter(|| black_box(system.solve(&factor, &x).expect("a net")))
        });
    }
    group.finish();
}

criterion_group!(benches, sweep);
criterion_main!(benches);
