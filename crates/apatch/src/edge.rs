//! `F` on the one or two tetrahedra of an edge (specification, section 5).

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::coefficients::{EDGE, barycentric, barycentric_gradients};
use crate::cubic::dot;
use crate::face::{FaceSide, SurfacePoint};
use crate::shooting::Shooting;

/// `F` along an edge `p_i p_j` between two faces: unprimed on its left, primed on its right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EdgeForm {
    /// `p_i`, `p_j`.
    pub(crate) p: [DVec3; 2],
    /// `e_ij`, `e_ji`.
    pub(crate) e: [f64; 2],
    /// On the positive and on the negative side of the mesh.
    pub(crate) sides: [Option<EdgeSide>; 2],
}

/// The tetrahedron `[u' p_i p_j u]` of an edge on one side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EdgeSide {
    pub(crate) sign: f64,
    /// Apexes `u'` (of the primed face) and `u`.
    pub(crate) apex: [DVec3; 2],
    /// `B₁` as a net: quadratic along the edge, linear from `u'` to `u`: `(h'_i, m', h'_j)` and `(h_i, m, h_j)`.
    pub(crate) b1: [[f64; 3]; 2],
    /// `B₂` as a net: linear along the edge, cubic from `u'` to `u`.
    pub(crate) b2: [[f64; 4]; 2],
    /// `B₃`, cubic from `u'` to `u`: `b'`, `S'`, `S`, `b`.
    pub(crate) b3: [f64; 4],
    /// `a_i`, `a_j` and `b_i`, `b_j`.
    pub(crate) ab: [[f64; 2]; 2],
    /// Coordinates `(k, i, j, u)` of `u'` in the unprimed tetrahedron.
    pub(crate) mu: [f64; 4],
    /// Coordinates `(l, i, j, u')` of `u` in the primed tetrahedron.
    pub(crate) nu: [f64; 4],
    /// Gradients of the coordinates of `u'`, `p_i`, `p_j`, `u`.
    pub(crate) gradients: [DVec3; 4],
}

impl EdgeSide {
    /// From the tetrahedra of the two faces and the numbers there of their vertices opposite the edge; `p` are its ends.
    pub(crate) fn new(p: [DVec3; 2], (f, k): (&FaceSide, usize), (g, l): (&FaceSide, usize)) -> Self {
        let [i, j] = EDGE[k];
        // The primed face runs through the edge the other way.
        let [jj, ii] = EDGE[l];
        let mu = f.barycentric(g.apex);
        let nu = g.barycentric(f.apex);
        let mu = [mu[k], mu[i], mu[j], mu[3]];
        let nu = [nu[l], nu[ii], nu[jj], nu[3]];
        let dot4 = |a: &[f64; 4], b: [f64; 4]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        let b_i = dot4(&mu, [f.m[j], f.h[i], f.m[k], f.r[i]]);
        let b_j = dot4(&mu, [f.m[i], f.m[k], f.h[j], f.r[j]]);
        let a_i = dot4(&nu, [g.m[jj], g.h[ii], g.m[l], g.r[ii]]);
        let a_j = dot4(&nu, [g.m[ii], g.m[l], g.h[jj], g.r[jj]]);
        let s = dot4(&mu, [f.r[k], f.r[i], f.r[j], f.b]);
        let s_primed = dot4(&nu, [g.r[l], g.r[ii], g.r[jj], g.b]);
        let net = |r: f64, a: f64, b: f64, rr: f64| [rr, (rr + 2.0 * a) / 3.0, (r + 2.0 * b) / 3.0, r];
        Self {
            sign: f.sign,
            apex: [g.apex, f.apex],
            b1: [[g.h[ii], g.m[l], g.h[jj]], [f.h[i], f.m[k], f.h[j]]],
            b2: [net(f.r[i], a_i, b_i, g.r[ii]), net(f.r[j], a_j, b_j, g.r[jj])],
            b3: [g.b, s_primed, s, f.b],
            ab: [[a_i, a_j], [b_i, b_j]],
            mu,
            nu,
            gradients: barycentric_gradients(&[g.apex, p[0], p[1], f.apex]),
        }
    }

    /// Whether `B₁` is of the sign of the side all over the tetrahedron.
    pub(crate) fn rises(&self) -> bool {
        let all = self.b1.as_flattened();
        // Rounding may take something from an `m` that was made 0.
        let slack = 1e-12 * all.iter().fold(0.0_f64, |s, b| s.max(b.abs()));
        all.iter().all(|b| self.sign * b >= -slack)
    }

    /// How the shooting polynomials change when the weights of `u` and `u'` do: by `t²` times these.
    pub(crate) fn betas(&self, y: f64) -> [f64; 2] {
        let z = 1.0 - y;
        [y * y * (1.0 + 2.0 * self.mu[3] * z), z * z * (1.0 + 2.0 * self.nu[3] * y)]
    }

    /// Barycentric coordinates of a point, in the order `u'`, `p_i`, `p_j`, `u`.
    pub(crate) fn barycentric(&self, x: DVec3) -> [f64; 4] {
        barycentric(x, self.apex[1], &self.gradients)
    }

    /// `F` and its spatial gradient at barycentric coordinates `(z, x, y, t)` of `u'`, `p_i`, `p_j`, `u`.
    #[inline]
    pub(crate) fn value(&self, e: [f64; 2], [z, x, y, t]: [f64; 4]) -> (f64, DVec3) {
        let [hp, h] = self.b1;
        let form = |h: &[f64; 3]| {
            let (p, q) = (h[0] * x + h[1] * y, h[1] * x + h[2] * y);
            (p * x + q * y, 2.0 * p, 2.0 * q)
        };
        let ((bp, bpx, bpy), (b, bx, by)) = (form(&hp), form(&h));
        let (rpi, rpj, ri, rj) = (self.b2[0][0], self.b2[1][0], self.b2[0][3], self.b2[1][3]);
        let [[ai, aj], [bi, bj]] = self.ab;
        let [wp, sp, s, w] = self.b3;
        // z t/(z + t) and its derivatives; 0 on the edge itself.
        let (z0, t0) = (z.max(0.0), t.max(0.0));
        let sum = z0 + t0;
        let (rho, rho_z, rho_t) = if sum == 0.0 {
            (0.0, 0.0, 0.0)
        } else {
            (z0 * t0 / sum, (t0 / sum) * (t0 / sum), (z0 / sum) * (z0 / sum))
        };
        let (ci, cj) = (ai * z + bi * t, aj * z + bj * t);
        let mixed = x * ci + y * cj;
        let (rp, r) = (rpi * x + rpj * y, ri * x + rj * y);
        let value = 3.0 * x * y * (e[0] * x + e[1] * y)
            + 3.0 * (z * bp + t * b)
            + 3.0 * (z * z * rp + t * t * r)
            + 6.0 * rho * mixed
            + w * t * t * t
            + 3.0 * s * t * t * z
            + 3.0 * sp * t * z * z
            + wp * z * z * z;
        let dx = 3.0 * y * (2.0 * e[0] * x + e[1] * y)
            + 3.0 * (z * bpx + t * bx)
            + 3.0 * (z * z * rpi + t * t * ri)
            + 6.0 * rho * ci;
        let dy = 3.0 * x * (e[0] * x + 2.0 * e[1] * y)
            + 3.0 * (z * bpy + t * by)
            + 3.0 * (z * z * rpj + t * t * rj)
            + 6.0 * rho * cj;
        let dz = 3.0 * bp
            + 6.0 * z * rp
            + 6.0 * (rho_z * mixed + rho * (x * ai + y * aj))
            + 3.0 * (s * t * t + 2.0 * sp * t * z + wp * z * z);
        let dt = 3.0 * b
            + 6.0 * t * r
            + 6.0 * (rho_t * mixed + rho * (x * bi + y * bj))
            + 3.0 * (w * t * t + 2.0 * s * t * z + sp * z * z);
        let g = &self.gradients;
        (value, g[0] * dz + g[1] * dx + g[2] * dy + g[3] * dt)
    }
}

impl EdgeForm {
    /// The two coefficients `(e_ij, e_ji)` have opposite signs.
    pub(crate) fn is_nonconvex(&self) -> bool {
        self.e[0] * self.e[1] < 0.0
    }

    /// Where the patch of a nonconvex edge shrinks to a point: the parameter from `p_i` to `p_j` at which `B₀` changes its sign.
    pub(crate) fn pinch(e: [f64; 2]) -> Option<f64> {
        // Quotients of opposite signs: the sum cannot cancel. One may vanish beside the other.
        (e[0] * e[1] < 0.0).then(|| e[0] / (e[0] - e[1])).filter(|&x| x > 0.0 && x < 1.0)
    }

    /// `B₀` at parameter `xi` from `p_i` to `p_j`.
    #[inline]
    pub(crate) fn b0(&self, xi: f64) -> f64 {
        let x = 1.0 - xi;
        3.0 * x * xi * (self.e[0] * x + self.e[1] * xi)
    }

    /// The side on which the surface lies at `xi`.
    #[inline]
    pub(crate) fn side(&self, b0: f64) -> Option<&EdgeSide> {
        match &self.sides {
            [Some(above), Some(below)] => Some(if b0 <= 0.0 { above } else { below }),
            [Some(side), None] | [None, Some(side)] => Some(side),
            [None, None] => None,
        }
    }

    /// `B₁`, `B₂`, `B₃` at `(xi, y)`, not multiplied by the sign.
    #[inline]
    pub(crate) fn layers(side: &EdgeSide, xi: f64, y: f64) -> [f64; 3] {
        let (x, z) = (1.0 - xi, 1.0 - y);
        let quadratic = [x * x, 2.0 * x * xi, xi * xi];
        let cubic = [z * z * z, 3.0 * y * z * z, 3.0 * y * y * z, y * y * y];
        let dot4 = |c: &[f64; 4]| c[0] * cubic[0] + c[1] * cubic[1] + c[2] * cubic[2] + c[3] * cubic[3];
        [
            z * dot(side.b1[0], quadratic) + y * dot(side.b1[1], quadratic),
            x * dot4(&side.b2[0]) + xi * dot4(&side.b2[1]),
            dot4(&side.b3),
        ]
    }

    /// The shooting polynomial on a side.
    #[inline]
    pub(crate) fn shooting(&self, side: &EdgeSide, xi: f64, y: f64) -> Shooting {
        let [b1, b2, b3] = Self::layers(side, xi, y);
        Shooting([self.b0(xi), b1, b2, b3].map(|b| side.sign * b))
    }

    pub(crate) fn foot(&self, xi: f64) -> DVec3 {
        self.p[0] * (1.0 - xi) + self.p[1] * xi
    }

    /// The surface over the point `xi` of the edge towards the point `y` between `u'` (0) and `u` (1).
    #[inline]
    pub(crate) fn point(&self, xi: f64, y: f64) -> SurfacePoint {
        let Some(side) = self.side(self.b0(xi)) else { return SurfacePoint::default() };
        let root = self.shooting(side, xi, y).root();
        let (t, s) = (root.t, 1.0 - root.t);
        let (_, gradient) = side.value(self.e, [t * (1.0 - y), s * (1.0 - xi), s * xi, t * y]);
        let apex = side.apex[0] * (1.0 - y) + side.apex[1] * y;
        SurfacePoint { position: self.foot(xi) * s + apex * t, gradient, t, simple: root.simple }
    }
}
