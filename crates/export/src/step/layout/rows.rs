//! Blocks: strips in rows, N-gons as kites.

use glam::DVec2;
use suture_surface::{Domain, Jet2, PatchKind, Surface};

use super::nodes::{Halves, Ruler};
use super::topology::{Topology, Vertex};
use super::{Block, Piece};

/// The patch and edge that continue a strip, and the ratio of the lengths of their intervals.
type Join = (usize, usize, f64);

/// How far, relative to the derivatives, rectangles may be from joining C².
const JOIN: f64 = 1e-7;

/// The blocks of all patches that are no exact faces.
pub(crate) fn blocks(
    surface: &Surface,
    topology: &Topology,
    face_of: &[Option<usize>],
    halves: &Halves,
) -> Vec<Block> {
    let joins = joins(surface, topology, face_of);
    let mut done: Vec<bool> = face_of.iter().map(Option::is_some).collect();
    let mut blocks = Vec::new();
    // Rows begin at one of their ends; what is left then are rings, which begin anywhere.
    for ends_only in [true, false] {
        for p in 0..done.len() {
            let linked: Vec<usize> = (0..4).filter(|&e| joins[p][e].is_some()).collect();
            if done[p] || (ends_only && linked.len() > 1) {
                continue;
            }
            match &topology.domains[p] {
                Domain::Rectangle { .. } => {
                    // The row leaves this patch on its right side.
                    let turn = linked.first().map_or(0, |&e| (e + 3) % 4);
                    blocks.push(row(topology, &joins, halves, &mut done, p, turn));
                }
                Domain::Polygon(corners) => {
                    done[p] = true;
                    blocks.extend(kites(topology, halves, p, corners));
                }
                Domain::Trimmed(_) => {}
            }
        }
    }
    blocks
}

/// Across which edges of strips the next one continues the parameters, and the ratio of the lengths of their intervals.
fn joins(surface: &Surface, topology: &Topology, face_of: &[Option<usize>]) -> Vec<[Option<Join>; 4]> {
    let strip = |p: usize| {
        matches!(surface.patches()[p].kind(), PatchKind::Strip { .. } | PatchKind::AdjacentStrip)
            && matches!(topology.domains[p], Domain::Rectangle { .. })
    };
    // Beside the row lie exact faces, or nothing: their curves are cut as the row is.
    let free = |p: usize, edge: usize| {
        [1, 3].iter().all(|s| {
            topology.across(p, (edge + s) % 4).is_none_or(|(q, _, same)| face_of[q].is_some() && !same)
        })
    };
    let mut joins = vec![[None; 4]; topology.domains.len()];
    for p in (0..joins.len()).filter(|&p| strip(p)) {
        for edge in 0..4 {
            if let Some((q, f, false)) = topology.across(p, edge)
                && q != p
                && strip(q)
                && free(p, edge)
                && free(q, f)
            {
                let block = |patch: usize, turn: usize| {
                    let ruler = Ruler { halves: Vec::new(), broken: false };
                    let pieces = vec![piece(topology, patch, turn, [0.0, 1.0], ruler.clone())];
                    Block { pieces, height: 1.0, ruler }
                };
                let (a, b) = (block(p, (edge + 3) % 4), block(q, (f + 1) % 4));
                joins[p][edge] = ratio(surface, &a, &b).map(|ratio| (q, f, ratio));
            }
        }
    }
    // What joins one way joins the other way: rounding may not decide otherwise.
    for p in 0..joins.len() {
        for edge in 0..4 {
            if let Some((q, f, ratio)) = joins[p][edge] {
                let back: Option<Join> = joins[q][f];
                joins[p][edge] = back.map(|_| (q, f, ratio));
            }
        }
    }
    joins
}

/// The ratio of the lengths of `b` and `a` with which `b` continues `a` C², if there is one.
fn ratio(surface: &Surface, a: &Block, b: &Block) -> Option<f64> {
    let sites = [0.0, 0.17, 0.5, 0.71, 1.0];
    let jets = sites.map(|y| (a.jet(surface, 0, 1.0, y), b.jet(surface, 0, 0.0, y)));
    let sum = |f: &dyn Fn(&(Jet2, Jet2)) -> f64| jets.iter().map(f).sum::<f64>();
    let ratio = sum(&|(a, b)| a.du.dot(b.du)) / sum(&|(a, _)| a.du.length_squared());
    let good = ratio > 1e-3
        && ratio < 1e3
        && jets.iter().all(|(a, b)| {
            let first = (a.du * ratio).distance(b.du);
            let second = (a.duu * ratio * ratio).distance(b.duu);
            first <= JOIN * b.du.length() && second <= JOIN * (b.du.length() + b.duu.length())
        });
    good.then_some(ratio)
}

fn piece(topology: &Topology, patch: usize, turn: usize, span: [f64; 2], ruler: Ruler) -> Piece {
    let corner =
        |k: usize| topology.domains[patch].edge((turn + k) % 4).map_or(DVec2::ZERO, |e| e.point(0.0));
    let vertex = |k: usize| topology.corner(patch, (turn + k) % 4);
    Piece { patch, quad: [0, 1, 2, 3].map(corner), corners: [0, 1, 2, 3].map(vertex), span, ruler }
}

/// The row that begins with `patch`, whose edge `turn` is its bottom.
fn row(
    topology: &Topology,
    joins: &[[Option<Join>; 4]],
    halves: &Halves,
    done: &mut [bool],
    patch: usize,
    turn: usize,
) -> Block {
    let ruler = |p: usize, e: usize| halves.ruler(topology.first[p] + e);
    let (mut p, mut turn) = (patch, turn);
    let mut pieces = Vec::new();
    let (mut at, mut length) = (0.0, 1.0);
    let side = ruler(p, (turn + 1) % 4);
    loop {
        done[p] = true;
        pieces.push(piece(topology, p, turn, [at, at + length], ruler(p, turn)));
        at += length;
        match joins[p][(turn + 1) % 4] {
            Some((q, f, ratio)) if !done[q] => {
                length *= ratio;
                (p, turn) = (q, (f + 1) % 4);
            }
            _ => break,
        }
    }
    Block { pieces, height: 1.0, ruler: side }
}

fn kites<'a>(
    topology: &'a Topology,
    halves: &Halves,
    patch: usize,
    corners: &'a [DVec2],
) -> impl Iterator<Item = Block> + use<'a> {
    let n = corners.len();
    let first = topology.first[patch];
    let halves: Vec<[Ruler; 2]> =
        (0..n).map(|k| [halves.half(first + k, false), halves.half(first + (k + n - 1) % n, true)]).collect();
    let centre = corners.iter().sum::<DVec2>() / n as f64;
    let middle = move |k: usize| (corners[k] + corners[(k + 1) % n]) * 0.5;
    halves.into_iter().enumerate().map(move |(k, [a, b])| {
        let before = (k + n - 1) % n;
        let vertices = [
            topology.corner(patch, k),
            topology.middle(patch, k),
            Vertex::Centre(patch),
            topology.middle(patch, before),
        ];
        let quad = [corners[k], middle(k), centre, middle(before)];
        let piece = Piece { patch, quad, corners: vertices, span: [0.0, 0.5], ruler: a };
        Block { pieces: vec![piece], height: 0.5, ruler: b }
    })
}
