//! Certificate over the number of seams, deviation over the number of mesh vertices: both linear (times a logarithm).

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Duration;

use common::{Grid, graph, surface};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use suture_certify::{CertifyOptions, certify, deviation};
use suture_mesh::TriMesh;
use suture_surface::{Continuity, EdgeRef, Jet2, PatchId, Seam, Surface};

fn bowl(x: DVec2) -> Jet2<f64> {
    Jet2 { p: 0.1 * x.length_squared(), du: 0.2 * x.x, dv: 0.2 * x.y, duu: 0.2, dvv: 0.2, ..Jet2::default() }
}

/// A row of `n` patches with `n − 1` seams.
fn row(n: u32) -> Surface {
    let edge = |patch, edge| EdgeRef { patch: PatchId(patch), edge };
    let patches = (0..n).map(|i| graph(DVec2::new(f64::from(i), 0.0), bowl)).collect();
    surface(patches, (1..n).map(|i| Seam::new(edge(i - 1, 1), edge(i, 3), Continuity::C2)).collect())
}

fn seams(c: &mut Criterion) {
    let mut group = c.benchmark_group("certify");
    for n in [10, 100, 1000] {
        let surface = row(n + 1);
        group.throughput(Throughput::Elements(n.into()));
        group.bench_with_input(BenchmarkId::from_parameter(n), &surface, |b, surface| {
            b.iter(|| certify(black_box(surface), 1.0, &CertifyOptions::default()));
        });
    }
    group.finish();
}

fn distances(c: &mut Criterion) {
    let mut group = c.benchmark_group("deviation");
    let smooth = row(4);
    let grid = Grid::of(&smooth, 32);
    for n in [16u32, 64, 128] {
        let lift = |p: DVec3| p + DVec3::Z * 0.01;
        let mesh = Grid::of(&smooth, n);
        let mesh = TriMesh::new(mesh.positions.iter().copied().map(lift).collect(), mesh.triangles);
        group.throughput(Throughput::Elements(mesh.positions.len() as u64));
        group.bench_with_input(BenchmarkId::from_parameter(mesh.positions.len()), &mesh, |b, mesh| {
            b.iter(|| deviation(black_box(mesh), &smooth, &grid.samples()));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    targets = seams, distances
}
criterion_main!(benches);
