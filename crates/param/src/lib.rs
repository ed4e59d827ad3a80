//! Flattening: a segment of a mesh and its collar become a chart, a disc with two parameters per vertex.
//!
//! [`disc_with_collar`] cuts a segment out together with a collar of neighbouring faces, as an abstract disc; a [`Parameterize`]
//! method flattens it, [`Recommended`] by default; [`Chart`] holds the result and its [`Distortion`].
//!
//! Not for closed or annular segments (cut them first), and not an atlas packer: charts overlap in the plane, and seams between
//! them are nobody's concern here.
//!
//! ```
//! use glam::DVec3;
//! use suture_mesh::{Topology, TriMesh};
//! use suture_param::{Chart, CollarOptions, Limits, Recommended, disc_with_collar};
//!
//! let position = |i: u32| DVec3::new((i % 9) as f64, (i / 9) as f64, 0.0);
//! let quad = |i: u32| [[i, i + 1, i + 10], [i, i + 10, i + 9]];
//! let faces: Vec<_> = (0..72).filter(|i| i % 9 < 8).flat_map(quad).collect();
//! let mesh = TriMesh::new((0..81).map(position).collect(), faces);
//! let topology = Topology::build(&mesh)?;
//! let disc = disc_with_collar(&mesh, &topology, &[58, 59], &CollarOptions { width: 1.5, ..Default::default() })?;
//! let chart = Chart::flatten(disc, &Recommended::default(), &Limits::default())?;
//! assert!(chart.distortion.accepted && (chart.distortion.stretch - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: faces are counter-clockwise seen from outside and stay so in the plane; lengths, also those of the parameter
//! plane, are in the units of the mesh ([`normalize`] makes the areas equal); everything is computed relative to the centre and
//! diameter of the chart, on one thread, and depends on the numbering of vertices and faces only in its rounding errors.

#![forbid(unsafe_code)]

mod boundary_scale;
mod chart;
mod conformal;
mod creases;
mod development;
mod disc;
mod distortion;
mod error;
mod frame;
mod lscm;
mod parameterize;
mod recommended;
mod rim;
mod sheet;
mod sparse;
mod spectral;
mod symmetric_dirichlet;
mod tutte;

pub use boundary_scale::BoundaryScaleOne;
pub use chart::Chart;
pub use disc::{CollarOptions, Disc, disc_with_collar};
pub use distortion::{Distortion, Limits};
pub use error::ParamError;
pub use frame::normalize;
pub use lscm::Lscm;
pub use parameterize::Parameterize;
pub use recommended::Recommended;
pub use spectral::Spectral;
pub use symmetric_dirichlet::{Start, SymmetricDirichlet};
pub use tutte::Tutte;
