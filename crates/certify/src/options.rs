//! How much is sampled and what counts as joined.

use serde::{Deserialize, Serialize};

use crate::CertifyError;

/// How densely seams and patches are sampled, and which jumps count as none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CertifyOptions {
    /// Samples that every seam starts with, clustered towards its ends (Chebyshev–Lobatto points), `3..=4097`. Six more lie at
    /// `2⁻¹⁰`, `2⁻²⁰`, `2⁻³⁰` from the ends: corners are where blends go wrong, and samples of the inside alone understate them.
    /// Default 17: resolves every polynomial of degree 16.
    pub samples: usize,
    /// How often the intervals beside the worst sample of every measure are halved, `0..=52`. Default 8: the place of a maximum is
    /// known to about `2⁻¹²` of the seam, a smooth maximum itself to `2⁻²⁴` of its height.
    pub refinements: usize,
    /// Patches are sampled at about the square of this number of points for regularity and curvature, `1..=1024`. Default 8.
    pub interior: usize,
    /// Jumps up to these count as none.
    pub limits: Limits,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self { samples: 17, refinements: 8, interior: 8, limits: Limits::default() }
    }
}

/// Largest jumps that count as rounding.
///
/// A surface that joins exactly shows what the evaluation rounds: some `1e-15` in position, ten times that in the normal, and in
/// curvature `1e-16` times the square of (diagonal / width of the narrowest patch), `1e-11` for strips of one percent. The defaults
/// lie a few orders above that and still far below what a mistake in a map, a basis or a knot leaves behind, or any eye or tool sees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Gap relative to the diagonal. Default `1e-10`.
    pub position: f64,
    /// Angle between the normals in radians. Default `1e-8`.
    pub normal: f64,
    /// Jump of the shape operator relative to the largest curvature beside it. Default `1e-6`.
    pub curvature: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { position: 1e-10, normal: 1e-8, curvature: 1e-6 }
    }
}

impl CertifyOptions {
    pub(crate) fn check(&self) -> Result<(), CertifyError> {
        let counts = [
            ("samples", self.samples, 3, 4097),
            ("refinements", self.refinements, 0, 52),
            ("interior", self.interior, 1, 1024),
        ];
        for (name, value, least, most) in counts {
            if !(least..=most).contains(&value) {
                return Err(CertifyError::Option { name, value, least, most });
            }
        }
        let limits = [
            ("position", self.limits.position),
            ("normal", self.limits.normal),
            ("curvature", self.limits.curvature),
        ];
        for (name, value) in limits {
            if value.is_nan() || value < 0.0 {
                return Err(CertifyError::Limit { name, value });
            }
        }
        Ok(())
    }
}
