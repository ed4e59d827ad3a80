//! What all steps read of the mesh: lengths, normals, creases and the dual metric, scaled to diagonal 1.

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

use super::diffusion::Diffusion;
use crate::SegmentError;

/// Lengths of the dual metric are integers in units of 2⁻³⁰ diagonals: sums are exact, so ties are true ties.
pub(super) const UNIT: f64 = (1u64 << 30) as f64;

/// The scaled mesh and its dual metric. Per-half-edge values agree on both sides of an edge.
pub(super) struct Shape<'a> {
    pub(super) mesh: &'a TriMesh,
    pub(super) topology: &'a Topology,
    /// Vertex positions, scaled.
    pub(super) positions: Vec<DVec3>,
    /// Face centroids.
    pub(super) centroids: Vec<DVec3>,
    /// Face areas, not below 1e-12 of their mean.
    pub(super) areas: Vec<f64>,
    /// Smoothed unit normals of the faces.
    pub(super) normals: Vec<DVec3>,
    /// Edge length, per half-edge.
    pub(super) lengths: Vec<f64>,
    /// Crease strength in [0, 1], per half-edge.
    pub(super) creases: Vec<f64>,
    /// Whether a vertex lies on a crease.
    pub(super) creased: Vec<bool>,
    /// Distance of the centroids over the middle of the edge, per half-edge.
    pub(super) spans: Vec<f64>,
    /// The dual metric, per half-edge, in [`UNIT`]s.
    pub(super) weights: Vec<u64>,
    /// Median edge length.
    pub(super) median_edge: f64,
}

impl<'a> Shape<'a> {
    pub(super) fn new(mesh: &'a TriMesh, topology: &'a Topology) -> Result<Self, SegmentError> {
        let positions = scaled(mesh)?;
        let faces = mesh.faces.len();
        let point = |f: usize, k: usize| positions[mesh.faces[f][k] as usize];
        let centroids: Vec<DVec3> =
            (0..faces).map(|f| (point(f, 0) + point(f, 1) + point(f, 2)) / 3.0).collect();
        let vectors: Vec<DVec3> =
            (0..faces).map(|f| 0.5 * (point(f, 1) - point(f, 0)).cross(point(f, 2) - point(f, 0))).collect();
        let mean = vectors.iter().map(|v| v.length()).sum::<f64>() / faces as f64;
        let areas: Vec<f64> =
            vectors.iter().map(|v| v.length().max(1e-12 * mean).max(f64::MIN_POSITIVE)).collect();
        let half_edges = topology.half_edge_count();
        let (mut lengths, mut creases, mut spans) =
            (vec![0.0; half_edges], vec![0.0; half_edges], vec![0.0; half_edges]);
        for h in 0..half_edges as u32 {
            // Mirrored from the lower side, so that both sides agree to the bit.
            let o = topology.opposite(h).unwrap_or(h);
            if o < h {
                lengths[h as usize] = lengths[o as usize];
                creases[h as usize] = creases[o as usize];
                spans[h as usize] = spans[o as usize];
                continue;
            }
            let [a, b] = [topology.tail(h), topology.head(h)].map(|v| positions[v as usize]);
            let (f, g) = (h as usize / 3, o as usize / 3);
            let middle = 0.5 * (a + b);
            lengths[h as usize] = a.distance(b);
            spans[h as usize] = centroids[f].distance(middle) + middle.distance(centroids[g]);
            let (n, m) = (vectors[f].normalize_or_zero(), vectors[g].normalize_or_zero());
            let angle = n.cross(m).length().atan2(n.dot(m));
            let s = ((angle.to_degrees() - 30.0) / 25.0).clamp(0.0, 1.0);
            creases[h as usize] = s * s * (3.0 - 2.0 * s);
        }
        let mut creased = vec![false; positions.len()];
        for h in (0..half_edges as u32).filter(|&h| creases[h as usize] > 0.5) {
            [topology.tail(h), topology.head(h)].into_iter().for_each(|v| creased[v as usize] = true);
        }
        let conductances: Vec<f64> = (0..half_edges).map(|h| conductance(lengths[h], spans[h])).collect();
        let diffusion = Diffusion::new(topology, &areas, &conductances, 0.008 * 0.008)?;
        let raw: Vec<DVec3> = vectors.iter().map(|v| v.normalize_or_zero()).collect();
        let smooth = [0, 1, 2].map(|k| diffusion.smooth(raw.iter().map(|n| n[k])));
        let normals: Vec<DVec3> = (0..faces)
            .map(|f| DVec3::new(smooth[0][f], smooth[1][f], smooth[2][f]).try_normalize().unwrap_or(raw[f]))
            .collect();
        let weights = (0..half_edges as u32)
            .map(|h| {
                let o = topology.opposite(h).unwrap_or(h);
                let (f, g) = (h.min(o) as usize / 3, h.max(o) as usize / 3);
                let h = h as usize;
                let w = spans[h] * (1.0 + 4.0 * creases[h]) + 0.06 * normals[f].distance(normals[g]);
                ((w * UNIT).round() as u64).clamp(1, 1 << 34)
            })
            .collect();
        let mut sorted = lengths.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let median_edge = sorted[half_edges / 2];
        Ok(Self {
            mesh,
            topology,
            positions,
            centroids,
            areas,
            normals,
            lengths,
            creases,
            creased,
            spans,
            weights,
            median_edge,
        })
    }
}

/// See [`Shape::modesty`].
const MODEST: f64 = 1.0 / 3.0;

impl Shape<'_> {
    /// Half the length of the creases between a face and its neighbours that are inside.
    pub(super) fn crease_inside(&self, face: usize, inside: impl Fn(usize) -> bool) -> f64 {
        let creased = (3 * face..3 * face + 3).filter(|&h| self.creases[h] > 0.0);
        let within = |h: &usize| self.topology.opposite(*h as u32).is_some_and(|o| inside(o as usize / 3));
        creased.filter(within).map(|h| 0.5 * self.lengths[h] * self.creases[h]).sum()
    }

    /// Width that blends along an arc with these ends should have, as a share of what is wanted elsewhere. Between corners on creases they
    /// have to be narrow anyway, and a longer arc would leave the creases: the sides of a bolt hole would grow into the plane.
    pub(super) fn modesty(&self, ends: [u32; 2]) -> f64 {
        if ends.iter().all(|&v| self.creased[v as usize]) { MODEST } else { 1.0 }
    }
}

/// Conductance of an edge in the dual Laplacian.
pub(super) fn conductance(length: f64, span: f64) -> f64 {
    if length < 50.0 * span { length / span } else { 50.0 }
}

/// The vertices moved to the box corner and scaled to diagonal 1; unused ones to zero.
fn scaled(mesh: &TriMesh) -> Result<Vec<DVec3>, SegmentError> {
    let bad = || SegmentError::NotFinite { diagonal: mesh.diagonal() };
    let [low, high] = mesh.bounding_box().ok_or_else(bad)?;
    // In two steps, so that squares neither overflow nor vanish.
    let extent = (high - low).max_element();
    if !(extent > 0.0 && extent.is_finite()) {
        return Err(bad());
    }
    let diagonal = ((high - low) / extent).length();
    let mut positions = vec![DVec3::ZERO; mesh.positions.len()];
    for &v in mesh.faces.iter().flatten() {
        let p = (mesh.positions[v as usize] - low) / extent / diagonal;
        if !p.is_finite() {
            return Err(bad());
        }
        positions[v as usize] = p;
    }
    Ok(positions)
}
