//! The recipe: knots, λ, parameter correction, guards and the decision when to stop.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_bernstein::{BSplineSurface, Jet2};

use crate::chart::Chart;
use crate::correction::correct;
use crate::guard::inspect;
use crate::rectangle::Frame;
use crate::smoothing::{self, Choice, choose};
use crate::{
    Cells, EnergyOrder, FitError, FitInput, FitOptions, FitReport, Grid, GuardReport, Mode, Outcome,
    Smoothing, System,
};

/// A fitted chart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The surface, over the parameters of [`Fit::params`].
    pub surface: BSplineSurface<DVec3>,
    /// The chart's parameters from now on: turned by [`Fit::frame`], then corrected. Arcs, corners and collars must be located
    /// in the triangles with these parameters; mixing old parameters with the new surface shifts everything tangentially.
    pub params: Vec<DVec2>,
    /// The rigid motion from the input's parameters to the surface's (before the correction).
    pub frame: Frame,
    /// Where the surface may be evaluated.
    pub cells: Cells,
    /// The numbers.
    pub report: FitReport,
}

impl Fit {
    /// Value and partials, or `None` outside the active cells: there the surface is not determined by data or energy.
    pub fn jet(&self, at: DVec2) -> Option<Jet2> {
        self.cells.covers(at).then(|| self.surface.jet(at))
    }
}

/// The stage `fit` of a reconstruction: chart to surface. Implement it to replace the default.
pub trait FitSurface {
    /// Fits one chart.
    ///
    /// # Errors
    /// What the implementation refuses; see [`FitError`].
    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, FitError>;
}

/// The default [`FitSurface`]: [`fit`] with these options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PenalizedLeastSquares {
    /// The options.
    pub options: FitOptions,
}

impl FitSurface for PenalizedLeastSquares {
    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, FitError> {
        fit(input, &self.options)
    }
}

/// Fewest vertices for more than one cell.
const FEW: usize = 10;
/// Margin of the domain rectangle, as a part of its square-root area.
const MARGIN: f64 = 0.05;
/// λ of the parameter correction, in floors.
const CORRECTION_STIFFNESS: f64 = 10.0;
/// λ at least this many floors means that the residual is noise.
const NOISE_LIMITED: f64 = 10.0;
/// Residual that finer knots must leave of a noisy one to be called noise (a noisy sphere: 0.97 to 1.03; coarse clean meshes: 0.3 to 0.8).
const NOISE_STAYS: f64 = 0.85;
/// Largest residual, in root mean squares, from which it is no noise but detail: of a normal distribution not one vertex in 10⁶ lies
/// that far out.
const LOCAL: f64 = 5.0;
/// How often the guards may raise λ tenfold.
const GUARD_INCREASES: usize = 4;
/// By how much they may raise the residual.
const GUARD_PRICE: f64 = 2.0;

/// Fits one chart by the recommended recipe.
///
/// Start with `h = √2 e`, choose λ, correct the parameters, guard, measure; end within tolerance, where λ says that the residual
/// is noise, or at the finest knots. With fewer than ten vertices one cell is used; with vertices on a conic the second-order
/// energy (see [`FitReport::order`]).
///
/// # Errors
/// The input is refused with the offending index: [`FitError::Length`], [`FitError::NotFinite`], [`FitError::TriangleIndex`],
/// [`FitError::TooFew`], [`FitError::Collinear`], [`FitError::ZeroArea`], [`FitError::EmptySegment`], [`FitError::Value`]; the
/// computation fails: [`FitError::Breakdown`] (after one retry at ten floors), [`FitError::Memory`], [`FitError::Net`].
/// A missed tolerance or a failed guard is no error but part of the report.
pub fn fit(input: &FitInput<'_>, options: &FitOptions) -> Result<Fit, FitError> {
    options.check()?;
    let chart = Chart::new(input)?;
    let order = chart.order(options.order);
    let knots = &options.knots;
    let finest = knots.finest.min(knots.start) * chart.edge;
    let mut h = knots.start * chart.edge;
    let grid = lay_grid(&chart, &chart.params, h, options)?;
    let mut round = Round::run(&chart, grid, chart.params.clone(), order, options)?;
    let (mut rounds, mut corrections) = (1, round.corrections);
    loop {
        if round.within(options) {
            return round.finish(&chart, order, rounds, corrections, Outcome::Tolerance);
        }
        let noisy = round.noise_limited && options.mode == Mode::Data && round.max <= LOCAL * round.rms;
        let last = if noisy { Outcome::Noise } else { Outcome::Limit };
        // Rounding of √2 · √2 must neither cost a round nor add one at h = e.
        if knots.cells.is_some() || chart.vertices < FEW || h <= finest * (1.0 + 1e-9) {
            return round.finish(&chart, order, rounds, corrections, last);
        }
        h = (h / knots.ratio).max(finest);
        let finer = lay_grid(&chart, &round.params, h, options)?;
        // The limit on the coefficients may leave nothing to refine.
        if finer.spacing() >= 0.99 * round.system.grid().spacing() {
            return round.finish(&chart, order, rounds, corrections, last);
        }
        let next = Round::run(&chart, finer, round.params.clone(), order, options)?;
        rounds += 1;
        corrections += next.corrections;
        // Noise does not care for knots; detail that was too fine for them does.
        if noisy && next.rms > NOISE_STAYS * round.rms {
            return round.finish(&chart, order, rounds, corrections, Outcome::Noise);
        }
        round = next;
    }
}

/// The domain rectangle, padded, with nearly square cells of side about `h`.
fn lay_grid(chart: &Chart<'_>, params: &[DVec2], h: f64, options: &FitOptions) -> Result<Grid, FitError> {
    let (low, high) = params.iter().fold((params[0], params[0]), |(l, h), &p| (l.min(p), h.max(p)));
    let size = high - low;
    let root = (size.x * size.y).sqrt();
    if let Some(cells) = options.knots.cells {
        let margin = pad(chart, root, 0.0);
        return Grid::new(low - margin, high + margin, cells);
    }
    if chart.vertices < FEW {
        let margin = pad(chart, root, 0.0);
        return Grid::new(low - margin, high + margin, [1, 1]);
    }
    let limit = options.knots.limit as f64;
    // At least the spacing at which the unpadded rectangle reaches the limit: bounds the loop below.
    let mut h = h.max(root / limit.sqrt()).max(size.max_element() / limit);
    loop {
        let margin = pad(chart, root, h);
        let padded = size + 2.0 * margin;
        let count = [0, 1].map(|d| (padded[d] / h).round().max(1.0));
        if (count[0] + 3.0) * (count[1] + 3.0) <= limit {
            return Grid::new(low - margin, high + margin, count.map(|c| c as usize));
        }
        h *= 1.05;
    }
}

/// The margin: whatever the reach needs, plus a cell for what the correction may move.
fn pad(chart: &Chart<'_>, root: f64, h: f64) -> f64 {
    let reach = if chart.reach > 0.0 { chart.reach + h } else { 0.0 };
    reach.max(MARGIN * root)
}

/// One round at fixed knots.
struct Round {
    system: System,
    params: Vec<DVec2>,
    net: Vec<DVec3>,
    lambda: f64,
    /// `t / n`.
    freedom: f64,
    sigma: Option<f64>,
    rms: f64,
    max: f64,
    worst: usize,
    corrections: usize,
    noise_limited: bool,
    guard: GuardReport,
}

impl Round {
    fn run(
        chart: &Chart<'_>,
        grid: Grid,
        params: Vec<DVec2>,
        order: EnergyOrder,
        options: &FitOptions,
    ) -> Result<Self, FitError> {
        let cells = Cells::around(grid, &params, chart.triangles, chart.reach);
        let system = System::new(cells, &params, &chart.weights, chart.area, order)?;
        let n = chart.vertices;
        let choose_at = |system: &System| {
            let select =
                |floor| choose(system, &chart.points, n, options.smoothing, floor, 1.0 / chart.relative);
            match select(options.floor) {
                Err(FitError::Breakdown { .. }) => select(10.0 * options.floor),
                other => other,
            }
        };
        let floor = system.lambda(options.floor);
        // The parameters are corrected at a small λ and λ is chosen for them: the other way round what the correction would remove is
        // taken for noise, and the search is the expensive part.
        let first = match options.smoothing {
            Smoothing::Gcv { .. } | Smoothing::RobustGcv | Smoothing::Noise(_) if options.corrections > 0 => {
                let lambda = CORRECTION_STIFFNESS * floor;
                let net = system.solve(&system.factor(lambda)?, &chart.points)?;
                Choice { lambda, net, trace: smoothing::trace(&system, lambda)?, from_data: true }
            }
            _ => choose_at(&system)?,
        };
        let from_data = first.from_data;
        let mut round = Self {
            freedom: first.trace / n as f64,
            lambda: first.lambda,
            net: first.net,
            system,
            params,
            sigma: None,
            rms: 0.0,
            max: 0.0,
            worst: 0,
            corrections: 0,
            noise_limited: false,
            guard: GuardReport::default(),
        };
        round.estimate_noise(chart);
        for _ in 0..options.corrections {
            if !round.correct(chart, options)? {
                break;
            }
        }
        if from_data {
            let choice = choose_at(&round.system)?;
            round.noise_limited = choice.from_data
                && (matches!(options.smoothing, Smoothing::Noise(_))
                    || choice.lambda >= NOISE_LIMITED * floor * (1.0 - 1e-9));
            (round.lambda, round.net, round.freedom) = (choice.lambda, choice.net, choice.trace / n as f64);
            round.estimate_noise(chart);
        }
        round.measure(chart);
        if options.mode == Mode::Tolerance {
            while !round.within(options) && round.lambda > floor * (1.0 + 1e-9) {
                round.refit(chart, (round.lambda / 10.0).max(floor))?;
                round.freedom = smoothing::trace(&round.system, round.lambda)? / n as f64;
                round.estimate_noise(chart);
                round.measure(chart);
            }
        }
        round.watch(chart)?;
        Ok(round)
    }

    fn within(&self, options: &FitOptions) -> bool {
        self.rms <= options.tolerance.rms && self.max <= options.tolerance.max
    }

    fn refit(&mut self, chart: &Chart<'_>, lambda: f64) -> Result<(), FitError> {
        self.net = self.system.solve(&self.system.factor(lambda)?, &chart.points)?;
        self.lambda = lambda;
        Ok(())
    }

    /// One round of foot points and refit at the same λ; `false` when nothing moved.
    fn correct(&mut self, chart: &Chart<'_>, options: &FitOptions) -> Result<bool, FitError> {
        // Correction follows the noise where it is comparable to the edges.
        let limit = options.correction_noise * chart.edge * chart.stretch;
        if self.sigma.is_none_or(|sigma| sigma > limit) {
            return Ok(false);
        }
        let cells = self.system.cells();
        let Some(params) =
            correct(cells, &self.net, &chart.points, &self.params, &chart.params, chart.triangles)
        else {
            return Ok(false);
        };
        self.system = self.system.relocate(&params, &chart.weights)?;
        self.params = params;
        self.refit(chart, self.lambda)?;
        self.estimate_noise(chart);
        self.corrections += 1;
        Ok(true)
    }

    /// Raises λ until the guards are content; the fit stays as it was when they never are, or when that costs more than
    /// [`GUARD_PRICE`] in residual: a few opposing samples beside a spike are not worth the whole chart (blobby: λ · 10⁴ removed
    /// some of them and raised the RMS from 5e-4 to 3e-2).
    fn watch(&mut self, chart: &Chart<'_>) -> Result<(), FitError> {
        let look = |round: &Self| inspect(chart, round.system.cells(), &round.params, &round.net);
        self.guard = look(self);
        if self.guard.passed() {
            return Ok(());
        }
        let before = (self.guard, self.lambda, self.net.clone(), self.rms);
        for increases in 1..=GUARD_INCREASES {
            // So stiff an energy may leave nothing of few data: then this was the last increase.
            if self.refit(chart, self.lambda * 10.0).is_err() {
                break;
            }
            self.guard = GuardReport { increases, ..look(self) };
            self.measure(chart);
            if self.guard.passed() || self.rms > GUARD_PRICE * before.3 {
                break;
            }
        }
        if !self.guard.passed() || self.rms > GUARD_PRICE * before.3 {
            let increases = self.guard.increases;
            (self.guard, self.lambda, self.net) = (GuardReport { increases, ..before.0 }, before.1, before.2);
            self.measure(chart);
        }
        self.freedom = smoothing::trace(&self.system, self.lambda)? / chart.vertices as f64;
        self.estimate_noise(chart);
        Ok(())
    }

    /// `σ² = RSS / (1 − t/n)`, in the chart's local lengths.
    fn estimate_noise(&mut self, chart: &Chart<'_>) {
        let free = 1.0 - self.freedom;
        self.sigma = (free > 0.0).then(|| (self.system.residual(&self.net, &chart.points) / free).sqrt());
    }

    fn measure(&mut self, chart: &Chart<'_>) {
        let at = self.system.positions(&self.net);
        let mut squares = Vec::new();
        let mut worst = (0, 0.0);
        for (i, (p, x)) in at.iter().zip(&chart.points).enumerate() {
            if chart.in_segment[i] {
                let square = p.distance_squared(*x);
                squares.push(square);
                if square > worst.1 {
                    worst = (i, square);
                }
            }
        }
        squares.sort_by(f64::total_cmp);
        self.rms = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt() * chart.relative;
        self.max = worst.1.sqrt() * chart.relative;
        self.worst = worst.0;
    }

    fn finish(
        self,
        chart: &Chart<'_>,
        order: EnergyOrder,
        rounds: usize,
        corrections: usize,
        outcome: Outcome,
    ) -> Result<Fit, FitError> {
        let grid = self.system.grid();
        let net = self.net.iter().map(|&p| p * chart.scale + chart.centre).collect();
        let report = FitReport {
            vertices: chart.vertices,
            cells: grid.cells,
            coefficients: self.system.unknowns(),
            order,
            spacing: grid.spacing() / chart.edge,
            lambda: self.lambda,
            eta: self.system.eta(self.lambda),
            freedom: self.freedom,
            sigma: self.sigma.map(|s| s * chart.relative),
            rms: self.rms,
            max: self.max,
            worst: self.worst,
            rounds,
            corrections,
            outcome,
            guard: self.guard,
        };
        Ok(Fit {
            surface: grid.surface(net)?,
            params: self.params,
            frame: chart.frame,
            cells: self.system.cells().clone(),
            report,
        })
    }
}
