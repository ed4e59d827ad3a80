//! [`Patch`], [`Surface`], [`Seam`]: what every method of suture produces and every consumer reads.
//!
//! A [`Surface`] is a set of parametric patches and a list of seams; a seam says that two boundary edges of patches are one
//! curve in space, parameter for parameter, and how smoothly its maker claims that the patches join there. Tessellation,
//! certificate, deviation, export and pictures work on these types alone.
//!
//! Conventions: the outward normal is `S_u × S_v`; the boundary of a domain is walked with the domain on the left; an edge has its
//! own parameter `t ∈ [0, 1]` that grows along that walk.

#![forbid(unsafe_code)]

mod domain;
mod patch;
mod record;
mod surface;

pub use domain::{Domain, EdgeCurve};
pub use patch::{Patch, PatchKind};
pub use record::{Record, RecordError, SplinePool};
pub use surface::{Continuity, EdgeRef, PatchId, Seam, Surface, SurfaceError};
pub use suture_bernstein::Jet2;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
