//! The measurements of bubble surfaces: jumps across seams over the built-in shapes and the meshes named on the command line,
//! convergence on the sphere, invariance, speed.
//!
//! `measure seams|jets|creases|splines|sphere|invariance|speed … FILES` prints these tables alone, and of the files alone.
//!
//! `cargo run --release -p suture-bubble --example measure_bubble -- ../shared/data/good/eight.off …`

#[path = "../tests/common/mod.rs"]
mod common;

use std::{error::Error, path::Path, time::Instant};

use common::{jet_jumps, jumps, mean_curvature, parameters, patch_jumps, tetrahedron, torus, with_normals};
use glam::{DMat3, DVec2, DVec3};
use suture_bubble::{
    BubbleOptions, Face, Fit, Implicit, PolyMesh, bubble, bubble_creased, bubble_with, sharp_edges,
    spline::{Intervals, SplineOptions, spline_surface},
};
use suture_mesh::{
    Topology, TriMesh, io,
    normals::{EstimateNormals, LoopLimit},
    shapes,
};
use suture_surface::Patch;

/// The tables, by the words that ask for one alone.
const TABLES: [&str; 7] = ["seams", "jets", "creases", "splines", "sphere", "invariance", "speed"];

fn main() -> Result<(), Box<dyn Error>> {
    let (words, files): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| TABLES.contains(&a.as_str()));
    let wanted = |table: &str| words.is_empty() || words.iter().any(|w| w == table);
    let mut meshes: Vec<(String, PolyMesh)> = vec![
        ("tetrahedron".into(), with_normals(&tetrahedron())),
        ("cube".into(), with_normals(&shapes::cuboid(DVec3::ONE, 1))),
        ("icosahedron".into(), with_normals(&shapes::sphere(0))),
        ("deformed icosahedron".into(), with_normals(&common::deformed(0))),
        ("quad torus".into(), torus(12, 8, 0)),
        ("mixed torus".into(), torus(12, 8, 3)),
    ];
    if !files.is_empty() && !words.is_empty() {
        meshes.clear();
    }
    for file in &files {
        let mesh = io::read(Path::new(file))?.mesh;
        let name = Path::new(file).file_stem().map_or(file.clone(), |s| s.to_string_lossy().into_owned());
        let normals = match &mesh.normals {
            Some(n) => n.iter().map(|n| n.normalize_or_zero()).collect(),
            None => LoopLimit.estimate(&mesh, &Topology::build(&mesh)?)?,
        };
        meshes.push((name, PolyMesh::from_triangles(&mesh, &normals)?));
    }
    if wanted("seams") {
        seams(&meshes);
    }
    if wanted("jets") {
        println!("\njets of graphs across seams, by order 0 to 4, in units of the edge, relative");
        for (name, mesh) in meshes.iter().filter(|m| m.1.faces.len() < 1000) {
            for order in 1..5 {
                match bubble(mesh, &BubbleOptions { order, ..Default::default() }) {
                    Ok(s) => println!("{name:26} {order} {}", list(&jet_jumps(&s, &parameters(21)))),
                    Err(e) => println!("{name:26} {order} {e}"),
                }
            }
        }
    }
    if wanted("creases") {
        creases(&meshes)?;
    }
    if wanted("splines") {
        splines()?;
    }
    if wanted("sphere") {
        spheres()?;
    }
    if wanted("invariance") {
        invariance()?;
    }
    if wanted("speed") {
        speed()?;
    }
    Ok(())
}

fn seams(meshes: &[(String, PolyMesh)]) {
    println!(
        "jumps at 50 parameters per edge, corners included: position / diagonal, normal in radians, shape operator relative"
    );
    println!(
        "{:26} {:>7} n {:>9} {:>9} {:>9} {:>7} {:>7} {:>8}",
        "mesh", "faces", "position", "normal", "shape", "cos", "fold", "build s"
    );
    for (name, mesh) in meshes {
        for order in 0..3 {
            if let Err(e) = row(name, mesh, order) {
                println!("{name:26} {:7} {order} {e}", mesh.faces.len());
            }
        }
    }
}

/// Creases where faces make more than 30 degrees: both parts of the seams.
fn creases(meshes: &[(String, PolyMesh)]) -> Result<(), Box<dyn Error>> {
    println!(
        "\ncreases at 30 degrees: jumps over creases (position alone is claimed) and over the other seams"
    );
    for (name, mesh) in meshes {
        let sharp = sharp_edges(mesh, 30f64.to_radians())?;
        for order in 0..3 {
            let surface = match bubble_creased(mesh, &sharp, &BubbleOptions { order, ..Default::default() }) {
                Ok(s) => s,
                Err(e) => {
                    println!("{name:26} {order} {e}");
                    continue;
                }
            };
            let count = surface.report().creases;
            let (smooth, sharp) = surface.seams().split_at(surface.seams().len() - count);
            let of = |seams| patch_jumps(surface.patches(), seams, diagonal(mesh), &parameters(50));
            let (s, c) = (of(smooth), of(sharp));
            println!(
                "{name:26} {order} {count:5} creases {:9.1e} {:9.1e} | {:6} others {:9.1e} {:9.1e} {:9.1e} fold {:.3}",
                c.position,
                c.normal,
                smooth.len(),
                s.position,
                s.normal,
                s.shape,
                surface.report().fold
            );
            if order == 2 {
                surface.report().warnings.iter().for_each(|w| println!("    {w}"));
            }
        }
    }
    Ok(())
}

/// Jumps of the spline variant against the number of intervals.
fn splines() -> Result<(), Box<dyn Error>> {
    println!("\nsplined boundary data, deformed icosahedron: A with splined heights, B with exact ones");
    let mesh = with_normals(&common::deformed(0));
    for order in 0..3 {
        let surface = bubble(&mesh, &BubbleOptions { order, ..Default::default() })?;
        for exact_height in [false, true] {
            for k in [4, 8, 16, 32, 64] {
                let start = Instant::now();
                let options = SplineOptions { intervals: Intervals::Count(k), exact_height };
                let made = spline_surface(&surface, &options)?;
                let seconds = start.elapsed().as_secs_f64();
                let j = patch_jumps(&made.patches, &made.seams, 1.0, &parameters(201));
                let degree = made.patches[0].bspline()?.points.degree()[0];
                let variant = if exact_height { "B" } else { "A" };
                println!(
                    "n = {order} {variant} K = {k:2} bidegree ({degree}, {degree}): position {:.1e} normal {:.1e} shape {:.1e} ({seconds:.2} s)",
                    j.position, j.normal, j.shape
                );
            }
        }
    }
    Ok(())
}

fn diagonal(mesh: &PolyMesh) -> f64 {
    let (lo, hi) =
        mesh.positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
    (hi - lo).length()
}

fn row(name: &str, mesh: &PolyMesh, order: usize) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let options = BubbleOptions { order, ..Default::default() };
    let surface = bubble(mesh, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let j = jumps(&surface, diagonal(mesh), &parameters(50));
    let report = surface.report();
    let cosine = report.cosine.map_or(1.0, |c| c.value);
    println!(
        "{name:26} {:7} {order} {:9.1e} {:9.1e} {:9.1e} {cosine:7.3} {:7.3} {seconds:8.3}",
        mesh.faces.len(),
        j.position,
        j.normal,
        j.shape,
        report.fold
    );
    if order == 2 {
        for w in &report.warnings {
            println!("    {w}");
        }
    }
    Ok(())
}

/// Largest errors of distance, normal and mean curvature on the unit sphere.
fn sphere_errors(level: u32, order: usize, fit: Fit) -> Result<[f64; 3], Box<dyn Error>> {
    let mesh = shapes::sphere(level);
    let poly = PolyMesh::from_triangles(&mesh, &mesh.positions)?;
    let surface = bubble(&poly, &BubbleOptions { order, fit, ..Default::default() })?;
    let mut worst = [0.0_f64; 3];
    for patch in surface.patches() {
        for i in 0..21 {
            for j in 0..21 - i {
                let jet = patch.jet(DVec2::new(f64::from(i), f64::from(j)) / 20.0);
                let Some(n) = jet.normal() else { continue };
                let r = jet.p.normalize();
                let errors = [
                    (jet.p.length() - 1.0).abs(),
                    n.cross(r).length().atan2(n.dot(r)),
                    (mean_curvature(&jet) + 1.0).abs(),
                ];
                for k in 0..3 {
                    worst[k] = worst[k].max(errors[k]);
                }
            }
        }
    }
    Ok(worst)
}

fn spheres() -> Result<(), Box<dyn Error>> {
    println!(
        "\nunit sphere, icosphere levels 0 to 3: largest errors of distance / normal / mean curvature, and orders between levels"
    );
    for (name, fit, orders) in [
        ("tangential", Fit::Tangential, 0..5),
        ("quadric", Fit::Quadric { lambda: 0.0 }, 1..3),
        ("quartic", Fit::Quartic, 2..3),
    ] {
        for order in orders {
            let mut last: Option<[f64; 3]> = None;
            for level in 0..4 {
                let e = sphere_errors(level, order, fit)?;
                let rates = last.map(|l| [0, 1, 2].map(|k| (l[k] / e[k]).log2()));
                println!(
                    "{name:10} n = {order} level {level}: {} {:5.1?}",
                    list(&e),
                    rates.unwrap_or_default()
                );
                last = Some(e);
            }
        }
    }
    Ok(())
}

/// Largest distance between corresponding points of the surfaces of a mesh and of a moved or renumbered copy.
fn invariance() -> Result<(), Box<dyn Error>> {
    println!(
        "\ninvariance: largest distance between corresponding points, deformed icosahedron and mixed torus"
    );
    let rotation = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    for (name, mesh) in [("deformed", with_normals(&common::deformed(0))), ("mixed", torus(12, 8, 3))] {
        for order in 0..5 {
            let options = BubbleOptions { order, ..Default::default() };
            let plain = bubble(&mesh, &options)?;
            let distance = |other: &PolyMesh,
                            back: DMat3,
                            at: &dyn Fn(usize, DVec2) -> DVec2|
             -> Result<f64, Box<dyn Error>> {
                let moved = bubble(other, &options)?;
                let mut worst = 0.0_f64;
                for (f, (a, b)) in plain.patches().iter().zip(moved.patches()).enumerate() {
                    for (u, v) in [(0.2, 0.3), (0.6, 0.1), (0.25, 0.0), (0.45, 0.45), (0.05, 0.05)] {
                        let at_a = DVec2::new(u, v);
                        worst = worst.max(a.jet(at_a).p.distance(back * b.jet(at(f, at_a)).p));
                    }
                }
                Ok(worst)
            };
            let map = |m: DMat3| {
                let mut out = mesh.clone();
                out.positions.iter_mut().chain(&mut out.normals).for_each(|p| *p = m * *p);
                out
            };
            let same = |_: usize, at: DVec2| at;
            let turned = distance(&map(rotation), rotation.transpose(), &same)?;
            let mut mirrored = map(mirror);
            for f in &mut mirrored.faces {
                match f {
                    Face::Triangle(v) => v.swap(1, 2),
                    Face::Quad(v) => v.swap(1, 3),
                }
            }
            let flipped = distance(&mirrored, mirror, &|_, at| DVec2::new(at.y, at.x))?;
            // Vertices in reverse, corners of every face begun one later.
            let last = mesh.positions.len() as u32 - 1;
            let mut renumbered = mesh.clone();
            renumbered.positions.reverse();
            renumbered.normals.reverse();
            for f in &mut renumbered.faces {
                match f {
                    Face::Triangle(v) => {
                        *v = v.map(|v| last - v);
                        v.rotate_left(1);
                    }
                    Face::Quad(v) => {
                        *v = v.map(|v| last - v);
                        v.rotate_left(1);
                    }
                }
            }
            let quads: Vec<bool> = mesh.faces.iter().map(|f| f.vertices().len() == 4).collect();
            let turn = move |f: usize, at: DVec2| {
                if quads[f] { DVec2::new(at.y, 1.0 - at.x) } else { DVec2::new(at.y, 1.0 - at.x - at.y) }
            };
            let relabelled = distance(&renumbered, DMat3::IDENTITY, &turn)?;
            println!(
                "{name:10} n = {order}: rotation {turned:.1e}, mirror {flipped:.1e}, relabelling {relabelled:.1e}"
            );
        }
    }
    Ok(())
}

/// Processor seconds of the calling thread and of the whole process, where the system tells.
fn processor() -> Option<[f64; 2]> {
    let thread = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = thread.split_whitespace().next()?.parse().ok()?;
    let process = std::fs::read_to_string("/proc/self/stat").ok()?;
    let ticks: f64 =
        process.rsplit(')').next()?.split_whitespace().skip(11).take(2).flat_map(str::parse::<f64>).sum();
    Some([nanoseconds * 1e-9, ticks * 1e-2])
}

fn speed() -> Result<(), Box<dyn Error>> {
    println!("\nspeed");
    let mesh: TriMesh = shapes::torus(2.0, 0.8, 320, 160);
    let poly = with_normals(&mesh);
    for (fit, name) in [(Fit::Tangential, "tangential"), (Fit::Quartic, "quartic")] {
        for order in 0..3 {
            let options = BubbleOptions { order, fit, ..Default::default() };
            let (start, busy) = (Instant::now(), processor());
            let surface = bubble(&poly, &options)?;
            let wall = start.elapsed().as_secs_f64();
            let busy = busy.zip(processor()).map_or(f64::NAN, |(a, b)| b[1] - a[1]);
            println!(
                "build n = {order}, {} triangles, {name}: {wall:.2} s, {busy:.2} s of processors",
                mesh.faces.len()
            );
            if fit == Fit::Tangential {
                let (start, busy) = (Instant::now(), processor());
                let mut sum = DVec3::ZERO;
                for patch in surface.patches().iter().take(20_000) {
                    for k in 0..10 {
                        sum += patch.jet(DVec2::new(0.05 + 0.07 * f64::from(k), 0.13)).duv;
                    }
                }
                let seconds = start.elapsed().as_secs_f64();
                let seconds = busy.zip(processor()).map_or(seconds, |(a, b)| b[0] - a[0]);
                println!(
                    "  jets of order two: {:.2} million per second and core ({:.1e})",
                    0.2 / seconds,
                    sum.x
                );
            }
        }
    }
    let f = Implicit::quadric(DVec3::Z, DMat3::IDENTITY);
    let given = vec![f; 3];
    let tiny = PolyMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        normals: vec![DVec3::Z; 3],
        faces: vec![Face::Triangle([0, 1, 2])],
    };
    println!(
        "given implicits: {:?}",
        bubble_with(&tiny, &given, &BubbleOptions::default())?.report().warnings
    );
    Ok(())
}

fn list(x: &[f64]) -> String {
    x.iter().map(|x| format!("{x:8.1e}")).collect::<Vec<_>>().join(" ")
}
