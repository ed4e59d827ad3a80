//! From a point of a patch to a colour.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::Jet2;
use suture_surface::{PatchKind, Surface};
use suture_tessellate::Tessellation;

use crate::{Shade, ViewOptions, camera::View, color};

/// The share of samples whose curvature lies within the range of the colour map.
const ROBUST: f64 = 0.95;

/// The symmetric range of the mean curvature (its largest absolute value at the middles of the triangles, the largest 5 % of the area
/// left out), in 1 / length: what [`Shade::Curvature`] maps to the ends of its colours. 0 without triangles.
pub fn curvature_range(tessellation: &Tessellation, surface: &Surface) -> f64 {
    let mesh = &tessellation.mesh;
    let mut all: Vec<(f64, f64)> = (0..mesh.faces.len())
        .into_par_iter()
        .filter_map(|f| {
            let patch = surface.patch(*tessellation.triangle_patch.get(f)?)?;
            let [a, b, c] = *tessellation.corner_parameters.get(f)?;
            let h = mean_curvature(&patch.jet((a + b + c) / 3.0)).abs();
            Some((h, mesh.area_vector(f).length())).filter(|(h, area)| h.is_finite() && area.is_finite())
        })
        .collect();
    quantile(&mut all, ROBUST)
}

/// The distance that all but the farthest 1 % of the area stay below.
pub(crate) fn deviation_range(tessellation: &Tessellation, distances: &[f64]) -> f64 {
    let mesh = &tessellation.mesh;
    let middle = |f: usize| mesh.faces[f].iter().map(|&v| distances[v as usize]).sum::<f64>() / 3.0;
    let all = (0..mesh.faces.len()).map(|f| (middle(f), mesh.area_vector(f).length()));
    let mut all: Vec<(f64, f64)> = all.filter(|(d, area)| d.is_finite() && area.is_finite()).collect();
    quantile(&mut all, 0.99)
}

/// The value below which `share` of the weight lies; 0 without values.
fn quantile(all: &mut [(f64, f64)], share: f64) -> f64 {
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = all.iter().map(|a| a.1).sum();
    let mut sum = 0.0;
    for &mut (value, weight) in all {
        sum += weight;
        if sum >= share * total {
            return value;
        }
    }
    0.0
}

/// Mean curvature, positive where the surface bulges towards `S_u × S_v`; not a number where the patch is singular.
fn mean_curvature(jet: &Jet2) -> f64 {
    let Some(n) = jet.normal() else { return f64::NAN };
    let (e, f, g) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
    let (l, m, k) = (jet.duu.dot(n), jet.duv.dot(n), jet.dvv.dot(n));
    (2.0 * f * m - e * k - g * l) / (2.0 * (e * g - f * f))
}

/// A point of the surface as a pixel sees it: enough to shade all its samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    at: DVec2,
    p: DVec3,
    du: DVec3,
    dv: DVec3,
    /// Unit normal and its partials.
    n: DVec3,
    nu: DVec3,
    nv: DVec3,
    curvature: f64,
}

impl Probe {
    /// The probe at `at`; `facet` is the normal to take where the patch is singular.
    pub(crate) fn new(jet: &Jet2, at: DVec2, facet: DVec3) -> Self {
        let curvature = mean_curvature(jet);
        let (n, nu, nv) = match jet.normal() {
            Some(n) => {
                let w = jet.du.cross(jet.dv);
                let part = |d: DVec3| (d - n * n.dot(d)) / w.length();
                let nu = part(jet.duu.cross(jet.dv) + jet.du.cross(jet.duv));
                let nv = part(jet.duv.cross(jet.dv) + jet.du.cross(jet.dvv));
                (n, nu, nv)
            }
            None => (facet, DVec3::ZERO, DVec3::ZERO),
        };
        Self { at, p: jet.p, du: jet.du, dv: jet.dv, n, nu, nv, curvature }
    }

    /// Point and unit normal at a parameter close by, to first order; `None` where that is too far for first order.
    pub(crate) fn near(&self, at: DVec2) -> Option<(DVec3, DVec3)> {
        let d = at - self.at;
        let turn = self.nu * d.x + self.nv * d.y;
        // The error is of the order of the square: a tenth of a degree or two.
        (turn.length_squared() < 0.05 * 0.05)
            .then(|| (self.p + self.du * d.x + self.dv * d.y, (self.n + turn).normalize()))
    }
}

/// How points become colours in one picture.
pub(crate) struct Shader {
    shade: Shade,
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    back: DVec3,
    bands: f64,
    range: f64,
    lit: DVec3,
}

impl Shader {
    pub(crate) fn new(options: &ViewOptions, view: &View, range: f64) -> Self {
        Self {
            shade: options.shade,
            eye: view.eye,
            right: view.right,
            up: view.up,
            back: view.back,
            bands: f64::from(options.bands),
            range,
            lit: color::linear(0xc9ccd1),
        }
    }

    /// Linear light of the point `p` with unit normal `n` of a patch of `kind`, on a triangle that shows its front or its back.
    /// `distance` is that from the input mesh.
    pub(crate) fn color(
        &self,
        probe: &Probe,
        p: DVec3,
        n: DVec3,
        front: bool,
        kind: PatchKind,
        distance: f64,
    ) -> DVec3 {
        let v = (self.eye - p).normalize_or(self.back);
        let (n, outside) = facing(n, v, front);
        match self.shade {
            Shade::Lit => self.lit * self.light(n, v) + self.gloss(n, v),
            Shade::Patches => {
                let base = color::of_kind(kind);
                // Back sides are greyer, so that an open surface shows which side is which.
                let base = if outside { base } else { base.lerp(DVec3::splat(0.25), 0.6) };
                base * self.light(n, v) + self.gloss(n, v)
            }
            Shade::Curvature => {
                let sign = if outside { 1.0 } else { -1.0 };
                // A minimal surface has no range: its rounding errors are not shown as curvature.
                let h = if self.range > 0.0 { sign * probe.curvature / self.range } else { 0.0 };
                color::diverging(h) * (0.35 + 0.65 * self.light(n, v)).min(1.0)
            }
            Shade::Deviation => {
                let x = if self.range > 0.0 { distance / self.range } else { 0.0 };
                color::sequential(x) * (0.35 + 0.65 * self.light(n, v)).min(1.0)
            }
            Shade::Reflection => {
                let r = n * (2.0 * n.dot(v)) - v;
                self.band(r.dot(self.up).clamp(-1.0, 1.0).asin(), n, v)
            }
            Shade::Isophotes => {
                let light = (self.up * 0.8 - self.right * 0.5 + self.back * 0.4).normalize();
                self.band(n.dot(light).clamp(-1.0, 1.0).acos(), n, v)
            }
        }
    }

    /// Light or dark by the angle, softly lit.
    fn band(&self, angle: f64, n: DVec3, v: DVec3) -> DVec3 {
        let bright = (angle * self.bands / std::f64::consts::PI).rem_euclid(1.0) < 0.5;
        let base = color::linear(if bright { 0xf4f6f8 } else { 0x1d2733 });
        base * (0.45 + 0.55 * self.light(n, v)).min(1.0)
    }

    /// Ambient light that is brighter from above, a headlight, and a weaker lamp at the upper left.
    fn light(&self, n: DVec3, v: DVec3) -> f64 {
        let lamp = (self.back + self.up * 0.9 - self.right * 0.7).normalize();
        0.16 + 0.10 * n.dot(self.up) + 0.42 * n.dot(v).max(0.0) + 0.40 * n.dot(lamp).max(0.0)
    }

    fn gloss(&self, n: DVec3, v: DVec3) -> DVec3 {
        let lamp = (self.back + self.up * 0.9 - self.right * 0.7).normalize();
        DVec3::splat(0.10 * n.dot((lamp + v).normalize_or_zero()).max(0.0).powi(40))
    }
}

/// The normal turned towards the eye, and whether the eye sees the side it came from.
///
/// Which side that is, the triangle knows; at a silhouette its normal may point slightly away all the same and is then bent into the
/// plane across the line of sight, or single pixels would flip.
fn facing(n: DVec3, v: DVec3, front: bool) -> (DVec3, bool) {
    let c = n.dot(v);
    let outside = if c.abs() > 0.25 { c > 0.0 } else { front };
    let n = if outside { n } else { -n };
    let c = n.dot(v);
    (if c < 0.0 { (n - v * c).normalize_or(v) } else { n }, outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(at: DVec2, r: f64) -> Jet2 {
        let ((s, c), (t, d)) = (at.x.sin_cos(), at.y.sin_cos());
        let v = |x, y, z| DVec3::new(x, y, z) * r;
        Jet2 {
            p: v(c * d, s * d, t),
            du: v(-s * d, c * d, 0.0),
            dv: v(-c * t, -s * t, d),
            duu: v(-c * d, -s * d, 0.0),
            duv: v(s * t, -c * t, 0.0),
            dvv: v(-c * d, -s * d, -t),
        }
    }

    #[test]
    fn a_sphere_bulges() {
        let h = mean_curvature(&sphere(DVec2::new(0.3, 0.7), 4.0));
        assert!((h - 0.25).abs() < 1e-15);
        assert!(mean_curvature(&Jet2::default()).is_nan());
    }

    #[test]
    fn probes_extend_normals_to_first_order() {
        let at = DVec2::new(0.3, 0.7);
        let probe = Probe::new(&sphere(at, 4.0), at, DVec3::Z);
        for d in [DVec2::new(1e-3, 0.0), DVec2::new(-7e-4, 2e-3)] {
            let (p, n) = probe.near(at + d).unwrap();
            let exact = sphere(at + d, 4.0);
            assert!(p.distance(exact.p) < 1e-5);
            assert!(n.distance(exact.normal().unwrap()) < 4e-6);
        }
        assert!(probe.near(at + DVec2::new(0.0, 0.1)).is_none());
    }

    #[test]
    fn normals_face_the_eye() {
        let v = DVec3::Z;
        assert_eq!(facing(DVec3::Z, v, true), (DVec3::Z, true));
        assert_eq!(facing(-DVec3::Z, v, true), (DVec3::Z, false));
        let (n, outside) = facing(DVec3::new(1.0, 0.0, -0.1).normalize(), v, true);
        assert!(outside && n.distance(DVec3::X) < 1e-15);
    }
}
