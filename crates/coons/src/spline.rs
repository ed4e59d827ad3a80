//! Splines evaluated in any number type: Cox and de Boor's and de Casteljau's recursions with expansions or intervals.

use glam::DVec3;
use suture_bernstein::{BSplineCurve, BSplineSurface, bspline};

use crate::real::Real;

/// The `degree + 1` basis functions of the piece that `span` names, at `t`.
fn basis<R: Real>(degree: usize, knots: &[f64], span: usize, t: R) -> Vec<R> {
    let near = &knots[span + 1 - degree..span + 1 + degree];
    let mut b = vec![R::of(1.0)];
    for n in 1..=degree {
        let mut carry = R::of(0.0);
        for (i, x) in b.iter_mut().enumerate() {
            let (lo, hi) = (R::of(near[degree - n + i]), R::of(near[degree + i]));
            let r = (t - lo) * (hi - lo).recip();
            let next = r * *x;
            *x = carry + (hi - t) * (hi - lo).recip() * *x;
            carry = next;
        }
        b.push(carry);
    }
    b
}

fn sum<R: Real>(terms: impl Iterator<Item = (R, DVec3)>) -> [R; 3] {
    terms.fold([R::of(0.0); 3], |s, (b, p)| [0, 1, 2].map(|i| s[i] + b * R::of(p[i])))
}

/// A B-spline curve at `t`.
pub(crate) fn spline_curve<R: Real>(curve: &BSplineCurve<DVec3>, t: R) -> [R; 3] {
    let (p, knots) = (curve.degree(), curve.knots());
    let span = bspline::span(p, knots, t.mid());
    sum(basis(p, knots, span, t).into_iter().zip(curve.net()[span - p..].iter().copied()))
}

/// A Bézier curve at `t`.
pub(crate) fn bezier_curve<R: Real>(net: &[DVec3], t: R) -> [R; 3] {
    let s = R::of(1.0) - t;
    [0, 1, 2].map(|x| {
        let mut b: Vec<R> = net.iter().map(|p| R::of(p[x])).collect();
        for n in (1..b.len()).rev() {
            for i in 0..n {
                b[i] = s * b[i] + t * b[i + 1];
            }
        }
        b.first().copied().unwrap_or(R::of(0.0))
    })
}

/// A B-spline surface at `(u, v)`.
pub(crate) fn spline_surface<R: Real>(surface: &BSplineSurface<DVec3>, u: R, v: R) -> [R; 3] {
    let ([p, q], [ku, kv]) = (surface.degree(), surface.knots());
    let (i, j) = (bspline::span(p, ku, u.mid()), bspline::span(q, kv, v.mid()));
    let (bu, bv) = (basis(p, ku, i, u), basis(q, kv, j, v));
    let columns = surface.count()[1];
    let mut total = [R::of(0.0); 3];
    for (a, x) in bu.into_iter().enumerate() {
        let row = &surface.net()[(i - p + a) * columns + j - q..];
        let inner = sum(bv.iter().copied().zip(row.iter().copied()));
        total = [0, 1, 2].map(|c| total[c] + x * inner[c]);
    }
    total
}
