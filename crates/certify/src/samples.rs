//! A tessellation as plain data.

use glam::{DVec2, DVec3};
use suture_surface::{PatchId, Surface};

use crate::CertifyError;

/// A tessellation of a surface, borrowed as plain slices; one entry per triangle in the last three.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSamples<'a> {
    /// Vertex positions.
    pub positions: &'a [DVec3],
    /// Vertex indices of every triangle.
    pub triangles: &'a [[u32; 3]],
    /// The patch that every triangle lies on.
    pub triangle_patch: &'a [PatchId],
    /// Parameters, on that patch, of the three corners of every triangle.
    pub corner_parameters: &'a [[DVec2; 3]],
}

impl SurfaceSamples<'_> {
    pub(crate) fn check(&self, surface: &Surface) -> Result<(), CertifyError> {
        let triangles = self.triangles.len();
        let lengths = [
            ("triangle_patch", self.triangle_patch.len()),
            ("corner_parameters", self.corner_parameters.len()),
        ];
        for (name, given) in lengths {
            if given != triangles {
                return Err(CertifyError::Length { name, triangles, given });
            }
        }
        check_triangles("tessellation", self.positions, self.triangles)?;
        let patches = surface.patches().len();
        for (triangle, (patch, corners)) in self.triangle_patch.iter().zip(self.corner_parameters).enumerate()
        {
            if patch.0 as usize >= patches || !corners.iter().all(|c| c.is_finite()) {
                return Err(CertifyError::NoSuchPatch { triangle, patch: patch.0, patches });
            }
        }
        Ok(())
    }
}

/// Checks that every triangle names vertices that exist and are finite.
pub(crate) fn check_triangles(
    of: &'static str,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> Result<(), CertifyError> {
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            match positions.get(vertex as usize) {
                Some(p) if p.is_finite() => {}
                Some(_) => return Err(CertifyError::NotFinite { of, vertex: vertex as usize }),
                None => {
                    let vertices = positions.len();
                    return Err(CertifyError::NoSuchVertex { of, triangle, vertex, vertices });
                }
            }
        }
    }
    Ok(())
}
