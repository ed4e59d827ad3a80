//! Surfaces as files.
//!
#![doc = include_str!("../README.md")]
//!
//! # Conventions
//!
//! Lengths are those of the surface. Triangles are counter-clockwise seen from the side of `S_u × S_v`. The same surface and tessellation
//! give the same bytes.

#![forbid(unsafe_code)]

mod error;
mod format;
mod glb;
mod group;
mod native;
mod obj;
mod step;

pub use error::ExportError;
pub use format::{Format, write, write_glb, write_step};
pub use glb::{to_glb, to_glb_with};
pub use native::{Loader, SCHEMA, read_native, write_native};
pub use obj::{to_mtl, to_obj};
pub use step::{LengthUnit, StepOptions, StepReport, to_step};
