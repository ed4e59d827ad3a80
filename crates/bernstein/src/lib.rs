//! Bernstein, B-spline and triangle bases; control nets over them; jets and their chain and product rules.
//!
//! The floor of the house: knows no mesh, no patch and no file; depends on nothing but glam.
//!
//! * [`Jet2`]: value and partials to second order of a function of two variables, with the product and the chain rule.
//! * [`bernstein`], [`bspline`]: the bases, values and derivatives, written into the caller's slice: no allocation.
//! * [`BezierCurve`], [`BezierPatch`], [`BezierTriangle`], [`BSplineCurve`], [`BSplineSurface`]: control nets of any degree up to
//!   [`MAX_DEGREE`] over any [`Vector`] (`f64`, `DVec2`, `DVec3`). `jet` and `point` evaluate without allocation.
//! * The same polynomial in other nets: `split`, `restrict` (de Casteljau), `elevate`, `insert` (Boehm), `extract`
//!   (B-spline to Bézier).
//! * New polynomials: `derivative` (hodographs), `product` (any bilinear map of two nets).
//! * Exact integrals: `integral` of a net, [`bernstein::product_integral`], [`triangle_product_integral`], [`Gram`] matrices
//!   of B-spline bases and their derivatives, [`gauss_legendre`].
//!
//! ```
//! use glam::DVec2;
//! use suture_bernstein::{Axis, BezierPatch};
//!
//! // x(u, v) = u v, written as a bilinear net.
//! let patch = BezierPatch::new([1, 1], vec![0.0, 0.0, 0.0, 1.0])?;
//! let jet = patch.jet(DVec2::new(0.5, 0.25));
//! assert_eq!((jet.p, jet.du, jet.dv, jet.duv), (0.125, 0.25, 0.5, 1.0));
//! let [_, upper] = patch.elevate(Axis::U, 2)?.split(Axis::U, 0.5)?;
//! assert_eq!(upper.point(DVec2::new(0.0, 0.25)), 0.125);
//! # Ok::<(), suture_bernstein::NetError>(())
//! ```
//!
//! Conventions: tensor nets are stored with the second index fastest, `net[i * columns + j]`; `u` belongs to the first index;
//! Bézier nets live on `[0, 1]`, B-splines on `[knots[degree], knots[count]]`; outside their domain all are continued
//! polynomially (by the first or last piece). When not to use it: rational (NURBS) geometry.
//!
//! Features: `serde` saves and loads nets; what is loaded is checked like what is built.

#![forbid(unsafe_code)]

mod axis;
pub mod bernstein;
pub mod bspline;
mod curve;
mod elevate;
mod error;
mod extract;
mod gauss;
mod hodograph;
mod insert;
mod integral;
mod jet;
mod patch;
mod product;
mod subdivide;
mod triangle;
mod vector;

pub use axis::Axis;
pub use curve::{BSplineCurve, BezierCurve};
pub use error::NetError;
pub use extract::BezierGrid;
pub use gauss::gauss_legendre;
pub use integral::{Gram, span_gram, triangle_product_integral};
pub use jet::Jet2;
pub use patch::{BSplineSurface, BezierPatch};
pub use triangle::BezierTriangle;
pub use vector::Vector;

/// Largest degree of any basis here: the evaluation buffers live on the stack.
pub const MAX_DEGREE: usize = 31;

/// Bases of at most this many functions are evaluated in small buffers: clearing them is a good part of the time.
const SMALL: usize = 8;
