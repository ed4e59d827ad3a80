//! A closed triangle mesh in, a certified C² surface out: the stages in their order, and the plain data between them.

use std::collections::BTreeMap;
use std::time::Instant;

use suture_blend::{Blend, BlendError, CornerMaps, Correspondence, Sewing, WidthOptions};
use suture_certify::{Certificate, CertifyOptions, Deviation, SurfaceSamples, certify, deviation};
use suture_fit::{Fit, FitOptions, FitSurface, PenalizedLeastSquares};
use suture_mesh::{IronOptions, RefineOptions, Topology, TriMesh, iron, refine_curved};
use suture_param::{Chart, Parameterize, Recommended};
use suture_segment::{Automatic, FairOptions, Limits, Segment, Segmentation};
use suture_tessellate::{Tessellation, TessellationOptions, tessellate};

use crate::arcs::DRAWINGS;
use crate::charting::Charted;
use crate::splitting::{Pieces, State};
use crate::{ByChart, Stage, SutureError, Watch};

/// The stages that can be swapped; the defaults are the best ones known.
pub struct Stages<'a> {
    /// Mesh → segments.
    pub segment: Box<dyn Segment + 'a>,
    /// Segment → parameters.
    pub parameterize: Box<dyn Parameterize + Sync + 'a>,
    /// Chart → B-spline.
    pub fit: Box<dyn FitSurface + Sync + 'a>,
    /// B-splines → maps.
    pub maps: Box<dyn CornerMaps + 'a>,
}

impl Default for Stages<'_> {
    fn default() -> Self {
        Self {
            segment: Box::new(Automatic {
                flatten: Box::new(ByChart::<Recommended>::default()),
                ..Automatic::default()
            }),
            parameterize: Box::new(Recommended::default()),
            fit: Box::new(PenalizedLeastSquares { options: FitOptions::default() }),
            maps: Box::new(Correspondence::default()),
        }
    }
}

/// What a reconstruction is asked for beyond its stages.
#[derive(Clone, Debug, Default)]
pub struct ReconstructOptions {
    /// Widths of the blends.
    pub widths: WidthOptions,
    /// How arcs are taken from the mesh.
    pub fair: Fairness,
    /// How fine the mesh is made first.
    pub refinement: Refinement,
    /// When segments are split.
    pub splits: Splits,
    /// Fineness of the tessellation.
    pub tessellation: TessellationOptions,
    /// Density and limits of the certificate.
    pub certify: CertifyOptions,
}

/// What is done to a mesh before it is fitted. Its knife edges are ironed ([`iron`]): charts fold there. Coarse triangles are split with curved midpoints ([`refine_curved`]): fits over few
/// and unequal triangles waver between the vertices, and the blends fold with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// Angle between the normals of neighbouring faces, in radians, beyond which their edge is ironed.
    pub sharpest: f64,
    /// Longest edge, in wanted widths of the blends.
    pub longest: f64,
    /// Largest angle between the normals at the ends of an edge, in radians.
    pub turn: f64,
    /// Shortest edge that this may lead to, in wanted widths.
    pub shortest: f64,
    /// Dihedral angle, in radians, from which an edge is meant to be sharp.
    pub crease: f64,
    /// Most rounds of splitting; 0 takes the mesh as it is.
    pub rounds: usize,
    /// How far a plane may be off whose edges are turned, relative to the diagonal.
    pub flat: f64,
}

impl Default for Refinement {
    fn default() -> Self {
        let (turn, crease) = (40f64.to_radians(), 50f64.to_radians());
        Self {
            sharpest: 140f64.to_radians(),
            longest: 1.0,
            turn,
            shortest: 0.15,
            crease,
            rounds: 3,
            flat: 2e-6,
        }
    }
}

impl Refinement {
    /// The mesh as it is.
    pub fn none() -> Self {
        Self { sharpest: std::f64::consts::PI, rounds: 0, ..Self::default() }
    }

    fn ironing(&self) -> IronOptions {
        // No farther than needed: what lies beside a knife edge is the shape.
        IronOptions { sharpest: self.sharpest, rest: 1.0, sweeps: IRON_SWEEPS }
    }

    /// For blends of the `wanted` width, relative to the diagonal; edges in planes may turn where no segments name faces.
    fn resolve(&self, wanted: f64, diagonal: f64, turns: bool) -> RefineOptions {
        let width = wanted * diagonal;
        RefineOptions {
            longest: self.longest * width,
            turn: self.turn,
            shortest: self.shortest * width,
            crease: self.crease,
            rounds: self.rounds,
            flat: turns.then_some(self.flat * diagonal),
        }
    }
}

/// How often the vertices at knife edges are moved at most.
const IRON_SWEEPS: usize = 50;

/// When segments are split in two and charted again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splits {
    /// How many times at most; 0 keeps the segmentation as it is.
    pub rounds: usize,
    /// Residual of a fit, relative to the diagonal, above which its segment is split while that helps; folding charts are split as
    /// well. `None` splits only what cannot be blended.
    pub tolerance: Option<f64>,
}

impl Default for Splits {
    fn default() -> Self {
        Self { rounds: 8, tolerance: Some(1e-3) }
    }
}

/// Largest valence that splitting may leave: beyond 6 no blend has all coefficients in [0, 1].
const MOST_SEGMENTS: usize = 6;

/// How arcs are taken from the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fairness {
    /// Along the mesh edges, as the paper does.
    Edges,
    /// As fair curves on the mesh.
    Fair(FairOptions),
}

impl Default for Fairness {
    fn default() -> Self {
        Self::Fair(FairOptions::default())
    }
}

/// A reconstructed surface with every stage's product.
#[derive(Debug)]
pub struct Reconstruction {
    /// The mesh that was fitted: the given one, refined where it is coarse. Its first vertices are those of the given mesh.
    pub mesh: TriMesh,
    /// The vertices at knife edges that were moved before, ascending.
    pub moved: Vec<u32>,
    /// Segments, corners and arcs of that mesh.
    pub segmentation: Segmentation,
    /// The segment of every face of the given mesh; that of one of its parts where a border runs through it.
    pub labels: Vec<u32>,
    /// Chart of every segment, in the parameters of its B-spline.
    pub charts: Vec<Chart>,
    /// B-spline of every segment, with its report.
    pub fits: Vec<Fit>,
    /// The surface, with the numbers of its making.
    pub blend: Blend,
    /// One watertight mesh of it.
    pub tessellation: Tessellation,
    /// How its seams join.
    pub certificate: Certificate,
    /// How far it lies from the mesh.
    pub deviation: Deviation,
    /// Seconds per stage.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Reconstructs a closed, connected, oriented manifold mesh.
///
/// # Errors
/// [`SutureError`], naming the stage and the segment, arc, corner or face where it stopped.
pub fn reconstruct(
    mesh: &TriMesh,
    stages: &Stages<'_>,
    options: &ReconstructOptions,
    watch: &dyn Watch,
) -> Result<Reconstruction, SutureError> {
    let mut clock = Clock { seconds: BTreeMap::new(), watch };
    let mut warnings = Vec::new();
    let topology = clock.run(Stage::Mesh, 1, || Ok(Topology::build(mesh)?))?;
    let diagonal = mesh.diagonal();
    let original = mesh;
    let ironed = iron(mesh, &topology, &options.refinement.ironing());
    if !ironed.moved.is_empty() {
        warnings.push(format!(
            "{} vertices at knife edges were moved, by up to {:.2} % of the diagonal: no smooth surface follows those (--keep-mesh \
             leaves them)",
            ironed.moved.len(),
            100.0 * ironed.farthest / diagonal
        ));
    }
    let mesh = &TriMesh::new(ironed.positions, mesh.faces.clone());
    let chosen = stages.segment.names_the_mesh();
    let refined = refine_curved(mesh, &options.refinement.resolve(options.widths.wanted, diagonal, !chosen))?;
    if refined.mesh.faces.len() > original.faces.len() {
        let (before, after) = (original.faces.len(), refined.mesh.faces.len());
        warnings
            .push(format!("{before} triangles were split into {after} where they are coarse for the blends"));
    }
    let (coarse, mesh) = (mesh, &refined.mesh);
    let coarse_topology = topology;
    let topology = Topology::build(mesh)?;
    let segmentation = clock.run(Stage::Segment, 1, || {
        if !chosen {
            return Ok(stages.segment.segment(mesh, &topology)?);
        }
        let coarsely = stages.segment.segment(coarse, &coarse_topology)?;
        let labels: Vec<u32> = refined.parents.iter().map(|&f| coarsely.labels[f as usize]).collect();
        let limits = Limits { max_valence: usize::MAX };
        Ok(Segmentation::from_labels_with(mesh, &topology, &labels, limits)?)
    })?;
    let valence = segmentation.corners.iter().map(|c| c.arcs.len()).fold(MOST_SEGMENTS, usize::max);
    let limits = Limits { max_valence: valence };

    let pieces = Pieces::new(mesh, &topology, stages, options, limits, watch);
    let mut state = pieces.charted(&mut clock, segmentation)?;
    let given = state.segmentation.charts.len();
    if let Some(tolerance) = options.splits.tolerance {
        state = pieces.split_poor(&mut clock, state, tolerance)?;
    }
    let parts = state.segmentation.charts.len() - given;
    if parts > 0 {
        warnings.push(format!("{parts} segments were split: their charts folded or missed the tolerance"));
    }
    let mut round = 0;
    // Folding blends are borne at creases, between segments that somebody chose, and elsewhere where another segmentation did not help.
    let mut patience = if chosen { 0 } else { options.splits.rounds.min(PATIENCE) };
    let blend = loop {
        let State { segmentation, charted, .. } = &state;
        let sewn = clock.run(Stage::Blend, 1, || {
            let strict = patience > 0;
            sew(&pieces, segmentation, charted, stages, options, strict, watch, &mut warnings)
        });
        let error = match sewn {
            Ok(blend) => break blend,
            Err(error) => error,
        };
        if patience == 0 && round == options.splits.rounds.min(MOST_RESEWN) {
            return Err(error);
        }
        round += 1;
        let before = segmentation.charts.len();
        let (blamed, impatient) = match patience {
            0 => (named(&error), false),
            _ => (doubtful(&error, mesh, &topology, &state), true),
        };
        let changed;
        (state, changed) = pieces.change(&mut clock, state, &blamed)?;
        if !changed && !impatient {
            return Err(error);
        }
        patience = if changed { patience.saturating_sub(1) } else { 0 };
        let after = state.segmentation.charts.len();
        if after != before {
            warnings.push(format!("{before} segments became {after}: {error}"));
        }
    };
    let State { segmentation, charted, .. } = state;
    let tessellation =
        clock.run(Stage::Tessellate, 1, || Ok(tessellate(&blend.surface, &options.tessellation)?))?;
    let certificate =
        clock.run(Stage::Certify, 1, || Ok(certify(&blend.surface, diagonal, &options.certify)?))?;
    let deviation = clock
        .run(Stage::Deviation, 1, || Ok(deviation(original, &blend.surface, &samples(&tessellation))?))?;
    let seconds = clock.seconds;
    let (charts, fits) = charted.into_iter().map(|c| (c.chart, c.fit)).unzip();
    let holders = refined.holders(original, &topology);
    let labels = holders.into_iter().map(|f| segmentation.labels[f as usize]).collect();
    Ok(Reconstruction {
        mesh: refined.mesh,
        moved: ironed.moved,
        segmentation,
        labels,
        charts,
        fits,
        blend,
        tessellation,
        certificate,
        deviation,
        seconds,
        warnings,
    })
}

/// A tessellation as the plain data that the deviation is measured on.
pub fn samples(tessellation: &Tessellation) -> SurfaceSamples<'_> {
    SurfaceSamples {
        positions: &tessellation.mesh.positions,
        triangles: &tessellation.mesh.faces,
        triangle_patch: &tessellation.triangle_patch,
        corner_parameters: &tessellation.corner_parameters,
    }
}

pub(crate) struct Clock<'a> {
    seconds: BTreeMap<&'static str, f64>,
    watch: &'a dyn Watch,
}

impl Clock<'_> {
    pub(crate) fn run<T>(
        &mut self,
        stage: Stage,
        steps: usize,
        work: impl FnOnce() -> Result<T, SutureError>,
    ) -> Result<T, SutureError> {
        if self.watch.interrupted() {
            return Err(SutureError::Interrupted);
        }
        self.watch.begin(stage, steps);
        let start = Instant::now();
        let result = work();
        *self.seconds.entry(stage.name()).or_default() += start.elapsed().as_secs_f64();
        result
    }
}

/// How often an arc is drawn before its blends are given up: in every way once, and in the first ones again beside what has changed.
const REDRAWINGS: usize = 10;
/// Most rounds of changing what cannot be blended: each one sews everything anew.
const MOST_RESEWN: usize = 6;
/// Rounds of changing what folds though its maps do not, before that is borne.
const PATIENCE: usize = 2;
/// Dihedral angle, in radians, of an arc's edges on the average, from which it lies on a crease, where nothing smooth is as good as wanted.
const CREASED: f64 = 30.0 * std::f64::consts::PI / 180.0;

/// Blends the charts; arcs along which no width fits are drawn in other ways. If it is `strict`, blends that fold though their maps do not
/// are an error even where no drawing helps.
fn sew(
    pieces: &Pieces<'_>,
    segmentation: &Segmentation,
    charted: &[Charted],
    stages: &Stages<'_>,
    options: &ReconstructOptions,
    strict: bool,
    watch: &dyn Watch,
    warnings: &mut Vec<String>,
) -> Result<Blend, SutureError> {
    let mut drafts = pieces.drafts(segmentation);
    let mut redrawn = vec![0; segmentation.arcs.len()];
    let mut content = false;
    let mut sewing: Option<Sewing<'_>> = None;
    loop {
        if watch.interrupted() {
            return Err(SutureError::Interrupted);
        }
        let drawings: Vec<usize> = redrawn.iter().map(|&times| times % DRAWINGS.len()).collect();
        let mut notes = Vec::new();
        let network = drafts.network(charted, &drawings, &mut notes)?;
        let sewing = match &mut sewing {
            Some(sewing) => {
                sewing.redraw(network)?;
                sewing
            }
            none => {
                let mut new = Sewing::new(network, stages.maps.as_ref(), &options.widths)?;
                new.be_strict(true);
                none.insert(new)
            }
        };
        let error = match sewing.sew() {
            Ok(blend) => {
                warnings.append(&mut notes);
                return Ok(blend);
            }
            Err(error) => error,
        };
        let blamed: Vec<usize> = match &error {
            BlendError::Obstacles { arcs, .. } => arcs.clone(),
            _ => (0..redrawn.len()).collect(),
        };
        let mut again = blamed.clone();
        again.retain(|&a| redrawn[a] < REDRAWINGS);
        if again.is_empty() || options.fair == Fairness::Edges {
            if content || strict {
                return Err(error.into());
            }
            content = true;
            sewing.be_strict(false);
            blamed.into_iter().for_each(|a| redrawn[a] = 0);
            continue;
        }
        again.into_iter().for_each(|a| redrawn[a] += 1);
    }
}

/// The segments that a failure of the blends names.
fn named(error: &SutureError) -> Vec<usize> {
    match error {
        SutureError::Blend(BlendError::Obstacles { segments, .. }) => segments.clone(),
        _ => Vec::new(),
    }
}

/// The segments that it names, and of the two beside every other arc concerned the one that is fitted worse; arcs on creases apart.
fn doubtful(error: &SutureError, mesh: &TriMesh, topology: &Topology, state: &State) -> Vec<usize> {
    let mut segments = named(error);
    if let SutureError::Blend(BlendError::Obstacles { arcs, .. }) = error {
        for arc in arcs.iter().map(|&a| &state.segmentation.arcs[a]) {
            let sides = [arc.left, arc.right].map(|s| s as usize);
            if !sides.iter().any(|s| segments.contains(s)) && bend(mesh, topology, &arc.vertices) < CREASED {
                let off = |s: usize| state.charted[s].fit.report.max;
                segments.push(if off(sides[0]) >= off(sides[1]) { sides[0] } else { sides[1] });
            }
        }
    }
    segments.sort_unstable();
    segments
}

/// Mean dihedral angle along a chain of edges, by length.
fn bend(mesh: &TriMesh, topology: &Topology, chain: &[u32]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for pair in chain.windows(2) {
        let Some(h) = topology.half_edge(pair[0], pair[1]) else { continue };
        let length = mesh.positions[pair[0] as usize].distance(mesh.positions[pair[1] as usize]);
        sum += length * suture_mesh::dihedral_angle(topology, mesh, h).map_or(0.0, f64::abs);
        total += length;
    }
    if total > 0.0 { sum / total } else { 0.0 }
}
