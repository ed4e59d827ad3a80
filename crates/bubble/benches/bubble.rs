//! Building swept over the number of faces, and evaluation swept over the order.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec2;
use suture_bubble::{BubbleOptions, Fit, PolyMesh, bubble};
use suture_mesh::{shapes, vertex_normals_area_weighted};
use suture_surface::Patch;

fn mesh(nu: u32, nv: u32) -> PolyMesh {
    let mesh = shapes::torus(2.0, 0.8, nu, nv);
    PolyMesh::from_triangles(&mesh, &vertex_normals_area_weighted(&mesh)).unwrap_or_default()
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    for (nu, nv) in [(20, 10), (80, 40)] {
        let mesh = mesh(nu, nv);
        for (name, fit) in [("tangential", Fit::Tangential), ("quartic", Fit::Quartic)] {
            let options = BubbleOptions { fit, ..Default::default() };
            group.bench_function(BenchmarkId::new(name, mesh.faces.len()), |b| {
                b.iter(|| bubble(&mesh, &options))
            });
        }
    }
    group.finish();
}

fn evaluate(c: &mut Criterion) {
    let mut group = c.benchmark_group("jet");
    let mesh = mesh(12, 8);
    for order in 0..5 {
        let Ok(surface) = bubble(&mesh, &BubbleOptions { order, ..Default::default() }) else { continue };
        let patch = &surface.patches()[5];
        group.bench_function(BenchmarkId::from_parameter(order), |b| {
            b.iter(|| patch.jet(black_box(DVec2::new(0.21, 0.34))));
        });
    }
    group.finish();
}

criterion_group!(benches, build, evaluate);
criterion_main!(benches);
