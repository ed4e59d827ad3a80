//! Holes of four to eight sides, split into four-sided fills around a centre.

use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_bernstein::BezierCurve;
use suture_surface::{
    Continuity, Domain, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, Seam, SplinePool,
};

use crate::blend::Blend;
use crate::constituent::{Constituent, Ribbon};
use crate::curve::{BorderCurve, hermite};
use crate::error::{CoonsError, NAMES};
use crate::four::FourSided;
use crate::options::{FillOptions, Order};
use crate::real::Real;
use crate::record;
use crate::taylor::Expansion;

type Sheet = Arc<dyn Constituent>;

/// One fill of a split hole: it meets side `v = 0`, shrinks to the centre at `v = 1`, and has been bent so that its normal along the spokes
/// `u = 0` and `u = 1` is that of a field that its neighbour has too.
///
/// `f + u(1 − u)² c0(v) + (u³ − u²) c1(v)`, where `c` takes from `f_u` on a spoke its component along the field.
#[derive(Clone, Debug)]
pub struct Wedge {
    pub(crate) fill: FourSided,
    /// The fields of normals along the spokes; not of unit length, their part along the spoke is taken out.
    pub(crate) normals: [BezierCurve<DVec3>; 2],
}

/// A hole split into wedges.
#[derive(Clone, Debug)]
pub struct SplitHole {
    /// The wedges, by side.
    pub wedges: Vec<Wedge>,
    /// What is measured of them.
    pub certificate: SplitCertificate,
}

/// How smoothly a split hole joins, measured at 33 points of every side and spoke.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SplitCertificate {
    /// The centre.
    pub center: DVec3,
    /// Diagonal of the corners' bounding box.
    pub diagonal: f64,
    /// Largest distance across sides and spokes, over the diagonal.
    pub position: f64,
    /// Largest angle between the normals across every side, in radians.
    pub sides: Vec<f64>,
    /// Largest angle between the normals across every spoke, in radians; spoke `i` starts at the corner where side `i` does.
    pub spokes: Vec<f64>,
    /// Angle between the tangent planes of the neighbours at every corner; a hole whose corners are not flat cannot be G¹.
    pub corners: Vec<f64>,
    /// The order that is reached: G¹ or C⁰.
    pub reached: Order,
}

/// Fills a hole of 4 to 8 sides: side `i` is the edge `v = 0` of `sides[i]`, `u` running from corner `i` to the next, `v` into the hole.
///
/// Asked for is G¹ with all sides and across the spokes. It is reached where the neighbours have one tangent plane and one curvature
/// along the spoke at every corner, as parts of one smooth surface do; otherwise the certificate says C⁰ and how much is missing.
///
/// # Errors
/// [`CoonsError::Sides`], [`CoonsError::Chain`]; [`CoonsError::NoThirdDerivatives`] for sides that cannot be expanded;
/// [`CoonsError::Folds`] where a spoke would leave a side backwards; [`CoonsError::NotFinite`], [`CoonsError::NoExtent`].
pub fn split_hole(sides: &[Sheet], options: &FillOptions) -> Result<SplitHole, CoonsError> {
    let n = sides.len();
    if !(4..=8).contains(&n) {
        return Err(CoonsError::Sides { sides: n });
    }
    let (zero, one) = (Expansion::u(0.0), Expansion::v(0.0));
    if let Some(i) = sides.iter().position(|s| s.expand(&zero, &one).is_none()) {
        return Err(CoonsError::NoThirdDerivatives { what: NAMES[i.min(3)], asked: Order::G1 });
    }
    let corners: Vec<Corner> = (0..n).map(|i| Corner::new(&sides[(i + n - 1) % n], &sides[i])).collect();
    for c in &corners {
        if let Some(&value) = [c.p, c.normal, c.bend, c.inward].iter().find(|p| !p.is_finite()) {
            return Err(CoonsError::NotFinite { what: "a side", u: 0.0, v: 0.0, value });
        }
    }
    let (low, high) =
        corners.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), c| (a.min(c.p), b.max(c.p)));
    let diagonal = low.distance(high);
    if !(diagonal > 0.0 && diagonal.is_finite()) {
        return Err(CoonsError::NoExtent { diagonal });
    }
    for (i, side) in sides.iter().enumerate() {
        let size = side.jet(DVec2::X).p.distance(corners[(i + 1) % n].p) / diagonal;
        if !(size <= options.tolerance) {
            return Err(CoonsError::Chain { side: i, sides: n, size });
        }
    }
    let center = center(sides, &corners);
    let normal = (0..n)
        .map(|i| (corners[i].p - center).cross(corners[(i + 1) % n].p - center))
        .fold(DVec3::ZERO, |s, x| s + x)
        .normalize_or(DVec3::Z);
    let out: Vec<DVec3> = corners
        .iter()
        .map(|c| {
            let d = c.p - center;
            (d - normal * d.dot(normal)).normalize_or_zero() * d.length()
        })
        .collect();
    let starts: Vec<[DVec3; 3]> = corners.iter().map(|c| c.leave(center)).collect();
    let bends: Vec<DVec3> = (0..n).map(|i| bend_at_end(corners[i].p, &starts[i], center, -out[i])).collect();
    let curvature = Hessian::nearest(normal, &out, &bends);
    let mut spokes = Vec::with_capacity(n);
    let mut fields = Vec::with_capacity(n);
    for (i, c) in corners.iter().enumerate() {
        let net = |source| CoonsError::Net { what: format!("spoke {i}"), source };
        let [start, bend, turn] = starts[i];
        spokes.push(hermite(&[c.p, start, bend], &[center, -out[i], bends[i]]).map_err(net)?);
        fields.push(hermite(&[c.normal, turn], &[normal, curvature.gradient(out[i])]).map_err(net)?);
    }
    let blend: Arc<dyn Blend> = Arc::new(options.family.flat(2));
    let mut wedges = Vec::with_capacity(n);
    for i in 0..n {
        let j = (i + 1) % n;
        let net = |source| CoonsError::Net { what: "the centre".into(), source };
        // What the spokes say of the centre to second order, as a ribbon that shrinks to it.
        let curves: Vec<Arc<dyn BorderCurve>> = vec![
            Arc::new(BezierCurve::new(vec![center]).map_err(net)?),
            Arc::new(BezierCurve::new(vec![-out[i], -out[j]]).map_err(net)?),
            Arc::new(BezierCurve::new(curvature.second(out[i], out[j]).to_vec()).map_err(net)?),
        ];
        let borders: [Arc<dyn BorderCurve>; 2] = [Arc::new(spokes[i].clone()), Arc::new(spokes[j].clone())];
        let cap: Sheet = Arc::new(Ribbon { at: 1.0, curves });
        let side = crate::geometric::reparametrise_edge(&sides[i], &borders, 0, 1)?;
        let fill = FourSided::raw([side, cap], borders, [Arc::clone(&blend), Arc::clone(&blend)]);
        wedges.push(Wedge { fill, normals: [fields[i].clone(), fields[j].clone()] });
    }
    let certificate = measure(sides, &wedges, &corners, center, diagonal, options.tolerance);
    Ok(SplitHole { wedges, certificate })
}

impl SplitHole {
    /// The seams along the spokes, for wedges that are patches `first, first + 1, …` of a surface.
    pub fn spoke_seams(&self, first: u32) -> Vec<Seam> {
        let n = self.wedges.len() as u32;
        let claimed = if self.certificate.reached == Order::G1 { Continuity::G1 } else { Continuity::C0 };
        let edge = |i: u32, edge| EdgeRef { patch: PatchId(first + i), edge };
        (0..n).map(|i| Seam::new(edge(i, 1), edge((i + 1) % n, 3), claimed)).collect()
    }
}

/// What two neighbouring sides know at their common corner.
struct Corner {
    p: DVec3,
    /// Mean unit normal.
    normal: DVec3,
    /// Angle between the two.
    angle: f64,
    /// Mean direction into the hole.
    inward: DVec3,
    /// Finite when both second derivatives are.
    bend: DVec3,
    jets: [Jet2; 2],
}

impl Corner {
    fn new(before: &Sheet, after: &Sheet) -> Self {
        let jets = [before.jet(DVec2::X), after.jet(DVec2::ZERO)];
        let normals = jets.map(|j| j.du.cross(j.dv).normalize_or_zero());
        let mean = (normals[0] + normals[1]).normalize_or_zero();
        // Across both edges, also where the tangent planes disagree: the wedges must not leave the edges. Where the edges go straight on
        // they do not span a plane.
        let across = jets[0].du.normalize_or_zero().cross(jets[1].du.normalize_or_zero());
        let normal =
            if across.length() > 1e-3 { across.normalize() * across.dot(mean).signum() } else { mean };
        // Along both edges away from the corner: inside whatever the surfaces' own parameter lines do.
        let inward = (jets[1].du.normalize_or_zero() - jets[0].du.normalize_or_zero()).normalize_or_zero();
        let inward = if inward == DVec3::ZERO { jets[1].dv.normalize_or_zero() } else { inward };
        let angle = normals[0].cross(normals[1]).length().atan2(normals[0].dot(normals[1]));
        let bend = jets[0].duu + jets[0].duv + jets[0].dvv + jets[1].duu + jets[1].duv + jets[1].dvv;
        Self { p: jets[1].p, normal, angle, inward, bend, jets }
    }

    /// First and second derivative of a spoke to `center`, and the derivative of the normal along it.
    fn leave(&self, center: DVec3) -> [DVec3; 3] {
        let chord = center - self.p;
        let flat = |d: DVec3| d - self.normal * d.dot(self.normal);
        // Halfway between the bisector and the chord: convex at reflex corners, straight in regular holes.
        let aim = flat(self.inward).normalize_or_zero() + flat(chord).normalize_or_zero();
        let start = aim.normalize_or(self.inward) * chord.length();
        let (mut bend, mut turn) = (DVec3::ZERO, DVec3::ZERO);
        for j in &self.jets {
            let n = j.du.cross(j.dv);
            let nn = n.length_squared();
            let (a, b) = (start.cross(j.dv).dot(n) / nn, j.du.cross(start).dot(n) / nn);
            let second = j.duu * (a * a) + j.duv * (2.0 * a * b) + j.dvv * (b * b);
            bend += self.normal * (0.5 * second.dot(self.normal));
            let dn = (j.duu * a + j.duv * b).cross(j.dv) + j.du.cross(j.duv * a + j.dvv * b);
            let unit = n / nn.sqrt();
            turn += (dn - unit * dn.dot(unit)) / nn.sqrt() * 0.5;
        }
        [start, bend, turn]
    }
}

/// The second derivative at its end of the quartic from `from`, with first and second derivative there, to `to` with first derivative `end`:
/// on a quadric surface spokes are then nearly parabolas.
fn bend_at_end(from: DVec3, [start, bend, _]: &[DVec3; 3], to: DVec3, end: DVec3) -> DVec3 {
    let (start, bend, way) = (*start, *bend, to - from);
    let fourth = end + start * 2.0 + bend * 0.5 - way * 3.0;
    let third = way - start - bend * 0.5 - fourth;
    bend + third * 6.0 + fourth * 12.0
}

/// The second fundamental form at the centre, as `normal · (gᵀ q)` with `g = (x², 2xy, y²)` in the plane across `normal`.
struct Hessian {
    normal: DVec3,
    axes: [DVec3; 2],
    q: DVec3,
}

impl Hessian {
    /// The form nearest to second derivatives `bends` in the directions `out`, the smallest one where they do not determine it.
    fn nearest(normal: DVec3, out: &[DVec3], bends: &[DVec3]) -> Self {
        let (e, f) = normal.any_orthonormal_pair();
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (d, b) in out.iter().zip(bends) {
            let (x, y) = (d.dot(e), d.dot(f));
            let g = DVec3::new(x * x, 2.0 * x * y, y * y);
            matrix += DMat3::from_cols(g * g.x, g * g.y, g * g.z);
            right += g * b.dot(normal);
        }
        let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
        let q = (matrix + DMat3::from_diagonal(DVec3::splat(1e-9 * trace))).inverse() * right;
        Self { normal, axes: [e, f], q: if q.is_finite() { q } else { DVec3::ZERO } }
    }

    /// Half the gradient of the form at `d`: by how much a normal of length 1 at the centre turns back along `d`.
    fn gradient(&self, d: DVec3) -> DVec3 {
        let ([e, f], q) = (self.axes, self.q);
        let (x, y) = (d.dot(e), d.dot(f));
        e * (q.x * x + q.y * y) + f * (q.y * x + q.z * y)
    }

    /// Bézier points of the second derivative in the direction `(1 − u) a + u b`.
    fn second(&self, a: DVec3, b: DVec3) -> [DVec3; 3] {
        [(a, a), (a, b), (b, b)].map(|(a, b)| self.normal * self.gradient(a).dot(b))
    }
}

/// The mean of the sides' continuations, each followed from its middle as far as the middle of the hole.
fn center(sides: &[Sheet], corners: &[Corner]) -> DVec3 {
    let n = sides.len() as f64;
    let middle = corners.iter().fold(DVec3::ZERO, |s, c| s + c.p) / n;
    let reach = |side: &Sheet| {
        let j = side.jet(DVec2::new(0.5, 0.0));
        let normal = j.du.cross(j.dv).normalize_or_zero();
        let way = middle - j.p;
        // Only the height over the tangent plane is asked of the continuation: the place is that of the middle.
        let flat = way - normal * way.dot(normal);
        let w = flat.dot(j.dv) / j.dv.length_squared();
        let curved = if w.is_finite() { normal * (0.5 * j.dvv.dot(normal) * w * w) } else { DVec3::ZERO };
        j.p + flat + curved
    };
    sides.iter().map(reach).fold(DVec3::ZERO, |s, x| s + x) / n
}

fn angle(a: Option<DVec3>, b: Option<DVec3>) -> f64 {
    match (a, b) {
        (Some(a), Some(b)) => a.cross(b).length().atan2(a.dot(b)),
        _ => f64::INFINITY,
    }
}

fn measure(
    sides: &[Sheet],
    wedges: &[Wedge],
    corners: &[Corner],
    center: DVec3,
    diagonal: f64,
    tolerance: f64,
) -> SplitCertificate {
    let n = sides.len();
    let mut position = 0.0f64;
    let (mut across_sides, mut across_spokes) = (vec![0.0f64; n], vec![0.0f64; n]);
    for i in 0..n {
        for k in 0..=32 {
            let t = f64::from(k) / 32.0;
            let (x, y) = (wedges[i].jet(DVec2::new(t, 0.0)), sides[i].jet(DVec2::new(t, 0.0)));
            position = position.max(x.p.distance(y.p) / diagonal);
            across_sides[i] = across_sides[i].max(angle(x.normal(), y.normal()));
            let before = &wedges[(i + n - 1) % n];
            // The centre itself is singular in either.
            let v = t * (1.0 - 1.0 / 64.0);
            let (x, y) = (wedges[i].jet(DVec2::new(0.0, v)), before.jet(DVec2::new(1.0, v)));
            position = position.max(x.p.distance(y.p) / diagonal);
            across_spokes[i] = across_spokes[i].max(angle(x.normal(), y.normal()));
        }
    }
    let smooth = across_sides.iter().chain(&across_spokes).all(|a| *a <= tolerance);
    SplitCertificate {
        center,
        diagonal,
        position,
        sides: across_sides,
        spokes: across_spokes,
        corners: corners.iter().map(|c| c.angle).collect(),
        reached: if smooth { Order::G1 } else { Order::C0 },
    }
}

impl Wedge {
    /// `c(v)` on a spoke with two derivatives.
    fn bend(&self, side: usize, at: f64) -> Option<[DVec3; 3]> {
        let v = Expansion::v(at);
        let u = Expansion::u(side as f64);
        let b = self.fill.beta.jet(at);
        let b = v.apply(&[b[0], b[1], b[2] / 2.0, b[3] / 6.0]);
        let [x, y] = [0, 1].map(|k: usize| self.fill.r[k].expand(&u, &v));
        let (x, y) = (x?, y?);
        let one = Expansion::of(1.0);
        // P_u along the spoke: the row of the first power of u.
        let pu = [0, 1, 2].map(|i| {
            let p = (one - b) * x[i] + b * y[i];
            let mut row = Expansion::of(0.0);
            row.0[0] = p.0[1];
            row
        });
        let spoke = self.fill.borders[side].expand(&v)?;
        let tangent = spoke.map(|s| {
            let mut d = Expansion::of(0.0);
            (0..3).for_each(|j| d.0[0][j] = (j + 1) as f64 * s.0[0][j + 1]);
            d
        });
        let dot = |a: &[Expansion; 3], b: &[Expansion; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let field = self.normals[side].expand(&v)?;
        let slope = dot(&field, &tangent) * dot(&tangent, &tangent).recip();
        let normal = [0, 1, 2].map(|i| field[i] - slope * tangent[i]);
        let size = -(dot(&pu, &normal) * dot(&normal, &normal).recip());
        let c = normal.map(|x| x * size);
        Some(crate::curve::curve_jet(&c))
    }
}

impl Patch for Wedge {
    fn domain(&self) -> Domain {
        Domain::Rectangle { min: DVec2::ZERO, max: DVec2::ONE }
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        let mut jet = self.fill.jet(at);
        let (u, s) = (at.x, 1.0 - at.x);
        let weights =
            [[u * s * s, s * (s - 2.0 * u), 6.0 * u - 4.0], [-u * u * s, u * (u - 2.0 * s), 6.0 * u - 2.0]];
        for (side, h) in weights.into_iter().enumerate() {
            let Some([c, d, dd]) = self.bend(side, at.y) else { continue };
            jet = jet.add(Jet2 {
                p: c * h[0],
                du: c * h[1],
                dv: d * h[0],
                duu: c * h[2],
                duv: d * h[1],
                dvv: dd * h[0],
            });
        }
        jet
    }

    fn kind(&self) -> PatchKind {
        PatchKind::Fill { sides: 3 }
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        record::wedge(self, pool)
    }

    /// At the centre the limit of the normals: that of the plane there.
    fn normal(&self, at: DVec2) -> Option<DVec3> {
        let jet = self.jet(at);
        if at.y == 1.0 {
            // f_v(u, 1) turns with u: the plane is spanned by it and its derivative.
            let fan = Jet2 { du: jet.duv, dv: jet.dv, ..Jet2::default() };
            return fan.normal().map(|n| if n.dot(self.normals[0].point(1.0)) < 0.0 { -n } else { n });
        }
        jet.normal()
    }
}
