//! Gaps between the open edges of a network of patches.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_surface::{
    Domain, EdgeCurve, EdgeRef, Jet2, Patch, PatchId, PatchKind, Record, Seam, SplinePool, Surface,
};

use crate::border::border_curves;
use crate::constituent::{Constituent, Map, Mapped, PatchSheet, Reflected};
use crate::error::CoonsError;
use crate::fill::{FillReport, FillSurface, Frame, Join, JoinCertificate, far_side, matched_reach};
use crate::four::FourSided;
use crate::options::FillOptions;

/// Two open edges that face each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// One edge.
    pub a: EdgeRef,
    /// The other.
    pub b: EdgeRef,
    /// Whether both run in the same direction: the orientations of their patches disagree.
    pub same_direction: bool,
    /// Largest distance between points of equal parameter.
    pub width: f64,
}

impl Gap {
    /// The gap between two edges of a surface, whether or not they face each other.
    ///
    /// # Errors
    /// [`CoonsError::OpenEdge`] for edges that do not exist, have seams, are trimmed or points.
    pub fn between(surface: &Surface, a: EdgeRef, b: EdgeRef) -> Result<Self, CoonsError> {
        let open = open_edges(surface);
        let find = |e: EdgeRef| {
            open.iter().find(|o| o.edge == e).ok_or(CoonsError::OpenEdge {
                patch: e.patch.0 as usize,
                edge: e.edge as usize,
                reason: "there is no such edge, or it has a seam, belongs to a trimmed patch or is a point",
            })
        };
        let (x, y) = (find(a)?, find(b)?);
        let (width, same_direction) = apart(x, y);
        Ok(Self { a, b, same_direction, width })
    }
}

/// Which pairs of open edges count as gaps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GapOptions {
    /// Largest width over the length of the shorter edge. Default 1: what is wider than long is no gap between neighbours.
    pub widest: f64,
}

impl Default for GapOptions {
    fn default() -> Self {
        Self { widest: 1.0 }
    }
}

/// Samples of an edge.
const SAMPLES: usize = 16;

struct Open {
    edge: EdgeRef,
    points: Vec<DVec3>,
    length: f64,
    /// Direction out of the patch at the middle.
    out: DVec3,
}

/// The gaps of a surface: pairs of open edges that face each other, the narrowest first, every edge in one of them at most. Edges of trimmed
/// patches are not looked at.
pub fn find_gaps(surface: &Surface, options: &GapOptions) -> Vec<Gap> {
    let open = open_edges(surface);
    let mut pairs = Vec::new();
    for i in 0..open.len() {
        for j in i + 1..open.len() {
            if let Some(gap) = facing(&open[i], &open[j], options.widest) {
                pairs.push((i, j, gap));
            }
        }
    }
    pairs.sort_by(|x, y| x.2.width.total_cmp(&y.2.width).then((x.0, x.1).cmp(&(y.0, y.1))));
    let mut used = vec![false; open.len()];
    let mut gaps = Vec::new();
    for (i, j, gap) in pairs {
        if !used[i] && !used[j] {
            (used[i], used[j]) = (true, true);
            gaps.push(gap);
        }
    }
    gaps
}

fn open_edges(surface: &Surface) -> Vec<Open> {
    let mut taken: Vec<EdgeRef> = surface.seams().iter().flat_map(|s| [s.a, s.b]).collect();
    taken.sort_unstable();
    let mut open = Vec::new();
    for (i, patch) in surface.patches().iter().enumerate() {
        let domain = patch.domain();
        if matches!(domain, Domain::Trimmed(_)) {
            continue;
        }
        for e in 0..domain.edge_count() {
            let edge = EdgeRef { patch: PatchId(i as u32), edge: e as u32 };
            let Some(curve) = domain.edge(e) else { continue };
            if taken.binary_search(&edge).is_ok() {
                continue;
            }
            let at = |k: usize| curve.point(k as f64 / SAMPLES as f64);
            let points: Vec<DVec3> = (0..=SAMPLES).map(|k| patch.jet(at(k)).p).collect();
            let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
            let [_, d, _] = curve.jet(0.5);
            let (j, o) = (patch.jet(curve.point(0.5)), -d.perp());
            let tangent = (j.du * d.x + j.dv * d.y).normalize_or_zero();
            let out = j.du * o.x + j.dv * o.y;
            let out = (out - tangent * out.dot(tangent)).normalize_or_zero();
            // Degenerate and broken edges face nothing.
            if length > 0.0 && length.is_finite() && out != DVec3::ZERO {
                open.push(Open { edge, points, length, out });
            }
        }
    }
    open
}

/// Largest distance of points of equal parameter, and whether they run in the same direction.
fn apart(a: &Open, b: &Open) -> (f64, bool) {
    let distance = |same: bool| {
        (0..=SAMPLES).fold(0.0f64, |w, k| {
            let other = if same { k } else { SAMPLES - k };
            w.max(a.points[k].distance(b.points[other]))
        })
    };
    let (against, along) = (distance(false), distance(true));
    if against <= along { (against, false) } else { (along, true) }
}

fn facing(a: &Open, b: &Open, widest: f64) -> Option<Gap> {
    let (width, same_direction) = apart(a, b);
    let shorter = a.length.min(b.length);
    let across = b.points[SAMPLES / 2] - a.points[SAMPLES / 2];
    // Edges that touch need a seam, not a fill.
    let open = width > 1e-9 * shorter && width <= widest * shorter;
    (open && a.out.dot(across) > 0.0 && b.out.dot(across) < 0.0).then_some(Gap {
        a: a.edge,
        b: b.edge,
        same_direction,
        width,
    })
}

/// Fills gaps of a surface; border curves are made here, and patches are continued by reflection, so that any patch will do. Without gaps
/// given, those that [`find_gaps`] finds are filled.
///
/// # Errors
/// [`CoonsError::NoGap`] when none are given or found, [`CoonsError::OpenEdge`] for edges that do not exist, have seams or are trimmed, and
/// the errors of [`FourSided::fill`].
pub fn fill_gaps(
    surface: Arc<Surface>,
    gaps: Option<&[Gap]>,
    options: &FillOptions,
    search: &GapOptions,
) -> Result<FillSurface, CoonsError> {
    let found;
    let gaps = match gaps {
        Some(gaps) => gaps,
        None => {
            found = find_gaps(&surface, search);
            &found
        }
    };
    if gaps.is_empty() {
        return Err(CoonsError::NoGap { edges: open_edges(&surface).len(), limit: search.widest });
    }
    let given = surface.patches().len();
    let mut patches: Vec<Box<dyn Patch>> = Vec::with_capacity(given + gaps.len());
    for index in 0..given {
        patches.push(Box::new(Shared { surface: Arc::clone(&surface), index }));
    }
    let mut seams = surface.seams().to_vec();
    let mut report = FillReport { given, fills: Vec::new() };
    let k = options.order.derivatives();
    for gap in gaps {
        let near = continued(&surface, gap.a, gap.width, k)?;
        let far = far_side(continued(&surface, gap.b, gap.width, k)?, gap.same_direction);
        let r = [near, far];
        let borders = border_curves(&r, options.order)?;
        let made = FourSided::fill(r, borders, options)?;
        let patch = PatchId(patches.len() as u32);
        patches.push(Box::new(made.patch));
        let claimed = options.order.claimed();
        seams.push(Seam::new(EdgeRef { patch, edge: 0 }, gap.a, claimed));
        let mut far = Seam::new(EdgeRef { patch, edge: 2 }, gap.b, claimed);
        far.same_direction = gap.same_direction;
        seams.push(far);
        report.fills.push(Join {
            patches: vec![patch],
            asked: options.order,
            certificate: JoinCertificate::Corners(made.certificate),
            moved: made.moved,
        });
    }
    Ok(FillSurface { surface: Surface::new(patches, seams)?, report })
}

/// A patch in the frame of one of its edges, continued by reflection to order `k`.
fn continued(
    surface: &Arc<Surface>,
    edge: EdgeRef,
    width: f64,
    k: usize,
) -> Result<Arc<dyn Constituent>, CoonsError> {
    let (patch, number) = (edge.patch.0 as usize, edge.edge as usize);
    let bad = |reason| CoonsError::OpenEdge { patch, edge: number, reason };
    let domain = surface.patch(edge.patch).ok_or_else(|| bad("there is no such patch"))?.domain();
    let Some(EdgeCurve::Line([from, to])) = domain.edge(number) else {
        return Err(bad("there is no such straight edge; trimmed patches cannot be continued"));
    };
    let shared = Shared { surface: Arc::clone(surface), index: patch };
    let sheet: Arc<dyn Constituent> = Arc::new(PatchSheet(Arc::new(shared)));
    let map = match &domain {
        Domain::Rectangle { min, max } => {
            let frame = Frame::of_rectangle([*min, *max], number as u8);
            // The reflection looks as deep into the patch as it reaches beyond it.
            let size = *max - *min;
            let depth = (size * frame.out).length();
            frame.map(matched_reach(&sheet, &frame, width).min(depth))
        }
        _ => {
            let n = domain.edge_count() as f64;
            let corners = (0..domain.edge_count()).filter_map(|e| domain.edge(e).map(|c| c.point(0.0)));
            let apex = corners.fold(DVec2::ZERO, |s, c| s + c) / n;
            let unit = Map::Away { from: to, to: from, apex, reach: 1.0 }.jet(DVec2::new(0.5, 0.0));
            let jet = sheet.jet(unit.p);
            let reach = width / (jet.du * unit.dv.x + jet.dv * unit.dv.y).length();
            // Short of the apex, where the map is singular.
            Map::Away { from: to, to: from, apex, reach: reach.min(0.75) }
        }
    };
    if !map.valid() {
        return Err(bad("the patch is singular there"));
    }
    Ok(Arc::new(Reflected { inner: Arc::new(Mapped { inner: sheet, map }), order: k }))
}

/// A patch of a surface that others use too.
#[derive(Clone, Debug)]
struct Shared {
    surface: Arc<Surface>,
    index: usize,
}

impl Shared {
    fn patch(&self) -> &dyn Patch {
        self.surface.patches()[self.index].as_ref()
    }
}

impl Patch for Shared {
    fn domain(&self) -> Domain {
        self.patch().domain()
    }

    fn jet(&self, at: DVec2) -> Jet2 {
        self.patch().jet(at)
    }

    fn kind(&self) -> PatchKind {
        self.patch().kind()
    }

    fn record(&self, pool: &mut SplinePool) -> Record {
        self.patch().record(pool)
    }

    fn normal(&self, at: DVec2) -> Option<DVec3> {
        self.patch().normal(at)
    }
}
