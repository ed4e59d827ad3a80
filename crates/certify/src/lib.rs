//! How smoothly the seams of a surface join, and how far the surface lies from a mesh.
//!
#![doc = include_str!("../README.md")]
//!
//! # Conventions
//!
//! Lengths in results are relative to the diagonal of the input's bounding box, curvatures are multiplied by it, angles are in radians.
//! The parameter of a seam is that of its side `a`. Curvatures are signed by `S_u × S_v`; where a seam says that both sides run in the
//! same direction, side `b` is seen from its other side. Everything is deterministic and independent of the number of threads.
//!
//! # References
//!
//! M. P. do Carmo, *Differential Geometry of Curves and Surfaces* (1976), §3.2 (shape operator); S.-M. Hu & J. Wallner, *A second order
//! algorithm for orthogonal projection onto curves and surfaces* (2005), eq. 6 (foot points).

#![forbid(unsafe_code)]

mod certificate;
mod deviation;
mod error;
mod foot;
mod nearest;
mod options;
mod region;
mod samples;
mod seam;
mod shape;

pub use certificate::{Certificate, PatchReport, Worst, certify};
pub use deviation::{Deviation, KindDeviation, Place, Stats, deviation};
pub use error::CertifyError;
pub use options::{CertifyOptions, Limits};
pub use samples::SurfaceSamples;
pub use seam::{BlindSpot, Jump, SeamReport, Unmeasured};
