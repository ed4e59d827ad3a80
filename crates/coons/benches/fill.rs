//! Second-order jets of fills, swept over the degree of the constituents, the kind of fill and the blend.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;
use suture_coons::{
    Analytic, Constituent, Family, FillOptions, FourSided, Map, Mapped, Order, Shape, Spline, ThreeSided,
    border_curves,
};
use suture_surface::Patch;

fn spline(degree: usize, z: f64) -> Option<Arc<dyn Constituent>> {
    let n = degree + 5;
    let net = (0..n * n)
        .map(|i| DVec3::new((i / n) as f64, (i % n) as f64, z + ((i * 7919) % 13) as f64 / 13.0))
        .collect();
    let surface = BSplineSurface::uniform([degree; 2], DVec2::ZERO, DVec2::splat(0.2), [5, 5], net).ok()?;
    Some(Arc::new(Spline(Arc::new(surface))))
}

fn walk(patch: &dyn Patch, i: &mut u32) -> DVec3 {
    *i = i.wrapping_add(1);
    let (u, v) = (f64::from(i.wrapping_mul(40503) % 1021), f64::from(i.wrapping_mul(30011) % 1019));
    patch.jet(black_box(DVec2::new(u / 1021.0, v / 1019.0))).dvv
}

fn jets(c: &mut Criterion) {
    let mut group = c.benchmark_group("jet");
    for degree in [2, 3, 5] {
        let (Some(a), Some(b)) = (spline(degree, 0.0), spline(degree, 1.0)) else { continue };
        let r = [a, b];
        let Ok(borders) = border_curves(&r, Order::C2) else { continue };
        let Ok(fill) = FourSided::fill(r, borders, &FillOptions::default()) else { continue };
        let mut i = 0;
        group.bench_function(BenchmarkId::new("spline", degree), |b| b.iter(|| walk(&fill.patch, &mut i)));
    }
    for (name, family) in [("trigonometric", Family::Trigonometric), ("rational", Family::Rational)] {
        let (Some(a), Some(b)) = (spline(3, 0.0), spline(3, 1.0)) else { continue };
        let r = [a, b];
        let Ok(borders) = border_curves(&r, Order::C2) else { continue };
        let options = FillOptions { family, ..Default::default() };
        let Ok(fill) = FourSided::fill(r, borders, &options) else { continue };
        let mut i = 0;
        group.bench_function(BenchmarkId::new(name, 3), |b| b.iter(|| walk(&fill.patch, &mut i)));
    }
    let sphere: Arc<dyn Constituent> = Arc::new(Analytic::new(Shape::Sphere { radius: 1.0 }));
    let map = Map::Affine { origin: DVec2::ZERO, u: DVec2::Y, v: DVec2::X };
    let cap: Arc<dyn Constituent> = Arc::new(Mapped { inner: sphere, map });
    let r = [Arc::clone(&cap), Arc::clone(&cap), cap];
    if let Ok(hole) = ThreeSided::fill(r, &FillOptions::default()) {
        let mut i = 0;
        group.bench_function(BenchmarkId::new("three_sided", "sphere"), |b| {
            b.iter(|| walk(&hole.patch, &mut i))
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(2));
    targets = jets
}
criterion_main!(benches);
