//! The edges of a tessellation that lie on seams and boundaries of patches, and the seam that each belongs to.

use glam::DVec2;
use rayon::prelude::*;
use suture_surface::{Domain, Surface};
use suture_tessellate::Tessellation;

/// Points at which boundary edges of a domain are compared with edges of triangles.
const POINTS: usize = 33;

/// Edges on seams and boundaries.
pub(crate) struct SeamEdges {
    /// Triangle of the tessellation and number of its first corner: the edge runs from there to the next corner.
    pub(crate) edges: Vec<(u32, u8)>,
    /// Seam of every edge; the number of seams for those of no seam.
    pub(crate) seam: Vec<u32>,
}

/// A boundary edge of a patch that a seam names.
struct Side {
    seam: u32,
    edge: usize,
    other: u32,
}

/// Finds the edges: where the triangles on both sides belong to different patches, or to places of one patch that are far apart.
pub(crate) fn seam_edges(surface: &Surface, t: &Tessellation) -> SeamEdges {
    let mut sides: Vec<Vec<Side>> = surface.patches().iter().map(|_| Vec::new()).collect();
    for (number, seam) in surface.seams().iter().enumerate() {
        for (own, other) in [(seam.a, seam.b), (seam.b, seam.a)] {
            let side = Side { seam: number as u32, edge: own.edge as usize, other: other.patch.0 };
            sides[own.patch.0 as usize].push(side);
        }
    }
    let faces = &t.mesh.faces;
    let mut all: Vec<(u64, u32, u8)> = faces
        .par_iter()
        .enumerate()
        .flat_map_iter(|(f, face)| {
            (0..3).map(move |k| {
                let (a, b) = (face[k].min(face[(k + 1) % 3]), face[k].max(face[(k + 1) % 3]));
                (u64::from(a) << 32 | u64::from(b), f as u32, k as u8)
            })
        })
        .collect();
    all.par_sort_unstable();
    let mut found = SeamEdges { edges: vec![], seam: vec![] };
    let none = surface.seams().len() as u32;
    for group in all.chunk_by(|a, b| a.0 == b.0) {
        let (_, f, k) = group[0];
        let patch = t.triangle_patch[f as usize].0;
        let seam = match group.get(1) {
            None => none,
            Some(&(_, g, l)) => {
                let other = t.triangle_patch[g as usize].0;
                if patch == other && same_place(t, (f, k), (g, l)) {
                    continue;
                }
                which(surface, &sides[patch as usize], patch, other, ends(t, f, k)).unwrap_or(none)
            }
        };
        found.edges.push((f, k));
        found.seam.push(seam);
    }
    found
}

/// Parameters of both ends of an edge of a triangle.
fn ends(t: &Tessellation, triangle: u32, k: u8) -> [DVec2; 2] {
    let corners = t.corner_parameters[triangle as usize];
    [corners[k as usize], corners[(k as usize + 1) % 3]]
}

/// Whether two triangles of one patch have the same parameters at their common edge.
fn same_place(t: &Tessellation, (f, k): (u32, u8), (g, l): (u32, u8)) -> bool {
    let ([a, b], [c, d]) = (ends(t, f, k), ends(t, g, l));
    let turned = t.mesh.faces[f as usize][k as usize] != t.mesh.faces[g as usize][l as usize];
    let (c, d) = if turned { (d, c) } else { (c, d) };
    let reach = 1e-6 * (a.distance(b) + c.distance(d));
    a.distance(c) <= reach && b.distance(d) <= reach
}

fn which(surface: &Surface, sides: &[Side], patch: u32, other: u32, ends: [DVec2; 2]) -> Option<u32> {
    let mut candidates = sides.iter().filter(|s| s.other == other);
    let first = candidates.next()?;
    let rest: Vec<&Side> = candidates.collect();
    if rest.is_empty() {
        return Some(first.seam);
    }
    // Two patches with several seams: the one whose curve is nearest to the edge in parameters.
    let domain = surface.patches().get(patch as usize)?.domain();
    let distance = |side: &Side| away(&domain, side.edge, ends);
    let best = std::iter::once(first).chain(rest).map(|s| (distance(s), s.seam));
    best.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, seam)| seam)
}

/// Sum of the distances of two points from a boundary edge, drawn as a polyline.
fn away(domain: &Domain, edge: usize, ends: [DVec2; 2]) -> f64 {
    let Some(curve) = domain.edge(edge) else { return f64::INFINITY };
    let points: Vec<DVec2> = (0..POINTS).map(|i| curve.point(i as f64 / (POINTS - 1) as f64)).collect();
    let to = |p: DVec2| {
        let segment = |w: &[DVec2]| {
            let d = w[1] - w[0];
            let s = ((p - w[0]).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            p.distance(w[0] + d * s)
        };
        points.windows(2).map(segment).fold(f64::INFINITY, f64::min)
    };
    ends.into_iter().map(to).sum()
}
