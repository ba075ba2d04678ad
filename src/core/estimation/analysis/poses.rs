//! The readings of all fitted poses, a packet of poses at a time.

use nalgebra::DMatrix;

use super::{Collector, NEVER_SUSPECT};
use crate::estimation::evaluated::{is_tension_read, sd_of};
use crate::estimation::evaluator::{Elimination, Equations, Evaluator, Layout, NoiseEstimate};
use crate::estimation::observation::{EntryPointSensitivity, Observation, ObservationKind};
use crate::real::{Kernel, Packet};

pub(super) struct AnalysePoses<'e, 'a, 'c, T: Packet> {
    pub evaluator: &'e mut Evaluator<'a, T>,
    pub collector: &'e mut Collector<'c>,
    pub token: T::Token,
}

impl<T: Packet> Kernel for AnalysePoses<'_, '_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(mut self) {
        let layout = self.evaluator.layout.clone();
        let zero = T::splat(self.token, 0.0);
        let mut elimination = Elimination::new(&layout, zero);
        let mut rows = Rows::new(&layout, self.collector.covariance.is_some(), zero);
        let mut sum = RowSum::new(&layout, zero);
        let mut found = Vec::new();
        for batch in 0..self.evaluator.batches() {
            if self.collector.covariance.is_none() {
                // This pass finds the tensions at which the next one linearises, unless the covariance has already found them.
                self.evaluator.equations_at(batch);
            }
            let equations = self.evaluator.equations_at(batch);
            elimination.eliminate(equations, &layout, 0.0);
            rows.fill(equations, &elimination, &layout);
            let estimates = self.evaluator.noise_estimates();
            found.clear();
            for one in &estimates {
                sum.clear(zero);
                sum.add_estimate(&rows, one, &layout);
                found.push(sum.reading(self.collector, &layout));
            }
            self.collect(batch, &estimates, &found);
        }
    }
}

/// The rows of a packet of poses.
struct Rows<T> {
    residual: Vec<T>,
    /// Derivative with respect to the pose, multiplied by the inverse Cholesky factor of its information.
    by_pose: Vec<[T; 6]>,
    /// Derivative with respect to the columns (pose re-estimated), row by row; empty if these have no covariance.
    by_column: Vec<T>,
}

impl<T: Packet> Rows<T> {
    fn new(layout: &Layout, has_covariance: bool, zero: T) -> Self {
        let rows = if has_covariance { layout.rows } else { 0 };
        Self {
            residual: vec![zero; layout.rows],
            by_pose: vec![[zero; 6]; layout.rows],
            by_column: vec![zero; rows * layout.columns],
        }
    }

    #[inline(always)]
    fn fill(&mut self, equations: &Equations<T>, elimination: &Elimination<T>, layout: &Layout) {
        self.residual.copy_from_slice(&equations.residual);
        for row in 0..layout.rows {
            self.by_pose[row] = elimination.half_solve(equations.by_pose[row]);
        }
        let gradients = self.by_column.chunks_exact_mut(layout.columns);
        for (row, gradient) in gradients.enumerate() {
            elimination.remaining_gradient(equations, layout, row, self.by_pose[row], gradient);
        }
    }
}

/// A linear combination of the rows.
struct RowSum<T> {
    standardised: T,
    /// Sum of its squared coefficients.
    square: T,
    by_pose: [T; 6],
    gradient: Vec<T>,
}

/// A reading of a packet of poses.
struct Reading<T> {
    standardised: T,
    redundancy: T,
    /// The cable whose entry point an error of the reading moves most.
    pulled: T,
    /// Squared displacement of that entry point by an error of one standard deviation (m^2).
    pull_squared: T,
}

impl<T: Packet> RowSum<T> {
    fn new(layout: &Layout, zero: T) -> Self {
        Self {
            standardised: zero,
            square: zero,
            by_pose: [zero; 6],
            gradient: vec![zero; layout.columns],
        }
    }

    #[inline(always)]
    fn clear(&mut self, zero: T) {
        self.standardised = zero;
        self.square = zero;
        self.by_pose = [zero; 6];
        self.gradient.fill(zero);
    }

    #[inline(always)]
    fn add(&mut self, rows: &Rows<T>, row: usize, factor: T) {
        self.standardised = factor.mul_add(rows.residual[row], self.standardised);
        self.square = factor.mul_add(factor, self.square);
        for (sum, y) in self.by_pose.iter_mut().zip(&rows.by_pose[row]) {
            *sum = factor.mul_add(*y, *sum);
        }
        let columns = self.gradient.len();
        if let Some(by_column) = rows.by_column.get(row * columns..(row + 1) * columns) {
            for (sum, g) in self.gradient.iter_mut().zip(by_column) {
                *sum = factor.mul_add(*g, *sum);
            }
        }
    }

    #[inline(always)]
    fn add_estimate(&mut self, rows: &Rows<T>, estimate: &NoiseEstimate<T>, layout: &Layout) {
        let kind = estimate.kind;
        if !matches!(kind, ObservationKind::Equilibrium(_)) {
            self.add(rows, estimate.row, estimate.own);
        }
        let is_shared = matches!(
            kind,
            ObservationKind::Equilibrium(_)
                | ObservationKind::Length(_)
                | ObservationKind::Tension(_)
        );
        if let Some(first) = layout.equilibrium.filter(|_| is_shared) {
            for (k, factor) in estimate.balance.iter().enumerate() {
                self.add(rows, first + k, *factor);
            }
        }
    }

    #[inline(always)]
    fn reading(&self, collector: &Collector<'_>, layout: &Layout) -> Reading<T> {
        let zero = self.standardised.lift(0.0);
        let mut reading = Reading {
            standardised: self.standardised,
            redundancy: self.square - crate::real::square_norm(self.by_pose),
            pulled: zero,
            pull_squared: zero,
        };
        if let Some(covariance) = collector.covariance {
            reading.redundancy = reading.redundancy - self.variance(covariance);
            if collector.keeps_all || reading.may_be_suspect() {
                self.pull(covariance, layout, &mut reading);
            }
        }
        reading
    }

    /// `g^T C g`: the part of the variance that the common parameters take.
    #[inline(always)]
    fn variance(&self, covariance: &DMatrix<f64>) -> T {
        let zero = self.standardised.lift(0.0);
        let mut variance = zero;
        for (k, column) in covariance.column_iter().enumerate() {
            // The matrix is symmetric: the sum over the lower triangle is doubled, with half the diagonal.
            let mut inner = self.gradient[k] * zero.lift(0.5 * column[k]);
            for (g, c) in self.gradient[..k].iter().zip(&column) {
                inner = g.mul_add(zero.lift(*c), inner);
            }
            variance = self.gradient[k].mul_add(inner, variance);
        }
        variance + variance
    }

    /// Entries of `C g` for the entry points.
    #[inline(always)]
    fn pull(&self, covariance: &DMatrix<f64>, layout: &Layout, reading: &mut Reading<T>) {
        let zero = self.standardised.lift(0.0);
        for cable in 0..layout.cables {
            let mut square = zero;
            for axis in 0..3 {
                let column = covariance.column(layout.cable_column(cable) + axis);
                let mut moved = zero;
                for (g, c) in self.gradient.iter().zip(&column) {
                    moved = g.mul_add(zero.lift(*c), moved);
                }
                square = moved.mul_add(moved, square);
            }
            let more = square - reading.pull_squared;
            reading.pulled = more.select_positive(zero.lift(cable as f64), reading.pulled);
            reading.pull_squared = more.select_positive(square, reading.pull_squared);
        }
    }
}

impl<T: Packet> Reading<T> {
    /// Whether the normalised residual of any pose is large enough to be suspect.
    #[inline(always)]
    fn may_be_suspect(&self) -> bool {
        let zero = self.standardised.lift(0.0);
        let limit = zero.lift(NEVER_SUSPECT * NEVER_SUSPECT) * self.redundancy;
        let beyond = self.standardised * self.standardised - limit;
        beyond.select_positive(zero.lift(1.0), zero).sum() > 0.0
    }
}

/// The values of each lane.
fn lanes<T: Packet>(values: impl ExactSizeIterator<Item = T>) -> Vec<f64> {
    let mut lanes = vec![0.0; values.len() * T::LANES];
    for (k, value) in values.enumerate() {
        value.store(&mut lanes, k);
    }
    lanes
}

impl<T: Packet> AnalysePoses<'_, '_, '_, T> {
    fn collect(&mut self, batch: usize, estimates: &[NoiseEstimate<T>], found: &[Reading<T>]) {
        let present = lanes(self.evaluator.equations().present.iter().copied());
        let standardised = lanes(found.iter().map(|one| one.standardised));
        let redundancy = lanes(found.iter().map(|one| one.redundancy));
        let pulled = lanes(found.iter().map(|one| one.pulled));
        let pull_squared = lanes(found.iter().map(|one| one.pull_squared));
        let collector = &mut *self.collector;
        let problem = collector.problem;
        let known = collector.covariance.is_some();
        let rows = self.evaluator.rows().iter();
        for (lane, row) in rows.skip(batch * T::LANES).take(T::LANES).enumerate() {
            if collector.is_connected(*row) {
                continue;
            }
            for (index, one) in estimates.iter().enumerate() {
                let at = |k: usize| k * T::LANES + lane;
                let is_read = match one.kind {
                    ObservationKind::Tension(cable) => {
                        is_tension_read(problem, self.evaluator, (*row, cable))
                    }
                    _ => present[at(one.row)] > 0.0,
                };
                if !is_read {
                    continue;
                }
                let square = pull_squared[at(index)];
                collector.add(Observation {
                    row: *row,
                    kind: one.kind,
                    standardised: standardised[at(index)],
                    sd: sd_of(problem, self.evaluator, one.kind, *row),
                    redundancy: known.then(|| redundancy[at(index)]),
                    pull: (known && square > 0.0).then(|| EntryPointSensitivity {
                        cable: pulled[at(index)] as usize,
                        per_sd_m: square.sqrt(),
                    }),
                });
            }
        }
    }
}
