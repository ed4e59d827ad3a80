//! `suture export`.

use suture::tessellate::{TessellationOptions, tessellate};
use suture::{Report, SutureError};

use super::commands::{settings, summary};
use super::progress::Progress;
use super::{args, input, output};

/// Loads the surface and writes it in every format asked for.
pub(crate) fn run(a: &args::Export, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    let outputs: Vec<output::Output> =
        a.output.iter().map(|p| output::Output::parse(p)).collect::<Result<_, _>>()?;
    let view = output::view_options(&a.picture)?;
    report.settings = settings(a);
    let surface = input::surface(&a.surface)?;
    let mut options = TessellationOptions::default();
    if let Some(chord) = a.chord {
        options.chord = chord;
    }
    let tessellation = tessellate(&surface, &options)?;
    report.describe_tessellation(&tessellation);
    let made = output::Made {
        model: suture::view::PageModel::new("", &surface, &tessellation),
        view: &view,
        cad: &a.cad,
        diagonal: tessellation.mesh.diagonal(),
    };
    let progress = Progress::new(common.quiet);
    output::all(&outputs, &made, &progress, report)?;
    drop(progress);
    if !common.quiet {
        print!("{}", summary(report));
    }
    Ok(report.holds())
}
