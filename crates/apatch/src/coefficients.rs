//! The formulas that give coefficients of `F` from positions and gradients (specification, sections 1–5).
//!
//! Coefficients are named by the vertices they belong to: `e[a][b]` is `aab`, `h[a]` is `aaA`, `m[k]` is `abA` for the edge `ab`
//! opposite vertex `k`, with `A` the apex.

use glam::DVec3;

/// The two ends of the edge opposite vertex `k`, in the order of the face.
pub(crate) const EDGE: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// `α(x; a, b) = 2 − 3 σ`, `σ` the parameter of the foot of `x` on the line from `a` to `b`.
pub(crate) fn alpha(x: DVec3, a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    (2.0 * (x - b) + (x - a)).dot(d) / d.length_squared()
}

/// `abX`: the coefficient of `6 x_a x_b x_X` that makes the derivative across the edge `ab` vary linearly along it, given `aaX` and
/// `bbX`. Affine in `x`.
pub(crate) fn across(x: DVec3, [a, b]: [DVec3; 2], ends: [f64; 2], along: [f64; 2]) -> f64 {
    let alpha = alpha(x, a, b);
    0.5 * (ends[0] + ends[1] + alpha * along[0] + (1.0 - alpha) * along[1])
}

/// Positions, gradients and the six coefficients on the edges of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners {
    pub(crate) p: [DVec3; 3],
    pub(crate) g: [DVec3; 3],
    pub(crate) e: [[f64; 3]; 3],
}

impl Corners {
    /// `e_ab = ⅓ (p_b − p_a)·g_a`, replaced by exactly 0 where that is below `snap` of its factors.
    pub(crate) fn new(p: [DVec3; 3], g: [DVec3; 3], snap: f64) -> Self {
        let mut e = [[0.0; 3]; 3];
        for a in 0..3 {
            for b in 0..3 {
                if a != b {
                    let d = p[b] - p[a];
                    let value = d.dot(g[a]) / 3.0;
                    let kept = (3.0 * value).abs() > snap * d.length() * g[a].length();
                    e[a][b] = if kept { value } else { 0.0 };
                }
            }
        }
        Self { p, g, e }
    }

    /// `h_a` for an apex.
    pub(crate) fn h(&self, apex: DVec3) -> [f64; 3] {
        [0, 1, 2].map(|a| (apex - self.p[a]).dot(self.g[a]) / 3.0)
    }

    /// `m_k` for an apex.
    pub(crate) fn m(&self, apex: DVec3, h: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let [a, b] = EDGE[k];
            across(apex, [self.p[a], self.p[b]], [h[a], h[b]], [self.e[a][b], self.e[b][a]])
        })
    }

    /// The gradients of the `m_k`, affine functions of the apex.
    pub(crate) fn m_gradients(&self) -> [DVec3; 3] {
        EDGE.map(|[a, b]| {
            let (d, g) = (self.p[b] - self.p[a], self.g[a] + self.g[b]);
            // From α too, that is from e_ab − e_ba, snapped or not.
            g / 6.0 - d * (1.5 * (self.e[a][b] - self.e[b][a]) / d.length_squared())
        })
    }

    /// `w_k`: what the coefficient `012` would have to be for a linear derivative across the edge opposite vertex `k`.
    pub(crate) fn w(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let [a, b] = EDGE[k];
            let e = &self.e;
            across(self.p[k], [self.p[a], self.p[b]], [e[a][k], e[b][k]], [e[a][b], e[b][a]])
        })
    }

    pub(crate) fn centroid(&self) -> DVec3 {
        (self.p[0] + self.p[1] + self.p[2]) / 3.0
    }
}

/// The quadratic that comes closest to the coefficients of layers 0 and 1 (Equation (4.13)), its coefficient at the apex left open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadric {
    /// `aa`, `bb`, `cc`.
    pub(crate) corner: [f64; 3],
    /// `bc`, `ca`, `ab`.
    pub(crate) edge: [f64; 3],
    /// `aA`, `bA`, `cA`.
    pub(crate) side: [f64; 3],
}

impl Quadric {
    /// Pseudo-inverse of the 16 × 9 system in closed form; `inner` is the coefficient `012`.
    pub(crate) fn fit(e: &[[f64; 3]; 3], h: &[f64; 3], m: &[f64; 3], inner: f64) -> Self {
        let per = |f: &dyn Fn(usize, usize, usize) -> f64| [f(0, 1, 2), f(1, 2, 0), f(2, 0, 1)];
        // a: the corner; b, c: the others.
        let corner = per(&|a, b, c| {
            (15.0 * (e[a][b] + e[a][c]) - 7.0 * (e[b][a] + e[c][a] + inner)
                + e[b][c]
                + e[c][b]
                + 9.0 * (h[a] - m[b] - m[c])
                + 3.0 * (h[b] + h[c] + m[a]))
                / 80.0
        });
        let edge = per(&|a, b, c| {
            (-3.0 * (e[a][b] + e[a][c]) - 7.0 * (e[b][a] + e[c][a])
                + 49.0 * (e[b][c] + e[c][b])
                + 23.0 * inner
                + 3.0 * (h[a] - m[b] - m[c])
                - 9.0 * (h[b] + h[c])
                + 21.0 * m[a])
                / 80.0
        });
        let side = per(&|a, b, c| {
            (21.0 * h[a] - 3.0 * (h[b] + h[c] + m[a] + e[a][b] + e[a][c]) + 9.0 * (m[b] + m[c])
                - (e[b][a] + e[c][a] + inner)
                + e[b][c]
                + e[c][b])
                / 20.0
        });
        Self { corner, edge, side }
    }

    /// Value and derivatives along the barycentric coordinates at `(x₀, x₁, x₂, t)`, the coefficient at the apex taken as 0.
    pub(crate) fn gradient(&self, x: [f64; 4]) -> (f64, [f64; 4]) {
        let [q0, q1, q2] = self.corner;
        let [s0, s1, s2] = self.edge;
        let r = self.side;
        let line = [
            q0 * x[0] + s2 * x[1] + s1 * x[2] + r[0] * x[3],
            s2 * x[0] + q1 * x[1] + s0 * x[2] + r[1] * x[3],
            s1 * x[0] + s0 * x[1] + q2 * x[2] + r[2] * x[3],
            r[0] * x[0] + r[1] * x[1] + r[2] * x[2],
        ];
        let value = line[0] * x[0] + line[1] * x[1] + line[2] * x[2] + line[3] * x[3];
        (value, line.map(|l| 2.0 * l))
    }
}

/// The coefficient at the apex of the linear function that comes closest (Equation (4.16) with `Σ λ = 2`): the paper's default.
pub(crate) fn paper_default(e: &[[f64; 3]; 3], h: &[f64; 3], m: &[f64; 3], inner: f64) -> f64 {
    let all: f64 = e[0][1] + e[0][2] + e[1][0] + e[1][2] + e[2][0] + e[2][1];
    0.5 * (h[0] + h[1] + h[2] + m[0] + m[1] + m[2]) - 0.2 * (all + inner)
}

/// Gradients of the barycentric coordinates of a tetrahedron, vertex by vertex. Not finite when it is flat.
pub(crate) fn barycentric_gradients(v: &[DVec3; 4]) -> [DVec3; 4] {
    let [a, b, c] = [v[0] - v[3], v[1] - v[3], v[2] - v[3]];
    let volume = a.cross(b).dot(c);
    let (ga, gb, gc) = (b.cross(c) / volume, c.cross(a) / volume, a.cross(b) / volume);
    [ga, gb, gc, -(ga + gb + gc)]
}

/// Barycentric coordinates of `x` with respect to a tetrahedron given by its last vertex and the gradients.
pub(crate) fn barycentric(x: DVec3, last: DVec3, gradients: &[DVec3; 4]) -> [f64; 4] {
    let d = x - last;
    let [a, b, c] = [gradients[0].dot(d), gradients[1].dot(d), gradients[2].dot(d)];
    [a, b, c, 1.0 - a - b - c]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn m_grows_along_its_gradient(
            p in prop::array::uniform3(vector()), g in prop::array::uniform3(vector()), x in vector(), d in vector(),
        ) {
            let corners = Corners::new(p, g, 1e-12);
            let m = |x: DVec3| corners.m(x, &corners.h(x));
            let scale = 1.0 + EDGE.iter().fold(0.0_f64, |s, &[a, b]| s.max(1.0 / p[a].distance(p[b])));
            for k in 0..3 {
                let slope = d.dot(corners.m_gradients()[k]);
                prop_assert!((m(x + d)[k] - m(x)[k] - slope).abs() < 1e-12 * scale * scale);
            }
        }
    }
}
