//! One watertight triangle mesh of a surface.
//!
//! Every seam is sampled once and both patches use its vertices; corners are identified through chains of seam ends. Whatever the
//! patches are, the mesh is closed where all edges belong to seams. Rectangles and polygons get regular grids where the counts
//! of their edges agree, trimmed domains a constrained Delaunay triangulation whose interior points follow the curvature.
//!
//! ```
//! # use glam::{DVec2, DVec3};
//! # use suture_bernstein::{BezierPatch, Jet2};
//! # use suture_surface::{Domain, Patch, PatchKind, Record, SplinePool};
//! # #[derive(Debug)]
//! # struct Bezier(BezierPatch<DVec3>);
//! # impl Patch for Bezier {
//! #     fn domain(&self) -> Domain { Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE } }
//! #     fn jet(&self, at: DVec2) -> Jet2 { self.0.jet(at) }
//! #     fn kind(&self) -> PatchKind { PatchKind::Trimmed }
//! #     fn record(&self, _: &mut SplinePool) -> Record { unimplemented!() }
//! # }
//! use suture_surface::Surface;
//! use suture_tessellate::{TessellationOptions, tessellate};
//!
//! let saddle = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::new(1.0, 1.0, 1.0)];
//! let surface = Surface::new(vec![Box::new(Bezier(BezierPatch::new([1, 1], saddle.to_vec())?))], vec![])?;
//! let coarse = tessellate(&surface, &TessellationOptions::default())?;
//! let fine = tessellate(&surface, &TessellationOptions { chord: 1e-5, ..Default::default() })?;
//! assert!(fine.mesh.faces.len() > coarse.mesh.faces.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions: lengths in [`TessellationOptions`] are relative to the size of the surface, angles in radians; triangles are
//! counter-clockwise in the parameter plane of their patch, hence seen from the side of `S_u × S_v`. The same surface gives the same
//! bits for any number of threads, and the same triangles after scaling by a power of two.
//!
//! When not to use it: for the distance between a surface and a mesh (the chords lie beside the surface; measure on the patches),
//! and where seams are gaps: positions come from one side, nothing is repaired.

#![forbid(unsafe_code)]

mod counts;
mod demand;
mod error;
mod grid;
mod net;
mod options;
mod planar;
mod sites;
mod tessellation;
mod union_find;

pub use error::TessellateError;
pub use options::TessellationOptions;
pub use tessellation::{Tessellation, tessellate};
