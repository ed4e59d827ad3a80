//! How a long computation is watched and stopped.

/// Told of progress, asked whether to go on. Called from several threads.
pub trait Watch: Sync {
    /// A stage of `steps` steps begins.
    fn begin(&self, stage: Stage, steps: usize);

    /// One step of the current stage is done.
    fn step(&self);

    /// Whether the computation is to stop; asked between steps.
    fn interrupted(&self) -> bool;
}

/// Nobody watches, nobody stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn begin(&self, _: Stage, _: usize) {}

    fn step(&self) {}

    fn interrupted(&self) -> bool {
        false
    }
}

/// The stages of all commands, each in the order in which a command runs them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Adjacency and tests of the mesh.
    Mesh,
    /// Labels, corners and arcs.
    Segment,
    /// Charts with collars and their B-splines.
    Fit,
    /// Maps, strips and N-blends.
    Blend,
    /// One patch per face, and along edges.
    Patches,
    /// One watertight mesh.
    Tessellate,
    /// Jumps at every seam.
    Certify,
    /// Distances both ways.
    Deviation,
    /// Faces, edges and curves of a STEP file.
    Export,
}

impl Stage {
    /// The name under which the report times it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Segment => "segment",
            Self::Fit => "fit",
            Self::Blend => "blend",
            Self::Patches => "patches",
            Self::Tessellate => "tessellate",
            Self::Certify => "certify",
            Self::Deviation => "deviation",
            Self::Export => "export",
        }
    }
}
