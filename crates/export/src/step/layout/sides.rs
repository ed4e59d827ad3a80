//! Edges: which sides of blocks and which edges of exact faces lie on each other.

use super::nodes::{Halves, Ruler};
use super::topology::Topology;
use super::{Block, LayoutEdge, Use};

/// Part of a side of a block: an edge of a patch, from one parameter to another, and what `a` or `b` is there.
#[derive(Clone, Debug)]
struct Stretch {
    patch: usize,
    edge: usize,
    t: [f64; 2],
    block: usize,
    side: usize,
    s: [f64; 2],
    ruler: Ruler,
    whole: bool,
}

/// The parts of the sides of every block that lie on edges of patches, in the order of the side's parameter.
fn stretches(topology: &Topology, blocks: &[Block]) -> Vec<[Vec<Stretch>; 4]> {
    let kite = |b: usize| blocks[b].height < 1.0;
    let mut corner = vec![0; topology.domains.len()];
    (0..blocks.len())
        .map(|block| {
            let mut sides: [Vec<Stretch>; 4] = Default::default();
            if kite(block) {
                let patch = blocks[block].pieces[0].patch;
                let n = topology.domains[patch].edge_count();
                let k = corner[patch];
                corner[patch] += 1;
                let base = Stretch {
                    patch,
                    edge: k,
                    t: [0.0, 0.5],
                    block,
                    side: 0,
                    s: [0.0, 0.5],
                    ruler: blocks[block].pieces[0].ruler.clone(),
                    whole: true,
                };
                let ruler = blocks[block].ruler.clone();
                sides[3].push(Stretch {
                    edge: (k + n - 1) % n,
                    side: 3,
                    t: [1.0, 0.5],
                    ruler,
                    ..base.clone()
                });
                sides[0].push(base);
                return sides;
            }
            let last = blocks[block].pieces.len() - 1;
            for (k, piece) in blocks[block].pieces.iter().enumerate() {
                let patch = piece.patch;
                let is = |e: &usize| {
                    topology.domains[patch].edge(*e).is_some_and(|c| c.point(0.0) == piece.quad[0])
                };
                let turn = (0..4).find(is).unwrap_or_default();
                for side in 0..4 {
                    let outer = match side {
                        1 => k == last,
                        3 => k == 0,
                        _ => true,
                    };
                    if outer {
                        let (s, ruler) = if side % 2 == 0 {
                            (piece.span, piece.ruler.clone())
                        } else {
                            ([0.0, 1.0], blocks[block].ruler.clone())
                        };
                        let t = if side < 2 { [0.0, 1.0] } else { [1.0, 0.0] };
                        let whole = side % 2 == 1 || last == 0;
                        let edge = (turn + side) % 4;
                        sides[side].push(Stretch { patch, edge, t, block, side, s, ruler, whole });
                    }
                }
            }
            sides
        })
        .collect()
}

/// A part of a stretch between the parameters `t` of its edge.
fn part(stretch: &Stretch, t: [f64; 2]) -> [f64; 2] {
    let at = |t: f64| {
        if t == stretch.t[0] {
            stretch.s[0]
        } else if t == stretch.t[1] {
            stretch.s[1]
        } else {
            let r = (t - stretch.t[0]) / (stretch.t[1] - stretch.t[0]);
            stretch.s[0] + (stretch.s[1] - stretch.s[0]) * r
        }
    };
    t.map(at)
}

/// All edges.
pub(crate) fn edges(
    topology: &Topology,
    face_of: &[Option<usize>],
    blocks: &[Block],
    halves: &Halves,
) -> Vec<LayoutEdge> {
    let sides = stretches(topology, blocks);
    // Which stretches lie on an edge.
    let mut on: Vec<Vec<Stretch>> = vec![Vec::new(); topology.patch_of.len()];
    for stretch in sides.iter().flatten().flatten() {
        on[topology.first[stretch.patch] + stretch.edge].push(stretch.clone());
    }
    let mut edges = Vec::new();
    for stretches in sides.iter().flatten() {
        let mut last: Option<(usize, usize, usize)> = None;
        for stretch in stretches {
            let e = topology.first[stretch.patch] + stretch.edge;
            let across = topology.across(stretch.patch, stretch.edge);
            let [t0, t1] = stretch.t;
            let cuts = if halves.broken(e) && (t1 - t0).abs() > 0.75 {
                vec![([t0, 0.5], stretch.ruler.half(false)), ([0.5, t1], stretch.ruler.half(true))]
            } else {
                vec![([t0, t1], stretch.ruler.clone())]
            };
            for (t, ruler) in cuts {
                let s = part(stretch, t);
                let own = Use::Block { block: stretch.block, side: stretch.side, ends: s };
                let ends = t.map(|t| topology.vertex(stretch.patch, stretch.edge, t));
                let mut edge = LayoutEdge {
                    ends,
                    joints: s.to_vec(),
                    uses: vec![own],
                    rulers: vec![Some(ruler.clone())],
                };
                let Some((q, f, same)) = across else {
                    edges.push(edge);
                    continue;
                };
                let u = if same { t } else { t.map(|t| 1.0 - t) };
                if let Some(face) = face_of[q] {
                    // Consecutive edges of one exact face along one side are one edge. Both walk with themselves on the left: the
                    // face passes the bottom of a block against `a`, its top along `a`.
                    let domain = &topology.domains[q];
                    let goes_on = |before: usize| match stretch.side {
                        0 => domain.next_edge(f) == before,
                        _ => domain.next_edge(before) == f,
                    };
                    let one_piece = t == stretch.t && stretch.side % 2 == 0 && !same;
                    match last {
                        Some((number, face_before, before))
                            if one_piece && face_before == face && goes_on(before) =>
                        {
                            let whole: &mut LayoutEdge = &mut edges[number];
                            whole.ends[1] = edge.ends[1];
                            whole.joints.push(s[1]);
                            whole.rulers.push(Some(ruler));
                            for one in &mut whole.uses {
                                match one {
                                    Use::Block { ends, .. } => ends[1] = s[1],
                                    Use::Exact { parts, .. } => parts.push((f, u)),
                                }
                            }
                            last = Some((number, face, f));
                        }
                        _ => {
                            last = one_piece.then_some((edges.len(), face, f));
                            edge.uses.push(Use::Exact { face, parts: vec![(f, u)] });
                            edges.push(edge);
                        }
                    }
                    continue;
                }
                let lies = |x: &&Stretch| {
                    let [lo, hi] = [x.t[0].min(x.t[1]), x.t[0].max(x.t[1])];
                    u.iter().all(|&u| lo <= u && u <= hi)
                };
                let Some(other) = on[topology.first[q] + f].iter().find(lies) else {
                    edges.push(edge);
                    continue;
                };
                let mine = (!(stretch.whole && t == stretch.t), stretch.block, stretch.side);
                let other_whole = other.whole && (u == other.t || [u[1], u[0]] == other.t);
                if mine < (!other_whole, other.block, other.side) {
                    edge.uses.push(Use::Block { block: other.block, side: other.side, ends: part(other, u) });
                    edges.push(edge);
                }
            }
        }
    }
    edges.extend(spokes(topology, blocks));
    edges.extend(exact_edges(topology, face_of));
    edges
}

/// The edges from the middles of the edges of an N-gon to its centre: right side of one kite, top of the next.
fn spokes(topology: &Topology, blocks: &[Block]) -> Vec<LayoutEdge> {
    let mut edges = Vec::new();
    let mut seen: Vec<usize> = vec![0; topology.domains.len()];
    for (b, block) in blocks.iter().enumerate().filter(|(_, block)| block.height < 1.0) {
        let piece = &block.pieces[0];
        let n = topology.domains[piece.patch].edge_count();
        seen[piece.patch] += 1;
        let next = if seen[piece.patch] == n { b + 1 - n } else { b + 1 };
        edges.push(LayoutEdge {
            ends: [piece.corners[1], piece.corners[2]],
            joints: vec![0.0, 0.5],
            uses: vec![
                Use::Block { block: b, side: 1, ends: [0.0, 0.5] },
                Use::Block { block: next, side: 2, ends: [0.0, 0.5] },
            ],
            rulers: vec![Some(block.ruler.clone())],
        });
    }
    edges
}

/// Edges between exact faces, and their borders.
fn exact_edges(topology: &Topology, face_of: &[Option<usize>]) -> Vec<LayoutEdge> {
    let mut edges = Vec::new();
    for (p, face) in face_of.iter().enumerate() {
        let Some(face) = *face else { continue };
        for e in 0..topology.domains[p].edge_count() {
            let whole = Use::Exact { face, parts: vec![(e, [0.0, 1.0])] };
            let ends = [0.0, 1.0].map(|t| topology.vertex(p, e, t));
            let mut edge = LayoutEdge { ends, joints: vec![0.0, 1.0], uses: vec![whole], rulers: vec![None] };
            match topology.across(p, e) {
                None => edges.push(edge),
                Some((q, f, same)) => {
                    // Blocks have seen to theirs; of two exact faces the first one does.
                    if let Some(other) = face_of[q]
                        && (p, e) < (q, f)
                    {
                        let t = if same { [0.0, 1.0] } else { [1.0, 0.0] };
                        edge.uses.push(Use::Exact { face: other, parts: vec![(f, t)] });
                        edges.push(edge);
                    }
                }
            }
        }
    }
    edges
}
