//! `suture bubble`.

use clap::{Args as ClapArgs, ValueEnum};
use serde::Serialize;
use suture::bubble::{BubbleOptions, Fit, MAX_ORDER};
use suture::{Report, SutureError, sew_bubble, vertex_normals};

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
    let bubbles = BubbleOptions { order, fit, curved, refuse, ..BubbleOptions::default() };
    a.local.run(common, report, |mesh, options, watch| {
        let normals = vertex_normals(mesh, a.local.source())?;
        sew_bubble(mesh, &normals, &bubbles, options, watch)
    })
}
