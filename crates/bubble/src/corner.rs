//! The jets of the height at corners of patches.

use glam::DVec3;

use crate::{
    implicit::Implicit,
    monomial::{self, TABLE},
};

/// Number of coefficients of a polynomial in two variables of degree below `l`.
pub(crate) const fn plane_count(l: usize) -> usize {
    l * (l + 1) / 2
}

/// Number of `x^a y^b`: by degree, then by falling `a`.
#[inline(always)]
pub(crate) const fn plane_index(a: usize, b: usize) -> usize {
    plane_count(a + b) + b
}

/// What a corner sees in its local parameters `x` (towards the next corner) and `y` (towards the previous one).
#[derive(Clone, Debug)]
pub(crate) struct CornerFrame<'a> {
    /// Base less the corner, by [`plane_index`]; orders above its length are zero.
    pub(crate) base: &'a [DVec3],
    /// N: constant, x, y, xy.
    pub(crate) normal: [DVec3; 4],
}

/// Solves `f(base + h N) = 0` for the coefficients of `h`, by [`plane_index`], of degree below `l ≤ 9`.
pub(crate) fn corner_jet(
    f: &Implicit,
    frame: &CornerFrame<'_>,
    l: usize,
    scratch: &mut Vec<f64>,
) -> Vec<f64> {
    const ROW: usize = plane_count(9);
    let c = f.coefficients();
    let used = monomial::count(f.degree().min(l.saturating_sub(1))).min(c.len());
    scratch.clear();
    scratch.resize(used.max(4) * ROW, 0.0);
    let (powers, _) = scratch.as_chunks_mut::<ROW>();
    let gradient = f.gradient();
    let inverse = -1.0 / gradient.dot(frame.normal[0]);
    let mut h = vec![0.0; plane_count(l)];
    let mut degrees = [0usize; monomial::TOTAL];
    for i in 0..used {
        degrees[i] = TABLE[i].exponents.iter().map(|&e| e as usize).sum();
    }
    for d in 1..l {
        let row = plane_count(d);
        for i in 4..used {
            let m = TABLE[i];
            if degrees[i] > d {
                break;
            }
            let (parent, variable) = (m.parent as usize, 1 + m.variable as usize);
            let mut sum = [0.0; 9];
            for j in 1..d {
                if degrees[parent] > d - j {
                    continue;
                }
                let left = &powers[parent][plane_count(d - j)..plane_count(d - j + 1)];
                let right = &powers[variable][plane_count(j)..plane_count(j + 1)];
                for (p, &x) in left.iter().enumerate() {
                    for (q, &y) in right.iter().enumerate() {
                        sum[p + q] += x * y;
                    }
                }
            }
            powers[i][row..row + d + 1].copy_from_slice(&sum[..d + 1]);
        }
        for b in 0..d + 1 {
            let a = d - b;
            let mut z = frame.base.get(row + b).copied().unwrap_or_default();
            if a > 0 {
                z += h[plane_index(a - 1, b)] * frame.normal[1];
            }
            if b > 0 {
                z += h[plane_index(a, b - 1)] * frame.normal[2];
            }
            if a > 0 && b > 0 {
                z += h[plane_index(a - 1, b - 1)] * frame.normal[3];
            }
            let mut value = gradient.dot(z);
            for i in 4..used {
                value += c[i] * powers[i][row + b];
            }
            let height = value * inverse;
            h[row + b] = height;
            z += height * frame.normal[0];
            for axis in 0..3 {
                powers[1 + axis][row + b] = z[axis];
            }
        }
    }
    h
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    #[test]
    fn the_jet_of_a_sphere_lies_on_it() {
        let f = Implicit::quadric(DVec3::Z, DMat3::IDENTITY);
        let (lx, ly) = (DVec3::new(0.5, 0.1, -0.1), DVec3::new(-0.2, 0.6, 0.05));
        let (nx, ny, nxy) =
            (DVec3::new(0.4, 0.0, -0.1), DVec3::new(0.0, 0.5, -0.1), DVec3::new(0.1, 0.2, 0.3));
        let frame = CornerFrame { base: &[DVec3::ZERO, lx, ly], normal: [DVec3::Z, nx, ny, nxy] };
        let h = corner_jet(&f, &frame, 9, &mut Vec::new());
        let value = |x: f64, y: f64| {
            let mut height = 0.0;
            for a in 0..9_usize {
                for b in 0..9 - a {
                    height += h[plane_index(a, b)] * x.powi(a as i32) * y.powi(b as i32);
                }
            }
            f.value(lx * x + ly * y + height * (DVec3::Z + nx * x + ny * y + nxy * (x * y)))
        };
        let (coarse, fine) = (value(0.2, 0.16), value(0.1, 0.08));
        let order = (coarse / fine).abs().log2();
        assert!((8.5..10.5).contains(&order), "{order} {coarse:e} {fine:e}");
    }
}
