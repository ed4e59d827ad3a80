//! Spectral conformal map: no pins.

use glam::{DVec2, DVec3};

use crate::conformal::hessian;
use crate::sheet::Sheet;
use crate::sparse::Pattern;
use crate::tutte::circle;
use crate::{ParamError, Parameterize};

/// Spectral conformal map: the least conformal energy for unit boundary mass.
///
/// Costs and distorts like [`Lscm`](crate::Lscm) but does not depend on pins. Flips are possible.
///
/// # References
/// P. Mullen, Y. Tong, P. Alliez, M. Desbrun, *Spectral conformal parameterization* (2008), section 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spectral {
    /// Number of inverse iterations. Default 6.
    pub iterations: usize,
}

impl Default for Spectral {
    fn default() -> Self {
        Self { iterations: 6 }
    }
}

impl Parameterize for Spectral {
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        let sheet = Sheet::new(positions, faces)?;
        let n = sheet.x.len();
        let (mut entries, mut values) = hessian(&sheet);
        let fixed = values.len();
        for &v in &sheet.boundary {
            entries.extend([(v as usize, v as usize), (n + v as usize, n + v as usize)]);
        }
        values.resize(entries.len(), 0.0);
        let pattern = Pattern::new("Spectral", 2 * n, &entries)?;
        // The energy is singular (constants; on developable charts all similarities): shifted by as little as rounding admits.
        let mut shift = 1e-9;
        let factor = loop {
            values[fixed..].fill(shift);
            match pattern.factor(&values) {
                Err(ParamError::Singular { .. }) if shift < 1e-5 => shift *= 10.0,
                other => break other?,
            }
        };
        // Only boundary values enter the first step; the circle is oriented, so the start is not orthogonal to the solution.
        let mut uv = circle(&sheet);
        let mass = sheet.boundary.len() as f64;
        for _ in 0..self.iterations.clamp(1, 1000) {
            let mut x = vec![0.0; 2 * n];
            for &v in &sheet.boundary {
                (x[v as usize], x[n + v as usize]) = uv[v as usize].into();
            }
            factor.solve(&mut x)?;
            for (v, p) in uv.iter_mut().enumerate() {
                *p = DVec2::new(x[v], x[n + v]);
            }
            let mean = sheet.boundary.iter().map(|&v| uv[v as usize]).sum::<DVec2>() / mass;
            uv.iter_mut().for_each(|p| *p -= mean);
            let square = sheet.boundary.iter().map(|&v| uv[v as usize].length_squared()).sum::<f64>();
            let scale = (mass / square).sqrt();
            if !(scale > 0.0 && scale.is_finite()) {
                return Err(ParamError::Singular { method: "Spectral", unknowns: 2 * n });
            }
            uv.iter_mut().for_each(|p| *p *= scale);
        }
        Ok(uv.into_iter().map(|p| p * sheet.scale).collect())
    }
}
