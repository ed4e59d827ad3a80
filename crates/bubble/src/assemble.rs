//! From mesh to surface.

use std::{borrow::Cow, sync::Arc};

use rayon::prelude::*;
use suture_surface::{Continuity, EdgeRef, Patch, PatchId, Seam, Surface};

use crate::{
    BubbleError,
    crease::split_creases,
    fan::fans,
    fit::{Fit, Fitted},
    hermite::Hermite,
    implicit::{Implicit, VertexImplicits},
    network::{EdgeUse, Edges, Network, Shapes},
    patch::{BubblePatch, Pairing, Side},
    poly_mesh::PolyMesh,
    report::{self, BubbleReport, BubbleWarning, Limits, Weighed},
    steer::steer_normals,
};

/// How a bubble surface is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BubbleOptions {
    /// Order of smoothness across edges, 0 to 4. Default 2: reflections are smooth.
    pub order: usize,
    /// How the vertex implicits are fitted.
    pub fit: Fit,
    /// Which interpolant of the boundary data a triangle gets.
    pub pairing: Pairing,
    /// Whether the surface of order 0 is curved (boundary curves touch the vertex implicits with order 2) rather than the mesh itself.
    /// Default true.
    pub curved: bool,
    /// Strips whose gradient makes a smaller cosine with the interpolated normal are refused, as are those whose interpolated normal or speed
    /// falls below twice or four times this value. Default 0.05; 0 or less accepts all.
    pub refuse: f64,
    /// Strips below this value in one of these measures are counted in a warning. Default 0.3.
    pub warn: f64,
    /// Normals whose cosine with the normal of a face there, or sine with an edge, is below this value are turned first, as little as needed
    /// ([`steer_normals`]); a warning tells. Default 0.3; 0 keeps all. [`bubble_with`] leaves normals alone.
    pub steer: f64,
}

impl Default for BubbleOptions {
    fn default() -> Self {
        Self {
            order: 2,
            fit: Fit::Tangential,
            pairing: Pairing::Mean,
            curved: true,
            refuse: 0.05,
            warn: 0.3,
            steer: 0.3,
        }
    }
}

/// A bubble surface: one patch per face.
#[derive(Debug)]
pub struct BubbleSurface {
    patches: Vec<BubblePatch>,
    seams: Vec<Seam>,
    network: Network,
    report: BubbleReport,
    /// The vertex that every one was before the mesh was split along creases; empty where it was not.
    source: Vec<u32>,
}

/// A surface of order `n` over a mesh with normals: one patch per face, in the order of faces, joining with order `n` across edges and
/// with order `2n` at vertices.
///
/// ```
/// use suture_bubble::{BubbleOptions, PolyMesh, bubble};
/// let mesh = suture_mesh::shapes::sphere(0);
/// let poly = PolyMesh::from_triangles(&mesh, &mesh.positions)?;
/// let ball = bubble(&poly, &BubbleOptions::default())?;
/// assert_eq!(ball.patches().len(), 20);
/// # Ok::<(), suture_bubble::BubbleError>(())
/// ```
///
/// # Errors
/// [`BubbleError`]: what is wrong with the mesh, its normals or the options; [`BubbleError::Degenerate`] where an edge runs along a normal
/// or normals turn too far along it.
///
/// # References
/// M. Kapl, M. Byrtus, B. Jüttler, *Triangular bubble spline surfaces*, 2011.
pub fn bubble(mesh: &PolyMesh, options: &BubbleOptions) -> Result<BubbleSurface, BubbleError> {
    bubble_shaped(mesh, Vec::new(), options)
}

/// As [`bubble`], with creases along the edges `tagged`: order `n` everywhere else, one common curve and no more there. Faces keep their numbers;
/// vertices of the network and the report are those of [`split_creases`].
///
/// # Errors
/// As [`bubble`] and [`split_creases`].
pub fn bubble_creased(
    mesh: &PolyMesh,
    tagged: &[[u32; 2]],
    options: &BubbleOptions,
) -> Result<BubbleSurface, BubbleError> {
    let split = split_creases(mesh, tagged)?;
    let mut surface = bubble_shaped(&split.mesh, split.creases, options)?;
    surface.source = split.source;
    Ok(surface)
}

fn bubble_shaped(
    mesh: &PolyMesh,
    creases: Vec<[[u32; 2]; 2]>,
    options: &BubbleOptions,
) -> Result<BubbleSurface, BubbleError> {
    mesh.check()?;
    let mut steered = Cow::Borrowed(mesh);
    let turned =
        if options.steer > 0.0 { steer_normals(steered.to_mut(), options.steer) } else { Vec::new() };
    let mut implicits = Fitted { fit: options.fit }.implicits(&steered)?;
    // Where even the best normal sees faces from the side, tangents are laid out anew, and nothing can be said of curvature.
    let bad = turned.iter().filter(|t| t.clearance[1] < options.steer * HOPELESS).map(|t| t.vertex);
    let bad: Vec<u32> = bad.collect();
    for &v in &bad {
        implicits[v as usize] = Implicit::plane(steered.normals[v as usize]);
    }
    let tangents = if bad.is_empty() { Vec::new() } else { fans(&steered, &Edges::of(&steered), &bad) };
    let shapes = Shapes { tangents, creases };
    let network = Network::build_shaped(&steered, implicits, options.order, contact(options), &shapes)?;
    let mut surface = bubble_over(&steered, network, options)?;
    let count = turned.iter().filter(|t| t.angle > 0.0).count();
    if let Some(&most) = turned.iter().max_by(|a, b| a.angle.total_cmp(&b.angle)).filter(|_| count > 0) {
        surface.report.warnings.push(BubbleWarning::Turned { count, most });
    }
    if let Some(&first) = bad.first() {
        surface.report.warnings.push(BubbleWarning::Unrolled { count: bad.len(), first });
    }
    surface.report.turned = count;
    Ok(surface)
}

/// Below this part of [`BubbleOptions::steer`] no normal is good enough.
const HOPELESS: f64 = 0.75;

fn contact(options: &BubbleOptions) -> usize {
    match options.order {
        0 if options.curved => 2,
        n => 2 * n,
    }
}

/// As [`bubble`], with vertex implicits from elsewhere; `options.fit` does not matter.
///
/// # Errors
/// As [`bubble`], and those of `implicits`.
pub fn bubble_with(
    mesh: &PolyMesh,
    implicits: &dyn VertexImplicits,
    options: &BubbleOptions,
) -> Result<BubbleSurface, BubbleError> {
    mesh.check()?;
    let implicits = implicits.implicits(mesh)?;
    bubble_over(mesh, Network::build(mesh, implicits, options.order, contact(options))?, options)
}

/// The patches over given strips: the last step of [`bubble`]. Order, contact and implicits are those of the network.
///
/// # Errors
/// As [`bubble`].
pub fn bubble_over(
    mesh: &PolyMesh,
    network: Network,
    options: &BubbleOptions,
) -> Result<BubbleSurface, BubbleError> {
    mesh.check()?;
    check_options(options)?;
    let (strips, sides) = (network.strips.len(), mesh.faces.len());
    if network.edges.sides.len() != sides || network.implicits.len() != mesh.positions.len() {
        return Err(BubbleError::Count {
            what: "faces of the network",
            given: network.edges.sides.len(),
            needed: sides,
        });
    }
    for (vertex, used) in used_vertices(mesh).into_iter().enumerate() {
        let f = &network.implicits[vertex];
        if used && !(f.gradient().length_squared() > 0.0 && f.coefficients().iter().all(|c| c.is_finite())) {
            let reason = "its gradient is zero or a coefficient is not finite";
            return Err(BubbleError::Implicit { vertex, reason });
        }
    }
    if let Some(strip) = network.strips.iter().position(|s| !s.finite()) {
        return Err(BubbleError::Strip {
            strip,
            reason: "a number overflows: the implicits at its ends bend too sharply",
        });
    }
    let (n, r, w) = (network.order, options.refuse, options.warn);
    let limits = Limits { refuse: [r, 2.0 * r, 4.0 * r], warn: [w; 3] };
    let Weighed { extremes, mut warnings, doubtful } = report::weigh_all(mesh, &network, &limits)?;

    let shared = Arc::clone(&network.strips);
    let hermite = Hermite::new(n);
    let orders = (n, network.contact);
    let build = |scratch: &mut Vec<f64>, f: usize| {
        let corners = mesh.faces[f].vertices();
        let count = corners.len();
        let mut sides = [Side::default(); 4];
        let mut positions = [glam::DVec3::ZERO; 4];
        let mut implicits: [&Implicit; 4] = [&network.implicits[corners[0] as usize]; 4];
        for k in 0..count {
            let (a, b) = (corners[k], corners[(k + 1) % count]);
            sides[k] = Side { strip: network.edges.sides[f][k], reversed: a > b };
            positions[k] = mesh.positions[a as usize];
            implicits[k] = &network.implicits[a as usize];
        }
        let (sides, positions, implicits) = (&sides[..count], &positions[..count], &implicits[..count]);
        let strips = Arc::clone(&shared);
        let mut patch = BubblePatch::build(
            strips,
            sides,
            positions,
            implicits,
            orders,
            options.pairing,
            (!doubtful[f]).then(Vec::new),
            &hermite,
            scratch,
        );
        patch.vertices[..count].copy_from_slice(corners);
        patch.sources = network.built.then(|| Arc::clone(&network.implicits));
        let measured = report::regularity(&patch);
        (patch, measured)
    };
    let (patches, measured): (Vec<_>, Vec<[f64; 2]>) =
        (0..mesh.faces.len()).into_par_iter().map_init(Vec::new, build).unzip();

    let (seams, branching) = seams(&network);
    if let Some(&first) = branching.first() {
        warnings.push(BubbleWarning::NonManifold { count: branching.len(), first });
    }
    let folded: Vec<usize> = (0..measured.len()).filter(|&f| !(measured[f][1] > 0.0)).collect();
    if let Some(&first) = folded.first() {
        warnings.push(BubbleWarning::Folds { count: folded.len(), first });
    }
    let leaned = || patches.iter().enumerate().filter(|p| !p.1.leans.is_empty());
    if let Some((first, _)) = leaned().next() {
        warnings.push(BubbleWarning::Leaned { count: leaned().count(), first });
    }
    let least = |i: usize| measured.iter().fold(f64::INFINITY, |m, x| m.min(x[i]));
    let quads = mesh.faces.iter().filter(|f| f.vertices().len() == 4).count();
    let [cosine, normal, speed] = extremes;
    let report = BubbleReport {
        order: n,
        triangles: sides - quads,
        quads,
        strips,
        boundary: network.edges.edges.iter().filter(|e| e.faces.len() == 1).count()
            - 2 * network.creases.len(),
        creases: network.creases.len(),
        cosine: (n > 0).then_some(cosine),
        normal,
        speed,
        regularity: least(0),
        fold: least(1),
        turned: 0,
        warnings,
    };
    Ok(BubbleSurface { patches, seams, network, report, source: Vec::new() })
}

impl BubbleSurface {
    /// The patches, one per face.
    pub fn patches(&self) -> &[BubblePatch] {
        &self.patches
    }

    /// The seams, one per edge with two faces.
    pub fn seams(&self) -> &[Seam] {
        &self.seams
    }

    /// The strips and the implicits they come from.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// What was measured.
    pub fn report(&self) -> &BubbleReport {
        &self.report
    }

    /// The edge of side `k` of face `f`.
    pub(crate) fn side_edge(&self, f: usize, k: usize) -> usize {
        self.network.edges.sides[f][k] as usize
    }

    /// The vertex that `v` was before the mesh was split along creases.
    pub(crate) fn whole(&self, v: u32) -> u32 {
        self.source.get(v as usize).copied().unwrap_or(v)
    }

    /// The vertex of corner `k` of face `f`.
    pub(crate) fn corner(&self, f: usize, k: usize) -> u32 {
        let side = &self.patches[f].sides[k];
        self.network.edges.edges[side.strip as usize].vertices[usize::from(side.reversed)]
    }

    /// The surface for tessellation, certificate, export and pictures.
    ///
    /// # Errors
    /// [`BubbleError::Surface`], which would be a defect of this crate.
    pub fn into_surface(self) -> Result<Surface, BubbleError> {
        let patches = self.patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect();
        Ok(Surface::new(patches, self.seams)?)
    }
}

fn check_options(options: &BubbleOptions) -> Result<(), BubbleError> {
    for (name, value) in [("refuse", options.refuse), ("warn", options.warn), ("steer", options.steer)] {
        if value.is_nan() {
            return Err(BubbleError::Option { name, value, range: "a number" });
        }
    }
    if !options.pairing.valid() {
        return Err(BubbleError::Option {
            name: "pairing",
            value: f64::NAN,
            range: "a permutation of 0, 1, 2",
        });
    }
    Ok(())
}

fn used_vertices(mesh: &PolyMesh) -> Vec<bool> {
    let mut used = vec![false; mesh.positions.len()];
    for &v in mesh.faces.iter().flat_map(|f| f.vertices()) {
        used[v as usize] = true;
    }
    used
}

/// The seams, and the edges with more than two faces.
fn seams(network: &Network) -> (Vec<Seam>, Vec<[u32; 2]>) {
    let claimed = match network.order {
        0 => Continuity::C0,
        1 => Continuity::G1,
        _ => Continuity::G2,
    };
    let (mut seams, mut branching) = (Vec::new(), Vec::new());
    for e in &network.edges.edges {
        match e.faces[..] {
            [] | [_] => {}
            [a, b] => {
                let edge = |e: EdgeUse| EdgeRef { patch: PatchId(e.face), edge: u32::from(e.side) };
                let mut seam = Seam::new(edge(a), edge(b), claimed);
                seam.same_direction = a.forward == b.forward;
                seams.push(seam);
            }
            _ => branching.push(e.vertices),
        }
    }
    for sides in &network.creases {
        let [a, b] = sides.map(|e| network.edges.edges[e as usize].faces.first());
        if let (Some(a), Some(b)) = (a, b) {
            let edge = |e: &EdgeUse| EdgeRef { patch: PatchId(e.face), edge: u32::from(e.side) };
            let mut seam = Seam::new(edge(a), edge(b), Continuity::C0);
            seam.same_direction = a.forward == b.forward;
            seams.push(seam);
        }
    }
    (seams, branching)
}
