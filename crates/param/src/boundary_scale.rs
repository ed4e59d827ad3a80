//! The conformal map with boundary scale 1.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

use crate::sheet::Sheet;
use crate::tutte::{extend, laplacian};
use crate::{ParamError, Parameterize};

/// The free-boundary conformal map whose scale is 1 along the boundary: among conformal maps the one with the least range of
/// scales in the limit of fine meshes.
///
/// Exact on planar and nearly exact on developable input. Flips are possible where the boundary crosses itself in the plane.
///
/// # References
/// R. Sawhney, K. Crane, *Boundary First Flattening* (2017), with zero boundary scale; B. Springborn, P. Schröder, U. Pinkall,
/// *Conformal equivalence of triangle meshes* (2008) for the property.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoundaryScaleOne;

impl Parameterize for BoundaryScaleOne {
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        let sheet = Sheet::new(positions, faces)?;
        let mut uv = flatten(&sheet)?;
        for p in &mut uv {
            *p *= sheet.scale;
        }
        Ok(uv)
    }
}

fn flatten(sheet: &Sheet<'_>) -> Result<Vec<DVec2>, ParamError> {
    let mut angles = vec![0.0; sheet.x.len()];
    for (face, flat) in sheet.faces.iter().zip(&sheet.flats) {
        for k in 0..3 {
            angles[face[k] as usize] += flat.angle[k];
        }
    }
    let stiffness = |f: usize, i: usize, j: usize| sheet.flats[f].stiffness(i, j);
    let (index, n) = sheet.interior();
    // L_II s_I = −Ω_I with s = 0 on the boundary flattens the inside; the turning angles change by (L s)_B.
    let mut turning: Vec<f64> = angles.iter().map(|a| PI - a).collect();
    let mut uv = vec![DVec2::ZERO; sheet.x.len()];
    if n == 0 {
        close_polygon(sheet, &turning, &mut uv)?;
        return Ok(uv);
    }
    let (pattern, values) = laplacian(sheet, &index, n, "BoundaryScaleOne", &stiffness)?;
    let factor = pattern.factor(&values)?;
    let mut s = vec![0.0; n];
    for (v, at) in index.iter().enumerate() {
        if let Some(i) = at {
            s[*i] = angles[v] - TAU;
        }
    }
    factor.solve(&mut s)?;
    for (f, face) in sheet.faces.iter().enumerate() {
        for i in 0..3 {
            for j in [(i + 1) % 3, (i + 2) % 3] {
                let (v, w) = (face[i] as usize, face[j] as usize);
                if let (None, Some(b)) = (index[v], index[w]) {
                    turning[v] += stiffness(f, i, j) * s[b];
                }
            }
        }
    }
    close_polygon(sheet, &turning, &mut uv)?;
    extend(sheet, &index, &factor, &mut uv, &stiffness)?;
    Ok(uv)
}

/// The boundary polygon with these turning angles and the lengths in space, closed by the smallest weighted change:
/// l̃ = l − diag(l) T (Tᵀ diag(l) T)⁻¹ Tᵀ l, T = unit directions.
fn close_polygon(sheet: &Sheet<'_>, turning: &[f64], uv: &mut [DVec2]) -> Result<(), ParamError> {
    let b = &sheet.boundary;
    let lengths = sheet.boundary_lengths();
    let mut direction = 0.0;
    let tangents: Vec<DVec2> = b
        .iter()
        .map(|&v| {
            direction += turning[v as usize];
            DVec2::from_angle(direction)
        })
        .collect();
    // The 2 × 2 matrix Tᵀ diag(l) T and the gap Tᵀ l.
    let (mut xx, mut xy, mut yy, mut gap) = (0.0, 0.0, 0.0, DVec2::ZERO);
    for (t, &l) in tangents.iter().zip(&lengths) {
        xx += l * t.x * t.x;
        xy += l * t.x * t.y;
        yy += l * t.y * t.y;
        gap += *t * l;
    }
    let det = xx * yy - xy * xy;
    if det.is_nan() || det <= f64::EPSILON * (xx + yy) * (xx + yy) {
        return Err(ParamError::Singular { method: "BoundaryScaleOne", unknowns: 2 });
    }
    let y = DVec2::new(yy * gap.x - xy * gap.y, xx * gap.y - xy * gap.x) / det;
    let mut at = DVec2::ZERO;
    for (i, &v) in b.iter().enumerate() {
        uv[v as usize] = at;
        at += tangents[i] * (lengths[i] * (1.0 - tangents[i].dot(y)));
    }
    Ok(())
}
