//! The maps of the paper: an affine N-gon, strips of degree (5, 1) that mimic the angle of the arcs, chains along the arcs
//! (Wagner, Hormann, Greiner, *C²-continuous surface reconstruction with piecewise polynomial patches*, 2003, Sections 6.3–6.5).
//!
//! Departures from the print: the steps of (17), (19), (21), (23) carry the scaling S; chains begin at the connection points, not
//! at the corners; points of an arc are taken at equal arc length from a smooth curve instead of from mesh vertices; the
//! width may differ from corner to corner and then varies linearly along the arc, which leaves (G1)–(G4) exact because both
//! ends of a cross line share their derivatives.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat2, DVec2, DVec3};
use suture_bernstein::{BSplineSurface, BezierPatch};

use crate::maps::{CornerMapSet, CornerMaps, MapSet, Memory, Node, StripMaps, all, between, bezier};
use crate::metric::isometry;
use crate::network::{Ray, sample_at};
use crate::polynomial::PlanePolynomial;
use crate::widths::Widths;
use crate::{ArcCurve, ArcEnd, BlendError, Corner, Network, gon};

/// The maps of the paper: see the module's documentation.
#[derive(Clone, Copy, Debug, Default)]
pub struct PaperMaps;

/// Sharper angles (and reflex ones as close to a full turn) are laid out as if they were this wide: the reach of a corner grows like
/// 1/sin(α/2), 5.7 widths at 20° for N = 3, and no arc has room for that. C² does not depend on the angle; the blend then lies
/// beside the rays instead of on them.
const NARROWEST: f64 = 50.0 * std::f64::consts::PI / 180.0;

/// The same for corners whose width was reduced this often: strips of neighbouring arcs that are laid out too far apart cross each other
/// at every width, and narrow ones have room for the reach of the true angle.
const SHARPEST: f64 = 18.0 * std::f64::consts::PI / 180.0;
const REDUCED: u32 = 5;

/// Least length of a chain in widths: one strip a third as long as it is wide.
const SHORTEST_CHAIN: f64 = 0.3;

impl CornerMaps for PaperMaps {
    fn maps(&self, network: &Network, widths: &Widths, _: &mut Memory) -> Result<MapSet, Vec<BlendError>> {
        let lengths: Vec<Vec<f64>> = network.arcs.iter().map(ArcCurve::lengths).collect();
        let corners = network.corners.iter().enumerate();
        let built = all(corners.map(|(c, corner)| corner_maps(network, &lengths, corner, widths, c)))?;
        let arcs = network.arcs.iter().enumerate();
        let chains =
            all(arcs.map(|(i, arc)| chain(network, &lengths[i], i, arc.corners.map(|c| &built[c]), widths)))?;
        Ok(MapSet { corners: built.into_iter().map(|b| b.maps).collect(), chains, missed: 0.0 })
    }
}

/// The maps around a corner and, per arc, how far from the corner its connection points lie (the farther of the two sides).
pub(crate) struct CornerBuild {
    pub(crate) maps: CornerMapSet,
    pub(crate) connections: Vec<f64>,
}

pub(crate) fn corner_maps(
    network: &Network,
    lengths: &[Vec<f64>],
    corner: &Corner,
    widths: &Widths,
    index: usize,
) -> Result<CornerBuild, BlendError> {
    let n = corner.arcs.len();
    let (s, inner) = (widths.corner[index], widths.inner);
    let narrowest = if widths.reductions[index] < REDUCED { NARROWEST } else { SHARPEST };
    let sectors: Vec<Sector> =
        (0..n).map(|i| sector(network, lengths, corner, i, s, inner, narrowest)).collect::<Result<_, _>>()?;
    let previous = |i: usize| &sectors[(i + n - 1) % n];
    let strips =
        (0..n).map(|i| StripMaps { down: sectors[i].down.clone(), up: previous(i).up.clone() }).collect();
    let connections = (0..n).map(|i| sectors[i].reach[0].max(previous(i).reach[1])).collect();
    let gon = sectors.into_iter().map(|s| s.gon).collect();
    Ok(CornerBuild { maps: CornerMapSet { gon, strips }, connections })
}

/// The maps of one corner into one segment.
struct Sector {
    gon: PlanePolynomial,
    /// Of the strip on the arc before the segment, into which the segment goes as ↓.
    down: BezierPatch<DVec2>,
    /// Of the strip on the arc after it, into which it goes as ↑.
    up: BezierPatch<DVec2>,
    /// Arc length from the corner to the connection points of the two strips.
    reach: [f64; 2],
}

fn sector(
    network: &Network,
    lengths: &[Vec<f64>],
    corner: &Corner,
    i: usize,
    s: f64,
    inner: f64,
    narrowest: f64,
) -> Result<Sector, BlendError> {
    let n = corner.arcs.len();
    let ray = |ArcEnd { arc, starts }| Ray::new(&network.arcs[arc], &lengths[arc], starts);
    let (next, prev) = (ray(corner.arcs[i]), ray(corner.arcs[(i + 1) % n]));
    debug_assert_eq!(next.left(), prev.right());
    let segment = network.segment(corner, i);
    let q = next.sample(0.0).left;
    let t = tangent_frame(&network.surfaces[segment], q, segment)?;
    let inverse = t.inverse();

    // Rays by the chord to the connection point, so that the connection point lies on the arc; its distance depends on the angle
    // between the rays: three rounds from a first guess settle it to far below a width.
    let mut reach = [1.2 * s; 2];
    let mut layout = None;
    for _ in 0..3 {
        let a = inverse * (next.sample(reach[0].min(next.length())).left - q);
        let b = inverse * (prev.sample(reach[1].min(prev.length())).right - q);
        let start = a.to_angle();
        let alpha = (b.to_angle() - start).rem_euclid(TAU);
        if !alpha.is_finite() {
            return Err(BlendError::Singular { segment, at: q.into() });
        }
        let l = Layout::new(n, alpha.clamp(narrowest, TAU - narrowest), inner);
        reach = [s * l.connection(); 2];
        layout = Some((l, DVec2::from_angle(start + 0.5 * alpha - FRAC_PI_2)));
    }
    let Some((layout, bisector)) = layout else {
        return Err(BlendError::Singular { segment, at: q.into() });
    };
    let place = |x: DVec2| q + t * (s * bisector.rotate(x + DVec2::new(0.0, layout.shift)));
    let strip = |rows: [[DVec2; 2]; 6]| bezier(rows.map(|r| r.map(place).to_vec()));
    // In the frame of the N-gon of the corner, segment i is the first one turned by 2π i/N.
    let back = gon::rotation(n, i).conjugate();
    let linear = |x: DVec2| t * (s * bisector.rotate(back.rotate(x)));
    Ok(Sector {
        gon: PlanePolynomial::affine(place(DVec2::ZERO), linear(DVec2::X), linear(DVec2::Y)),
        down: strip(layout.down)?,
        up: strip(layout.up)?,
        reach,
    })
}

/// Conjugate of a unit complex number: the inverse rotation.
trait Conjugate {
    fn conjugate(self) -> Self;
}

impl Conjugate for DVec2 {
    fn conjugate(self) -> Self {
        DVec2::new(self.x, -self.y)
    }
}

fn tangent_frame(surface: &BSplineSurface<DVec3>, at: DVec2, segment: usize) -> Result<DMat2, BlendError> {
    isometry(&surface.jet(at)).ok_or(BlendError::Singular { segment, at: at.into() })
}

/// Control points of the two adjacent strips in the frame of the N-gon, for rays at an angle `α`: (14)–(24).
struct Layout {
    /// Rows `g_0 … g_5` along the strip ↓, each at `V = 0` and `V = 1`.
    down: [[DVec2; 2]; 6],
    /// The same of the strip ↑.
    up: [[DVec2; 2]; 6],
    /// The translation `t` along the bisector that puts the corner on the rays.
    shift: f64,
    /// The connection point of the strip ↑.
    end: DVec2,
}

impl Layout {
    fn new(n: usize, alpha: f64, inner: f64) -> Self {
        let r = gon::corners(n);
        let (r1, r2, rn) = (r[0], r[1], r[n - 1]);
        let d = gon::apothem(n);
        let (sigma, kappa) = (0.5 * alpha).sin_cos();
        let e_up = -(r1 + r2).normalize();
        let e_down = -(r1 + rn).normalize();
        let (mut up, mut down) = ([[DVec2::ZERO; 2]; 6], [[DVec2::ZERO; 2]; 6]);
        for i in 0..3 {
            let step = i as f64 * 0.5 * d;
            up[5 - i] = [r2 - step * e_up, r1 - step * e_up];
            down[5 - i] = [r1 - step * e_down, rn - step * e_down];
        }
        // The side that leads is the one that runs on straight from the N-gon; the other one keeps the distance 1 from it.
        for i in 0..3 {
            let step = (3 - i) as f64 * 0.5 * d;
            let (along_up, along_down) = (DVec2::new(-sigma, kappa) * step, DVec2::new(sigma, kappa) * step);
            if alpha >= TAU / n as f64 {
                let g = up[3][0] + along_up;
                up[i] = [g, g + DVec2::new(kappa, sigma)];
                let g = down[3][1] + along_down;
                down[i] = [g + DVec2::new(-kappa, sigma), g];
            } else {
                let g = up[3][1] + along_up;
                up[i] = [g + DVec2::new(-kappa, -sigma), g];
                let g = down[3][0] + along_down;
                down[i] = [g, g + DVec2::new(kappa, -sigma)];
            }
        }
        let x = up[0][0] + (1.0 - inner) * (up[0][1] - up[0][0]);
        let shift = -x.dot(DVec2::new(kappa, sigma)) / sigma;
        Self { down, up, shift, end: x + DVec2::new(0.0, shift) }
    }

    /// Distance of the connection points from the corner, in widths; the layout is symmetric about the bisector.
    fn connection(&self) -> f64 {
        self.end.length()
    }
}

/// Length that the `reach` of both corners leaves for the chain of an arc of length `total`, for a mean width `mean`.
///
/// # Errors
/// [`BlendError::ArcTooShort`] where no strip fits.
pub(crate) fn room(
    network: &Network,
    index: usize,
    total: f64,
    reach: [f64; 2],
    mean: f64,
) -> Result<f64, BlendError> {
    let available = total - reach[0] - reach[1];
    if available < SHORTEST_CHAIN * mean {
        let needed = (reach[0] + reach[1]) / mean + SHORTEST_CHAIN;
        return Err(BlendError::ArcTooShort {
            arc: index,
            corners: network.arcs[index].corners,
            length: total / network.diagonal,
            limit: total / needed / network.diagonal,
        });
    }
    Ok(available)
}

/// A node of a chain in one chart: the cross line with its derivatives, and the point of the arc that it stands for.
struct ChainNode {
    node: Node,
    point: DVec2,
}

pub(crate) fn chain(
    network: &Network,
    lengths: &[f64],
    index: usize,
    ends: [&CornerBuild; 2],
    widths: &Widths,
) -> Result<Vec<StripMaps>, BlendError> {
    let arc = &network.arcs[index];
    let total = lengths.last().copied().unwrap_or(0.0);
    let slot = |end: usize| {
        let wanted = ArcEnd { arc: index, starts: end == 0 };
        network.corners[arc.corners[end]].arcs.iter().position(|e| *e == wanted).unwrap_or(0)
    };
    let slots = [slot(0), slot(1)];
    let reach = [0, 1].map(|e| ends[e].connections[slots[e]]);
    let s = [0, 1].map(|e| widths.corner[arc.corners[e]]);
    let available = room(network, index, total, reach, 0.5 * (s[0] + s[1]))?;
    let strips = ((available / widths.shortest[index]).floor() as usize).clamp(1, 10_000);
    let stations: Vec<f64> = (1..strips).map(|k| reach[0] + available * k as f64 / strips as f64).collect();
    let width = |at: f64| s[0] + (s[1] - s[0]) * at / total;

    let side = |up: bool| -> Result<Vec<ChainNode>, BlendError> {
        // At the start, ↓ of the chain is ↑ of the adjacent strip, which runs against it: V turns round and U changes its sign.
        let first = &ends[0].maps.strips[slots[0]];
        let last = &ends[1].maps.strips[slots[1]];
        let start = end_node(if up { &first.down } else { &first.up }, true);
        let end = end_node(if up { &last.up } else { &last.down }, false);
        let segment = if up { arc.left } else { arc.right };
        let surface = &network.surfaces[segment];
        let share = if up { 1.0 - widths.inner } else { widths.inner };
        let on_arc = |node: &Node| node.p[0] * (1.0 - share) + node.p[1] * share;

        let mut points = vec![on_arc(&start)];
        points.extend(stations.iter().map(|&at| {
            let sample = sample_at(arc, lengths, at);
            if up { sample.left } else { sample.right }
        }));
        points.push(on_arc(&end));
        let second = |p: &[DVec2], i: usize| p[i + 1] - 2.0 * p[i] + p[i - 1];
        let unmoved = points.clone();
        for i in 1..strips {
            points[i] += widths.d_curv * second(&unmoved, i);
        }

        let mut nodes = vec![ChainNode { node: start, point: points[0] }];
        for i in 1..strips {
            let d = 0.5 * (points[i + 1] - points[i - 1]);
            let t = tangent_frame(surface, points[i], segment)?;
            let tilde = (t.inverse() * d).normalize_or_zero();
            let inward = t * if up { tilde.perp() } else { -tilde.perp() };
            let w = width(stations[i - 1]);
            let (p_in, p_out) =
                (points[i] + inward * (w * widths.inner), points[i] - inward * (w * (1.0 - widths.inner)));
            let p = if up { vec![p_out, p_in] } else { vec![p_in, p_out] };
            let dd = second(&points, i);
            nodes.push(ChainNode { node: Node { p, d: vec![d; 2], dd: vec![dd; 2] }, point: points[i] });
        }
        nodes.push(ChainNode { node: end, point: points[strips] });
        Ok(nodes)
    };
    let (down, up) = (side(false)?, side(true)?);
    (0..strips)
        .map(|k| {
            // ã and a of (30), (31), averaged over the two charts: common to both, as (G2)–(G4) demand.
            let scale = |node: usize| {
                let one = |side: &[ChainNode]| {
                    let chord = side[k + 1].point.distance(side[k].point);
                    chord / side[node].node.d[0].length().max(f64::MIN_POSITIVE)
                };
                0.5 * (one(&down) + one(&up))
            };
            let scales = [scale(k), scale(k + 1)];
            Ok(StripMaps {
                down: between(&down[k].node, &down[k + 1].node, scales)?,
                up: between(&up[k].node, &up[k + 1].node, scales)?,
            })
        })
        .collect()
}

/// The free end (`U = 0`) of an adjacent strip as a node of a chain.
pub(crate) fn end_node(strip: &BezierPatch<DVec2>, reversed: bool) -> Node {
    let columns = strip.degree()[1] + 1;
    let (row0, row1) = (&strip.net()[..columns], &strip.net()[columns..2 * columns]);
    let sign = if reversed { -5.0 } else { 5.0 };
    let mut p = row0.to_vec();
    let mut d: Vec<DVec2> = row0.iter().zip(row1).map(|(&a, &b)| (b - a) * sign).collect();
    if reversed {
        p.reverse();
        d.reverse();
    }
    // The second derivative vanishes there: rows 0 to 3 of the layout are equally spaced.
    Node { dd: vec![DVec2::ZERO; p.len()], p, d }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn determinant(net: &[[DVec2; 2]; 6], at: DVec2) -> f64 {
        let jet = BezierPatch::new([5, 1], net.concat()).unwrap().jet(at);
        jet.du.perp_dot(jet.dv)
    }

    #[test]
    fn connection_points_lie_where_the_specification_says() {
        for n in 3..=8 {
            let got = Layout::new(n, TAU / n as f64, 2.0 / 3.0).connection();
            assert!((got - crate::reach(n)).abs() < 1e-14, "N = {n}: {got}");
        }
        assert!((Layout::new(3, 20f64.to_radians(), 2.0 / 3.0).connection() - 5.7).abs() < 0.05);
    }

    #[test]
    fn rays_divide_the_end_lines_and_strips_do_not_fold() {
        for n in 3..=6 {
            for degrees in (20..=340).step_by(20) {
                let alpha = f64::from(degrees).to_radians();
                for inner in [0.5, 2.0 / 3.0] {
                    let layout = Layout::new(n, alpha, inner);
                    let (sigma, kappa) = (0.5 * alpha).sin_cos();
                    let shift = DVec2::new(0.0, layout.shift);
                    // ↑ lies towards −U: its ray points along (−σ, κ), that of ↓ along (σ, κ).
                    for (net, ray, inside) in [
                        (&layout.up, DVec2::new(-sigma, kappa), 1),
                        (&layout.down, DVec2::new(sigma, kappa), 0),
                    ] {
                        let (p_in, p_out) = (net[0][inside] + shift, net[0][1 - inside] + shift);
                        let on = p_in * (1.0 - inner) + p_out * inner;
                        assert!(on.perp_dot(ray).abs() < 1e-14 && on.dot(ray) > 0.0, "N = {n}, {degrees}°");
                        assert!((p_in.distance(p_out) - 1.0).abs() < 1e-14);
                        for j in 0..2 {
                            let along = net[1][j] - net[0][j];
                            assert!(along.perp_dot(ray).abs() < 1e-14 && along.dot(ray) < 0.0);
                        }
                        for i in 0..=8 {
                            for j in 0..=8 {
                                let at = DVec2::new(f64::from(i), f64::from(j)) / 8.0;
                                assert!(determinant(net, at) > 0.0, "N = {n}, {degrees}°, {at}");
                            }
                        }
                    }
                }
            }
        }
    }
}
