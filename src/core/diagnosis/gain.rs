//! Cross-validation: the gain of a cause on held-out poses, and the change of the platform's positions.
//!
//! Each pose is left out in turn. With the orthonormal basis `V` of the estimated parameters and the rows `j` of the
//! pose, the residual that the fit to all other poses predicts is `e_j = (1 - V_j V_j^T)^-1 r_j` (Cook and Weisberg 1982,
//! linear at the solution), and leaving the pose out moves the coordinates in the basis by `V_j^T e_j`. Only the pose of the
//! platform is fitted to the held-out readings.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::budget::{BOOTSTRAP_SEED, RESAMPLES};
use super::fit::Fit;
use super::projector::Projector;
use super::report::{Gain, KindGain, PositionChange, Quantity};
use crate::effect::Search;
use crate::estimation::{Linearisation, RowKind};
use crate::statistics::normal_quantile;

/// Prediction of one held-out pose.
#[derive(Debug, Clone)]
struct HeldOut {
    row: usize,
    /// Sum of squares, and its expectation from noise alone.
    chi2: f64,
    freedom: f64,
    /// Sum of squares and expectation for each kind of reading.
    kinds: Vec<(Quantity, f64, f64)>,
    /// Change of the estimate, in coordinates of the basis, when this pose is left out.
    step: DVector<f64>,
}

impl HeldOut {
    /// Sum of squares of one kind of reading, and its expectation from noise alone.
    fn of_kind(&self, quantity: Quantity) -> (f64, f64) {
        let kind = self.kinds.iter().find(|(q, ..)| *q == quantity);
        kind.map_or((0.0, 0.0), |(_, squares, freedom)| (*squares, *freedom))
    }
}

/// Predictions of all held-out poses by one model.
#[derive(Debug, Clone)]
pub(super) struct Prediction {
    held_out: Vec<HeldOut>,
    linear: Rc<Linearisation>,
    projector: Projector,
    /// Positions of the fitted poses by row (m).
    positions: Vec<(usize, Vector3<f64>)>,
    /// Rows at which an event of the model acts alone, so that no other pose can predict them.
    events: Vec<usize>,
}

impl Prediction {
    pub fn new(fit: &Fit<'_>) -> Self {
        let linear = fit.linearisation();
        let projector = Projector::new(&linear.design, &linear.residual);
        let held_out = (0..linear.poses.len())
            .map(|pose| hold_out(&linear, &projector, pose))
            .collect();
        let poses = fit.solution.poses.iter();
        Self {
            held_out,
            linear,
            projector,
            positions: poses.map(|(row, pose)| (*row, pose.position)).collect(),
            events: rows_of_events(fit),
        }
    }

    /// Root mean square of the held-out residuals, in standard deviations.
    pub fn rms(&self) -> f64 {
        rms(self.held_out.iter().map(|pose| (pose.chi2, pose.freedom)))
    }

    /// Pairs of predictions by both models, without the poses at which an event acts alone.
    fn pairs<'p>(&'p self, before: &'p Self) -> Vec<(&'p HeldOut, &'p HeldOut)> {
        let skipped = |row: usize| self.events.contains(&row) || before.events.contains(&row);
        let both = before.held_out.iter().zip(&self.held_out);
        both.filter(|(one, _)| !skipped(one.row)).collect()
    }

    /// Gain of this fit over `before`.
    pub fn gain_over(&self, before: &Self) -> Gain {
        let pairs = self.pairs(before);
        let was = rms(pairs.iter().map(|(b, _)| (b.chi2, b.freedom)));
        let is = rms(pairs.iter().map(|(_, a)| (a.chi2, a.freedom)));
        Gain {
            before: was,
            after: is,
            interval: resampled(&pairs),
            poses_held_out: pairs.len(),
            kinds: kinds(&pairs),
            position: self.position_change(before),
        }
    }

    /// Distance of the fitted positions from those of another fit.
    fn position_change(&self, before: &Self) -> PositionChange {
        let position = |positions: &[(usize, Vector3<f64>)], row: usize| {
            let entry = positions.iter().find(|(k, _)| *k == row);
            entry.map_or_else(Vector3::zeros, |(_, position)| *position)
        };
        let poses = self.held_out.iter().map(|pose| pose.row);
        let differences =
            poses.map(|row| position(&self.positions, row) - position(&before.positions, row));
        let differences: Vec<Vector3<f64>> = differences.collect();
        let count = differences.len().max(1) as f64;
        let mean_square: f64 = differences.iter().map(Vector3::norm_squared).sum();
        let value = (mean_square / count).sqrt();
        let largest_m = differences.iter().map(Vector3::norm).fold(0.0, f64::max);
        // Jackknife: the same with each pose left out of both fits, which is a column.
        let mut moved = self.moved_positions() - before.moved_positions();
        let differences: Vec<f64> = differences.iter().flatten().copied().collect();
        let differences = DVector::from_vec(differences);
        let values: Vec<f64> = moved
            .column_iter_mut()
            .map(|mut column| {
                column += &differences;
                column.norm() / count.sqrt()
            })
            .collect();
        let n = values.len().max(2) as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let half = normal_quantile(0.975) * (squares * (n - 1.0) / n).sqrt();
        PositionChange {
            rms_m: value,
            interval_m: [(value - half).max(0.0), value + half],
            largest_m,
        }
    }

    /// Change of the fitted positions, three rows for each pose, when a pose is left out, one column for each.
    fn moved_positions(&self) -> DMatrix<f64> {
        let poses = &self.linear.poses;
        let mut maps = DMatrix::zeros(3 * poses.len(), self.projector.rank());
        for (pose, block) in poses.iter().enumerate() {
            let map = block.pose_by_parameter.fixed_rows::<3>(0) * self.projector.map();
            maps.rows_mut(3 * pose, 3).copy_from(&map);
        }
        let mut steps = DMatrix::zeros(self.projector.rank(), self.held_out.len());
        for (pose, held_out) in self.held_out.iter().enumerate() {
            steps.set_column(pose, &held_out.step);
        }
        maps * steps
    }
}

fn rows_of_events(fit: &Fit<'_>) -> Vec<usize> {
    let labels = &fit.problem.dataset.measurements.labels;
    let mut rows = Vec::new();
    for bound in &fit.problem.free_effects {
        if let Search::AtPose(pose) = bound.effect.search() {
            let label = bound.values[pose];
            rows.extend(labels.iter().position(|l| *l as f64 == label));
        }
    }
    rows
}

fn hold_out(linear: &Linearisation, projector: &Projector, pose: usize) -> HeldOut {
    let block = &linear.poses[pose];
    let (first, count) = (block.rows.start, block.rows.len());
    let basis = projector.basis().rows(first, count);
    let residual = projector.residual.rows(first, count);
    let remaining = DMatrix::identity(count, count) - basis * basis.transpose();
    // The matrix is singular only if this pose alone determines a parameter; then the pose cannot be predicted.
    let error = remaining.cholesky().map(|factor| factor.solve(&residual));
    let step = error.as_ref().map_or_else(
        || DVector::zeros(projector.rank()),
        |error| basis.tr_mul(error),
    );
    let error = error.unwrap_or_else(|| residual.into_owned());
    let redundancy: Vec<f64> = block
        .remainder
        .row_iter()
        .map(|row| row.norm_squared())
        .collect();
    let mut kinds: Vec<(Quantity, f64, f64)> = Vec::new();
    for (k, row) in linear.rows[block.rows.clone()].iter().enumerate() {
        let Some(quantity) = quantity_of(row.kind) else {
            continue;
        };
        let (square, freedom) = (error[k] * error[k], redundancy[k]);
        match kinds.iter_mut().find(|(q, ..)| *q == quantity) {
            Some((_, squares, freedoms)) => {
                *squares += square;
                *freedoms += freedom;
            }
            None => kinds.push((quantity, square, freedom)),
        }
    }
    HeldOut {
        row: block.row,
        chi2: error.norm_squared(),
        freedom: redundancy.iter().sum(),
        kinds,
        step,
    }
}

/// Kind of reading of a row; `None` for equilibrium equations and priors.
pub(super) fn quantity_of(kind: RowKind) -> Option<Quantity> {
    match kind {
        RowKind::Observation(kind) => Quantity::of(kind),
        RowKind::AssumedTension(_) | RowKind::Prior(_) => None,
    }
}

fn rms(terms: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (squares, freedom) = terms.fold((0.0, 0.0), |(s, f), (a, b)| (s + a, f + b));
    if freedom > 0.0 {
        (squares / freedom).sqrt()
    } else {
        f64::NAN
    }
}

fn kinds(pairs: &[(&HeldOut, &HeldOut)]) -> Vec<KindGain> {
    let gain = |quantity: Quantity| KindGain {
        quantity,
        before: rms(pairs.iter().map(|(before, _)| before.of_kind(quantity))),
        after: rms(pairs.iter().map(|(_, after)| after.of_kind(quantity))),
    };
    Quantity::ALL
        .into_iter()
        .map(gain)
        .filter(|gain| gain.before.is_finite())
        .collect()
}

/// Bootstrap 95 % interval of the difference of the root mean squares, resampling poses.
fn resampled(pairs: &[(&HeldOut, &HeldOut)]) -> [f64; 2] {
    if pairs.is_empty() {
        return [f64::NAN; 2];
    }
    let mut rng = ChaCha8Rng::seed_from_u64(BOOTSTRAP_SEED);
    let mut differences: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let mut sums = [(0.0, 0.0); 2];
            for _ in 0..pairs.len() {
                let (before, after) = pairs[rng.random_range(0..pairs.len())];
                for (sum, pose) in sums.iter_mut().zip([before, after]) {
                    sum.0 += pose.chi2;
                    sum.1 += pose.freedom;
                }
            }
            rms([sums[0]].into_iter()) - rms([sums[1]].into_iter())
        })
        .collect();
    differences.sort_by(f64::total_cmp);
    let quantile = |share: f64| differences[((RESAMPLES - 1) as f64 * share).round() as usize];
    [quantile(0.025), quantile(0.975)]
}
