//! What can be chosen.

use serde::{Deserialize, Serialize};

use crate::ApatchError;

/// Where the weight of every apex comes from: the one free number per face and side (`f₀₀₀₃`). It is raised where the surface would
/// otherwise not be single-sheeted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ApexWeight {
    /// The quadratic that the face suggests, fitted to the neighbours' opposite vertices and gradients there: quadrics are
    /// reproduced. The default.
    #[default]
    Neighbours,
    /// The linear function that comes closest: the default of the paper. Flatter; no quadric but planes is reproduced.
    Paper,
    /// One weight per face of the input mesh, for the positive side; its negative on the other. Large weights press the surface to
    /// the face. Where faces are divided, their parts inherit the weight.
    Given(Vec<f64>),
}

/// How the surface is built.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ApatchOptions {
    /// Where apex weights come from.
    pub weight: ApexWeight,
    /// Slopes of edges below this, relative to the length of the edge and of the gradient, count as zero: plane faces are planes in
    /// spite of rounding. In `[0, 1e-3]`. Default `1e-12`.
    pub snap: f64,
    /// Least height of a tetrahedron over the tangent planes, in units of the square root of the area of its face; in `(0, 1]`.
    /// Default 0.05, as in the paper.
    pub clearance: f64,
    /// Least sine of the angle between an apex direction and the tangent planes; below it other directions are tried. In `(0, 0.5]`.
    /// Default 0.05.
    pub steepness: f64,
    /// How far weights stay above their lower bound, relative to the largest height coefficient of the face; in `(0, 10]`.
    /// Default 0.02: at the bound itself two sheets touch.
    pub margin: f64,
    /// Rounds of local refinement by modified Butterfly where tetrahedra intersect their neighbours or normals are too steep;
    /// at most 8. Default 4: few faces are touched, and each round leaves fewer.
    pub refinements: usize,
    /// Whether the normals were estimated, so that they may be estimated again: at the ends of turned edges, and where they are against a
    /// face and another direction is not. Default false: normals are data.
    pub estimated: bool,
    /// Cells per face or edge that the proof of single-sheetedness may examine, `1..=1_000_000`. Default 2048.
    pub cells: usize,
    /// Whether tetrahedra that are not neighbours are tested for intersections, for the report only. Default true.
    pub intersections: bool,
}

impl Default for ApatchOptions {
    fn default() -> Self {
        Self {
            weight: ApexWeight::default(),
            snap: 1e-12,
            clearance: 0.05,
            steepness: 0.05,
            margin: 0.02,
            refinements: 4,
            estimated: false,
            cells: 2048,
            intersections: true,
        }
    }
}

impl ApatchOptions {
    pub(crate) fn check(&self, faces: usize) -> Result<(), ApatchError> {
        let ranges = [
            ("snap", self.snap, (0.0..=1e-3).contains(&self.snap), "0..=0.001"),
            ("clearance", self.clearance, self.clearance > 0.0 && self.clearance <= 1.0, "(0, 1]"),
            ("steepness", self.steepness, self.steepness > 0.0 && self.steepness <= 0.5, "(0, 0.5]"),
            ("margin", self.margin, self.margin > 0.0 && self.margin <= 10.0, "(0, 10]"),
            ("refinements", self.refinements as f64, self.refinements <= 8, "0..=8"),
            ("cells", self.cells as f64, (1..=1_000_000).contains(&self.cells), "1..=1000000"),
        ];
        if let Some((name, value, _, range)) = ranges.into_iter().find(|r| !r.2) {
            return Err(ApatchError::Option { name, value, range });
        }
        if let ApexWeight::Given(weights) = &self.weight {
            if weights.len() != faces {
                return Err(ApatchError::WeightCount { given: weights.len(), faces });
            }
            if let Some(face) = weights.iter().position(|w| !w.is_finite()) {
                return Err(ApatchError::Weight { face, value: weights[face] });
            }
        }
        Ok(())
    }
}
