//! The triangles of a surface, patch by patch, with exact normals and curvatures at their corners.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::Jet2;
use suture_surface::Surface;
use suture_tessellate::Tessellation;

/// Vertices and triangles sorted by patch: vertices on seams once per patch, since normals and curvatures may jump there.
pub(crate) struct Sorted {
    /// Number of vertices of every patch.
    pub(crate) vertices: Vec<u32>,
    /// Number of triangles of every patch.
    pub(crate) triangles: Vec<u32>,
    /// Corners of the triangles, counted from the first vertex of their patch.
    pub(crate) local: Vec<u32>,
    /// The triangle of the tessellation that stands at each place.
    pub(crate) order: Vec<u32>,
    /// The vertex of the tessellation behind each vertex.
    pub(crate) vertex: Vec<u32>,
    pub(crate) normal: Vec<DVec3>,
    /// Principal curvatures, the larger first; positive where the surface bulges towards the normal.
    pub(crate) curvature: Vec<[f64; 2]>,
    /// Parameters as shares of the box around the patch's own.
    pub(crate) parameter: Vec<DVec2>,
    /// A third of the area of the triangles around each vertex.
    pub(crate) area: Vec<f64>,
}

struct Part {
    local: Vec<u32>,
    vertex: Vec<u32>,
    normal: Vec<DVec3>,
    curvature: Vec<[f64; 2]>,
    parameter: Vec<DVec2>,
    area: Vec<f64>,
}

impl Sorted {
    /// Sorts a tessellation of `surface`, whose indices have been checked.
    pub(crate) fn new(surface: &Surface, tessellation: &Tessellation) -> Self {
        let patches = surface.patches().len();
        let mut lists = vec![Vec::new(); patches];
        for (t, patch) in tessellation.triangle_patch.iter().enumerate() {
            lists[patch.0 as usize].push(t as u32);
        }
        let parts: Vec<Part> = lists
            .par_iter()
            .enumerate()
            .map(|(patch, list)| part(surface, tessellation, patch, list))
            .collect();
        let all = |f: fn(&Part) -> usize| parts.iter().map(f).map(|n| n as u32).collect();
        Self {
            vertices: all(|p| p.vertex.len()),
            triangles: all(|p| p.local.len() / 3),
            local: parts.iter().flat_map(|p| p.local.iter().copied()).collect(),
            order: lists.concat(),
            vertex: parts.iter().flat_map(|p| p.vertex.iter().copied()).collect(),
            normal: parts.iter().flat_map(|p| p.normal.iter().copied()).collect(),
            curvature: parts.iter().flat_map(|p| p.curvature.iter().copied()).collect(),
            parameter: parts.iter().flat_map(|p| p.parameter.iter().copied()).collect(),
            area: parts.iter().flat_map(|p| p.area.iter().copied()).collect(),
        }
    }

    /// The value below which `share` of the area lies; 0 without area.
    pub(crate) fn quantile(&self, values: impl Iterator<Item = f64>, share: f64) -> f64 {
        let mut all: Vec<(f64, f64)> =
            values.zip(self.area.iter().copied()).filter(|v| v.0.is_finite()).collect();
        all.par_sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = all.iter().map(|v| v.1).sum();
        let mut sum = 0.0;
        for (value, area) in all {
            sum += area;
            if sum >= share * total {
                return value;
            }
        }
        0.0
    }
}

fn part(surface: &Surface, t: &Tessellation, patch: usize, list: &[u32]) -> Part {
    let mut known: HashMap<(u32, [u64; 2]), u32> = HashMap::with_capacity(list.len());
    let mut part = Part {
        local: Vec::with_capacity(3 * list.len()),
        vertex: vec![],
        normal: vec![],
        curvature: vec![],
        parameter: vec![],
        area: vec![],
    };
    let mut at = Vec::new();
    let mut towards = Vec::new();
    for &triangle in list {
        let triangle = triangle as usize;
        let parameters = t.corner_parameters[triangle];
        let third = t.mesh.area_vector(triangle).length() / 3.0;
        for (k, &v) in t.mesh.faces[triangle].iter().enumerate() {
            let p = parameters[k];
            // By parameter too: where a patch meets itself, a vertex has two.
            let number = *known.entry((v, p.to_array().map(f64::to_bits))).or_insert_with(|| {
                part.vertex.push(v);
                part.area.push(0.0);
                at.push(p);
                towards.push((parameters[0] + parameters[1] + parameters[2]) / 3.0);
                at.len() as u32 - 1
            });
            part.area[number as usize] += third;
            part.local.push(number);
        }
    }
    let (lo, hi) =
        at.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let extent = (hi - lo).max(DVec2::splat(f64::MIN_POSITIVE));
    for (i, &p) in at.iter().enumerate() {
        let patch = &surface.patches()[patch];
        let jet = patch.jet(p);
        // In a singular corner the values a little inside are shown.
        let inside = || patch.jet(p.lerp(towards[i], 1e-3));
        let v = part.vertex[i] as usize;
        let given = t.mesh.normals.as_ref().and_then(|n| n.get(v)).copied();
        let normal = normal(&jet).or_else(|| normal(&inside())).or(given).and_then(DVec3::try_normalize);
        part.normal.push(normal.unwrap_or(DVec3::Z));
        part.curvature.push(principal(&jet).or_else(|| principal(&inside())).unwrap_or_default());
        part.parameter.push((p - lo) / extent);
    }
    part
}

fn normal(jet: &Jet2) -> Option<DVec3> {
    jet.normal().filter(|n| n.is_finite())
}

/// Principal curvatures, the larger first, in 1 / length; `None` where the patch is singular.
///
/// # References
/// M. P. do Carmo, *Differential Geometry of Curves and Surfaces* (1976), §3.3.
fn principal(jet: &Jet2) -> Option<[f64; 2]> {
    let n = normal(jet)?;
    // In an orthonormal frame of the tangent plane, so that parameter lines that are nearly parallel cost no digits.
    let e = jet.du.try_normalize()?;
    let f = n.cross(e);
    let (ue, ve, vf) = (jet.du.dot(e), jet.dv.dot(e), jet.dv.dot(f));
    let (l, m, k) = (jet.duu.dot(n), jet.duv.dot(n), jet.dvv.dot(n));
    // Columns of the inverse of the map from parameters to the plane.
    let (a, b) = (1.0 / ue, -ve / (ue * vf));
    let c = 1.0 / vf;
    let (p, q, r) = (l * a * a, a * (l * b + m * c), l * b * b + 2.0 * m * b * c + k * c * c);
    let (middle, radius) = (-0.5 * (p + r), (0.5 * (p - r)).hypot(q));
    let pair = [middle + radius, middle - radius];
    pair.iter().all(|k| k.is_finite()).then_some(pair)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_curvatures_of_a_skew_saddle() {
        // z = x² − 3 y² at the origin, in skew parameters x = 2 u + v, y = v / 2: normal +z, so that hollow directions are negative.
        let v = DVec3::new;
        let jet = Jet2 {
            p: DVec3::ZERO,
            du: v(2.0, 0.0, 0.0),
            dv: v(1.0, 0.5, 0.0),
            duu: v(0.0, 0.0, 8.0),
            duv: v(0.0, 0.0, 4.0),
            dvv: v(7.0, 0.0, 2.0 - 6.0 * 0.25),
        };
        let [a, b] = principal(&jet).unwrap();
        assert!((a - 6.0).abs() < 1e-12 && (b + 2.0).abs() < 1e-12, "{a} {b}");
        assert!(principal(&Jet2::default()).is_none());
    }
}
