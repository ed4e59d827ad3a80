//! `suture apatch`.

use clap::{Args as ClapArgs, ValueEnum};
use serde::Serialize;
use suture::apatch::{ApatchOptions, ApexWeight};
use suture::{Report, SutureError, sew_apatch, vertex_normals};

use super::args;
use super::commands::settings;
use super::local::Local;

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Apatch {
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) local: Local,
    /// Where the one free number per face comes from
    #[arg(long, value_enum, default_value_t)]
    apex: Apex,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
enum Apex {
    /// The quadratic that the neighbours suggest: quadrics are reproduced
    #[default]
    Neighbours,
    /// The closest linear function, as in the paper: flatter
    Paper,
}

/// Lays the surface; whether everything that was claimed holds, single-sheetedness included.
pub(crate) fn run(a: &Apatch, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    report.settings = settings(a);
    let weight = match a.apex {
        Apex::Neighbours => ApexWeight::Neighbours,
        Apex::Paper => ApexWeight::Paper,
    };
    let mut simple = true;
    let holds = a.local.run(common, report, |mesh, options, watch| {
        let source = a.local.source();
        let normals = vertex_normals(mesh, source)?;
        let apatches = ApatchOptions {
            weight: weight.clone(),
            estimated: source.estimates(mesh),
            ..ApatchOptions::default()
        };
        let sewn = sew_apatch(mesh, &normals, &apatches, options, watch)?;
        simple = sewn.report.violated_faces.is_empty() && sewn.report.violated_edges.is_empty();
        Ok(sewn)
    })?;
    Ok(holds && simple)
}
