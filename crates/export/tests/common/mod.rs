//! Patches on shared B-splines, with a loader.
#![allow(dead_code, unreachable_pub)] // Every test file uses its part of this one.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;
use suture_surface::{
    Continuity, Domain, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, RecordError, Seam, SplinePool,
    Surface,
};

/// A rectangle of a B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    pub spline: Arc<BSplineSurface<DVec3>>,
    pub min: DVec2,
    pub max: DVec2,
    pub kind: PatchKind,
}

impl Patch for Window {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: self.min, max: self.max }
    }
    fn jet(&self, at: DVec2) -> Jet2 {
        self.spline.jet(at)
    }
    fn kind(&self) -> PatchKind {
        self.kind
    }
    fn record(&self, pool: &mut SplinePool) -> Record {
        let spline = pool.index(&self.spline);
        let data =
            serde_json::json!({ "spline": spline, "min": self.min, "max": self.max, "kind": self.kind });
        Record { kind: "test.window".into(), data }
    }
}

pub fn load(record: &Record, pool: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    #[derive(serde::Deserialize)]
    struct Data {
        spline: usize,
        min: DVec2,
        max: DVec2,
        kind: PatchKind,
    }
    let malformed = |reason: String| RecordError::Malformed { kind: record.kind.clone(), reason };
    let data: Data = serde::Deserialize::deserialize(&record.data)
        .map_err(|e: serde_json::Error| malformed(e.to_string()))?;
    let spline =
        pool.get(data.spline).ok_or_else(|| malformed(format!("there is no spline {}", data.spline)))?;
    Ok(Box::new(Window { spline: Arc::clone(spline), min: data.min, max: data.max, kind: data.kind }))
}

/// A biquadratic sheet over `[0, 2] × [0, 1]`, moved and scaled, with coordinates of many digits.
pub fn sheet(scale: f64, shift: DVec3) -> Arc<BSplineSurface<DVec3>> {
    let net = (0..4)
        .flat_map(|i| (0..3).map(move |j| (f64::from(i) * 2.0 / 3.0, f64::from(j) / 2.0)))
        .map(|(x, y)| DVec3::new(x, y, 0.3 * (x * x / 3.0 - y)) * scale + shift)
        .collect();
    let knots = [vec![0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0], vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]];
    Arc::new(BSplineSurface::new([2, 2], knots, net).unwrap())
}

pub fn edge(patch: u32, edge: u32) -> EdgeRef {
    EdgeRef { patch: PatchId(patch), edge }
}

pub fn sewn(patches: Vec<Window>, seams: Vec<Seam>) -> Surface {
    Surface::new(patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect(), seams).unwrap()
}

/// One sheet in two windows of different kinds.
pub fn two(scale: f64, shift: DVec3) -> Surface {
    let spline = sheet(scale, shift);
    let window = |min: DVec2, kind| Window { spline: Arc::clone(&spline), min, max: min + DVec2::ONE, kind };
    let patches = vec![window(DVec2::ZERO, PatchKind::Trimmed), window(DVec2::X, PatchKind::NBlend { n: 5 })];
    sewn(patches, vec![Seam::new(edge(0, 1), edge(1, 3), Continuity::C1)])
}

/// Two unit squares at a right angle along the y axis.
pub fn roof() -> Surface {
    let plane = |a: DVec3, b: DVec3| {
        let knots = || vec![0.0, 0.0, 1.0, 1.0];
        let net = vec![a, a + DVec3::Y, b, b + DVec3::Y];
        let spline = Arc::new(BSplineSurface::new([1, 1], [knots(), knots()], net).unwrap());
        Window { spline, min: DVec2::ZERO, max: DVec2::ONE, kind: PatchKind::Strip { odd: false } }
    };
    let patches = vec![plane(-DVec3::X, DVec3::ZERO), plane(DVec3::ZERO, -DVec3::Z)];
    sewn(patches, vec![Seam::new(edge(0, 1), edge(1, 3), Continuity::C0)])
}
