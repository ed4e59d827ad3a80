//! Sew smooth surfaces over triangle meshes, with a measured certificate of every seam: the facade.
//!
//! [`reconstruct()`] turns a closed triangle mesh into a C² surface; every stage it runs is a crate of its own, re-exported
//! here, and can be swapped ([`Stages`]). [`sew_apatch`] and [`sew_bubble`] lay one patch over every face of a mesh with normals, open or
//! closed: C¹ implicit surfaces and G⁰ to G⁴ parametric ones; [`fill_and_measure`] closes gaps and holes between surfaces. [`Report`] is what the command line writes with `--json`.
//!
//! When not to use it: faceted models whose edges must stay sharp (every result is smooth everywhere, edges become fillets or bulge);
//! meshes with a boundary or several components have no reconstruction.

#![forbid(unsafe_code)]

mod arcs;
mod charting;
mod error;
mod fill;
mod flattening;
mod page;
mod reconstruct;
mod repair;
pub mod report;
mod segments;
mod sew;
mod splitting;
mod watch;

pub use error::SutureError;
pub use fill::{Filled, Unfilled, fill_and_measure};
pub use flattening::ByChart;
pub use page::{degrees, facets, hull_of};
pub use reconstruct::{
    Fairness, ReconstructOptions, Reconstruction, Refinement, Splits, Stages, reconstruct, samples,
};
pub use repair::repair_all;
pub use report::Report;
pub use segments::{
    ArcReport, ChartReport, CornerReport, FlatteningReport, SegmentsReport, describe_segments,
};
pub use sew::{
    NormalSource, SewOptions, Sewn, SplinedReport, sew_apatch, sew_bubble, sew_creased, sew_splined,
    vertex_normals,
};
pub use watch::{Stage, Unwatched, Watch};

use suture_surface::{Patch, Record, RecordError, SplinePool};

/// Loads a surface that was saved as native JSON, with the patches of every method of this program.
///
/// # Errors
/// [`SutureError::Export`]: what is malformed, and where.
pub fn load_surface(bytes: &[u8]) -> Result<suture_surface::Surface, SutureError> {
    let blend = suture_blend::RECORDS.map(|kind| (kind, suture_blend::load as suture_export::Loader));
    let apatch = suture_apatch::RECORDS.map(|kind| (kind, suture_apatch::load as suture_export::Loader));
    let bubble = suture_bubble::RECORDS.map(|kind| (kind, suture_bubble::load as suture_export::Loader));
    let coons = suture_coons::RECORDS.map(|kind| (kind, load_fill as suture_export::Loader));
    let loaders = [&blend[..], &apatch, &bubble, &coons].concat();
    Ok(suture_export::read_native(bytes, &loaders)?)
}

/// Loads a fill, whose constituents may be patches of every method.
fn load_fill(record: &Record, pool: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    let foreign = |record: &Record, pool: &SplinePool| {
        let kind = record.kind.as_str();
        if suture_blend::RECORDS.contains(&kind) {
            suture_blend::load(record, pool)
        } else if suture_apatch::RECORDS.contains(&kind) {
            suture_apatch::load(record, pool)
        } else if suture_bubble::RECORDS.contains(&kind) {
            suture_bubble::load(record, pool)
        } else {
            load_fill(record, pool)
        }
    };
    suture_coons::load_with(record, pool, &foreign)
}

pub use suture_apatch as apatch;
pub use suture_bernstein as bernstein;
pub use suture_blend as blend;
pub use suture_bubble as bubble;
pub use suture_certify as certify;
pub use suture_coons as coons;
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
