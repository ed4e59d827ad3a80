//! Symmetric Dirichlet energy by reweighted proxies.

use glam::{DMat2, DVec2, DVec3};

use crate::sheet::{Flat, Sheet};
use crate::sparse::Pattern;
use crate::{BoundaryScaleOne, ParamError, Parameterize, Tutte};

/// Minimises the symmetric Dirichlet energy Σ A (s₁² + s₂² + 1/s₁² + 1/s₂²), from a start without flips.
///
/// Never flips a triangle: the energy is infinite there, and each step ends before the first triangle degenerates.
///
/// # References
/// M. Rabinovich, R. Poranne, D. Panozzo, O. Sorkine-Hornung, *Scalable locally injective mappings* (2017), Algorithm 1;
/// J. Smith, S. Schaefer, *Bijective parameterization with free boundaries* (2015), section 3.3 for the largest step.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricDirichlet {
    /// Where to start. Default [`Start::Conformal`].
    pub start: Start,
    /// Largest number of iterations; fewer when the energy no longer falls. Default 10: more do not help a fit.
    pub iterations: usize,
}

impl Default for SymmetricDirichlet {
    fn default() -> Self {
        Self { start: Start::default(), iterations: 10 }
    }
}

/// Where [`SymmetricDirichlet`] starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Start {
    /// [`BoundaryScaleOne`], or [`Tutte`] where that flips.
    #[default]
    Conformal,
    /// [`Tutte`].
    Tutte,
    /// These parameters, one per vertex and without flips.
    Given(Vec<DVec2>),
}

impl Parameterize for SymmetricDirichlet {
    /// # Errors
    /// [`ParamError::Flips`] when the start flips.
    fn parameterize(&self, positions: &[DVec3], faces: &[[u32; 3]]) -> Result<Vec<DVec2>, ParamError> {
        let sheet = Sheet::new(positions, faces)?;
        let tutte = || Tutte.parameterize(positions, faces);
        let start = match &self.start {
            Start::Given(uv) => uv.clone(),
            Start::Tutte => tutte()?,
            Start::Conformal => match BoundaryScaleOne.parameterize(positions, faces) {
                Ok(uv) if flips(&sheet, &uv).is_none() => uv,
                _ => tutte()?,
            },
        };
        crate::distortion::check_uv(&start, positions.len())?;
        let mut descent = Descent::new(&sheet, start)?;
        for _ in 0..self.iterations {
            if !descent.step()? {
                break;
            }
        }
        Ok(descent.parameters())
    }
}

/// Number of flipped faces and the worst one, if there are any.
pub(crate) fn flips(sheet: &Sheet<'_>, uv: &[DVec2]) -> Option<(usize, usize)> {
    let (mut count, mut face, mut worst) = (0, 0, f64::INFINITY);
    for (f, (v, flat)) in sheet.faces.iter().zip(&sheet.flats).enumerate() {
        let j = flat.jacobian(v.map(|v| uv[v as usize] / sheet.scale));
        let det = j[0].perp_dot(j[1]);
        if det <= 0.0 || det.is_nan() {
            count += 1;
            if count == 1 || det < worst {
                (worst, face) = (det, f);
            }
        }
    }
    (count > 0).then_some((count, face))
}

/// The state of the descent.
pub(crate) struct Descent<'a> {
    sheet: &'a Sheet<'a>,
    pattern: Pattern,
    uv: Vec<DVec2>,
    energy: f64,
}

impl<'a> Descent<'a> {
    /// Scales the start so that its energy is least.
    pub(crate) fn new(sheet: &'a Sheet<'a>, mut uv: Vec<DVec2>) -> Result<Self, ParamError> {
        let faces = sheet.faces.len();
        if let Some((count, face)) = flips(sheet, &uv) {
            return Err(ParamError::Flips { method: "SymmetricDirichlet", count, faces, face });
        }
        uv.iter_mut().for_each(|p| *p /= sheet.scale);
        let (mut p, mut q) = (0.0, 0.0);
        for (v, flat) in sheet.faces.iter().zip(&sheet.flats) {
            let j = flat.jacobian(v.map(|v| uv[v as usize]));
            let (det, square) = (j[0].perp_dot(j[1]), j[0].length_squared() + j[1].length_squared());
            p += flat.area * square;
            q += flat.area * square / (det * det);
        }
        // t² P + t⁻² Q is least at t⁴ = Q / P.
        let t = (q / p).sqrt().sqrt();
        if t > 0.0 && t.is_finite() {
            uv.iter_mut().for_each(|p| *p *= t);
        }
        let mut entries = Vec::with_capacity(21 * faces + 2 * uv.len());
        for v in sheet.faces {
            for (k, l) in CORNERS {
                let (a, b) = ordered(v, k, l);
                entries.extend([(2 * a, 2 * b), (2 * a + 1, 2 * b), (2 * a + 1, 2 * b + 1)]);
                if k != l {
                    entries.push((2 * a, 2 * b + 1));
                }
            }
        }
        entries.extend((0..2 * uv.len()).map(|i| (i, i)));
        let pattern = Pattern::new("SymmetricDirichlet", 2 * uv.len(), &entries)?;
        let energy = energy(sheet, &uv);
        Ok(Self { sheet, pattern, uv, energy })
    }

    /// One iteration; whether the energy fell by more than rounding errors.
    pub(crate) fn step(&mut self) -> Result<bool, ParamError> {
        let (sheet, n) = (self.sheet, self.uv.len());
        let mut values = Vec::with_capacity(21 * sheet.faces.len() + 2 * n);
        let mut direction = vec![0.0; 2 * n];
        let mut trace = 0.0;
        for (v, flat) in sheet.faces.iter().zip(&sheet.flats) {
            let proxy = Proxy::new(flat.jacobian(v.map(|v| self.uv[v as usize])));
            let m = proxy.weight * flat.area;
            for (k, l) in CORNERS {
                let g = flat.grad[k].dot(flat.grad[l]);
                values.extend([g * m.x_axis.x, g * m.x_axis.y, g * m.y_axis.y]);
                if k != l {
                    values.push(g * m.x_axis.y);
                } else {
                    trace += g * (m.x_axis.x + m.y_axis.y);
                }
            }
            for k in 0..3 {
                let r = m * (proxy.residual * flat.grad[k]);
                direction[2 * v[k] as usize] -= r.x;
                direction[2 * v[k] as usize + 1] -= r.y;
            }
        }
        // The proxies leave translations free; a small multiple of the identity holds them.
        values.extend(std::iter::repeat_n(1e-8 * trace / (2 * n) as f64, 2 * n));
        self.pattern.factor(&values)?.solve(&mut direction)?;
        let direction: Vec<DVec2> = direction.chunks_exact(2).map(DVec2::from_slice).collect();
        let mut t = (0.8 * largest_step(sheet, &self.uv, &direction)).min(1.0);
        for _ in 0..40 {
            let next: Vec<DVec2> = self.uv.iter().zip(&direction).map(|(p, d)| *p + *d * t).collect();
            let value = energy(sheet, &next);
            if value < self.energy {
                let fell = self.energy - value > 1e-12 * self.energy;
                (self.uv, self.energy) = (next, value);
                return Ok(fell);
            }
            t *= 0.5;
        }
        Ok(false)
    }

    /// The parameters in the units of the surface.
    pub(crate) fn parameters(&self) -> Vec<DVec2> {
        self.uv.iter().map(|p| *p * self.sheet.scale).collect()
    }
}

/// Pairs of corners, in the order of the entries of a face.
const CORNERS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)];

/// The two vertices with the larger first: the blocks of different corners are symmetric, so their order does not matter.
fn ordered(face: &[u32; 3], k: usize, l: usize) -> (usize, usize) {
    let (a, b) = (face[k] as usize, face[l] as usize);
    (a.max(b), a.min(b))
}

/// The quadratic that stands in for the energy of a triangle: A tr((J − R)ᵀ M (J − R)), M = U diag(w²) Uᵀ.
struct Proxy {
    weight: DMat2,
    /// J − R, R the rotation nearest to J.
    residual: DMat2,
}

impl Proxy {
    fn new(j: [DVec2; 2]) -> Self {
        // J = U diag(s₁, s₂) Vᵀ by the angles of its conformal and anticonformal parts.
        let (e, h) = (0.5 * (j[0].x + j[1].y), 0.5 * (j[1].x - j[0].y));
        let (f, g) = (0.5 * (j[0].x - j[1].y), 0.5 * (j[1].x + j[0].y));
        let (q, r) = (e.hypot(h), f.hypot(g));
        let s1 = q + r;
        // s₂ from the determinant: the difference q − r cancels in thin triangles.
        let s2 = j[0].perp_dot(j[1]) / s1;
        // w² = (s − s⁻³) / (s − 1), written without the difference that vanishes at s = 1.
        let w = |s: f64| (s + 1.0) * (s * s + 1.0) / (s * s * s);
        let (w1, w2) = (w(s1), w(s2));
        let u = DVec2::from_angle(0.5 * (h.atan2(e) + g.atan2(f)));
        let (mean, half) = (0.5 * (w1 + w2), 0.5 * (w1 - w2));
        let (c, s) = (u.x * u.x - u.y * u.y, 2.0 * u.x * u.y);
        let weight =
            DMat2::from_cols(DVec2::new(mean + half * c, half * s), DVec2::new(half * s, mean - half * c));
        let (c, s) = (e / q, h / q);
        let residual =
            DMat2::from_cols(DVec2::new(j[0].x - c, j[1].x - s), DVec2::new(j[0].y + s, j[1].y - c));
        Self { weight, residual }
    }
}

/// Symmetric Dirichlet energy; infinite with flips.
fn energy(sheet: &Sheet<'_>, uv: &[DVec2]) -> f64 {
    let mut sum = 0.0;
    for (v, flat) in sheet.faces.iter().zip(&sheet.flats) {
        sum += flat.area * density(flat, v.map(|v| uv[v as usize]));
    }
    sum
}

fn density(flat: &Flat, q: [DVec2; 3]) -> f64 {
    let j = flat.jacobian(q);
    let det = j[0].perp_dot(j[1]);
    if det > 0.0 {
        (j[0].length_squared() + j[1].length_squared()) * (1.0 + 1.0 / (det * det))
    } else {
        f64::INFINITY
    }
}

/// Largest step at which no triangle has degenerated yet; infinite if none ever does.
fn largest_step(sheet: &Sheet<'_>, uv: &[DVec2], direction: &[DVec2]) -> f64 {
    let mut step = f64::INFINITY;
    for v in sheet.faces {
        let [p, q, r] = v.map(|v| uv[v as usize]);
        let [d, e, f] = v.map(|v| direction[v as usize]);
        let (a, b, da, db) = (q - p, r - p, e - d, f - d);
        step = step.min(first_root(da.perp_dot(db), a.perp_dot(db) + da.perp_dot(b), a.perp_dot(b)));
    }
    step
}

/// Smallest positive root of a t² + b t + c with c > 0.
fn first_root(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // The root 2 c / (−b + √…) is the smaller positive one for b < 0 and the only one for b ≥ 0, a < 0; no cancellation for b < 0.
    let root = discriminant.sqrt();
    if b < 0.0 {
        2.0 * c / (root - b)
    } else if a < 0.0 {
        -(b + root) / (2.0 * a)
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_roots() {
        assert_eq!(first_root(1.0, -3.0, 2.0), 1.0);
        assert_eq!(first_root(0.0, -2.0, 1.0), 0.5);
        assert_eq!(first_root(-1.0, 0.0, 4.0), 2.0);
        assert_eq!(first_root(-1.0, 1.0, 2.0), 2.0);
        assert_eq!(first_root(1.0, 3.0, 2.0), f64::INFINITY);
        assert_eq!(first_root(1.0, 0.0, 1.0), f64::INFINITY);
        assert_eq!(first_root(0.0, 0.0, 1.0), f64::INFINITY);
    }

    /// M (J − R) must be half the gradient of the density, or the descent is none.
    #[test]
    fn the_proxy_has_the_gradient_of_the_energy() {
        let d = |m: [f64; 4]| {
            let det = m[0] * m[3] - m[1] * m[2];
            m.iter().map(|x| x * x).sum::<f64>() * (1.0 + 1.0 / (det * det))
        };
        for m in [[1.2, 0.3, -0.4, 0.9], [0.2, 0.1, 0.05, 3.0], [1.0, 0.0, 0.0, 1.0], [-0.5, 0.8, -1.3, 0.2]]
        {
            let proxy = Proxy::new([DVec2::new(m[0], m[1]), DVec2::new(m[2], m[3])]);
            let half = (proxy.weight * proxy.residual).to_cols_array();
            for (i, at) in [(0, 0), (1, 2), (2, 1), (3, 3)] {
                let h = 1e-6;
                let (mut lo, mut hi) = (m, m);
                lo[i] -= h;
                hi[i] += h;
                let difference = (d(hi) - d(lo)) / (2.0 * h);
                assert!((2.0 * half[at] - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{m:?}");
            }
        }
    }
}
