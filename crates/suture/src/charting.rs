//! Segments to B-splines: collars, charts and fits, and which of them had better be split.

use rayon::prelude::*;
use suture_fit::{Fit, FitInput, FitSurface, Outcome};
use suture_mesh::{Topology, TriMesh};
use suture_param::{Chart, CollarOptions, Disc, Limits, Parameterize, disc_with_collar};
use suture_segment::Segmentation;

use crate::{SutureError, Watch};

/// Most rings of a collar: a bound for meshes whose triangles are tiny against the width of the blends.
const MAX_RINGS: usize = 12;

/// Parts of the wanted collar that are tried in turn: all of it, a single ring, and where that matters what lies between.
const COLLARS: [f64; 4] = [1.0, 0.0, 0.5, 0.25];

/// Residual (relative to the diagonal) up to which a fit is good enough to keep a collar.
const GOOD_FIT: f64 = 5e-4;

/// What the charting of all segments shares, measured once.
#[derive(Clone, Copy)]
pub(crate) struct Charting<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) topology: &'a Topology,
    pub(crate) segmentation: &'a Segmentation,
    pub(crate) parameterize: &'a (dyn Parameterize + Sync),
    pub(crate) fit: &'a (dyn FitSurface + Sync),
    /// Dihedral angle that collars do not cross.
    pub(crate) sharp: f64,
    /// Extent from which a crease stops collars.
    pub(crate) shortest: f64,
    pub(crate) diagonal: f64,
    /// Median edge length.
    pub(crate) edge: f64,
}

/// A segment with its chart, its B-spline, and how far outside the segment that may be used.
#[derive(Debug)]
pub(crate) struct Charted {
    pub(crate) chart: Chart,
    pub(crate) fit: Fit,
    pub(crate) reach: f64,
}

/// Share of a segment's residual that its parts must undercut together, or one of them alone, for the split to be kept: noise stays what
/// it is however small the parts.
const WORTH: f64 = 0.8;
const WORTH_ALONE: f64 = 0.5;
/// Largest residual, in root mean squares, from which it is no noise but a place that the chart cannot follow; it stays in one of the parts
/// and has to be cut out of that next.
const LOCAL: f64 = 5.0;

/// Largest residual that a part may have, in those of the whole: a sliver that no chart fits is worse than what it was cut from.
const MOST_WORSE: f64 = 1.5;

/// Area ratio beyond which a chart is split: knots a median edge apart are ten edges apart where it is squeezed.
const SQUEEZED: f64 = 100.0;

/// Largest residual that a fit may have, in tolerances.
const MOST_OFF: f64 = 5.0;

impl Charted {
    /// Whether the segment had better be split: its chart folds or is squeezed, or its fit misses the tolerance.
    pub(crate) fn poor(&self, tolerance: f64) -> bool {
        let report = &self.fit.report;
        self.folded() || self.squeezed() || report.rms > tolerance || report.max > MOST_OFF * tolerance
    }

    /// Whether the fit has no flipped samples and the chart no more distortion than it may.
    pub(crate) fn sound(&self) -> bool {
        self.fit.report.guard.passed() && self.chart.distortion.accepted
    }

    /// How much more a residual counts for what is wrong with the chart.
    fn doubt(&self) -> f64 {
        match self.fit.report.guard.flipped_inside {
            0 if self.sound() => 1.0,
            0 => UNSOUND,
            _ => TURNED,
        }
    }

    /// How much there is to gain from splitting the segment.
    pub(crate) fn badness(&self) -> f64 {
        if self.folded() { f64::INFINITY } else { self.fit.report.max }
    }

    fn folded(&self) -> bool {
        folded(&self.chart)
    }

    fn squeezed(&self) -> bool {
        squeezed(&self.chart)
    }

    /// Whether two parts are better than this whole.
    pub(crate) fn worse_than(&self, parts: [&Charted; 2]) -> bool {
        let (whole, [a, b]) = (self.fit.report.rms, parts.map(|p| p.fit.report.rms));
        let [m, n] = parts.map(|p| p.fit.report.vertices as f64);
        let together = ((m * a * a + n * b * b) / (m + n)).sqrt();
        let alone = if self.fit.report.max > LOCAL * whole { WORTH } else { WORTH_ALONE };
        let farthest = parts.iter().map(|p| p.fit.report.max).fold(0.0, f64::max);
        let closer = (together < WORTH * whole || a.min(b) < alone * whole)
            && farthest <= MOST_WORSE * self.fit.report.max;
        let folded = parts.iter().filter(|part| part.folded()).count();
        let squeezed = parts.iter().filter(|part| part.squeezed()).count();
        match (self.folded(), self.squeezed()) {
            (true, _) => folded < 2,
            (false, true) => folded == 0 && (closer || squeezed < 2),
            (false, false) => folded == 0 && closer,
        }
    }
}

/// Charts and fits every segment that has none yet.
///
/// # Errors
/// [`SutureError::Chart`], [`SutureError::Fit`], [`SutureError::Interrupted`].
pub(crate) fn chart_all(
    context: &Charting<'_>,
    known: Vec<Option<Charted>>,
    collars: &[f64],
    watch: &dyn Watch,
) -> Result<Vec<Charted>, SutureError> {
    let charted: Vec<_> = known
        .into_par_iter()
        .enumerate()
        .map(|(s, known)| {
            if watch.interrupted() {
                return Err(SutureError::Interrupted);
            }
            let charted = match known {
                Some(known) => known,
                None => chart(context, s, collars[s])?,
            };
            watch.step();
            Ok(charted)
        })
        .collect();
    // In the order of the segments, so that of several errors the first one is reported.
    charted.into_iter().collect()
}

/// Cuts, flattens and fits a segment with the widest collar that can be fitted well: a collar that runs into a cavity or over a
/// tip spoils the whole chart (spot: residuals of 3e-3 with three rings, 3e-4 with one). The first is an edge wider than the
/// blends need, because a fit is worst at its rim: of the torus's mean curvature the blends then miss 5 % and not 8 %.
fn chart(context: &Charting<'_>, segment: usize, collar: f64) -> Result<Charted, SutureError> {
    let mut tried: Vec<(f64, Charted)> = Vec::new();
    // Charts that no knots can follow: fits of them are as slow as they are useless, so they are for the last resort.
    let mut useless: Vec<(f64, Chart)> = Vec::new();
    let mut failure = None;
    for (attempt, part) in COLLARS.into_iter().enumerate() {
        // Where a single ring is no better, the collar is not what is wrong.
        if let ([(whole, first), (ring, _)], 2) = (&tried[..], attempt)
            && *ring > WORTH * whole
            && first.doubt() <= UNSOUND
        {
            break;
        }
        let width = part * (collar + context.edge);
        let charts = tried.iter().map(|(_, charted)| &charted.chart).chain(useless.iter().map(|(_, c)| c));
        let known: Vec<usize> = charts.map(|chart| chart.disc.faces.len()).collect();
        let flat = match cut(context, segment, width) {
            Ok(disc) if known.contains(&disc.faces.len()) => continue,
            Ok(disc) => flatten(context, segment, disc),
            Err(error) => Err(error),
        };
        match flat {
            Ok(chart) if folded(&chart) || squeezed(&chart) => useless.push((width, chart)),
            Ok(chart) => match fit(context, segment, width, chart) {
                Ok(charted) => {
                    let report = &charted.fit.report;
                    let fits = report.outcome == Outcome::Tolerance || report.rms <= GOOD_FIT;
                    // A wider one than a single ring may be as good.
                    if fits && charted.sound() && part > 0.0 {
                        return Ok(charted);
                    }
                    tried.push((report.rms * charted.doubt(), charted));
                }
                Err(error) => failure = failure.or(Some(error)),
            },
            Err(error) => failure = failure.or(Some(error)),
        }
    }
    if let Some((_, charted)) = tried.into_iter().min_by(|(a, _), (b, _)| a.total_cmp(b)) {
        return Ok(charted);
    }
    let wrong = |chart: &Chart| (folds(chart), chart.distortion.area_ratio);
    let least = useless.into_iter().min_by(|(_, a), (_, b)| {
        let ((a, x), (b, y)) = (wrong(a), wrong(b));
        a.cmp(&b).then(x.total_cmp(&y))
    });
    match (least, failure) {
        (Some((width, chart)), _) => fit(context, segment, width, chart),
        (None, Some(error)) => Err(error),
        (None, None) => Err(SutureError::Internal { what: format!("segment {segment} was not charted") }),
    }
}

/// How many triangles the flattening flips or lands on others.
fn folds(chart: &Chart) -> usize {
    chart.distortion.flips + chart.distortion.overlaps
}

fn folded(chart: &Chart) -> bool {
    folds(chart) > 0
}

/// Whether the flattening squeezes a part so much that knots cannot follow it.
fn squeezed(chart: &Chart) -> bool {
    chart.distortion.area_ratio > SQUEEZED
}

/// Residuals count this much more where the guards of the fit or the limits of the distortion do not hold, and where the fit turns over
/// in the segment itself.
const UNSOUND: f64 = 4.0;
const TURNED: f64 = 16.0;

/// The disc of a segment with a collar of this width.
fn cut(context: &Charting<'_>, segment: usize, collar: f64) -> Result<Disc, SutureError> {
    let Charting { mesh, topology, segmentation, sharp, shortest, .. } = *context;
    let options =
        CollarOptions { width: collar, max_rings: MAX_RINGS, sharp, shortest, ..CollarOptions::default() };
    disc_with_collar(mesh, topology, &segmentation.charts[segment].faces, &options)
        .map_err(|source| SutureError::Chart { segment, source })
}

fn flatten(context: &Charting<'_>, segment: usize, disc: Disc) -> Result<Chart, SutureError> {
    let wrong = |source| SutureError::Chart { segment, source };
    Chart::flatten(disc, &context.parameterize, &Limits::default()).map_err(wrong)
}

fn fit(context: &Charting<'_>, segment: usize, collar: f64, chart: Chart) -> Result<Charted, SutureError> {
    // A crease or a handle may stop the collar short: there the B-spline continues on its own. It does so without harm for half an edge (spot:
    // with a whole one blends were 0.8 % off where both surfaces were fitted to 0.2 %).
    let reach = collar.max(chart.disc.reach.unwrap_or(0.0)).max(0.5 * context.edge);
    let input = FitInput {
        points: &chart.disc.positions,
        params: &chart.uv,
        triangles: &chart.disc.faces,
        in_segment: &chart.disc.in_segment,
        diagonal: context.diagonal,
        reach,
    };
    let fit = context.fit.fit(&input).map_err(|source| SutureError::Fit { segment, source })?;
    let chart = chart.with_uv(fit.params.clone()).map_err(|source| SutureError::Chart { segment, source })?;
    Ok(Charted { chart, fit, reach })
}
