//! A-patches.

#![forbid(unsafe_code)]

mod bounds;
mod build;
mod coefficients;
mod cubic;
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

pub use bounds::FaceBound;
pub use build::apatch;
pub use error::ApatchError;
pub use face::SurfacePoint;
pub use hull::{EdgeClass, FaceClass};
pub use options::{ApatchOptions, ApexWeight};
pub use patches::{EdgePatch, FacePatch, PlanarPatch, RECORDS, load};
pub use query::{Cell, Location, Locator};
pub use report::{ApatchReport, ClassCounts, Intersections};
pub use shooting::{Root, Shooting};
pub use surface::{ApatchSurface, Side};
pub use tessellate::{ApatchTessellation, Shading};
