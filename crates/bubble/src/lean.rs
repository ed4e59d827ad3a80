//! Leans: what a patch adds to its base so that it leaves its sides to the inside.
//!
//! Seen along N, a patch leaves the side over `p(t)` to the inside where `y = N·(p′ × (L_d + D_d + h N_d)) > 0`. Where the curve of a needle's
//! side strays further than the needle is wide, `y` changes sign: tangent planes and curvatures are still those of the neighbour, but the
//! patch turns back over its own border. There its base gets one more part: `x Σ C(6, i) λ_a^{6−i} λ_b^i q_i`, `i` from 2 to 4, with the
//! coordinate `x` inward (on a quad `x (1 − x)²`), which vanishes twice on all other sides. What is added to a base changes no strip ([`crate::bend`]).

use glam::DVec3;

use crate::{
    network::{MeshEdge, Network},
    newton::horner,
    patch::BubblePatch,
    poly_mesh::PolyMesh,
    strip::Strip,
};

/// Least `y`, relative to that of the plane face seen along its normal.
const LEAST: f64 = 0.2;
/// Sides are looked at closely where a few samples fall below this.
const DOUBTFUL: f64 = 1.25 * LEAST;
/// Close samples of a side.
const SAMPLES: usize = 48;
/// Longest lean relative to the height of the face.
const LONGEST: f64 = 40.0;
/// Degree of a lean along its side.
const DEGREE: usize = 6;

/// Bernstein coefficients by side, none for sides that need nothing; empty where none does.
pub(crate) type Leans = Vec<Vec<DVec3>>;

impl BubblePatch {
    /// The leans that this patch needs.
    pub(crate) fn find_leans(&self) -> Leans {
        let leans: Leans = (0..self.count).map(|k| self.lean(k)).collect();
        if leans.iter().all(Vec::is_empty) { Vec::new() } else { leans }
    }

    fn lean(&self, side: usize) -> Vec<DVec3> {
        let half = self.half(if self.count == 3 { 2 * side } else { side });
        let strip = self.strip_of(&half);
        let sign = if half.against { -1.0 } else { 1.0 };
        let edge = self.corners[half.to] - self.corners[half.from];
        // y, the direction across in which it grows, and y of the plane face.
        let at = |lambda: f64| {
            let t = if half.against { 1.0 - lambda } else { lambda };
            let [x, y, z] = strip.curve_series::<2>(t);
            let along = DVec3::new(x[1], y[1], z[1]) * sign;
            let leaving = self.leaving::<2>(&half, lambda);
            let first = |s: &[[f64; 2]; 3]| DVec3::new(s[0][0], s[1][0], s[2][0]);
            let [[h]] = horner::<1, 1>(strip.level(0), t);
            let n = strip.normal(t);
            let leave = first(&leaving.base[0]) + h * first(&leaving.normal);
            let flat = edge.cross(self.leave(&half, lambda)[0].0).length() * n.length();
            (n.dot(along.cross(leave)), n.cross(along), flat)
        };
        let mut net = vec![DVec3::ZERO; DEGREE + 1];
        for (i, q) in net.iter_mut().enumerate().take(DEGREE - 1).skip(2) {
            let (_, across, flat) = at(i as f64 / DEGREE as f64);
            *q = across * (flat / across.length_squared());
        }
        // A lean has no say at the corners: what these leave is asked for beside them.
        let [start, end] = [0.0, 1.0].map(|lambda| {
            let (y, _, flat) = at(lambda);
            0.5 * y / flat
        });
        if !(start > 0.0 && end > 0.0) {
            return Vec::new();
        }
        let mut size = 0.0_f64;
        for i in 1..SAMPLES {
            let lambda = i as f64 / SAMPLES as f64;
            let (y, across, flat) = at(lambda);
            let goal = flat * (start * (1.0 - lambda) + end * lambda).min(LEAST);
            if y >= goal {
                continue;
            }
            let gain = value(&net, lambda).dot(across);
            let wanted = (goal - y) / gain;
            size = size.max(if wanted > 0.0 { wanted.min(LONGEST) } else { LONGEST });
        }
        net.iter_mut().for_each(|q| *q *= size);
        if size > 0.0 && net.iter().all(|q| q.is_finite()) { net } else { Vec::new() }
    }
}

/// `Σ C(6, i) (1 − λ)^{6−i} λ^i q_i`.
fn value(net: &[DVec3], lambda: f64) -> DVec3 {
    let rest = 1.0 - lambda;
    let terms = (2_i32..).zip(&net[2..DEGREE - 1]).map(|(i, &q)| {
        let c = suture_bernstein::bernstein::binomial(DEGREE, i as usize);
        q * (c * lambda.powi(i) * rest.powi(DEGREE as i32 - i))
    });
    terms.sum()
}

/// Whether leans that were read are such as are made here.
pub(crate) fn fit(leans: &[Vec<DVec3>], count: usize) -> bool {
    let zero = |q: &[DVec3]| q.iter().all(|q| *q == DVec3::ZERO);
    let one = |net: &Vec<DVec3>| {
        net.is_empty()
            || net.len() == DEGREE + 1
                && zero(&net[..2])
                && zero(&net[DEGREE - 1..])
                && net.iter().all(|q| q.is_finite())
    };
    leans.is_empty() || leans.len() == count && leans.iter().all(one)
}

/// The faces along an edge, and whether they may need leans there.
pub(crate) struct Beside {
    faces: [Option<Leave>; 2],
    doubts: [bool; 2],
    ends: [DVec3; 2],
}

/// How a face leaves an edge at its ends: directions of base and N.
#[derive(Clone, Copy)]
struct Leave {
    base: [DVec3; 2],
    normal: [DVec3; 2],
    sign: f64,
}

impl Beside {
    pub(crate) fn of(mesh: &PolyMesh, network: &Network, e: &MeshEdge, strip: &Strip) -> Self {
        let (ends, normals) = (strip.ends(), strip.normals());
        let leave = |u: &crate::EdgeUse| {
            let v = mesh.faces[u.face as usize].vertices();
            let (k, count) = (u.side as usize, v.len());
            let mut beside = [v[(k + count - 1) % count], v[(k + 2) % count]].map(|v| v as usize);
            if !u.forward {
                beside.swap(0, 1);
            }
            let of = |end: usize| {
                let w = beside[end];
                (mesh.positions[w] - ends[end], network.implicits[w].gradient() - normals[end])
            };
            let start = of(0);
            let end = if count == 3 { start } else { of(1) };
            let sign = if u.forward { 1.0 } else { -1.0 };
            Leave { base: [start.0, end.0], normal: [start.1, end.1], sign }
        };
        // Bends and edges with more faces are rare enough to be looked at closely.
        let closely = !strip.bend().is_empty() || e.faces.len() > 2;
        let looked = strip.order() > 0;
        let face = |i: usize| e.faces.get(i).filter(|_| looked && !closely).map(leave);
        Self { faces: [face(0), face(1)], doubts: [looked && closely; 2], ends }
    }

    /// Looks at `t`, where N is `n` and the boundary curve `p`.
    #[inline(always)]
    pub(crate) fn look(&mut self, t: f64, n: DVec3, p: &[DVec3; 3]) {
        let (s, chord) = (1.0 - t, self.ends[1] - self.ends[0]);
        let h = (p[0] - self.ends[0] * s - self.ends[1] * t).dot(n) / n.length_squared();
        for (face, doubt) in self.faces.iter().zip(&mut self.doubts) {
            let Some(f) = face else { continue };
            let base = f.base[0] * s + f.base[1] * t;
            let leave = base + h * (f.normal[0] * s + f.normal[1] * t);
            let y = f.sign * n.dot(p[1].cross(leave));
            let flat = chord.cross(base).length_squared() * n.length_squared();
            *doubt |= !(y > 0.0 && y * y > DOUBTFUL * DOUBTFUL * flat);
        }
    }

    /// Whether the face that is the `i`-th along the edge may need a lean.
    pub(crate) fn doubtful(&self, i: usize) -> bool {
        self.doubts[i.min(1)]
    }
}

#[cfg(test)]
mod tests {
    use crate::{BubbleOptions, BubbleWarning, Face, PolyMesh, bubble};
    use glam::{DVec2, DVec3};
    use suture_surface::Patch;

    /// A needle beside a triangle, its normals turned about its length: the curve of the long side strays over the third corner.
    fn needle() -> PolyMesh {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.004, 0.0], [0.5, -0.8, 0.0]];
        let normals = [[-0.4, 0.5, 0.8], [0.4, -0.5, 0.8], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
        let [positions, normals] = [positions, normals].map(|x| x.map(DVec3::from_array).to_vec());
        PolyMesh { positions, normals, faces: vec![Face::Triangle([0, 1, 2]), Face::Triangle([1, 0, 3])] }
    }

    #[test]
    fn a_needle_leaves_its_sides_to_the_inside() {
        let mesh = needle();
        for order in 1..5 {
            let s = bubble(&mesh, &BubbleOptions { order, ..Default::default() }).unwrap();
            let leaned = |w: &BubbleWarning| matches!(w, BubbleWarning::Leaned { first: 0, .. });
            assert!(s.report().warnings.iter().any(leaned), "{:?}", s.report().warnings);
            for i in 0..65 {
                let t = f64::from(i) / 64.0;
                let at = [DVec2::new(t, 0.0), DVec2::new(1.0 - t, 0.0)];
                let [a, b] = [0, 1].map(|f: usize| s.patches()[f].jet(at[f]).normal().unwrap());
                assert!(a.distance(b) < 1e-9, "{order} {t}: {a} {b}");
            }
        }
    }

    #[test]
    fn faces_that_need_none_get_none() {
        let mesh = suture_mesh::shapes::sphere(0);
        let poly = PolyMesh::from_triangles(&mesh, &mesh.positions).unwrap();
        let s = bubble(&poly, &BubbleOptions::default()).unwrap();
        assert!(s.patches().iter().all(|p| p.leans.is_empty() && p.find_leans().is_empty()));
    }
}
