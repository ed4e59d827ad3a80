//! Files out. Everything is computed before the first byte is written, and every file appears whole or not at all.

use std::path::{Path, PathBuf};

use glam::DVec3;
use suture::export::{self, Format, LengthUnit, StepOptions};
use suture::view::{self, Camera, Page, PageModel, ViewOptions};
use suture::{Report, Stage, SutureError, Watch};

use super::args::{Axis, Cad, Picture, Shade, Unit};

/// A file to write, its format known.
pub(crate) enum Output {
    Picture(PathBuf),
    Page(PathBuf),
    Model(PathBuf, Format),
}

impl Output {
    /// Reads the format from the extension, before any work is done.
    pub(crate) fn parse(path: &Path) -> Result<Self, SutureError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if extension == "png" {
            return Ok(Self::Picture(path.to_owned()));
        }
        if extension == "html" || extension == "htm" {
            return Ok(Self::Page(path.to_owned()));
        }
        Ok(Self::Model(path.to_owned(), Format::from_path(path)?))
    }

    /// Refuses what is no page.
    pub(crate) fn page(path: &Path) -> Result<(), SutureError> {
        match Self::parse(path)? {
            Self::Page(_) => Ok(()),
            _ => {
                let what = format!("{}: only pages (.html) can show surfaces side by side", path.display());
                Err(SutureError::Unsuitable { what })
            }
        }
    }

    fn write_made(&self, made: &Made<'_>, report: &mut Report) -> Result<&Path, SutureError> {
        let model = &made.model;
        let (surface, tessellation) = (model.surface, model.tessellation);
        match self {
            Self::Picture(path) => {
                let picture = match model.deviation {
                    Some(d) => view::render_deviation(tessellation, surface, &d.vertex_distances, made.view)?,
                    None => view::render(tessellation, surface, made.view)?,
                };
                picture.write_png(path)?;
                Ok(path)
            }
            Self::Page(path) => {
                let model = PageModel { report: snapshot(report), ..model.clone() };
                Page { title: title(report), models: vec![model], view: made.view.clone() }
                    .write_html(path)?;
                Ok(path)
            }
            Self::Model(path, Format::Step) => {
                let step = export::write_step(path, surface, &made.step_options(path))?;
                report.describe_step(&step);
                Ok(path)
            }
            Self::Model(path, Format::Glb) => {
                let deviation = model.deviation.map(|d| &d.vertex_distances[..]);
                export::write_glb(path, surface, tessellation, deviation)?;
                Ok(path)
            }
            Self::Model(path, format) => {
                export::write(path, *format, surface, Some(tessellation))?;
                Ok(path)
            }
        }
    }
}

/// What there is to write, and how.
pub(crate) struct Made<'a> {
    /// The surface and everything that pages show of it; they add the report.
    pub(crate) model: PageModel<'a>,
    pub(crate) view: &'a ViewOptions,
    pub(crate) cad: &'a Cad,
    /// What lengths are relative to.
    pub(crate) diagonal: f64,
}

impl Made<'_> {
    fn step_options(&self, path: &Path) -> StepOptions {
        let name = path.file_stem().map(|n| n.to_string_lossy().into_owned());
        StepOptions {
            tolerance: self.cad.cad_tolerance,
            diagonal: Some(self.diagonal),
            name: name.unwrap_or_default(),
            unit: match self.cad.unit {
                Unit::Um => LengthUnit::Micrometre,
                Unit::Mm => LengthUnit::Millimetre,
                Unit::Cm => LengthUnit::Centimetre,
                Unit::M => LengthUnit::Metre,
            },
            ..StepOptions::default()
        }
    }
}

/// Writes everything asked for and enters it in the report.
pub(crate) fn all(
    outputs: &[Output],
    made: &Made<'_>,
    watch: &dyn Watch,
    report: &mut Report,
) -> Result<(), SutureError> {
    watch.begin(Stage::Export, outputs.len());
    let start = std::time::Instant::now();
    for target in outputs {
        if watch.interrupted() {
            return Err(SutureError::Interrupted);
        }
        let path = target.write_made(made, report)?;
        report.outputs.push(path.display().to_string());
        watch.step();
    }
    report.seconds.insert(Stage::Export.name().into(), start.elapsed().as_secs_f64());
    Ok(())
}

/// The heading of a page: file and command.
pub(crate) fn title(report: &Report) -> String {
    let file = report.input_file.as_ref().and_then(|f| Path::new(f).file_name()).map(|f| f.to_string_lossy());
    format!("{} · {}", file.as_deref().unwrap_or("built-in shape"), report.command)
}

/// The report so far, as a page shows it.
pub(crate) fn snapshot(report: &Report) -> serde_json::Value {
    let mut report = report.clone();
    report.peak_memory_bytes = suture::report::peak_memory();
    // Numbers, strings and maps have a JSON form.
    serde_json::to_value(&report).unwrap_or_default()
}

/// What pictures look like and how pages open.
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
            Shade::Deviation => view::Shade::Deviation,
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
