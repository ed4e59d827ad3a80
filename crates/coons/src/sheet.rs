//! Given surfaces as patches.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, SplinePool};

use crate::constituent::Constituent;
use crate::record;

/// A rectangle of a given surface, as a patch beside the fills.
#[derive(Clone, Debug)]
pub struct SheetPatch {
    pub(crate) sheet: Arc<dyn Constituent>,
    pub(crate) domain: [DVec2; 2],
}

impl SheetPatch {
    /// The part of `sheet` over the rectangle from `domain[0]` to `domain[1]`; `None` unless that is finite and not empty.
    pub fn new(sheet: Arc<dyn Constituent>, domain: [DVec2; 2]) -> Option<Self> {
        let [a, b] = domain;
        (a.is_finite() && b.is_finite() && a.x < b.x && a.y < b.y).then_some(Self { sheet, domain })
    }

    /// The surface.
    pub fn sheet(&self) -> &Arc<dyn Constituent> {
        &self.sheet
    }
}

impl Patch for SheetPatch {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: self.domain[0], max: self.domain[1] }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        self.sheet.jet(at)
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Given
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        record::given(self, pool)
    }

    /// Where one parameter line shrinks to a point, the limit from the side that the domain lies on.
    fn normal(&self, at: DVec2) -> Option<DVec3> {
        let jet = self.jet(at);
        let [min, max] = self.domain;
        // f_v ≈ h f_uv a step h inside u, and alike for f_u.
        let towards = |x: f64, low: f64, high: f64| if x - low < high - x { 1.0 } else { -1.0 };
        let u = Jet2 { dv: jet.duv * towards(at.x, min.x, max.x), ..jet };
        let v = Jet2 { du: jet.duv * towards(at.y, min.y, max.y), ..jet };
        jet.normal().or_else(|| u.normal()).or_else(|| v.normal())
    }
}
