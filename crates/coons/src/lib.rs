//! Fills of gaps between surfaces.

#![forbid(unsafe_code)]

mod analytic;
mod blend;
mod border;
mod certificate;
mod constituent;
mod curve;
mod error;
mod four;
mod geometric;
mod nsided;
mod options;
mod real;
mod record;
mod sheet;
mod spline;
mod taylor;
mod three;

pub use analytic::{Analytic, Shape};
pub use blend::{Blend, BlendFunction, Family, printed_correction, rational_correction};
pub use border::{border_curve, border_curves};
pub use certificate::{CornerCertificate, CornerDelta};
pub use constituent::{
    Constituent, Map, Mapped, PatchSheet, Reflected, Ribbon, Spline, boundary_jets, constituent_fn,
};
pub use curve::{BorderCurve, CurveData, SplineCurve, curve_fn, hermite};
pub use error::CoonsError;
pub use four::{CertifiedFill, FourSided};
pub use geometric::{RuledEdge, remark_2};
pub use nsided::{SplitCertificate, SplitHole, Wedge, split_hole};
pub use options::{FillOptions, Order};
pub use real::{Interval, Real};
pub use record::{Foreign, RECORDS, load, load_with};
pub use sheet::SheetPatch;
pub use taylor::{Enclosure, Expansion, Taylor};
pub use three::{CertifiedHole, HoleCertificate, ThreeSided, Tip};
