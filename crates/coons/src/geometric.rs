//! Constituents in parameters that border curves of any speed and direction fit: G¹ and G² from C¹ and C².

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::constituent::{Constituent, Map, Mapped};
use crate::curve::BorderCurve;
use crate::error::CoonsError;

/// Reparametrises both constituents near their edges so that the border curves leave them like parameter lines, as far as that is
/// possible (specification §2.4): a fill that is `C^k` with the result is `G^k` with the surfaces. What is left of the curves'
/// derivatives points out of the tangent plane, and the corner certificate finds it.
///
/// # Errors
/// [`CoonsError::Folds`] where a curve leaves backwards or along the edge.
pub(crate) fn reparametrise(
    r: &[Arc<dyn Constituent>; 2],
    borders: &[Arc<dyn BorderCurve>; 2],
    k: usize,
) -> Result<[Arc<dyn Constituent>; 2], CoonsError> {
    Ok([reparametrise_edge(&r[0], borders, 0, k)?, reparametrise_edge(&r[1], borders, 1, k)?])
}

/// One of the two.
pub(crate) fn reparametrise_edge(
    r: &Arc<dyn Constituent>,
    borders: &[Arc<dyn BorderCurve>; 2],
    edge: u8,
    k: usize,
) -> Result<Arc<dyn Constituent>, CoonsError> {
    let v = f64::from(edge);
    let (mut psi, mut lambda, mut chi, mut kappa) = ([0.0; 2], [1.0; 2], [0.0; 2], [0.0; 2]);
    for side in 0..2 {
        let u = side as f64;
        let j = r.jet(DVec2::new(u, v));
        let [_, d, dd] = borders[side].jet(v);
        (psi[side], lambda[side]) = in_plane(j.du, j.dv, d);
        if !(lambda[side] > 0.0) {
            return Err(CoonsError::Folds { edge, side: u, speed: lambda[side] });
        }
        if k >= 2 {
            let (p, l) = (psi[side], lambda[side]);
            let rest = dd - j.duu * (p * p) - j.duv * (2.0 * p * l) - j.dvv * (l * l);
            (chi[side], kappa[side]) = in_plane(j.du, j.dv, rest);
        }
    }
    let map = Map::Edge { at: v, psi, lambda, chi, kappa };
    Ok(Arc::new(Mapped { inner: Arc::clone(r), map }))
}

/// `(a, b)` with `a x + b y` nearest to `d`; NaN when `x` and `y` are parallel.
fn in_plane(x: DVec3, y: DVec3, d: DVec3) -> (f64, f64) {
    let n = x.cross(y);
    let nn = n.length_squared();
    (d.cross(y).dot(n) / nn, x.cross(d).dot(n) / nn)
}

/// The direction in which a fill made by Remark 2 leaves a ruled surface: `k(u) ρ(u)`, positive for a fill that continues it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuledEdge {
    /// Smallest `k(u) ρ(u)` over `max ρ²`; the fill folds unless it is positive (erratum E5).
    pub smallest: f64,
    /// Where.
    pub at: f64,
    /// Largest sine of the angle between `f_v` and the ruling: zero when the surface is ruled as the remark needs it and the curves
    /// leave along the rulings.
    pub aslant: f64,
}

/// What Remark 2 of the paper asks of a ruled edge and, by erratum E5, leaves out: `f_v = (1 − A) r3' + A r4' + (r_v − (1 − A) r_v(0) − A
/// r_v(1))` must be a positive multiple of the ruling `r_v` along the whole edge `v = edge`. Measured at 257 points.
///
/// # Errors
/// [`CoonsError::Folds`] when it is not positive.
pub fn remark_2(
    r: &dyn Constituent,
    borders: [&dyn BorderCurve; 2],
    alpha: &dyn crate::Blend,
    edge: u8,
) -> Result<RuledEdge, CoonsError> {
    let v = f64::from(edge.min(1));
    let ruling = |u: f64| r.jet(DVec2::new(u, v)).dv;
    let deltas = [0, 1].map(|s: usize| borders[s].jet(v)[1] - ruling(s as f64));
    let mut result = RuledEdge { smallest: f64::INFINITY, at: 0.0, aslant: 0.0 };
    let mut scale = 0.0f64;
    for i in 0..=256 {
        let u = f64::from(i) / 256.0;
        let (rho, a) = (ruling(u), alpha.jet(u)[0]);
        let f = rho + deltas[0] * (1.0 - a) + deltas[1] * a;
        scale = scale.max(rho.length_squared());
        let product = f.dot(rho);
        if !(product >= result.smallest) {
            (result.smallest, result.at) = (product, u);
        }
        result.aslant = result.aslant.max(f.cross(rho).length() / (f.length() * rho.length()));
    }
    result.smallest /= scale;
    if result.smallest > 0.0 {
        Ok(result)
    } else {
        Err(CoonsError::Folds { edge, side: result.at, speed: result.smallest })
    }
}
