//! `suture bubble`.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::{Args as ClapArgs, ValueEnum};
use serde::Serialize;
use suture::bubble::spline::{HomogeneousSpline, Intervals, SplineOptions, SplineSurface};
use suture::bubble::{BubbleOptions, Fit, MAX_ORDER, PolyMesh, sharp_edges};
use suture::mesh::TriMesh;
use suture::{Report, SutureError, sew_creased, sew_splined, vertex_normals};

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
    /// Cubic splines of so many intervals along every edge for boundary data, 4 to 1024, so that patches are tensor-product B-splines; for orders up to 2
    #[arg(long, value_name = "K", conflicts_with = "seam_angle")]
    splines: Option<usize>,
    /// As --splines, with as many intervals as it takes for normals to agree across seams to this angle in degrees
    #[arg(long, value_name = "ANGLE")]
    seam_angle: Option<f64>,
    /// With splines: cubic boundary curves too, for the lowest degrees
    #[arg(long)]
    cubic_curves: bool,
    /// With splines: write knots, control points (times weights) and weights of every patch, as JSON
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    nets: Option<PathBuf>,
}

impl Bubble {
    fn splines(&self) -> Result<Option<SplineOptions>, SutureError> {
        let angle = self.seam_angle.map(|angle| Intervals::Angle(angle.to_radians()));
        let intervals = self.splines.map(Intervals::Count).or(angle);
        if intervals.is_none() && (self.cubic_curves || self.nets.is_some()) {
            let what = "--cubic-curves and --nets are for splines; give --splines or --seam-angle too".into();
            return Err(SutureError::Unsuitable { what });
        }
        Ok(intervals.map(|intervals| SplineOptions { intervals, exact_height: !self.cubic_curves }))
    }
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
    let splines = a.splines()?;
    let tag = |mesh: &TriMesh| {
        let normals = vertex_normals(mesh, a.local.source())?;
        let mut tagged = given.clone();
        if let Some(angle) = a.creases {
            let poly = PolyMesh::from_triangles(mesh, &normals)?;
            tagged.extend(sharp_edges(&poly, angle.to_radians())?);
        }
        Ok::<_, SutureError>((normals, tagged))
    };
    let Some(splines) = splines else {
        return a.local.run(common, report, |mesh, options, watch| {
            let (normals, tagged) = tag(mesh)?;
            sew_creased(mesh, &normals, &tagged, &bubbles, options, watch)
        });
    };
    a.local.run(common, report, |mesh, options, watch| {
        let (normals, tagged) = tag(mesh)?;
        sew_splined(mesh, &normals, &tagged, (&bubbles, &splines), options, watch, |surface| {
            a.nets.as_deref().map_or(Ok(()), |path| write_nets(path, surface))
        })
    })
}

/// A patch as it is written.
#[derive(Serialize)]
struct Net {
    face: usize,
    #[serde(flatten)]
    net: HomogeneousSpline,
}

/// Writes the nets of all patches, one per line.
fn write_nets(path: &Path, surface: &SplineSurface) -> Result<(), SutureError> {
    let failed = |source| SutureError::File { path: path.to_owned(), source };
    let mut out = BufWriter::new(File::create(path).map_err(failed)?);
    for (face, patch) in surface.patches.iter().enumerate() {
        let net = Net { face, net: patch.bspline()? };
        out.write_all(if face == 0 { b"[\n" } else { b",\n" }).map_err(failed)?;
        serde_json::to_writer(&mut out, &net).map_err(|e| failed(e.into()))?;
    }
    out.write_all(b"\n]\n").and_then(|()| out.flush()).map_err(failed)
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
