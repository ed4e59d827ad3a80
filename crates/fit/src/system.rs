//! The penalised least-squares problem of one chart over fixed knots: assemble once, factor per lambda, solve many.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::cholesky::{Failure, Symbolic};
use crate::energy::cell_energy;
use crate::grid::basis;
use crate::stencil::{NONE, Pattern, Stencil};
use crate::{Cells, EnergyOrder, FitError, Grid};

/// Minimises `Σ wᵢ |F(pᵢ) − xᵢ|² + λ a^(m−1) ∫ |Dᵐ F|²` over the coefficients of the active cells.
///
/// `G = Aᵀ W A` and the energy are assembled cell by cell, `A` is never formed; the energy is integrated over the active
/// cells. λ is dimensionless when the weights sum to one and `a` is the area of the chart in the parameter plane.
#[derive(Clone, Debug)]
pub struct System {
    cells: Cells,
    order: EnergyOrder,
    /// `h² / a`: turns η into the factor of the dimensionless energy.
    unit: f64,
    /// `(a / h²)ᵐ`: turns λ into η.
    stiffness: f64,
    data: Vec<Datum>,
    points: usize,
    g: Stencil,
    e: Arc<Stencil>,
    pattern: Arc<Pattern>,
    symbolic: Arc<Symbolic>,
}

/// One data point in its cell.
#[derive(Clone, Copy, Debug)]
struct Datum {
    index: usize,
    cell: [usize; 2],
    weight: f64,
    u: [f64; 4],
    v: [f64; 4],
}

/// A [`System`] factored for one λ.
#[derive(Debug)]
pub struct Factor {
    lambda: f64,
    /// Factor of the dimensionless energy.
    kappa: f64,
    /// Scaling to unit diagonal.
    scale: Vec<f64>,
    values: Vec<f64>,
    log_det: f64,
}

impl Factor {
    /// The dimensionless λ.
    pub fn lambda(&self) -> f64 {
        self.lambda
    }

    /// `log det(G + λ a^(m−1) E)`.
    pub fn log_det(&self) -> f64 {
        self.log_det
    }
}

impl System {
    /// Assembles the problem: `params` and `weights` one per point, `area` of the chart in the parameter plane.
    ///
    /// # Errors
    /// [`FitError::Length`], [`FitError::NotFinite`], [`FitError::Value`] (`area`), [`FitError::Inactive`],
    /// [`FitError::Memory`].
    pub fn new(
        cells: Cells,
        params: &[DVec2],
        weights: &[f64],
        area: f64,
        order: EnergyOrder,
    ) -> Result<Self, FitError> {
        if !(area > 0.0 && area.is_finite()) {
            return Err(FitError::Value { name: "area", value: area, expected: "positive and finite" });
        }
        let pattern = Arc::new(Pattern::new(&cells));
        if pattern.len() == 0 {
            return Err(FitError::Value { name: "active cells", value: 0.0, expected: "at least 1" });
        }
        let grid = cells.grid();
        let energy = cell_energy(order, grid.step.x / grid.step.y);
        let mut e = Stencil::zero(pattern.len());
        for cell in cells.iter() {
            e.add(pattern.rows(cell), &energy);
        }
        let h = grid.spacing();
        let unit = h / area * h;
        let mut system = Self {
            symbolic: Arc::new(Symbolic::new(&pattern)?),
            cells,
            order,
            unit,
            stiffness: unit.powi(-order.order()),
            data: Vec::new(),
            points: 0,
            g: Stencil::zero(pattern.len()),
            e: Arc::new(e),
            pattern,
        };
        system.gather(params, weights)?;
        Ok(system)
    }

    /// The same knots, cells and energy with other parameters: reuses the symbolic factorisation.
    ///
    /// # Errors
    /// [`FitError::Length`], [`FitError::NotFinite`], [`FitError::Inactive`].
    pub fn relocate(&self, params: &[DVec2], weights: &[f64]) -> Result<Self, FitError> {
        let mut system = Self { g: Stencil::zero(0), data: Vec::new(), ..self.clone() };
        system.gather(params, weights)?;
        Ok(system)
    }

    /// The active cells.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The grid.
    pub fn grid(&self) -> Grid {
        self.cells.grid()
    }

    /// The energy.
    pub fn order(&self) -> EnergyOrder {
        self.order
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.pattern.len()
    }

    /// Number of values in a factor: its memory in units of eight bytes.
    pub fn factor_len(&self) -> usize {
        self.symbolic.factor_len()
    }

    /// Stiffness relative to the knots, `η = λ (a / h²)ᵐ`.
    pub fn eta(&self, lambda: f64) -> f64 {
        lambda * self.stiffness
    }

    /// The λ of a given `η`.
    pub fn lambda(&self, eta: f64) -> f64 {
        eta / self.stiffness
    }

    /// Floater's 1998 default, `|AᵀWA|_F / |a^(m−1) E|_F`: a constant η, kept as a diagnostic.
    pub fn floater(&self) -> f64 {
        self.lambda(self.g.frobenius() / self.e.frobenius() / self.unit)
    }

    /// Factors `G + λ a^(m−1) E`, scaled to unit diagonal.
    ///
    /// # Errors
    /// [`FitError::Value`] when λ is not positive and finite, [`FitError::Breakdown`], [`FitError::Memory`].
    pub fn factor(&self, lambda: f64) -> Result<Factor, FitError> {
        let kappa = self.eta(lambda) * self.unit;
        if !(lambda > 0.0 && kappa > 0.0 && kappa.is_finite()) {
            return Err(FitError::Value { name: "lambda", value: lambda, expected: "positive and finite" });
        }
        let breakdown = |unknown: usize| {
            let k = self.pattern.net()[unknown];
            let [_, q] = self.pattern.count();
            let cells = self.grid().cells;
            let cell =
                [(k / q).saturating_sub(1).min(cells[0] - 1), (k % q).saturating_sub(1).min(cells[1] - 1)];
            FitError::Breakdown { cell, eta: self.eta(lambda) }
        };
        let columns = || self.g.0.iter().zip(&self.e.0);
        let mut log_det = 0.0;
        let mut scale = Vec::with_capacity(self.unknowns());
        for (k, (g, e)) in columns().enumerate() {
            let diagonal = g[0] + kappa * e[0];
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return Err(breakdown(k));
            }
            log_det += diagonal.ln();
            scale.push(1.0 / diagonal.sqrt());
        }
        let mut values = Vec::with_capacity(self.unknowns() * 25);
        for ((i, (g, e)), row) in columns().enumerate().zip(self.pattern.neighbours()) {
            for (k, &j) in row.iter().enumerate().filter(|&(_, &j)| j != NONE) {
                values.push((g[k] + kappa * e[k]) * scale[i] * scale[j as usize]);
            }
        }
        let values = self.symbolic.factor(&values).map_err(|failure| match failure {
            Failure::Pivot(unknown) => breakdown(unknown),
            Failure::Memory => FitError::Memory { coefficients: self.unknowns() },
        })?;
        log_det += self.symbolic.log_det(&values);
        Ok(Factor { lambda, kappa, scale, values, log_det })
    }

    /// The net that fits `points`, all coefficients of the grid; those without an active cell repeat their nearest neighbour.
    ///
    /// Works about the centroid of the points and refines once with the residual taken from the points.
    ///
    /// # Errors
    /// [`FitError::Length`], [`FitError::NotFinite`], [`FitError::Memory`].
    pub fn solve(&self, factor: &Factor, points: &[DVec3]) -> Result<Vec<DVec3>, FitError> {
        self.check_points(points)?;
        if factor.scale.len() != self.unknowns() {
            let (given, needed) = (factor.scale.len(), self.unknowns());
            return Err(FitError::Length { what: "factor", given, needed });
        }
        let (centre, scale) = local(points);
        let local: Vec<DVec3> = points.iter().map(|&x| (x - centre) / scale).collect();
        let mut c = vec![[0.0; 3]; self.unknowns()];
        for _ in 0..2 {
            let r = self.gradient(&local, factor.kappa, &c);
            let step = self.back_substitute(factor, &r)?;
            for (c, s) in c.iter_mut().zip(step) {
                for d in 0..3 {
                    c[d] += s[d];
                }
            }
        }
        Ok(self.spread(&c).into_iter().map(|p| p * scale + centre).collect())
    }

    /// Positions of the surface with coefficients `net` at the data, in the order of the parameters.
    pub fn positions(&self, net: &[DVec3]) -> Vec<DVec3> {
        let q = self.grid().count()[1];
        let mut out = vec![DVec3::ZERO; self.points];
        for d in &self.data {
            let mut sum = DVec3::ZERO;
            for a in 0..4 {
                let row = &net[(d.cell[0] + a) * q + d.cell[1]..][..4];
                sum += (row[0] * d.v[0] + row[1] * d.v[1] + row[2] * d.v[2] + row[3] * d.v[3]) * d.u[a];
            }
            out[d.index] = sum;
        }
        out
    }

    /// Weighted residual sum of squares `Σ wᵢ |F(pᵢ) − xᵢ|²`.
    pub fn residual(&self, net: &[DVec3], points: &[DVec3]) -> f64 {
        let at = self.positions(net);
        self.data.iter().map(|d| d.weight * at[d.index].distance_squared(points[d.index])).sum()
    }

    /// Sorts the points by cell and assembles `G`.
    fn gather(&mut self, params: &[DVec2], weights: &[f64]) -> Result<(), FitError> {
        if weights.len() != params.len() {
            return Err(FitError::Length { what: "weights", given: weights.len(), needed: params.len() });
        }
        let grid = self.grid();
        let mut data = Vec::with_capacity(params.len());
        for (index, (&at, &weight)) in params.iter().zip(weights).enumerate() {
            if !at.is_finite() {
                return Err(FitError::NotFinite { what: "parameter", index });
            }
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(FitError::NotFinite { what: "weight", index });
            }
            if !self.cells.covers(at) {
                return Err(FitError::Inactive { index, at });
            }
            let (cell, t) = grid.locate(at);
            let (u, v) = (basis(t.x).map(|b| b[0]), basis(t.y).map(|b| b[0]));
            data.push(Datum { index, cell, weight, u, v });
        }
        // By position inside the cell, not by index: the sums do not depend on the order of the vertices.
        data.sort_by(|a, b| {
            let key = |d: &Datum| (d.cell, d.u[0], d.v[0], d.weight);
            let (a, b) = (key(a), key(b));
            (a.0.cmp(&b.0)).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)).then(a.3.total_cmp(&b.3))
        });
        let mut g = Stencil::zero(self.unknowns());
        for group in data.chunk_by(|a, b| a.cell == b.cell) {
            let mut block = [[0.0; 16]; 16];
            for d in group {
                let b: [f64; 16] = std::array::from_fn(|k| d.u[k / 4] * d.v[k % 4]);
                for r in 0..16 {
                    let wb = d.weight * b[r];
                    for c in r..16 {
                        block[r][c] += wb * b[c];
                    }
                }
            }
            g.add(self.pattern.rows(group[0].cell), &block);
        }
        (self.data, self.points, self.g) = (data, params.len(), g);
        Ok(())
    }

    /// `Aᵀ W (x − A c) − κ E c`, from the points rather than from `G`.
    fn gradient(&self, points: &[DVec3], kappa: f64, c: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut r = vec![[0.0; 3]; c.len()];
        for d in &self.data {
            let rows = self.pattern.rows(d.cell);
            let mut f = points[d.index].to_array();
            for a in 0..4 {
                for b in 0..4 {
                    let (w, c) = (d.u[a] * d.v[b], &c[rows[a] + b]);
                    (0..3).for_each(|k| f[k] -= w * c[k]);
                }
            }
            for a in 0..4 {
                for b in 0..4 {
                    let w = d.weight * d.u[a] * d.v[b];
                    let r = &mut r[rows[a] + b];
                    (0..3).for_each(|k| r[k] += w * f[k]);
                }
            }
        }
        self.e.subtract_product(&self.pattern, kappa, c, &mut r);
        r
    }

    fn back_substitute(&self, factor: &Factor, r: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, FitError> {
        let n = r.len();
        let mut columns = vec![0.0; 3 * n];
        for (i, r) in r.iter().enumerate() {
            (0..3).for_each(|d| columns[d * n + i] = r[d] * factor.scale[i]);
        }
        self.symbolic
            .solve(&factor.values, &mut columns, 3)
            .map_err(|_| FitError::Memory { coefficients: n })?;
        Ok((0..n).map(|i| [0, 1, 2].map(|d| columns[d * n + i] * factor.scale[i])).collect())
    }

    /// From the unknowns to the whole net: breadth first from the active coefficients, in net order.
    fn spread(&self, c: &[[f64; 3]]) -> Vec<DVec3> {
        let [p, q] = self.pattern.count();
        let mut net = vec![None; p * q];
        let mut queue: VecDeque<usize> = self.pattern.net().iter().copied().collect();
        for (&k, &c) in self.pattern.net().iter().zip(c) {
            net[k] = Some(DVec3::from_array(c));
        }
        while let Some(k) = queue.pop_front() {
            let (i, j) = (k / q, k % q);
            let near = [
                (i > 0).then(|| k - q),
                (i + 1 < p).then(|| k + q),
                (j > 0).then(|| k - 1),
                (j + 1 < q).then(|| k + 1),
            ];
            for n in near.into_iter().flatten() {
                if net[n].is_none() {
                    net[n] = net[k];
                    queue.push_back(n);
                }
            }
        }
        net.into_iter().map(Option::unwrap_or_default).collect()
    }

    fn check_points(&self, points: &[DVec3]) -> Result<(), FitError> {
        if points.len() != self.points {
            return Err(FitError::Length { what: "points", given: points.len(), needed: self.points });
        }
        match points.iter().position(|x| !x.is_finite()) {
            Some(index) => Err(FitError::NotFinite { what: "point", index }),
            None => Ok(()),
        }
    }
}

/// One net for one λ with the energy over the whole rectangle: the plain textbook problem, for comparison with other programs.
/// For several λ or several sets of points build a [`System`].
///
/// # Errors
/// Those of [`System::new`], [`System::factor`] and [`System::solve`].
pub fn solve(
    grid: Grid,
    params: &[DVec2],
    points: &[DVec3],
    weights: &[f64],
    lambda: f64,
    area: f64,
    order: EnergyOrder,
) -> Result<Vec<DVec3>, FitError> {
    let system = System::new(Cells::all(grid), params, weights, area, order)?;
    system.solve(&system.factor(lambda)?, points)
}

/// Middle of the bounding box and a power of two near the size: exact to divide by, independent of the points' order.
pub(crate) fn local(points: &[DVec3]) -> (DVec3, f64) {
    let Some(&first) = points.first() else { return (DVec3::ZERO, 1.0) };
    let (low, high) = points.iter().fold((first, first), |(l, h), &x| (l.min(x), h.max(x)));
    let size = (high - low).max_element();
    let scale = size.log2().floor().exp2();
    (low + (high - low) * 0.5, if scale > 0.0 && scale.is_finite() { scale } else { 1.0 })
}
