//! Gradients of quadrics fitted around each vertex.

use std::collections::VecDeque;

use glam::DVec3;

use super::weighted::{angle_weighted, named};
use super::{EstimateNormals, NormalsError, check, ring};
use crate::measure::length;
use crate::{Topology, TriMesh};

/// Gradients of implicit quadrics fitted to the vertices around each vertex, their lengths made consistent over the mesh: where the
/// vertices lie on one quadric, its gradients up to one factor. Elsewhere lengths vary slowly, around 1 in the mean.
///
/// Fits that are not unique (plane parts, few vertices), that miss the vertex's own neighbours or whose normal disagrees with the
/// faces are replaced by the mean of the face normals weighted by angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricFit {
    /// How many rings of neighbours are fitted, clamped to `1..=4`. Default 2: a quadric has nine degrees of freedom, one ring about six
    /// points.
    pub rings: usize,
    /// Largest factor between the lengths of a gradient and of its neighbours' estimates of it; beyond it the fit is not used. At least 1.
    /// Default 4.
    pub spread: f64,
}

impl Default for QuadricFit {
    fn default() -> Self {
        Self { rings: 2, spread: 4.0 }
    }
}

/// `x ↦ x·A x + b·x` with `x` measured from a vertex in units of the patch; the constant is part of the fit.
#[derive(Clone, Copy, Debug)]
struct Quadric {
    c: [f64; 10],
    origin: DVec3,
    scale: f64,
}

impl EstimateNormals for QuadricFit {
    fn estimate(&self, mesh: &TriMesh, topology: &Topology) -> Result<Vec<DVec3>, NormalsError> {
        check(mesh, topology)?;
        let count = mesh.positions.len();
        let mut normals = Vec::with_capacity(count);
        let mut fits = Vec::with_capacity(count);
        let mut mark = vec![u32::MAX; count];
        for v in 0..count as u32 {
            let mean = angle_weighted(mesh, topology, v);
            let around = rings(topology, v, self.rings.clamp(1, 4), &mut mark);
            fits.push(mean.and_then(|n| fit(mesh, v, &around, n)));
            normals.push(mean.unwrap_or_default());
        }
        let normals = named(topology, normals)?;
        Ok(scale(mesh, topology, normals, fits, self.spread.max(1.0)))
    }
}

/// The vertices within `rings` edges of `v`, `v` first.
fn rings(topology: &Topology, v: u32, rings: usize, mark: &mut [u32]) -> Vec<u32> {
    let mut all = vec![v];
    mark[v as usize] = v;
    let mut from = 0;
    for _ in 0..rings {
        let to = all.len();
        for i in from..to {
            for w in ring(topology, all[i]) {
                if std::mem::replace(&mut mark[w as usize], v) != v {
                    all.push(w);
                }
            }
        }
        from = to;
    }
    all
}

/// The quadric of least squares, its gradient at the vertex of length 1 and on the side of `normal`; `None` where it is not unique or
/// does not describe the vertices.
fn fit(mesh: &TriMesh, v: u32, around: &[u32], normal: DVec3) -> Option<Quadric> {
    if around.len() < 9 {
        return None;
    }
    let origin = mesh.positions[v as usize];
    let scale = around.iter().map(|&w| length(mesh.positions[w as usize] - origin)).fold(0.0, f64::max);
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let rows: Vec<[f64; 10]> =
        around.iter().map(|&w| monomials((mesh.positions[w as usize] - origin) / scale)).collect();
    let (sigma, c) = least(&rows);
    // The second smallest singular value tells whether another quadric fits as well.
    if !(sigma[1] > 1e-5 * sigma[9] && sigma[0] < 0.1 * sigma[1]) {
        return None;
    }
    let mut q = Quadric { c, origin, scale };
    let gradient = q.gradient(origin);
    let size = gradient.length();
    // An exact fit may turn the normal; a rough one, above all at a boundary, is worth less than the faces.
    let agreement = if sigma[0] < 1e-6 * sigma[1] { 0.5 } else { 0.98 };
    if !(size > 1e-3 && gradient.dot(normal).abs() > agreement * size) {
        return None;
    }
    let factor = 1.0 / size.copysign(gradient.dot(normal));
    q.c = q.c.map(|c| c * factor);
    Some(q)
}

fn monomials(p: DVec3) -> [f64; 10] {
    let DVec3 { x, y, z } = p;
    [x * x, y * y, z * z, x * y, y * z, z * x, x, y, z, 1.0]
}

impl Quadric {
    /// Gradient in units of one over the scale of the fit.
    fn gradient(&self, p: DVec3) -> DVec3 {
        let c = &self.c;
        let DVec3 { x, y, z } = (p - self.origin) / self.scale;
        DVec3::new(
            2.0 * c[0] * x + c[3] * y + c[5] * z + c[6],
            2.0 * c[1] * y + c[3] * x + c[4] * z + c[7],
            2.0 * c[2] * z + c[4] * y + c[5] * x + c[8],
        )
    }
}

/// Singular values ascending, and the right singular vector of the smallest: one-sided Jacobi rotations of the columns, which lose
/// nothing to the squaring of a normal matrix.
fn least(rows: &[[f64; 10]]) -> ([f64; 10], [f64; 10]) {
    const N: usize = 10;
    let mut a: Vec<[f64; N]> = rows.to_vec();
    let mut v = [[0.0; N]; N];
    for i in 0..N {
        v[i][i] = 1.0;
    }
    for _ in 0..40 {
        let mut turned = false;
        for i in 0..N {
            for j in i + 1..N {
                let (mut p, mut q, mut r) = (0.0, 0.0, 0.0);
                for row in &a {
                    p += row[i] * row[i];
                    q += row[j] * row[j];
                    r += row[i] * row[j];
                }
                if r.abs() <= f64::EPSILON * (p * q).sqrt() {
                    continue;
                }
                turned = true;
                let tau = (q - p) / (2.0 * r);
                let t = tau.signum() / (tau.abs() + (1.0 + tau * tau).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                let s = c * t;
                for row in a.iter_mut().chain(v.iter_mut()) {
                    (row[i], row[j]) = (c * row[i] - s * row[j], s * row[i] + c * row[j]);
                }
            }
        }
        if !turned {
            break;
        }
    }
    let sizes = std::array::from_fn::<f64, N, _>(|i| a.iter().map(|row| row[i] * row[i]).sum::<f64>().sqrt());
    let mut order = std::array::from_fn::<usize, N, _>(|i| i);
    order.sort_by(|&i, &j| sizes[i].total_cmp(&sizes[j]));
    (order.map(|i| sizes[i]), std::array::from_fn(|i| v[i][order[0]]))
}

/// Chooses the length of every gradient so that neighbours agree about each other's, and brings the mean to 1.
fn scale(
    mesh: &TriMesh,
    topology: &Topology,
    normals: Vec<DVec3>,
    fits: Vec<Option<Quadric>>,
    spread: f64,
) -> Vec<DVec3> {
    let count = normals.len();
    let p = |v: u32| mesh.positions[v as usize];
    // log of (length at b)/(length at a), as the fits of both ends see it.
    let ratio = |a: u32, b: u32| -> f64 {
        let see = |from: u32, to: u32| {
            let size = fits[from as usize].as_ref()?.gradient(p(to)).length().ln();
            size.is_finite().then_some(size)
        };
        match (see(a, b), see(b, a)) {
            (Some(x), Some(y)) if x.abs() <= spread.ln() && y.abs() <= spread.ln() => 0.5 * (x - y),
            (Some(x), None) if x.abs() <= spread.ln() => x,
            (None, Some(y)) if y.abs() <= spread.ln() => -y,
            _ => 0.0,
        }
    };
    let mut log = vec![f64::NAN; count];
    let mut order: Vec<u32> = Vec::with_capacity(count);
    let mut queue = VecDeque::new();
    for seed in 0..count as u32 {
        if !log[seed as usize].is_nan() {
            continue;
        }
        log[seed as usize] = 0.0;
        queue.push_back(seed);
        let begin = order.len();
        while let Some(v) = queue.pop_front() {
            order.push(v);
            for w in ring(topology, v) {
                if log[w as usize].is_nan() {
                    log[w as usize] = log[v as usize] + ratio(v, w);
                    queue.push_back(w);
                }
            }
        }
        // Every component by itself: nothing relates their scales.
        let part = &order[begin..];
        relax(topology, part, &ratio, &mut log);
        let mean = part.iter().map(|&v| log[v as usize]).sum::<f64>() / part.len().max(1) as f64;
        part.iter().for_each(|&v| log[v as usize] -= mean);
    }
    (0..count)
        .map(|v| {
            let direction = fits[v].as_ref().map_or(normals[v], |q| q.gradient(q.origin).normalize_or_zero());
            direction * log[v].exp()
        })
        .collect()
}

/// The lengths that agree best with all ratios, by conjugate gradients from the first guess: the tree that gave it is not special.
fn relax(topology: &Topology, part: &[u32], ratio: &impl Fn(u32, u32) -> f64, log: &mut [f64]) {
    let mut place = vec![0u32; log.len()];
    (0u32..).zip(part).for_each(|(i, &v)| place[v as usize] = i);
    let rings: Vec<Vec<u32>> = part.iter().map(|&v| ring(topology, v)).collect();
    let laplacian = |x: &[f64]| -> Vec<f64> {
        let at = |w: &u32| x[place[*w as usize] as usize];
        (0..part.len()).map(|i| rings[i].iter().map(|w| x[i] - at(w)).sum()).collect()
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut x: Vec<f64> = part.iter().map(|&v| log[v as usize]).collect();
    let now = laplacian(&x);
    let mut r: Vec<f64> =
        (0..part.len()).map(|i| rings[i].iter().map(|&w| ratio(w, part[i])).sum::<f64>() - now[i]).collect();
    let mut d = r.clone();
    let mut rr = dot(&r, &r);
    // Logarithms of ratios are of order 1, whatever the units: far below that, the guess was consistent already.
    let enough = 1e-24 * part.len() as f64;
    for _ in 0..1000 {
        if !(rr > enough) {
            break;
        }
        let a = laplacian(&d);
        let step = rr / dot(&d, &a);
        if !step.is_finite() {
            break;
        }
        for i in 0..x.len() {
            x[i] += step * d[i];
            r[i] -= step * a[i];
        }
        let next = dot(&r, &r);
        for i in 0..d.len() {
            d[i] = r[i] + next / rr * d[i];
        }
        rr = next;
    }
    part.iter().zip(x).for_each(|(&v, x)| log[v as usize] = x);
}
