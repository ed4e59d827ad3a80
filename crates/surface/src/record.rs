//! Patches as data: the native format's view of a patch, open to methods that do not exist yet.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_bernstein::BSplineSurface;

/// One patch as data: the type that its method reads, and what it needs to build the patch again to the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Name under which the method that made the patch loads it again, for example `"blend.strip"`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The method's own data; B-splines by their number in the [`SplinePool`].
    pub data: serde_json::Value,
}

/// Why a record does not become a patch.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// No loader knows this type of record.
    #[error("no method loads patches of type {kind:?}")]
    UnknownKind {
        /// The type found.
        kind: String,
    },
    /// The data does not have the form that its type asks for.
    #[error("a patch of type {kind:?} is malformed: {reason}")]
    Malformed {
        /// The type found.
        kind: String,
        /// What is wrong.
        reason: String,
    },
}

/// B-spline surfaces shared by several patches, each stored once.
#[derive(Clone, Debug, Default)]
pub struct SplinePool {
    splines: Vec<Arc<BSplineSurface<DVec3>>>,
}

impl SplinePool {
    /// A pool of given splines, for loading.
    pub fn new(splines: Vec<Arc<BSplineSurface<DVec3>>>) -> Self {
        Self { splines }
    }

    /// The number of `spline`, entered on first sight. Identity is that of the allocation, not of the values.
    pub fn index(&mut self, spline: &Arc<BSplineSurface<DVec3>>) -> usize {
        let known = self.splines.iter().position(|s| Arc::ptr_eq(s, spline));
        known.unwrap_or_else(|| {
            self.splines.push(Arc::clone(spline));
            self.splines.len() - 1
        })
    }

    /// The spline of number `index`.
    pub fn get(&self, index: usize) -> Option<&Arc<BSplineSurface<DVec3>>> {
        self.splines.get(index)
    }

    /// All splines, by number.
    pub fn splines(&self) -> &[Arc<BSplineSurface<DVec3>>] {
        &self.splines
    }
}
