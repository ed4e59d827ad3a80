//! Patches with closed forms.
#![allow(dead_code, unreachable_pub)] // Every test file uses its part of this one.

use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3};
use suture_surface::{
    Continuity, Domain, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
};

type Map = Arc<dyn Fn(DVec2) -> Jet2 + Send + Sync>;

/// A patch given by its jet.
#[derive(Clone)]
pub struct Analytic {
    pub domain: Domain,
    pub kind: PatchKind,
    pub map: Map,
}

impl std::fmt::Debug for Analytic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Analytic({:?})", self.domain)
    }
}

impl Patch for Analytic {
    fn domain(&self) -> Domain {
        self.domain.clone()
    }
    fn jet(&self, at: DVec2) -> Jet2 {
        (self.map)(at)
    }
    fn kind(&self) -> PatchKind {
        self.kind
    }
    fn record(&self, _: &mut SplinePool) -> Record {
        Record { kind: "analytic".into(), data: Default::default() }
    }
}

impl Analytic {
    pub fn new(domain: Domain, map: impl Fn(DVec2) -> Jet2 + Send + Sync + 'static) -> Self {
        Self { domain, kind: PatchKind::Trimmed, map: Arc::new(map) }
    }

    pub fn square(map: impl Fn(DVec2) -> Jet2 + Send + Sync + 'static) -> Self {
        Self::new(Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }, map)
    }

    /// `p ↦ f p + shift` for a linear `f`.
    pub fn moved(&self, f: DMat3, shift: DVec3) -> Self {
        let map = Arc::clone(&self.map);
        let moved = move |at| {
            let jet = map(at).map(|p: DVec3| f * p);
            Jet2 { p: jet.p + shift, ..jet }
        };
        Self { map: Arc::new(moved), ..self.clone() }
    }

    /// `p ↦ p (1 + δ (p · m)²)`.
    pub fn bulged(&self, delta: f64, m: DVec3) -> Self {
        let map = Arc::clone(&self.map);
        let bulged = move |at| {
            let jet = map(at);
            let h = jet.map(|p| p.dot(m));
            let mut w = h.weighted(&h).map(|x: f64| delta * x);
            w.p += 1.0;
            jet.weighted(&w)
        };
        Self { map: Arc::new(bulged), ..self.clone() }
    }
}

/// The part of the unit sphere over the face of the cube with outward normal `a` and sides along `b` and `a × b`.
pub fn cube_face(a: DVec3, b: DVec3) -> Analytic {
    let c = a.cross(b);
    Analytic::square(move |at| {
        let q = Jet2 {
            p: a + b * (2.0 * at.x - 1.0) + c * (2.0 * at.y - 1.0),
            du: b * 2.0,
            dv: c * 2.0,
            ..Jet2::default()
        };
        let s = |x: DVec3, y: DVec3| 2.0 * x.dot(y);
        let (p, u, v) = (q.p.length_squared(), s(q.p, q.du), s(q.p, q.dv));
        let w = |first: f64| -0.5 * p.powf(-1.5) * first;
        let ww = |x: f64, y: f64, xy: f64| 0.75 * p.powf(-2.5) * x * y - 0.5 * p.powf(-1.5) * xy;
        q.weighted(&Jet2 {
            p: p.powf(-0.5),
            du: w(u),
            dv: w(v),
            duu: ww(u, u, s(q.du, q.du)),
            duv: ww(u, v, s(q.du, q.dv)),
            dvv: ww(v, v, s(q.dv, q.dv)),
        })
    })
}

pub fn sphere_patches() -> Vec<Analytic> {
    [(1.0, DVec3::X, DVec3::Y), (1.0, DVec3::Y, DVec3::Z), (1.0, DVec3::Z, DVec3::X)]
        .into_iter()
        .flat_map(|(s, a, b)| [cube_face(a * s, b), cube_face(-a * s, b)])
        .collect()
}

/// Seams between all edges of `shape` whose ends agree crosswise; the patches of the surface are `patches`.
pub fn sewn(shape: &[Analytic], patches: Vec<Analytic>, claimed: Continuity) -> Surface {
    let mut edges = Vec::new();
    for (p, patch) in shape.iter().enumerate() {
        for e in 0..patch.domain.edge_count() {
            let curve = patch.domain.edge(e).unwrap();
            let ends = [0.0, 1.0].map(|t| patch.jet(curve.point(t)).p);
            edges.push((EdgeRef { patch: PatchId(p as u32), edge: e as u32 }, ends));
        }
    }
    let mut seams = Vec::new();
    for (i, (a, [a0, a1])) in edges.iter().enumerate() {
        for (b, [b0, b1]) in &edges[i + 1..] {
            if a0.distance(*b1) < 1e-9 && a1.distance(*b0) < 1e-9 {
                seams.push(Seam::new(*a, *b, claimed));
            }
        }
    }
    surface(patches, seams)
}

pub fn surface(patches: Vec<Analytic>, seams: Vec<Seam>) -> Surface {
    Surface::new(patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect(), seams).unwrap()
}

pub fn sphere() -> Surface {
    sewn(&sphere_patches(), sphere_patches(), Continuity::C2)
}

/// The graph `z = f(x, y)` over the unit square; `f` returns value and partials. Its edge 0 is the x axis.
pub fn graph(corner: DVec2, f: impl Fn(DVec2) -> Jet2<f64> + Send + Sync + 'static) -> Analytic {
    Analytic::square(move |at| {
        let x = corner + at;
        let z = f(x);
        let lift = |xy: DVec2, z: f64| xy.extend(z);
        Jet2 {
            p: lift(x, z.p),
            du: lift(DVec2::X, z.du),
            dv: lift(DVec2::Y, z.dv),
            duu: lift(DVec2::ZERO, z.duu),
            duv: lift(DVec2::ZERO, z.duv),
            dvv: lift(DVec2::ZERO, z.dvv),
        }
    })
}

/// Two graphs over neighbouring squares that meet along `x ∈ [0, 1], y = 0`, the parameter `t` being `x`.
pub fn pair(
    above: impl Fn(DVec2) -> Jet2<f64> + Send + Sync + 'static,
    below: impl Fn(DVec2) -> Jet2<f64> + Send + Sync + 'static,
    claimed: Continuity,
) -> Surface {
    let patches = vec![graph(DVec2::ZERO, above), graph(DVec2::new(0.0, -1.0), below)];
    let edge = |patch, edge| EdgeRef { patch: PatchId(patch), edge };
    surface(patches, vec![Seam::new(edge(0, 0), edge(1, 2), claimed)])
}

/// A tessellation as owned arrays: an `n × n` grid on every patch (all must have the unit square as domain).
#[derive(Default)]
pub struct Grid {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub triangle_patch: Vec<PatchId>,
    pub corner_parameters: Vec<[DVec2; 3]>,
}

impl Grid {
    pub fn of(surface: &Surface, n: u32) -> Self {
        let mut grid = Self::default();
        for (p, patch) in surface.patches().iter().enumerate() {
            let first = grid.positions.len() as u32;
            let at = |i: u32, j: u32| DVec2::new(f64::from(i), f64::from(j)) / f64::from(n);
            let vertex = |i: u32, j: u32| first + i * (n + 1) + j;
            for i in 0..=n {
                for j in 0..=n {
                    grid.positions.push(patch.jet(at(i, j)).p);
                    if i < n && j < n {
                        for t in [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]] {
                            grid.triangles.push(t.map(|(a, b)| vertex(i + a, j + b)));
                            grid.corner_parameters.push(t.map(|(a, b)| at(i + a, j + b)));
                            grid.triangle_patch.push(PatchId(p as u32));
                        }
                    }
                }
            }
        }
        grid
    }

    pub fn samples(&self) -> suture_certify::SurfaceSamples<'_> {
        suture_certify::SurfaceSamples {
            positions: &self.positions,
            triangles: &self.triangles,
            triangle_patch: &self.triangle_patch,
            corner_parameters: &self.corner_parameters,
        }
    }
}
