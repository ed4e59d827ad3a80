//! How much a flattening stretches, and whether it folds or overlaps.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::ParamError;
use crate::sheet::Sheet;

/// What a flattening may do to still be accepted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Largest quotient of the greatest and least area scale. Default 8.
    pub area_ratio: f64,
    /// Largest quotient of the two singular values in one triangle. Default 7.
    pub stretch: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { area_ratio: 8.0, stretch: 7.0 }
    }
}

/// How much a flattening stretches.
///
/// Triangles thinner than 10⁻⁶ of their longest edge are measured as if they had that height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distortion {
    /// Number of triangles whose parameter area is not positive.
    pub flips: usize,
    /// Greatest over least quotient of parameter area and area in space; infinite with flips.
    pub area_ratio: f64,
    /// Largest quotient s₁ / s₂ of the singular values of a triangle's map; infinite with flips.
    pub stretch: f64,
    /// The triangle with the largest [`stretch`](Self::stretch), or with flips the one whose parameter area relative to its area
    /// in space is most negative.
    pub worst_face: usize,
    /// Symmetric Dirichlet energy per area after the best uniform scaling, 4 for an isometry; infinite with flips.
    pub energy: f64,
    /// Number of pairs of boundary edges that cross in the plane although they are far apart in space: the map is two-valued
    /// there. Copies of one mesh face that land on each other do not count.
    pub overlaps: usize,
    /// Whether there are no flips and no overlaps and both quotients keep the limits.
    pub accepted: bool,
}

impl Distortion {
    /// Measures the flattening `uv` of `faces` over `positions`.
    ///
    /// # Errors
    /// [`ParamError::Length`], [`ParamError::NotFinite`], [`ParamError::NotDisc`], [`ParamError::VertexIndex`],
    /// [`ParamError::Collapsed`] when all positions coincide.
    pub fn measure(
        positions: &[DVec3],
        faces: &[[u32; 3]],
        uv: &[DVec2],
        limits: &Limits,
    ) -> Result<Self, ParamError> {
        Self::on(&Sheet::new(positions, faces)?, uv, limits)
    }

    /// The same, of a disc that was laid flat already.
    pub(crate) fn on(sheet: &Sheet<'_>, uv: &[DVec2], limits: &Limits) -> Result<Self, ParamError> {
        check_uv(uv, sheet.x.len())?;
        let mut new = Self {
            flips: 0,
            area_ratio: 1.0,
            stretch: 1.0,
            worst_face: 0,
            energy: 4.0,
            overlaps: overlaps(&sheet.x, uv, &sheet.boundary),
            accepted: false,
        };
        let (mut least, mut greatest, mut worst, mut folded) = (f64::INFINITY, 0f64, 0f64, 0f64);
        let (mut p, mut q, mut total) = (0.0, 0.0, 0.0);
        for (f, (face, flat)) in sheet.faces.iter().zip(&sheet.flats).enumerate() {
            let j = flat.jacobian(face.map(|v| uv[v as usize] / sheet.scale));
            let (det, square) = (j[0].perp_dot(j[1]), j[0].length_squared() + j[1].length_squared());
            if det > 0.0 {
                least = least.min(det);
                greatest = greatest.max(det);
                let stretch = stretch(j, det);
                if stretch > worst {
                    worst = stretch;
                    if new.flips == 0 {
                        new.worst_face = f;
                    }
                }
                p += flat.area * square;
                q += flat.area * square / (det * det);
            } else {
                if new.flips == 0 || det < folded {
                    (folded, new.worst_face) = (det, f);
                }
                new.flips += 1;
            }
            total += flat.area;
        }
        if new.flips == 0 {
            new.area_ratio = greatest / least;
            new.stretch = worst;
            new.energy = 2.0 * p.sqrt() * q.sqrt() / total;
        } else {
            (new.area_ratio, new.stretch, new.energy) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        }
        new.accepted = new.flips == 0
            && new.overlaps == 0
            && new.area_ratio <= limits.area_ratio
            && new.stretch <= limits.stretch;
        Ok(new)
    }
}

/// Whether there is one finite parameter per vertex.
pub(crate) fn check_uv(uv: &[DVec2], vertices: usize) -> Result<(), ParamError> {
    if uv.len() != vertices {
        return Err(ParamError::Length { what: "parameters", given: uv.len(), needed: vertices });
    }
    match uv.iter().position(|p| !p.is_finite()) {
        Some(vertex) => Err(ParamError::NotFinite { vertex, value: uv[vertex].extend(0.0) }),
        None => Ok(()),
    }
}

/// s₁ / s₂ of a Jacobian with det > 0.
fn stretch(j: [DVec2; 2], det: f64) -> f64 {
    // s₁ = |conformal part| + |anticonformal part|; s₁² / det is exact to rounding near 1, where a formula in
    // s₁² + s₂² has only half of the digits.
    let conformal = (j[0].x + j[1].y).hypot(j[1].x - j[0].y);
    let s1 = 0.5 * (conformal + (j[0].x - j[1].y).hypot(j[1].x + j[0].y));
    s1 * s1 / det
}

/// Pairs of boundary edges that cross in the plane but are far apart in space (segmentation: farther than 2.5 median boundary
/// edges and 1.5 times their own lengths between their midpoints).
fn overlaps(x: &[DVec3], uv: &[DVec2], boundary: &[u32]) -> usize {
    struct Edge {
        ends: [u32; 2],
        lo: DVec2,
        hi: DVec2,
        middle: DVec3,
        length: f64,
    }
    let n = boundary.len();
    let mut edges: Vec<Edge> = (0..n)
        .map(|i| {
            let ends = [boundary[i], boundary[(i + 1) % n]];
            let [a, b] = ends.map(|v| uv[v as usize]);
            let [p, q] = ends.map(|v| x[v as usize]);
            Edge { ends, lo: a.min(b), hi: a.max(b), middle: 0.5 * (p + q), length: p.distance(q) }
        })
        .collect();
    let mut lengths: Vec<f64> = edges.iter().map(|e| e.length).collect();
    let (_, &mut median, _) = lengths.select_nth_unstable_by(n / 2, f64::total_cmp);
    edges.sort_by(|a, b| a.lo.x.total_cmp(&b.lo.x));
    let side = |a: u32, b: u32, c: u32| {
        let [a, b, c] = [a, b, c].map(|v| uv[v as usize]);
        (b - a).perp_dot(c - a)
    };
    let mut count = 0;
    for (i, e) in edges.iter().enumerate() {
        for o in edges[i + 1..].iter().take_while(|o| o.lo.x <= e.hi.x) {
            if o.lo.y > e.hi.y || e.lo.y > o.hi.y || e.ends.iter().any(|v| o.ends.contains(v)) {
                continue;
            }
            let ([a, b], [c, d]) = (e.ends, o.ends);
            let crossing = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            let far = 2.5 * median + 1.5 * (e.length + o.length);
            count += usize::from(crossing && e.middle.distance(o.middle) > far);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    fn square() -> Vec<DVec3> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec()
    }

    #[track_caller]
    fn measure(map: impl Fn(DVec3) -> DVec2) -> Distortion {
        let x = square();
        let uv: Vec<_> = x.iter().map(|&p| map(p)).collect();
        Distortion::measure(&x, &SQUARE, &uv, &Limits::default()).unwrap()
    }

    #[test]
    fn an_affine_map_has_the_quotient_of_its_singular_values() {
        // Singular values 6 and 2, whatever the rotations.
        let d = measure(|p| DVec2::from_angle(0.3).rotate(DVec2::new(6.0 * p.x, 2.0 * p.y)));
        assert!((d.stretch - 3.0).abs() < 1e-13 && (d.area_ratio - 1.0).abs() < 1e-13);
        // s₁ = √3, s₂ = 1/√3 after scaling: 2 (3 + 1/3).
        assert!((d.energy - 20.0 / 3.0).abs() < 1e-12);
        assert!(d.accepted && d.flips == 0 && d.overlaps == 0);
        assert!(!measure(|p| DVec2::new(7.1 * p.x, p.y)).accepted);
    }

    #[test]
    fn a_mirror_image_flips_everything() {
        let d = measure(|p| DVec2::new(-p.x, p.y));
        assert_eq!((d.flips, d.accepted), (2, false));
        assert!(d.stretch.is_infinite());
        assert_eq!(measure(|_| DVec2::ZERO).flips, 2);
    }

    #[test]
    fn a_strip_that_runs_over_itself_overlaps() {
        // A spiral of one and a quarter turns, rising in space.
        let n = 60;
        let (mut x, mut uv, mut faces) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..=n {
            let angle = 2.5 * std::f64::consts::PI * i as f64 / n as f64;
            for r in [1.0, 1.3] {
                uv.push(DVec2::from_angle(angle) * (r + 0.02 * angle));
                x.push(uv[uv.len() - 1].extend(2.0 * angle));
            }
            if i < n {
                let a = 2 * i as u32;
                faces.extend([[a, a + 1, a + 3], [a, a + 3, a + 2]]);
            }
        }
        let d = Distortion::measure(&x, &faces, &uv, &Limits::default()).unwrap();
        assert!(d.flips == 0 && d.overlaps > 0, "{d:?}");
        // The same strip lying in its own plane really touches itself there: harmless.
        let flat: Vec<_> = uv.iter().map(|p| p.extend(0.0)).collect();
        assert_eq!(Distortion::measure(&flat, &faces, &uv, &Limits::default()).unwrap().overlaps, 0);
    }

    #[test]
    fn bad_parameters_are_named() {
        let x = square();
        let mut uv = vec![DVec2::ZERO; 4];
        uv[2].y = f64::NAN;
        let limits = Limits::default();
        let error = Distortion::measure(&x, &SQUARE, &uv, &limits).unwrap_err();
        assert!(matches!(error, ParamError::NotFinite { vertex: 2, .. }));
        assert!(matches!(
            Distortion::measure(&x, &SQUARE, &uv[..3], &limits),
            Err(ParamError::Length { given: 3, needed: 4, .. })
        ));
    }
}
