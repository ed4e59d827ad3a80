//! One apex weight changed while the rest stands: rays over a face and along its edges, whose coefficients are computed once.
//!
//! Only `B₂` and `B₃` of a ray depend on the weight `b` of an apex, and by `b β t²` in all: `β = 1` over the face and a quadratic in the
//! place across for an edge (specification, section 5 and erratum 16). So a new weight costs one root per ray.

use std::sync::Arc;

use glam::DVec3;

use crate::edge::{EdgeForm, EdgeSide};
use crate::hull::opposite_vertex;
use crate::{ApatchError, ApatchSurface, Shooting, Side};

/// Rays that depend on one apex weight: over its face, then along the edges of the face. From [`ApatchSurface::weight_rays`].
#[derive(Clone, Debug)]
pub struct WeightRays {
    rays: Vec<WeightRay>,
}

/// A ray and its coefficients without the weight.
#[derive(Clone, Copy, Debug)]
struct WeightRay {
    foot: DVec3,
    rise: DVec3,
    shooting: Shooting,
    beta: f64,
}

impl WeightRays {
    /// Number of rays.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// The points of the surface for a weight (times the sign of the side), in the order of the rays, and whether each is on a ray with a
    /// simple minimal root.
    pub fn points(&self, weight: f64) -> impl ExactSizeIterator<Item = (DVec3, bool)> + '_ {
        self.rays.iter().map(move |ray| {
            let [b0, b1, b2, b3] = ray.shooting.0;
            let more = weight * ray.beta;
            let root = Shooting([b0, b1, b2 + more / 3.0, b3 + more]).root();
            (ray.foot + ray.rise * root.t, root.simple)
        })
    }
}

impl ApatchSurface {
    /// The rays on which the weight of an apex acts: `n` segments along every edge of the face, `m` across the patches of its edges. Over
    /// the face row by row (parallel to the edge from corner 0 to corner 1), then edge by edge, each along and then across; without
    /// those on which the surface lies on the other side. `None` if there is no such apex.
    pub fn weight_rays(&self, face: usize, side: Side, n: usize, m: usize) -> Option<WeightRays> {
        let form = self.faces.get(face)?.as_ref()?;
        let s = side.index();
        let one = form.sides[s].as_ref()?;
        let mut rays = Vec::new();
        let part = |i: usize, n: usize| i as f64 / n.max(1) as f64;
        let mut free = *one;
        free.set_weight(0.0);
        for j in 0..=n {
            for i in 0..=n - j {
                let q = [part(n - i - j, n), part(i, n), part(j, n)];
                let (l0, _) = form.base.gradient(q);
                if !form.side(l0).is_some_and(|at| at.sign == one.sign) {
                    continue;
                }
                let foot = form.foot(q);
                let shooting = form.shooting(&free, q, l0);
                rays.push(WeightRay { foot, rise: free.apex - foot, shooting, beta: 1.0 });
            }
        }
        for k in 0..3 {
            let edge = self.of_half[3 * face + k] as usize;
            let form = &self.edges[edge];
            let Some(along) = &form.sides[s] else { continue };
            // Which of the two apexes is that of the face.
            let left = self.topology.face(self.halves[edge]) as usize == face;
            let weight = one.sign * one.b;
            for i in 0..=n {
                for j in 0..=m {
                    let (xi, y) = (part(i, n), part(j, m));
                    if !form.side(form.b0(xi)).is_some_and(|at| at.sign == along.sign) {
                        continue;
                    }
                    let beta = along.betas(y)[usize::from(!left)];
                    let [b0, b1, b2, b3] = form.shooting(along, xi, y).0;
                    let shooting = Shooting([b0, b1, b2 - weight * beta / 3.0, b3 - weight * beta]);
                    let foot = form.foot(xi);
                    let apex = along.apex[0] * (1.0 - y) + along.apex[1] * y;
                    rays.push(WeightRay { foot, rise: apex - foot, shooting, beta });
                }
            }
        }
        Some(WeightRays { rays })
    }

    /// The same surface with another apex weight on one face (times the sign of the side), and the edges beside it adapted; nothing else is
    /// computed anew. Bounds are not enforced: compare with [`face_bound`](Self::face_bound).
    ///
    /// # Errors
    /// [`ApatchError::NoSuch`], [`ApatchError::Weight`].
    pub fn set_weight(&mut self, face: usize, side: Side, weight: f64) -> Result<(), ApatchError> {
        if !weight.is_finite() {
            return Err(ApatchError::Weight { face, value: weight });
        }
        let s = side.index();
        let count = self.faces.len();
        let missing = ApatchError::NoSuch { what: "face", index: face, count };
        let Some(Some(form)) = self.faces.get_mut(face) else { return Err(missing) };
        let Some(side) = Arc::make_mut(form).sides[s].as_mut() else { return Err(missing) };
        side.set_weight(side.sign * weight);
        for k in 0..3 {
            let edge = self.of_half[3 * face + k] as usize;
            let h = self.halves[edge];
            let Some(o) = self.topology.opposite(h) else { continue };
            let beside = [h, o].map(|h| {
                let form = self.faces[self.topology.face(h) as usize].as_deref();
                form.and_then(|form| form.sides[s])
            });
            let form: &mut EdgeForm = Arc::make_mut(&mut self.edges[edge]);
            if let ([Some(f), Some(g)], Some(_)) = (beside, &form.sides[s]) {
                let new = EdgeSide::new(form.p, (&f, opposite_vertex(h)), (&g, opposite_vertex(o)));
                form.sides[s] = Some(new);
            }
        }
        Ok(())
    }
}
