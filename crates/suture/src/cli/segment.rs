//! `suture segment`.

use std::path::{Path, PathBuf};

use clap::Args as ClapArgs;
use serde::Serialize;
use suture::mesh::{Topology, TriMesh};
use suture::param::Recommended;
use suture::report::SurfaceReport;
use suture::segment::{Segmentation, colouring, write_labels};
use suture::view::{Page, PageModel, ViewOptions};
use suture::{Report, SegmentsReport, SutureError, describe_segments, facets};

use super::commands::{settings, suitable};
use super::{args, input, output};

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Segment {
    /// The mesh
    #[serde(skip)]
    pub(crate) input: PathBuf,
    /// Where to write: labels, one per face and line (.labels, .txt; to standard output without this), the mesh with coloured
    /// segments (.ply) or a page that shows them (.html); may be repeated. Labels belong to the faces of the file; `reconstruct` without
    /// labels segments the mesh after it was refined, and may find other borders
    #[arg(long, short, value_name = "FILE")]
    #[serde(skip)]
    output: Vec<PathBuf>,
    /// Repair first what can be repaired safely
    #[arg(long)]
    repair: bool,
    #[command(flatten)]
    #[serde(flatten)]
    segmentation: args::Segmentation,
}

/// A file to write.
#[derive(Clone, Copy)]
enum Form {
    Labels,
    Ply,
    Page,
}

impl Form {
    fn of(path: &Path) -> Result<Self, SutureError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "labels" | "txt" | "" => Ok(Self::Labels),
            "ply" => Ok(Self::Ply),
            "html" | "htm" => Ok(Self::Page),
            other => Err(SutureError::Unsuitable {
                what: format!(
                    "{}: segments are written as labels (.labels, .txt), coloured mesh (.ply) or page (.html), not as .{other}",
                    path.display()
                ),
            }),
        }
    }
}

/// Segments a mesh and says what came of it.
pub(crate) fn run(a: &Segment, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    report.settings = settings(a);
    let forms: Vec<Form> = a.output.iter().map(|p| Form::of(p)).collect::<Result<_, _>>()?;
    let mut notices = Vec::new();
    let mesh = input::mesh(&a.input, a.repair, &mut notices)?;
    report.warnings.append(&mut notices);
    report.describe_mesh(&mesh);
    suitable(report)?;
    let topology = Topology::build(&mesh)?;
    let segmentation = input::segmentation(&a.segmentation)?.segment(&mesh, &topology)?;
    report.surface = Some(SurfaceReport {
        charts: segmentation.charts.len(),
        corners: segmentation.corners.len(),
        arcs: segmentation.arcs.len(),
        ..Default::default()
    });
    let segments = describe_segments(&mesh, &topology, &segmentation, &Recommended::default());
    report.segments = Some(segments.clone());
    for (path, form) in a.output.iter().zip(forms) {
        write(path, form, &mesh, &segmentation, report)?;
        report.outputs.push(path.display().to_string());
    }
    if a.output.is_empty() {
        print!("{}", write_labels(&segmentation.labels));
    } else if !common.quiet {
        print!("{}", table(&segments));
    }
    Ok(true)
}

fn write(
    path: &Path,
    form: Form,
    mesh: &TriMesh,
    segmentation: &Segmentation,
    report: &Report,
) -> Result<(), SutureError> {
    match form {
        Form::Labels => output::text(path, &write_labels(&segmentation.labels)),
        Form::Ply => {
            let of_chart = colouring(segmentation);
            let colours: Vec<[u8; 3]> =
                segmentation.labels.iter().map(|&l| PALETTE[of_chart[l as usize] % PALETTE.len()]).collect();
            suture::mesh::io::write_coloured_ply(path, mesh, &colours)
                .map_err(|source| SutureError::Mesh { path: path.to_owned(), source })
        }
        Form::Page => {
            let (surface, tessellation) =
                facets(mesh).map_err(|e| SutureError::Internal { what: e.to_string() })?;
            let model = PageModel {
                mesh: Some(mesh),
                labels: Some(&segmentation.labels),
                report: output::snapshot(report),
                ..PageModel::new("", &surface, &tessellation)
            };
            let view = ViewOptions::default();
            Page { title: output::title(report), models: vec![model], view }.write_html(path)?;
            Ok(())
        }
    }
}

/// Colours that differ in hue or in lightness from each other, also to most people who are colour-blind (P. Tol, 2021, "muted").
const PALETTE: [[u8; 3]; 10] = [
    [136, 204, 238],
    [204, 102, 119],
    [221, 204, 119],
    [17, 119, 51],
    [51, 34, 136],
    [170, 68, 153],
    [68, 170, 153],
    [153, 153, 51],
    [136, 34, 85],
    [221, 221, 221],
];

/// One line per segment, then what is worst.
fn table(segments: &SegmentsReport) -> String {
    use std::fmt::Write;
    let SegmentsReport { charts, corners, arcs } = segments;
    let mut out = String::from("segment   faces  area %  corners  shortest arc %  area ratio  stretch\n");
    for (s, chart) in charts.iter().enumerate() {
        let beside = arcs.iter().filter(|a| a.charts.contains(&(s as u32)));
        let shortest = beside.map(|a| a.length).fold(f64::INFINITY, f64::min);
        let flat = match (&chart.flattening, &chart.error) {
            (Some(f), _) if f.flips + f.overlaps > 0 => {
                format!("folds: {} triangles turned over, {} overlaps", f.flips, f.overlaps)
            }
            (Some(f), _) => format!("{:>10.1}  {:>7.1}", f.area_ratio, f.stretch),
            (None, error) => error.clone().unwrap_or_default(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{s:>7}  {:>6}  {:>6.2}  {:>7}  {:>14.2}  {flat}",
            chart.faces,
            100.0 * chart.area,
            chart.corners,
            100.0 * shortest
        );
    }
    let valences: Vec<String> = (3..=corners.iter().map(|c| c.valence).max().unwrap_or(3))
        .map(|n| format!("{} of {n} segments", corners.iter().filter(|c| c.valence == n).count()))
        .collect();
    let narrowest = arcs.iter().map(|a| a.width).fold(f64::INFINITY, f64::min);
    let _ = writeln!(
        out,
        "segments     {} charts, {} arcs, {} corners ({}); the shortest arc admits blends of {narrowest:.4} of the diagonal",
        charts.len(),
        arcs.len(),
        corners.len(),
        valences.join(", ")
    );
    out
}
