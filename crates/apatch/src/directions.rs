//! Better directions for the apexes of faces whose tetrahedra meet those beside them or are too tall (specification, section 9.4).
//!
//! Seen along an edge, its two faces, the walls up to their apexes and the tetrahedron between these are angles that add up to the
//! angle between the faces: `θ = φ + gap + φ'`. The tetrahedron is valid for `0 < gap < π`. One face at a time moves to the direction
//! that does its edges most good, the others held, until nothing improves.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;
use suture_mesh::Topology;

use crate::ApatchOptions;
use crate::apexes::{Apexes, Placed, Site};
use crate::coefficients::{Corners, EDGE};
use crate::hull::{Class, opposite_vertex};

/// Angles of edge tetrahedra below this are worth a search, in radians: thinner ones lose digits.
const THIN: f64 = 0.02;

/// Angles of edge tetrahedra that a search aims at.
const WIDE: f64 = 0.15;

/// Heights, in units of the square root of the area of the face, above which a search is worth it.
const TALL: f64 = 6.0;

/// Sweeps over all faces in question.
const SWEEPS: usize = 12;

/// Sweeps after which the neighbours of faces in question take part.
const NEAR: usize = 3;

/// Classes, corners and apexes, with what lies beside what.
pub(crate) struct Directions<'a> {
    pub(crate) corners: &'a [Corners],
    pub(crate) classes: &'a [Class],
    pub(crate) topology: &'a Topology,
    pub(crate) options: &'a ApatchOptions,
}

/// The angles around the edges of all faces.
struct Angles {
    /// Of the walls up to the apexes, by face, edge `j` (from corner `j`) and side.
    walls: Vec<[[f64; 2]; 3]>,
    /// From each face up to the one across, by half-edge.
    between: Vec<f64>,
}

impl Directions<'_> {
    /// Turns the apexes of faces in question; half-edges (the lower of each pair) whose tetrahedra are not valid after that.
    pub(crate) fn improve(&self, apexes: &mut [Apexes]) -> Vec<u32> {
        let mut angles = self.angles(apexes);
        let mut last = f64::INFINITY;
        for sweep in 0..SWEEPS {
            let faces = self.faces(apexes, &angles, sweep >= NEAR);
            let mut cost = 0.0;
            for &f in &faces {
                cost += self.turn(f, apexes, &angles);
                angles.walls[f] = self.wall_angles(f, &apexes[f]);
            }
            if faces.is_empty() || (sweep > NEAR && cost >= 0.999 * last) {
                break;
            }
            last = cost;
        }
        (0..self.topology.half_edge_count() as u32)
            .filter(|&h| self.topology.opposite(h).is_some_and(|o| h < o) && !self.is_wider(h, 0.0, &angles))
            .collect()
    }

    fn angles(&self, apexes: &[Apexes]) -> Angles {
        let faces: Vec<([[f64; 2]; 3], [f64; 3])> = (0..self.corners.len())
            .into_par_iter()
            .map(|f| (self.wall_angles(f, &apexes[f]), [0, 1, 2].map(|j| self.between((3 * f + j) as u32))))
            .collect();
        let (walls, between): (Vec<_>, Vec<_>) = faces.into_iter().unzip();
        Angles { walls, between: between.into_flattened() }
    }

    fn wall_angles(&self, f: usize, apexes: &Apexes) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|j| {
            let frame = Frame::new(&self.corners[f], opposite_vertex(j));
            [0, 1].map(|s| apexes.points[s].map_or(f64::NAN, |p| frame.height(p, s)))
        })
    }

    /// The angle from the face of a half-edge, through the positive side, to the one across.
    fn between(&self, h: u32) -> f64 {
        let Some(o) = self.topology.opposite(h) else { return f64::NAN };
        let frame = Frame::new(&self.corners[self.topology.face(h) as usize], opposite_vertex(h));
        frame.angle(self.corners[self.topology.face(o) as usize].p[opposite_vertex(o)]).rem_euclid(TAU)
    }

    /// Whether the tetrahedra of an edge with two faces, if any, keep their angles further than that from 0 and from `π`.
    fn is_wider(&self, h: u32, than: f64, angles: &Angles) -> bool {
        let Some(o) = self.topology.opposite(h) else { return true };
        let wall = |h: u32, s: usize| angles.walls[(h / 3) as usize][(h % 3) as usize][s];
        let sides = self.edge_class(h).sides();
        (0..2).all(|s| {
            let exists = [h, o].iter().all(|&h| self.classes[(h / 3) as usize].sides()[s]);
            let gap = across(angles.between[h as usize], s) - wall(h, s) - wall(o, s);
            // Written so that what is not a number is not wide.
            !(sides[s] && exists) || gap.min(PI - gap) > than
        })
    }

    /// Faces beside thin or wrong edge tetrahedra and those with tall apexes, in order; with all their neighbours if `wide`.
    fn faces(&self, apexes: &[Apexes], angles: &Angles, wide: bool) -> Vec<usize> {
        let tall = |f: usize| {
            let ([a, b, c], centre) = (self.corners[f].p, self.corners[f].centroid());
            let height =
                apexes[f].points.iter().flatten().fold(0.0_f64, |m, p| m.max(p.distance_squared(centre)));
            height > TALL * TALL * 0.5 * (b - a).cross(c - a).length()
        };
        let turns = |f: &usize| apexes[*f].d != DVec3::ZERO;
        let edges = |f: usize| (0..3).map(move |j| (3 * f + j) as u32);
        let mut faces: Vec<usize> = (0..self.corners.len())
            .into_par_iter()
            .filter(turns)
            .filter(|&f| tall(f) || edges(f).any(|h| !self.is_wider(h, THIN, angles)))
            .collect();
        if wide {
            let beside: Vec<usize> = faces
                .iter()
                .flat_map(|&f| edges(f).filter_map(|h| self.topology.opposite(h)))
                .map(|o| self.topology.face(o) as usize)
                .filter(turns)
                .collect();
            faces.extend(beside);
            faces.sort_unstable();
            faces.dedup();
        }
        faces
    }

    /// Turns the apexes of one face to the best direction found; what remains to be wished for.
    fn turn(&self, f: usize, apexes: &mut [Apexes], angles: &Angles) -> f64 {
        let site = Site::new(&self.corners[f], self.classes[f], self.options);
        let walls = self.walls(f, angles);
        let cost = |d: DVec3| -> Option<(f64, Placed)> {
            let placed = site.place(d);
            let cost = cost(&site, &placed, &walls)?;
            Some((cost, placed))
        };
        let before = apexes[f];
        let Some((mut least, _)) = cost(before.d) else { return 0.0 };
        let (mut best, mut found) = (before.d, None);
        let offer = |d: DVec3, least: &mut f64, best: &mut DVec3, found: &mut Option<Placed>| {
            if d.is_finite()
                && let Some((value, placed)) = cost(d)
                && value < *least - 1e-9
            {
                (*least, *best, *found) = (value, d, Some(placed));
            }
        };
        let centre = site.cap_centre();
        for d in [site.normal, site.mean(), site.rising_centre(), centre] {
            offer(d, &mut least, &mut best, &mut found);
        }
        for j in 0..3 {
            if let Some(o) = self.topology.opposite((3 * f + j) as u32) {
                // Walls that lean the same way cannot meet.
                let d = apexes[self.topology.face(o) as usize].d;
                offer(d, &mut least, &mut best, &mut found);
                offer((d + before.d).normalize_or_zero(), &mut least, &mut best, &mut found);
            }
        }
        let around = |d: DVec3, radius: f64, turn: f64| {
            let (x, y) = d.any_orthonormal_pair();
            (d + (x * turn.cos() + y * turn.sin()) * radius).normalize_or_zero()
        };
        for radius in [0.2, 0.45, 0.8, 1.4] {
            for k in 0..10 {
                offer(around(centre, radius, TAU * f64::from(k) / 10.0), &mut least, &mut best, &mut found);
            }
        }
        let mut radius = 0.15;
        for round in 0..6 {
            let from = best;
            for k in 0..6 {
                let turn = TAU * (f64::from(k) + 0.5 * f64::from(round % 2)) / 6.0;
                offer(around(from, radius, turn), &mut least, &mut best, &mut found);
            }
            radius *= if best == from { 0.5 } else { 1.0 };
        }
        if let Some(placed) = found {
            apexes[f] = Apexes {
                points: placed.points,
                d: best,
                turned: best != site.normal,
                steep: !site.is_good(&placed),
            };
        }
        least
    }

    /// What the neighbours leave of the angles over the edges of a face, its own part still to be taken off; by edge and side.
    fn walls(&self, f: usize, angles: &Angles) -> [Wall; 3] {
        [0, 1, 2].map(|j| {
            let h = (3 * f + j) as u32;
            let mut free = [None; 2];
            if let Some(o) = self.topology.opposite(h) {
                let (g, sides) = ((o / 3) as usize, self.edge_class(h).sides());
                for s in 0..2 {
                    if sides[s] && self.classes[g].sides()[s] {
                        let taken = angles.walls[g][(o % 3) as usize][s];
                        free[s] = Some(across(angles.between[h as usize], s) - taken);
                    }
                }
            }
            Wall { frame: Frame::new(&self.corners[f], opposite_vertex(h)), free }
        })
    }

    fn edge_class(&self, h: u32) -> Class {
        let (f, [i, j]) = ((h / 3) as usize, EDGE[opposite_vertex(h)]);
        Class::of_edge([self.corners[f].e[i][j], self.corners[f].e[j][i]])
    }
}

/// The angle between two faces on a side, given that on the positive one.
fn across(between: f64, s: usize) -> f64 {
    if s == 0 { between } else { TAU - between }
}

/// What a direction costs: narrow and wrong angles over the edges, height, steepness; `None` where there is no apex at all.
fn cost(site: &Site, placed: &Placed, walls: &[Wall; 3]) -> Option<f64> {
    // Not `<=`: what is not a number is no apex.
    if !(placed.lift > 1e-3 && placed.height.is_finite()) {
        return None;
    }
    let mut sum = 1e-3 * (1.0 + placed.height).ln() + 2e-3 * (placed.height / TALL).powi(2).min(1e4);
    if !site.is_good(placed) {
        // Worth only what cannot be had otherwise: where an m_k falls, the surface tears.
        sum += if placed.rises { 1e2 } else { 1e6 };
    }
    for wall in walls {
        for s in 0..2 {
            if let (Some(free), Some(p)) = (wall.free[s], placed.points[s]) {
                let gap = free - wall.frame.height(p, s);
                let q = gap.min(PI - gap);
                let lack = (1.0 - q / WIDE).max(0.0);
                sum += lack * lack;
                if q <= 0.0 {
                    sum += 10.0;
                }
            }
        }
    }
    Some(sum)
}

/// An edge of a face, and the angle over it that the neighbour leaves, by side.
struct Wall {
    frame: Frame,
    free: [Option<f64>; 2],
}

/// The plane across an edge of a face: into the face, and up.
struct Frame {
    origin: DVec3,
    into: DVec3,
    up: DVec3,
}

impl Frame {
    fn new(corners: &Corners, k: usize) -> Self {
        let [i, j] = EDGE[k];
        let (a, b, c) = (corners.p[i], corners.p[j], corners.p[k]);
        let up = (b - a).cross(c - a).normalize_or_zero();
        Self { origin: a, into: up.cross(b - a).normalize_or_zero(), up }
    }

    /// The angle around the edge of a point, from the face upwards.
    fn angle(&self, p: DVec3) -> f64 {
        let d = p - self.origin;
        d.dot(self.up).atan2(d.dot(self.into))
    }

    /// The angle of an apex over the face on a side.
    fn height(&self, p: DVec3, s: usize) -> f64 {
        let angle = self.angle(p);
        if s == 0 { angle } else { -angle }
    }
}
