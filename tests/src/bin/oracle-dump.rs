//! Writes problems with our solutions for the independent implementations under tests/oracle: `oracle-dump FOLDER`.

use std::path::{Path, PathBuf};

use glam::DVec2;
use serde_json::json;
use suture::export::{StepOptions, to_step};
use suture::fit::{EnergyOrder, Grid, solve};
use suture::mesh::{Topology, TriMesh};
use suture::param::{BoundaryScaleOne, CollarOptions, Disc, Lscm, Parameterize, disc_with_collar};
use suture::segment::Segment;
use suture::tessellate::{TessellationOptions, tessellate};
use suture::{ReconstructOptions, Stages, Unwatched, reconstruct};
use suture_tests::{PAPER, labels, mesh, own};

/// Chords of the tessellation that volumes and areas are compared with: errors of 1e-5 of the volume.
const CHORD: f64 = 2e-5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: oracle-dump FOLDER")?);
    std::fs::create_dir_all(&folder)?;
    for (name, segment) in [("deformed_tetrahedron", 0), ("torus_2304", 3), ("cylinder_2736", 1)] {
        let disc = segment_disc(name, segment)?;
        write(&folder, &format!("lscm_{name}.json"), &lscm(&disc)?)?;
        for order in [EnergyOrder::Second, EnergyOrder::Third] {
            write(&folder, &format!("fit_{name}_{}.json", order.order()), &fit(&disc, order)?)?;
        }
    }
    for (name, ..) in PAPER {
        let file = own(&format!("paper/{name}.obj"));
        let mesh = mesh(&file);
        write(&folder, &format!("mesh_{name}.json"), &measures(&file, &mesh))?;
    }
    for name in ["sphere_320", "deformed_tetrahedron", "torus_2304"] {
        step(&folder, name)?;
    }
    Ok(())
}

/// A reconstruction as a STEP file, with what OpenCASCADE should find in it.
fn step(folder: &Path, name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let mesh = mesh(&own(&format!("paper/{name}.obj")));
    let stages =
        Stages { segment: Box::new(labels(&own(&format!("paper/{name}.labels")))), ..Stages::default() };
    let surface = reconstruct(&mesh, &stages, &ReconstructOptions::default(), &Unwatched)?.blend.surface;
    let options =
        StepOptions { diagonal: Some(mesh.diagonal()), name: name.into(), ..StepOptions::default() };
    let (bytes, report) = to_step(&surface, &options)?;
    let file = format!("{name}.step");
    std::fs::write(folder.join(&file), bytes)?;
    let fine =
        tessellate(&surface, &TessellationOptions { chord: CHORD, ..TessellationOptions::default() })?.mesh;
    let told = measures(Path::new(&file), &fine);
    // Vertices of a tessellation lie on the patches.
    let stride = fine.positions.len().div_ceil(10_000);
    let points: Vec<_> = fine.positions.iter().step_by(stride).collect();
    let value = json!({
        "file": file, "diagonal": report.diagonal, "faces": report.faces, "edges": report.edges,
        "vertices": report.vertices, "solids": 1, "euler": told["euler"], "limit": options.tolerance,
        "angle_limit": options.angle.to_degrees(), "curvature_limit": 2.0 * options.curvature,
        "volume": told["volume"], "area": told["area"], "points": points,
    });
    write(folder, &format!("step_{name}.json"), &value)?;
    Ok(())
}

fn segment_disc(name: &str, segment: usize) -> Result<Disc, Box<dyn std::error::Error>> {
    let mesh = mesh(&own(&format!("paper/{name}.obj")));
    let topology = Topology::build(&mesh)?;
    let segmentation = labels(&own(&format!("paper/{name}.labels"))).segment(&mesh, &topology)?;
    let options = CollarOptions { max_rings: 0, ..CollarOptions::default() };
    Ok(disc_with_collar(&mesh, &topology, &segmentation.charts[segment].faces, &options)?)
}

fn lscm(disc: &Disc) -> Result<serde_json::Value, Box<dyn std::error::Error>> {
    let border = disc.boundary()?;
    let pins = [border[0] as usize, border[border.len() / 2] as usize];
    let pin_uv = [DVec2::ZERO, DVec2::new(1.0, 0.25)];
    let method = Lscm { pins: Some(pins), pin_uv: Some(pin_uv) };
    let uv = method.parameterize(&disc.positions, &disc.faces)?;
    Ok(json!({ "vertices": disc.positions, "faces": disc.faces, "pins": pins, "pin_uv": pin_uv, "uv": uv }))
}

fn fit(disc: &Disc, order: EnergyOrder) -> Result<serde_json::Value, Box<dyn std::error::Error>> {
    let params = BoundaryScaleOne.parameterize(&disc.positions, &disc.faces)?;
    let (low, high) =
        params.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let pad = (high - low) * 0.05;
    let grid = Grid::new(low - pad, high + pad, [7, 5])?;
    let n = disc.positions.len();
    // Uneven on purpose: weights are part of the problem.
    let raw: Vec<f64> = (0..n).map(|i| 1.0 + (i % 7) as f64).collect();
    let sum: f64 = raw.iter().sum();
    let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
    let area: f64 = disc
        .faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| params[v as usize]);
            0.5 * (b - a).perp_dot(c - a)
        })
        .sum();
    let lambda = 1e-6;
    let net = solve(grid, &params, &disc.positions, &weights, lambda, area, order)?;
    let surface = grid.surface(net)?;
    let [knots_u, knots_v] = surface.knots();
    Ok(json!({
        "knots_u": knots_u, "knots_v": knots_v, "params": params, "points": disc.positions, "weights": weights,
        "lambda": lambda, "area": area, "order": order.order(), "net": surface.net(),
    }))
}

fn measures(file: &Path, mesh: &TriMesh) -> serde_json::Value {
    let area: f64 = (0..mesh.faces.len()).map(|f| mesh.area_vector(f).length()).sum();
    let volume: f64 = (0..mesh.faces.len())
        .map(|f| {
            let [a, b, c] = mesh.corners(f);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    json!({
        "file": file, "vertices": mesh.positions.len(), "faces": mesh.faces.len(), "area": area, "volume": volume,
        "euler": suture::mesh::check(mesh).euler_characteristic,
    })
}

fn write(folder: &Path, name: &str, value: &serde_json::Value) -> std::io::Result<()> {
    std::fs::write(folder.join(name), value.to_string())
}
