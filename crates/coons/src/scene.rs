//! Scenes: surfaces, and the gaps and holes between them, as JSON.
//!
//! ```json
//! {
//!   "schema": 1,
//!   "surfaces": {
//!     "pipe":  { "analytic": { "type": "cylinder", "radius": 1 }, "domain": [[0, -2], [1.5, -1]] },
//!     "plate": { "bezier": { "degree": [1, 1], "net": [[1, 0, 1], [1, 0, 2], [0, 1, 1], [0, 1, 2]] } }
//!   },
//!   "fills": [
//!     { "type": "gap", "between": [{ "surface": "pipe", "edge": 2 }, { "surface": "plate", "edge": 3 }], "order": "C2" }
//!   ]
//! }
//! ```
//!
//! * `surfaces`: by name, each with one of
//!   `analytic` — [`Analytic`]: `type` (`plane`, `cylinder`, `cone`, `sphere`, `ellipsoid`, `torus`, `swept`, `bulges`), its numbers, and the
//!   frame `origin`, `x`, `y`, `z`; needs `domain`, the rectangle of its parameters `[[a0, b0], [a1, b1]]` that is there;
//!   `spline` — `degree`, `knots`, `net` of a tensor-product B-spline, second index fastest;
//!   `bezier` — `degree`, `net`. Both take their own domain when there is none.
//! * `fills`, each with `type`:
//!   * `gap`: `between` two edges. Edge 0 is the lower one (second parameter smallest), then counter-clockwise 1, 2, 3. `reach` is the speed
//!     across the edge in parameters of the surface per width of the gap (default: as fast as the gap is wide); `extension` is `natural`
//!     (the surface itself beyond its edge, default), `ribbon` (the polynomial of its boundary jets) or `reflected`.
//!     `curves`: two border curves ([`CurveData`]) or `null` for curves made here.
//!   * `four_sided`, `three_sided`: `r`, the constituents of the formula as they are: each a `surface` with an affine map of its parameters,
//!     `origin + u (first) + v (second)`, `drawn` as far as given beside the gap; and `curves` for four sides.
//!   * `hole`: `sides`, 4 to 8 edges, walked against their own direction (so that the hole is on the left): each of them starts where the
//!     next one ends.
//!
//!   Each but the last may name its own `order` (`C0` … `C3`, `G1`, `G2`). A scene without fills asks for gaps to be found
//!   ([`Scene::with_gaps`]).
//! * `blend`: family of blend functions, `polynomial`, `trigonometric`, `rational` or `symmetric_rational`.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_bernstein::{BSplineSurface, BezierPatch};

use crate::analytic::Analytic;
use crate::blend::Family;
use crate::curve::CurveData;
use crate::error::CoonsError;
use crate::options::Order;

/// Number of the schema that is read.
pub const SCHEMA: u64 = 1;

/// Surfaces and what to fill between them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// [`SCHEMA`].
    pub schema: u64,
    /// The surfaces by name.
    pub surfaces: BTreeMap<String, SceneSurface>,
    /// What to fill. Nothing: the gaps that are found ([`Scene::with_gaps`]).
    #[serde(default)]
    pub fills: Vec<SceneFill>,
    /// Family of blend functions, instead of the one that the caller has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blend: Option<Family>,
}

/// A surface of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneSurface {
    /// The surface.
    #[serde(flatten)]
    pub geometry: Geometry,
    /// Lower and upper corner of the parameters that are there.
    #[serde(default)]
    pub domain: Option<[DVec2; 2]>,
}

/// The form of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Geometry {
    /// An analytic surface.
    Analytic(Analytic),
    /// A B-spline surface.
    Spline(BSplineSurface<DVec3>),
    /// A Bézier patch.
    Bezier(BezierPatch<DVec3>),
}

/// How a surface is continued over the gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Extension {
    /// By itself.
    #[default]
    Natural,
    /// By the polynomial of its boundary jets.
    Ribbon,
    /// By reflection of its inside.
    Reflected,
}

/// An edge of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneEdge {
    /// Name of the surface.
    pub surface: String,
    /// 0 to 3, counter-clockwise from the lower edge.
    pub edge: u8,
    /// Parameters across the edge per width of the gap.
    #[serde(default)]
    pub reach: Option<f64>,
    /// How it is continued.
    #[serde(default)]
    pub extension: Extension,
}

impl SceneEdge {
    /// The edge with defaults for the rest.
    pub fn new(surface: &str, edge: u8) -> Self {
        Self { surface: surface.into(), edge, reach: None, extension: Extension::default() }
    }
}

/// A constituent as it stands in the formula.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneConstituent {
    /// Name of the surface.
    pub surface: String,
    /// Parameters of the surface at `(0, 0)`.
    pub origin: DVec2,
    /// What a unit of `u` adds.
    pub u: DVec2,
    /// What a unit of `v` adds.
    pub v: DVec2,
    /// How far it is drawn beside the gap, in units of the parameter across.
    #[serde(default = "one")]
    pub drawn: f64,
}

fn one() -> f64 {
    1.0
}

/// One thing to fill.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum SceneFill {
    /// A gap between two edges.
    Gap {
        /// The edges.
        between: [SceneEdge; 2],
        /// Border curves from the first to the second edge: at the end of the first edge (which the fill has at `u = 0`), then at its start.
        #[serde(default)]
        curves: [Option<CurveData>; 2],
        /// Instead of the order asked for the whole scene.
        #[serde(default)]
        order: Option<Order>,
    },
    /// Equation 1 as it stands.
    FourSided {
        /// `r1`, `r2`.
        r: [SceneConstituent; 2],
        /// `r3`, `r4`.
        #[serde(default)]
        curves: [Option<CurveData>; 2],
        /// As for a gap.
        #[serde(default)]
        order: Option<Order>,
    },
    /// Equation 2 as it stands.
    ThreeSided {
        /// `r1`, `r2`, `r3`.
        r: [SceneConstituent; 3],
        /// As for a gap.
        #[serde(default)]
        order: Option<Order>,
    },
    /// A hole of 4 to 8 sides.
    Hole {
        /// The edges around it.
        sides: Vec<SceneEdge>,
    },
}

impl SceneFill {
    /// A gap with border curves made here.
    pub fn between(a: SceneEdge, b: SceneEdge) -> Self {
        Self::Gap { between: [a, b], curves: [None, None], order: None }
    }
}

/// Reads a scene.
///
/// # Errors
/// [`CoonsError::Json`] with line and column; [`CoonsError::Scene`] for another schema.
pub fn read(json: &str) -> Result<Scene, CoonsError> {
    #[derive(Deserialize)]
    struct Head {
        schema: u64,
    }
    // The schema first: a file of another one would be called malformed for the wrong reason.
    let head: Head = serde_json::from_str(json)?;
    if head.schema != SCHEMA {
        let reason = format!("{} is not {SCHEMA}, the one that is read", head.schema);
        return Err(CoonsError::Scene { what: "schema".into(), reason });
    }
    Ok(serde_json::from_str(json)?)
}
