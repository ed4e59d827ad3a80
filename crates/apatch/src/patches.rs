//! The surface as parametric patches: one per face, and one per edge that is not straight (two where the edge is crossed).
//!
//! A point of a patch is the minimal root on a ray, hence a smooth function of the ray; its derivatives follow from those of the shooting
//! polynomial by implicit differentiation.

use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use suture_bernstein::BezierCurve;
use suture_surface::{Domain, Jet2, Patch, PatchKind, Record, RecordError, SplinePool};

use crate::edge::{EdgeForm, EdgeSide};
use crate::face::{FaceForm, SurfacePoint};

/// The surface over a face that is not plane. Domain: the triangle `(0, 0), (1, 0), (0, 1)` of barycentric coordinates
/// `(1 − u − v, u, v)`, with further corners where an edge is crossed.
///
/// Over a face that the surface may cross, derivatives jump at the lines of its pieces (the tangent planes do not).
#[derive(Clone, Debug)]
pub struct FacePatch {
    form: Arc<FaceForm>,
    /// Parameter from corner `j` to the next one at which that edge is crossed.
    pinches: [Option<f64>; 3],
}

impl FacePatch {
    pub(crate) fn new(form: Arc<FaceForm>, pinches: [Option<f64>; 3]) -> Self {
        Self { form, pinches }
    }

    /// The point of the surface on the ray of `at`.
    pub fn point(&self, at: DVec2) -> SurfacePoint {
        self.form.point(barycentric(at))
    }
}

/// The corners of the domain of a face patch.
fn polygon(pinches: &[Option<f64>; 3]) -> Vec<DVec2> {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
    let mut all = Vec::with_capacity(6);
    for j in 0..3 {
        all.push(corners[j]);
        all.extend(pinches[j].map(|x| corners[j] * (1.0 - x) + corners[(j + 1) % 3] * x));
    }
    all
}

/// Barycentric coordinates on a face; exactly zero on its edges in spite of rounding.
fn barycentric(at: DVec2) -> [f64; 3] {
    let clean = |x: f64| if x.abs() <= 4.0 * f64::EPSILON { 0.0 } else { x };
    [clean((1.0 - at.x) - at.y), clean(at.x), clean(at.y)]
}

impl Patch for FacePatch {
    fn domain(&self) -> Domain {
        let corners = polygon(&self.pinches);
        if corners.len() == 3 {
            return Domain::Polygon(corners);
        }
        // Three corners in a line are no polygon to rely on.
        let line = |k: usize| BezierCurve::new(vec![corners[k], corners[(k + 1) % corners.len()]]);
        match (0..corners.len()).map(line).collect() {
            Ok(lines) => Domain::Trimmed(vec![lines]),
            Err(_) => Domain::Polygon(Vec::new()),
        }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let q = barycentric(at);
        let form = &*self.form;
        let base = form.base.second(q);
        let Some(side) = form.side(base.v) else { return Jet2::constant(DVec3::NAN) };
        // The tangents of x = (1 − u − v, u, v).
        let (u, v) = ([-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]);
        let l0 = plane(base.v, base.g, |a, b| base.along(a, b), u, v);
        let l1 = side.l1();
        let line = crate::cubic::apply(&l1, q);
        let l1 = plane(
            crate::cubic::dot(line, q),
            line.map(|l| 2.0 * l),
            |a, b| 2.0 * crate::cubic::dot(crate::cubic::apply(&l1, a), b),
            u,
            v,
        );
        let l2 = plane(crate::cubic::dot(side.r, q), side.r, |_, _| 0.0, u, v);
        let root = form.shooting(side, q, base.v).root();
        let t = implicit([l0, l1, l2, Jet2::constant(side.b)], root.t);
        let [p0, p1, p2] = form.p;
        let foot = Jet2 { p: form.foot(q), du: p1 - p0, dv: p2 - p0, ..Jet2::default() };
        let rise = Jet2 { p: side.apex - foot.p, du: -foot.du, dv: -foot.dv, ..Jet2::default() };
        let mut jet = foot + rise.weighted(&t);
        // The form of `SurfacePoint`, to the bit.
        jet.p = foot.p * (1.0 - root.t) + side.apex * root.t;
        jet
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Face
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        record(FACE, &FaceData { form: (*self.form).clone(), pinches: self.pinches })
    }

    fn normal(&self, at: DVec2) -> Option<DVec3> {
        self.point(at).gradient.try_normalize()
    }
}

/// The jet, along two tangents, of a function of the barycentric coordinates.
fn plane(p: f64, g: [f64; 3], h: impl Fn([f64; 3], [f64; 3]) -> f64, u: [f64; 3], v: [f64; 3]) -> Jet2<f64> {
    use crate::cubic::dot;
    Jet2 { p, du: dot(g, u), dv: dot(g, v), duu: h(u, u), duv: h(u, v), dvv: h(v, v) }
}

/// The jet of the root `t` of `Σ B_s B_s³(t) = 0` from those of the coefficients.
fn implicit(b: [Jet2<f64>; 4], t: f64) -> Jet2<f64> {
    let s = 1.0 - t;
    let sum = |w: [f64; 4]| {
        let term = |i: usize| b[i].map(|x| x * w[i]);
        term(0) + term(1) + term(2) + term(3)
    };
    let value = sum([s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]);
    let first = sum([-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t]);
    let second = sum([6.0 * s, 6.0 * t - 12.0 * s, 6.0 * s - 12.0 * t, 6.0 * t]);
    solve(t, &value, &first, second.p)
}

/// The jet of `t` where `Φ(u, v, t) = 0`, from the jets of `Φ` and `Φ_t` at fixed `t` and from `Φ_tt`.
fn solve(t: f64, value: &Jet2<f64>, first: &Jet2<f64>, second: f64) -> Jet2<f64> {
    let d = first.p;
    let (du, dv) = (-value.du / d, -value.dv / d);
    let bend = |vv: f64, fa: f64, fb: f64, a: f64, b: f64| -(vv + fa * b + fb * a + second * a * b) / d;
    Jet2 {
        p: t,
        du,
        dv,
        duu: bend(value.duu, first.du, first.du, du, du),
        duv: bend(value.duv, first.du, first.dv, du, dv),
        dvv: bend(value.dvv, first.dv, first.dv, dv, dv),
    }
}

/// The surface along an edge, between the patches of its two faces: a lune. Domain: `0 ≤ u ≤ 1`, `|v| ≤ u (1 − u)`; `u` runs along
/// the edge with its left face at positive `v`; the ray at `(u, v)` points to `y u + (1 − y) u'`, `y = ½ + v / (2 u (1 − u))`. Edges:
/// 0 along the right face, 1 back along the left one.
#[derive(Clone, Debug)]
pub struct EdgePatch {
    form: Arc<EdgeForm>,
    span: [f64; 2],
    side: usize,
}

/// Closest to the ends of a lune that derivatives are taken where they have no limit.
const NEAR_END: f64 = 1.0 / (1u64 << 40) as f64;

/// Below this `u (1 − u)`, roots are found again in units of it.
const NEAR: f64 = 1e-3;

/// Smallest `u (1 − u)` at which second derivatives are taken: their tangential parts grow without limit towards the ends, and the
/// curvature is left of them with as many digits fewer.
const LEAST_SIGMA: f64 = 1.0 / (1u64 << 22) as f64;

impl EdgePatch {
    /// `side`: 0 above, 1 below the mesh; `span`: the part of the edge where the surface lies there.
    pub(crate) fn new(form: Arc<EdgeForm>, span: [f64; 2], side: usize) -> Option<Self> {
        form.sides[side].as_ref()?;
        Some(Self { form, span, side })
    }

    /// Parameters `(ξ, y)` along the whole edge and across it.
    fn ray(&self, at: DVec2) -> [f64; 2] {
        let sigma = at.x * (1.0 - at.x);
        let y = if sigma > 0.0 { (0.5 + at.y / (2.0 * sigma)).clamp(0.0, 1.0) } else { 0.5 };
        [self.span[0] * (1.0 - at.x) + self.span[1] * at.x, y]
    }

    /// The point of the surface on the ray of `at`.
    pub fn point(&self, at: DVec2) -> SurfacePoint {
        let [xi, y] = self.ray(at);
        self.form.point(xi, y)
    }

    /// `B₀ / (ζ (1 − ζ))`, linear or quadratic in the parameter `ζ` of the span, with its derivatives.
    fn beta0(&self, xi: f64) -> [f64; 3] {
        let [ei, ej] = self.form.e;
        let [lo, hi] = self.span;
        let d = ei - ej;
        let width = hi - lo;
        if width == 1.0 {
            let v = ei * (1.0 - xi) + ej * xi;
            [3.0 * v, -3.0 * d, 0.0]
        } else if lo == 0.0 {
            let c = 3.0 * width * width * d;
            [c * (1.0 - xi), -c * width, 0.0]
        } else {
            let c = -3.0 * width * width * d;
            [c * xi, c * width, 0.0]
        }
    }

    /// The derivatives on the ray `y` at `zeta`.
    fn derivatives(&self, zeta: f64, y: f64) -> Jet2 {
        let form = &*self.form;
        let Some(side) = &form.sides[self.side] else { return Jet2::constant(DVec3::NAN) };
        let xi = self.span[0] * (1.0 - zeta) + self.span[1] * zeta;
        let sigma = zeta * (1.0 - zeta);
        let width = self.span[1] - self.span[0];
        let [p, d, dd] = self.beta0(xi);
        // Jets in (ζ, y); the root is t = σ τ, and everything is divided by σ, so that nothing vanishes at the ends.
        let s = Jet2 { p: sigma, du: 1.0 - 2.0 * zeta, duu: -2.0, ..Jet2::default() };
        let b0 = Jet2 { p, du: d, duu: dd, ..Jet2::default() };
        let [b1, b2, b3] = layers(side, xi, y, width);
        let times = |x: f64| move |j: Jet2<f64>| j.map(|v| v * x);
        let s2 = s.weighted(&s);
        let c = [
            b0,
            times(3.0)(b1) + times(-3.0)(b0.weighted(&s)),
            times(3.0)(b0.weighted(&s2)) + times(-6.0)(b1.weighted(&s)) + times(3.0)(b2.weighted(&s)),
            (times(-1.0)(b0.weighted(&s)) + times(3.0)(b1) + times(-3.0)(b2) + b3).weighted(&s2),
        ];
        let sign = side.sign;
        let mut tau =
            if sigma > 0.0 { form.shooting(side, xi, y).root().t / sigma } else { -b0.p / (3.0 * b1.p) };
        let cubes = |t: f64| ([1.0, t, t * t, t * t * t], [0.0, 1.0, 2.0 * t, 3.0 * t * t]);
        if sigma > 0.0 && sigma < NEAR {
            // The root is exact relative to 1; divided by σ it has lost digits, which Newton's method restores.
            for _ in 0..2 {
                let (powers, slopes) = cubes(tau);
                let at = |w: [f64; 4]| (0..4).map(|i| w[i] * c[i].p).sum::<f64>();
                let step = at(powers) / at(slopes);
                // A larger step would lead to another root.
                if step.abs() <= 0.1 * tau.abs() {
                    tau -= step;
                }
            }
        }
        let (powers, slopes) = cubes(tau);
        let sum = |w: [f64; 4]| (0..4).fold(Jet2::default(), |j: Jet2<f64>, i| j + times(sign * w[i])(c[i]));
        let second = sign * (2.0 * c[2].p + 6.0 * tau * c[3].p);
        let tau = solve(tau, &sum(powers), &sum(slopes), second);
        // f(ζ, y) = τ (U(y) − q(ζ)); the point is q + σ f with y = ½ + v/(2 σ).
        let [p0, p1] = form.p;
        let along = (p1 - p0) * width;
        let [primed, apex] = side.apex;
        let rise = Jet2 {
            p: primed * (1.0 - y) + apex * y - form.foot(xi),
            du: -along,
            dv: apex - primed,
            ..Jet2::default()
        };
        let f = rise.weighted(&tau);
        let (slope, half) = (s.du, y - 0.5);
        let sharp = 1.0 / sigma.max(f64::MIN_POSITIVE);
        Jet2 {
            p: DVec3::ZERO,
            du: along + f.p * slope + f.du * sigma - f.dv * (half * slope),
            dv: f.dv * 0.5,
            duu: (f.p - f.dv * half) * -2.0 + f.du * (2.0 * slope) + f.duu * sigma
                - f.duv * (2.0 * half * slope)
                + f.dvv * (half * half * slope * slope * sharp),
            duv: (f.duv - f.dvv * (half * slope * sharp)) * 0.5,
            dvv: f.dvv * (0.25 * sharp),
        }
    }
}

impl Patch for EdgePatch {
    fn domain(&self) -> Domain {
        let curve = |a: f64, c: f64, b: f64| {
            BezierCurve::new(vec![DVec2::new(a, 0.0), DVec2::new(0.5, c), DVec2::new(b, 0.0)])
        };
        // Three finite control points: the constructor accepts them.
        match (curve(0.0, -0.5, 1.0), curve(1.0, 0.5, 0.0)) {
            (Ok(right), Ok(left)) => Domain::Trimmed(vec![vec![right, left]]),
            _ => Domain::Polygon(Vec::new()),
        }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let mut zeta = at.x;
        let [xi, mut y] = self.ray(at);
        if self.beta0(xi)[0] == 0.0 {
            // Both B₀ and its slope vanish: the lune ends in a cusp, whose derivatives are taken just before it.
            zeta = zeta.clamp(NEAR_END, 1.0 - NEAR_END);
            if zeta != at.x {
                y = 0.5;
            }
        }
        let mut jet = self.derivatives(zeta, y);
        if zeta * (1.0 - zeta) < LEAST_SIGMA {
            jet = bent_as(&jet, &self.derivatives(zeta.clamp(LEAST_SIGMA, 1.0 - LEAST_SIGMA), y));
        }
        jet.p = self.point(at).position;
        jet
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Edge
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        record(EDGE, &EdgeData { form: (*self.form).clone(), span: self.span, side: self.side })
    }

    fn normal(&self, at: DVec2) -> Option<DVec3> {
        self.point(at).gradient.try_normalize()
    }
}

/// `jet` with the second derivatives of `near`, told in the frame of its own tangents and normal: the curvature of the one, the tangent
/// plane of the other.
fn bent_as(jet: &Jet2, near: &Jet2) -> Jet2 {
    let frame = |j: &Jet2| DMat3::from_cols(j.du, j.dv, j.du.cross(j.dv).normalize_or_zero());
    let turn = frame(jet) * frame(near).inverse();
    let turned = Jet2 { duu: turn * near.duu, duv: turn * near.duv, dvv: turn * near.dvv, ..*jet };
    if turned.finite() { turned } else { *jet }
}

/// Jets of `B₁`, `B₂`, `B₃` in `(ζ, y)`, `ξ = … + width ζ`.
fn layers(side: &EdgeSide, xi: f64, y: f64, width: f64) -> [Jet2<f64>; 3] {
    let (x, z) = (1.0 - xi, 1.0 - y);
    let quadratic = |h: &[f64; 3]| {
        [
            h[0] * x * x + 2.0 * h[1] * x * xi + h[2] * xi * xi,
            2.0 * width * ((h[1] - h[0]) * x + (h[2] - h[1]) * xi),
            2.0 * width * width * (h[0] - 2.0 * h[1] + h[2]),
        ]
    };
    let cubic = |c: &[f64; 4]| {
        let d = [c[1] - c[0], c[2] - c[1], c[3] - c[2]];
        [
            c[0] * z * z * z + 3.0 * c[1] * y * z * z + 3.0 * c[2] * y * y * z + c[3] * y * y * y,
            3.0 * (d[0] * z * z + 2.0 * d[1] * y * z + d[2] * y * y),
            6.0 * ((d[1] - d[0]) * z + (d[2] - d[1]) * y),
        ]
    };
    let (p, u) = (quadratic(&side.b1[0]), quadratic(&side.b1[1]));
    let mix = |i: usize| z * p[i] + y * u[i];
    let b1 = Jet2 { p: mix(0), du: mix(1), dv: u[0] - p[0], duu: mix(2), duv: u[1] - p[1], dvv: 0.0 };
    let (i, j) = (cubic(&side.b2[0]), cubic(&side.b2[1]));
    let mix = |k: usize| x * i[k] + xi * j[k];
    let b2 = Jet2 {
        p: mix(0),
        du: width * (j[0] - i[0]),
        dv: mix(1),
        duu: 0.0,
        duv: width * (j[1] - i[1]),
        dvv: mix(2),
    };
    let c = cubic(&side.b3);
    [b1, b2, Jet2 { p: c[0], dv: c[1], dvv: c[2], ..Jet2::default() }]
}

/// A plane face. Domain: the triangle `(0, 0), (1, 0), (0, 1)`.
#[derive(Clone, Debug)]
pub struct PlanarPatch {
    corners: [DVec3; 3],
}

impl PlanarPatch {
    pub(crate) fn new(corners: [DVec3; 3]) -> Self {
        Self { corners }
    }
}

impl Patch for PlanarPatch {
    fn domain(&self) -> Domain {
        Domain::Polygon(polygon(&[None; 3]))
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let [a, b, c] = self.corners;
        let q = barycentric(at);
        Jet2 { p: a * q[0] + b * q[1] + c * q[2], du: b - a, dv: c - a, ..Jet2::default() }
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Planar
    }

    fn record(&self, _: &mut SplinePool) -> Record {
        record(PLANAR, &self.corners)
    }
}

/// Names under which records of these patches are stored: what [`load`] reads.
pub const RECORDS: [&str; 3] = [FACE, EDGE, PLANAR];
const FACE: &str = "apatch.face";
const EDGE: &str = "apatch.edge";
const PLANAR: &str = "apatch.planar";

#[derive(Serialize, Deserialize)]
struct FaceData {
    form: FaceForm,
    pinches: [Option<f64>; 3],
}

#[derive(Serialize, Deserialize)]
struct EdgeData {
    form: EdgeForm,
    span: [f64; 2],
    side: usize,
}

fn record(kind: &str, data: &impl Serialize) -> Record {
    // Serialising numbers and arrays into a value cannot fail; a null would be refused when loading.
    Record { kind: kind.into(), data: serde_json::to_value(data).unwrap_or_default() }
}

/// Loads a patch that this crate recorded.
///
/// # Errors
/// [`RecordError::UnknownKind`] for records of other methods, [`RecordError::Malformed`].
pub fn load(record: &Record, _: &SplinePool) -> Result<Box<dyn Patch>, RecordError> {
    let bad = |reason: &str| RecordError::Malformed { kind: record.kind.clone(), reason: reason.into() };
    match record.kind.as_str() {
        FACE => {
            let data: FaceData = parse(record)?;
            if data.form.sides == [None; 2] {
                return Err(bad("the face has no tetrahedron"));
            }
            if data.pinches.iter().flatten().any(|x| !(*x > 0.0 && *x < 1.0)) {
                return Err(bad("an edge is crossed outside of it"));
            }
            Ok(Box::new(FacePatch::new(Arc::new(data.form), data.pinches)))
        }
        EDGE => {
            let data: EdgeData = parse(record)?;
            let [lo, hi] = data.span;
            if !(0.0 <= lo && lo < hi && hi <= 1.0 && (lo == 0.0 || hi == 1.0)) {
                return Err(bad("the span is no part of the edge"));
            }
            if data.side > 1 {
                return Err(bad("the side is neither 0 nor 1"));
            }
            let patch = EdgePatch::new(Arc::new(data.form), data.span, data.side);
            Ok(Box::new(patch.ok_or_else(|| bad("the edge has no tetrahedron on its side"))?))
        }
        PLANAR => Ok(Box::new(PlanarPatch::new(parse(record)?))),
        other => Err(RecordError::UnknownKind { kind: other.into() }),
    }
}

/// The tetrahedra in which a recorded patch lives: one or two of a face, one of a lune, none of a plane face. Vertices in the order of
/// [`Cell`](crate::Cell).
///
/// # Errors
/// [`RecordError::UnknownKind`] for records of other methods, [`RecordError::Malformed`].
pub fn tetrahedra(record: &Record) -> Result<Vec<[DVec3; 4]>, RecordError> {
    match record.kind.as_str() {
        FACE => {
            let FaceForm { p: [a, b, c], sides, .. } = parse::<FaceData>(record)?.form;
            Ok(sides.iter().flatten().map(|side| [a, b, c, side.apex]).collect())
        }
        EDGE => {
            let EdgeData { form, side, .. } = parse(record)?;
            let one = form.sides.get(side).and_then(Option::as_ref);
            Ok(one.map(|s| [s.apex[0], form.p[0], form.p[1], s.apex[1]]).into_iter().collect())
        }
        PLANAR => Ok(Vec::new()),
        other => Err(RecordError::UnknownKind { kind: other.into() }),
    }
}

fn parse<T: DeserializeOwned>(record: &Record) -> Result<T, RecordError> {
    T::deserialize(&record.data)
        .map_err(|e| RecordError::Malformed { kind: record.kind.clone(), reason: e.to_string() })
}
