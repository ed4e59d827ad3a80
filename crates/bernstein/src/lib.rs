//! Bernstein, B-spline and triangle bases; control nets over them; jets and their chain and product rules.
//!
//! The floor of the house: knows no mesh, no patch and no file; depends on nothing but glam.
//!
//! * [`Jet2`]: value and partials to second order of a function of two variables, with the product and the chain rule.
//! * [`bernstein`], [`bspline`]: the bases, values and derivatives, written into the caller's slice: no allocation.
//! * [`BezierCurve`], [`BezierPatch`], [`BezierTriangle`], [`BSplineCurve`], [`BSplineSurface`]: control nets of any degree up to
//!   [`MAX_DEGREE`] over any [`Vector`] (`f64`, `DVec2`, `DVec3`).
//!
//! ```
//! use glam::DVec2;
//! use suture_bernstein::BezierPatch;
//!
//! // x(u, v) = u v, written as a bilinear net.
//! let patch = BezierPatch::new([1, 1], vec![0.0, 0.0, 0.0, 1.0])?;
//! let jet = patch.jet(DVec2::new(0.5, 0.25));
//! assert_eq!((jet.p, jet.du, jet.dv, jet.duv), (0.125, 0.25, 0.5, 1.0));
//! # Ok::<(), suture_bernstein::NetError>(())
//! ```
//!
//! Conventions: tensor nets are stored with the second index fastest, `net[i * columns + j]`; `u` belongs to the first index;
//! Bézier nets live on `[0, 1]`, B-splines on `[knots[degree], knots[count]]`; outside their domain all are continued
//! polynomially (by the first or last piece). When not to use it: rational (NURBS) geometry.

#![forbid(unsafe_code)]

pub mod bernstein;
pub mod bspline;
mod curve;
mod error;
mod jet;
mod patch;
mod triangle;
mod vector;

pub use curve::{BSplineCurve, BezierCurve};
pub use error::NetError;
pub use jet::Jet2;
pub use patch::{BSplineSurface, BezierPatch};
pub use triangle::BezierTriangle;
pub use vector::Vector;

/// Largest degree of any basis here: the evaluation buffers live on the stack.
pub const MAX_DEGREE: usize = 31;
