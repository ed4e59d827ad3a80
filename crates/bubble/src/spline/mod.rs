//! The spline variant: Hermite boundary data as cubic splines, so that patches are polynomial or rational tensor-product B-splines.
//!
//! Cross derivatives of the height along edges become C² cubic splines over `K` uniform intervals that keep value and derivatives up to order `n`
//! at both ends: corners stay as they are, positions still agree across seams, normals and curvatures to within a jump that falls like `K⁻⁴`
//! and `K⁻³`. A triangle takes the single pairing `P₁ ⊕ P₂`; with its own cubic height it is rational of bidegree (5, 5), (7, 7) or (11, 11) for orders
//! 0, 1, 2, a quad polynomial of (4, 4), (4, 4), (6, 6).
//!
//! ```
//! use suture_bubble::{BubbleOptions, PolyMesh, bubble, spline::{Intervals, SplineOptions, spline_surface}};
//!
//! let mesh = suture_mesh::shapes::sphere(0);
//! let poly = PolyMesh::from_triangles(&mesh, &mesh.positions)?;
//! let ball = bubble(&poly, &BubbleOptions { order: 1, ..Default::default() })?;
//! let options = SplineOptions { intervals: Intervals::Angle(1e-5), exact_height: false };
//! let splines = spline_surface(&ball, &options)?;
//! assert!(splines.normal < 1e-5 && splines.position < 1e-12);
//! assert_eq!(splines.patches[0].bspline()?.points.degree(), [7, 7]);
//! # Ok::<(), suture_bubble::BubbleError>(())
//! ```

mod cubic;
mod net;
mod patch;
mod pieces;
mod surface;

pub use net::HomogeneousSpline;
pub use patch::SplinePatch;
pub use surface::{Intervals, SplineOptions, SplineSurface, spline_surface};

/// Fewest intervals.
pub const LEAST: usize = 4;
/// Most intervals.
pub const MOST: usize = 1024;
