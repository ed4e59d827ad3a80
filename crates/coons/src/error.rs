//! Why a fill is refused.

use glam::DVec3;
use suture_bernstein::NetError;
use suture_surface::SurfaceError;

use crate::options::Order;

/// Why a fill is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CoonsError {
    /// A constituent or a curve is not finite where it is needed.
    #[error(
        "{what} is not finite at ({u}, {v}): {value}; check the input, or replace the surface by a ribbon if it ends there"
    )]
    NotFinite {
        /// Which constituent or curve: `r1`, `r2`, `r3`, `r4`.
        what: &'static str,
        /// Parameter.
        u: f64,
        /// Parameter.
        v: f64,
        /// What was found.
        value: DVec3,
    },
    /// A parameter outside `[0, 1]²`.
    #[error("({u}, {v}) lies outside the unit square, where a fill is not defined")]
    Outside {
        /// Parameter.
        u: f64,
        /// Parameter.
        v: f64,
    },
    /// Everything lies in one point.
    #[error("the sides of the gap have no extent (diagonal {diagonal:e}); there is nothing to fill")]
    NoExtent {
        /// Diagonal of the bounding box.
        diagonal: f64,
    },
    /// A border curve does not join a surface at a corner as smoothly as asked for.
    #[error(
        "at the corner v = {edge}, u = {side} derivative {order} of the border curve misses that of the surface by {size:e} of the \
         diagonal, more than {limit:e}; change the curve, ask for a lower order, or ask for repair"
    )]
    Corner {
        /// The edge: 0 for `v = 0` (`r1`), 1 for `v = 1` (`r2`).
        edge: u8,
        /// The side: 0 for `u = 0` (`r3`), 1 for `u = 1` (`r4`).
        side: u8,
        /// Order of the derivative.
        order: usize,
        /// Length of the difference over the diagonal.
        size: f64,
        /// What is allowed.
        limit: f64,
    },
    /// The surfaces of a three-sided hole do not join along an edge as asked for.
    #[error(
        "along {edge} derivative {order} of the fill misses that of its neighbour by {size:e} of the diagonal at parameter {at}, \
         more than {limit:e}; change the third surface or ask for a lower order"
    )]
    Edge {
        /// The edge, `v = 0`, `v = 1` or `u = 1`.
        edge: &'static str,
        /// Order of the derivative.
        order: usize,
        /// Where it is largest.
        at: f64,
        /// Size over the diagonal.
        size: f64,
        /// What is allowed.
        limit: f64,
    },
    /// A border curve leaves a surface backwards or along its edge: the fill would fold (erratum E5, E6).
    #[error(
        "at v = {edge}, u = {side} the fill would run with speed {speed:e} (of the surface's own) across the edge: it folds back; \
         turn the border curve round"
    )]
    Folds {
        /// The edge, as in [`Corner`](Self::Corner).
        edge: u8,
        /// Parameter along the edge.
        side: f64,
        /// Factor between the directions; positive for a fill that continues its surface.
        speed: f64,
    },
    /// The fill folds at the tip of a three-sided hole (erratum E7).
    #[error(
        "at the tip the fill folds or has no tangent plane: (U × U')·n = {value:e} at v = {at}, turning {turning} rad; the two \
         surfaces must run round the tip in one direction, by less than a full turn"
    )]
    Tip {
        /// Parameter along the degenerate edge.
        at: f64,
        /// Smallest `(U × U')·n` over `|U|²`.
        value: f64,
        /// Total turning of `U` in radians.
        turning: f64,
    },
    /// A three-sided hole whose edge `u = 0` is not a point.
    #[error(
        "edge u = 0 of {what} is not one point: it extends over {size:e} of the diagonal; use a four-sided fill"
    )]
    NoTip {
        /// `r1` or `r2`.
        what: &'static str,
        /// Extent over the diagonal.
        size: f64,
    },
    /// An order for which the three-sided formula has no theorem.
    #[error(
        "{asked:?} is not offered for three-sided holes, which join C0, C1, C2 or G1: the third surface is given, not reparametrised, \
         and no condition for {asked:?} is known; ask for C2 or G1"
    )]
    ThreeSidedOrder {
        /// What was asked for.
        asked: Order,
    },
    /// The blend functions are not flat enough for the order asked for.
    #[error("the blend is flat of order {flat}, {asked:?} needs {}; take another blend function", asked.derivatives())]
    Blend {
        /// Its order.
        flat: usize,
        /// What was asked for.
        asked: Order,
    },
    /// Third derivatives are needed and not known.
    #[error("{what} knows no third derivatives, which {asked:?} needs; ask for C2, or implement `expand`")]
    NoThirdDerivatives {
        /// Which constituent or curve.
        what: &'static str,
        /// What was asked for.
        asked: Order,
    },
    /// A net that is not one.
    #[error("{what}: {source}")]
    Net {
        /// Where.
        what: String,
        /// Why.
        #[source]
        source: NetError,
    },
    /// A hole with too few or too many sides.
    #[error(
        "a hole of {sides} sides; holes of 4 to 8 sides are split around a centre, 2 and 3 have fills of their own"
    )]
    Sides {
        /// How many.
        sides: usize,
    },
    /// The sides of a hole do not follow each other.
    #[error("side {side} ends {size:e} of the diagonal away from the start of side {}; order the sides round the hole", (side + 1) % sides)]
    Chain {
        /// The side.
        side: usize,
        /// Number of sides.
        sides: usize,
        /// Distance over the diagonal.
        size: f64,
    },
    /// The scene is not JSON of the documented form.
    #[error("the scene is malformed: {0}")]
    Json(#[from] serde_json::Error),
    /// The scene names something that does not exist or cannot be.
    #[error("{what}: {reason}")]
    Scene {
        /// The place in the scene.
        what: String,
        /// What is wrong and what to do.
        reason: String,
    },
    /// No gap was found.
    #[error(
        "no gap was found between the {edges} open edges of the surface; name the two edges, or raise the largest width {limit}"
    )]
    NoGap {
        /// Number of open edges.
        edges: usize,
        /// Largest width over the length of the edge.
        limit: f64,
    },
    /// An edge that cannot be continued.
    #[error("edge {edge} of patch {patch} cannot be filled at: {reason}")]
    OpenEdge {
        /// The patch.
        patch: usize,
        /// The edge.
        edge: usize,
        /// Why.
        reason: &'static str,
    },
    /// The product's patches and seams do not fit.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

/// Names of the constituents and curves in errors.
pub(crate) const NAMES: [&str; 4] = ["r1", "r2", "r3", "r4"];
