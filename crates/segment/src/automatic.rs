//! Automatic segmentation.
use suture_mesh::{Topology, TriMesh};

use crate::{Flatten, Limits, NormalSpread, Segment, SegmentError, Segmentation};

/// Segmentation from the mesh alone.
pub struct Automatic {
    /// What is asked of the charts.
    pub options: AutomaticOptions,
    /// The test whether a union of charts can still be flattened.
    pub flatten: Box<dyn Flatten + Send + Sync>,
}

/// What is asked of automatic charts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutomaticOptions {
    /// Number of charts.
    pub charts: Option<usize>,
    /// What the partition is allowed to be.
    pub limits: Limits,
}

impl Default for AutomaticOptions {
    fn default() -> Self {
        Self { charts: None, limits: Limits { max_valence: 6 } }
    }
}

impl Default for Automatic {
    fn default() -> Self {
        Self { options: AutomaticOptions::default(), flatten: Box::new(NormalSpread::default()) }
    }
}

impl Segment for Automatic {
    fn segment(&self, mesh: &TriMesh, topology: &Topology) -> Result<Segmentation, SegmentError> {
        Segmentation::from_labels_with(mesh, topology, &vec![0u32; mesh.faces.len()], self.options.limits)
    }
}
