//! The construction: mesh and normals to implicit surface.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use suture_mesh::{Topology, TriMesh};

use crate::bounds::{Raise, Verdict, bound_face, certify_edge, certify_face, raise_edge};
use crate::coefficients::EDGE;
use crate::edge::{EdgeForm, EdgeSide};
use crate::face::{Base, FaceForm, FaceSide};
use crate::hull::{Class, Hull, against, opposite_vertex};
use crate::report::{ApatchReport, ClassCounts};
use crate::{ApatchError, ApatchOptions, ApatchSurface, ApexWeight, intersect, refine};

/// Smallest height of a face over its longest edge, relative to that edge.
const LEAST_HEIGHT: f64 = 1e-12;

/// Rounds in which edges may raise the weights of their faces.
const ROUNDS: usize = 16;

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
    let mut topology = Topology::build(mesh)?;
    check(mesh, normals)?;
    let mut mesh = TriMesh { normals: Some(normals.to_vec()), ..mesh.clone() };
    let input = (mesh.positions.len(), mesh.faces.len());
    let mut parents: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    let mut hull = Hull::new(&mesh, gradients(&mesh), &topology, options);
    let mut rounds = 0;
    while rounds < options.refinements {
        let mut faces = hull.faces_to_refine(&topology);
        faces.extend(hull.hopeless.iter().map(|h| h.0));
        if faces.is_empty() {
            break;
        }
        let Some(finer) = refine::butterfly(&mesh, &topology, &faces, |h| hull.is_straight(h)) else { break };
        let trial = Topology::build(&finer.mesh)?;
        let next = Hull::new(&finer.mesh, gradients(&finer.mesh), &trial, options);
        // A round that makes matters worse is the last one, and is taken back.
        if next.hopeless.len() > hull.hopeless.len()
            || (next.hopeless.len() == hull.hopeless.len() && next.trouble() > 2 * hull.trouble())
        {
            break;
        }
        parents = finer.parents.iter().map(|&p| parents[p as usize]).collect();
        (mesh, topology, hull) = (finer.mesh, trial, next);
        rounds += 1;
    }
    if let Some(&(face, k)) = hull.hopeless.first() {
        return Err(against(&mesh, &hull.corners[face], face, k));
    }
    let mut build = Build { mesh, topology, hull, options, parents };
    let (forms, weights) = build.faces()?;
    build.finish(forms, weights, input, rounds)
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
        input: (usize, usize),
        refinements: usize,
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
            let judged: Vec<[Option<Judged>; 2]> = dirty.par_iter().map(|&e| self.judge(&edges[e])).collect();
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
        let report = self.report(
            &forms,
            &weights,
            &edges,
            &halves,
            &verdicts,
            &weighted,
            (input, refinements, rounds),
        );
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

    fn judge(&self, edge: &EdgeForm) -> [Option<Judged>; 2] {
        [0, 1].map(|s| {
            let side = edge.sides[s].as_ref()?;
            let (mut verdict, near) = certify_edge(edge, side, self.options.cells);
            let mut raise = None;
            if verdict != Verdict::Proven {
                let margin = self.options.margin * largest(&side.b1[0]).max(largest(&side.b1[1]));
                raise = raise_edge(edge, side, margin, near);
                if raise.is_none() && verdict == Verdict::Undecided {
                    // Samples are content: it is worth looking closer.
                    (verdict, _) = certify_edge(edge, side, CLOSER * self.options.cells);
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
        ((input_vertices, input_faces), refinements, edge_rounds): ((usize, usize), usize, usize),
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
            input_vertices,
            input_faces,
            vertices: self.mesh.positions.len(),
            faces: self.mesh.faces.len(),
            refinements,
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
