//! The abstract disc of a segment and its collar.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use suture_mesh::{Topology, TriMesh};

use crate::ParamError;
use crate::creases::Creases;
use crate::development::Development;
use crate::rim::boundary_loop;

/// A segment and its collar as an abstract disc over the mesh: the same mesh face may occur twice where the collar meets
/// itself or winds around a handle.
///
/// Faces of the segment come first, in ascending order of the mesh; then the collar, ring by ring. Corners keep the order of
/// the mesh face, so that barycentric coordinates carry over.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Mesh vertex of every chart vertex.
    pub vertices: Vec<u32>,
    /// Position of every chart vertex, in the units of the mesh.
    pub positions: Vec<DVec3>,
    /// Chart vertices of every chart face.
    pub faces: Vec<[u32; 3]>,
    /// Mesh face of every chart face.
    pub mesh_faces: Vec<u32>,
    /// Whether a chart face belongs to the segment; copies of segment faces in the collar do not.
    pub in_segment: Vec<bool>,
    /// Distance of every chart vertex from the segment along chart edges; 0 on the segment and its boundary.
    pub distance: Vec<f64>,
    /// Number of rings in the collar.
    pub rings: usize,
    /// Width of the collar: the least distance of a boundary vertex where the mesh goes on. `None` where it goes on nowhere
    /// (borders of the mesh and sharp edges all around).
    pub reach: Option<f64>,
}

/// How far a collar reaches and where it stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CollarOptions {
    /// Width in the units of the mesh: rings grow around boundary vertices not farther than this from the segment, measured
    /// along chart edges. Default infinite: `max_rings` decides.
    pub width: f64,
    /// Largest number of rings. Default 3: at three edges outside the segment a fit still has full accuracy.
    pub max_rings: usize,
    /// Dihedral angle in radians beyond which the collar does not cross an edge. Default 25°: one smooth function through
    /// a crease spoils the segment. Pass π to cross everything, as fillets do.
    pub sharp: f64,
    /// Extent, in the units of the mesh, from which sharp edges that hang together stop the collar; shorter creases are crossed. Default 0:
    /// every sharp edge stops it.
    pub shortest: f64,
    /// Most area of the disc, in those of the flat disc with a collar as wide. Default 3: where the surface is curved like a saddle
    /// collars grow exponentially, and at this growth their best conformal chart has an area ratio of about 100.
    pub growth: f64,
}

impl Default for CollarOptions {
    fn default() -> Self {
        Self { width: f64::INFINITY, max_rings: 3, sharp: 25f64.to_radians(), shortest: 0.0, growth: 3.0 }
    }
}

/// Cuts a segment out of the mesh, together with a collar of neighbouring faces.
///
/// Each ring completes the faces around all boundary vertices that are not yet farther than the width. Two copies of one mesh
/// face that share a chart vertex are one copy, and neighbouring faces that share a chart vertex share their edge too; closing
/// the disc under these two rules has one result whatever the order, so the collar does not depend on any numbering. A ring
/// that would close the surface, or make the disc larger than it may grow, is not taken, and the disc is the one before it.
///
/// # Errors
/// [`ParamError::Empty`], [`ParamError::FaceIndex`], [`ParamError::RepeatedFace`], [`ParamError::NotDisc`] for the segment;
/// [`ParamError::Length`] if the adjacency belongs to another mesh; [`ParamError::NotFinite`], [`ParamError::Option`],
/// [`ParamError::CollarTooLarge`]; [`ParamError::Valence`] if an interior vertex came out with a wrong number of faces.
///
/// # References
/// The closure is the folding of Stallings, *Topology of finite graphs* (1983), applied to faces.
pub fn disc_with_collar(
    mesh: &TriMesh,
    topology: &Topology,
    segment_faces: &[u32],
    options: &CollarOptions,
) -> Result<Disc, ParamError> {
    let segment = checked(mesh, topology, segment_faces, options)?;
    let mut development =
        Development::new(topology, &segment, Creases::new(mesh, topology, options.sharp, options.shortest));
    let mut disc = extract(&mut development, mesh, topology, segment.len(), 0)?;
    let around = circumference(&disc)?;
    let limit = (16 * mesh.faces.len() + 1024).min(u32::MAX as usize / 6);
    for ring in 1..=options.max_rings {
        // A boundary vertex at which nothing can be attached changes nothing, so all near ones are tried.
        let near: Vec<u32> = boundary_loop(disc.vertices.len(), &disc.faces)?
            .into_iter()
            .filter(|&v| disc.distance[v as usize] <= options.width)
            .collect();
        if !development.complete(&near, limit) {
            break;
        }
        if development.copies() > limit {
            return Err(ParamError::CollarTooLarge { faces: development.copies(), rings: ring, limit });
        }
        match extract(&mut development, mesh, topology, segment.len(), ring) {
            Ok(next) if growth(&next, segment.len(), around) > options.growth => break,
            Ok(next) => disc = next,
            // The collar closes the surface.
            Err(ParamError::NotDisc { loops: 0, .. }) => break,
            Err(ParamError::NotDisc { euler: 1, loops: 1, components: 1, defects: 0 }) => break,
            Err(other) => return Err(other),
        }
    }
    Ok(disc)
}

impl Disc {
    /// The boundary loop, counter-clockwise.
    ///
    /// # Errors
    /// [`ParamError::NotDisc`] and others if the faces were changed by hand.
    pub fn boundary(&self) -> Result<Vec<u32>, ParamError> {
        boundary_loop(self.vertices.len(), &self.faces)
    }

    /// Number of faces of the segment; they come first.
    pub fn segment_len(&self) -> usize {
        self.in_segment.iter().filter(|&&s| s).count()
    }

    /// Whether every array has the length that goes with the others and the faces form a disc.
    ///
    /// # Errors
    /// [`ParamError::Length`], [`ParamError::NotDisc`], [`ParamError::VertexIndex`], [`ParamError::NotFinite`].
    pub fn check(&self) -> Result<(), ParamError> {
        let (n, f) = (self.vertices.len(), self.faces.len());
        let lengths = [
            ("positions", self.positions.len(), n),
            ("distances", self.distance.len(), n),
            ("mesh faces", self.mesh_faces.len(), f),
            ("segment flags", self.in_segment.len(), f),
        ];
        for (what, given, needed) in lengths {
            if given != needed {
                return Err(ParamError::Length { what, given, needed });
            }
        }
        if let Some(vertex) = self.positions.iter().position(|p| !p.is_finite()) {
            return Err(ParamError::NotFinite { vertex, value: self.positions[vertex] });
        }
        self.boundary().map(drop)
    }
}

/// The segment in ascending order, if all input has a meaning.
fn checked(
    mesh: &TriMesh,
    topology: &Topology,
    segment_faces: &[u32],
    options: &CollarOptions,
) -> Result<Vec<u32>, ParamError> {
    if options.width.is_nan() || options.width < 0.0 {
        return Err(ParamError::Option { option: "width", value: options.width, limit: "≥ 0" });
    }
    if !(0.0..=std::f64::consts::PI).contains(&options.sharp) {
        return Err(ParamError::Option { option: "sharp", value: options.sharp, limit: "between 0 and π" });
    }
    for (what, given, needed) in [
        ("faces of the adjacency", topology.face_count(), mesh.faces.len()),
        ("vertices of the adjacency", topology.vertex_count(), mesh.positions.len()),
    ] {
        if given != needed {
            return Err(ParamError::Length { what, given, needed });
        }
    }
    if options.shortest.is_nan() || options.shortest < 0.0 {
        return Err(ParamError::Option { option: "shortest", value: options.shortest, limit: "≥ 0" });
    }
    if options.growth.is_nan() || options.growth < 1.0 {
        return Err(ParamError::Option { option: "growth", value: options.growth, limit: "≥ 1" });
    }
    if segment_faces.is_empty() {
        return Err(ParamError::Empty);
    }
    let mut segment = segment_faces.to_vec();
    segment.sort_unstable();
    if let Some(&face) = segment.last().filter(|&&f| f as usize >= mesh.faces.len()) {
        return Err(ParamError::FaceIndex { face, faces: mesh.faces.len() });
    }
    if let Some(w) = segment.windows(2).find(|w| w[0] == w[1]) {
        return Err(ParamError::RepeatedFace { face: w[0] });
    }
    Ok(segment)
}

/// The development as a disc, with distances, checked.
fn extract(
    development: &mut Development<'_>,
    mesh: &TriMesh,
    topology: &Topology,
    segment: usize,
    rings: usize,
) -> Result<Disc, ParamError> {
    let (vertices, faces, mesh_faces) = development.faces();
    let in_segment = (0..faces.len()).map(|f| f < segment).collect();
    let positions: Vec<DVec3> = vertices.iter().map(|&v| mesh.positions[v as usize]).collect();
    if let Some(at) = positions.iter().position(|p| !p.is_finite()) {
        return Err(ParamError::NotFinite { vertex: vertices[at] as usize, value: positions[at] });
    }
    let boundary = boundary_loop(vertices.len(), &faces)?;
    check_valence(topology, &vertices, &faces, &boundary)?;
    let distance = distances(&positions, &faces, segment);
    let open = development.open();
    let reach =
        boundary.iter().filter(|&&v| open[v as usize]).map(|&v| distance[v as usize]).reduce(f64::min);
    Ok(Disc { vertices, positions, faces, mesh_faces, in_segment, distance, rings, reach })
}

fn circumference(disc: &Disc) -> Result<f64, ParamError> {
    let rim = disc.boundary()?;
    let next = rim.iter().cycle().skip(1);
    Ok(rim
        .iter()
        .zip(next)
        .map(|(&a, &b)| disc.positions[a as usize].distance(disc.positions[b as usize]))
        .sum())
}

/// Area of a disc whose first `segment` faces are `around` in circumference, in that of the flat disc that a convex segment of the same
/// area and circumference has with a collar as wide (Steiner's formula).
fn growth(disc: &Disc, segment: usize, around: f64) -> f64 {
    let area = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| disc.positions[v as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    let (inside, collar) = disc.faces.split_at(segment);
    let [inside, collar] = [inside, collar].map(|faces| faces.iter().map(area).sum::<f64>());
    let width = disc.distance.iter().copied().fold(0.0, f64::max);
    (inside + collar) / (inside + width * (around + std::f64::consts::PI * width))
}

fn check_valence(
    topology: &Topology,
    vertices: &[u32],
    faces: &[[u32; 3]],
    boundary: &[u32],
) -> Result<(), ParamError> {
    let mut valence = vec![0usize; vertices.len()];
    for &v in faces.iter().flatten() {
        valence[v as usize] += 1;
    }
    let mut interior = vec![true; vertices.len()];
    for &v in boundary {
        interior[v as usize] = false;
    }
    for (vertex, &found) in valence.iter().enumerate() {
        let needed = topology.outgoing(vertices[vertex]).count();
        if interior[vertex] && found != needed {
            return Err(ParamError::Valence { vertex, found, needed });
        }
    }
    Ok(())
}

/// Distance of every vertex from the first `segment` faces along edges (Dijkstra).
fn distances(positions: &[DVec3], faces: &[[u32; 3]], segment: usize) -> Vec<f64> {
    use std::cmp::Reverse;
    use std::collections::BinaryHeap;
    let mut first = vec![0usize; positions.len() + 1];
    for &v in faces.iter().flatten() {
        first[v as usize + 1] += 2;
    }
    for i in 1..first.len() {
        first[i] += first[i - 1];
    }
    let mut fill = first.clone();
    let mut neighbours = vec![0u32; first[positions.len()]];
    for f in faces {
        for k in 0..3 {
            for other in [f[(k + 1) % 3], f[(k + 2) % 3]] {
                neighbours[fill[f[k] as usize]] = other;
                fill[f[k] as usize] += 1;
            }
        }
    }
    let mut distance = vec![f64::INFINITY; positions.len()];
    // Lengths are finite and not negative: their bits order like the numbers.
    let mut heap = BinaryHeap::new();
    for &v in faces[..segment].iter().flatten() {
        if distance[v as usize] != 0.0 {
            distance[v as usize] = 0.0;
            heap.push(Reverse((0u64, v)));
        }
    }
    while let Some(Reverse((bits, v))) = heap.pop() {
        let (v, d) = (v as usize, f64::from_bits(bits));
        if d > distance[v] {
            continue;
        }
        for &w in &neighbours[first[v]..first[v + 1]] {
            let through = d + positions[v].distance(positions[w as usize]);
            if through < distance[w as usize] {
                distance[w as usize] = through;
                heap.push(Reverse((through.to_bits(), w)));
            }
        }
    }
    distance
}
