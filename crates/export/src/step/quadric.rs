//! Patches that lie on planes, spheres, cylinders and cones, and curves that lie on circles.

use glam::{DVec2, DVec3};
use suture_surface::{Domain, Patch};

use super::brep::Geometry;

/// How far points may be from the plane or sphere, relative to the size of the patch.
const CLOSE: f64 = 1e-9;

/// How far normals may be from those of the plane or sphere, in radians.
const PARALLEL: f64 = 1e-7;

/// The plane, sphere, cylinder or cone that the patch lies on, and whether its normals are against those of the patch; `None` when the patch
/// bends otherwise, or is so large a part of it that no frame keeps poles and seam away from it.
///
/// The frame of a sphere has the patch at its equator, and all have it on the side away from the seam: no patch has a pole or a seam in it.
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

    let parallel = known.iter().all(|(_, n)| n.cross(normal).length() <= PARALLEL);
    if parallel && points.iter().all(|p| (p - centre).dot(normal).abs() <= CLOSE * size) {
        let frame = [centre, normal, normal.any_orthonormal_vector()];
        return Some((Geometry::Plane { frame }, false));
    }
    round(&known, &points, size).or_else(|| straight(&known, &points, size))
}

/// The sphere: its points are c + r n for one c and one r, negative where the normals point inwards.
fn round(known: &[(DVec3, DVec3)], points: &[DVec3], size: f64) -> Option<(Geometry, bool)> {
    let (p0, n0) = means(known);
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

/// The cylinder or cone: all normals have one angle with an axis.
fn straight(known: &[(DVec3, DVec3)], points: &[DVec3], size: f64) -> Option<(Geometry, bool)> {
    // Differences of such normals are perpendicular to the axis.
    let (p0, n0) = means(known);
    let far = |from: DVec3| {
        let by = |x: &&(DVec3, DVec3), y: &&(DVec3, DVec3)| {
            x.1.distance_squared(from).total_cmp(&y.1.distance_squared(from))
        };
        known.iter().max_by(by).map(|x| x.1)
    };
    let first = far(n0)?;
    let across = far(first)? - first;
    let differences = known.iter().map(|(_, n)| (n - first).cross(across));
    let axis = differences.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    let mut axis = axis.try_normalize()?;
    let slope = known.iter().map(|(_, n)| n.dot(axis)).sum::<f64>() / known.len() as f64;
    if known.iter().any(|(_, n)| (n.dot(axis) - slope).abs() > PARALLEL) {
        return None;
    }
    // Points in the plane across the axis: c + ρ m, with m the normal's direction there and ρ linear along the axis.
    let flat = |x: DVec3| x - axis * x.dot(axis);
    let scale = (1.0 - slope * slope).sqrt();
    // The radius at p0, from ρ = radius − (slope / scale) · height, seen along the normals.
    let tangent = slope / scale;
    let reduced: Vec<(DVec3, DVec3)> = known
        .iter()
        .map(|(p, n)| {
            let m = flat(*n) / scale;
            (flat(p - p0) + m * (tangent * (p - p0).dot(axis)), m)
        })
        .collect();
    let (q0, m0) = means(&reduced);
    let spread: f64 = reduced.iter().map(|(_, m)| (m - m0).length_squared()).sum();
    let radius = reduced.iter().map(|(q, m)| (q - q0).dot(m - m0)).sum::<f64>() / spread;
    let centre = p0 + q0 - m0 * radius;
    // Outwards the normals of a cone lean against the direction in which it widens.
    let (outwards, r) = (radius.signum(), radius.abs());
    let lean = -tangent * outwards;
    let at = |p: DVec3| (p - centre).dot(axis);
    let on = points.iter().all(|&p| {
        let wide = r + lean * at(p);
        wide > 0.0 && (flat(p - centre).length() - wide).abs() <= CLOSE * size
    });
    let along = known.iter().all(|(p, n)| {
        let m = flat(p - centre).normalize_or_zero() * outwards;
        (m * scale + axis * slope).distance(*n) <= PARALLEL
    });
    let towards = flat(p0 - centre).try_normalize()?;
    let narrow = points.iter().all(|p| flat(p - centre).normalize_or_zero().dot(towards) > 0.0);
    if !(r.is_finite() && r > CLOSE * size && on && along && narrow) {
        return None;
    }
    let mut lean = lean;
    if lean < 0.0 {
        (axis, lean) = (-axis, -lean);
    }
    let frame = [centre, axis, -towards];
    let geometry = if lean <= PARALLEL {
        Geometry::Cylinder { frame, radius: r }
    } else {
        Geometry::Cone { frame, radius: r, angle: lean.atan() }
    };
    Some((geometry, radius < 0.0))
}

fn means(known: &[(DVec3, DVec3)]) -> (DVec3, DVec3) {
    let sum = known.iter().fold((DVec3::ZERO, DVec3::ZERO), |s, x| (s.0 + x.0, s.1 + x.1));
    (sum.0 / known.len() as f64, sum.1 / known.len() as f64)
}

/// The circle that points along a curve lie on, its axis such that they go around it counter-clockwise: frame and radius.
pub(crate) fn circle(points: &[DVec3]) -> Option<([DVec3; 3], f64)> {
    let (a, b, c) = (*points.first()?, points[points.len() / 2], *points.last()?);
    let (u, v) = (b - a, c - a);
    let w = u.cross(v);
    let centre =
        a + (w.cross(u) * v.length_squared() + v.cross(w) * u.length_squared()) / (2.0 * w.length_squared());
    let (axis, radius) = (w.try_normalize()?, a.distance(centre));
    let size = u.length() + v.length();
    // A nearly straight one has its centre too far away to be known.
    let good = radius < 1e3 * size
        && points.iter().all(|&p| {
            (p.distance(centre) - radius).abs() <= CLOSE * size
                && (p - centre).dot(axis).abs() <= CLOSE * size
        })
        && points.windows(2).all(|p| (p[0] - centre).cross(p[1] - centre).dot(axis) > 0.0);
    good.then_some(([centre, axis, (a - centre) / radius], radius))
}

#[cfg(test)]
mod tests {
    use suture_surface::{Jet2, PatchKind, Record, SplinePool};

    use super::*;

    /// `(ρ cos u, ρ sin u, v)`, ρ = radius + slope v, in another frame; `turned` exchanges the parameters.
    #[derive(Clone, Debug)]
    struct Round {
        radius: f64,
        slope: f64,
        turned: bool,
    }

    impl Patch for Round {
        fn domain(&self) -> Domain {
            Domain::Polygon(vec![DVec2::new(0.2, -0.3), DVec2::new(0.9, 0.1), DVec2::new(0.4, 0.8)])
        }

        fn jet(&self, at: DVec2) -> Jet2 {
            let (u, v) = if self.turned { (at.y, at.x) } else { (at.x, at.y) };
            let (s, c) = u.sin_cos();
            let r = self.radius + self.slope * v;
            let x = |p: DVec3| glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7) * p;
            let (du, dv) =
                (x(DVec3::new(-r * s, r * c, 0.0)), x(DVec3::new(self.slope * c, self.slope * s, 1.0)));
            let (du, dv) = if self.turned { (dv, du) } else { (du, dv) };
            Jet2 { p: x(DVec3::new(r * c, r * s, v)) + DVec3::new(5.0, -2.0, 1.0), du, dv, ..Jet2::default() }
        }

        fn kind(&self) -> PatchKind {
            PatchKind::Face
        }

        fn record(&self, _: &mut SplinePool) -> Record {
            Record { kind: "test.round".into(), data: serde_json::Value::Null }
        }
    }

    #[test]
    fn cylinders_and_cones_are_recognised_from_inside_and_outside() {
        for slope in [0.0, 0.4, -0.7] {
            for turned in [false, true] {
                let patch = Round { radius: 2.0, slope, turned };
                let (found, against) = recognise(&patch, &patch.domain()).unwrap();
                assert_eq!(against, turned, "{slope}");
                match found {
                    Geometry::Cylinder { radius, .. } => {
                        assert!(slope == 0.0 && (radius - 2.0).abs() < 1e-12, "{radius}");
                    }
                    Geometry::Cone { angle, frame: [c, a, _], radius } => {
                        assert!((angle.tan() - f64::abs(slope)).abs() < 1e-9, "{angle} {slope}");
                        // The radius is that of the cone at the origin of the frame, growing along the axis.
                        let p = patch.jet(DVec2::new(0.5, 0.2)).p - c;
                        let height = p.dot(a);
                        let wide = (p - a * height).length();
                        assert!((wide - radius - height * angle.tan()).abs() < 1e-9);
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    #[test]
    fn circles_are_recognised_with_their_direction() {
        let at = |t: f64| DVec3::new(1.0 + 2.0 * t.cos(), 3.0, 2.0 * t.sin());
        let points: Vec<DVec3> = (0..9).map(|i| at(0.1 * f64::from(i))).collect();
        let ([centre, axis, start], radius) = circle(&points).unwrap();
        assert!(centre.distance(DVec3::new(1.0, 3.0, 0.0)) < 1e-12 && (radius - 2.0).abs() < 1e-12);
        assert!(axis.distance(-DVec3::Y) < 1e-12 && start.distance(DVec3::X) < 1e-12);
        let bent: Vec<DVec3> = points.iter().map(|p| *p + DVec3::Y * p.x * p.x * 1e-6).collect();
        assert!(circle(&bent).is_none());
        let straight: Vec<DVec3> = (0..9).map(|i| DVec3::X * f64::from(i)).collect();
        assert!(circle(&straight).is_none());
    }
}
