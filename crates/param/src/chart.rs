//! A flattened disc.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::frame::normalize;
use crate::{Disc, Distortion, Limits, ParamError, Parameterize, distortion::check_uv};

/// A disc with parameters.
///
/// Saved and loaded by serde; loading checks the disc and measures the distortion again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Saved")]
pub struct Chart {
    /// The disc. Do not change its faces: the chart has an index of them.
    pub disc: Disc,
    /// Parameters of every chart vertex.
    pub uv: Vec<DVec2>,
    /// What the flattening does.
    #[serde(skip_serializing)]
    pub distortion: Distortion,
    /// What it may do.
    pub limits: Limits,
    /// (Mesh face, chart face), sorted.
    #[serde(skip)]
    copies: Vec<(u32, u32)>,
}

impl Chart {
    /// Flattens a disc and [normalises](normalize) the parameters. Limits that are exceeded and flips of methods that do not
    /// exclude them are in the [`Distortion`], not errors.
    ///
    /// # Errors
    /// What the method and [`Disc::check`] report, and [`ParamError::Collapsed`].
    pub fn flatten(disc: Disc, method: &impl Parameterize, limits: &Limits) -> Result<Self, ParamError> {
        disc.check()?;
        let mut uv = method.parameterize(&disc.positions, &disc.faces)?;
        normalize(&disc.positions, &disc.faces, &mut uv)?;
        Self::new(disc, uv, limits)
    }

    /// A chart with parameters from elsewhere, taken as they are.
    ///
    /// # Errors
    /// What [`Disc::check`] reports; [`ParamError::Length`] and [`ParamError::NotFinite`] for the parameters.
    pub fn new(disc: Disc, uv: Vec<DVec2>, limits: &Limits) -> Result<Self, ParamError> {
        disc.check()?;
        let distortion = Distortion::measure(&disc.positions, &disc.faces, &uv, limits)?;
        let mut copies: Vec<_> = disc.mesh_faces.iter().enumerate().map(|(c, &f)| (f, c as u32)).collect();
        copies.sort_unstable();
        Ok(Self { disc, uv, distortion, limits: *limits, copies })
    }

    /// The same disc with other parameters (after a parameter correction), taken as they are.
    ///
    /// # Errors
    /// [`ParamError::Length`] and [`ParamError::NotFinite`].
    pub fn with_uv(mut self, uv: Vec<DVec2>) -> Result<Self, ParamError> {
        check_uv(&uv, self.disc.vertices.len())?;
        self.distortion = Distortion::measure(&self.disc.positions, &self.disc.faces, &uv, &self.limits)?;
        self.uv = uv;
        Ok(self)
    }

    /// The chart faces that are copies of a mesh face, ascending: the one in the segment first, if there is one.
    pub fn copies(&self, mesh_face: u32) -> impl Iterator<Item = usize> + '_ {
        let first = self.copies.partition_point(|c| c.0 < mesh_face);
        self.copies[first..].iter().take_while(move |c| c.0 == mesh_face).map(|c| c.1 as usize)
    }

    /// Parameters of a point of a chart face; barycentric coordinates as in the mesh face, summing to 1.
    ///
    /// # Panics
    /// When the chart face does not exist.
    pub fn at(&self, chart_face: usize, barycentric: [f64; 3]) -> DVec2 {
        let [a, b, c] = self.corners(chart_face);
        // Relative to one corner, so that coordinates that sum to 1 up to rounding do not scale the point.
        a + (b - a) * barycentric[1] + (c - a) * barycentric[2]
    }

    /// Parameters of the corners of a chart face.
    ///
    /// # Panics
    /// When the chart face does not exist.
    pub fn corners(&self, chart_face: usize) -> [DVec2; 3] {
        self.disc.faces[chart_face].map(|v| self.uv[v as usize])
    }
}

/// What a saved chart is made of.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    disc: Disc,
    uv: Vec<DVec2>,
    limits: Limits,
}

impl TryFrom<Saved> for Chart {
    type Error = ParamError;

    fn try_from(saved: Saved) -> Result<Self, ParamError> {
        Self::new(saved.disc, saved.uv, &saved.limits)
    }
}
