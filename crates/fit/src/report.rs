//! What a fit says about itself.

use serde::{Deserialize, Serialize};

use crate::EnergyOrder;

/// Why a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// Within tolerance.
    Tolerance,
    /// Not within tolerance at the finest admissible knots: split the segment, lower the area ratio of its chart, or loosen the
    /// tolerance.
    Limit,
    /// Not within tolerance, but λ says that the residual is noise: the vertices scatter by `sigma` around any smooth surface,
    /// and more knots would not help.
    Noise,
}

/// What the guards saw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GuardReport {
    /// How often λ was raised tenfold.
    pub increases: usize,
    /// Samples outside the inflated bounding box in the returned fit.
    pub outside: usize,
    /// Samples inside the chart whose normal opposes the mesh's in the returned fit.
    pub flipped: usize,
    /// Those of them inside the segment itself.
    pub flipped_inside: usize,
    /// Largest distance outside the inflated bounding box, relative to the diagonal.
    pub overshoot: f64,
    /// The cell of the worst sample, if any failed.
    pub cell: Option<[usize; 2]>,
}

impl GuardReport {
    /// Whether every sample passed.
    pub fn passed(&self) -> bool {
        self.outside + self.flipped == 0
    }
}

/// One fit in numbers. Lengths are relative to the diagonal of the whole mesh unless stated otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// Vertices that carry weight.
    pub vertices: usize,
    /// Cells `P × Q`.
    pub cells: [usize; 2],
    /// Coefficients of active cells.
    pub coefficients: usize,
    /// Order of the energy; lower than asked for when the vertices do not determine a quadratic.
    pub order: EnergyOrder,
    /// Knot spacing in median edges of the chart.
    pub spacing: f64,
    /// Dimensionless λ.
    pub lambda: f64,
    /// Stiffness relative to the knots.
    pub eta: f64,
    /// Effective degrees of freedom per vertex, `t / n`.
    pub freedom: f64,
    /// Estimated noise per coordinate; `None` when the degrees of freedom reach the number of vertices. An upper bound without
    /// meaning when λ sits at the floor.
    pub sigma: Option<f64>,
    /// Root mean square distance over the vertices of the segment.
    pub rms: f64,
    /// Largest distance over the vertices of the segment.
    pub max: f64,
    /// The vertex with the largest distance.
    pub worst: usize,
    /// Rounds of knots.
    pub rounds: usize,
    /// Rounds of parameter correction that moved the chart, over all rounds.
    pub corrections: usize,
    /// Why the fit ended.
    pub outcome: Outcome,
    /// What the guards saw.
    pub guard: GuardReport,
}
