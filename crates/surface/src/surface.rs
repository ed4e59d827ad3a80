//! Patches and their seams.

use serde::{Deserialize, Serialize};

use crate::Patch;

/// Index of a patch in [`Surface::patches`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PatchId(pub u32);

/// Order of smoothness across a seam, ascending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Continuity {
    /// Positions agree.
    C0,
    /// Tangent planes agree (first derivatives do after a change of parameters).
    G1,
    /// First derivatives of some common parameterisation agree.
    C1,
    /// Curvatures agree (second derivatives do after a change of parameters).
    G2,
    /// Second derivatives of some common parameterisation agree.
    C2,
}

/// A boundary edge of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct EdgeRef {
    /// The patch.
    pub patch: PatchId,
    /// Number of the edge in the domain of the patch.
    pub edge: u32,
}

/// Two boundary edges that are one curve in space: the point at `t` of `a` is the point at `1 − t` of `b` (both edges have
/// their patch on the left, so they run against each other), or at `t` of `b` when `same_direction` is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seam {
    /// One side.
    pub a: EdgeRef,
    /// The other side.
    pub b: EdgeRef,
    /// Whether both edges run in the same direction: the orientations of the patches disagree.
    #[serde(default)]
    pub same_direction: bool,
    /// How smoothly the maker of the surface claims that the patches join.
    pub claimed: Continuity,
}

impl Seam {
    /// A seam between two edges that run against each other.
    pub fn new(a: EdgeRef, b: EdgeRef, claimed: Continuity) -> Self {
        Self { a, b, same_direction: false, claimed }
    }

    /// The parameter on `b` of the point at `t` of `a`.
    pub fn opposite(&self, t: f64) -> f64 {
        if self.same_direction { t } else { 1.0 - t }
    }
}

/// Patches and the seams between them. An edge that no seam names is a boundary of the surface.
#[derive(Debug, Default)]
pub struct Surface {
    patches: Vec<Box<dyn Patch>>,
    seams: Vec<Seam>,
}

/// Why patches and seams do not form a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A seam names a patch or an edge that does not exist.
    #[error("seam {seam} names edge {} of patch {}, which does not exist", edge.edge, edge.patch.0)]
    NoSuchEdge {
        /// The seam.
        seam: usize,
        /// The missing edge.
        edge: EdgeRef,
    },
    /// Two seams name the same edge.
    #[error("seams {} and {} both name edge {} of patch {}", seams[0], seams[1], edge.edge, edge.patch.0)]
    SharedEdge {
        /// The two seams.
        seams: [usize; 2],
        /// The edge named twice.
        edge: EdgeRef,
    },
}

impl Surface {
    /// A surface from its patches and seams.
    ///
    /// # Errors
    /// [`SurfaceError`]: a seam names an edge that does not exist, or that another seam names. That the two edges of a seam are
    /// one curve is measured by the certificate, not here.
    pub fn new(patches: Vec<Box<dyn Patch>>, seams: Vec<Seam>) -> Result<Self, SurfaceError> {
        let mut taken: Vec<Vec<Option<usize>>> =
            patches.iter().map(|p| vec![None; p.domain().edge_count()]).collect();
        for (number, seam) in seams.iter().enumerate() {
            for edge in [seam.a, seam.b] {
                let slot = taken
                    .get_mut(edge.patch.0 as usize)
                    .and_then(|edges| edges.get_mut(edge.edge as usize))
                    .ok_or(SurfaceError::NoSuchEdge { seam: number, edge })?;
                if let Some(first) = slot.replace(number) {
                    return Err(SurfaceError::SharedEdge { seams: [first, number], edge });
                }
            }
        }
        Ok(Self { patches, seams })
    }

    /// The patches.
    pub fn patches(&self) -> &[Box<dyn Patch>] {
        &self.patches
    }

    /// The seams.
    pub fn seams(&self) -> &[Seam] {
        &self.seams
    }

    /// Patch `id`, if it exists.
    pub fn patch(&self, id: PatchId) -> Option<&dyn Patch> {
        self.patches.get(id.0 as usize).map(AsRef::as_ref)
    }
}
