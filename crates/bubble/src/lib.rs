//! Bubble splines: G⁰, G¹ and G² surfaces, one patch per triangle or quad.
#![forbid(unsafe_code)]

mod assemble;
mod corner;
mod cross;
mod error;
mod fast;
mod fit;
mod hermite;
mod implicit;
mod monomial;
mod network;
mod patch;
mod poly_mesh;
mod record;
mod report;
mod series;
mod strip;

pub use assemble::{BubbleOptions, BubbleSurface, bubble, bubble_over, bubble_with};
pub use error::{BubbleError, Measure};
pub use fit::{Fit, Fitted};
pub use implicit::{Implicit, TaylorOf, VertexImplicits};
pub use network::{EdgeUse, MeshEdge, Network, mesh_edges};
pub use patch::{BubblePatch, Pairing};
pub use poly_mesh::{Face, PolyMesh};
pub use record::{RECORDS, load};
pub use report::{BubbleReport, BubbleWarning, Extreme};
pub use strip::{EndTaylor, Strip};

/// The largest order of smoothness.
pub const MAX_ORDER: usize = 4;
