//! The readings of all fitted poses, a packet of poses at a time.

use nalgebra::DMatrix;

use super::{Collector, is_tension_read, sd_of};
use crate::estimation::evaluator::{CABLE_COLUMNS, Elimination, Evaluator, Layout, NoiseEstimate};
use crate::estimation::observation::{Observation, ObservationKind, Pull};
use crate::real::{Kernel, Packet};

pub(super) struct AnalysePoses<'e, 'a, T: Packet> {
    pub evaluator: &'e mut Evaluator<'a, T>,
    pub collector: &'e mut Collector<'a>,
    pub token: T::Token,
}

impl<T: Packet> Kernel for AnalysePoses<'_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(mut self) {
        let layout = self.evaluator.layout.clone();
        let zero = T::splat(self.token, 0.0);
        let mut elimination = Elimination::new(&layout, zero);
        let mut found = Vec::new();
        for batch in 0..self.evaluator.batches() {
            // Twice: the first time finds the tensions at which the second linearises.
            self.evaluator.equations_at(batch);
            let equations = self.evaluator.equations_at(batch);
            elimination.eliminate(equations, &layout, 0.0);
            let mut rows = Rows {
                residual: equations.residual.clone(),
                by_pose: Vec::with_capacity(layout.rows),
                by_column: Vec::new(),
            };
            for row in 0..layout.rows {
                let y = elimination.half_solve(equations.by_pose[row]);
                rows.by_pose.push(y);
                if self.collector.covariance.is_some() {
                    let gradient = elimination.remaining_gradient(equations, &layout, row, y);
                    rows.by_column.push(gradient);
                }
            }
            let estimates = self.evaluator.noise_estimates();
            found.clear();
            for one in &estimates {
                let covariance = self.collector.covariance.as_ref();
                found.push(rows.reading(one, &layout, covariance, zero));
            }
            self.collect(batch, &estimates, &found);
        }
    }
}

/// The rows of a packet of poses.
struct Rows<T> {
    residual: Vec<T>,
    /// Derivative with respect to the pose, over the Cholesky factor of its information.
    by_pose: Vec<[T; 6]>,
    /// Derivative with respect to the columns, the pose following; empty where these have no covariance.
    by_column: Vec<Vec<T>>,
}

/// A reading of a packet of poses.
struct Reading<T> {
    standardised: T,
    redundancy: T,
    /// The cable whose entry point an error of the reading moves most.
    pulled: T,
    /// By how much one of a standard deviation moves it, squared (m^2).
    pull_squared: T,
}

impl<T: Packet> Rows<T> {
    #[inline(always)]
    fn reading(
        &self,
        estimate: &NoiseEstimate<T>,
        layout: &Layout,
        covariance: Option<&DMatrix<f64>>,
        zero: T,
    ) -> Reading<T> {
        let mut standardised = zero;
        let mut redundancy = zero;
        let mut by_pose = [zero; 6];
        let mut gradient = vec![zero; layout.columns];
        let mut add = |row: usize, factor: T| {
            standardised = factor.mul_add(self.residual[row], standardised);
            redundancy = factor.mul_add(factor, redundancy);
            for (sum, y) in by_pose.iter_mut().zip(self.by_pose[row]) {
                *sum = factor.mul_add(y, *sum);
            }
            if let Some(by_column) = self.by_column.get(row) {
                for (sum, g) in gradient.iter_mut().zip(by_column) {
                    *sum = factor.mul_add(*g, *sum);
                }
            }
        };
        let kind = estimate.kind;
        if !matches!(kind, ObservationKind::Equilibrium(_)) {
            add(estimate.row, estimate.own);
        }
        let is_shared = matches!(
            kind,
            ObservationKind::Equilibrium(_)
                | ObservationKind::Length(_)
                | ObservationKind::Tension(_)
        );
        if let Some(first) = layout.equilibrium.filter(|_| is_shared) {
            for (k, factor) in estimate.balance.into_iter().enumerate() {
                add(first + k, factor);
            }
        }
        let mut reading = Reading {
            standardised,
            redundancy: redundancy - crate::real::square_norm(by_pose),
            pulled: zero,
            pull_squared: zero,
        };
        if let Some(covariance) = covariance {
            reading.follow(covariance, &gradient, layout);
        }
        reading
    }
}

impl<T: Packet> Reading<T> {
    /// The common parameters follow an error of the reading: `C g` and `g^T C g`.
    #[inline(always)]
    fn follow(&mut self, covariance: &DMatrix<f64>, gradient: &[T], layout: &Layout) {
        let zero = gradient[0].lift(0.0);
        let mut moved = Vec::with_capacity(gradient.len());
        for (g, column) in gradient.iter().zip(covariance.column_iter()) {
            let mut inner = zero;
            for (h, c) in gradient.iter().zip(&column) {
                inner = h.mul_add(zero.lift(*c), inner);
            }
            self.redundancy = self.redundancy - *g * inner;
            moved.push(inner);
        }
        for (cable, moved) in moved[..CABLE_COLUMNS * layout.cables]
            .chunks_exact(CABLE_COLUMNS)
            .enumerate()
        {
            let mut square = zero;
            for d in &moved[..3] {
                square = d.mul_add(*d, square);
            }
            let more = square - self.pull_squared;
            self.pulled = more.select_positive(zero.lift(cable as f64), self.pulled);
            self.pull_squared = more.select_positive(square, self.pull_squared);
        }
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

impl<T: Packet> AnalysePoses<'_, '_, T> {
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
                    pull: (known && square > 0.0).then(|| Pull {
                        cable: pulled[at(index)] as usize,
                        per_sd_m: square.sqrt(),
                    }),
                });
            }
        }
    }
}
