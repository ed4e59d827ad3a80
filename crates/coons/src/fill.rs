//! From a scene to a surface of old and new patches.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;
use serde::Serialize;
use suture_bernstein::BSplineSurface;
use suture_surface::{Continuity, EdgeRef, Patch, PatchId, Seam, Surface};

use crate::border::border_curve;
use crate::certificate::CornerCertificate;
use crate::constituent::{Constituent, EdgeRibbon, Map, Mapped, Reflected, Spline};
use crate::curve::{BorderCurve, CurveData};
use crate::error::CoonsError;
use crate::four::FourSided;
use crate::gaps::{GapOptions, find_gaps};
use crate::nsided::{SplitCertificate, split_hole};
use crate::options::{FillOptions, Order};
use crate::scene::{Extension, Geometry, Scene, SceneConstituent, SceneEdge, SceneFill, SceneSurface};
use crate::sheet::SheetPatch;
use crate::three::{HoleCertificate, ThreeSided};

type Sheet = Arc<dyn Constituent>;

/// Old and new patches in one surface, and what is known about the new ones.
#[derive(Debug)]
pub struct FillSurface {
    /// The given surfaces, then the fills, with the seams between them.
    pub surface: Surface,
    /// What is known.
    pub report: FillReport,
}

/// What is known about the fills of a surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FillReport {
    /// Number of given patches.
    pub given: usize,
    /// The fills in the order of the scene.
    pub fills: Vec<Join>,
}

/// One fill.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Join {
    /// Its patches.
    pub patches: Vec<PatchId>,
    /// The order that was asked for.
    pub asked: Order,
    /// How smoothly it joins.
    pub certificate: JoinCertificate,
    /// How far border curves were moved by repair, over the diagonal of the gap.
    pub moved: [f64; 2],
}

impl Join {
    /// The order that is reached, in the words of the one asked for; `None` when not even positions agree.
    pub fn reached(&self) -> Option<Order> {
        match &self.certificate {
            JoinCertificate::Corners(c) => {
                // With respect to reparametrised constituents a geometric order is the parametric one.
                let whole = c.reached.is_some_and(|r| r.derivatives() >= self.asked.derivatives());
                if whole { Some(self.asked) } else { c.reached }
            }
            JoinCertificate::Hole(c) => Some(c.reached),
            JoinCertificate::Split(c) => Some(c.reached),
        }
    }
}

/// How smoothly a fill joins.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JoinCertificate {
    /// A four-sided fill.
    Corners(CornerCertificate),
    /// A three-sided fill.
    Hole(HoleCertificate),
    /// A hole split into wedges.
    Split(SplitCertificate),
}

/// Fills what a scene asks for. The order of `options` holds where a fill names none, its family where the scene names none.
///
/// # Errors
/// [`CoonsError::Scene`] with the place for what does not exist, and all errors of the fills.
pub fn fill(scene: &Scene, options: &FillOptions) -> Result<FillSurface, CoonsError> {
    let options = &FillOptions { family: scene.blend.unwrap_or(options.family), ..*options };
    let mut work = Work::new(scene)?;
    for (number, fill) in scene.fills.iter().enumerate() {
        work.fill(number, fill, options)?;
    }
    let Work { patches, seams, report, .. } = work;
    Ok(FillSurface { surface: Surface::new(patches, seams)?, report })
}

struct Given {
    sheet: Sheet,
    domain: [DVec2; 2],
    patch: PatchId,
}

struct Work {
    given: BTreeMap<String, Given>,
    patches: Vec<Box<dyn Patch>>,
    seams: Vec<Seam>,
    report: FillReport,
}

/// An edge in the frame of a gap: `v = 0` on the edge, `v > 0` beyond it, `u` against the direction of the edge.
pub(crate) struct Frame {
    pub(crate) origin: DVec2,
    pub(crate) along: DVec2,
    pub(crate) out: DVec2,
}

impl Frame {
    pub(crate) fn of_rectangle([min, max]: [DVec2; 2], edge: u8) -> Self {
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        let (a, b) = (corners[usize::from(edge % 4)], corners[usize::from((edge + 1) % 4)]);
        // The domain lies on the left of its edges.
        let out = -(b - a).perp().normalize_or_zero();
        Self { origin: b, along: a - b, out }
    }

    /// With `reach` parameters per unit of `v`.
    pub(crate) fn map(&self, reach: f64) -> Map {
        Map::Affine { origin: self.origin, u: self.along, v: self.out * reach }
    }
}

/// From the frame of the second edge of a gap, where the edge is `v = 0` and `u` runs the other way, to that of the gap; `flip` when `u` does
/// not run the other way.
pub(crate) fn far_side(inner: Sheet, flip: bool) -> Sheet {
    let (origin, u) = if flip { (DVec2::Y, DVec2::X) } else { (DVec2::ONE, -DVec2::X) };
    Arc::new(Mapped { inner, map: Map::Affine { origin, u, v: -DVec2::Y } })
}

impl Work {
    fn new(scene: &Scene) -> Result<Self, CoonsError> {
        let (mut given, mut patches) = (BTreeMap::new(), Vec::<Box<dyn Patch>>::new());
        // Surfaces that only enter formulas are drawn by their fills.
        let drawn = |name: &str| {
            scene.fills.iter().any(|f| match f {
                SceneFill::Gap { between, .. } => between.iter().any(|e| e.surface == name),
                SceneFill::Hole { sides } => sides.iter().any(|e| e.surface == name),
                _ => false,
            })
        };
        for (name, surface) in &scene.surfaces {
            let (sheet, own) = read_surface(name, surface)?;
            let drawn = drawn(name);
            let Some(domain) = surface.domain.or(own) else {
                if drawn {
                    return Err(bad_surface(name, "an analytic surface needs a domain [[a0, b0], [a1, b1]]"));
                }
                given.insert(
                    name.clone(),
                    Given { sheet, domain: [DVec2::ZERO, DVec2::ONE], patch: PatchId(u32::MAX) },
                );
                continue;
            };
            let patch = PatchId(patches.len() as u32);
            let sheet_patch = SheetPatch::new(Arc::clone(&sheet), domain)
                .ok_or_else(|| bad_surface(name, "its domain is empty or not finite"))?;
            if drawn {
                patches.push(Box::new(sheet_patch));
            }
            given.insert(name.clone(), Given { sheet, domain, patch });
        }
        let report = FillReport { given: patches.len(), fills: Vec::new() };
        Ok(Self { given, patches, seams: Vec::new(), report })
    }

    fn given(&self, number: usize, name: &str) -> Result<&Given, CoonsError> {
        self.given.get(name).ok_or_else(|| CoonsError::Scene {
            what: format!("fill {number}"),
            reason: format!("there is no surface {name:?}"),
        })
    }

    fn push(&mut self, patch: Box<dyn Patch>) -> PatchId {
        self.patches.push(patch);
        PatchId(self.patches.len() as u32 - 1)
    }

    fn edge(&self, number: usize, edge: &SceneEdge) -> Result<(&Given, Frame), CoonsError> {
        let given = self.given(number, &edge.surface)?;
        if edge.edge > 3 {
            return Err(CoonsError::Scene {
                what: format!("fill {number}"),
                reason: format!("surface {:?} has edges 0 to 3, not {}", edge.surface, edge.edge),
            });
        }
        Ok((given, Frame::of_rectangle(given.domain, edge.edge)))
    }

    /// The surface in the frame of its edge, continued as asked for.
    fn continued(
        &self,
        number: usize,
        edge: &SceneEdge,
        width: f64,
        order: usize,
    ) -> Result<Sheet, CoonsError> {
        let (given, frame) = self.edge(number, edge)?;
        let reach = edge.reach.unwrap_or_else(|| matched_reach(&given.sheet, &frame, width));
        if !(reach.is_finite() && reach > 0.0) {
            return Err(CoonsError::Scene {
                what: format!("fill {number}"),
                reason: format!(
                    "the reach {reach} over edge {} of {:?} is not positive",
                    edge.edge, edge.surface
                ),
            });
        }
        let inner: Sheet = Arc::new(Mapped { inner: Arc::clone(&given.sheet), map: frame.map(reach) });
        Ok(match edge.extension {
            Extension::Natural => inner,
            Extension::Ribbon => match EdgeRibbon::new(Arc::clone(&inner), 0.0, order) {
                Some(ribbon) => Arc::new(ribbon),
                None => inner,
            },
            Extension::Reflected => Arc::new(Reflected { inner, order }),
        })
    }

    fn fill(&mut self, number: usize, fill: &SceneFill, options: &FillOptions) -> Result<(), CoonsError> {
        let with = |order: &Option<Order>| FillOptions { order: order.unwrap_or(options.order), ..*options };
        match fill {
            SceneFill::Gap { between, curves, order } => self.gap(number, between, curves, &with(order)),
            SceneFill::FourSided { r, curves, order } => {
                let options = with(order);
                let sheets = [self.mapped(number, &r[0])?, self.mapped(number, &r[1])?];
                let id = self.four(number, sheets.clone(), curves, &options)?;
                let claimed = options.order.claimed();
                let below = [DVec2::new(0.0, -r[0].drawn), DVec2::X];
                self.draw(number, &sheets[0], below, 2, EdgeRef { patch: id, edge: 0 }, claimed)?;
                let above = [DVec2::Y, DVec2::new(1.0, 1.0 + r[1].drawn)];
                self.draw(number, &sheets[1], above, 0, EdgeRef { patch: id, edge: 2 }, claimed)
            }
            SceneFill::ThreeSided { r, order } => {
                let options = with(order);
                let sheets =
                    [self.mapped(number, &r[0])?, self.mapped(number, &r[1])?, self.mapped(number, &r[2])?];
                let hole = ThreeSided::fill(sheets.clone(), &options)?;
                let id = self.push(Box::new(hole.patch));
                let claimed = options.order.claimed();
                let domains = [
                    [DVec2::new(0.0, -r[0].drawn), DVec2::X],
                    [DVec2::Y, DVec2::new(1.0, 1.0 + r[1].drawn)],
                    [DVec2::X, DVec2::new(1.0 + r[2].drawn, 1.0)],
                ];
                for (k, (old, new)) in [(2, 0), (0, 2), (3, 1)].into_iter().enumerate() {
                    self.draw(
                        number,
                        &sheets[k],
                        domains[k],
                        old,
                        EdgeRef { patch: id, edge: new },
                        claimed,
                    )?;
                }
                let certificate = JoinCertificate::Hole(hole.certificate);
                let join = Join { patches: vec![id], asked: options.order, certificate, moved: [0.0; 2] };
                self.report.fills.push(join);
                Ok(())
            }
            SceneFill::Hole { sides } => self.hole(number, sides, options),
        }
    }

    fn mapped(&self, number: usize, c: &SceneConstituent) -> Result<Sheet, CoonsError> {
        let map = Map::Affine { origin: c.origin, u: c.u, v: c.v };
        if !map.valid() {
            let reason = "a number of its map is not finite".into();
            return Err(CoonsError::Scene { what: format!("fill {number}"), reason });
        }
        Ok(Arc::new(Mapped { inner: Arc::clone(&self.given(number, &c.surface)?.sheet), map }))
    }

    /// Draws a constituent beside its fill.
    fn draw(
        &mut self,
        number: usize,
        sheet: &Sheet,
        domain: [DVec2; 2],
        edge: u32,
        beside: EdgeRef,
        claimed: Continuity,
    ) -> Result<(), CoonsError> {
        let patch = SheetPatch::new(Arc::clone(sheet), domain).ok_or_else(|| CoonsError::Scene {
            what: format!("fill {number}"),
            reason: "a constituent must be drawn a positive way beside the gap".into(),
        })?;
        let patch = self.push(Box::new(patch));
        self.report.given += 1;
        self.seams.push(Seam::new(beside, EdgeRef { patch, edge }, claimed));
        Ok(())
    }

    fn four(
        &mut self,
        number: usize,
        sheets: [Sheet; 2],
        curves: &[Option<CurveData>; 2],
        options: &FillOptions,
    ) -> Result<PatchId, CoonsError> {
        let border = |side: usize| -> Result<Arc<dyn BorderCurve>, CoonsError> {
            match &curves[side] {
                Some(data) => data.build().map_err(|source| CoonsError::Net {
                    what: format!("curve {side} of fill {number}"),
                    source,
                }),
                None => Ok(Arc::new(border_curve(&sheets, side as f64, options.order.derivatives())?)),
            }
        };
        let borders = [border(0)?, border(1)?];
        let made = FourSided::fill(sheets, borders, options)?;
        let id = self.push(Box::new(made.patch));
        let certificate = JoinCertificate::Corners(made.certificate);
        self.report.fills.push(Join {
            patches: vec![id],
            asked: options.order,
            certificate,
            moved: made.moved,
        });
        Ok(id)
    }

    fn gap(
        &mut self,
        number: usize,
        between: &[SceneEdge; 2],
        curves: &[Option<CurveData>; 2],
        options: &FillOptions,
    ) -> Result<(), CoonsError> {
        let ends = |e: &SceneEdge| -> Result<[glam::DVec3; 3], CoonsError> {
            let (given, f) = self.edge(number, e)?;
            Ok([0.0, 0.5, 1.0].map(|t| given.sheet.jet(f.origin + f.along * t).p))
        };
        let (a, b) = (ends(&between[0])?, ends(&between[1])?);
        // Edges of surfaces that are oriented alike run against each other; a surface that is not is joined from its other side.
        let flip = a[0].distance(b[0]) + a[2].distance(b[2]) < a[0].distance(b[2]) + a[2].distance(b[0]);
        let width = a[1].distance(b[1]);
        let k = options.order.derivatives();
        let near = self.continued(number, &between[0], width, k)?;
        let far = far_side(self.continued(number, &between[1], width, k)?, flip);
        let id = self.four(number, [near, far], curves, options)?;
        for (k, edge) in [0u32, 2].into_iter().enumerate() {
            let patch = self.given(number, &between[k].surface)?.patch;
            let old = EdgeRef { patch, edge: u32::from(between[k].edge) };
            let mut seam = Seam::new(EdgeRef { patch: id, edge }, old, options.order.claimed());
            seam.same_direction = k == 1 && flip;
            self.seams.push(seam);
        }
        Ok(())
    }

    fn hole(&mut self, number: usize, sides: &[SceneEdge], options: &FillOptions) -> Result<(), CoonsError> {
        if !(4..=8).contains(&sides.len()) {
            return Err(CoonsError::Sides { sides: sides.len() });
        }
        let mut middle = glam::DVec3::ZERO;
        for side in sides {
            let (given, f) = self.edge(number, side)?;
            middle += given.sheet.jet(f.origin).p / sides.len() as f64;
        }
        let mut sheets = Vec::with_capacity(sides.len());
        for side in sides {
            let (given, f) = self.edge(number, side)?;
            let width = given.sheet.jet(f.origin + f.along * 0.5).p.distance(middle);
            sheets.push(self.continued(number, side, width, 2)?);
        }
        let split = split_hole(&sheets, options)?;
        let first = self.patches.len() as u32;
        let claimed = split.certificate.reached.claimed();
        self.seams.extend(split.spoke_seams(first));
        for (i, side) in sides.iter().enumerate() {
            let old = EdgeRef { patch: self.given(number, &side.surface)?.patch, edge: u32::from(side.edge) };
            self.seams.push(Seam::new(EdgeRef { patch: PatchId(first + i as u32), edge: 0 }, old, claimed));
        }
        let patches = (0..sides.len() as u32).map(|i| PatchId(first + i)).collect();
        let certificate = JoinCertificate::Split(split.certificate);
        self.report.fills.push(Join { patches, asked: Order::G1, certificate, moved: [0.0; 2] });
        for wedge in split.wedges {
            self.push(Box::new(wedge));
        }
        Ok(())
    }
}

fn bad_surface(name: &str, reason: &str) -> CoonsError {
    CoonsError::Scene { what: format!("surface {name:?}"), reason: reason.into() }
}

/// The surface as a constituent, and its own domain if it has one.
fn read_surface(name: &str, surface: &SceneSurface) -> Result<(Sheet, Option<[DVec2; 2]>), CoonsError> {
    let net = |source| CoonsError::Net { what: format!("surface {name:?}"), source };
    Ok(match &surface.geometry {
        Geometry::Analytic(a) if a.valid() => (Arc::new(a.clone()), None),
        Geometry::Analytic(_) => {
            return Err(bad_surface(name, "a number is not finite, or a curve has no or too many points"));
        }
        Geometry::Spline(s) => (Arc::new(Spline(Arc::new(s.clone()))), Some(s.domain())),
        Geometry::Bezier(b) => {
            let knots = b
                .degree()
                .map(|d| (0..2 * d + 2).map(|i| if i <= d { 0.0 } else { 1.0 }).collect::<Vec<f64>>());
            let s = BSplineSurface::new(b.degree(), knots, b.net().to_vec()).map_err(net)?;
            (Arc::new(Spline(Arc::new(s))), Some([DVec2::ZERO, DVec2::ONE]))
        }
    })
}

impl Scene {
    /// The scene with the gaps between its surfaces as what to fill: pairs of edges that face each other, as
    /// [`find_gaps`] finds them. Surfaces without a domain are not looked at.
    ///
    /// # Errors
    /// [`CoonsError::NoGap`]; [`CoonsError::Scene`], [`CoonsError::Net`] for surfaces that are none.
    pub fn with_gaps(&self, options: &GapOptions) -> Result<Self, CoonsError> {
        let (mut names, mut patches) = (Vec::new(), Vec::<Box<dyn Patch>>::new());
        for (name, surface) in &self.surfaces {
            let (sheet, own) = read_surface(name, surface)?;
            let Some(domain) = surface.domain.or(own) else { continue };
            let patch = SheetPatch::new(sheet, domain)
                .ok_or_else(|| bad_surface(name, "its domain is empty or not finite"))?;
            names.push(name.clone());
            patches.push(Box::new(patch));
        }
        let gaps = find_gaps(&Surface::new(patches, Vec::new())?, options);
        if gaps.is_empty() {
            return Err(CoonsError::NoGap { edges: 4 * names.len(), limit: options.widest });
        }
        let edge = |e: EdgeRef| SceneEdge::new(&names[e.patch.0 as usize], e.edge as u8);
        let fills = gaps.iter().map(|g| SceneFill::between(edge(g.a), edge(g.b))).collect();
        Ok(Self { fills, ..self.clone() })
    }

    /// The scene with one order for everything, in place of what its fills say.
    pub fn with_order(mut self, asked: Order) -> Self {
        for fill in &mut self.fills {
            match fill {
                SceneFill::Gap { order, .. }
                | SceneFill::FourSided { order, .. }
                | SceneFill::ThreeSided { order, .. } => *order = Some(asked),
                SceneFill::Hole { .. } => {}
            }
        }
        self
    }
}

/// Parameters across an edge that are `width` long in space, at its middle.
pub(crate) fn matched_reach(sheet: &Sheet, frame: &Frame, width: f64) -> f64 {
    let jet = sheet.jet(frame.origin + frame.along * 0.5);
    width / (jet.du * frame.out.x + jet.dv * frame.out.y).length()
}
