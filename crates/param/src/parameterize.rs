//! The trait of all flattening methods.

use glam::{DVec2, DVec3};

use crate::ParamError;

/// A method that flattens a disc.
pub trait Parameterize {
    /// Parameters of every vertex of the disc `faces` over `positions`, in any frame of the plane (see
    /// [`normalize`](crate::normalize)). Faces are counter-clockwise and should come out so; methods that cannot promise it
    /// say so, and [`Distortion`](crate::Distortion) counts.
    ///
    /// # Errors
    /// [`ParamError::Empty`], [`ParamError::VertexIndex`], [`ParamError::NotDisc`], [`ParamError::NotFinite`],
    /// [`ParamError::Collapsed`] for input that is not a disc in space; [`ParamError::Singular`] and what the method names.
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError>;
}

impl<T: Parameterize + ?Sized> Parameterize for &T {
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        (**self).parameterize(positions, faces)
    }
}

impl<T: Parameterize + ?Sized> Parameterize for Box<T> {
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        (**self).parameterize(positions, faces)
    }
}
