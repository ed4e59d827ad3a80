//! The commands.

use std::path::{Path, PathBuf};

use clap::CommandFactory;
use suture::blend::{Intent, WidthOptions};
use suture::mesh::{TriMesh, shapes};
use suture::view::PageModel;
use suture::{
    Fairness, ReconstructOptions, Refinement, Report, Splits, Stages, SutureError, Watch, degrees,
    reconstruct, repair_all, samples,
};

use super::args::{self, Args, Command};
use super::progress::Progress;
use super::{input, output};

/// Runs the command; `Ok(false)`: there is a result, but it failed its checks.
pub(crate) fn run(args: &Args) -> Result<bool, SutureError> {
    if let Some(threads) = args.common.threads {
        // Fails only when a pool exists already, and none can at this point.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
    let mut report = Report::new(name(&args.command), input_of(&args.command));
    let start = std::time::Instant::now();
    let result = match &args.command {
        Command::Reconstruct(a) => reconstruct_command(a, &args.common, &mut report),
        Command::Apatch(a) => super::apatch::run(a, &args.common, &mut report),
        Command::Bubble(a) => super::bubble::run(a, &args.common, &mut report),
        Command::Fill(a) => super::fill::run(a, &args.common, &mut report),
        Command::View(a) => super::view::run(a, &args.common, &mut report),
        Command::Compare(a) => super::compare::run(a, &args.common, &mut report),
        Command::Segment(a) => super::segment::run(a, &args.common, &mut report),
        Command::Check(a) => check_command(a, &args.common, &mut report),
        Command::Certify(a) => certify_command(a, &args.common, &mut report),
        Command::Export(a) => super::export::run(a, &args.common, &mut report),
        Command::Completions { shell } => {
            clap_complete::generate(*shell, &mut Args::command(), "suture", &mut std::io::stdout());
            return Ok(true);
        }
        Command::Man => {
            let page = clap_mangen::Man::new(Args::command());
            let print = page.render(&mut std::io::stdout());
            print.map_err(|source| SutureError::File { path: "standard output".into(), source })?;
            return Ok(true);
        }
        Command::Schema => {
            let schema = serde_json::to_string_pretty(&schemars::schema_for!(Report));
            println!("{}", schema.unwrap_or_default());
            return Ok(true);
        }
    };
    if let Err(error) = &result {
        report.fail(error);
    }
    report.seconds.insert("total".into(), start.elapsed().as_secs_f64());
    report.peak_memory_bytes = suture::report::peak_memory();
    if let Some(path) = &args.common.json {
        output::report(&report, path)?;
    }
    result
}

fn name(command: &Command) -> &'static str {
    match command {
        Command::Reconstruct(_) => "reconstruct",
        Command::Apatch(_) => "apatch",
        Command::Bubble(_) => "bubble",
        Command::Fill(_) => "fill",
        Command::View(_) => "view",
        Command::Compare(_) => "compare",
        Command::Segment(_) => "segment",
        Command::Check(_) => "check",
        Command::Certify(_) => "certify",
        Command::Export(_) => "export",
        Command::Completions { .. } => "completions",
        Command::Man => "man",
        Command::Schema => "schema",
    }
}

fn input_of(command: &Command) -> Option<&Path> {
    match command {
        Command::Reconstruct(a) => a.input.as_deref(),
        Command::Apatch(a) => Some(&a.local.input),
        Command::Bubble(a) => Some(&a.local.input),
        Command::Fill(a) => Some(&a.input),
        Command::View(a) => Some(&a.input),
        Command::Compare(a) => Some(&a.input),
        Command::Segment(a) => Some(&a.input),
        Command::Check(a) => Some(&a.input),
        Command::Certify(a) => Some(&a.surface),
        Command::Export(a) => Some(&a.surface),
        _ => None,
    }
}

/// Where everything goes when no input and no output are named.
const DEFAULT_FOLDER: &str = "suture-out";

fn reconstruct_command(
    a: &args::Reconstruct,
    common: &args::Common,
    report: &mut Report,
) -> Result<bool, SutureError> {
    let mut paths = a.output.clone();
    let mut json = None;
    if a.input.is_none() && paths.is_empty() {
        let folder = PathBuf::from(DEFAULT_FOLDER);
        std::fs::create_dir_all(&folder)
            .map_err(|source| SutureError::File { path: folder.clone(), source })?;
        paths =
            ["surface.glb", "surface.json", "surface.png", "surface.html"].map(|f| folder.join(f)).to_vec();
        json = common.json.is_none().then(|| folder.join("report.json"));
    }
    let outputs: Vec<output::Output> =
        paths.iter().map(|p| output::Output::parse(p)).collect::<Result<_, _>>()?;
    let view = output::view_options(&a.picture)?;
    report.settings = settings(a);

    let mut notices = Vec::new();
    let mesh = match &a.input {
        Some(path) => input::mesh(path, a.repair, &mut notices)?,
        None => shapes::pebble(),
    };
    report.warnings.append(&mut notices);
    report.describe_mesh(&mesh);
    suitable(report)?;

    let stages = Stages {
        segment: input::segmentation(&a.segmentation)?,
        parameterize: input::parameterization(&a.shape),
        fit: Box::new(input::fit(&a.shape)?),
        maps: input::maps(&a.shape),
    };
    let options = options(a);
    let progress = Progress::new(common.quiet);
    let result = reconstruct(&mesh, &stages, &options, &progress)?;
    report.describe_reconstruction(&result, mesh.diagonal());
    if progress.interrupted() {
        return Err(SutureError::Interrupted);
    }
    let made = output::Made {
        model: PageModel {
            certificate: Some(&result.certificate),
            deviation: Some(&result.deviation),
            mesh: Some(&mesh),
            labels: Some(&result.labels),
            degrees: degrees(&result.blend.surface),
            ..PageModel::new("", &result.blend.surface, &result.tessellation)
        },
        view: &view,
        cad: &a.cad,
        diagonal: mesh.diagonal(),
    };
    output::all(&outputs, &made, &progress, report)?;
    drop(progress);
    if let Some(path) = json {
        output::report(report, &path)?;
        report.outputs.push(path.display().to_string());
    }
    if !common.quiet {
        print!("{}", summary(report));
    }
    Ok(report.holds())
}

fn options(a: &args::Reconstruct) -> ReconstructOptions {
    let shape = &a.shape;
    let mut options = ReconstructOptions::default();
    let default = WidthOptions::default();
    options.widths = WidthOptions {
        intent: match shape.intent {
            args::Intent::Fidelity => Intent::Fidelity,
            args::Intent::Fillet => Intent::Fillet,
        },
        d_in: shape.d_in,
        d_out: shape.d_out,
        d_min: shape.d_min,
        d_curv: shape.d_curv.unwrap_or(default.d_curv),
        ..default
    };
    // Whoever brings segments wants to keep them: they are split only where there is no other way.
    let given = a.segmentation.labels.is_some() || a.segmentation.waypoints.is_some();
    let tolerance = shape.tolerance.or(options.splits.tolerance).filter(|_| !given);
    options.splits = Splits { rounds: shape.splits, tolerance };
    if shape.edge_arcs {
        options.fair = Fairness::Edges;
    }
    if shape.keep_mesh {
        options.refinement = Refinement::none();
    }
    if let Some(chord) = shape.chord {
        options.tessellation.chord = chord;
    }
    options
}

/// Meshes that no segmentation can help are refused before any work, with the way out.
pub(super) fn suitable(report: &Report) -> Result<(), SutureError> {
    let Some(input) = &report.input else {
        return Ok(());
    };
    let unsuitable = |what: String| Err(SutureError::Unsuitable { what });
    if input.components > 1 {
        return unsuitable(format!(
            "the mesh has {} components; reconstruct them one by one (weld vertices with --repair if they only seem apart)",
            input.components
        ));
    }
    if input.boundary_loops > 0 {
        return unsuitable(format!(
            "the mesh has {} boundary loops; only closed meshes can be reconstructed: close the holes first",
            input.boundary_loops
        ));
    }
    Ok(())
}

/// Whether a mesh can be reconstructed at all.
pub(crate) fn suitable_mesh(mesh: &TriMesh) -> Result<(), SutureError> {
    let mut report = Report::default();
    report.describe_mesh(mesh);
    suitable(&report)
}

pub(crate) fn settings(arguments: &impl serde::Serialize) -> serde_json::Map<String, serde_json::Value> {
    match serde_json::to_value(arguments) {
        Ok(serde_json::Value::Object(map)) => map,
        _ => serde_json::Map::new(),
    }
}

/// What people read at the end.
pub(crate) fn summary(report: &Report) -> String {
    use std::fmt::Write;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let mut line = |text: String| {
        let _ = writeln!(out, "{text}");
    };
    if let Some(i) = &report.input {
        let genus = i.genus.map_or("none".into(), |g| g.to_string());
        let open = if i.boundary_loops > 0 {
            format!(", {} boundary loops", i.boundary_loops)
        } else {
            String::new()
        };
        line(format!("mesh         {} vertices, {} triangles, genus {genus}{open}", i.vertices, i.faces));
    }
    if let Some(s) = &report.surface {
        let count = |k: &str| s.patches.get(k).copied().unwrap_or(0);
        if s.charts > 0 {
            line(format!(
                "surface      {} trimmed B-splines, {} strips, {} N-blends ({} patches when the strips of an arc are merged)",
                count("trimmed"),
                count("strip"),
                count("nblend"),
                s.patches_merged
            ));
        } else {
            let all: Vec<String> = s.patches.iter().map(|(kind, n)| format!("{n} {kind} patches")).collect();
            line(format!("surface      {}", all.join(", ")));
        }
        if let Some([low, high]) = s.widths {
            line(format!("widths       {low:.4} to {high:.4} of the diagonal"));
        }
    }
    if let Some(c) = &report.certificate {
        line(format!(
            "certificate  {} claimed, {} measured over {} seams: position {:.1e}, normal {:.1e} rad, curvature {:.1e}",
            c.claimed,
            c.measured.as_deref().unwrap_or("nothing"),
            c.seams,
            c.position,
            c.normal,
            c.curvature
        ));
    }
    if let Some(d) = &report.deviation {
        let percent = |x: f64| 100.0 * x;
        line(format!(
            "deviation    vertices to surface: rms {:.4} %, max {:.4} %; surface to facets: rms {:.4} %, max {:.4} % of the diagonal",
            percent(d.mesh_to_surface.rms),
            percent(d.mesh_to_surface.max),
            percent(d.surface_to_mesh.rms),
            percent(d.surface_to_mesh.max)
        ));
    }
    if let Some(t) = &report.tessellation {
        let input = report.input.as_ref();
        let open = input.is_some_and(|i| i.boundary_loops > 0 && i.boundary_loops == t.boundary_loops);
        let bounded = input.is_none() && report.certificate.as_ref().is_some_and(|c| c.open_edges > 0);
        let yes = |b: bool, word: &str| if b { word.to_owned() } else { format!("NOT {word}") };
        line(format!(
            "tessellation {} triangles, {}, {}, {}, genus {}",
            t.triangles,
            match (open, bounded && !t.closed) {
                (true, _) => "open as the mesh is".into(),
                (_, true) => "open where edges have no seam".into(),
                _ => yes(t.closed, "closed"),
            },
            yes(t.manifold, "manifold"),
            yes(t.oriented, "oriented"),
            t.genus.map_or("none".into(), |g| g.to_string())
        ));
    }
    if let Some(s) = &report.step {
        line(format!(
            "STEP         {} faces, {} edges, {} vertices; from the surface {:.1e}, between faces {:.1e} of the diagonal, {:.4}°, curvature {:.2} %",
            s.faces,
            s.edges,
            s.vertices,
            s.position,
            s.gap,
            s.angle.to_degrees(),
            100.0 * s.curvature
        ));
    }
    for warning in &report.warnings {
        line(format!("note         {warning}"));
    }
    for path in &report.outputs {
        line(format!("wrote        {path}"));
    }
    out
}

fn check_command(a: &args::Check, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    let mut notices = Vec::new();
    let mut mesh: TriMesh = input::mesh(&a.input, false, &mut notices)?;
    let found = suture::mesh::check(&mesh);
    report.describe_mesh(&mesh);
    report.warnings.append(&mut notices);
    if !common.quiet {
        println!("{found}");
    }
    if let Some(path) = &a.output {
        report.warnings.extend(repair_all(&mut mesh));
        suture::mesh::io::write(path, &mesh)
            .map_err(|source| SutureError::Mesh { path: path.clone(), source })?;
        report.outputs.push(path.display().to_string());
    }
    if !common.quiet {
        for warning in &report.warnings {
            println!("note: {warning}");
        }
    }
    Ok(found.is_sound())
}

fn certify_command(
    a: &args::Certify,
    common: &args::Common,
    report: &mut Report,
) -> Result<bool, SutureError> {
    let surface = input::surface(&a.surface)?;
    let options = ReconstructOptions::default();
    let tessellation = suture::tessellate::tessellate(&surface, &options.tessellation)?;
    let mut notices = Vec::new();
    let mesh = a.mesh.as_ref().map(|path| input::mesh(path, false, &mut notices)).transpose()?;
    report.warnings.append(&mut notices);
    let diagonal = mesh.as_ref().unwrap_or(&tessellation.mesh).diagonal();
    report.describe_certificate(&suture::certify::certify(&surface, diagonal, &options.certify)?);
    report.describe_tessellation(&tessellation);
    if let Some(mesh) = &mesh {
        report.describe_mesh(mesh);
        let deviation = suture::certify::deviation(mesh, &surface, &samples(&tessellation))?;
        report.describe_deviation(&deviation);
    }
    if !common.quiet {
        print!("{}", summary(report));
    }
    Ok(report.holds())
}
