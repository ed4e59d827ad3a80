//! `F` on the one or two tetrahedra of a face (specification, sections 3 and 4).

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::coefficients::{Corners, EDGE, Quadric, barycentric, barycentric_gradients, paper_default};
use crate::cubic::{Cubic, Form2, apply, dot, quadratic};
use crate::shooting::Shooting;

/// How the base layer of `F` is made: what vanishes at the corners of the face and has their gradients.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Base {
    /// One rational function: a cubic without its inner coefficient, and that coefficient as a weighted mean of three.
    Rational { cubic: Cubic, w: [f64; 3] },
    /// Three cubics, one per sub-triangle `(c, p_a, p_b)` opposite vertex `k`.
    Split([Cubic; 3]),
}

impl Base {
    pub(crate) fn rational(corners: &Corners) -> Self {
        Self::Rational { cubic: Cubic::of_edges(&corners.e, 0.0), w: corners.w() }
    }

    pub(crate) fn split(corners: &Corners) -> Self {
        let (e, p, c) = (&corners.e, &corners.p, corners.centroid());
        let z = [0, 1, 2].map(|k| (e[k][EDGE[k][0]] + e[k][EDGE[k][1]]) / 3.0);
        let y = [0, 1, 2].map(|k| {
            let [a, b] = EDGE[k];
            crate::coefficients::across(c, [p[a], p[b]], [z[a], z[b]], [e[a][b], e[b][a]])
        });
        let x = [0, 1, 2].map(|a| (z[a] + y[EDGE[a][0]] + y[EDGE[a][1]]) / 3.0);
        let ccc = (x[0] + x[1] + x[2]) / 3.0;
        // In the order c, a, b: 000, 111, 222, 001, 002, 110, 112, 220, 221, 012.
        Self::Split([0, 1, 2].map(|k| {
            let [a, b] = EDGE[k];
            Cubic([ccc, 0.0, 0.0, x[a], x[b], z[a], e[a][b], z[b], e[b][a], y[k]])
        }))
    }

    /// The sub-triangle of a point, by the vertex opposite to it, and the coordinates there.
    #[inline]
    fn local(x: [f64; 3]) -> (usize, [f64; 3]) {
        let k = if x[0] <= x[1] && x[0] <= x[2] {
            0
        } else if x[1] <= x[2] {
            1
        } else {
            2
        };
        let [a, b] = EDGE[k];
        (k, [3.0 * x[k], x[a] - x[k], x[b] - x[k]])
    }

    /// Value and gradient of `L₀`, homogeneous of degree 3.
    #[inline]
    pub(crate) fn gradient(&self, x: [f64; 3]) -> (f64, [f64; 3]) {
        match self {
            Self::Rational { cubic, w } => {
                let (v, g) = cubic.gradient(x);
                // Roundings below zero must not make negative weights.
                let x = x.map(|x| x.max(0.0));
                let a = [x[1] * x[2], x[2] * x[0], x[0] * x[1]];
                let d = a[0] + a[1] + a[2];
                if d == 0.0 {
                    return (v, g);
                }
                let mean = dot(*w, a) / d;
                let product = x[0] * a[0];
                // ∂N/∂x₀ − W ∂D/∂x₀ = (w₁ − W) x₂ + (w₂ − W) x₁, and so on.
                let u = w.map(|w| w - mean);
                let slope = [u[1] * x[2] + u[2] * x[1], u[2] * x[0] + u[0] * x[2], u[0] * x[1] + u[1] * x[0]];
                let g = [0, 1, 2].map(|i| g[i] + 6.0 * (a[i] * mean + product * slope[i] / d));
                (v + 6.0 * product * mean, g)
            }
            Self::Split(cubics) => {
                let (k, y) = Self::local(x);
                let [a, b] = EDGE[k];
                let (v, l) = cubics[k].gradient(y);
                let mut g = [0.0; 3];
                (g[a], g[b], g[k]) = (l[1], l[2], 3.0 * l[0] - l[1] - l[2]);
                (v, g)
            }
        }
    }

    /// Value, gradient and second derivatives of `L₀`.
    pub(crate) fn second(&self, x: [f64; 3]) -> Form2 {
        match self {
            Self::Rational { cubic, w } => {
                let mut form = cubic.second(x);
                let mut x = x.map(|x| x.max(0.0));
                let products = |x: [f64; 3]| [x[1] * x[2], x[2] * x[0], x[0] * x[1]];
                let sum = |a: [f64; 3]| a[0] + a[1] + a[2];
                let mut a = products(x);
                let (v, g) = (form.v, form.g);
                let corner = sum(a) == 0.0;
                if corner {
                    // Second derivatives at a corner depend on the direction; those along its bisector are taken.
                    x = x.map(|x| if x > 0.0 { x } else { NUDGE });
                    a = products(x);
                }
                let d = sum(a);
                let mean = dot(*w, a) / d;
                let product = x[0] * a[0];
                let u = w.map(|w| w - mean);
                let dd = [x[1] + x[2], x[2] + x[0], x[0] + x[1]];
                let slope = [u[1] * x[2] + u[2] * x[1], u[2] * x[0] + u[0] * x[2], u[0] * x[1] + u[1] * x[0]]
                    .map(|s| s / d);
                form.v += 6.0 * product * mean;
                for i in 0..3 {
                    form.g[i] += 6.0 * (a[i] * mean + product * slope[i]);
                }
                // Second derivatives of the product, of N − W D with W held, and the mixed terms.
                for (n, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
                    let (pp, bend) = if i == j { (0.0, 0.0) } else { (x[3 - i - j], u[3 - i - j]) };
                    let ww = (bend - slope[i] * dd[j] - slope[j] * dd[i]) / d;
                    form.h[n] += 6.0 * (pp * mean + a[i] * slope[j] + a[j] * slope[i] + product * ww);
                }
                if corner {
                    (form.v, form.g) = (v, g);
                }
                form
            }
            Self::Split(cubics) => {
                let (k, y) = Self::local(x);
                let [a, b] = EDGE[k];
                let l = cubics[k].second(y);
                // Columns of the map to local coordinates: what each global coordinate moves.
                let mut columns = [[0.0; 3]; 3];
                columns[k] = [3.0, -1.0, -1.0];
                columns[a] = [0.0, 1.0, 0.0];
                columns[b] = [0.0, 0.0, 1.0];
                let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
                Form2 {
                    v: l.v,
                    g: columns.map(|c| dot(c, l.g)),
                    h: pairs.map(|(i, j)| l.along(columns[i], columns[j])),
                }
            }
        }
    }
}

/// Distance from a corner at which second derivatives that have no limit there are taken.
const NUDGE: f64 = 1.0 / (1u64 << 60) as f64;

/// The tetrahedron of a face on one side: the layers of `F` above the base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FaceSide {
    /// `+1` (apex `u`) or `−1` (apex `v`).
    pub(crate) sign: f64,
    pub(crate) apex: DVec3,
    /// `aaA`.
    pub(crate) h: [f64; 3],
    /// `abA`.
    pub(crate) m: [f64; 3],
    /// `q_aA` of the quadratic of step 5.
    pub(crate) q: [f64; 3],
    /// `aAA`, once the weight is known.
    pub(crate) r: [f64; 3],
    /// The apex weight `AAA`.
    pub(crate) b: f64,
    /// Gradients of the barycentric coordinates.
    pub(crate) gradients: [DVec3; 4],
}

impl FaceSide {
    /// The side with apex `apex`, its weight still 0.
    pub(crate) fn new(corners: &Corners, sign: f64, apex: DVec3) -> Self {
        let h = corners.h(apex);
        let m = corners.m(apex, &h);
        let fit = Quadric::fit(&corners.e, &h, &m, inner(corners));
        let gradients = barycentric_gradients(&[corners.p[0], corners.p[1], corners.p[2], apex]);
        let mut side = Self { sign, apex, h, m, q: fit.side, r: [0.0; 3], b: 0.0, gradients };
        side.set_weight(0.0);
        side
    }

    pub(crate) fn set_weight(&mut self, b: f64) {
        self.b = b;
        self.r = self.q.map(|q| (b + 2.0 * q) / 3.0);
    }

    /// Whether layer 1 is of the sign of the side all over the face: the surface leaves a zero of the base at a slope.
    pub(crate) fn rises(&self) -> bool {
        self.h.iter().all(|h| self.sign * h > 0.0) && self.m.iter().all(|m| self.sign * m >= -self.slack())
    }

    /// What rounding may take from an `m_k` that was made 0.
    fn slack(&self) -> f64 {
        1e-12 * self.h.iter().fold(0.0_f64, |s, h| s.max(h.abs()))
    }

    /// The paper's default weight.
    pub(crate) fn paper_weight(&self, corners: &Corners) -> f64 {
        paper_default(&corners.e, &self.h, &self.m, inner(corners))
    }

    /// The weight for which the quadratic of step 5, extended to the opposite vertices of the neighbours, comes closest to their value
    /// and gradient; `None` where they do not determine it.
    pub(crate) fn neighbour_weight(&self, corners: &Corners, opposite: &[(DVec3, DVec3)]) -> Option<f64> {
        let fit = Quadric::fit(&corners.e, &self.h, &self.m, inner(corners));
        let ell2 = self.ell2(corners);
        let slope = self.gradients[3];
        let (mut above, mut below) = (0.0, 0.0);
        for &(p, g) in opposite {
            let x = barycentric(p, self.apex, &self.gradients);
            let (value, d) = fit.gradient(x);
            let gradient: DVec3 = (0..4).map(|i| self.gradients[i] * d[i]).sum();
            let tau = x[3];
            above += tau * tau * value + 2.0 * ell2 * tau * slope.dot(gradient - g);
            below += tau.powi(4) + 4.0 * ell2 * tau * tau * slope.length_squared();
        }
        (below >= 1e-8).then(|| -above / below)
    }

    /// Area of the face.
    fn ell2(&self, corners: &Corners) -> f64 {
        0.5 * (corners.p[1] - corners.p[0]).cross(corners.p[2] - corners.p[0]).length()
    }

    /// `L₁`, homogeneous of degree 2, as a quadratic form.
    #[inline]
    pub(crate) fn l1(&self) -> [f64; 6] {
        quadratic(&self.h, &self.m)
    }

    /// Barycentric coordinates of a point.
    pub(crate) fn barycentric(&self, x: DVec3) -> [f64; 4] {
        barycentric(x, self.apex, &self.gradients)
    }

    /// `F` and its spatial gradient at barycentric coordinates `(x₀, x₁, x₂, t)`.
    #[inline]
    pub(crate) fn value(&self, base: &Base, x: [f64; 4]) -> (f64, DVec3) {
        let [y, t] = [[x[0], x[1], x[2]], [x[3]; 3]];
        let t = t[0];
        let (l0, g0) = base.gradient(y);
        let line = apply(&self.l1(), y);
        let (l1, l2) = (dot(line, y), dot(self.r, y));
        let value = l0 + 3.0 * t * l1 + 3.0 * t * t * l2 + t * t * t * self.b;
        let d = [0, 1, 2].map(|i| g0[i] + 6.0 * t * line[i] + 3.0 * t * t * self.r[i]);
        let dt = 3.0 * l1 + 6.0 * t * l2 + 3.0 * t * t * self.b;
        let g = &self.gradients;
        (value, g[0] * d[0] + g[1] * d[1] + g[2] * d[2] + g[3] * dt)
    }
}

/// The coefficient `012` that step 5 uses; it does not enter the base layer.
fn inner(corners: &Corners) -> f64 {
    let w = corners.w();
    (w[0] + w[1] + w[2]) / 3.0
}

/// `F` over a face that is not plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FaceForm {
    pub(crate) p: [DVec3; 3],
    pub(crate) base: Base,
    /// On the positive and on the negative side of the mesh.
    pub(crate) sides: [Option<FaceSide>; 2],
}

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SurfacePoint {
    /// Position.
    pub position: DVec3,
    /// Gradient of `F`: towards the positive side, not of unit length.
    pub gradient: DVec3,
    /// Parameter on the ray from the mesh to the apex.
    pub t: f64,
    /// Whether the ray has a minimal root that is simple.
    pub simple: bool,
}

impl SurfacePoint {
    /// Unit normal.
    pub fn normal(&self) -> DVec3 {
        self.gradient.normalize_or_zero()
    }
}

impl FaceForm {
    /// The side on which the surface lies over `q`, given `L₀(q)`.
    #[inline]
    pub(crate) fn side(&self, l0: f64) -> Option<&FaceSide> {
        match &self.sides {
            [Some(above), Some(below)] => Some(if l0 <= 0.0 { above } else { below }),
            [Some(side), None] | [None, Some(side)] => Some(side),
            [None, None] => None,
        }
    }

    /// The shooting polynomial on a side.
    #[inline]
    pub(crate) fn shooting(&self, side: &FaceSide, q: [f64; 3], l0: f64) -> Shooting {
        let l1 = dot(apply(&side.l1(), q), q);
        Shooting([l0, l1, dot(side.r, q), side.b].map(|c| side.sign * c))
    }

    pub(crate) fn foot(&self, q: [f64; 3]) -> DVec3 {
        self.p[0] * q[0] + self.p[1] * q[1] + self.p[2] * q[2]
    }

    /// The surface over the point of barycentric coordinates `q`.
    #[inline]
    pub(crate) fn point(&self, q: [f64; 3]) -> SurfacePoint {
        let (l0, g0) = self.base.gradient(q);
        let Some(side) = self.side(l0) else { return SurfacePoint::default() };
        let line = apply(&side.l1(), q);
        let (l1, l2) = (dot(line, q), dot(side.r, q));
        let root = Shooting([l0, l1, l2, side.b].map(|c| side.sign * c)).root();
        let (t, s) = (root.t, 1.0 - root.t);
        // The layers are homogeneous: those at (1 − t) q are powers of 1 − t times those at q.
        let d = [0, 1, 2].map(|i| s * s * g0[i] + 6.0 * t * s * line[i] + 3.0 * t * t * side.r[i]);
        let dt = 3.0 * s * s * l1 + 6.0 * t * s * l2 + 3.0 * t * t * side.b;
        let g = &side.gradients;
        SurfacePoint {
            position: self.foot(q) * s + side.apex * t,
            gradient: g[0] * d[0] + g[1] * d[1] + g[2] * d[2] + g[3] * dt,
            t,
            simple: root.simple,
        }
    }
}
