//! C² blends between B-spline surfaces: strips along arcs, N-blends at corners.
//!
//! Where the segments of a surface meet, each with a B-spline of its own, the B-splines are cut back and the gaps are
//! filled with weighted means of the two or N surfaces involved. The weights and the maps `G` that bring points of the surfaces
//! together fulfil the conditions (H1)–(H25) and (G1)–(G8) of Wagner, Hormann and Greiner (*C²-continuous surface reconstruction with
//! piecewise polynomial patches*, 2003) identically: the result is C² by construction, not by fitting.
//!
//! The input is plain ([`Network`]): B-splines, and polylines of points with parameters on both sides; where they came from does not
//! matter. When not to use it: surfaces with a boundary (no arc may have only one side), or gaps whose surfaces do not
//! continue beyond their borders (a fill is made for those).
//!
//! Conventions: seen from outside, arcs leave a corner counter-clockwise; a strip runs along its arc with `U`, the segment on
//! the right (↓) at `V = 0`, the one on the left (↑) at `V = 1`; beside a corner it runs towards the corner. N-gons have edge length 1,
//! centre 0 and their first corner on the positive V axis.

#![forbid(unsafe_code)]

mod assemble;
mod check;
mod correspondence;
mod error;
pub mod gon;
mod maps;
mod metric;
mod network;
mod paper;
mod patches;
mod polynomial;
mod sewing;
mod tables;
pub mod weights;
mod widths;

pub use assemble::Blend;
pub use check::{MapReport, Obstacle, check_maps};
pub use correspondence::Correspondence;
pub use error::BlendError;
pub use maps::{CornerMapSet, CornerMaps, MapSet, Memory, StripMaps};
pub use metric::isometry;
pub use network::{ArcCurve, ArcEnd, ArcSample, Corner, Network};
pub use paper::PaperMaps;
pub use patches::{NBlend, RECORDS, Strip, Trimmed, load};
pub use polynomial::PlanePolynomial;
pub use sewing::{Sewing, blend};
pub use widths::{Intent, WidthOptions, Widths, admissible, outward_reach, reach};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
