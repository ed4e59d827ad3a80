//! Sew smooth surfaces over triangle meshes, with a measured certificate of every seam: the facade.
//!
//! [`reconstruct()`] turns a closed triangle mesh into a C² surface; every stage it runs is a crate of its own, re-exported
//! here, and can be swapped ([`Stages`]). [`Report`] is what the command line writes with `--json`.
//!
//! When not to use it: meshes with a boundary, or with several components (reconstruct them one by one); faceted models whose
//! edges must stay sharp (the result is C² everywhere, edges become fillets).

#![forbid(unsafe_code)]

mod error;
mod reconstruct;
mod repair;
pub mod report;
mod watch;

pub use error::SutureError;
pub use reconstruct::{Fairness, ReconstructOptions, Reconstruction, Stages, reconstruct, samples};
pub use repair::repair_all;
pub use report::Report;
pub use watch::{Stage, Unwatched, Watch};

/// Loads a surface that was saved as native JSON, with the patches of every method of this program.
///
/// # Errors
/// [`SutureError::Export`]: what is malformed, and where.
pub fn load_surface(bytes: &[u8]) -> Result<suture_surface::Surface, SutureError> {
    let loaders = suture_blend::RECORDS.map(|kind| (kind, suture_blend::load as suture_export::Loader));
    Ok(suture_export::read_native(bytes, &loaders)?)
}

pub use suture_bernstein as bernstein;
pub use suture_blend as blend;
pub use suture_certify as certify;
pub use suture_export as export;
pub use suture_fit as fit;
pub use suture_mesh as mesh;
pub use suture_param as param;
pub use suture_segment as segment;
pub use suture_surface as surface;
pub use suture_tessellate as tessellate;
pub use suture_view as view;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
