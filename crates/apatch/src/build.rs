//! The construction: mesh and normals to implicit surface.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use suture_mesh::normals::{AngleWeighted, EstimateNormals, LoopLimit, smallest_cap};
use suture_mesh::{Topology, TriMesh};

use crate::bounds::{Raise, Verdict, bound_face, certify_edge, certify_face, raise_edge};
use crate::coefficients::EDGE;
use crate::edge::{EdgeForm, EdgeSide};
use crate::face::{Base, FaceForm, FaceSide};
use crate::hull::{Class, Hull, against, opposite_vertex};
use crate::report::{ApatchReport, ClassCounts};
use crate::unfold::Unfolded;
use crate::{ApatchError, ApatchOptions, ApatchSurface, ApexWeight, intersect, refine, unfold};

/// Smallest height of a face over its longest edge, relative to that edge.
const LEAST_HEIGHT: f64 = 1e-12;

/// Rounds in which edges may raise the weights of their faces.
const ROUNDS: usize = 16;

/// So many faces, and one of so many, may be in trouble for refinement to be tried.
const SOME: usize = 64;

/// So many bad edges may be turned by trial.
const FEW: usize = 8;

const MANY: usize = 20;

/// Rounds in which edges may also do so that are only not proven: two edges may raise their faces against each other for ever.
const PATIENT: usize = 6;

/// How many times more cells an edge may take whose sampled rays are all content.
const CLOSER: usize = 16;

/// Builds the implicit surface through the vertices of a mesh with the given gradients there.
///
/// `normals` has one vector per vertex, towards the positive side, of any length; the directions are met exactly. The lengths matter
/// too: with the gradients of a quadric (up to one factor for all), the quadric is reproduced.
///
/// # Errors
/// [`ApatchError`]: a mesh that is not an oriented manifold, numbers that are not finite, faces without area, normals that are zero or
/// that no tetrahedron can meet, options out of range. Rays that could not be proven to meet the surface once, tetrahedra that intersect
/// and steep faces are no errors; the report names them.
///
/// # References
/// G. Xu, H. Huang, C. Bajaj, *C¹ modeling with A-patches from rational trivariate functions*, CAGD 18 (2001).
pub fn apatch(
    mesh: &TriMesh,
    normals: &[DVec3],
    options: &ApatchOptions,
) -> Result<ApatchSurface, ApatchError> {
    options.check(mesh.faces.len())?;
    let topology = Topology::build(mesh)?;
    check(mesh, normals)?;
    let mesh = TriMesh { normals: Some(normals.to_vec()), ..mesh.clone() };
    let input = (mesh.positions.len(), mesh.faces.len());
    let parents: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    let mut work = Work {
        hull: Hull::new(&mesh, gradients(&mesh), &topology, options),
        mesh,
        topology,
        parents,
        mended: Mended::default(),
    };
    let free = if options.estimated { 0 } else { input.0 };
    work.mend(free, options)?;
    let rounds = work.refine(free, options)?;
    let Work { mesh, topology, hull, parents, mended } = work;
    if let Some(&(face, k)) = hull.hopeless.first() {
        return Err(against(&mesh, &hull.corners[face], face, k));
    }
    let mut build = Build { mesh, topology, hull, options, parents };
    let (forms, weights) = build.faces()?;
    build.finish(forms, weights, Before { input, mended, refinements: rounds })
}

/// What was changed of the input before its faces were divided.
#[derive(Clone, Default)]
struct Mended {
    edges: Vec<[u32; 2]>,
    normals: Vec<u32>,
}

/// What came before the forms: vertices and faces of the input, and what was done to them.
struct Before {
    input: (usize, usize),
    mended: Mended,
    refinements: usize,
}

/// Whether there is less to complain of: faces without apexes count most.
fn better(next: &Hull, hull: &Hull) -> bool {
    let rank = |h: &Hull| (h.hopeless.len(), h.trouble());
    rank(next) < rank(hull)
}

/// A mesh with its hull, on the way to one without trouble.
#[derive(Clone)]
struct Work {
    mesh: TriMesh,
    topology: Topology,
    hull: Hull,
    parents: Vec<u32>,
    mended: Mended,
}

impl Work {
    /// Takes folds out of the mesh, and estimates normals of vertices from number `free` on again; each only if it helps.
    fn mend(&mut self, free: usize, options: &ApatchOptions) -> Result<(), ApatchError> {
        if self.hull.is_sound() {
            return Ok(());
        }
        let faces = self.hull.faces_in_trouble(&self.topology);
        if let Some(mut flat) = unfold::unfold(&self.mesh, &self.topology, &faces)? {
            flat.vertices.retain(|&v| v as usize >= free);
            estimate(&mut flat.mesh, &flat.topology, &flat.vertices);
            let next = Hull::new(&flat.mesh, gradients(&flat.mesh), &flat.topology, options);
            if better(&next, &self.hull) {
                (self.mesh, self.topology, self.hull) = (flat.mesh, flat.topology, next);
                self.mended.edges.extend(flat.edges);
                self.mended.normals.extend(flat.vertices);
            }
        }
        for kind in [Again::Bad, Again::Sharp, Again::Cap, Again::Mean] {
            // The first is the one that helps most; with much trouble there is no time for the others.
            if self.hull.is_sound() || (kind != Again::Bad && self.hull.trouble() > SOME) {
                break;
            }
            let (mesh, topology) = (&self.mesh, &self.topology);
            let faces = self.hull.faces_in_trouble(topology);
            let mut vertices: Vec<u32> =
                faces.iter().flat_map(|&f| mesh.faces[f]).filter(|&v| v as usize >= free).collect();
            vertices.sort_unstable();
            vertices.dedup();
            let all = again(mesh, topology, &vertices, kind, &self.hull.bad_edges);
            if all.is_empty() {
                continue;
            }
            let trial = with(mesh, &all);
            let next = Hull::new(&trial, gradients(&trial), topology, options);
            // Those that are no better for it keep what they have.
            let (was, is) = (self.hull.trouble_at(mesh, topology), next.trouble_at(mesh, topology));
            let kept: Vec<(u32, DVec3)> =
                all.into_iter().filter(|&(v, _)| is[v as usize] < was[v as usize]).collect();
            if kept.is_empty() {
                continue;
            }
            let trial = with(mesh, &kept);
            let next = Hull::new(&trial, gradients(&trial), topology, options);
            if better(&next, &self.hull) {
                (self.mesh, self.hull) = (trial, next);
                self.mended.normals.extend(kept.iter().map(|k| k.0));
            }
        }
        self.turn_by_trial(free, options)?;
        self.mended.normals.sort_unstable();
        self.mended.normals.dedup();
        Ok(())
    }

    /// Turns edges that are bad or beside a bad one where that helps: slivers leave no room for tetrahedra beside them.
    fn turn_by_trial(&mut self, free: usize, options: &ApatchOptions) -> Result<(), ApatchError> {
        if self.hull.bad_edges.len() > FEW {
            return Ok(());
        }
        // Two turns where one alone changes nothing.
        let mut best: Option<(Unfolded, Hull)> = None;
        let mut open = vec![(Unfolded::none(&self.mesh, &self.topology), self.hull.clone())];
        while let Some((from, hull)) = open.pop() {
            for h in beside_bad(&from.topology, &hull) {
                let Some(mut turned) = unfold::turn(&from, h)? else { continue };
                turned.vertices.retain(|&v| v as usize >= free);
                estimate(&mut turned.mesh, &turned.topology, &turned.vertices);
                let next = Hull::new(&turned.mesh, gradients(&turned.mesh), &turned.topology, options);
                if better(&next, best.as_ref().map_or(&self.hull, |b| &b.1)) {
                    best = Some((turned, next));
                } else if from.edges.is_empty() && !better(&self.hull, &next) {
                    open.push((turned, next));
                }
            }
        }
        if let Some((turned, next)) = best {
            (self.mesh, self.topology, self.hull) = (turned.mesh, turned.topology, next);
            self.mended.edges.extend(turned.edges);
            self.mended.normals.extend(turned.vertices);
        }
        Ok(())
    }

    /// The given faces divided by a rule, those left out whose parts have no apexes at all.
    fn divided(
        &self,
        mut faces: Vec<usize>,
        rule: refine::Rule,
        free: usize,
        options: &ApatchOptions,
    ) -> Result<Option<Work>, ApatchError> {
        let straight = |h| self.hull.is_straight(h);
        for last in [false, true] {
            let Some(finer) = refine::butterfly(&self.mesh, &self.topology, &faces, straight, rule) else {
                break;
            };
            let topology = Topology::build(&finer.mesh)?;
            let hull = Hull::new(&finer.mesh, gradients(&finer.mesh), &topology, options);
            let parents = finer.parents.iter().map(|&f| self.parents[f as usize]).collect();
            let mut next = Work { mesh: finer.mesh, topology, hull, parents, mended: self.mended.clone() };
            // New vertices are anybody's to move.
            next.mend(free, options)?;
            let spoiled: Vec<u32> = next.hull.hopeless.iter().map(|&(f, _)| finer.parents[f]).collect();
            if last || spoiled.is_empty() {
                return Ok(Some(next));
            }
            let corners: Vec<u32> = spoiled.iter().flat_map(|&f| self.mesh.faces[f as usize]).collect();
            faces.retain(|&f| !self.mesh.faces[f].iter().any(|v| corners.contains(v)));
        }
        Ok(None)
    }

    /// Divides faces in trouble as long as it helps; the number of rounds.
    fn refine(&mut self, free: usize, options: &ApatchOptions) -> Result<usize, ApatchError> {
        let (mut rounds, mut tried) = (0, self.clone());
        for round in 1..=options.refinements {
            let faces = tried.hull.faces_in_trouble(&tried.topology);
            if faces.is_empty() || faces.len() > SOME + self.mesh.faces.len() / MANY {
                break;
            }
            let mut best: Option<Work> = None;
            for rule in [refine::Rule::Tangents, refine::Rule::Butterfly] {
                let Some(next) = tried.divided(faces.clone(), rule, free, options)? else { continue };
                let good = better(&next.hull, &self.hull);
                if best.as_ref().is_none_or(|b| better(&next.hull, &b.hull)) {
                    best = Some(next);
                }
                if good {
                    break;
                }
            }
            let Some(best) = best else { break };
            if better(&best.hull, &self.hull) {
                (*self, rounds) = (best.clone(), round);
            } else if round > rounds + 1 {
                break;
            }
            tried = best;
        }
        Ok(rounds)
    }
}

/// The half-edges of the faces beside bad edges, each edge once, in order.
fn beside_bad(topology: &Topology, hull: &Hull) -> Vec<u32> {
    let halves = hull.bad_edges.iter().flat_map(|&h| [Some(h), topology.opposite(h)]).flatten();
    let mut all: Vec<u32> = halves
        .flat_map(|h| [h, topology.next(h), topology.prev(h)])
        .filter_map(|h| Some(h.min(topology.opposite(h)?)))
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Normals of the given vertices by [`LoopLimit`], of the lengths that they had; the vertices that have new ones.
fn estimate(mesh: &mut TriMesh, topology: &Topology, vertices: &[u32]) -> Vec<u32> {
    let (Ok(estimates), Some(normals)) = (LoopLimit.estimate(mesh, topology), &mut mesh.normals) else {
        return Vec::new();
    };
    for &v in vertices {
        normals[v as usize] = estimates[v as usize] * normals[v as usize].length();
    }
    vertices.to_vec()
}

/// How a normal is estimated again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Again {
    /// The centre of the smallest cap around the faces and, along edges sharper than a right angle, the directions that keep the surface
    /// on the blunt side of the edge.
    Sharp,
    /// The same for edges with bad tetrahedra only.
    Bad,
    /// The centre of the smallest cap around the faces.
    Cap,
    /// The mean of the faces, weighted by angle.
    Mean,
}

/// The given vertices that have another normal of some kind, and that normal, of the length of the old one.
fn again(
    mesh: &TriMesh,
    topology: &Topology,
    vertices: &[u32],
    kind: Again,
    bad: &[u32],
) -> Vec<(u32, DVec3)> {
    let means = match kind {
        Again::Mean => AngleWeighted.estimate(mesh, topology).unwrap_or_default(),
        _ => Vec::new(),
    };
    let normal = |h: u32| mesh.area_vector(topology.face(h) as usize).normalize_or_zero();
    let mut all = Vec::new();
    for &v in vertices {
        let mut sees: Vec<DVec3> = topology.outgoing(v).map(normal).collect();
        let old = gradients(mesh)[v as usize];
        let new = match kind {
            Again::Mean => means.get(v as usize).copied(),
            Again::Cap => smallest_cap(&sees).map(|c| c.0),
            Again::Sharp | Again::Bad => {
                for h in topology.outgoing(v) {
                    let Some(o) = topology.opposite(h) else { continue };
                    let (m, n) = (normal(h), normal(o));
                    if m.dot(n) < 0.0
                        && (matches!(kind, Again::Sharp) || bad.binary_search(&h.min(o)).is_ok())
                    {
                        let at = |v: u32| mesh.positions[v as usize];
                        let along = (at(topology.head(h)) - at(v)).normalize_or_zero();
                        // Over a valley the surface is to leave downwards, over a ridge upwards.
                        sees.push(if along.dot(m.cross(n)) > 0.0 { -along } else { along });
                    }
                }
                smallest_cap(&sees).map(|c| c.0)
            }
        };
        if let Some(n) = new.filter(|n| n.dot(old) < (1.0 - 1e-9) * old.length()) {
            all.push((v, n * old.length()));
        }
    }
    all
}

/// The mesh with other normals at some vertices.
fn with(mesh: &TriMesh, normals: &[(u32, DVec3)]) -> TriMesh {
    let mut mesh = mesh.clone();
    if let Some(old) = &mut mesh.normals {
        normals.iter().for_each(|&(v, n)| old[v as usize] = n);
    }
    mesh
}

fn gradients(mesh: &TriMesh) -> &[DVec3] {
    mesh.normals.as_deref().unwrap_or(&[])
}

fn check(mesh: &TriMesh, normals: &[DVec3]) -> Result<(), ApatchError> {
    if let Some(vertex) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(ApatchError::NotFinite { vertex });
    }
    if normals.len() != mesh.positions.len() {
        return Err(ApatchError::NormalCount { normals: normals.len(), vertices: mesh.positions.len() });
    }
    for (face, corners) in mesh.faces.iter().enumerate() {
        for &v in corners {
            let n = normals[v as usize];
            // Lengths whose squares vanish or overflow are as useless as zero and infinity.
            if !(n.length_squared().is_normal()) {
                return Err(ApatchError::Normal { vertex: v as usize, value: n.to_array() });
            }
        }
        let [a, b, c] = mesh.corners(face);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let height = ((b - a) / longest).cross((c - a) / longest).length();
        // Not `<`: NaN is no height.
        if !(height >= LEAST_HEIGHT) {
            return Err(ApatchError::DegenerateFace { face, height, limit: LEAST_HEIGHT });
        }
    }
    Ok(())
}

/// What the apex weight of a face and side came to.
#[derive(Clone, Copy, Debug, Default)]
struct Weight {
    raised: bool,
    verdict: Option<Verdict>,
}

/// `F` on every face that is not plane, with what its weights came to.
type Faces = (Vec<Option<FaceForm>>, Vec<[Weight; 2]>);

/// What is known of an edge on one side, and what it asks of its faces.
type Judged = (Verdict, Option<Raise>);

struct Build<'a> {
    mesh: TriMesh,
    topology: Topology,
    hull: Hull,
    options: &'a ApatchOptions,
    parents: Vec<u32>,
}

impl Build<'_> {
    /// `F` on all faces that are not plane, their weights above their bounds.
    fn faces(&self) -> Result<Faces, ApatchError> {
        let all: Vec<(Option<FaceForm>, [Weight; 2])> =
            (0..self.mesh.faces.len()).into_par_iter().map(|f| self.face(f)).collect::<Result<_, _>>()?;
        Ok(all.into_iter().unzip())
    }

    fn face(&self, f: usize) -> Result<(Option<FaceForm>, [Weight; 2]), ApatchError> {
        let corners = &self.hull.corners[f];
        let class = self.hull.classes[f];
        if class == Class::Zero {
            return Ok((None, [Weight::default(); 2]));
        }
        let base = if class == Class::Nonconvex { Base::split(corners) } else { Base::rational(corners) };
        let mut form = FaceForm { p: corners.p, base, sides: [None; 2] };
        let mut weights = [Weight::default(); 2];
        let opposite: Vec<(DVec3, DVec3)> = (0..3u32)
            .filter_map(|k| self.topology.opposite(3 * f as u32 + k))
            .map(|o| self.topology.tail(self.topology.prev(o)) as usize)
            .map(|v| (self.mesh.positions[v], gradients(&self.mesh)[v]))
            .collect();
        for s in 0..2 {
            let Some(apex) = self.hull.apexes[f].points[s] else { continue };
            let sign = if s == 0 { 1.0 } else { -1.0 };
            let mut side = FaceSide::new(corners, sign, apex);
            let wanted = sign
                * match &self.options.weight {
                    ApexWeight::Neighbours => side
                        .neighbour_weight(corners, &opposite)
                        // Neighbours in one plane with the face say nothing; those that share a corner may.
                        .or_else(|| side.neighbour_weight(corners, &self.ring(f)))
                        .unwrap_or_else(|| side.paper_weight(corners)),
                    ApexWeight::Paper => side.paper_weight(corners),
                    ApexWeight::Given(w) => sign * w[self.parents[f] as usize],
                };
            let height = largest(&side.h);
            let margin = self.options.margin * height;
            if !(wanted.is_finite() && margin.is_finite()) {
                return Err(ApatchError::NotFinitePatch { face: f });
            }
            let cells = self.options.cells;
            let mut weight = wanted;
            let mut verdict = certify_face(&form, &side, sign * (wanted - margin), cells);
            if verdict != Verdict::Proven {
                let bound = bound_face(&form, &side, 1e-2 * height, cells);
                weight = wanted.max(bound.proven + margin);
                if weight > wanted && self.options.weight == ApexWeight::Neighbours {
                    // No quadric is near: just above its bound the surface would all but have a second sheet.
                    weight = weight.max(sign * side.paper_weight(corners));
                }
                if !weight.is_finite() {
                    return Err(ApatchError::NotFinitePatch { face: f });
                }
                verdict = certify_face(&form, &side, sign * weight, cells);
            }
            if !side.rises() {
                // Where the base changes its sign, the root leaves the face in a jump.
                verdict = Verdict::Undecided;
            }
            side.set_weight(sign * weight);
            form.sides[s] = Some(side);
            weights[s] = Weight { raised: weight > wanted, verdict: Some(verdict) };
        }
        Ok((Some(form), weights))
    }

    /// The vertices that share a face with a corner of face `f`, with their gradients; some more than once.
    fn ring(&self, f: usize) -> Vec<(DVec3, DVec3)> {
        let corners = self.mesh.faces[f];
        corners
            .iter()
            .flat_map(|&v| self.topology.outgoing(v))
            .flat_map(|h| [self.topology.head(h), self.topology.tail(self.topology.prev(h))])
            .filter(|v| !corners.contains(v))
            .map(|v| (self.mesh.positions[v as usize], gradients(&self.mesh)[v as usize]))
            .collect()
    }

    /// The two forms beside an edge, and the numbers there of the vertices opposite.
    fn edge(&self, forms: &[Option<FaceForm>], h: u32) -> EdgeForm {
        let (f, k) = (self.topology.face(h) as usize, opposite_vertex(h));
        let [i, j] = EDGE[k];
        let corners = &self.hull.corners[f];
        let mut edge = EdgeForm {
            p: [corners.p[i], corners.p[j]],
            e: [corners.e[i][j], corners.e[j][i]],
            sides: [None; 2],
        };
        let Some(o) = self.topology.opposite(h) else { return edge };
        let (g, l) = (self.topology.face(o) as usize, opposite_vertex(o));
        let sides = Class::of_edge(edge.e).sides();
        for s in 0..2 {
            let side = |f: usize| forms[f].as_ref().and_then(|f| f.sides[s].as_ref());
            if let (true, Some(f), Some(g)) = (sides[s], side(f), side(g)) {
                edge.sides[s] = Some(EdgeSide::new(edge.p, (f, k), (g, l)));
            }
        }
        edge
    }

    /// Edges, with the weights of their faces raised where they ask for it.
    fn finish(
        &mut self,
        mut forms: Vec<Option<FaceForm>>,
        mut weights: Vec<[Weight; 2]>,
        before: Before,
    ) -> Result<ApatchSurface, ApatchError> {
        let halves: Vec<u32> = (0..self.topology.half_edge_count() as u32)
            .filter(|&h| self.topology.opposite(h).is_none_or(|o| h < o))
            .collect();
        let mut edges: Vec<EdgeForm> = halves.par_iter().map(|&h| self.edge(&forms, h)).collect();
        let mut verdicts: Vec<[Option<Verdict>; 2]> = vec![[None; 2]; edges.len()];
        let mut dirty: Vec<usize> = (0..edges.len()).collect();
        let mut weighted = vec![false; edges.len()];
        let mut rounds = 0;
        loop {
            let judged: Vec<[Option<Judged>; 2]> =
                dirty.par_iter().map(|&e| self.judge(&edges[e], rounds < PATIENT)).collect();
            // The largest demand on every face and side; in the order of edges, though a maximum needs none.
            let mut demand: Vec<[f64; 2]> = vec![[0.0; 2]; forms.len()];
            let mut raised = Vec::new();
            for (&e, judged) in dirty.iter().zip(&judged) {
                for s in 0..2 {
                    let Some((verdict, raise)) = judged[s] else { continue };
                    verdicts[e][s] = Some(verdict);
                    let (Some(raise), true) = (raise, rounds < ROUNDS) else { continue };
                    weighted[e] |= raise.ratio != 1.0;
                    let Some(o) = self.topology.opposite(halves[e]) else { continue };
                    for (h, by) in [(halves[e], raise.by), (o, raise.by * raise.ratio)] {
                        let f = self.topology.face(h) as usize;
                        demand[f][s] = demand[f][s].max(by);
                        raised.push(f);
                    }
                }
            }
            raised.sort_unstable();
            raised.dedup();
            if raised.is_empty() {
                break;
            }
            rounds += 1;
            for &f in &raised {
                let Some(form) = &mut forms[f] else { continue };
                for s in 0..2 {
                    if let (Some(side), true) = (&mut form.sides[s], demand[f][s] > 0.0) {
                        side.set_weight(side.b + side.sign * demand[f][s]);
                        weights[f][s].raised = true;
                    }
                }
            }
            let touched = |&e: &usize| {
                let face = |h: u32| raised.binary_search(&(self.topology.face(h) as usize)).is_ok();
                face(halves[e]) || self.topology.opposite(halves[e]).is_some_and(face)
            };
            dirty = (0..edges.len()).filter(touched).collect();
            let again: Vec<EdgeForm> = dirty.par_iter().map(|&e| self.edge(&forms, halves[e])).collect();
            for (&e, edge) in dirty.iter().zip(again) {
                edges[e] = edge;
            }
        }
        let report = self.report(&forms, &weights, &edges, &halves, &verdicts, &weighted, (before, rounds));
        let faces = forms.into_iter().map(|f| f.map(Arc::new)).collect();
        let edges = edges.into_iter().map(Arc::new).collect();
        let mesh = std::mem::take(&mut self.mesh);
        let mut of_half = vec![0; 3 * mesh.faces.len()];
        for (e, &h) in (0u32..).zip(&halves) {
            of_half[h as usize] = e;
            if let Some(o) = self.topology.opposite(h) {
                of_half[o as usize] = e;
            }
        }
        Ok(ApatchSurface {
            mesh,
            topology: self.topology.clone(),
            classes: std::mem::take(&mut self.hull.classes),
            parents: std::mem::take(&mut self.parents),
            faces,
            edges,
            halves,
            of_half,
            report,
        })
    }

    fn judge(&self, edge: &EdgeForm, anyway: bool) -> [Option<Judged>; 2] {
        [0, 1].map(|s| {
            let side = edge.sides[s].as_ref()?;
            let (mut verdict, mut near) = certify_edge(edge, side, self.options.cells);
            let mut raise = None;
            if verdict != Verdict::Proven {
                let margin = self.options.margin * largest(&side.b1[0]).max(largest(&side.b1[1]));
                raise = raise_edge(edge, side, margin, near, false);
                if raise.is_none() && verdict == Verdict::Undecided {
                    // Samples are content: it is worth looking closer.
                    (verdict, near) = certify_edge(edge, side, CLOSER * self.options.cells);
                    if verdict != Verdict::Proven {
                        raise = raise_edge(edge, side, margin, near, anyway);
                    }
                }
            }
            if verdict == Verdict::Proven && !side.rises() {
                verdict = Verdict::Undecided;
            }
            Some((verdict, raise))
        })
    }

    fn report(
        &self,
        forms: &[Option<FaceForm>],
        weights: &[[Weight; 2]],
        edges: &[EdgeForm],
        halves: &[u32],
        verdicts: &[[Option<Verdict>; 2]],
        weighted: &[bool],
        (before, edge_rounds): (Before, usize),
    ) -> ApatchReport {
        let count = |class: Class| self.hull.classes.iter().filter(|&&c| c == class).count();
        let faces = ClassCounts {
            positive: count(Class::Positive),
            negative: count(Class::Negative),
            nonconvex: count(Class::Nonconvex),
            zero: count(Class::Zero),
        };
        let inner: Vec<Class> = edges
            .iter()
            .zip(halves)
            .filter(|(_, h)| self.topology.opposite(**h).is_some())
            .map(|(e, _)| Class::of_edge(e.e))
            .collect();
        let of = |class: Class| inner.iter().filter(|&&c| c == class).count();
        let edge_classes = ClassCounts {
            positive: of(Class::Positive),
            negative: of(Class::Negative),
            nonconvex: of(Class::Nonconvex),
            zero: of(Class::Zero),
        };
        let unproven = |v: &Option<Verdict>| v.is_some_and(|v| v != Verdict::Proven);
        let violated = |v: &Option<Verdict>| *v == Some(Verdict::Violated);
        let list =
            |keep: &dyn Fn(usize) -> bool, n: usize| (0..n).filter(|&i| keep(i)).map(|i| i as u32).collect();
        let ends = |h: u32| [self.topology.tail(h), self.topology.head(h)];
        let edge_list = |keep: &dyn Fn(usize) -> bool| -> Vec<[u32; 2]> {
            (0..edges.len()).filter(|&e| keep(e)).map(|e| ends(halves[e])).collect()
        };
        ApatchReport {
            input_vertices: before.input.0,
            input_faces: before.input.1,
            vertices: self.mesh.positions.len(),
            faces: self.mesh.faces.len(),
            turned_edges: before.mended.edges,
            estimated_again: before.mended.normals,
            refinements: before.refinements,
            boundary_edges: edges.len() - inner.len(),
            face_classes: faces,
            edge_classes,
            face_pieces: faces.positive + faces.negative + 6 * faces.nonconvex,
            edge_pieces: edge_classes.positive + edge_classes.negative + 2 * edge_classes.nonconvex,
            turned_faces: self.hull.apexes.iter().filter(|a| a.turned).count(),
            steep_faces: list(&|f| self.hull.apexes[f].steep, forms.len()),
            bad_edges: self.hull.bad_edges.iter().map(|&h| ends(h)).collect(),
            raised_faces: weights.iter().filter(|w| w[0].raised || w[1].raised).count(),
            edge_rounds,
            weighted_edges: weighted.iter().filter(|w| **w).count(),
            unproven_faces: list(&|f| weights[f].iter().any(|w| unproven(&w.verdict)), forms.len()),
            violated_faces: list(&|f| weights[f].iter().any(|w| violated(&w.verdict)), forms.len()),
            unproven_edges: edge_list(&|e| verdicts[e].iter().any(unproven)),
            violated_edges: edge_list(&|e| verdicts[e].iter().any(violated)),
            intersections: self.options.intersections.then(|| {
                intersect::count(&self.mesh, forms, edges, |e| {
                    let h = halves[e];
                    let o = self.topology.opposite(h);
                    [Some(h), o].map(|h| h.map(|h| self.topology.face(h)))
                })
            }),
        }
    }
}

fn largest(values: &[f64; 3]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}
