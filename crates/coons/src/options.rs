//! What is asked of a fill.

use serde::{Deserialize, Serialize};
use suture_surface::Continuity;

use crate::blend::Family;

/// How smoothly a fill is to join the surfaces beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Order {
    /// Positions agree.
    C0,
    /// First derivatives agree.
    C1,
    /// First and second derivatives agree.
    #[default]
    C2,
    /// Derivatives to third order agree.
    C3,
    /// Tangent planes agree: border curves may leave at any speed, and aslant.
    G1,
    /// Curvatures agree, as G1.
    G2,
}

impl Order {
    /// Number of derivatives that agree (after a change of parameters for G1 and G2).
    pub fn derivatives(self) -> usize {
        match self {
            Self::C0 => 0,
            Self::C1 | Self::G1 => 1,
            Self::C2 | Self::G2 => 2,
            Self::C3 => 3,
        }
    }

    /// Whether the agreement is after a change of parameters.
    pub fn geometric(self) -> bool {
        matches!(self, Self::G1 | Self::G2)
    }

    /// What a seam of the surface claims; there is no name for C³ there.
    pub fn claimed(self) -> Continuity {
        match self {
            Self::C0 => Continuity::C0,
            Self::C1 => Continuity::C1,
            Self::C2 | Self::C3 => Continuity::C2,
            Self::G1 => Continuity::G1,
            Self::G2 => Continuity::G2,
        }
    }

    /// `C^k` for `k ≤ 3`.
    pub fn parametric(k: usize) -> Self {
        [Self::C0, Self::C1, Self::C2, Self::C3][k.min(3)]
    }
}

impl std::str::FromStr for Order {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        Ok(match s {
            "C0" => Self::C0,
            "C1" => Self::C1,
            "C2" => Self::C2,
            "C3" => Self::C3,
            "G1" => Self::G1,
            "G2" => Self::G2,
            _ => return Err(format!("{s:?} is none of C0, C1, C2, C3, G1, G2")),
        })
    }
}

/// What is asked of a fill.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FillOptions {
    /// How smoothly to join. Default C².
    pub order: Order,
    /// Largest corner difference that counts as none, over the diagonal of the gap (derivatives per unit parameter). Default `1e-9`:
    /// far above rounding, far below what can be seen.
    pub tolerance: f64,
    /// Move border curves that do not join as asked for, and say how far. Default no: input is refused, not changed silently.
    pub repair: bool,
    /// Family of blend functions. Default polynomial: exact end jets, smallest derivatives.
    pub family: Family,
}

impl Default for FillOptions {
    fn default() -> Self {
        Self { order: Order::C2, tolerance: 1e-9, repair: false, family: Family::Polynomial }
    }
}
