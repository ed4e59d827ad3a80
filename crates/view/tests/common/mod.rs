//! Surfaces made of analytic patches.
#![allow(dead_code, unreachable_pub)]

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use suture_bernstein::Jet2;
use suture_surface::{
    Continuity, Domain, EdgeRef, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
};

/// A rectangle of a torus with radii 1 and `tube`, parameters in turns.
#[derive(Clone, Debug)]
pub struct TorusPatch {
    pub min: DVec2,
    pub max: DVec2,
    pub tube: f64,
    pub kind: PatchKind,
}

impl Patch for TorusPatch {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: self.min, max: self.max }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let ((s, c), (sv, cv)) = ((at.x * TAU).sin_cos(), (at.y * TAU).sin_cos());
        let (e, e1, t) = (DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), self.tube);
        let rho = 1.0 + t * cv;
        Jet2 {
            p: e * rho + DVec3::Z * (t * sv),
            du: e1 * (rho * TAU),
            dv: (e * -sv + DVec3::Z * cv) * (t * TAU),
            duu: e * (-rho * TAU * TAU),
            duv: e1 * (-t * sv * TAU * TAU),
            dvv: (e * cv + DVec3::Z * sv) * (-t * TAU * TAU),
        }
    }

    fn kind(&self) -> PatchKind {
        self.kind
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        Record { kind: "test".into(), data: serde_json::Value::Null }
    }
}

/// A closed torus of `m × n` rectangles, of all kinds in turn.
pub fn torus(m: usize, n: usize) -> Surface {
    let kinds = [
        PatchKind::Trimmed,
        PatchKind::Strip { odd: false },
        PatchKind::Strip { odd: true },
        PatchKind::AdjacentStrip,
        PatchKind::NBlend { n: 3 },
    ];
    let mut patches: Vec<Box<dyn Patch>> = Vec::new();
    let mut seams = Vec::new();
    let id = |i: usize, j: usize, edge: u32| EdgeRef { patch: PatchId((i % m * n + j % n) as u32), edge };
    let at = |i: usize, j: usize| DVec2::new(i as f64 / m as f64, j as f64 / n as f64);
    for i in 0..m {
        for j in 0..n {
            let kind = kinds[(i + 2 * j) % 5];
            patches.push(Box::new(TorusPatch { min: at(i, j), max: at(i + 1, j + 1), tube: 0.45, kind }));
            seams.push(Seam::new(id(i, j, 1), id(i + 1, j, 3), Continuity::C2));
            seams.push(Seam::new(id(i, j, 2), id(i, j + 1, 0), Continuity::C2));
        }
    }
    Surface::new(patches, seams).unwrap()
}

/// One open piece of the torus.
pub fn piece(kind: PatchKind) -> Surface {
    let patch = TorusPatch { min: DVec2::new(0.0, 0.25), max: DVec2::new(0.5, 0.75), tube: 0.45, kind };
    Surface::new(vec![Box::new(patch)], vec![]).unwrap()
}
