//! What may be chosen, and why the defaults are what they are.

use serde::{Deserialize, Serialize};

use crate::{EnergyOrder, FitError};

/// How close the surface must come to the vertices of the segment; both relative to the diagonal of the whole mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Root mean square distance. Default 2e-4.
    pub rms: f64,
    /// Largest distance. Default 1e-3.
    pub max: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { rms: 2e-4, max: 1e-3 }
    }
}

/// How λ is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Smoothing {
    /// Generalised cross validation with the degrees of freedom multiplied by `gamma`, over half decades above the floor.
    /// Default with 1.4: within 4 % of the best λ (median) on noisy data; 1.0 undersmooths.
    Gcv {
        /// Factor of the degrees of freedom, at least 1.
        gamma: f64,
    },
    /// `(0.3 + 0.7 tr H² / n) GCV₁` (Lukas 2006): as good on noise, closer to the best λ on clean data.
    RobustGcv,
    /// The floor itself: no search. For clean data, when speed matters.
    Floor,
    /// Floater's 1998 constant η (≈ 0.1 for `m = 2`, 0.01 for `m = 3`): smooths less and less as knots are added. A diagnostic.
    Floater,
    /// This dimensionless λ, whatever the floor says.
    Fixed(f64),
    /// Known noise per coordinate, relative to the diagonal of the mesh: the largest λ whose RMS does not exceed it.
    /// (The parameters follow the tangential noise, so that the target is σ, not σ√3.)
    Noise(f64),
}

impl Default for Smoothing {
    fn default() -> Self {
        Self::Gcv { gamma: 1.4 }
    }
}

/// What decides when smoothing and tolerance disagree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// The data: where λ says that the residual is noise, the fit ends and reports it. Default.
    #[default]
    Data,
    /// The tolerance: λ is lowered to the floor, then knots are added.
    Tolerance,
}

/// Knot spacing. Lengths in units of the median edge `e` of the chart in its parameter plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knots {
    /// First spacing. Default √2: about half a coefficient per vertex. Twice the cells' area would hold the tolerance of
    /// positions on smooth meshes as well, but doubles the error of their curvature (torus: 3 % for 6 %).
    pub start: f64,
    /// Smallest spacing. Default 1: below, the residual only measures interpolation.
    pub finest: f64,
    /// Factor from round to round, at least 1.05. Default √2: doubles the coefficients.
    pub ratio: f64,
    /// Largest number of coefficients of the rectangle. Default 65 000: the range that was measured.
    pub limit: usize,
    /// Use exactly this many cells in `u` and `v`, one round. Default none.
    pub cells: Option<[usize; 2]>,
}

impl Default for Knots {
    fn default() -> Self {
        Self {
            start: std::f64::consts::SQRT_2,
            finest: 1.0,
            ratio: std::f64::consts::SQRT_2,
            limit: 65_000,
            cells: None,
        }
    }
}

/// Everything that may be chosen; `FitOptions::default()` is the recommended recipe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FitOptions {
    /// When a fit is good enough.
    pub tolerance: Tolerance,
    /// The energy.
    pub order: EnergyOrder,
    /// The choice of λ.
    pub smoothing: Smoothing,
    /// What wins when smoothing and tolerance disagree.
    pub mode: Mode,
    /// The knots.
    pub knots: Knots,
    /// Smallest stiffness `η = λ (a / h²)ᵐ`. Default 1e-4: no explosion outside the data, best largest curvature; 1e-5 lowers
    /// the RMS of smooth clean charts by 10–30 %.
    pub floor: f64,
    /// Rounds of foot points and refit. Default 2: they get most of the gain; more do not help the shape.
    pub corrections: usize,
    /// No correction when the noise estimate exceeds this many median edges. Default 1: what looks like noise of a tenth of
    /// an edge is mostly parameters that do not fit (coarse clean meshes: correcting them lowers the RMS by factors of 2 to 5,
    /// a noisy sphere is none the worse).
    pub correction_noise: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::default(),
            order: EnergyOrder::default(),
            smoothing: Smoothing::default(),
            mode: Mode::default(),
            knots: Knots::default(),
            floor: 1e-4,
            corrections: 2,
            correction_noise: 1.0,
        }
    }
}

impl FitOptions {
    /// No search for λ: three edges per cell, the floor, refined until the tolerance holds. For clean meshes.
    pub fn fast() -> Self {
        Self {
            smoothing: Smoothing::Floor,
            knots: Knots { start: 3.0, ..Knots::default() },
            ..Self::default()
        }
    }

    /// Refuses values outside their range.
    pub(crate) fn check(&self) -> Result<(), FitError> {
        let positive = |name, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(FitError::Value { name, value, expected: "positive and finite" }),
        };
        positive("tolerance.rms", self.tolerance.rms)?;
        positive("tolerance.max", self.tolerance.max)?;
        positive("floor", self.floor)?;
        positive("knots.start", self.knots.start)?;
        positive("knots.finest", self.knots.finest)?;
        // Smaller steps than this could take rounds without end.
        if !(self.knots.ratio >= 1.05 && self.knots.ratio.is_finite()) {
            let value = self.knots.ratio;
            return Err(FitError::Value { name: "knots.ratio", value, expected: "at least 1.05 and finite" });
        }
        if self.knots.limit < 16 || self.knots.limit > 4_000_000 {
            let value = self.knots.limit as f64;
            return Err(FitError::Value { name: "knots.limit", value, expected: "from 16 to 4 000 000" });
        }
        if let Some([p, q]) = self.knots.cells {
            let coefficients = p.saturating_add(3).saturating_mul(q.saturating_add(3));
            if p == 0 || q == 0 || coefficients > self.knots.limit {
                let expected = "at least 1 cell in either direction and (P + 3)(Q + 3) <= knots.limit";
                return Err(FitError::Value { name: "knots.cells", value: coefficients as f64, expected });
            }
        }
        if self.correction_noise.is_nan() || self.correction_noise < 0.0 {
            let value = self.correction_noise;
            return Err(FitError::Value { name: "correction_noise", value, expected: "not negative" });
        }
        match self.smoothing {
            Smoothing::Gcv { gamma } if !(gamma >= 1.0 && gamma.is_finite()) => {
                Err(FitError::Value { name: "gamma", value: gamma, expected: "at least 1 and finite" })
            }
            Smoothing::Fixed(lambda) => positive("lambda", lambda),
            Smoothing::Noise(sigma) => positive("sigma", sigma),
            _ => Ok(()),
        }
    }
}
