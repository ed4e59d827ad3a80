//! Files out. Everything is computed before the first byte is written, and every file appears whole or not at all.

use std::path::{Path, PathBuf};

use glam::DVec3;
use suture::export::{self, Format};
use suture::surface::Surface;
use suture::tessellate::Tessellation;
use suture::view::{self, Camera, ViewOptions};
use suture::{Report, SutureError};

use super::args::{Axis, Picture, Shade};

/// A file to write, its format known.
pub(crate) enum Output {
    Picture(PathBuf),
    Model(PathBuf, Format),
}

impl Output {
    /// Reads the format from the extension, before any work is done.
    pub(crate) fn parse(path: &Path) -> Result<Self, SutureError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if extension == "png" {
            return Ok(Self::Picture(path.to_owned()));
        }
        Ok(Self::Model(path.to_owned(), Format::from_path(path)?))
    }

    pub(crate) fn write(
        &self,
        surface: &Surface,
        tessellation: &Tessellation,
        options: &ViewOptions,
    ) -> Result<&Path, SutureError> {
        match self {
            Self::Picture(path) => {
                view::render(tessellation, surface, options)?.write_png(path)?;
                Ok(path)
            }
            Self::Model(path, format) => {
                export::write(path, *format, surface, Some(tessellation))?;
                Ok(path)
            }
        }
    }
}

/// What pictures look like.
pub(crate) fn view_options(args: &Picture) -> Result<ViewOptions, SutureError> {
    let bad = || SutureError::Unsuitable {
        what: format!("--size {}: must be WIDTHxHEIGHT in pixels, for example 800x600", args.size),
    };
    let (width, height) = args.size.split_once('x').ok_or_else(bad)?;
    let mut options = ViewOptions {
        width: width.parse().map_err(|_| bad())?,
        height: height.parse().map_err(|_| bad())?,
        shade: match args.shade {
            Shade::Patches => view::Shade::Patches,
            Shade::Reflection => view::Shade::Reflection,
            Shade::Isophotes => view::Shade::Isophotes,
            Shade::Curvature => view::Shade::Curvature,
            Shade::Lit => view::Shade::Lit,
        },
        up: match args.up {
            Axis::X => DVec3::X,
            Axis::Y => DVec3::Y,
            Axis::Z => DVec3::Z,
        },
        bands: args.bands,
        ..ViewOptions::default()
    };
    if args.azimuth.is_some() || args.elevation.is_some() {
        let radians = |degrees: Option<f64>, default: f64| degrees.unwrap_or(default).to_radians();
        options.camera = Camera::Orbit {
            azimuth: radians(args.azimuth, 30.0),
            elevation: radians(args.elevation, 25.0),
            distance: 1.0,
        };
    }
    Ok(options)
}

/// Writes the report where asked.
pub(crate) fn report(report: &Report, path: &Path) -> Result<(), SutureError> {
    let json = serde_json::to_string_pretty(report)
        .map_err(|e| SutureError::Internal { what: format!("the report has no JSON form: {e}") })?;
    text(path, &(json + "\n"))
}

/// Writes a text file whole or not at all.
pub(crate) fn text(path: &Path, content: &str) -> Result<(), SutureError> {
    suture::mesh::io::atomic_write(path, |w| w.write_all(content.as_bytes()))
        .map_err(|source| SutureError::File { path: path.to_owned(), source })
}
