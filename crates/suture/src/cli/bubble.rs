//! `suture bubble`.

use std::path::{Path, PathBuf};

use clap::{Args as ClapArgs, ValueEnum};
use serde::Serialize;
use suture::bubble::{BubbleOptions, Fit, MAX_ORDER, PolyMesh, sharp_edges};
use suture::{Report, SutureError, sew_creased, vertex_normals};

use super::args;
use super::commands::settings;
use super::local::Local;

#[derive(ClapArgs, Debug, Serialize)]
pub(crate) struct Bubble {
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) local: Local,
    /// Order of smoothness across edges: 0 to 4
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(0..=MAX_ORDER as i64))]
    order: u8,
    /// How the surface bends at the vertices
    #[arg(long, value_enum, default_value_t)]
    fit: Fitting,
    /// With --order 0: the mesh itself, as printed in the paper, instead of curved patches
    #[arg(long)]
    flat: bool,
    /// Edges are refused along which the cosine between gradient and normal, half the relative length of the normal or a quarter of the
    /// relative speed falls below this; 0 accepts all
    #[arg(long, value_name = "VALUE", default_value_t = BubbleOptions::default().refuse)]
    refuse: f64,
    /// Take the normals as they are, even where they see a face from behind (it folds) or an edge runs along them
    #[arg(long)]
    keep_normals: bool,
    /// Keep edges sharp where the normals of their faces make a larger angle, in degrees
    #[arg(long, value_name = "ANGLE")]
    creases: Option<f64>,
    /// Keep these edges sharp: two numbers of vertices per line, from 0; added to those of --creases
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    crease_edges: Option<PathBuf>,
}

#[derive(ValueEnum, Clone, Copy, Debug, Default, Serialize)]
#[serde(rename_all = "snake_case")]
enum Fitting {
    /// Not at all
    Plane,
    /// As the normals around turn: sound on real meshes
    #[default]
    Tangential,
    /// As the quadric through positions and normals around
    Quadric,
    /// As a quartic over two rings: the most exact for smooth, dense meshes, wild on noise
    Quartic,
}

/// Weight that keeps the quadric determined where the neighbours lie in a plane.
const QUADRIC_WEIGHT: f64 = 1e-3;

/// Lays the surface; whether everything that was claimed holds.
pub(crate) fn run(a: &Bubble, common: &args::Common, report: &mut Report) -> Result<bool, SutureError> {
    report.settings = settings(a);
    let fit = match a.fit {
        Fitting::Plane => Fit::Plane,
        Fitting::Tangential => Fit::Tangential,
        Fitting::Quadric => Fit::Quadric { lambda: QUADRIC_WEIGHT },
        Fitting::Quartic => Fit::Quartic,
    };
    let (order, curved, refuse) = (a.order.into(), !a.flat, a.refuse);
    let steer = if a.keep_normals { 0.0 } else { BubbleOptions::default().steer };
    let bubbles = BubbleOptions { order, fit, curved, refuse, steer, ..BubbleOptions::default() };
    if let Some(angle) = a.creases.filter(|angle| !(0.0..=180.0).contains(angle)) {
        let what = format!("--creases {angle} is not an angle between 0 and 180 degrees");
        return Err(SutureError::Unsuitable { what });
    }
    let given = a.crease_edges.as_deref().map(read_edges).transpose()?.unwrap_or_default();
    a.local.run(common, report, |mesh, options, watch| {
        let normals = vertex_normals(mesh, a.local.source())?;
        let mut tagged = given;
        if let Some(angle) = a.creases {
            let poly = PolyMesh::from_triangles(mesh, &normals)?;
            tagged.extend(sharp_edges(&poly, angle.to_radians())?);
        }
        sew_creased(mesh, &normals, &tagged, &bubbles, options, watch)
    })
}

/// Pairs of vertices, one per line; empty lines and those that begin with `#` do not count.
fn read_edges(path: &Path) -> Result<Vec<[u32; 2]>, SutureError> {
    let text = std::fs::read_to_string(path)
        .map_err(|source| SutureError::File { path: path.to_owned(), source })?;
    let mut out = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<u32> = line.split_whitespace().map_while(|w| w.parse().ok()).collect();
        let two = (line.split_whitespace().count() == 2).then(|| <[u32; 2]>::try_from(words).ok()).flatten();
        out.push(two.ok_or_else(|| SutureError::Unsuitable {
            what: format!("{}, line {}: not two numbers of vertices", path.display(), number + 1),
        })?);
    }
    Ok(out)
}
