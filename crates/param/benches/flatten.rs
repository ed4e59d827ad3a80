//! Collars and flattening methods over the number of faces.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use std::hint::black_box;
use suture_mesh::{Topology, TriMesh};
use suture_param::*;

/// An `n × n` grid of quads with a hill.
fn hill(n: u32) -> TriMesh {
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (2.0 * i as f64 / n as f64 - 1.0, 2.0 * j as f64 / n as f64 - 1.0);
            positions.push(DVec3::new(x, y, 1.5 * (-4.0 * (x * x + y * y)).exp()));
            if i < n && j < n {
                faces.extend([
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]);
            }
        }
    }
    TriMesh::new(positions, faces)
}

fn flatten(c: &mut Criterion) {
    let methods: [(&str, &dyn Parameterize); 5] = [
        ("lscm", &Lscm::default()),
        ("boundary scale 1", &BoundaryScaleOne),
        ("tutte", &Tutte),
        ("symmetric dirichlet 5", &SymmetricDirichlet { iterations: 5, ..Default::default() }),
        ("recommended", &Recommended::default()),
    ];
    let mut group = c.benchmark_group("flatten");
    group
        .sample_size(10)
        .measurement_time(std::time::Duration::from_secs(1))
        .warm_up_time(std::time::Duration::from_millis(200));
    for n in [16, 32, 64, 128] {
        let mesh = hill(n);
        group.throughput(Throughput::Elements(mesh.faces.len() as u64));
        for (name, method) in methods {
            group.bench_with_input(BenchmarkId::new(name, mesh.faces.len()), &mesh, |b, mesh| {
                b.iter(|| method.parameterize(black_box(&mesh.positions), &mesh.faces));
            });
        }
    }
    group.finish();
}

fn collar(c: &mut Criterion) {
    let mut group = c.benchmark_group("collar of 3 rings");
    group
        .sample_size(10)
        .measurement_time(std::time::Duration::from_secs(1))
        .warm_up_time(std::time::Duration::from_millis(200));
    for n in [32, 64, 128, 256] {
        let mesh = hill(n);
        let Ok(topology) = Topology::build(&mesh) else { continue };
        let quarter = |f: &u32| (f / 2 % n) < n / 2 && f / 2 / n < n / 2;
        let segment: Vec<u32> = (0..mesh.faces.len() as u32).filter(quarter).collect();
        group.throughput(Throughput::Elements(segment.len() as u64));
        group.bench_with_input(BenchmarkId::from_parameter(segment.len()), &segment, |b, segment| {
            b.iter(|| disc_with_collar(&mesh, &topology, black_box(segment), &CollarOptions::default()));
        });
    }
    group.finish();
}

criterion_group!(benches, flatten, collar);
criterion_main!(benches);
