//! Maps with true correspondence: points that are blended lie on one line across the shape, so that a blend of charts that agree
//! is the charts.
//!
//! All charts of a corner or an arc share one *reference map* `(Y, n)` into space; the parameter of a chart is where the line
//! `Y + λ n` meets its surface, and the map `G` is the projection Π of these parameters onto the admissible maps: polynomials of degree
//! `n` on the N-gon, of degree `(5, q)` on the strips, with (G1)–(G8) of Wagner et al. (2003) built in. Π is the same linear operator
//! for every chart, hence exact where charts differ by an affine map, whatever the reference map is.
//!
//! Where that cannot work the degrees go down from (2, 2) to (1, 1); a corner whose arcs leave too close to each other gets the
//! paper's maps, which do not look at the other charts at all.

mod kept;
mod layout;
mod line;
mod project;
mod reference;

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use suture_bernstein::BezierPatch;

use self::kept::{ArcKey, CornerKey, Kept};
use self::layout::Layout;
use self::line::Line;
use self::project::{Across, GonProjection, hermite, lines};
use self::reference::{Centre, Jet};
use crate::check::{LEAST_JACOBIAN, jacobian, strip_jacobian};
use crate::maps::{CornerMapSet, CornerMaps, MapSet, Memory, Node, StripMaps, all, between};
use crate::network::sample_at;
use crate::paper;
use crate::polynomial::PlanePolynomial;
use crate::widths::Widths;
use crate::{ArcCurve, ArcEnd, BlendError, Corner, Network, gon};

/// How far the N-gon is enlarged for the fit of its maps: strips continue them beyond its edges.
const ENLARGEMENT: f64 = 1.3;
/// Share of missed lines above which the maps of a corner say nothing about the shape.
const MOST_MISSED: f64 = 0.05;
/// Cosine between the normals on both sides of an arc below which its lines are useless, and the share of such samples from which
/// the whole arc is.
const LEAST_AGREEMENT: f64 = -0.2;
const MOST_TURNED: f64 = 0.1;
/// Reductions of the width after which the paper's maps are tried at a corner beside which strips fold, and along an arc that folds.
const PAPER_CORNER: u32 = 1;
const PAPER_ARC: u32 = 3;

/// The maps of the module's documentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Correspondence {
    /// Total degree of the maps of N-gons, 1 to 4.
    pub gon: usize,
    /// Degree of the maps of strips across their direction, at least `gon`.
    pub across: usize,
}

impl Default for Correspondence {
    /// (2, 2): (3, 3) gains only where the charts agree almost perfectly.
    fn default() -> Self {
        Self { gon: 2, across: 2 }
    }
}

impl CornerMaps for Correspondence {
    fn maps(
        &self,
        network: &Network,
        widths: &Widths,
        memory: &mut Memory,
    ) -> Result<MapSet, Vec<BlendError>> {
        let mut kept: Kept = memory.take().unwrap_or_default();
        kept.renew(network);
        let maps = self.ladder(network, widths, &mut kept);
        memory.keep(kept);
        maps
    }

    fn reach(&self, valence: usize) -> f64 {
        layout::regular_reach(valence)
    }
}

impl Correspondence {
    /// What folds at full degree is made again at degree 1, corners that fold even then by the paper.
    fn ladder(&self, network: &Network, widths: &Widths, kept: &mut Kept) -> Result<MapSet, Vec<BlendError>> {
        let top = self.gon.clamp(1, PlanePolynomial::MAX_DEGREE);
        let across = self.across.clamp(top, suture_bernstein::MAX_DEGREE);
        let Kept { lengths, back_to_back, corners, arcs, .. } = kept;
        let mut rungs = vec![Rung::Degree(top); network.corners.len()];
        let mut orders = vec![ArcOrder::Degree(across); network.arcs.len()];
        for (a, arc) in network.arcs.iter().enumerate().filter(|(a, _)| back_to_back[*a]) {
            orders[a] = ArcOrder::Paper;
            arc.corners.iter().for_each(|&c| rungs[c] = Rung::Paper);
        }
        loop {
            let keys: Vec<CornerKey> =
                rungs.iter().enumerate().map(|(c, &rung)| CornerKey::new(c, rung, widths)).collect();
            let results: Vec<_> = (corners.par_iter_mut().zip(&keys).enumerate())
                .map(|(c, (known, &key))| {
                    known.get(key, || CornerBuild::new(network, lengths, c, key.rung, widths))
                })
                .collect();
            let corners: Vec<Arc<CornerBuild>> = all(results)?;
            let results: Vec<_> = (arcs.par_iter_mut().zip(&orders).enumerate())
                .map(|(a, (known, &order))| {
                    let ends = network.arcs[a].corners.map(|c| keys[c]);
                    let key = ArcKey { order, ends, shortest: widths.shortest[a] };
                    known.get(key, || ArcBuild::new(network, &lengths[a], a, &corners, widths, order))
                })
                .collect();
            let arcs: Vec<Arc<ArcBuild>> = all(results)?;
            let (rungs_before, orders_before) = (rungs.clone(), orders.clone());
            for (c, build) in corners.iter().enumerate() {
                if let Rung::Degree(degree) = rungs[c]
                    && build.poor
                {
                    rungs[c] = if degree > 1 { Rung::Degree(1) } else { Rung::Paper };
                }
            }
            for (a, build) in arcs.iter().enumerate().filter(|(_, build)| build.folds.contains(&true)) {
                let folds = build.folds;
                let ends = network.arcs[a].corners;
                let mut lower = |c: usize, to: Rung| rungs[c] = rungs[c].min(to);
                match orders[a] {
                    ArcOrder::Degree(q) if q > 1 => {
                        orders[a] = ArcOrder::Degree(1);
                        ends.iter().for_each(|&c| lower(c, Rung::Degree(1)));
                    }
                    ArcOrder::Degree(_) => {
                        for (e, c) in ends.into_iter().enumerate() {
                            if folds[e] && widths.reductions[c] >= PAPER_CORNER {
                                lower(c, Rung::Paper);
                            }
                        }
                        if folds[2] && ends.iter().any(|&c| widths.reductions[c] >= PAPER_ARC) {
                            orders[a] = ArcOrder::Paper;
                            ends.iter().for_each(|&c| lower(c, Rung::Paper));
                        }
                    }
                    ArcOrder::Paper => {}
                }
            }
            if (rungs_before, orders_before) == (rungs.clone(), orders.clone()) {
                return Ok(assemble(network, &corners, &arcs));
            }
        }
    }
}

/// Whether the surfaces along an arc turn their backs to each other: no line meets both of them there, as along the edge of a fin.
fn back_to_back(network: &Network, arc: &ArcCurve) -> bool {
    let normal = |segment: usize, at| network.surfaces[segment].jet(at).normal();
    let turned =
        arc.samples.iter().filter(|s| match (normal(arc.left, s.left), normal(arc.right, s.right)) {
            (Some(l), Some(r)) => l.dot(r) < LEAST_AGREEMENT,
            _ => true,
        });
    turned.count() as f64 > MOST_TURNED * arc.samples.len() as f64
}

/// Step of the ladder on which a corner stands, the lowest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rung {
    Paper,
    Degree(usize),
}

/// How the strips of an arc are made. The paper's need its maps at both ends.
#[derive(Clone, Copy, PartialEq)]
enum ArcOrder {
    /// This degree across.
    Degree(usize),
    Paper,
}

/// Lattice of the N-gon enlarged for the fit, its centre and `k (k + 1)/2` points per sector.
fn gon_lattice(valence: usize, k: usize) -> Vec<DVec2> {
    let r = gon::corners(valence);
    let mut points = vec![DVec2::ZERO];
    for i in 0..valence {
        let (a, b) = (r[i] * ENLARGEMENT, r[(i + 1) % valence] * ENLARGEMENT);
        points
            .extend((1..=k).flat_map(|i| (0..=k - i).map(move |j| (a * i as f64 + b * j as f64) / k as f64)));
    }
    points
}

/// Where the maps of an N-gon are tested.
fn gon_samples(valence: usize) -> Vec<DVec2> {
    gon_lattice(valence, 6)
}

/// The maps of an N-gon and what the arcs need of them.
struct CornerBuild {
    /// `None` for the maps of the paper.
    layout: Option<Layout>,
    gon: Vec<PlanePolynomial>,
    missed: Missed,
    /// Whether a map folds, or most lines missed their surfaces.
    poor: bool,
    /// The paper's strips with the distance of their connection points, where there is no layout.
    paper: Option<paper::CornerBuild>,
}

/// How many lines were shot, and how many met nothing.
#[derive(Clone, Copy, Default)]
struct Missed {
    lines: usize,
    missed: usize,
}

impl Missed {
    fn add(self, other: Self) -> Self {
        Self { lines: self.lines + other.lines, missed: self.missed + other.missed }
    }

    fn share(self) -> f64 {
        if self.lines > 0 { self.missed as f64 / self.lines as f64 } else { 0.0 }
    }
}

impl CornerBuild {
    fn new(
        network: &Network,
        lengths: &[Vec<f64>],
        index: usize,
        rung: Rung,
        widths: &Widths,
    ) -> Result<Self, BlendError> {
        let corner = &network.corners[index];
        let s = widths.corner[index];
        if let Rung::Degree(degree) = rung
            && let Some(layout) = Layout::new(network, lengths, corner, s)
        {
            let mut missed = Missed::default();
            let projection = GonProjection::new(corner.arcs.len(), degree)?;
            let gon: Option<Vec<_>> = (0..corner.arcs.len())
                .map(|i| {
                    let surface = &network.surfaces[network.segment(corner, i)];
                    let start = corner_parameter(network, corner, i);
                    let values: Vec<DVec2> = projection
                        .samples
                        .iter()
                        .map(|&p| shoot(surface, layout.target(p), layout.normal, start, s, &mut missed))
                        .collect();
                    projection.fit(&values)
                })
                .collect();
            if let Some(gon) = gon {
                let samples = gon_samples(corner.arcs.len());
                let folds =
                    |map: &PlanePolynomial| jacobian(samples.iter().map(|&p| map.jet(p))) <= LEAST_JACOBIAN;
                let poor = missed.share() > MOST_MISSED || gon.iter().any(folds);
                return Ok(Self { layout: Some(layout), gon, missed, poor, paper: None });
            }
        }
        let build = paper::corner_maps(network, lengths, corner, widths, index)?;
        let (gon, missed) = (build.maps.gon.clone(), Missed::default());
        Ok(Self { layout: None, gon, missed, poor: false, paper: Some(build) })
    }
}

/// Parameter of a corner in its segment `i`.
fn corner_parameter(network: &Network, corner: &Corner, i: usize) -> DVec2 {
    let ArcEnd { arc, starts } = corner.arcs[i];
    let samples = &network.arcs[arc].samples;
    if starts { samples[0].left } else { samples[samples.len() - 1].right }
}

/// The parameter where the line through `y` along `n` meets the surface, or of the point nearest to `y` if it does not.
fn shoot(
    surface: &suture_bernstein::BSplineSurface<DVec3>,
    y: DVec3,
    n: DVec3,
    start: DVec2,
    width: f64,
    missed: &mut Missed,
) -> DVec2 {
    missed.lines += 1;
    line::meet(surface, &Line::new(y, n), start, width).unwrap_or_else(|| {
        missed.missed += 1;
        line::nearest(surface, y, start)
    })
}

/// A node of the reference map: a cross line with its normal, by arc length.
enum Cross {
    /// On the arc: centre, vector to the left, normal, and half the width, each with two derivatives.
    Arc { centre: Jet, left: Jet, normal: Jet, half: [f64; 3] },
    /// On the edge of an N-gon: the edge from right to left, and `±1/κ`.
    Gon { edge: [DVec2; 2], outward: f64 },
}

impl Cross {
    fn at(&self, v: f64, layout: Option<&Layout>) -> (Jet, Jet) {
        match (self, layout) {
            (Self::Arc { centre, left, normal, half }, _) => {
                let side = 2.0 * v - 1.0;
                let [s, s1, s2] = half.map(|h| side * h);
                let offset = Jet {
                    value: left.value * s,
                    d: left.d * s + left.value * s1,
                    dd: left.dd * s + left.d * (2.0 * s1) + left.value * s2,
                };
                (centre.mix(1.0, offset, 1.0), *normal)
            }
            (Self::Gon { edge, outward }, Some(layout)) => {
                let [p, d, dd] = edge_jet(&layout.plane, *edge, *outward, v);
                let lift = |x: DVec2| layout.axes[0] * x.x + layout.axes[1] * x.y;
                let y = Jet { value: layout.origin + lift(p), d: lift(d), dd: lift(dd) };
                (y, Jet { value: layout.normal, ..Jet::default() })
            }
            (Self::Gon { .. }, None) => Default::default(),
        }
    }
}

/// Value and the first two derivatives of `map` across an edge of the N-gon, with the outward direction scaled by `outward`.
fn edge_jet(map: &PlanePolynomial, [right, left]: [DVec2; 2], outward: f64, v: f64) -> [DVec2; 3] {
    let nu = (0.5 * (right + left)).normalize_or_zero() * outward;
    let jet = map.jet(right.lerp(left, v));
    [
        jet.p,
        jet.du * nu.x + jet.dv * nu.y,
        jet.duu * (nu.x * nu.x) + jet.duv * (2.0 * nu.x * nu.y) + jet.dvv * (nu.y * nu.y),
    ]
}

/// The strips of an arc from N-gon to N-gon, `U` along the arc.
struct ArcBuild {
    strips: Vec<StripMaps>,
    /// Whether the first and the last strip are those beside the corners.
    adjacent: [bool; 2],
    missed: Missed,
    /// Whether a strip folds: beside the start, beside the end, between.
    folds: [bool; 3],
}

/// One end of an arc as its chain sees it.
struct End<'a> {
    build: &'a CornerBuild,
    /// The arc among those of the corner.
    slot: usize,
    start: bool,
    /// Distance from the corner to the first cross line.
    reach: f64,
}

impl End<'_> {
    /// Edge of the N-gon that faces the arc, from right to left as seen along the arc.
    fn edge(&self) -> [DVec2; 2] {
        let n = self.build.gon.len();
        let r = gon::corners(n);
        let (before, after) = (r[(self.slot + n - 1) % n], r[self.slot]);
        if self.start { [before, after] } else { [after, before] }
    }

    /// Map of the N-gon into the chart on the left (`up`) or right of the arc.
    fn map(&self, up: bool) -> &PlanePolynomial {
        let n = self.build.gon.len();
        &self.build.gon[if up == self.start { self.slot } else { (self.slot + n - 1) % n }]
    }

    /// Scale of the outward direction that makes arc length the parameter.
    fn outward(&self, layout: &Layout) -> f64 {
        let speed = layout.speed(self.slot);
        if self.start { speed.recip() } else { -speed.recip() }
    }
}

impl ArcBuild {
    fn new(
        network: &Network,
        lengths: &[f64],
        index: usize,
        corners: &[Arc<CornerBuild>],
        widths: &Widths,
        order: ArcOrder,
    ) -> Result<Self, BlendError> {
        let arc = &network.arcs[index];
        let paper = arc.corners.map(|c| corners[c].paper.as_ref());
        let q = match (order, paper) {
            (ArcOrder::Paper, [Some(start), Some(end)]) => {
                let strips = paper::chain(network, lengths, index, [start, end], widths)?;
                return Ok(Self {
                    strips,
                    adjacent: [false; 2],
                    missed: Missed::default(),
                    folds: [false; 3],
                });
            }
            (ArcOrder::Degree(q), _) => q,
            (ArcOrder::Paper, _) => 1,
        };
        let total = lengths.last().copied().unwrap_or(0.0);
        let ends = [0, 1].map(|e| {
            let wanted = ArcEnd { arc: index, starts: e == 0 };
            let slot = network.corners[arc.corners[e]].arcs.iter().position(|x| *x == wanted).unwrap_or(0);
            let build = &*corners[arc.corners[e]];
            let reach = match (&build.layout, &build.paper) {
                (Some(layout), _) => layout.reach(slot),
                (None, Some(paper)) => paper.connections[slot],
                (None, None) => 0.0,
            };
            End { build, slot, start: e == 0, reach }
        });
        let s = [0, 1].map(|e| widths.corner[arc.corners[e]]);
        let mean = 0.5 * (s[0] + s[1]);
        let available = paper::room(network, index, total, [ends[0].reach, ends[1].reach], mean)?;
        let count = ((available / widths.shortest[index]).round() as usize).clamp(1, 10_000);
        let [from, to] = [ends[0].reach, total - ends[1].reach];
        let mut t: Vec<f64> = (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect();

        let stop = || BlendError::Inconsistent { what: format!("arc {index} has no direction") };
        let centre = Centre::new(network, arc, lengths, mean)?;
        let mut crosses: Vec<Cross> = t
            .iter()
            .map(|&t| {
                let (c, left, normal) = centre.at(t).ok_or_else(stop)?;
                Ok(Cross::Arc { centre: c, left, normal, half: half_width(s, [from, to], t) })
            })
            .collect::<Result<_, BlendError>>()?;
        for (end, corner) in ends.iter().zip(arc.corners) {
            if let Some(layout) = &end.build.layout {
                let h = layout.first_strip(end.slot);
                let cross = Cross::Gon { edge: end.edge(), outward: end.outward(layout) };
                if end.start {
                    t.insert(0, end.reach - h);
                    crosses.insert(0, cross);
                } else {
                    t.push(total - end.reach + h);
                    crosses.push(cross);
                }
            } else if end.build.paper.is_none() {
                return Err(BlendError::Inconsistent { what: format!("corner {corner} has no maps") });
            }
        }

        let across = Across::chebyshev(q)?;
        let exact = Across::interpolation(q)?;
        let layout_at =
            |k: usize| if k == 0 { ends[0].build.layout.as_ref() } else { ends[1].build.layout.as_ref() };
        let mut missed = Missed::default();
        let mut sides = [false, true].map(|up| (up, Vec::new()));
        for k in 0..t.len() - 1 {
            let h = t[k + 1] - t[k];
            let [mut down, mut up] = [Vec::new(), Vec::new()];
            let nodes: Vec<[(Jet, Jet); 2]> = across
                .nodes
                .iter()
                .map(|&v| [crosses[k].at(v, layout_at(k)), crosses[k + 1].at(v, layout_at(k + 1))])
                .collect();
            for u in lines() {
                let sample = sample_at(arc, lengths, t[k] + u * h);
                let [mut right, mut left] = [Vec::new(), Vec::new()];
                for pair in &nodes {
                    let [y, n] = [0, 1].map(|which| {
                        let pick = |jets: &(Jet, Jet)| if which == 0 { jets.0 } else { jets.1 };
                        blend_nodes(pick(&pair[0]), pick(&pair[1]), u, h)
                    });
                    let mut shoot = |segment: usize, start: DVec2| {
                        shoot(&network.surfaces[segment], y, n, start, mean, &mut missed)
                    };
                    right.push(shoot(arc.right, sample.right));
                    left.push(shoot(arc.left, sample.left));
                }
                down.push(across.fit(&right));
                up.push(across.fit(&left));
            }
            sides[0].1.push(down);
            sides[1].1.push(up);
        }
        let chains = sides
            .into_iter()
            .map(|(up, samples)| {
                let given = [0, 1].map(|e| end_node(&ends[e], up, &exact, s[e]));
                let [Some(first), Some(last)] = given else {
                    return Err(BlendError::Inconsistent { what: format!("arc {index} has no end") });
                };
                project::chain(&t, [first, last], &samples, mean)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let strips: Vec<StripMaps> = (0..t.len() - 1)
            .map(|k| {
                let h = t[k + 1] - t[k];
                let strip = |side: &[Node]| between(&side[k], &side[k + 1], [h; 2]);
                Ok(StripMaps { down: strip(&chains[0])?, up: strip(&chains[1])? })
            })
            .collect::<Result<_, BlendError>>()?;
        let adjacent = ends.map(|e| e.build.layout.is_some());
        let mut folds = [false; 3];
        for (k, strip) in strips.iter().enumerate() {
            let place = match k {
                0 if adjacent[0] => 0,
                k if k + 1 == strips.len() && adjacent[1] => 1,
                _ => 2,
            };
            let folded = |map| !(strip_jacobian(map) > LEAST_JACOBIAN);
            folds[place] |= folded(&strip.down) || folded(&strip.up);
        }
        Ok(Self { strips, adjacent, missed, folds })
    }
}

/// Half of the width at `t` with its derivatives: from corner to corner, constant to second order at both first cross lines.
fn half_width([a, b]: [f64; 2], [from, to]: [f64; 2], t: f64) -> [f64; 3] {
    let h = to - from;
    let u = ((t - from) / h).clamp(0.0, 1.0);
    let step = 0.5 * (b - a);
    [
        0.5 * a + step * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u),
        step * 30.0 * u * u * (1.0 - u) * (1.0 - u) / h,
        step * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (h * h),
    ]
}

fn blend_nodes(start: Jet, end: Jet, u: f64, h: f64) -> DVec3 {
    let [a, e] = hermite(u);
    start.value * a[0]
        + start.d * (a[1] * h)
        + start.dd * (a[2] * h * h)
        + end.value * e[0]
        + end.d * (e[1] * h)
        + end.dd * (e[2] * h * h)
}

/// The node where a chain meets its corner, in one chart: on the edge of the N-gon, or where the paper's adjacent strip begins.
fn end_node(end: &End<'_>, up: bool, exact: &Across, width: f64) -> Option<Node> {
    if let Some(layout) = &end.build.layout {
        let (map, edge, outward) = (end.map(up), end.edge(), end.outward(layout));
        let jets: Vec<[DVec2; 3]> = exact.nodes.iter().map(|&v| edge_jet(map, edge, outward, v)).collect();
        let [p, d, dd] = [0, 1, 2].map(|k| exact.fit(&jets.iter().map(|j| j[k]).collect::<Vec<_>>()));
        return Some(Node { p, d, dd });
    }
    let strip = &end.build.paper.as_ref()?.maps.strips[end.slot];
    // Seen from the start the strip runs against the arc: its ↓ is the chain's ↑.
    let node = paper::end_node(if up == end.start { &strip.down } else { &strip.up }, end.start);
    // Its rows are half an apothem apart: their difference is the derivative by 5/2 apothems of arc length.
    let speed = 2.5 * gon::apothem(end.build.gon.len()) * width;
    let raise = |ends: &[DVec2], scale: f64| -> Vec<DVec2> {
        exact.nodes.iter().map(|&v| ends[0].lerp(ends[1], v) * scale).collect()
    };
    Some(Node { p: raise(&node.p, 1.0), d: raise(&node.d, speed.recip()), dd: raise(&node.dd, 0.0) })
}

fn assemble(network: &Network, corners: &[Arc<CornerBuild>], arcs: &[Arc<ArcBuild>]) -> MapSet {
    let mut missed = Missed::default();
    let mut chains: Vec<Vec<StripMaps>> = Vec::new();
    let mut strips: Vec<Vec<Option<StripMaps>>> =
        network.corners.iter().map(|c| vec![None; c.arcs.len()]).collect();
    for (a, build) in arcs.iter().enumerate() {
        let mut chain = build.strips.clone();
        missed = missed.add(build.missed);
        for (e, &c) in network.arcs[a].corners.iter().enumerate() {
            let slot = network.corners[c].arcs.iter().position(|x| *x == ArcEnd { arc: a, starts: e == 0 });
            if let Some(slot) = slot.filter(|_| build.adjacent[e]) {
                strips[c][slot] = if e == 0 { Some(turned(chain.remove(0))) } else { chain.pop() };
            }
        }
        chains.push(chain);
    }
    let corners = corners
        .iter()
        .zip(strips)
        .map(|(build, strips)| {
            missed = missed.add(build.missed);
            match &build.paper {
                Some(paper) => paper.maps.clone(),
                None => {
                    CornerMapSet { gon: build.gon.clone(), strips: strips.into_iter().flatten().collect() }
                }
            }
        })
        .collect();
    MapSet { corners, chains, missed: missed.share() }
}

/// The same strip walked the other way: what was on the right is on the left.
fn turned(strip: StripMaps) -> StripMaps {
    let turn = |mut map: BezierPatch<DVec2>| {
        let net = map.net().iter().rev().copied().collect();
        if let Ok(patch) = BezierPatch::new(map.degree(), net) {
            map = patch;
        }
        map
    };
    StripMaps { down: turn(strip.up), up: turn(strip.down) }
}
