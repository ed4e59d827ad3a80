//! Tutte's embedding on a circle.

use glam::{DVec2, DVec3};

use crate::frame::farthest;
use crate::sheet::Sheet;
use crate::sparse::Pattern;
use crate::{ParamError, Parameterize};

/// Tutte's embedding: the boundary on a circle by arc length, every interior vertex at the mean of its neighbours.
///
/// Bijective in exact arithmetic for every triangulated disc; only very deep charts (interior vertices squeezed below
/// rounding errors) can still come out with flips. Area and angles are not kept: a start for
/// [`SymmetricDirichlet`](crate::SymmetricDirichlet), not a chart to fit on. The circle has the area of the surface.
///
/// # References
/// W. T. Tutte, *How to draw a graph*, Proc. London Math. Soc. (1963).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tutte;

impl Parameterize for Tutte {
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        let sheet = Sheet::new(positions, faces)?;
        let mut uv = circle(&sheet);
        harmonic(&sheet, &mut uv, "Tutte", |_, _, _| -0.5)?;
        let radius = (sheet.area() / std::f64::consts::PI).sqrt() * sheet.scale;
        Ok(uv.into_iter().map(|p| p * radius).collect())
    }
}

/// The boundary on the unit circle by arc length, beginning at the boundary vertex of [`farthest`]; the rest at the origin.
pub(crate) fn circle(sheet: &Sheet<'_>) -> Vec<DVec2> {
    let b = &sheet.boundary;
    let lengths = sheet.boundary_lengths();
    let total: f64 = lengths.iter().sum();
    let [start, _] = farthest(sheet);
    let first = b.iter().position(|&v| v as usize == start).unwrap_or(0);
    let mut uv = vec![DVec2::ZERO; sheet.x.len()];
    let mut along = 0.0;
    for i in 0..b.len() {
        let at = (first + i) % b.len();
        uv[b[at] as usize] = DVec2::from_angle(std::f64::consts::TAU * along / total);
        along += lengths[at];
    }
    uv
}

/// Extends boundary values harmonically: one factorisation, two solves. `stiffness(face, i, j)` is the off-diagonal entry that
/// the face contributes for its corners `i ≠ j`.
pub(crate) fn harmonic(
    sheet: &Sheet<'_>,
    uv: &mut [DVec2],
    method: &'static str,
    stiffness: impl Fn(usize, usize, usize) -> f64,
) -> Result<(), ParamError> {
    let (index, n) = sheet.interior();
    if n == 0 {
        return Ok(());
    }
    let (pattern, values) = laplacian(sheet, &index, n, method, &stiffness)?;
    let factor = pattern.factor(&values)?;
    extend(sheet, &index, &factor, uv, &stiffness)
}

/// Interior block of the Laplacian with these off-diagonal entries.
pub(crate) fn laplacian(
    sheet: &Sheet<'_>,
    index: &[Option<usize>],
    n: usize,
    method: &'static str,
    stiffness: &impl Fn(usize, usize, usize) -> f64,
) -> Result<(Pattern, Vec<f64>), ParamError> {
    let mut entries = Vec::with_capacity(6 * sheet.faces.len());
    let mut values = Vec::with_capacity(6 * sheet.faces.len());
    for (f, face) in sheet.faces.iter().enumerate() {
        let at = face.map(|v| index[v as usize]);
        for i in 0..3 {
            let j = (i + 1) % 3;
            let w = stiffness(f, i, j);
            for end in [at[i], at[j]].into_iter().flatten() {
                entries.push((end, end));
                values.push(-w);
            }
            if let (Some(a), Some(b)) = (at[i], at[j]) {
                entries.push((a.max(b), a.min(b)));
                values.push(w);
            }
        }
    }
    Ok((Pattern::new(method, n, &entries)?, values))
}

/// Solves for the interior with boundary values from `uv`.
pub(crate) fn extend(
    sheet: &Sheet<'_>,
    index: &[Option<usize>],
    factor: &crate::sparse::Factor<'_>,
    uv: &mut [DVec2],
    stiffness: &impl Fn(usize, usize, usize) -> f64,
) -> Result<(), ParamError> {
    let n = index.iter().flatten().count();
    let mut rhs = vec![0.0; 2 * n];
    for (f, face) in sheet.faces.iter().enumerate() {
        for i in 0..3 {
            for j in [(i + 1) % 3, (i + 2) % 3] {
                let (v, w) = (face[i] as usize, face[j] as usize);
                if let (Some(a), None) = (index[v], index[w]) {
                    let s = stiffness(f, i, j);
                    rhs[a] -= s * uv[w].x;
                    rhs[n + a] -= s * uv[w].y;
                }
            }
        }
    }
    factor.solve(&mut rhs)?;
    for (v, at) in index.iter().enumerate() {
        if let Some(a) = at {
            uv[v] = DVec2::new(rhs[*a], rhs[n + a]);
        }
    }
    Ok(())
}
