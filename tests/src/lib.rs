//! Shared helpers of the integration tests: where data lies, how a case is run.

use std::path::{Path, PathBuf};

use glam::DVec3;
use suture::mesh::{TriMesh, io};
use suture::segment::{Labels, Segment, read_labels};
use suture::{ReconstructOptions, Reconstruction, Splits, Stages, SutureError, Unwatched, reconstruct};

/// The project's own test data.
pub fn own(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(path)
}

/// The collection of real meshes, which is not part of the project; `None`, with a printed reason, where it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data").join(path);
    if file.exists() {
        return Some(file);
    }
    println!("skipped: {path} is not here (the collection of real meshes is not part of the project)");
    None
}

/// Reads a mesh that a test relies on.
///
/// # Panics
/// When it cannot be read.
pub fn mesh(path: &Path) -> TriMesh {
    io::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).mesh
}

/// Reads labels that a test relies on.
///
/// # Panics
/// When they cannot be read.
pub fn labels(path: &Path) -> Labels {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    Labels(read_labels(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
}

/// Reconstructs with the segments of `segment`, split only where there is no other way.
///
/// # Errors
/// Those of the reconstruction.
pub fn run(mesh: &TriMesh, segment: Box<dyn Segment>) -> Result<Reconstruction, SutureError> {
    let splits = Splits { tolerance: None, ..Splits::default() };
    let options = ReconstructOptions { splits, ..ReconstructOptions::default() };
    reconstruct(mesh, &Stages { segment, ..Stages::default() }, &options, &Unwatched)
}

/// Reconstructs with defaults.
///
/// # Errors
/// Those of the reconstruction.
pub fn run_automatic(mesh: &TriMesh) -> Result<Reconstruction, SutureError> {
    reconstruct(mesh, &Stages::default(), &ReconstructOptions::default(), &Unwatched)
}

/// Applies `f` to every position.
pub fn mapped(mesh: &TriMesh, f: impl Fn(DVec3) -> DVec3) -> TriMesh {
    TriMesh::new(mesh.positions.iter().map(|&p| f(p)).collect(), mesh.faces.clone())
}

/// The six shapes of the paper with the counts of its table: name, triangles, segments, N-blends, strips.
pub const PAPER: [(&str, usize, usize, usize, usize); 6] = [
    ("deformed_tetrahedron", 196, 4, 4, 24),
    ("sphere_320", 320, 5, 6, 52),
    ("l_shape", 448, 12, 16, 126),
    ("torus_2304", 2304, 8, 8, 152),
    ("deformed_octahedron", 128, 8, 6, 53),
    ("cylinder_2736", 2736, 6, 8, 132),
];
