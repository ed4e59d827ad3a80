//! Reading and writing every format, by the number of triangles.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use suture_mesh::{
    io::{self, MeshFormat, WriteOptions},
    shapes,
};

fn formats(c: &mut Criterion) {
    for (name, format, ascii) in [
        ("obj", MeshFormat::Obj, false),
        ("off", MeshFormat::Off, false),
        ("ply", MeshFormat::Ply, false),
        ("ply-ascii", MeshFormat::Ply, true),
        ("stl", MeshFormat::Stl, false),
        ("stl-ascii", MeshFormat::Stl, true),
    ] {
        let options = WriteOptions { format: Some(format), ascii };
        let mut group = c.benchmark_group(name);
        group.sample_size(10).measurement_time(std::time::Duration::from_secs(1));
        for level in [3, 5, 6] {
            let mesh = shapes::sphere(level);
            let mut bytes = Vec::new();
            io::write_to(&mut bytes, &mesh, format, options).expect("a sphere can be written");
            group.throughput(Throughput::Bytes(bytes.len() as u64));
            group.bench_with_input(BenchmarkId::new("read", mesh.faces.len()), &bytes, |b, bytes| {
                b.iter(|| io::read_from(black_box(bytes), format));
            });
            group.bench_with_input(BenchmarkId::new("write", mesh.faces.len()), &mesh, |b, mesh| {
                b.iter(|| io::write_to(std::io::sink(), black_box(mesh), format, options));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, formats);
criterion_main!(benches);
