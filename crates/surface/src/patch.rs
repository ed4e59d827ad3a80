//! The parametric patch.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_bernstein::Jet2;

use crate::{Domain, Record, SplinePool};

/// What a patch is made by and stands for: the key of colours, counts and materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PatchKind {
    /// A B-spline surface trimmed to the interior of its segment.
    Trimmed,
    /// A blending strip along an arc; strips of one arc alternate between even and odd.
    Strip {
        /// Whether it is an odd one of its arc.
        odd: bool,
    },
    /// A blending strip that touches an N-blend.
    AdjacentStrip,
    /// An N-blend around a corner.
    NBlend {
        /// Number of segments at the corner.
        n: u8,
    },
    /// A bubble spline patch over a face of a mesh.
    Bubble {
        /// Number of corners of the face, 3 or 4.
        n: u8,
    },
    /// The part of an implicit surface over a face of the mesh.
    Face,
    /// The part of an implicit surface along an edge of the mesh.
    Edge,
    /// A plane face of the mesh, kept as it is.
    Planar,
    /// A patch that closes a gap or a part of a hole.
    Fill {
        /// Number of its sides, 3 or 4.
        sides: u8,
    },
    /// A surface that was given, kept as it is.
    Given,
}

/// A parametric patch: the one noun that all methods share.
pub trait Patch: Send + Sync + std::fmt::Debug {
    /// The parameter domain with its boundary edges.
    fn domain(&self) -> Domain;

    /// Value and partials to second order at `at`, a point of the domain or so close to it that rounding explains the
    /// distance. Exact derivatives, no differences.
    fn jet(&self, at: DVec2) -> Jet2;

    /// Kind of the patch.
    fn kind(&self) -> PatchKind;

    /// The patch as data that its method can load again to the same bits; shared B-splines go to the pool.
    fn record(&self, pool: &mut SplinePool) -> Record;

    /// Unit normal, or `None` where the patch is singular (see [`Jet2::normal`]).
    fn normal(&self, at: DVec2) -> Option<DVec3> {
        self.jet(at).normal()
    }
}
