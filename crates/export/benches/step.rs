//! How long a STEP file takes: a ball of 6 n² patches, each refitted.

use std::collections::BTreeMap;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DMat3, DVec2, DVec3};
use suture_export::{StepOptions, to_step};
use suture_surface::{
    Continuity, Domain, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
};

/// The central projection of a rectangle of a plane onto the unit sphere.
#[derive(Clone, Debug)]
struct Ball {
    frame: DMat3,
    min: DVec2,
    max: DVec2,
}

impl Patch for Ball {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: self.min, max: self.max }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let (u, v) = (at.x, at.y);
        let q = DVec3::new(u, v, 1.0);
        let s = q.length_squared();
        let (a, b, c) = (s.powf(-0.5), s.powf(-1.5), 3.0 * s.powf(-2.5));
        let w = Jet2 { p: a, du: -u * b, dv: -v * b, duu: u * u * c - b, duv: u * v * c, dvv: v * v * c - b };
        let q = Jet2 { p: q, du: DVec3::X, dv: DVec3::Y, ..Jet2::default() };
        q.weighted(&w).map(|x| self.frame * x)
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Bubble { n: 4 }
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        Record { kind: "bench.ball".into(), data: serde_json::Value::Null }
    }
}

fn ball(n: u32) -> Surface {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut patches = Vec::new();
    for k in 0..6 {
        let (x, y) = (axes[k % 3], axes[(k + 1) % 3]);
        let (x, y) = if k < 3 { (x, y) } else { (y, x) };
        let frame = DMat3::from_cols(x, y, x.cross(y));
        let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
        for i in 0..n {
            for j in 0..n {
                let (min, max) = (DVec2::new(at(i), at(j)), DVec2::new(at(i + 1), at(j + 1)));
                patches.push(Ball { frame, min, max });
            }
        }
    }
    // Edges whose ends are the same points to nine digits.
    let mut known: BTreeMap<[[i64; 3]; 2], EdgeRef> = BTreeMap::new();
    let mut seams = Vec::new();
    for (p, patch) in patches.iter().enumerate() {
        let domain = patch.domain();
        for edge in 0..4 {
            let Some(curve) = domain.edge(edge) else { continue };
            let mut key =
                [0.0, 1.0].map(|t| (patch.jet(curve.point(t)).p * 1e9).round().to_array().map(|x| x as i64));
            key.sort_unstable();
            let own = EdgeRef { patch: PatchId(p as u32), edge: edge as u32 };
            match known.remove(&key) {
                Some(other) => seams.push(Seam::new(other, own, Continuity::G2)),
                None => {
                    known.insert(key, own);
                }
            }
        }
    }
    let patches = patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect();
    Surface::new(patches, seams).expect("patches that join")
}

fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("to_step");
    group.sample_size(10);
    for n in [2, 4, 8, 16] {
        let surface = ball(n);
        group.throughput(Throughput::Elements(u64::from(6 * n * n)));
        group.bench_with_input(BenchmarkId::from_parameter(6 * n * n), &surface, |b, surface| {
            b.iter(|| to_step(black_box(surface), &StepOptions::default()).expect("a file"));
        });
    }
    group.finish();
}

criterion_group!(benches, step);
criterion_main!(benches);
