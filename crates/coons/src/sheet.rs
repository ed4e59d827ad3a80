//! Given surfaces as patches.

use std::sync::Arc;

use glam::DVec2;
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
}
