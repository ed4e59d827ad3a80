//! Labels per face: the text format, and the segmentation they stand for.

use std::fmt::Write;

use suture_mesh::{Topology, TriMesh};

use crate::{Segment, SegmentError, Segmentation};

/// Segmentation by one given label per face.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels(
    /// The label of every face, in the order of the faces; any numbers.
    pub Vec<u32>,
);

impl Segment for Labels {
    fn segment(&self, mesh: &TriMesh, topology: &Topology) -> Result<Segmentation, SegmentError> {
        Segmentation::from_labels(mesh, topology, &self.0)
    }

    fn names_the_mesh(&self) -> bool {
        true
    }
}

/// Reads one non-negative integer per line, in the order of the faces. A byte order mark, blanks around the numbers, CRLF and
/// empty lines at the end are accepted.
///
/// # Errors
/// [`SegmentError::Label`] with the line. That their number fits the mesh is checked by [`Segmentation::from_labels`].
pub fn read_labels(text: &str) -> Result<Vec<u32>, SegmentError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.trim_end()
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let line = line.trim();
            line.parse().map_err(|_| SegmentError::Label { line: i + 1, text: excerpt(line) })
        })
        .collect()
}

/// Writes one label per line, as [`read_labels`] reads them.
pub fn write_labels(labels: &[u32]) -> String {
    let mut text = String::with_capacity(labels.len() * 3);
    for label in labels {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{label}");
    }
    text
}

/// The first 40 characters, for an error message.
pub(crate) fn excerpt(text: &str) -> String {
    text.chars().take(40).collect()
}
