//! C¹ implicit surfaces of degree 3 over triangle meshes with normals (A-patches).
//!
//! * [`apatch`] builds an [`ApatchSurface`] from a mesh and one gradient per vertex; [`ApatchReport`] says what it found and proved.
//! * [`ApatchSurface::face_point`], [`ApatchSurface::edge_point`]: points with gradients. [`ApatchSurface::tessellate`]: a watertight
//!   mesh at a fixed resolution. [`ApatchSurface::surface`]: parametric patches with exact second derivatives, and their seams.
//! * [`Locator`], [`ApatchSurface::value`], [`ApatchSurface::inside`]: the implicit function.
//! * [`ApatchSurface::face_bound`], [`ApatchSurface::set_weight`]: the one free number per face and side; [`WeightRays`]: what it does to the
//!   surface, for interactive change. [`Shading`]: isophotes and reflection lines.
//!
//! ```
//! use suture_apatch::{ApatchOptions, apatch};
//! use suture_mesh::shapes;
//!
//! // Twenty triangles whose corners and normals are those of a sphere: the surface is the sphere.
//! let mesh = shapes::sphere(0);
//! let surface = apatch(&mesh, &mesh.positions, &ApatchOptions::default())?;
//! let point = surface.face_point(7, [0.5, 0.3, 0.2]).unwrap();
//! assert!((point.position.length() - 1.0).abs() < 1e-14);
//! assert!(surface.report().unproven_faces.is_empty());
//! assert!(suture_mesh::check(&surface.tessellate(8, 2)?.mesh).closed);
//! # Ok::<(), suture_apatch::ApatchError>(())
//! ```
//!
//! Conventions: faces are counter-clockwise seen from the positive side, towards which `F` and the normals grow; edge `k` of a face is
//! opposite its vertex `k`; lengths in units of the input, tolerances relative. The same input gives the same bits for any number of
//! threads. Letters are those of the paper: `u` and `v` are apexes, `e`, `h`, `m`, `r` coefficients of `F`.
//!
//! When not to use it: where curvature must be continuous, where normals are unknown and corners sharp, or where patches must be
//! polynomial: these are roots of cubics, not polynomials.

#![forbid(unsafe_code)]

mod apexes;
mod bounds;
mod build;
mod coefficients;
mod cubic;
mod directions;
mod edge;
mod error;
mod face;
mod hull;
mod intersect;
mod options;
mod patches;
mod query;
mod refine;
mod report;
mod shooting;
mod surface;
mod tessellate;
mod unfold;
mod weights;

pub use bounds::FaceBound;
pub use build::apatch;
pub use error::ApatchError;
pub use face::SurfacePoint;
pub use hull::Class;
pub use options::{ApatchOptions, ApexWeight};
pub use patches::{EdgePatch, FacePatch, PlanarPatch, RECORDS, load, tetrahedra};
pub use query::{Cell, Location, Locator};
pub use report::{ApatchReport, ClassCounts, Intersections};
pub use shooting::{Root, Shooting};
pub use surface::{ApatchSurface, Side};
pub use tessellate::{ApatchTessellation, Shading};
pub use weights::WeightRays;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
