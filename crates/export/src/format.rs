//! The file formats.

use std::fmt;
use std::path::Path;

use suture_mesh::io::{MeshFormat, WriteOptions, atomic_write, write_with};
use suture_surface::Surface;
use suture_tessellate::Tessellation;

use crate::{ExportError, StepOptions, StepReport, glb, native, obj, to_step};

/// A file format that a surface can leave in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Binary glTF 2.0, `.glb`: triangles in 32-bit numbers with exact normals, one material per group of patches.
    Glb,
    /// Wavefront OBJ, `.obj`: triangles in 64-bit numbers with exact normals, one group and material per group of patches; the
    /// materials go into an `.mtl` file beside it.
    Obj,
    /// Stanford polygon file, `.ply`, binary: triangles in 64-bit numbers with normals.
    Ply,
    /// Stereolithography, `.stl`, binary: triangles in 32-bit numbers.
    Stl,
    /// STEP AP214, `.step` or `.stp`: a solid of B-spline faces for CAD systems.
    Step,
    /// Native JSON, `.json` (by custom `.suture.json`): the patches themselves, lossless.
    Native,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 6] = [Self::Step, Self::Glb, Self::Obj, Self::Ply, Self::Stl, Self::Native];

    /// The format's extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Step => "step",
            Self::Native => "json",
        }
    }

    /// The format that the extension of `path` names, in any case.
    ///
    /// # Errors
    /// [`ExportError::UnknownFormat`], which lists the extensions that exist.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, ExportError> {
        let path = path.as_ref();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        let known = ".step, .glb, .obj, .ply, .stl or .json";
        let extension = if extension.eq_ignore_ascii_case("stp") { "step" } else { extension };
        Self::ALL
            .into_iter()
            .find(|f| f.extension().eq_ignore_ascii_case(extension))
            .ok_or_else(|| ExportError::UnknownFormat { path: path.to_owned(), known })
    }

    /// Whether the format holds triangles, and so [`write()`] needs a tessellation.
    pub fn needs_tessellation(self) -> bool {
        !matches!(self, Self::Native | Self::Step)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Glb => "glTF",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Step => "STEP",
            Self::Native => "native JSON",
        })
    }
}

/// Writes `surface` to `path` in `format`; a file appears complete or not at all, and replaces one that was there.
///
/// # Errors
/// [`ExportError::NeedsTessellation`] for formats of triangles without `tessellation`, [`ExportError::Tessellation`] when it is that
/// of another surface, [`ExportError::Io`], and what the format refuses.
pub fn write(
    path: impl AsRef<Path>,
    format: Format,
    surface: &Surface,
    tessellation: Option<&Tessellation>,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    let needed = || tessellation.ok_or(ExportError::NeedsTessellation { format });
    match format {
        Format::Native => save(path, &native::write_native(surface)?),
        Format::Step => write_step(path, surface, &step_options(path)).map(|_| ()),
        Format::Glb => save(path, &glb::to_glb(surface, needed()?)?),
        Format::Obj => {
            let materials = path.with_extension("mtl");
            let name =
                materials.file_name().and_then(|n| n.to_str()).filter(|n| !n.contains(char::is_control));
            // A name that no line of an OBJ file can hold leaves the file without colours.
            let bytes = obj::to_obj(surface, needed()?, name)?;
            if name.is_some() {
                save(&materials, obj::to_mtl().as_bytes())?;
            }
            save(path, &bytes)
        }
        Format::Ply => mesh(path, MeshFormat::Ply, needed()?),
        Format::Stl => mesh(path, MeshFormat::Stl, needed()?),
    }
}

/// Writes `surface` to `path` as binary glTF with the distances of the vertices from a mesh ([`to_glb_with`](crate::to_glb_with)); the file
/// appears complete or not at all.
///
/// # Errors
/// Those of [`to_glb_with`](crate::to_glb_with), and [`ExportError::Io`].
pub fn write_glb(
    path: impl AsRef<Path>,
    surface: &Surface,
    tessellation: &Tessellation,
    deviation: Option<&[f64]>,
) -> Result<(), ExportError> {
    save(path.as_ref(), &glb::to_glb_with(surface, tessellation, deviation)?)
}

/// Writes `surface` to `path` as STEP; the file appears complete or not at all.
///
/// # Errors
/// Those of [`to_step`], and [`ExportError::Io`].
pub fn write_step(
    path: impl AsRef<Path>,
    surface: &Surface,
    options: &StepOptions,
) -> Result<StepReport, ExportError> {
    let (bytes, report) = to_step(surface, options)?;
    save(path.as_ref(), &bytes)?;
    Ok(report)
}

/// The defaults, with the name of the file for the product.
fn step_options(path: &Path) -> StepOptions {
    let name = path.file_stem().map(|n| n.to_string_lossy().into_owned());
    StepOptions { name: name.unwrap_or_default(), ..StepOptions::default() }
}

fn mesh(path: &Path, format: MeshFormat, tessellation: &Tessellation) -> Result<(), ExportError> {
    Ok(write_with(
        path,
        &tessellation.mesh,
        WriteOptions { format: Some(format), ..WriteOptions::default() },
    )?)
}

fn save(path: &Path, bytes: &[u8]) -> Result<(), ExportError> {
    atomic_write(path, |out| out.write_all(bytes))
        .map_err(|source| ExportError::Io { path: path.to_owned(), source })
}
