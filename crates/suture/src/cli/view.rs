//! `suture view`.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use serde::Serialize;
use suture::certify::Deviation;
use suture::mesh::TriMesh;
use suture::segment::read_labels;
use suture::view::PageModel;
use suture::{ReconstructOptions, Report, SutureError, degrees, facets, hull_of, samples};

use super::commands::{settings, summary};
use super::progress::Progress;
use super::{args, input, output};

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct View {
    /// A surface as written by `-o NAME.json`, or a mesh: .obj, .stl, .ply or .off
    #[serde(skip)]
    pub(crate) input: PathBuf,
    /// Where to write: .html (one page for any browser) or .png; a surface also leaves in every other format; may be repeated
    #[arg(long, short, value_name = "FILE", required = true)]
    #[serde(skip)]
    output: Vec<PathBuf>,
    /// The mesh that the surface was made from: shown over it, and its distance measured
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    mesh: Option<PathBuf>,
    /// Segments of the mesh: one label per face, one per line
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    labels: Option<PathBuf>,
    /// Largest distance of the tessellation's chords from the surface
    #[arg(long, value_name = "LENGTH")]
    chord: Option<f64>,
    #[command(flatten)]
    #[serde(flatten)]
    cad: args::Cad,
    #[command(flatten)]
    #[serde(flatten)]
    picture: args::Picture,
}

/// Shows; whether the seams hold what they claim.
pub(crate) fn run(a: &View, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    report.settings = settings(a);
    let outputs: Vec<output::Output> =
        a.output.iter().map(|p| output::Output::parse(p)).collect::<Result<_, _>>()?;
    let view = output::view_options(&a.picture)?;
    let mut notices = Vec::new();
    let mut mesh = a.mesh.as_ref().map(|path| input::mesh(path, false, &mut notices)).transpose()?;
    let mut options = ReconstructOptions::default();
    options.tessellation.chord = a.chord.unwrap_or(options.tessellation.chord);
    let of_mesh = !a.input.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let (surface, tessellation) = if of_mesh {
        let given = input::mesh(&a.input, false, &mut notices)?;
        report.describe_mesh(&given);
        let facets = facets(&given).map_err(|e| SutureError::Internal { what: e.to_string() })?;
        mesh = mesh.or(a.labels.is_some().then_some(given));
        facets
    } else {
        let surface = input::surface(&a.input)?;
        let tessellation = suture::tessellate::tessellate(&surface, &options.tessellation)?;
        (surface, tessellation)
    };
    report.warnings.append(&mut notices);
    let labels = labels(a, mesh.as_ref())?;
    let diagonal = mesh.as_ref().unwrap_or(&tessellation.mesh).diagonal();
    let certificate = suture::certify::certify(&surface, diagonal, &options.certify)?;
    report.describe_certificate(&certificate);
    report.describe_tessellation(&tessellation);
    let mut deviation: Option<Deviation> = None;
    if let Some(mesh) = mesh.as_ref().filter(|_| !of_mesh) {
        report.describe_mesh(mesh);
        let measured = suture::certify::deviation(mesh, &surface, &samples(&tessellation))?;
        report.describe_deviation(&measured);
        deviation = Some(measured);
    }
    let model = PageModel {
        certificate: Some(&certificate),
        deviation: deviation.as_ref(),
        mesh: mesh.as_ref(),
        labels: labels.as_deref(),
        hull: hull_of(&surface),
        degrees: degrees(&surface),
        ..PageModel::new("", &surface, &tessellation)
    };
    let progress = Progress::new(common.quiet);
    output::all(&outputs, &output::Made { model, view: &view, cad: &a.cad, diagonal }, &progress, report)?;
    drop(progress);
    if !common.quiet {
        print!("{}", summary(report));
    }
    // Looking at a mesh judges nothing.
    Ok(of_mesh || report.holds())
}

fn labels(a: &View, mesh: Option<&TriMesh>) -> Result<Option<Vec<u32>>, SutureError> {
    let Some(path) = &a.labels else { return Ok(None) };
    let labels = read_labels(&input::text(path)?)?;
    let faces = mesh.map_or(0, |m| m.faces.len());
    if labels.len() != faces {
        let what = format!(
            "{}: {} labels for {faces} faces; name their mesh with --mesh",
            path.display(),
            labels.len()
        );
        return Err(SutureError::Unsuitable { what });
    }
    Ok(Some(labels))
}
