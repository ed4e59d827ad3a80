//! The B-spline basis over a knot vector (de Boor, *A Practical Guide to Splines*, 1978; Piegl & Tiller, *The NURBS Book*,
//! 1997, A2.1–A2.3).
//!
//! Knots may repeat any number of times, at the ends as inside: empty intervals are never evaluated.

use crate::{MAX_DEGREE, NetError};

/// Checks a knot vector for `count` basis functions of `degree`.
///
/// # Errors
/// [`NetError::Degree`], [`NetError::Count`], [`NetError::Knots`].
pub fn check(degree: usize, count: usize, knots: &[f64]) -> Result<(), NetError> {
    if degree > MAX_DEGREE {
        return Err(NetError::Degree { degree });
    }
    let needed = count.max(degree + 1).saturating_add(degree + 1);
    if count <= degree || knots.len() != needed {
        return Err(NetError::Count { given: knots.len(), needed });
    }
    if let Some(index) =
        (0..knots.len()).find(|&i| !knots[i].is_finite() || (i > 0 && knots[i] < knots[i - 1]))
    {
        return Err(NetError::Knots { index });
    }
    if knots[degree] >= knots[count] {
        return Err(NetError::Knots { index: count });
    }
    // Every interval that is divided by must be a number.
    if !(knots[needed - 1] - knots[0]).is_finite() {
        return Err(NetError::Knots { index: needed - 1 });
    }
    Ok(())
}

/// Index `k` of the span `knots[k] ≤ t < knots[k + 1]` that evaluates `t`; clamped to the domain, so that parameters outside
/// it are continued by the first or last piece. The upper end of the domain belongs to the last piece, NaN to the first.
///
/// Constant time on uniform knots, a binary search on others.
///
/// # Panics
/// May panic when [`check`] refuses the knots.
#[inline]
pub fn span(degree: usize, knots: &[f64], t: f64) -> usize {
    let count = knots.len() - degree - 1;
    let (first, last) = (knots[degree], knots[count]);
    // On uniform knots this guess fails only within rounding of a knot. The conversion saturates, NaN becomes 0.
    let cell = ((t - first) / (last - first) * (count - degree) as f64) as usize;
    let guess = degree.saturating_add(cell);
    if guess < count && knots[guess] <= t && t < knots[guess + 1] {
        return guess;
    }
    search(degree, &knots[..=count], t)
}

#[cold]
fn search(degree: usize, knots: &[f64], t: f64) -> usize {
    let last = knots[knots.len() - 1];
    // The last knot not above t; beyond the domain the last one below its end, before it the last one at its start.
    let above = if t >= last {
        knots.partition_point(|&k| k < last)
    } else if t > knots[degree] {
        knots.partition_point(|&k| k <= t)
    } else {
        knots.partition_point(|&k| k <= knots[degree])
    };
    above - 1
}

/// Writes value and derivatives to order `D − 1` of the `degree + 1` functions that live on `span` (the functions
/// `span − degree ..= span`) at `t` into `out[0..=degree]`.
///
/// # Panics
/// When `out` is shorter than `degree + 1` or `span` is not one that [`span`] returns.
pub fn jets<const D: usize>(degree: usize, knots: &[f64], span: usize, t: f64, out: &mut [[f64; D]]) {
    unrolled(degree, knots, span, t, out);
}

/// [`jets`], to be inlined where the degree is a constant.
#[inline(always)]
pub(crate) fn unrolled<const D: usize>(
    degree: usize,
    knots: &[f64],
    span: usize,
    t: f64,
    out: &mut [[f64; D]],
) {
    if D == 0 {
        return;
    }
    let out = &mut out[..=degree];
    // The 2p knots that the functions of the span see; interval i of level n is [near[p + i − n], near[p + i]].
    let near = &knots[span + 1 - degree..span + 1 + degree];
    let top = (D - 1).min(degree);
    out[0] = [0.0; D];
    out[0][0] = 1.0;
    // Column 0 climbs to degree p by Cox and de Boor's recursion. Column d leaves it at degree p − d and climbs the rest by
    // N′ = n (N_i/(t_{i+n} − t_i) − N_{i+1}/(t_{i+n+1} − t_{i+1})). (A half-open range unrolls, a closed one does not.)
    for n in 1..degree + 1 {
        let branch = degree + 1 - n;
        if branch <= top {
            out[..n].iter_mut().for_each(|b| b[branch] = b[0]);
        }
        let mut carry = [0.0; D];
        for i in 0..n {
            let (a, b) = (near[degree - n + i], near[degree + i]);
            let width = b - a;
            // A quotient rather than a product with 1/width: exactly 0 and 1 at the ends, so that clamped nets are
            // interpolated to the bit.
            let (r, slope) = ((t - a) / width, n as f64 / width);
            let row = &mut out[i];
            let next = r * row[0];
            row[0] = carry[0] + (1.0 - r) * row[0];
            carry[0] = next;
            for d in 1..D {
                if d >= branch {
                    let next = slope * row[d];
                    row[d] = carry[d] - next;
                    carry[d] = next;
                }
            }
        }
        out[n] = carry;
    }
    for d in top + 1..D {
        out.iter_mut().for_each(|b| b[d] = 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_skip_empty_intervals_and_clamp() {
        let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0];
        let wanted = [
            (-5.0, 2),
            (0.0, 2),
            (0.5, 2),
            (1.0, 4),
            (1.5, 4),
            (2.0, 7),
            (3.0, 7),
            (9.0, 7),
            (f64::INFINITY, 7),
            (f64::NEG_INFINITY, 2),
            (f64::NAN, 2),
        ];
        for (t, k) in wanted {
            assert_eq!(span(2, &knots, t), k, "t = {t}");
        }
    }

    #[test]
    fn spans_at_repeated_ends_of_the_domain() {
        // Domain [0, 1] with the first and last knots of the domain repeated inside it.
        let knots = [-1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0];
        check(1, 6, &knots).unwrap();
        for t in [-1.0, 0.0, 0.5, 1.0, 2.0, f64::NAN] {
            assert_eq!(span(1, &knots, t), 3, "t = {t}");
        }
    }

    #[test]
    fn bad_knots_are_refused_with_the_place() {
        assert_eq!(check(32, 40, &[]), Err(NetError::Degree { degree: 32 }));
        assert_eq!(check(3, usize::MAX, &[0.0]), Err(NetError::Count { given: 1, needed: usize::MAX }));
        assert_eq!(check(1, 2, &[0.0, 0.0, 1.0]), Err(NetError::Count { given: 3, needed: 4 }));
        assert_eq!(check(1, 2, &[0.0, 1.0, 0.5, 2.0]), Err(NetError::Knots { index: 2 }));
        assert_eq!(check(1, 2, &[0.0, 0.0, f64::NAN, 1.0]), Err(NetError::Knots { index: 2 }));
        assert_eq!(check(1, 2, &[-f64::MAX, 0.0, 1.0, f64::MAX]), Err(NetError::Knots { index: 3 }));
        assert_eq!(check(1, 2, &[0.0, 1.0, 1.0, 2.0]), Err(NetError::Knots { index: 2 }));
    }

    #[test]
    fn the_uniform_cubic_is_the_textbook_cubic() {
        let knots: Vec<f64> = (0..8).map(f64::from).collect();
        let t = 0.25_f64;
        let mut out = [[0.0; 3]; 4];
        jets(3, &knots, 3, 3.0 + t, &mut out);
        let s = 1.0 - t;
        let wanted = [
            [s.powi(3) / 6.0, -s * s / 2.0, s],
            [(3.0 * t.powi(3) - 6.0 * t * t + 4.0) / 6.0, (9.0 * t * t - 12.0 * t) / 6.0, 3.0 * t - 2.0],
            [(3.0 * s.powi(3) - 6.0 * s * s + 4.0) / 6.0, -(9.0 * s * s - 12.0 * s) / 6.0, 3.0 * s - 2.0],
            [t.powi(3) / 6.0, t * t / 2.0, t],
        ];
        for (got, want) in out.as_flattened().iter().zip(wanted.as_flattened()) {
            assert!((got - want).abs() < 1e-15, "{got} ≠ {want}");
        }
    }
}
