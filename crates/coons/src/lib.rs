//! Fills of gaps between surfaces.
//!
#![doc = include_str!("../README.md")]
//!
//! # Conventions
//!
//! A fill lives on `[0, 1]²`: `r1` is met at `v = 0`, `r2` at `v = 1`, the border curve `r3` at `u = 0` and `r4` at `u = 1` (in a three-sided fill the
//! surface `r3` at `u = 1`). Letters are those of the paper; sizes in certificates are relative to the diagonal of the gap's bounding box,
//! derivatives per unit of the parameters. Orders: `C^k` agrees with the constituents in their parameters, `G^k` after a change of them.
//!
//! # References
//!
//! M. Szilvási-Nagy, T. P. Vendel, H. Stachel, *C² filling of gaps by convex combination of surfaces under boundary constraints*, KoG 6 (2002); W. J.
//! Gordon, *Blending-function methods of bivariate and multivariate interpolation and approximation*, SIAM J. Numer. Anal. 8 (1971).

#![forbid(unsafe_code)]

mod analytic;
mod blend;
mod border;
mod certificate;
mod constituent;
mod curve;
mod error;
mod fill;
mod four;
mod gaps;
mod geometric;
mod nsided;
mod options;
mod prepared;
mod real;
mod record;
pub mod scene;
mod sheet;
mod spline;
mod taylor;
mod three;

pub use analytic::{Analytic, Shape};
pub use blend::{Blend, BlendFunction, Family, printed_correction, rational_correction};
pub use border::{border_curve, border_curves};
pub use certificate::{CornerCertificate, CornerDelta};
pub use constituent::{
    Constituent, EdgeRibbon, Map, Mapped, PatchSheet, Reflected, Ribbon, Spline, constituent_fn,
};
pub use curve::{BorderCurve, CurveData, SplineCurve, curve_fn, hermite};
pub use error::CoonsError;
pub use fill::{FillReport, FillSurface, Join, JoinCertificate, fill};
pub use four::{CertifiedFill, FourSided};
pub use gaps::{Gap, GapOptions, fill_gaps, find_gaps};
pub use geometric::{RuledEdge, remark_2};
pub use nsided::{SplitCertificate, SplitHole, Wedge, split_hole};
pub use options::{FillOptions, Order};
pub use prepared::Prepared;
pub use real::{Interval, Real};
pub use record::{Foreign, RECORDS, load, load_with};
pub use scene::Scene;
pub use sheet::SheetPatch;
pub use taylor::{Enclosure, Expansion, Taylor};
pub use three::{CertifiedHole, HoleCertificate, ThreeSided, Tip};
