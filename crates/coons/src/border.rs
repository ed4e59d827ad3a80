//! Border curves made for the user.

use std::sync::Arc;

use glam::DVec3;
use suture_bernstein::BezierCurve;

use crate::certificate::corner_jets;
use crate::constituent::Constituent;
use crate::curve::{BorderCurve, hermite};
use crate::error::{CoonsError, NAMES};
use crate::options::Order;

/// The border curve on side `u` that joins `C^k` with both surfaces: the Hermite curve of degree `2k + 1` from their jets across the
/// edges, `r1` at `v = 0` and `r2` at `v = 1`.
///
/// # Errors
/// [`CoonsError::NoThirdDerivatives`] for `k = 3`, [`CoonsError::Net`] when a jet is not finite.
pub fn border_curve(
    r: &[Arc<dyn Constituent>; 2],
    u: f64,
    k: usize,
) -> Result<BezierCurve<DVec3>, CoonsError> {
    let k = k.min(3);
    let ends = [0, 1].map(|edge| {
        let jets = corner_jets(r[edge].as_ref(), u, edge as f64);
        let missing = CoonsError::NoThirdDerivatives { what: NAMES[edge], asked: Order::parametric(k) };
        jets[..=k].iter().copied().collect::<Option<Vec<_>>>().ok_or(missing)
    });
    let [start, end] = ends;
    hermite(&start?, &end?)
        .map_err(|source| CoonsError::Net { what: format!("the border curve at u = {u}"), source })
}

/// Both border curves, so that a gap takes two surfaces and nothing else.
///
/// # Errors
/// As [`border_curve`].
pub fn border_curves(
    r: &[Arc<dyn Constituent>; 2],
    order: Order,
) -> Result<[Arc<dyn BorderCurve>; 2], CoonsError> {
    let k = order.derivatives();
    Ok([Arc::new(border_curve(r, 0.0, k)?), Arc::new(border_curve(r, 1.0, k)?)])
}
