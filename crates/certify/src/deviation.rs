//! Distances between a mesh and a smooth surface, both ways.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde::Serialize;
use suture_mesh::TriMesh;
use suture_surface::{PatchId, PatchKind, Surface};

use crate::foot::Feet;
use crate::nearest::Nearest;
use crate::region::Region;
use crate::samples::check_triangles;
use crate::{CertifyError, SurfaceSamples};

/// Distances between a mesh and a surface, relative to the diagonal of the mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// From the vertices that the faces of the mesh use to the smooth surface.
    pub mesh_to_surface: Stats,
    /// From points of the surface (vertices and centroids of the tessellation, evaluated on their patches) to the facets of the mesh;
    /// has the sagitta of the facets as its floor.
    pub surface_to_mesh: Stats,
    /// The same for every kind of patch that holds a foot point or a sample, kinds ascending.
    pub kinds: Vec<KindDeviation>,
    /// Distance of every vertex of the mesh to the surface; 0 for vertices that no face uses.
    pub mesh_distances: Vec<f64>,
    /// Distance of every vertex of the tessellation to the facets of the mesh; 0 for vertices that no triangle uses.
    pub vertex_distances: Vec<f64>,
    /// Distance of the centroid of every triangle of the tessellation, in parameters, to the facets of the mesh.
    pub centroid_distances: Vec<f64>,
}

/// Distances that belong to one kind of patch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct KindDeviation {
    /// The kind.
    pub kind: PatchKind,
    /// From the mesh vertices whose foot point lies on such a patch.
    pub mesh_to_surface: Stats,
    /// From the samples of such patches.
    pub surface_to_mesh: Stats,
}

/// Statistics of distances, every sample with the same weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stats {
    /// Number of samples.
    pub count: usize,
    /// Mean distance.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Largest distance.
    pub max: f64,
    /// Where the largest is; `None` without samples.
    pub worst: Option<Place>,
}

/// A pair of points, one of the mesh and one of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The point that was measured from.
    pub point: DVec3,
    /// In [`Deviation::mesh_to_surface`] the vertex of the mesh, in [`Deviation::surface_to_mesh`] the face of the mesh.
    pub element: u32,
    /// The patch.
    pub patch: PatchId,
    /// Parameters on the patch.
    pub at: DVec2,
}

impl Stats {
    /// Statistics of two disjoint sets of samples together.
    pub fn merge(&self, other: &Self) -> Self {
        let count = self.count + other.count;
        let n = count.max(1) as f64;
        let (a, b) = (self.count as f64 / n, other.count as f64 / n);
        let larger = if other.count > 0 && (self.count == 0 || other.max > self.max) { other } else { self };
        Self {
            count,
            mean: a * self.mean + b * other.mean,
            rms: (a * self.rms * self.rms + b * other.rms * other.rms).sqrt(),
            max: larger.max,
            worst: larger.worst,
        }
    }

    fn of<'a>(samples: impl Iterator<Item = &'a Sample>) -> Self {
        let mut stats = Self::default();
        let (mut sum, mut squares) = (0.0, 0.0);
        for s in samples {
            if stats.worst.is_none() || s.distance > stats.max {
                (stats.max, stats.worst) = (s.distance, Some(s.place));
            }
            stats.count += 1;
            sum += s.distance;
            squares += s.distance * s.distance;
        }
        if stats.count > 0 {
            stats.mean = sum / stats.count as f64;
            stats.rms = (squares / stats.count as f64).sqrt();
        }
        stats
    }
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    distance: f64,
    place: Place,
}

/// Measures how far `mesh` and `surface` lie apart, relative to the diagonal of the mesh.
///
/// `samples` is a tessellation of `surface`. From the mesh, it gives the nearest triangle, whose parameters start the search for the
/// foot point on the smooth surface: the fineness of the tessellation does not show in the result, as long as it is fine enough to
/// tell which part of the surface is near. Every distance is one to a point of the surface: where the search fails, that of the
/// tessellation's own point, moved onto its patch. Towards the mesh, its vertices and centroids are the samples.
///
/// Parallel over points; the result does not depend on the number of threads, and scales with the units.
///
/// # Errors
/// [`CertifyError`]: indices, lengths and coordinates that do not make a mesh or a tessellation of `surface`.
pub fn deviation(
    mesh: &TriMesh,
    surface: &Surface,
    samples: &SurfaceSamples<'_>,
) -> Result<Deviation, CertifyError> {
    check_triangles("mesh", &mesh.positions, &mesh.faces)?;
    samples.check(surface)?;
    let Some([lo, hi]) = mesh.bounding_box() else { return Err(CertifyError::NoArea { of: "mesh" }) };
    let diagonal = lo.distance(hi);
    if !(diagonal.is_finite() && diagonal > 0.0) {
        return Err(CertifyError::Diagonal { value: diagonal });
    }
    let centre = 0.5 * (lo + hi);
    let facets = Nearest::new("mesh", &mesh.positions, &mesh.faces, centre, diagonal)?;
    let chords = Nearest::new("tessellation", samples.positions, samples.triangles, centre, diagonal)?;
    let regions: Vec<Region> = surface.patches().par_iter().map(|p| Region::new(p.domain())).collect();
    let feet = Feet::new(surface, &regions);

    let used = first_use(mesh.positions.len(), &mesh.faces);
    let from_mesh: Vec<Option<Sample>> = (0..mesh.positions.len())
        .into_par_iter()
        .map(|v| {
            used[v]?;
            let point = mesh.positions[v];
            let hit = chords.find(point)?;
            let triangle = hit.triangle as usize;
            let patch = samples.triangle_patch[triangle];
            let [r, s, t] = hit.barycentric;
            let [a, b, c] = samples.corner_parameters[triangle];
            let foot = feet.find(point, patch, a * r + b * s + c * t);
            let (patch, at, distance) = match foot {
                Some(foot) => (foot.patch, foot.at, foot.distance / diagonal),
                None => (patch, a, hit.distance),
            };
            Some(Sample { distance, place: Place { point, element: v as u32, patch, at } })
        })
        .collect();

    let to_mesh = |patch: PatchId, at: DVec2| {
        let point = surface.patch(patch)?.jet(at).p;
        let hit = facets.find(point)?;
        Some(Sample { distance: hit.distance, place: Place { point, element: hit.triangle, patch, at } })
    };
    let corners = first_use(samples.positions.len(), samples.triangles);
    let vertices: Vec<Option<Sample>> = corners
        .par_iter()
        .map(|corner| {
            let (triangle, corner) = (*corner)?;
            to_mesh(samples.triangle_patch[triangle], samples.corner_parameters[triangle][corner])
        })
        .collect();
    let centroids: Vec<Option<Sample>> = (0..samples.triangles.len())
        .into_par_iter()
        .map(|t| {
            let [a, b, c] = samples.corner_parameters[t];
            to_mesh(samples.triangle_patch[t], (a + b + c) / 3.0)
        })
        .collect();

    let from_surface = || vertices.iter().chain(&centroids).flatten();
    let distances = |of: &[Option<Sample>]| of.iter().map(|s| s.map_or(0.0, |s| s.distance)).collect();
    Ok(Deviation {
        mesh_to_surface: Stats::of(from_mesh.iter().flatten()),
        surface_to_mesh: Stats::of(from_surface()),
        kinds: by_kind(surface, from_mesh.iter().flatten(), from_surface()),
        mesh_distances: distances(&from_mesh),
        vertex_distances: distances(&vertices),
        centroid_distances: distances(&centroids),
    })
}

/// The first triangle that uses every vertex, and as which of its corners.
fn first_use(vertices: usize, triangles: &[[u32; 3]]) -> Vec<Option<(usize, usize)>> {
    let mut first = vec![None; vertices];
    for (t, corners) in triangles.iter().enumerate() {
        for (c, &v) in corners.iter().enumerate() {
            first[v as usize].get_or_insert((t, c));
        }
    }
    first
}

fn by_kind<'a>(
    surface: &Surface,
    from_mesh: impl Iterator<Item = &'a Sample>,
    from_surface: impl Iterator<Item = &'a Sample>,
) -> Vec<KindDeviation> {
    let kinds: Vec<PatchKind> = surface.patches().iter().map(|p| p.kind()).collect();
    let mut groups: BTreeMap<PatchKind, [Vec<&Sample>; 2]> = BTreeMap::new();
    let both = from_mesh.map(|s| (0, s)).chain(from_surface.map(|s| (1, s)));
    for (way, sample) in both {
        if let Some(&kind) = kinds.get(sample.place.patch.0 as usize) {
            groups.entry(kind).or_default()[way].push(sample);
        }
    }
    let stats = |s: Vec<&'a Sample>| Stats::of(s.into_iter());
    groups
        .into_iter()
        .map(|(kind, [mesh, surface])| KindDeviation {
            kind,
            mesh_to_surface: stats(mesh),
            surface_to_mesh: stats(surface),
        })
        .collect()
}
