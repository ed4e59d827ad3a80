//! The three ways over the size of the mesh.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Duration;

use common::{sphere, torus};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_mesh::Topology;
use suture_segment::{Automatic, Segment, Segmentation, Waypoints};

fn ways(c: &mut Criterion) {
    let mut group = c.benchmark_group("segment");
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    for levels in [3, 4, 5] {
        let mesh = sphere(levels);
        let topology = Topology::build(&mesh).unwrap();
        let faces = mesh.faces.len();
        group.throughput(Throughput::Elements(faces as u64));
        let labels: Vec<u32> = (0..faces as u32).map(|f| f / (faces as u32 / 8)).collect();
        group.bench_function(BenchmarkId::new("labels/sphere", faces), |b| {
            b.iter(|| Segmentation::from_labels(black_box(&mesh), &topology, &labels).unwrap());
        });
        let paths = vec![vec![1, 2, 3, 4, 1], vec![1, 0, 3], vec![2, 0, 4], vec![1, 5, 3]];
        let waypoints = Waypoints { paths, ..Waypoints::default() };
        group.bench_function(BenchmarkId::new("waypoints/sphere", faces), |b| {
            b.iter(|| waypoints.segment(black_box(&mesh), &topology).unwrap());
        });
        group.bench_function(BenchmarkId::new("automatic/sphere", faces), |b| {
            b.iter(|| Automatic::default().segment(black_box(&mesh), &topology).unwrap());
        });
    }
    for m in [32, 64, 128] {
        let mesh = torus(m, m / 4);
        let topology = Topology::build(&mesh).unwrap();
        group.throughput(Throughput::Elements(mesh.faces.len() as u64));
        group.bench_function(BenchmarkId::new("automatic/torus", mesh.faces.len()), |b| {
            b.iter(|| Automatic::default().segment(black_box(&mesh), &topology).unwrap());
        });
    }
}

criterion_group!(benches, ways);
criterion_main!(benches);
