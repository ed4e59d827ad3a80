//! Swap one stage: a segmentation of one's own, everything else as it is.
//!
//! `cargo run --release -p suture --example own_stage`

use suture::mesh::{Topology, TriMesh, shapes};
use suture::segment::{Segment, SegmentError, Segmentation};
use suture::{ReconstructOptions, Stages, Unwatched, reconstruct};

/// Six segments by the axis that a face looks along: a cube of charts around anything star-shaped.
struct ByAxis;

impl Segment for ByAxis {
    fn segment(&self, mesh: &TriMesh, topology: &Topology) -> Result<Segmentation, SegmentError> {
        let labels: Vec<u32> = (0..mesh.faces.len())
            .map(|f| {
                let [a, b, c] = mesh.corners(f);
                let centre = a + b + c;
                let n = centre.abs();
                let axis = if n.x >= n.y && n.x >= n.z {
                    0
                } else if n.y >= n.z {
                    1
                } else {
                    2
                };
                2 * axis + u32::from(centre[axis as usize] < 0.0)
            })
            .collect();
        Segmentation::from_labels(mesh, topology, &labels)
    }
}

fn main() -> Result<(), suture::SutureError> {
    let mesh = shapes::sphere(4);
    let stages = Stages { segment: Box::new(ByAxis), ..Stages::default() };
    let result = reconstruct(&mesh, &stages, &ReconstructOptions::default(), &Unwatched)?;
    println!(
        "{} patches, {:?}, vertices {:.1e} of the diagonal from the surface (rms)",
        result.blend.surface.patches().len(),
        result.certificate.measured,
        result.deviation.mesh_to_surface.rms
    );
    Ok(())
}
