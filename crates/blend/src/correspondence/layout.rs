//! The reference map of a corner: where the N-gon lies on the shape, common to all charts.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::gon_samples;
use crate::network::Ray;
use crate::polynomial::PlanePolynomial;
use crate::{Corner, Network, gon};

/// Distance of the corners of the N-gon from the rays, in half widths.
const BAND: f64 = 0.8;
/// Largest 1/sin(α/2) and cot(α/2) that the layout follows: sharper sectors would push the N-gon too far out.
const CAP: f64 = 2.2;
/// Distance of the first cross line from the N-gon, in widths.
const GAP: f64 = 0.6;
/// Least cot(α/2) for the first cross line: it stays off the corner of a straight angle.
const LEAST_COT: f64 = 0.2;
/// Where the direction of an arc is taken, in widths from the corner.
const DIRECTION_AT: f64 = 1.2;
/// Sectors below this, or as close to a full turn, make cross lines of neighbouring arcs intersect.
pub(super) const SHARPEST: f64 = 18.0 * std::f64::consts::PI / 180.0;
/// Cosine between the lines and a normal above which a corner counts as smooth, and below which its lines are useless.
const SMOOTH: f64 = 0.9;
const STEEPEST: f64 = 0.2;
/// Shortest adjacent strip, in widths: shorter ones arise only where the cap acts on both sides of a ray.
const SHORTEST: f64 = 0.05;

/// The N-gon laid out in the tangent plane of a corner: `Y(P) = origin + [e₁ e₂] L(P)`, lines along `normal`.
pub(super) struct Layout {
    pub(super) origin: DVec3,
    pub(super) axes: [DVec3; 2],
    pub(super) normal: DVec3,
    /// L: N-gon → (e₁, e₂).
    pub(super) plane: PlanePolynomial,
    /// Directions of the arcs in (e₁, e₂), and the sectors between arc i and arc i + 1.
    directions: Vec<f64>,
    sectors: Vec<f64>,
    /// How far along arc i the corners of the N-gon on either side lie, seen in the charts: where these are steep against the
    /// tangent plane, farther than in it.
    along: Vec<f64>,
    width: f64,
}

impl Layout {
    /// The layout for width `s`, or `None` where the arcs leave in the wrong order or too close to each other.
    pub(super) fn new(network: &Network, lengths: &[Vec<f64>], corner: &Corner, s: f64) -> Option<Self> {
        let n = corner.arcs.len();
        let rays: Vec<Ray<'_>> =
            corner.arcs.iter().map(|e| Ray::new(&network.arcs[e.arc], &lengths[e.arc], e.starts)).collect();
        let normals = (0..n)
            .map(|i| network.surfaces[network.segment(corner, i)].jet(rays[i].sample(0.0).left).normal())
            .collect::<Option<Vec<_>>>()?;
        let normal = central_direction(&normals)?;
        let e1 = normal.any_orthonormal_vector();
        let axes = [e1, normal.cross(e1)];
        let origin = rays[0].sample(0.0).position;
        let arcs: Vec<DVec3> = rays
            .iter()
            .map(|ray| ray.sample((DIRECTION_AT * s).min(ray.length())).position - origin)
            .collect();
        let directions: Vec<f64> = arcs.iter().map(|d| d.dot(axes[1]).atan2(d.dot(axes[0]))).collect();
        let sectors: Vec<f64> =
            (0..n).map(|i| (directions[(i + 1) % n] - directions[i]).rem_euclid(TAU)).collect();
        // Any order but the counter-clockwise one winds more than once.
        let winding = sectors.iter().sum::<f64>() / TAU;
        let open = |a: &f64| (SHARPEST..=TAU - SHARPEST).contains(a);
        if (winding - 1.0).abs() > 1e-6 || !sectors.iter().all(open) {
            return None;
        }
        let corners: Vec<DVec2> = (0..n)
            .map(|i| {
                let half = 0.5 * sectors[i];
                let distance = BAND * 0.5 * s * (1.0 / half.sin()).min(CAP);
                DVec2::from_angle(directions[i] + half) * distance
            })
            .collect();
        let plane = harmonic(&corners)?;
        // Along the lines onto the tangent planes of the charts.
        let met: Vec<DVec3> = corners
            .iter()
            .zip(&normals)
            .map(|(r, n)| {
                let y = axes[0] * r.x + axes[1] * r.y;
                y - normal * (y.dot(*n) / normal.dot(*n))
            })
            .collect();
        let along = (0..n)
            .map(|i| {
                let arc = arcs[i].normalize_or_zero();
                met[i].dot(arc).max(met[(i + n - 1) % n].dot(arc))
            })
            .collect();
        let layout = Self { origin, axes, normal, plane, directions, sectors, along, width: s };
        let unfolded = gon_samples(n).into_iter().all(|p| {
            let jet = layout.plane.jet(p);
            jet.du.perp_dot(jet.dv) > 0.0
        });
        (unfolded && (0..n).all(|i| layout.first_strip(i) > SHORTEST * s)).then_some(layout)
    }

    /// `Y` over a point of the N-gon.
    pub(super) fn target(&self, at: DVec2) -> DVec3 {
        let l = self.plane.jet(at).p;
        self.origin + self.axes[0] * l.x + self.axes[1] * l.y
    }

    /// Distance of the first cross line of arc `i` from the corner.
    pub(super) fn reach(&self, i: usize) -> f64 {
        let cot = |alpha: f64| (1.0 / (0.5 * alpha).tan()).min(CAP);
        let n = self.sectors.len();
        let beside = cot(self.sectors[i]).max(cot(self.sectors[(i + n - 1) % n]));
        let flat = self.width * (0.5 * beside.max(LEAST_COT) + GAP);
        flat.max(self.along[i] + self.width * GAP)
    }

    /// Length of the strip between the N-gon and the first cross line of arc `i`, on its shorter side.
    pub(super) fn first_strip(&self, i: usize) -> f64 {
        let n = self.sectors.len();
        let r = gon::corners(n);
        let ray = DVec2::from_angle(self.directions[i]);
        let along = |p: DVec2| self.plane.jet(p).p.dot(ray);
        self.reach(i) - along(r[i]).max(along(r[(i + n - 1) % n])).max(self.along[i])
    }

    /// Speed |D_ν L| of the layout across the middle of the edge that faces arc `i`.
    pub(super) fn speed(&self, i: usize) -> f64 {
        let n = self.sectors.len();
        let r = gon::corners(n);
        let middle = 0.5 * (r[i] + r[(i + n - 1) % n]);
        let nu = middle.normalize_or_zero();
        let jet = self.plane.jet(middle);
        (jet.du * nu.x + jet.dv * nu.y).length()
    }
}

/// The direction whose largest angle with the `normals` is least: lines along it meet all of the surfaces as steeply as can be.
/// `None` where some surface turns away from every direction.
fn central_direction(normals: &[DVec3]) -> Option<DVec3> {
    // The smallest cap around the normals is that around two of them, or around three.
    let n = normals.len();
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
    let mut centres: Vec<DVec3> = pairs.clone().map(|(i, j)| normals[i] + normals[j]).collect();
    centres.extend(pairs.flat_map(|(i, j)| {
        (0..j).map(move |k| {
            let centre = (normals[i] - normals[k]).cross(normals[j] - normals[k]);
            centre * centre.dot(normals[k]).signum()
        })
    }));
    let least = |d: &DVec3| normals.iter().map(|n| n.dot(*d)).fold(f64::INFINITY, f64::min);
    // The sum first: it is the smoothest choice, and as good as any on a smooth surface.
    let sum = normals.iter().sum::<DVec3>().try_normalize().filter(|d| least(d) > SMOOTH);
    let best = || {
        let directions = centres.iter().filter_map(|c| c.try_normalize());
        directions.max_by(|a, b| least(a).total_cmp(&least(b))).filter(|d| least(d) > STEEPEST)
    };
    sum.or_else(best)
}

/// Distance of the first cross line from a corner of valence `n` with equal angles, in widths.
pub(super) fn regular_reach(n: usize) -> f64 {
    let cot = 2.0 * gon::apothem(n);
    0.5 * cot.clamp(LEAST_COT, CAP) + GAP
}

/// The harmonic polynomial with `L(R_i) = r_i`: `c₀ + Σ (c_k z^k + d_k z̄^k)`, a discrete Fourier transform of the `r_i`.
fn harmonic(r: &[DVec2]) -> Option<PlanePolynomial> {
    let n = r.len();
    let degree = n / 2;
    let radius = gon::circumradius(n);
    let mut coefficients = vec![DVec2::ZERO; (degree + 1) * (degree + 2) / 2];
    // R_i = radius · i · e^{2πi/N}, the first corner on the positive V axis.
    let mean = |k: i32| {
        let turn = |i: usize| DVec2::from_angle(-TAU * f64::from(k) * (i as f64 / n as f64 + 0.25));
        r.iter().enumerate().map(|(i, &x)| turn(i).rotate(x)).sum::<DVec2>() / n as f64
    };
    coefficients[0] = mean(0);
    for k in 1..=degree {
        let scale = radius.powi(k as i32).recip();
        let row = k * (k + 1) / 2;
        let even = 2 * k == n;
        let (c, d) = (mean(k as i32) * scale, mean(-(k as i32)) * scale);
        // z^k = Σ_j binomial(k, j) i^j U^{k−j} V^j; at k = N/2 both waves are one real wave and each carries half of it.
        for j in 0..=k {
            let b = suture_bernstein::bernstein::binomial(k, j) * if even { 0.5 } else { 1.0 };
            let i_to_j = DVec2::from_angle(0.25 * TAU * j as f64);
            let conjugate = DVec2::new(i_to_j.x, -i_to_j.y);
            coefficients[row + j] += (i_to_j.rotate(c) + conjugate.rotate(d)) * b;
        }
    }
    PlanePolynomial::new(degree, coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonic_layouts_interpolate() {
        for n in 3..=8 {
            let r: Vec<DVec2> = (0..n)
                .map(|i| {
                    DVec2::from_angle(0.3 + TAU * i as f64 / n as f64) * (1.0 + 0.2 * (i as f64 * 1.7).sin())
                })
                .collect();
            let l = harmonic(&r).unwrap();
            for (p, r) in gon::corners(n).into_iter().zip(&r) {
                assert!((l.jet(p).p - *r).length() < 1e-14, "N = {n}");
                let jet = l.jet(0.7 * p);
                assert!((jet.duu + jet.dvv).length() < 1e-13, "N = {n} is not harmonic");
            }
        }
    }

    #[test]
    fn reaches_of_regular_corners_are_those_of_the_specification() {
        for (n, reach) in [(3, 0.889), (4, 1.1), (6, 1.466)] {
            assert!((regular_reach(n) - reach).abs() < 1e-3);
        }
    }
}
