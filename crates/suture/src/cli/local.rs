//! What the commands with one patch per face have in common.

use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use serde::Serialize;
use suture::mesh::TriMesh;
use suture::view::PageModel;
use suture::{NormalSource, Report, SewOptions, Sewn, SutureError, Watch, degrees};

use super::commands::summary;
use super::progress::Progress;
use super::{args, input, output};

/// Input, output and what lies between for every method.
#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Local {
    /// The mesh, open or closed: .obj, .stl, .ply or .off
    #[serde(skip)]
    pub(crate) input: PathBuf,
    /// Where to write; the extension names the format: .step (CAD), .glb .obj .ply .stl, .json (lossless), .png (picture), .html (page for any browser); may be repeated
    #[arg(long, short, value_name = "FILE", required = true)]
    #[serde(skip)]
    pub(crate) output: Vec<PathBuf>,
    /// Segments of the tessellation along every edge of the mesh; without it 12 to 2, fewer for larger meshes
    #[arg(long, value_name = "N")]
    pub(crate) resolution: Option<usize>,
    /// Where the normals come from; without it the file if it has them, else loop
    #[arg(long, value_enum)]
    pub(crate) normals: Option<Normals>,
    /// Repair first what can be repaired safely: weld equal vertices, orient faces, drop isolated vertices and degenerate or duplicate faces
    #[arg(long)]
    pub(crate) repair: bool,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) cad: args::Cad,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) picture: args::Picture,
}

#[derive(ValueEnum, Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Normals {
    /// From the file
    File,
    /// Of the limit of Loop's subdivision
    Loop,
    /// Mean of the faces', weighted by their angles
    Angle,
    /// Mean of the faces', weighted by their areas
    Area,
    /// Gradients of fitted quadrics
    Quadric,
}

impl Local {
    pub(crate) fn source(&self) -> NormalSource {
        match self.normals {
            None => NormalSource::Best,
            Some(Normals::File) => NormalSource::Mesh,
            Some(Normals::Loop) => NormalSource::Loop,
            Some(Normals::Angle) => NormalSource::Angle,
            Some(Normals::Area) => NormalSource::Area,
            Some(Normals::Quadric) => NormalSource::Quadric,
        }
    }

    /// Reads the mesh, has `sew` lay the surface, writes everything and tells what there is to tell; whether all that was claimed holds.
    pub(crate) fn run<R: Serialize>(
        &self,
        common: &args::Common,
        report: &mut Report,
        sew: impl FnOnce(&TriMesh, &SewOptions, &dyn Watch) -> Result<Sewn<R>, SutureError>,
    ) -> Result<bool, SutureError> {
        let outputs: Vec<output::Output> =
            self.output.iter().map(|p| output::Output::parse(p)).collect::<Result<_, _>>()?;
        let view = output::view_options(&self.picture)?;
        let mut notices = Vec::new();
        let mesh = input::mesh(&self.input, self.repair, &mut notices)?;
        report.warnings.append(&mut notices);
        report.describe_mesh(&mesh);
        if mesh.faces.is_empty() {
            let what = format!("{}: the mesh has no faces", self.input.display());
            return Err(SutureError::Unsuitable { what });
        }
        let progress = Progress::new(common.quiet);
        let options = SewOptions { resolution: self.resolution, ..SewOptions::default() };
        let sewn = sew(&mesh, &options, &progress)?;
        report.describe_sewn(&sewn);
        if progress.interrupted() {
            return Err(SutureError::Interrupted);
        }
        let made = output::Made {
            model: PageModel {
                certificate: Some(&sewn.certificate),
                deviation: Some(&sewn.deviation),
                mesh: Some(&mesh),
                hull: sewn.hull.clone(),
                degrees: degrees(&sewn.surface),
                ..PageModel::new("", &sewn.surface, &sewn.tessellation)
            },
            view: &view,
            cad: &self.cad,
            diagonal: mesh.diagonal(),
        };
        output::all(&outputs, &made, &progress, report)?;
        drop(progress);
        if !common.quiet {
            print!("{}", summary(report));
        }
        Ok(report.holds())
    }
}
