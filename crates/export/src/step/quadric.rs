//! Patches that lie on planes and spheres.

use glam::{DVec2, DVec3};
use suture_surface::{Domain, Patch};

use super::brep::Geometry;

/// How far points may be from the plane or sphere, relative to the size of the patch.
const CLOSE: f64 = 1e-9;

/// How far normals may be from those of the plane or sphere, in radians.
const PARALLEL: f64 = 1e-7;

/// The plane or the sphere that the patch lies on, and whether its normals are against those of the patch; `None` when the patch bends
/// otherwise, or is so large a part of its sphere that no frame keeps poles and seam away from it.
///
/// The frame of a sphere has the patch at its equator, on the side away from the seam: no patch has a pole or a seam in it.
pub(crate) fn recognise(patch: &dyn Patch, domain: &Domain) -> Option<(Geometry, bool)> {
    let places = [0.0, 0.15, 0.38, 0.5, 0.71, 0.92];
    let border: Vec<DVec2> = (0..domain.edge_count())
        .filter_map(|e| domain.edge(e))
        .flat_map(|curve| places.map(|t| curve.point(t)))
        .collect();
    let middle = border.iter().sum::<DVec2>() / border.len() as f64;
    let inside = border.iter().flat_map(|&b| [0.2, 0.6].map(|x| b.lerp(middle, x)));
    let sites: Vec<DVec2> = border.iter().copied().chain(inside).collect();
    let points: Vec<DVec3> = sites.iter().map(|&at| patch.jet(at).p).collect();
    // Patches may be singular at their corners, whose normals say nothing.
    let normals: Vec<Option<DVec3>> = sites.iter().map(|&at| patch.normal(at)).collect();
    let centre = points.iter().sum::<DVec3>() / points.len() as f64;
    let size = points.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let known: Vec<(DVec3, DVec3)> =
        points.iter().zip(&normals).filter_map(|(&p, &n)| n.map(|n| (p, n))).collect();
    let normal = known.iter().map(|x| x.1).sum::<DVec3>().try_normalize()?;
    let p0 = known.iter().map(|x| x.0).sum::<DVec3>() / known.len() as f64;
    let n0 = known.iter().map(|x| x.1).sum::<DVec3>() / known.len() as f64;

    let parallel = known.iter().all(|(_, n)| n.cross(normal).length() <= PARALLEL);
    if parallel && points.iter().all(|p| (p - centre).dot(normal).abs() <= CLOSE * size) {
        let frame = [centre, normal, normal.any_orthonormal_vector()];
        return Some((Geometry::Plane { frame }, false));
    }
    // The points are c + r n for one c and one r, negative where the normals point inwards.
    let spread: f64 = known.iter().map(|(_, n)| (n - n0).length_squared()).sum();
    let radius = known.iter().map(|(p, n)| (p - p0).dot(n - n0)).sum::<f64>() / spread;
    let centre = p0 - n0 * radius;
    let r = radius.abs();
    let on = points.iter().all(|p| (p.distance(centre) - r).abs() <= CLOSE * size);
    let along = known.iter().all(|(p, n)| ((p - centre) / radius).cross(*n).length() <= PARALLEL);
    // Everything within 60 degrees of the middle of the patch.
    let towards = (p0 - centre).try_normalize()?;
    let narrow = points.iter().all(|p| (p - centre).dot(towards) > 0.5 * r);
    if !(r.is_finite() && on && along && narrow) {
        return None;
    }
    let frame = [centre, towards.any_orthonormal_vector(), -towards];
    Some((Geometry::Sphere { frame, radius: r }, radius < 0.0))
}
