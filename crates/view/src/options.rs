//! What a picture shows and from where.

use glam::DVec3;

use crate::ViewError;

/// What a picture shows and from where.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Width in pixels, 1 to 16384. Default 800.
    pub width: u32,
    /// Height in pixels, 1 to 16384. Default 600.
    pub height: u32,
    /// What the colours mean. Default [`Shade::Patches`].
    pub shade: Shade,
    /// Where the eye is. Default [`Camera::Auto`].
    pub camera: Camera,
    /// The direction that points upwards in the picture, of any length. Default Z. Where it coincides with the direction of view,
    /// the coordinate axis farthest from it takes its place.
    pub up: DVec3,
    /// Vertical angle of view in radians, between 0 and π. Default 0.5: longer than a standard lens, for little distortion.
    pub field_of_view: f64,
    /// What is behind the surface. Default white.
    pub background: Background,
    /// Samples per pixel along each axis, 1 to 4. Default 3.
    pub samples: u32,
    /// Number of light bands over half a turn for [`Shade::Reflection`] and [`Shade::Isophotes`]. Default 24.
    pub bands: u32,
    /// Curvature at the ends of the colour map for [`Shade::Curvature`], in 1 / length; `None` takes
    /// [`curvature_range`](crate::curvature_range). Set it to compare pictures.
    pub curvature_range: Option<f64>,
    /// Distance at the end of the colour map for [`Shade::Deviation`], in the unit of the distances; `None` takes the one that 99 % of the
    /// area stay below.
    pub deviation_range: Option<f64>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            width: 800,
            height: 600,
            shade: Shade::Patches,
            camera: Camera::Auto,
            up: DVec3::Z,
            field_of_view: 0.5,
            background: Background::White,
            samples: 3,
            bands: 24,
            curvature_range: None,
            deviation_range: None,
        }
    }
}

/// What the colours of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shade {
    /// Colour by kind of patch: trimmed blue, strips red and light red in turn, adjacent strips green, N-blends yellow; A-patches over faces
    /// light blue, along edges orange, plane faces grey; bubble patches teal.
    Patches,
    /// One neutral colour, lit.
    Lit,
    /// Reflection lines: bands of light far away, mirrored in the surface. The lines are one order less smooth than the surface: gaps
    /// show a kink of the normal, kinks a jump of the curvature.
    Reflection,
    /// Bands of equal angle between normal and light: independent of the eye, otherwise as reflection lines.
    Isophotes,
    /// Mean curvature: red where the surface bulges towards its normal (a sphere with outward normals), blue where it is hollow.
    Curvature,
    /// Distance from the input mesh: dark violet where there is none, yellow where it is largest; needs distances
    /// ([`render_deviation`](crate::render_deviation)).
    Deviation,
}

/// Where the eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Camera {
    /// Of eight directions slightly from above, the one that sees the largest area; distance as for [`Camera::Orbit`].
    Auto,
    /// Around the mesh, which is in the middle of the picture.
    Orbit {
        /// Angle around the up axis, radians, counter-clockwise seen from above. For up = Z, 0 looks from +X, π/2 from +Y.
        azimuth: f64,
        /// Angle above the horizon, radians, −π/2 to π/2.
        elevation: f64,
        /// Distance, relative to the one at which the mesh just fits into the picture with a small margin.
        distance: f64,
    },
    /// Given positions, in the units of the mesh.
    LookAt {
        /// Position of the eye.
        eye: DVec3,
        /// The point in the middle of the picture.
        target: DVec3,
    },
}

/// What is behind the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Background {
    /// Opaque white.
    White,
    /// Nothing: alpha is the share of the pixel that the surface covers.
    Transparent,
}

const MOST_PIXELS: u32 = 1 << 14;

impl ViewOptions {
    pub(crate) fn check(&self) -> Result<(), ViewError> {
        let within = |name, value: f64, limits: [f64; 2]| {
            if value >= limits[0] && value <= limits[1] {
                Ok(())
            } else {
                Err(ViewError::Option { name, value, limits })
            }
        };
        let tiny = f64::MIN_POSITIVE;
        within("width", self.width.into(), [1.0, MOST_PIXELS.into()])?;
        within("height", self.height.into(), [1.0, MOST_PIXELS.into()])?;
        within("samples", self.samples.into(), [1.0, 4.0])?;
        within("bands", self.bands.into(), [1.0, 10_000.0])?;
        within("field_of_view", self.field_of_view, [1e-3, 3.1])?;
        within("up", self.up.length(), [tiny, f64::MAX])?;
        within("curvature_range", self.curvature_range.unwrap_or(1.0), [tiny, f64::MAX])?;
        within("deviation_range", self.deviation_range.unwrap_or(1.0), [tiny, f64::MAX])?;
        match self.camera {
            Camera::Auto => Ok(()),
            Camera::Orbit { azimuth, elevation, distance } => {
                within("azimuth", azimuth, [-1e6, 1e6])?;
                within("elevation", elevation, [-1.6, 1.6])?;
                within("distance", distance, [1e-6, 1e6])
            }
            Camera::LookAt { eye, target } => {
                within("distance from eye to target", eye.distance(target), [tiny, f64::MAX])
            }
        }
    }
}
