//! The default: conformal where that is gentle, symmetric Dirichlet elsewhere.

use glam::{DVec2, DVec3};

use crate::frame::normalize;
use crate::sheet::Sheet;
use crate::symmetric_dirichlet::{Descent, flips};
use crate::{BoundaryScaleOne, Distortion, Limits, ParamError, Parameterize, Tutte};

/// The default: [`BoundaryScaleOne`]; where it flips or its area ratio exceeds 4, a few iterations of
/// [`SymmetricDirichlet`](crate::SymmetricDirichlet) from it, or from [`Tutte`] where it flips. Where parts far apart in space land on
/// each other, the descent starts from [`Tutte`] again and ends before that happens: a fit over such a map would be two-valued.
///
/// The result has no flips. It may exceed the limits: see [`Distortion::accepted`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recommended {
    /// Area ratio up to which the conformal map is taken as it is: it is smoother across triangles. Default 4.
    pub gentle: f64,
    /// Iterations of the first round. Default 5.
    pub iterations: usize,
    /// Iterations when the first round is not accepted. Default 20: charts of creased meshes need them (cow: 16 to 184 area ratio after 10).
    pub most: usize,
    /// Iterations from a Tutte embedding, which starts much farther away. Default 30.
    pub from_tutte: usize,
    /// What is accepted.
    pub limits: Limits,
}

impl Default for Recommended {
    fn default() -> Self {
        Self { gentle: 4.0, iterations: 5, most: 20, from_tutte: 30, limits: Limits::default() }
    }
}

impl Parameterize for Recommended {
    /// # Errors
    /// [`ParamError::Flips`] when even the embedding on a circle flips, which happens to rounding errors only.
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        let sheet = Sheet::new(positions, faces)?;
        let measure = |uv: &[DVec2]| Distortion::on(&sheet, uv, &self.limits);
        let conformal =
            BoundaryScaleOne.parameterize(positions, faces).ok().filter(|uv| flips(&sheet, uv).is_none());
        let mut uv = match conformal {
            Some(uv) if measure(&uv)?.area_ratio <= self.gentle => uv,
            Some(uv) => self.descend(&sheet, uv, self.iterations, self.most, &measure)?,
            None => {
                let uv = Tutte.parameterize(positions, faces)?;
                self.descend(&sheet, uv, self.most, self.from_tutte, &measure)?
            }
        };
        if measure(&uv)?.overlaps > 0 {
            let uv_on_disc = Tutte.parameterize(positions, faces)?;
            uv = self.descend_apart(&sheet, uv_on_disc, &measure)?;
        }
        normalize(positions, faces, &mut uv)?;
        if let Some((count, face)) = flips(&sheet, &uv) {
            return Err(ParamError::Flips { method: "Recommended", count, faces: faces.len(), face });
        }
        Ok(uv)
    }
}

impl Recommended {
    fn descend(
        &self,
        sheet: &Sheet<'_>,
        start: Vec<DVec2>,
        first: usize,
        most: usize,
        measure: &dyn Fn(&[DVec2]) -> Result<Distortion, ParamError>,
    ) -> Result<Vec<DVec2>, ParamError> {
        let mut descent = Descent::new(sheet, start)?;
        for i in 0..most.max(first) {
            if i >= first && measure(&descent.parameters())?.accepted {
                break;
            }
            if !descent.step()? {
                break;
            }
        }
        Ok(descent.parameters())
    }

    /// As far down from a map onto a disc as nothing lands on something else.
    fn descend_apart(
        &self,
        sheet: &Sheet<'_>,
        start: Vec<DVec2>,
        measure: &dyn Fn(&[DVec2]) -> Result<Distortion, ParamError>,
    ) -> Result<Vec<DVec2>, ParamError> {
        let mut descent = Descent::new(sheet, start)?;
        let mut best = descent.parameters();
        for _ in 0..self.from_tutte {
            if !descent.step()? {
                break;
            }
            let next = descent.parameters();
            let distortion = measure(&next)?;
            if distortion.overlaps > 0 {
                break;
            }
            best = next;
            if distortion.accepted {
                break;
            }
        }
        Ok(best)
    }
}
