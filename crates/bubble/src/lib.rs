//! Bubble splines: surfaces of order G⁰ to G⁴ over meshes of triangles and quads with normals, one patch per face.
//!
//! [`bubble`] is the whole way; its stages can be taken one by one: [`VertexImplicits`] (how the surface bends at the vertices, by
//! default fitted: [`Fitted`]), [`Network`] (strips along the edges), [`bubble_over`] (patches over strips). [`BubbleSurface::tessellate`]:
//! a watertight mesh at a fixed resolution.
//!
//! ```
//! use glam::DVec2;
//! use suture_bubble::{BubbleOptions, PolyMesh, bubble};
//! use suture_surface::Patch;
//!
//! // Twenty patches over the icosahedron, curvature continuous, nearly a sphere.
//! let mesh = suture_mesh::shapes::sphere(0);
//! let poly = PolyMesh::from_triangles(&mesh, &mesh.positions)?;
//! let ball = bubble(&poly, &BubbleOptions { order: 2, ..Default::default() })?;
//! let middle = ball.patches()[0].jet(DVec2::new(1.0 / 3.0, 1.0 / 3.0));
//! assert!((middle.p.length() - 1.0).abs() < 5e-4);
//! # Ok::<(), suture_bubble::BubbleError>(())
//! ```
//!
//! Conventions: the patch of face `f` is number `f`; corner 0 of a triangle is at `(0, 0)`, corner 1 at `(1, 0)`, corner 2 at `(0, 1)`; quads live
//! on the unit square; side `k` runs from corner `k` to the next. Strips run from the lower vertex to the higher one. `h` is the height
//! along the interpolated normal `N`, which is not normalised. Letters are those of Kapl, Byrtus and Jüttler (2011).
//!
//! [`bubble_creased`] keeps edges sharp, [`spline`] writes B-splines.
//!
//! When not to use it: meshes that wind back on themselves within a triangle (patches fold there, the report tells); where few patches
//! are wanted.

#![forbid(unsafe_code)]

mod assemble;
mod bend;
mod corner;
mod crease;
mod cross;
mod ends;
mod error;
mod fan;
mod fast;
mod fit;
mod half;
mod height;
mod hermite;
mod implicit;
mod lean;
mod monomial;
mod near;
mod network;
mod newton;
mod patch;
mod poly_mesh;
mod record;
mod report;
mod series;
pub mod spline;
mod steer;
mod strip;
mod taylor;
mod tessellate;

pub use assemble::{BubbleOptions, BubbleSurface, bubble, bubble_creased, bubble_over, bubble_with};
pub use crease::{Creased, sharp_edges, split_creases};
pub use error::{BubbleError, Measure};
pub use fit::{Fit, Fitted};
pub use implicit::{Implicit, TaylorOf, VertexImplicits};
pub use network::{EdgeUse, MeshEdge, Network, mesh_edges};
pub use patch::{BubblePatch, Pairing};
pub use poly_mesh::{Face, PolyMesh};
pub use record::{RECORDS, load};
pub use report::{BubbleReport, BubbleWarning, Extreme};
pub use steer::{Turned, steer_normals};
pub use strip::{EndTaylor, Strip};
pub use tessellate::BubbleTessellation;

/// The largest order of smoothness.
pub const MAX_ORDER: usize = 4;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
