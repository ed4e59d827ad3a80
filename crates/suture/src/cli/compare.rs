//! `suture compare`: the three methods for meshes side by side.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args as ClapArgs;
use serde::Serialize;
use suture::apatch::{ApatchOptions, ApatchReport};
use suture::bubble::{BubbleOptions, BubbleReport};
use suture::mesh::TriMesh;
use suture::report::Compared;
use suture::view::{Page, PageModel};
use suture::{
    NormalSource, ReconstructOptions, Reconstruction, Report, SewOptions, Sewn, Stages, SutureError, Watch,
    degrees, reconstruct, sew_apatch, sew_bubble, vertex_normals,
};

use super::commands::settings;
use super::progress::Progress;
use super::{args, input, output};

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Compare {
    /// The mesh: .obj, .stl, .ply or .off
    #[serde(skip)]
    pub(crate) input: PathBuf,
    /// Where to write the page: .html; with --json alone no page is needed
    #[arg(long, short, value_name = "FILE")]
    #[serde(skip)]
    output: Option<PathBuf>,
    /// Order of smoothness of the bubble surface: 0 to 4
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(0..=4))]
    order: u8,
    /// Repair first what can be repaired safely
    #[arg(long)]
    repair: bool,
    #[command(flatten)]
    #[serde(flatten)]
    picture: args::Picture,
}

/// A surface of one of the methods.
enum Made {
    Reconstruct(Box<Reconstruction>),
    Apatch(Box<Sewn<ApatchReport>>),
    Bubble(Box<Sewn<BubbleReport>>),
}

/// Makes all three; good if every method that has a result holds its claim, and there is one.
pub(crate) fn run(a: &Compare, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    report.settings = settings(a);
    let view = output::view_options(&a.picture)?;
    if let Some(path) = &a.output {
        output::Output::page(path)?;
    }
    let mut notices = Vec::new();
    let mesh = input::mesh(&a.input, a.repair, &mut notices)?;
    report.warnings.append(&mut notices);
    report.describe_mesh(&mesh);
    let progress = Progress::new(common.quiet);
    let mut made = Vec::new();
    for method in ["reconstruct", "apatch", "bubble"] {
        let start = Instant::now();
        let mut own = Report::new(method, Some(&a.input));
        own.input = report.input.clone();
        match make(method, a, &mesh, &progress) {
            Err(SutureError::Interrupted) => return Err(SutureError::Interrupted),
            Err(error) => {
                report.warnings.push(format!("{method}: {error}"));
                own.fail(&error);
                report.compared.push(compared(&own, String::new()));
            }
            Ok(surface) => {
                surface.describe(&mut own, mesh.diagonal());
                own.seconds.insert("total".into(), start.elapsed().as_secs_f64());
                let names = surface.degrees();
                report.compared.push(compared(&own, summary_of(&names)));
                made.push((method, surface, own, names));
            }
        }
    }
    if progress.interrupted() {
        return Err(SutureError::Interrupted);
    }
    drop(progress);
    if let (Some(path), false) = (&a.output, made.is_empty()) {
        let models = made.iter().map(|(method, surface, own, names)| PageModel {
            mesh: Some(&mesh),
            degrees: names.clone(),
            report: output::snapshot(own),
            ..surface.model(method)
        });
        let page = Page { title: output::title(report), models: models.collect(), view };
        page.write_html(path)?;
        report.outputs.push(path.display().to_string());
    }
    if !common.quiet {
        print!("{}", text(report));
    }
    Ok(!made.is_empty() && made.iter().all(|(_, _, own, _)| own.holds()))
}

fn make(method: &str, a: &Compare, mesh: &TriMesh, watch: &dyn Watch) -> Result<Made, SutureError> {
    let options = SewOptions::default();
    let normals = || vertex_normals(mesh, NormalSource::Best);
    Ok(match method {
        "reconstruct" => {
            super::commands::suitable_mesh(mesh)?;
            let made = reconstruct(mesh, &Stages::default(), &ReconstructOptions::default(), watch)?;
            Made::Reconstruct(Box::new(made))
        }
        "apatch" => {
            let apatches =
                ApatchOptions { estimated: NormalSource::Best.estimates(mesh), ..ApatchOptions::default() };
            Made::Apatch(Box::new(sew_apatch(mesh, &normals()?, &apatches, &options, watch)?))
        }
        _ => {
            let bubbles = BubbleOptions { order: a.order.into(), ..BubbleOptions::default() };
            Made::Bubble(Box::new(sew_bubble(mesh, &normals()?, &bubbles, &options, watch)?))
        }
    })
}

impl Made {
    fn describe(&self, report: &mut Report, diagonal: f64) {
        match self {
            Self::Reconstruct(r) => report.describe_reconstruction(r, diagonal),
            Self::Apatch(s) => report.describe_sewn(s),
            Self::Bubble(s) => report.describe_sewn(s),
        }
    }

    fn degrees(&self) -> Vec<String> {
        degrees(match self {
            Self::Reconstruct(r) => &r.blend.surface,
            Self::Apatch(s) => &s.surface,
            Self::Bubble(s) => &s.surface,
        })
    }

    fn model(&self, name: &str) -> PageModel<'_> {
        match self {
            Self::Reconstruct(r) => PageModel {
                certificate: Some(&r.certificate),
                deviation: Some(&r.deviation),
                labels: Some(&r.labels),
                ..PageModel::new(name, &r.blend.surface, &r.tessellation)
            },
            Self::Apatch(s) => sewn(name, s),
            Self::Bubble(s) => sewn(name, s),
        }
    }
}

fn sewn<'a, R>(name: &str, s: &'a Sewn<R>) -> PageModel<'a> {
    PageModel {
        certificate: Some(&s.certificate),
        deviation: Some(&s.deviation),
        hull: s.hull.clone(),
        ..PageModel::new(name, &s.surface, &s.tessellation)
    }
}

fn summary_of(degrees: &[String]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for name in degrees {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    match names.len() {
        0..=4 => names.join("; "),
        n => format!("{}; and {} more", names[..4].join("; "), n - 4),
    }
}

fn compared(own: &Report, degree: String) -> Compared {
    let certificate = own.certificate.as_ref();
    Compared {
        method: own.command.clone(),
        claimed: certificate.map(|c| c.claimed.clone()),
        measured: certificate.and_then(|c| c.measured.clone()),
        patches: own.surface.as_ref().map_or(0, |s| s.patches.values().sum()),
        patches_merged: own.surface.as_ref().map_or(0, |s| s.patches_merged),
        degree,
        normal: certificate.map(|c| c.normal),
        curvature: certificate.map(|c| c.curvature),
        mesh_to_surface: own.deviation.as_ref().map(|d| d.mesh_to_surface),
        surface_to_mesh: own.deviation.as_ref().map(|d| d.surface_to_mesh),
        triangles: own.tessellation.map_or(0, |t| t.triangles),
        seconds: own.seconds.get("total").copied(),
        error: own.error.clone(),
    }
}

/// The comparison as people read it.
fn text(report: &Report) -> String {
    use std::fmt::Write;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "method       order  patches    rms %    max %        s  degree");
    for c in &report.compared {
        if let Some(error) = &c.error {
            let _ = writeln!(out, "{:<12} none: {}", c.method, error.message);
            continue;
        }
        let (rms, max) = c.mesh_to_surface.map_or((f64::NAN, f64::NAN), |d| (100.0 * d.rms, 100.0 * d.max));
        let _ = writeln!(
            out,
            "{:<12} {:<5} {:>8} {rms:>8.4} {max:>8.4} {:>8.2}  {}",
            c.method,
            c.measured.as_deref().unwrap_or("none"),
            c.patches,
            c.seconds.unwrap_or(f64::NAN),
            c.degree
        );
    }
    for path in &report.outputs {
        let _ = writeln!(out, "wrote        {path}");
    }
    out
}
