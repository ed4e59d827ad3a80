//! The B-spline basis over a knot vector (de Boor 1978; Piegl & Tiller, *The NURBS Book*, 1997, A2.1–A2.3).

use crate::{MAX_DEGREE, NetError};

/// Checks a knot vector for `count` basis functions of `degree`.
///
/// # Errors
/// [`NetError::Degree`], [`NetError::Count`], [`NetError::Knots`].
pub fn check(degree: usize, count: usize, knots: &[f64]) -> Result<(), NetError> {
    if degree > MAX_DEGREE {
        return Err(NetError::Degree { degree });
    }
    if count <= degree || knots.len() != count + degree + 1 {
        return Err(NetError::Count { given: knots.len(), needed: count.max(degree + 1) + degree + 1 });
    }
    if let Some(index) =
        (0..knots.len()).find(|&i| !knots[i].is_finite() || (i > 0 && knots[i] < knots[i - 1]))
    {
        return Err(NetError::Knots { index });
    }
    if knots[degree] >= knots[count] {
        return Err(NetError::Knots { index: count });
    }
    Ok(())
}

/// Index `k` of the span `knots[k] ≤ t < knots[k + 1]` that evaluates `t`; clamped to the domain, so that parameters outside
/// it are continued by the first or last piece.
pub fn span(degree: usize, knots: &[f64], t: f64) -> usize {
    let count = knots.len() - degree - 1;
    let k = knots[degree..=count].partition_point(|&k| k <= t);
    let mut k = (degree + k).saturating_sub(1).clamp(degree, count - 1);
    while knots[k] == knots[k + 1] && k > degree {
        k -= 1;
    }
    while knots[k] == knots[k + 1] && k + 1 < count {
        k += 1;
    }
    k
}

/// Writes value and derivatives to order `D − 1` of the `degree + 1` functions that live on `span` (the functions
/// `span − degree ..= span`) at `t` into `out[0..=degree]`.
///
/// # Panics
/// When `degree > MAX_DEGREE`, `out` is shorter than `degree + 1` or `span` is not one that [`span`] returns.
pub fn jets<const D: usize>(degree: usize, knots: &[f64], span: usize, t: f64, out: &mut [[f64; D]]) {
    let mut row = [0.0; MAX_DEGREE + 1];
    for d in 0..D {
        if d > degree {
            out[..=degree].iter_mut().for_each(|b| b[d] = 0.0);
            continue;
        }
        // Values of the basis of degree p − d on the span …
        row[0] = 1.0;
        for n in 1..=degree - d {
            let mut carry = 0.0;
            for i in 0..n {
                let (a, b) = (knots[span + 1 + i - n], knots[span + 1 + i]);
                let w = row[i] / (b - a);
                row[i] = carry + (b - t) * w;
                carry = (t - a) * w;
            }
            row[n] = carry;
        }
        // … raised to degree p by d differences: N' = n (N_{i}/(t_{i+n} − t_i) − N_{i+1}/(t_{i+n+1} − t_{i+1})).
        for n in degree - d + 1..=degree {
            let mut carry = 0.0;
            for i in 0..n {
                let (a, b) = (knots[span + 1 + i - n], knots[span + 1 + i]);
                let w = n as f64 * row[i] / (b - a);
                row[i] = carry - w;
                carry = w;
            }
            row[n] = carry;
        }
        for i in 0..=degree {
            out[i][d] = row[i];
        }
    }
}
