//! Charts with known truth.
#![allow(dead_code, missing_docs, unreachable_pub)]

use glam::{DVec2, DVec3};
use suture_fit::FitInput;

/// A chart that owns its arrays.
#[derive(Clone)]
pub struct Chart {
    pub points: Vec<DVec3>,
    pub params: Vec<DVec2>,
    pub triangles: Vec<[u32; 3]>,
    pub in_segment: Vec<bool>,
    pub diagonal: f64,
    pub reach: f64,
}

impl Chart {
    /// A jittered triangle lattice with `side` vertices along the diameter, cut to the unit disc and scaled by `radius`.
    pub fn disc(side: usize, radius: f64, lift: impl Fn(DVec2) -> DVec3) -> Self {
        let e = 2.0 / (side - 1) as f64;
        let mut noise = Noise(7);
        let rows = (side as f64 / 0.866).ceil() as i64 + 2;
        let (mut id, mut params) = (std::collections::BTreeMap::new(), Vec::new());
        for j in -rows..=rows {
            for i in -2 * rows..=2 * rows {
                let jitter = DVec2::new(noise.uniform(), noise.uniform()) * 0.3 * e;
                let p = DVec2::new(e * (i as f64 + 0.5 * j as f64), e * 0.866 * j as f64) + jitter;
                if p.length() <= 1.0 {
                    id.insert((i, j), params.len() as u32);
                    params.push(p * radius);
                }
            }
        }
        let mut triangles = Vec::new();
        for &(i, j) in id.keys() {
            for t in [[(i, j), (i + 1, j), (i, j + 1)], [(i + 1, j), (i + 1, j + 1), (i, j + 1)]] {
                if let [Some(&a), Some(&b), Some(&c)] = t.map(|k| id.get(&k)) {
                    triangles.push([a, b, c]);
                }
            }
        }
        // Vertices without a triangle are dropped.
        let mut used = vec![false; params.len()];
        triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        let mut new = vec![0; params.len()];
        let mut kept = Vec::new();
        for (v, p) in params.iter().enumerate().filter(|&(v, _)| used[v]) {
            new[v] = kept.len() as u32;
            kept.push(*p);
        }
        triangles.iter_mut().flatten().for_each(|v| *v = new[*v as usize]);
        Self {
            points: kept.iter().map(|&p| lift(p)).collect(),
            in_segment: vec![true; triangles.len()],
            params: kept,
            triangles,
            diagonal: 1.0,
            reach: 0.0,
        }
    }

    pub fn input(&self) -> FitInput<'_> {
        FitInput {
            points: &self.points,
            params: &self.params,
            triangles: &self.triangles,
            in_segment: &self.in_segment,
            diagonal: self.diagonal,
            reach: self.reach,
        }
    }

    /// Gaussian noise of standard deviation `sigma` per coordinate, or along the vertex normal only.
    pub fn noisy(mut self, sigma: f64, seed: u64, normal: bool) -> Self {
        let mut noise = Noise(seed);
        let mut normals = vec![DVec3::ZERO; self.points.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            t.iter().for_each(|&v| normals[v as usize] += (b - a).cross(c - a));
        }
        for (x, n) in self.points.iter_mut().zip(normals) {
            let r = DVec3::new(noise.normal(), noise.normal(), noise.normal()) * sigma;
            *x += if normal { n.normalize() * r.x } else { r };
        }
        self
    }
}

/// Stereographic projection onto the sphere of diameter of the box 1, `p` in units of length at the pole.
pub fn sphere(p: DVec2) -> DVec3 {
    let r = 0.5 / 3f64.sqrt();
    let q = p / (2.0 * r);
    let s = q.length_squared();
    DVec3::new(2.0 * q.x, 2.0 * q.y, 1.0 - s) / (1.0 + s) * r
}

pub fn sphere_distance(x: DVec3) -> f64 {
    (x.length() - 0.5 / 3f64.sqrt()).abs()
}

/// A patch of the torus with radii 0.3 and 0.12, nearly isometric near the origin.
pub fn torus(p: DVec2) -> DVec3 {
    let (s, c) = (p.x / 0.12).sin_cos();
    let (t, d) = (p.y / 0.42).sin_cos();
    let r = 0.3 + 0.12 * c;
    DVec3::new(r * d, r * t, 0.12 * s)
}

pub fn torus_distance(x: DVec3) -> f64 {
    let ring = x.truncate().length() - 0.3;
    (ring.hypot(x.z) - 0.12).abs()
}

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Noise(pub u64);

impl Noise {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in (−½, ½).
    pub fn uniform(&mut self) -> f64 {
        ((self.next() >> 11) as f64 + 0.5) / (1u64 << 53) as f64 - 0.5
    }

    /// Standard normal (Box–Muller).
    pub fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform() + 0.5, self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

/// Root mean square of `distance` over the fitted positions of the chart's own parameters.
pub fn truth_error(fit: &suture_fit::Fit, distance: impl Fn(DVec3) -> f64) -> f64 {
    let squares = fit.params.iter().map(|&p| distance(fit.surface.jet(p).p).powi(2));
    (squares.sum::<f64>() / fit.params.len() as f64).sqrt()
}
