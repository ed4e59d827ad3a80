//! The choice of λ.

use glam::DVec3;
use nalgebra::{DMatrix, DVector};

use crate::system::{Factor, System};
use crate::{FitError, Smoothing};

/// Half decades above the floor that are searched: seven decades.
const STEPS: i32 = 14;
/// Share of the plain score in the robust one (Lukas 2006: 0.3).
const ROBUST: f64 = 0.3;
/// Fewest points of the grid that a choice is made from.
const FEWEST_TRIALS: usize = 6;

/// A chosen λ with its fit.
#[derive(Debug)]
pub(crate) struct Choice {
    pub(crate) lambda: f64,
    pub(crate) net: Vec<DVec3>,
    /// Effective degrees of freedom.
    pub(crate) trace: f64,
    /// Whether λ was taken from the data (and not given, or the smallest one for want of a better).
    pub(crate) from_data: bool,
}

/// One point of the grid of λ.
#[derive(Clone, Debug)]
struct Trial {
    lambda: f64,
    residual: f64,
    trace: f64,
    /// `tr H² = t + dt/d log λ`.
    trace_squared: f64,
}

/// Chooses λ for `points`; `n` is the number of vertices with weight, `floor` the smallest η, `sigma_unit` the diagonal in units
/// of the points.
pub(crate) fn choose(
    system: &System,
    points: &[DVec3],
    n: usize,
    smoothing: Smoothing,
    floor: f64,
    sigma_unit: f64,
) -> Result<Choice, FitError> {
    let floor = system.lambda(floor);
    let at = |lambda: f64, from_data: bool| -> Result<Choice, FitError> {
        let net = system.solve(&system.factor(lambda)?, points)?;
        Ok(Choice { lambda, net, trace: trace(system, lambda)?, from_data })
    };
    match smoothing {
        Smoothing::Floor => return at(floor, false),
        Smoothing::Floater => return at(system.floater().max(floor), false),
        Smoothing::Fixed(lambda) => return at(lambda, false),
        _ => {}
    }
    let n = n as f64;
    let gcv = |t: &Trial, gamma: f64| {
        let free = 1.0 - gamma * t.trace / n;
        if free > 0.0 { t.residual / (free * free) } else { f64::INFINITY }
    };
    let score = |t: &Trial| match smoothing {
        Smoothing::RobustGcv => (ROBUST + (1.0 - ROBUST) * t.trace_squared / n) * gcv(t, 1.0),
        Smoothing::Gcv { gamma } => gcv(t, gamma),
        _ => 0.0,
    };
    let target = match smoothing {
        Smoothing::Noise(sigma) => Some((sigma * sigma_unit).powi(2)),
        _ => None,
    };
    // The residual grows with λ, and no score is below its share of the residual.
    let share = if smoothing == Smoothing::RobustGcv { ROBUST } else { 1.0 };
    let passed = |residual: f64, trials: &[Trial]| match target {
        Some(target) => residual > target,
        None => share * residual > trials.iter().map(score).fold(f64::INFINITY, f64::min),
    };
    let trials = trials(system, points, floor, passed)?;
    let (chosen, from_data) = match target {
        Some(target) => match trials.iter().rposition(|t| t.residual.max(0.0) <= target) {
            Some(k) => (k, true),
            // No λ reaches the noise level: knots or chart misfit. The smallest λ is kept for the next round only.
            None => (0, false),
        },
        None => (least(&trials, score), true),
    };
    let t = &trials[chosen];
    let net = system.solve(&system.factor(t.lambda)?, points)?;
    Ok(Choice { lambda: t.lambda, net, trace: t.trace, from_data })
}

/// Index of the least score; where none is finite the stiffest λ (it has the fewest degrees of freedom).
fn least(trials: &[Trial], score: impl Fn(&Trial) -> f64) -> usize {
    let mut best = (trials.len() - 1, f64::INFINITY);
    for (k, t) in trials.iter().enumerate() {
        let s = score(t);
        if s < best.1 {
            best = (k, s);
        }
    }
    best.0
}

/// Residuals and degrees of freedom over the half-decade grid above `floor`, up to where the residual has `passed` what the trials below
/// leave to gain.
///
/// `t = N − d log det / d log λ` from a cubic spline through `log det` on the grid, one point wider on either side: no
/// factorisation beyond those that the residuals need.
fn trials(
    system: &System,
    points: &[DVec3],
    floor: f64,
    passed: impl Fn(f64, &[Trial]) -> bool,
) -> Result<Vec<Trial>, FitError> {
    let lambda = |k: i32| floor * 10f64.powf(0.5 * f64::from(k));
    let mut log_dets = Vec::new();
    let mut residuals: Vec<f64> = Vec::new();
    let mut trials = Vec::new();
    for k in -1..=STEPS + 1 {
        let factor = match system.factor(lambda(k)) {
            Ok(factor) => factor,
            // Few data are lost beside so stiff an energy: the grid ends here.
            Err(_) if log_dets.len() > FEWEST_TRIALS => break,
            Err(error) => return Err(error),
        };
        log_dets.push(factor.log_det());
        if log_dets.len() > FEWEST_TRIALS {
            trials = finish(system, lambda, &residuals, &log_dets);
            if residuals.last().is_some_and(|&residual| passed(residual, &trials)) {
                break;
            }
        }
        if (0..=STEPS).contains(&k) {
            residuals.push(system.residual(&system.solve(&factor, points)?, points));
        }
    }
    Ok(trials)
}

/// The trials of `residuals` at the inner ones of the values of λ that `log_dets` belong to.
fn finish(system: &System, lambda: impl Fn(i32) -> f64, residuals: &[f64], log_dets: &[f64]) -> Vec<Trial> {
    let step = 0.5 * std::f64::consts::LN_10;
    let (slopes, bends) = spline(log_dets, step);
    residuals
        .iter()
        .enumerate()
        .map(|(k, &residual)| {
            let trace = system.unknowns() as f64 - slopes[k + 1];
            Trial { lambda: lambda(k as i32), residual, trace, trace_squared: trace - bends[k + 1] }
        })
        .collect()
}

/// Degrees of freedom at one λ: a central difference of `log det` with a step of 0.02 in `log λ`.
pub(crate) fn trace(system: &System, lambda: f64) -> Result<f64, FitError> {
    let log_det = |shift: f64| system.factor(lambda * shift.exp()).map(|f: Factor| f.log_det());
    Ok(system.unknowns() as f64 - (log_det(0.01)? - log_det(-0.01)?) / 0.02)
}

/// First and second derivatives at the nodes of the not-a-knot cubic spline through equidistant `values` (at least five).
fn spline(values: &[f64], step: f64) -> (Vec<f64>, Vec<f64>) {
    let n = values.len();
    // Second derivatives M: (M[i−1] + 4 M[i] + M[i+1]) / 6 = second difference; third derivative continuous at both second nodes.
    let mut a = DMatrix::<f64>::zeros(n, n);
    let mut b = DVector::<f64>::zeros(n);
    for i in 1..n - 1 {
        a[(i, i - 1)] = 1.0;
        a[(i, i)] = 4.0;
        a[(i, i + 1)] = 1.0;
        b[i] = 6.0 * (values[i - 1] - 2.0 * values[i] + values[i + 1]) / (step * step);
    }
    for (row, i) in [(0, 1), (n - 1, n - 2)] {
        a[(row, i - 1)] = 1.0;
        a[(row, i)] = -2.0;
        a[(row, i + 1)] = 1.0;
    }
    let m = a.lu().solve(&b).unwrap_or_else(|| DVector::zeros(n));
    let slope = |i: usize| {
        // From the piece on the right, at the last node from the left.
        if i + 1 < n {
            (values[i + 1] - values[i]) / step - step * (2.0 * m[i] + m[i + 1]) / 6.0
        } else {
            (values[i] - values[i - 1]) / step + step * (2.0 * m[i] + m[i - 1]) / 6.0
        }
    };
    ((0..n).map(slope).collect(), m.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cells, EnergyOrder, Grid};
    use glam::DVec2;

    #[test]
    fn the_spline_reproduces_cubics() {
        let x = |i: usize| 0.3 * i as f64 - 1.0;
        let values: Vec<f64> = (0..8).map(|i| x(i).powi(3) - 2.0 * x(i).powi(2) + 0.5).collect();
        let (slopes, bends) = spline(&values, 0.3);
        for i in 0..8 {
            assert!((slopes[i] - (3.0 * x(i).powi(2) - 4.0 * x(i))).abs() < 1e-12);
            assert!((bends[i] - (6.0 * x(i) - 4.0)).abs() < 1e-11);
        }
    }

    fn system() -> (System, Vec<DVec2>) {
        let params: Vec<DVec2> = (0..400)
            .map(|k| {
                let (i, j) = (k % 20, k / 20);
                let jitter = DVec2::new((1.7 * k as f64).sin(), (2.9 * k as f64).cos()) * 0.3;
                (DVec2::new(i as f64, j as f64) + jitter) / 20.0
            })
            .collect();
        let grid = Grid::new(DVec2::splat(-0.1), DVec2::splat(1.1), [12, 12]).unwrap();
        let weights = vec![1.0 / 400.0; 400];
        (System::new(Cells::all(grid), &params, &weights, 1.0, EnergyOrder::Third).unwrap(), params)
    }

    /// `tr[(G + λE)⁻¹ G]` column by column: the influence of every datum on its own fitted value.
    fn dense_trace(system: &System, params: usize, lambda: f64) -> f64 {
        let factor = system.factor(lambda).unwrap();
        let mut t = 0.0;
        for k in 0..params {
            let mut points = vec![DVec3::ZERO; params];
            points[k].x = 1.0;
            let net = system.solve(&factor, &points).unwrap();
            t += system.positions(&net)[k].x;
        }
        t
    }

    #[test]
    fn traces_match_the_influence_of_every_datum() {
        let (system, params) = system();
        let points: Vec<DVec3> = params.iter().map(|p| DVec3::new(p.x, p.y, (3.0 * p.x).sin())).collect();
        let floor = system.lambda(1e-4);
        let trials = trials(&system, &points, floor, |_, _| false).unwrap();
        for k in [0, 2, 5, 9, 14] {
            let exact = dense_trace(&system, params.len(), trials[k].lambda);
            let by_difference = trace(&system, trials[k].lambda).unwrap();
            assert!((by_difference / exact - 1.0).abs() < 1e-4, "{k}: {by_difference} {exact}");
            assert!((trials[k].trace / exact - 1.0).abs() < 5e-3, "{k}: {} {exact}", trials[k].trace);
        }
    }
}
