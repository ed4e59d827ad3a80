//! Surfaces made of analytic patches.
#![allow(dead_code, unreachable_pub)]

use glam::{DVec2, DVec3};
use suture_bernstein::{BezierCurve, Jet2};
use suture_surface::{
    Continuity, Domain, EdgeRef, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
};

/// A map from parameters into space.
#[derive(Clone, Debug)]
pub enum Map {
    /// `o + u a + v b`.
    Affine([DVec3; 3]),
    /// Bilinear in the four corners (lower left, lower right, upper right, upper left) on `[0, 1]²`.
    Bilinear([DVec3; 4]),
    /// `o + x a + y b` with `(x, y)` between two curves: the first at `v = 0`, the second at `v = 1`.
    Ruled([DVec3; 3], Box<[BezierCurve<DVec2>; 2]>),
    /// A torus of radii 1 and 0.4, both parameters in turns.
    Torus,
    /// The unit sphere, longitude in turns, latitude in radians.
    Globe,
    /// The graph of a bump over the plane.
    Bump,
}

impl Map {
    fn jet(&self, at: DVec2) -> Jet2 {
        let (u, v) = (at.x, at.y);
        match self {
            Self::Affine([o, a, b]) => Jet2 { p: *o + *a * u + *b * v, du: *a, dv: *b, ..Jet2::default() },
            Self::Bilinear([a, b, c, d]) => {
                let (s, t) = (1.0 - u, 1.0 - v);
                Jet2 {
                    p: (*a * s + *b * u) * t + (*d * s + *c * u) * v,
                    du: (*b - *a) * t + (*c - *d) * v,
                    dv: (*d - *a) * s + (*c - *b) * u,
                    duv: *a - *b + *c - *d,
                    ..Jet2::default()
                }
            }
            Self::Ruled([o, a, b], curves) => {
                let [p, q] = [0, 1].map(|i| curves[i].jet::<3>(u));
                let mix = |i: usize| p[i] * (1.0 - v) + q[i] * v;
                let space = |d: DVec2| *a * d.x + *b * d.y;
                Jet2 {
                    p: *o + space(mix(0)),
                    du: space(mix(1)),
                    dv: space(q[0] - p[0]),
                    duu: space(mix(2)),
                    duv: space(q[1] - p[1]),
                    dvv: DVec3::ZERO,
                }
            }
            Self::Torus => {
                let tau = std::f64::consts::TAU;
                let ((s, c), (sv, cv)) = ((u * tau).sin_cos(), (v * tau).sin_cos());
                let (e, e1) = (DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0));
                let rho = 1.0 + 0.4 * cv;
                Jet2 {
                    p: e * rho + DVec3::Z * (0.4 * sv),
                    du: e1 * (rho * tau),
                    dv: (e * -sv + DVec3::Z * cv) * (0.4 * tau),
                    duu: e * (-rho * tau * tau),
                    duv: e1 * (-0.4 * sv * tau * tau),
                    dvv: (e * cv + DVec3::Z * sv) * (-0.4 * tau * tau),
                }
            }
            Self::Globe => {
                let tau = std::f64::consts::TAU;
                let ((s, c), (sv, cv)) = ((u * tau).sin_cos(), v.sin_cos());
                let (e, e1) = (DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0));
                Jet2 {
                    p: e * cv + DVec3::Z * sv,
                    du: e1 * (cv * tau),
                    dv: e * -sv + DVec3::Z * cv,
                    duu: e * (-cv * tau * tau),
                    duv: e1 * (-sv * tau),
                    dvv: e * -cv - DVec3::Z * sv,
                }
            }
            Self::Bump => {
                let g = 0.5 * (-4.0 * at.length_squared()).exp();
                let z = |f: f64| DVec3::Z * (g * f);
                Jet2 {
                    p: DVec3::new(u, v, g),
                    du: DVec3::X + z(-8.0 * u),
                    dv: DVec3::Y + z(-8.0 * v),
                    duu: z(64.0 * u * u - 8.0),
                    duv: z(64.0 * u * v),
                    dvv: z(64.0 * v * v - 8.0),
                }
            }
        }
    }
}

/// A map on a domain, projected to the unit sphere if `sphere` is set, then scaled.
#[derive(Clone, Debug)]
pub struct Mapped {
    pub domain: Domain,
    pub map: Map,
    pub sphere: bool,
    pub scale: f64,
    pub kind: PatchKind,
}

impl Patch for Mapped {
    fn domain(&self) -> Domain {
        self.domain.clone()
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let jet = self.map.jet(at);
        let jet = if self.sphere { on_sphere(&jet) } else { jet };
        jet.map(|x| x * self.scale)
    }

    fn kind(&self) -> PatchKind {
        self.kind
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        Record { kind: "test".into(), data: serde_json::Value::Null }
    }
}

/// The jet of `q / |q|`: differentiates `p r = q` and `r² = q·q`.
fn on_sphere(q: &Jet2) -> Jet2 {
    let r = q.p.length();
    let p = q.p / r;
    let (ru, rv) = (p.dot(q.du), p.dot(q.dv));
    let (du, dv) = ((q.du - p * ru) / r, (q.dv - p * rv) / r);
    let second = |qab: DVec3, qa: DVec3, qb: DVec3, ra: f64, rb: f64, pa: DVec3, pb: DVec3| {
        let rab = (qa.dot(qb) + q.p.dot(qab) - ra * rb) / r;
        (qab - pa * rb - pb * ra - p * rab) / r
    };
    Jet2 {
        p,
        du,
        dv,
        duu: second(q.duu, q.du, q.du, ru, ru, du, du),
        duv: second(q.duv, q.du, q.dv, ru, rv, du, dv),
        dvv: second(q.dvv, q.dv, q.dv, rv, rv, dv, dv),
    }
}

pub const UNIT: Domain = Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE };

/// Pairs all edges that run against each other in space and builds the surface, scaled.
pub fn sew(mut patches: Vec<Mapped>, scale: f64) -> Surface {
    patches.iter_mut().for_each(|p| p.scale = 1.0);
    let mut edges = Vec::new();
    for (p, patch) in patches.iter().enumerate() {
        for e in 0..patch.domain.edge_count() {
            let at = [0.0, 0.3, 0.7, 1.0].map(|t| patch.jet(patch.domain.edge(e).unwrap().point(t)).p);
            edges.push((EdgeRef { patch: PatchId(p as u32), edge: e as u32 }, at));
        }
    }
    let mut seams = Vec::new();
    let mut taken = vec![false; edges.len()];
    for i in 0..edges.len() {
        let near = |a: DVec3, b: DVec3| a.distance(b) < 1e-9;
        let other = (i + 1..edges.len())
            .find(|&j| !taken[j] && (0..4).all(|k| near(edges[i].1[k], edges[j].1[3 - k])));
        let collapsed = near(edges[i].1[0], edges[i].1[1]);
        if let (false, false, Some(j)) = (taken[i], collapsed, other) {
            taken[i] = true;
            taken[j] = true;
            seams.push(Seam::new(edges[i].0, edges[j].0, Continuity::C2));
        }
    }
    patches.iter_mut().for_each(|p| p.scale = scale);
    Surface::new(patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect(), seams).unwrap()
}

pub fn patch(domain: Domain, map: Map, sphere: bool, kind: PatchKind) -> Mapped {
    Mapped { domain, map, sphere, scale: 1.0, kind }
}

/// Outward normal, `a` and `b` (right-handed) of the faces of a cube.
pub fn cube_frames() -> [[DVec3; 3]; 6] {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    [[x, y, z], [y, z, x], [z, x, y], [-x, z, y], [-y, x, z], [-z, y, x]]
}

/// The unit sphere in six rectangles.
pub fn cube_sphere(scale: f64) -> Surface {
    let domain = Domain::Rectangle { min: -DVec2::ONE, max: DVec2::ONE };
    let faces = cube_frames().map(|f| patch(domain.clone(), Map::Affine(f), true, PatchKind::Trimmed));
    sew(faces.to_vec(), scale)
}

/// The unit sphere laid out as a reconstruction is: six trimmed patches, twelve arcs of `pieces` strips, eight 3-blends that touch the
/// trimmed patches in single points; and, in the first face, a hole with curved edges that five rectangles and a pentagon fill.
pub fn blended_sphere(pieces: usize, scale: f64) -> Surface {
    let inset = 0.8;
    let mut patches = Vec::new();
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec2::new(x, y) * inset);
    let frames = cube_frames();
    let line = |a: DVec2, b: DVec2| {
        BezierCurve::new((0..4).map(|i| if i == 3 { b } else { a.lerp(b, i as f64 / 3.0) }).collect())
            .unwrap()
    };
    for (f, frame) in frames.iter().enumerate() {
        let knot = |e: usize, k: usize| {
            let (a, b) = (square[e % 4], square[(e + 1) % 4]);
            if k == pieces { b } else { a.lerp(b, k as f64 / pieces as f64) }
        };
        let mut loops = vec![
            (0..4)
                .flat_map(|e| (0..pieces).map(move |k| (e, k)))
                .map(|(e, k)| line(knot(e, k), knot(e, k + 1)))
                .collect::<Vec<_>>(),
        ];
        if f == 0 {
            let star = |i: usize, r: f64| {
                let (s, c) = (std::f64::consts::TAU * (i % 5) as f64 / 5.0).sin_cos();
                DVec2::new(c, s) * r
            };
            let (outer, inner) = (0.5, 0.2);
            // Arches between neighbouring corners of a pentagon.
            let arch = |i: usize| {
                vec![star(i, outer), star(i, outer) * 1.2, star(i + 1, outer) * 1.2, star(i + 1, outer)]
            };
            let mut hole = Vec::new();
            for i in (0..5).rev() {
                let mut net = arch(i);
                net.reverse();
                hole.push(BezierCurve::new(net).unwrap());
            }
            loops.push(hole);
            for i in 0..5 {
                let curves = [BezierCurve::new(arch(i)).unwrap(), line(star(i, inner), star(i + 1, inner))];
                // From the outer curve inwards the rectangle would be mirrored: swap the curves and run backwards.
                let back = curves.map(|c| BezierCurve::new(c.net().iter().rev().copied().collect()).unwrap());
                let [o, i] = back;
                patches.push(patch(
                    UNIT,
                    Map::Ruled(*frame, Box::new([i, o])),
                    true,
                    PatchKind::AdjacentStrip,
                ));
            }
            let corners = (0..5).map(|i| star(i, inner)).collect();
            patches.push(patch(
                Domain::Polygon(corners),
                Map::Affine(*frame),
                true,
                PatchKind::NBlend { n: 5 },
            ));
        }
        patches.push(patch(Domain::Trimmed(loops), Map::Affine(*frame), true, PatchKind::Trimmed));
    }
    let space = |f: usize, p: DVec2| frames[f][0] + frames[f][1] * p.x + frames[f][2] * p.y;
    // The strips: every pair of face edges that face each other across a cube edge.
    for f in 0..6 {
        for e in 0..4 {
            let (a, b) = (space(f, square[e]), space(f, square[(e + 1) % 4]));
            let across = frames[f][1] * (square[e] + square[(e + 1) % 4]).x / 2.0
                + frames[f][2] * (square[e] + square[(e + 1) % 4]).y / 2.0;
            let g = (0..6).find(|&g| frames[g][0].dot(across) > 0.5 * inset).unwrap();
            if g < f {
                continue;
            }
            // Mirror image across the plane between the two faces.
            let n = (frames[f][0] - frames[g][0]).normalize();
            let mirror = |p: DVec3| p - n * (2.0 * n.dot(p));
            for k in 0..pieces {
                let at = |k: usize| a.lerp(b, k as f64 / pieces as f64);
                let (p, q) = (at(k), at(k + 1));
                let kind = if k == 0 || k + 1 == pieces {
                    PatchKind::AdjacentStrip
                } else {
                    PatchKind::Strip { odd: k % 2 == 1 }
                };
                // The face is on the left of its edge, the strip on the right.
                patches.push(patch(UNIT, Map::Bilinear([q, p, mirror(p), mirror(q)]), true, kind));
            }
        }
    }
    for s in 0..8 {
        let sign = |bit: usize| if s >> bit & 1 == 1 { -1.0 } else { 1.0 };
        let c = DVec3::new(sign(0), sign(1), sign(2));
        let corner = |axis: usize| {
            let mut p = c * inset;
            p[axis] = c[axis];
            p
        };
        let mut r = [corner(0), corner(1), corner(2)];
        if (r[1] - r[0]).cross(r[2] - r[0]).dot(c) < 0.0 {
            r.swap(1, 2);
        }
        let corners = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
        let map = Map::Affine([r[0], r[1] - r[0], r[2] - r[0]]);
        patches.push(patch(Domain::Polygon(corners), map, true, PatchKind::NBlend { n: 3 }));
    }
    sew(patches, scale)
}

/// One patch of `map` on a rectangle, sewn to itself where its edges meet.
pub fn single(map: Map, min: DVec2, max: DVec2) -> Surface {
    sew(vec![patch(Domain::Rectangle { min, max }, map, false, PatchKind::Trimmed)], 1.0)
}

/// One trimmed patch of `map` bounded by polylines.
pub fn trimmed(map: Map, loops: &[Vec<[f64; 2]>]) -> Surface {
    let curves = loops
        .iter()
        .map(|l| {
            (0..l.len())
                .map(|i| BezierCurve::new(vec![l[i].into(), l[(i + 1) % l.len()].into()]).unwrap())
                .collect()
        })
        .collect();
    sew(vec![patch(Domain::Trimmed(curves), map, false, PatchKind::Trimmed)], 1.0)
}
