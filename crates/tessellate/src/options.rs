//! How finely a surface is tessellated.

use crate::TessellateError;

/// How finely a surface is tessellated. Lengths are relative to the size of the surface, the diagonal of the box around samples of
/// all its patches, so that the result does not depend on units.
///
/// The three tolerances steer the number of segments from samples of the patches; they are met up to the features that the samples
/// miss, not guaranteed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TessellationOptions {
    /// Largest distance of a triangle edge from the surface, relative to the surface's size. Default 5e-4: below one pixel of a
    /// picture 1000 pixels wide.
    pub chord: f64,
    /// Largest angle, in radians, by which the normal turns along an edge; a boundary curve may turn by twice as much. Default 0.2.
    pub angle: f64,
    /// Largest length of an edge along the parameter lines, relative to the surface's size. Default 0.1: flat regions still get
    /// triangles of decent shape.
    pub max_edge: f64,
    /// Largest number of segments of a boundary edge of a patch (at least 4); wins over the tolerances. Default 256.
    pub max_segments: usize,
}

impl Default for TessellationOptions {
    fn default() -> Self {
        Self { chord: 5e-4, angle: 0.2, max_edge: 0.1, max_segments: 256 }
    }
}

impl TessellationOptions {
    /// The tolerances as lengths for a surface of the given size.
    pub(crate) fn limits(&self, size: f64) -> Limits {
        Limits {
            chord: self.chord * size,
            angle: self.angle,
            edge: self.max_edge * size,
            segments: self.max_segments.min(MOST_SEGMENTS),
        }
    }

    pub(crate) fn check(&self) -> Result<(), TessellateError> {
        let named = [("chord", self.chord), ("angle", self.angle), ("max_edge", self.max_edge)];
        // Not `value <= 0.0`: NaN must be refused too.
        match named.into_iter().find(|(_, value)| value.is_nan() || *value <= 0.0) {
            Some((name, value)) => Err(TessellateError::Option { name, value, limit: 0.0 }),
            None if self.max_segments < 4 => Err(TessellateError::Option {
                name: "max_segments",
                value: self.max_segments as f64,
                limit: 4.0,
            }),
            None => Ok(()),
        }
    }
}

/// More segments on one edge than any 32-bit mesh of a grid can hold.
const MOST_SEGMENTS: usize = 1 << 15;

/// The options as lengths in the units of the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) chord: f64,
    pub(crate) angle: f64,
    pub(crate) edge: f64,
    pub(crate) segments: usize,
}
