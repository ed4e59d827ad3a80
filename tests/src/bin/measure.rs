//! Reconstructs every mesh at hand and prints the tables of docs/measurements.md.
//!
//! `cargo run --release -p suture-tests --bin measure [NAME…]`: only cases whose name contains one of the words.

use std::time::Instant;

use suture::segment::Labels;
use suture::surface::PatchKind;
use suture_tests::{PAPER, labels, mesh, own, run, run_automatic, shared};

/// Meshes of the collection and the labels given for them, by hand and by another program.
const GIVEN: [(&str, &str); 8] = [
    ("good/sphere.obj", "labels/sphere.cube6.labels"),
    ("good/torus.obj", "labels/torus.grid8.labels"),
    ("good/blobby.off", "labels/blobby.vor.labels"),
    ("good/spot.obj", "labels/spot.vor.labels"),
    ("good/fandisk.off", "labels/fandisk.dihedral25_raw.labels"),
    ("good/knot1.off", "labels/knot1.vor.labels"),
    ("good/eight.off", "labels/eight.vor.labels"),
    ("good/wingnut.obj", "labels/wingnut.vor.labels"),
];
const AUTO: [&str; 10] = [
    "sphere.obj",
    "torus.obj",
    "blobby.off",
    "spot.obj",
    "fish.obj",
    "hand.off",
    "cow.off",
    "knot1.off",
    "eight.off",
    "wingnut.obj",
];

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "| case | segments | N-blends | strips | merged patches | rms % | max % | position | normal | curvature | Jacobian | width % | largest curvature | topology | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let case = |name: String, file: std::path::PathBuf, given: Option<Labels>| {
        if wanted.is_empty() || wanted.iter().any(|w| name.contains(w.as_str())) {
            row(&name, &file, given);
        }
    };
    for (name, ..) in PAPER {
        let file = own(&format!("paper/{name}.obj"));
        case(format!("{name}, labels"), file.clone(), Some(labels(&own(&format!("paper/{name}.labels")))));
        case(format!("{name}, automatic"), file, None);
    }
    for (file, label) in GIVEN {
        if let (Some(file), Some(path)) = (shared(file), shared(label)) {
            case(format!("{label}, given"), file, Some(labels(&path)));
        }
    }
    for file in AUTO {
        let stem = file.split('.').next().unwrap_or(file);
        let Some(path) = shared(&format!("good/{file}")) else { continue };
        if let Some(label) = shared(&format!("labels_auto/{stem}.labels")) {
            case(format!("{stem}, labels_auto"), path.clone(), Some(labels(&label)));
        }
        case(format!("{stem}, automatic"), path, None);
    }
}

fn row(name: &str, file: &std::path::Path, given: Option<Labels>) {
    let input = mesh(file);
    let start = Instant::now();
    let result = match given {
        Some(labels) => run(&input, Box::new(labels)),
        None => run_automatic(&input),
    };
    let r = match result {
        Ok(r) => r,
        Err(e) => {
            println!("| {name} | {e} |");
            return;
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    let count =
        |f: &dyn Fn(PatchKind) -> bool| r.blend.surface.patches().iter().filter(|p| f(p.kind())).count();
    let strips = count(&|k| matches!(k, PatchKind::Strip { .. } | PatchKind::AdjacentStrip));
    let gons = count(&|k| matches!(k, PatchKind::NBlend { .. }));
    let d = &r.deviation.mesh_to_surface;
    let widths = &r.blend.widths.corner;
    let narrow = widths.iter().copied().fold(f64::INFINITY, f64::min) / input.diagonal();
    let check = suture::mesh::check(&r.tessellation.mesh);
    let genus = suture::mesh::check(&input).genus;
    let topology = check.closed && check.manifold && check.oriented && check.genus == genus;
    let c = &r.certificate;
    println!(
        "| {name} | {} | {gons} | {strips} | {} | {:.4} | {:.3} | {:.1e} | {:.1e} | {:.1e} | {:.2} | {:.2} | {:.0} | {} | {seconds:.1} |",
        r.segmentation.charts.len(),
        r.segmentation.charts.len() + r.segmentation.corners.len() + r.segmentation.arcs.len(),
        100.0 * d.rms,
        100.0 * d.max,
        c.position,
        c.normal,
        c.curvature,
        r.blend.maps.jacobian,
        100.0 * narrow,
        c.largest_curvature,
        if topology { "ok" } else { "WRONG" },
    );
    if std::env::var_os("SUTURE_VERBOSE").is_some() {
        let kinds: Vec<String> = r
            .deviation
            .kinds
            .iter()
            .map(|k| {
                format!(
                    "{:?} rms {:.4}% max {:.3}%",
                    k.kind,
                    100.0 * k.mesh_to_surface.rms,
                    100.0 * k.mesh_to_surface.max
                )
            })
            .collect();
        eprintln!("  {}", kinds.join("; "));
        if let Some(p) = c.worst.largest_curvature {
            eprintln!("  largest curvature: {p:?} {:?}", c.patches[p.0 as usize]);
        }
        eprintln!("  seconds {:?}", r.seconds);
        for (i, (f, ch)) in r.fits.iter().zip(&r.charts).enumerate() {
            eprintln!(
                "  fit {i}: {:?} cells, rms {:.1e} max {:.1e} {:?} lambda {:.1e} guard {} area ratio {:.1} curvature {:.0}",
                f.report.cells,
                f.report.rms,
                f.report.max,
                f.report.outcome,
                f.report.lambda,
                f.report.guard.increases,
                ch.distortion.area_ratio,
                c.patches[i].curvature,
            );
        }
        for w in &r.warnings {
            eprintln!("  {w}");
        }
    }
}
