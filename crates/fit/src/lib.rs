//! Fits one chart, a disc of triangles with parameters, by a uniform bicubic B-spline surface.
//!
//! Minimises `Σ wᵢ |F(pᵢ) − xᵢ|² + λ a^(m−1) ∫ |Dᵐ F|²` with weights from the areas in space; λ is dimensionless. Around that
//! linear problem [`fit`] runs the recipe: minimum-area domain rectangle, knots from the median edge, λ by generalised cross
//! validation above a floor, foot-point correction of the parameters, guards, refinement until the tolerance holds or λ says
//! that what remains is noise.
//!
//! ```
//! use glam::{DVec2, DVec3};
//! use suture_fit::{FitInput, FitOptions, fit};
//!
//! // A 12 × 12 grid of vertices on a paraboloid.
//! let params: Vec<DVec2> = (0..144).map(|k| DVec2::new((k % 12) as f64, (k / 12) as f64) / 11.0).collect();
//! let points: Vec<DVec3> = params.iter().map(|p| p.extend(p.length_squared())).collect();
//! let quads = (0..132u32).filter(|k| k % 12 < 11);
//! let triangles: Vec<[u32; 3]> = quads.flat_map(|k| [[k, k + 1, k + 13], [k, k + 13, k + 12]]).collect();
//! let in_segment = vec![true; triangles.len()];
//! let input = FitInput {
//!     points: &points, params: &params, triangles: &triangles, in_segment: &in_segment, diagonal: 2.4, reach: 0.0,
//! };
//! let result = fit(&input, &FitOptions::default())?;
//! assert!(result.report.rms < 1e-9);
//! assert!(result.jet(result.params[0]).is_some_and(|jet| jet.p.distance(points[0]) < 1e-8));
//! # Ok::<(), suture_fit::FitError>(())
//! ```
//!
//! # Conventions
//! The surface lives over the chart's parameters after a rigid motion ([`Fit::frame`], longer side of the rectangle = `u`) and
//! the correction: [`Fit::params`] are the chart from then on. Only the active cells ([`Fit::cells`]) carry meaning:
//! [`Fit::jet`] says where. Tolerances and reported lengths are relative to the diagonal of the whole mesh.
//!
//! # Determinism
//! One thread per chart; all sums run in an order given by the geometry, so that neither threads nor the numbering of the
//! vertices matter beyond rounding. Put the parallelism over charts.
//!
//! # When not to use it
//! For scattered points without triangles (no areas, no flip guard), for charts with folds, and across sharp edges: one C²
//! function through a crease rings on both sides. To interpolate rather than approximate, this is the wrong tool.
//!
//! # References
//! Floater, Iske: Thinning and approximation of large sets of scattered data (1998); Craven, Wahba: Smoothing noisy data with
//! spline functions, Numer. Math. 31 (1979), GCV; Wood: Generalized Additive Models (2nd ed. 2017), 6.2.2, the factor `gamma`.

#![forbid(unsafe_code)]

mod cells;
mod chart;
mod cholesky;
mod correction;
mod energy;
mod error;
mod fit;
mod grid;
mod guard;
mod options;
mod rectangle;
mod report;
mod smoothing;
mod stencil;
mod system;

pub use cells::Cells;
pub use chart::FitInput;
pub use energy::EnergyOrder;
pub use error::FitError;
pub use fit::{Fit, FitSurface, PenalizedLeastSquares, fit};
pub use grid::Grid;
pub use options::{FitOptions, Knots, Mode, Smoothing, Tolerance};
pub use rectangle::Frame;
pub use report::{FitReport, GuardReport, Outcome};
pub use system::{Factor, System, solve};
