//! Control nets of splined patches.

use glam::{DVec2, DVec3};
use suture_bernstein::BSplineSurface;
use suture_surface::Jet2;

use super::{patch::SplinePatch, pieces::Pieces};
use crate::{BubbleError, hermite::Hermite};

/// A tensor-product B-spline patch in homogeneous coordinates, over the square around the patch's domain: polynomial, or rational over the
/// triangle `u, v ≥ 0`, `u + v ≤ 1`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct HomogeneousSpline {
    /// Control points times weights.
    pub points: BSplineSurface<DVec3>,
    /// Weights over the same knots; `None` where all are 1. On triangles they are those of `((1 − u)(1 − v))^{2n+1}`: positive but at `u = 1`
    /// and `v = 1`, where two corners of the triangle are base points; trim a little inside of them.
    pub weights: Option<BSplineSurface<f64>>,
}

impl HomogeneousSpline {
    /// The jet at `at`; not finite at base points.
    pub fn jet(&self, at: DVec2) -> Jet2 {
        let p = self.points.jet(at);
        let Some(w) = self.weights.as_ref().map(|w| w.jet(at)) else { return p };
        let q = p.p / w.p;
        let (du, dv) = ((p.du - q * w.du) / w.p, (p.dv - q * w.dv) / w.p);
        Jet2 {
            p: q,
            du,
            dv,
            duu: (p.duu - 2.0 * w.du * du - w.duu * q) / w.p,
            duv: (p.duv - w.du * dv - w.dv * du - w.duv * q) / w.p,
            dvv: (p.dvv - 2.0 * w.dv * dv - w.dvv * q) / w.p,
        }
    }
}

/// One more than the largest total degree of a bend: `4n + 3` along its side, one more across a quad.
const BEND_TERMS: usize = 13;

/// One term `f(u) g(v)` of a sum.
type Term = (Pieces, Pieces);

impl SplinePatch {
    /// The patch as a B-spline surface: rational over a triangle, polynomial over a quad; C² across its knots. A bent base (beside creases) adds
    /// its own degree, `4n + 1` with curved creases, to that of the weight or of the blend across.
    ///
    /// # Errors
    /// [`BubbleError::NotFinitePatch`] when numbers overflow.
    pub fn bspline(&self) -> Result<HomogeneousSpline, BubbleError> {
        let patch = &self.exact;
        let k = self.intervals;
        let n = patch.order;
        let (height, weight) = if patch.count == 3 { self.triangle() } else { (self.quad(), None) };
        let one = Pieces::constant(k, 1.0);
        let weight = weight.unwrap_or_else(|| (one.clone(), one.clone()));
        // 1, u, v, uv, and the coefficients of L and N in them.
        let t = Pieces::linear(k, 0.0, 1.0);
        let monomials = [(&one, &one), (&t, &one), (&one, &t), (&t, &t)];
        let coefficients = |x: &[DVec3; 4]| {
            if patch.count == 3 {
                [x[0], x[1] - x[0], x[2] - x[0], DVec3::ZERO]
            } else {
                [x[0], x[1] - x[0], x[3] - x[0], x[2] - x[1] - x[3] + x[0]]
            }
        };
        let (base, normal) = (coefficients(&patch.corners), coefficients(&patch.normals));
        let mut terms: Vec<(Pieces, Pieces, DVec3)> = Vec::new();
        for (m, (a, b)) in monomials.iter().enumerate() {
            if base[m] != DVec3::ZERO {
                terms.push((weight.0.mul(a), weight.1.mul(b), base[m]));
            }
            for (f, g) in &height {
                if normal[m] != DVec3::ZERO {
                    terms.push((f.mul(a), g.mul(b), normal[m]));
                }
            }
        }
        if patch.bent() {
            let bends = patch.bend_taylor::<BEND_TERMS>(DVec2::ZERO);
            let powers: Vec<Pieces> = (0..BEND_TERMS).map(|i| t.power(i)).collect();
            for i in 0..BEND_TERMS {
                for j in 0..BEND_TERMS - i {
                    let c = DVec3::from_array([0, 1, 2].map(|axis| bends[axis].0[i][j]));
                    if c != DVec3::ZERO {
                        terms.push((weight.0.mul(&powers[i]), weight.1.mul(&powers[j]), c));
                    }
                }
            }
        }
        let degree = |d: fn(&(Pieces, Pieces, DVec3)) -> usize| terms.iter().map(d).max().unwrap_or(0);
        let most = degree(|t| t.0.degree()).max(degree(|t| t.1.degree())).max(3);
        let knots = Pieces::knots(most, k);
        let count = knots.len() - most - 1;
        let mut net = vec![DVec3::ZERO; count * count];
        for (f, g, c) in &terms {
            let (f, g) = (f.elevate(most).spline(), g.elevate(most).spline());
            for (row, &f) in net.chunks_exact_mut(count).zip(&f) {
                for (p, &g) in row.iter_mut().zip(&g) {
                    *p += *c * (f * g);
                }
            }
        }
        let bad = |_| BubbleError::NotFinitePatch { face: 0 };
        let points = BSplineSurface::new([most; 2], [knots.clone(), knots.clone()], net).map_err(bad)?;
        let weights = if patch.count == 3 && (n > 0 || !height.is_empty()) {
            let (f, g) = (weight.0.elevate(most).spline(), weight.1.elevate(most).spline());
            let net = f.iter().flat_map(|f| g.iter().map(move |g| f * g)).collect();
            Some(BSplineSurface::new([most; 2], [knots.clone(), knots], net).map_err(bad)?)
        } else {
            None
        };
        Ok(HomogeneousSpline { points, weights })
    }

    /// `h` times `((1 − u)(1 − v))^{2n+1}`, and that weight.
    fn triangle(&self) -> (Vec<Term>, Option<Term>) {
        let (n, k) = (self.exact.order, self.intervals);
        let hermite = Hermite::new(n);
        let (t, s) = (Pieces::linear(k, 0.0, 1.0), Pieces::linear(k, 1.0, 0.0));
        let powers: Vec<Pieces> = (0..3 * n + 2).map(|i| s.power(i)).collect();
        let mut terms = Vec::new();
        // Σ_q of v^q w^{i−q} c_q, times w^{2n+1}: what stands before v^q for all data along u, and the like across.
        for q in 0..2 * n + 2 {
            let (mut along_u, mut along_v): (Option<Pieces>, Option<Pieces>) = (None, None);
            for (h, data) in &self.data {
                let half = self.exact.half(*h);
                let [_, twist] = self.exact.weights(&half);
                // Halves towards corner 1 run along u; of them the one from corner 2 enters with s = 1 − x/w.
                let (sum, end, sign) = match (half.from, half.to) {
                    (0, 1) => (&mut along_u, 0, 1.0),
                    (2, 1) => (&mut along_u, 1, -1.0),
                    _ => (&mut along_v, 0, 1.0),
                };
                for (i, datum) in data.iter().enumerate() {
                    let c = hermite.basis[end][i][q];
                    // i + 2n + 1 ≥ q always.
                    let Some(power) = powers.get(i + 2 * n + 1 - q).filter(|_| c != 0.0) else { continue };
                    let mut e = datum.pieces(k);
                    if twist != 0.0 && n > 0 {
                        let row = &self.exact.twists[(h * (n + 1) + i) * (2 * n + 2)..][..2 * n + 2];
                        e = e.add(&Pieces::polynomial(k, row).scale(-twist));
                    }
                    let c = if i % 2 == 1 { c * sign } else { c };
                    let part = e.mul(power).scale(c);
                    *sum = Some(sum.take().map_or_else(|| part.clone(), |s| s.add(&part)));
                }
            }
            let across = t.power(q).mul(&s.power(2 * n + 1));
            terms.extend(along_u.map(|f| (f, across.clone())));
            terms.extend(along_v.map(|f| (across, f)));
        }
        let w = s.power(2 * n + 1);
        (terms, Some((w.clone(), w)))
    }

    fn quad(&self) -> Vec<Term> {
        let (n, k) = (self.exact.order, self.intervals);
        let hermite = Hermite::new(n);
        let mut terms = Vec::new();
        for (h, data) in &self.data {
            let half = self.exact.half(*h);
            let [_, twist] = self.exact.weights(&half);
            for (i, datum) in data.iter().enumerate() {
                let mut e = datum.pieces(k);
                if n > 0 {
                    let row = &self.exact.twists[(h * (n + 1) + i) * (2 * n + 2)..][..2 * n + 2];
                    e = e.add(&Pieces::polynomial(k, row).scale(-twist));
                }
                let inward = Pieces::polynomial(k, &hermite.basis[0][i][..2 * n + 2]);
                terms.push(match half.side {
                    0 => (e, inward),
                    1 => (inward.reverse(), e),
                    2 => (e.reverse(), inward.reverse()),
                    _ => (inward, e.reverse()),
                });
            }
        }
        terms
    }
}
