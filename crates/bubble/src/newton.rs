//! Polynomials in Newton's form with the nodes 0, 1, 0, 1, …

use crate::series::Series;

/// Newton's coefficients over the nodes 0, 1, 0, 1, … of the polynomial with Taylor coefficients `a` at 0 in `t` and `b` at 1 in
/// `1 − t`, written to every `stride`-th entry of `out`.
pub(crate) fn newton(a: &[f64], b: &[f64], out: &mut [f64], stride: usize) {
    let m = a.len();
    // Column j of the table of divided differences f[0ⁱ, 1ʲ], i = 0..=m; the next one from f[0ⁱ⁻¹, 1ʲ] − f[0ⁱ, 1ʲ⁻¹].
    let mut column = [0.0; 10];
    column[1..m + 1].copy_from_slice(a);
    out[0] = column[1];
    for j in 1..m + 1 {
        column[0] = if j % 2 == 1 { b[j - 1] } else { -b[j - 1] };
        for i in 1..m + 1 {
            column[i] = column[i - 1] - column[i];
        }
        out[(2 * j - 1) * stride] = column[j];
        if j < m {
            out[2 * j * stride] = column[j + 1];
        }
    }
}

/// The `C` polynomials with Newton coefficients `c`, as series about `t`.
#[inline(always)]
pub(crate) fn horner<const L: usize, const C: usize>(c: &[f64], t: f64) -> [Series<L>; C] {
    let mut out = [[0.0; L]; C];
    let shift = [t, t - 1.0];
    for (i, row) in c.chunks_exact(C).enumerate().rev() {
        let x = shift[i % 2];
        for entry in 0..C {
            let s = &mut out[entry];
            for k in (1..L).rev() {
                s[k] = s[k] * x + s[k - 1];
            }
            s[0] = s[0] * x + row[entry];
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newtons_form_copies_both_ends() {
        let (a, b) = ([0.3, -1.0, 2.0, 0.5, 7.0], [1.0, 0.25, -3.0, 1.5, -2.0]);
        let mut c = [0.0; 10];
        newton(&a, &b, &mut c, 1);
        let [at0] = horner::<5, 1>(&c, 0.0);
        let [at1] = horner::<5, 1>(&c, 1.0);
        for k in 0..5 {
            assert!((at0[k] - a[k]).abs() < 1e-13);
            assert!((at1[k] * (-1.0_f64).powi(k as i32) - b[k]).abs() < 1e-12, "{k}");
        }
    }
}
