//! Everything that can go wrong between a file and a surface.

use std::path::PathBuf;

use suture_apatch::ApatchError;
use suture_bubble::BubbleError;
use suture_mesh::normals::NormalsError;

/// Why there is no result. [`kind`](Self::kind) is stable, for programs; the message is for people.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SutureError {
    /// A file could not be read as what it should be.
    #[error("{}: {source}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: suture_mesh::MeshError,
    },
    /// A file could not be read at all.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The mesh is not an oriented manifold.
    #[error("{0}; run `suture check` for the whole list of defects, or pass --repair")]
    Topology(#[from] suture_mesh::TopologyError),
    /// The mesh cannot be cut into charts as asked.
    #[error(transparent)]
    Segment(#[from] suture_segment::SegmentError),
    /// A segment cannot be flattened.
    #[error("segment {segment}: {source}")]
    Chart {
        /// The segment.
        segment: usize,
        /// Why.
        source: suture_param::ParamError,
    },
    /// A chart cannot be fitted.
    #[error("segment {segment}: {source}")]
    Fit {
        /// The segment.
        segment: usize,
        /// Why.
        source: suture_fit::FitError,
    },
    /// The B-splines cannot be blended.
    #[error(transparent)]
    Blend(#[from] suture_blend::BlendError),
    /// The mesh has no normals where they are needed, and none can be estimated.
    #[error(transparent)]
    Normals(#[from] suture_mesh::normals::NormalsError),
    /// The mesh has no A-patches.
    #[error(transparent)]
    Apatch(#[from] suture_apatch::ApatchError),
    /// The mesh has no bubble surface.
    #[error(transparent)]
    Bubble(#[from] suture_bubble::BubbleError),
    /// A gap or hole cannot be filled as asked for.
    #[error(transparent)]
    Fill(#[from] suture_coons::CoonsError),
    /// The surface cannot be tessellated.
    #[error(transparent)]
    Tessellate(#[from] suture_tessellate::TessellateError),
    /// The surface cannot be measured.
    #[error(transparent)]
    Certify(#[from] suture_certify::CertifyError),
    /// The result cannot be written.
    #[error(transparent)]
    Export(#[from] suture_export::ExportError),
    /// The picture cannot be drawn or written.
    #[error(transparent)]
    View(#[from] suture_view::ViewError),
    /// The mesh has another form than the command works on.
    #[error("{what}")]
    Unsuitable {
        /// What it is and what to do.
        what: String,
    },
    /// The caller asked to stop.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// A promise between two stages was broken: a defect of this program.
    #[error("internal error: {what}; please report it with the input")]
    Internal {
        /// What was broken.
        what: String,
    },
}

impl SutureError {
    /// A stable name of the kind of error, for the report.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Mesh { .. } => "input",
            Self::File { .. } => "file",
            Self::Topology(_) => "topology",
            Self::Segment(_) => "segment",
            Self::Chart { .. } => "chart",
            Self::Fit { .. } => "fit",
            Self::Blend(_) => "blend",
            Self::Normals(_) => "normals",
            Self::Apatch(_) => "apatch",
            Self::Bubble(_) => "bubble",
            Self::Fill(_) => "fill",
            Self::Tessellate(_) => "tessellate",
            Self::Certify(_) => "certify",
            Self::Export(_) => "export",
            Self::View(_) => "view",
            Self::Unsuitable { .. } => "unsuitable",
            Self::Interrupted => "interrupted",
            Self::Internal { .. } => "internal",
        }
    }

    /// Where the error is, where that is one thing: a file, a segment, a face, an edge or a vertex.
    pub fn at(&self) -> Option<String> {
        match self {
            Self::Mesh { path, .. } | Self::File { path, .. } => Some(path.display().to_string()),
            Self::Chart { segment, .. } | Self::Fit { segment, .. } => Some(format!("segment {segment}")),
            Self::Normals(NormalsError::NotFinite { vertex } | NormalsError::NoNormal { vertex }) => {
                Some(format!("vertex {vertex}"))
            }
            Self::Apatch(e) => match e {
                ApatchError::NotFinite { vertex } | ApatchError::Normal { vertex, .. } => {
                    Some(format!("vertex {vertex}"))
                }
                ApatchError::DegenerateFace { face, .. }
                | ApatchError::NormalAgainstFace { face, .. }
                | ApatchError::NotFinitePatch { face } => Some(format!("face {face}")),
                _ => None,
            },
            Self::Bubble(e) => match e {
                BubbleError::NotFinite { vertex }
                | BubbleError::Normal { vertex, .. }
                | BubbleError::Implicit { vertex, .. } => Some(format!("vertex {vertex}")),
                BubbleError::VertexIndex { face, .. } | BubbleError::RepeatedVertex { face, .. } => {
                    Some(format!("face {face}"))
                }
                BubbleError::CoincidentVertices { edge: [a, b] }
                | BubbleError::Degenerate { edge: [a, b], .. } => Some(format!("edge {a} {b}")),
                _ => None,
            },
            _ => None,
        }
    }
}
