//! What the residuals at a solution say: standardised residuals, redundancies, suspicious readings.
//!
//! For a whitened row `r` with the fitted part's variance `h`, the redundancy is `1 - h`: the share of an
//! error in that reading that shows in its residual (Baarda 1968). `r / sqrt(1 - h)` is standard
//! normal if model and noise are right. The redundancies of all rows and priors sum to the degrees of
//! freedom.

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

use super::evaluated::Evaluated;
use super::evaluator::{Elimination, Evaluator, Layout};
use super::home::HomeRow;
use super::observation::{Observation, ObservationKind};
use super::problem::Problem;
use super::solution::Solution;
use super::system::{Priors, System};
use crate::real::{Kernel, Lanes, Packet};

/// Residuals of all readings at a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Every reading that was made and every equilibrium equation, in the order of the rows.
    pub observations: Vec<Observation>,
    /// Estimated error of each tension reading (N): row, cable, value.
    pub tension_errors_n: Vec<(usize, usize, f64)>,
    /// Redundancy of the prior of each parameter.
    pub prior_redundancies: Vec<Option<f64>>,
}

impl Analysis {
    /// Analyses the residuals of `problem` at `solution`.
    #[must_use]
    pub fn new(problem: &Problem<'_>, solution: &Solution) -> Self {
        Arch::new().dispatch(Dispatch { problem, solution })
    }

    /// Root mean square residual of the readings that `pick` accepts (SI units).
    #[must_use]
    pub fn rms(&self, pick: impl Fn(ObservationKind) -> bool) -> Option<f64> {
        rms(self
            .observations
            .iter()
            .filter(|r| pick(r.kind))
            .map(Observation::residual))
    }

    /// Root mean square of the estimated errors of the tension readings (N).
    #[must_use]
    pub fn tension_rms_n(&self) -> Option<f64> {
        rms(self.tension_errors_n.iter().map(|(_, _, error)| *error))
    }

    /// Readings whose normalised residual is improbable, the worst first: two-sided, at level
    /// `alpha` for all readings together (Bonferroni).
    #[must_use]
    pub fn suspects(&self, alpha: f64) -> Vec<Observation> {
        let level = alpha / self.observations.len().max(1) as f64;
        let size = |r: &Observation| r.normalised().map_or(0.0, f64::abs);
        let mut suspects: Vec<Observation> = self
            .observations
            .iter()
            .filter(|r| crate::statistics::normal_two_sided(size(r)) < level)
            .copied()
            .collect();
        suspects.sort_by(|a, b| size(b).total_cmp(&size(a)));
        suspects
    }
}

fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_usize, 0.0), |(n, s), v| (n + 1, s + v * v));
    (count > 0).then(|| (sum / count as f64).sqrt())
}

struct Dispatch<'a> {
    problem: &'a Problem<'a>,
    solution: &'a Solution,
}

impl WithSimd for Dispatch<'_> {
    type Output = Analysis;
    fn with_simd<S: Simd>(self, simd: S) -> Analysis {
        analyse::<Lanes<S>>(simd, self.problem, self.solution)
    }
}

fn analyse<T: Packet>(token: T::Token, problem: &Problem<'_>, solution: &Solution) -> Analysis {
    let mut at = Evaluated::<T>::at(token, problem, solution);
    let own = covariance_at(&mut at, problem, solution);
    let covariance = own.as_ref();
    let observations = match &mut at.home_evaluator {
        Some((row, evaluator)) => home_observations(evaluator, problem, covariance, &at.home, *row),
        None => Vec::new(),
    };
    let mut collector = Collector {
        problem,
        covariance: covariance.map(|c| at.map.column_covariance(&at.home, c)),
        observations,
        tension_errors_n: Vec::new(),
    };
    T::run(
        token,
        AnalysePoses {
            evaluator: &mut at.poses,
            collector: &mut collector,
            token,
        },
    );
    Analysis {
        observations: collector.observations,
        tension_errors_n: collector.tension_errors_n,
        prior_redundancies: prior_redundancies(problem, solution, covariance),
    }
}

/// Covariance of the parameters with the equations linearised at the solution itself; that of the
/// solution belongs to the state before the last step.
fn covariance_at<T: Packet>(
    at: &mut Evaluated<'_, T>,
    problem: &Problem<'_>,
    solution: &Solution,
) -> Option<DMatrix<f64>> {
    solution.covariance.as_ref()?;
    // Twice: the first pass finds the tensions at which the equilibrium is linearised.
    at.poses.assemble(None, None, 0.0);
    at.poses.assemble(None, None, 0.0);
    let priors = Priors::evaluate(problem, &solution.globals, &solution.parameters);
    System::build(&at.poses.sums, &at.map, &at.home, &priors).covariance()
}

/// Standard deviation of a reading; `length_weight` is the whitening factor of its length row.
pub(super) fn sd_of(
    problem: &Problem<'_>,
    kind: ObservationKind,
    row: usize,
    length_weight: f64,
) -> f64 {
    let robot = &problem.dataset.robot;
    match kind {
        ObservationKind::Length(_) => length_weight.recip(),
        ObservationKind::Equilibrium(_) => 1.0,
        ObservationKind::Laser => robot.laser.map_or(f64::NAN, |l| l.sd_m),
        ObservationKind::Swivel(cable) => {
            robot.cables[cable].pulley.swivel_sd_rad.unwrap_or(f64::NAN)
        }
        ObservationKind::TrackerPosition(k) => {
            let own = problem.dataset.measurements.tracked_position_sd_m.get(row);
            let nominal = robot
                .tracker
                .map_or(f64::NAN, |t| t.position_sd_m.each()[k]);
            own.map(|sd| sd[k])
                .filter(|sd| !sd.is_nan())
                .unwrap_or(nominal)
        }
        ObservationKind::TrackerOrientation(_) => robot
            .tracker
            .and_then(|t| t.orientation_sd_rad)
            .unwrap_or(f64::NAN),
        ObservationKind::Inclination(_) => robot.inclinometer.map_or(f64::NAN, |i| i.sd_rad),
    }
}

fn home_observations(
    evaluator: &mut Evaluator<'_, f64>,
    problem: &Problem<'_>,
    covariance: Option<&DMatrix<f64>>,
    home: &HomeRow,
    row: usize,
) -> Vec<Observation> {
    let layout = evaluator.layout.clone();
    let present = evaluator.equations_at(0).present.clone();
    let n = covariance.map_or(0, DMatrix::nrows);
    let measured = (layout.cables..layout.rows).filter(|r| present[*r] > 0.0);
    measured
        .map(|r| {
            let index = r - layout.cables;
            let kind = layout.kinds[r];
            let gradient = DVector::from_column_slice(&home.gradients[index * n..(index + 1) * n]);
            let fitted = |c: &DMatrix<f64>| gradient.dot(&(c * &gradient));
            Observation {
                row,
                kind,
                standardised: home.residuals[index],
                sd: sd_of(problem, kind, row, 1.0),
                redundancy: covariance.map(|c| 1.0 - fitted(c)),
            }
        })
        .collect()
}

fn prior_redundancies(
    problem: &Problem<'_>,
    solution: &Solution,
    covariance: Option<&DMatrix<f64>>,
) -> Vec<Option<f64>> {
    let priors = Priors::evaluate(problem, &solution.globals, &solution.parameters);
    let n = solution.parameters.len();
    let mut rows = vec![DVector::zeros(n); n];
    for (row, column, value) in &priors.derivatives {
        rows[*row][*column] = *value;
    }
    let redundancy = |k: usize| {
        solution.parameters[k].prior_sd?;
        let covariance = covariance?;
        Some(1.0 - rows[k].dot(&(covariance * &rows[k])))
    };
    (0..n).map(redundancy).collect()
}

struct Collector<'a> {
    problem: &'a Problem<'a>,
    covariance: Option<DMatrix<f64>>,
    observations: Vec<Observation>,
    tension_errors_n: Vec<(usize, usize, f64)>,
}

struct AnalysePoses<'e, 'a, T: Packet> {
    evaluator: &'e mut Evaluator<'a, T>,
    collector: &'e mut Collector<'a>,
    token: T::Token,
}

impl<T: Packet> Kernel for AnalysePoses<'_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(mut self) {
        let layout = self.evaluator.layout.clone();
        let zero = T::splat(self.token, 0.0);
        let mut elimination = Elimination::new(&layout, zero);
        let mut fitted = vec![zero; layout.rows];
        let mut tension = vec![zero; layout.cables];
        for batch in 0..self.evaluator.batches() {
            // Twice: the first time finds the tensions at which the second linearises.
            self.evaluator.equations_at(batch);
            let equations = self.evaluator.equations_at(batch);
            elimination.eliminate(equations, &layout, 0.0);
            for row in 0..layout.rows {
                let y = elimination.half_solve(equations.by_pose[row]);
                fitted[row] = crate::real::square_norm(y);
                if let Some(covariance) = &self.collector.covariance {
                    let gradient = elimination.remaining_gradient(equations, &layout, row, y);
                    fitted[row] = fitted[row] + quadratic_form(covariance, &gradient);
                }
            }
            for cable in 0..layout.cables {
                tension[cable] = self.evaluator.tension_error(batch, cable);
            }
            self.collect(batch, &layout, &fitted, &tension);
        }
    }
}

/// `g^T C g`.
#[inline(always)]
fn quadratic_form<T: Packet>(covariance: &DMatrix<f64>, gradient: &[T]) -> T {
    let zero = gradient[0].lift(0.0);
    let mut sum = zero;
    for (g, column) in gradient.iter().zip(covariance.column_iter()) {
        let mut inner = zero;
        for (h, c) in gradient.iter().zip(&column) {
            inner = h.mul_add(zero.lift(*c), inner);
        }
        sum = g.mul_add(inner, sum);
    }
    sum
}

impl<T: Packet> AnalysePoses<'_, '_, T> {
    fn collect(&mut self, batch: usize, layout: &Layout, fitted: &[T], tension: &[T]) {
        let lanes = |value: T| {
            let mut values = vec![0.0; T::LANES];
            value.store(&mut values, 0);
            values
        };
        let first = batch * T::LANES;
        let rows: Vec<usize> = self
            .evaluator
            .rows()
            .iter()
            .skip(first)
            .take(T::LANES)
            .copied()
            .collect();
        let equations = self.evaluator.equations();
        let residual: Vec<_> = equations.residual.iter().map(|v| lanes(*v)).collect();
        let present: Vec<_> = equations.present.iter().map(|v| lanes(*v)).collect();
        let weights: Vec<_> = equations
            .length_by_cable
            .iter()
            .map(|g| lanes(g[3]))
            .collect();
        let fitted: Vec<_> = fitted.iter().map(|v| lanes(*v)).collect();
        let tension: Vec<_> = tension.iter().map(|v| lanes(*v)).collect();
        let known = self.collector.covariance.is_some();
        for (lane, row) in rows.iter().enumerate() {
            for k in (0..layout.rows).filter(|k| present[*k][lane] > 0.0) {
                let kind = layout.kinds[k];
                let weight = weights.get(k).map_or(1.0, |w| -w[lane]);
                self.collector.observations.push(Observation {
                    row: *row,
                    kind,
                    standardised: residual[k][lane],
                    sd: sd_of(self.collector.problem, kind, *row, weight),
                    redundancy: known.then(|| 1.0 - fitted[k][lane]),
                });
            }
            let latent = self.collector.problem.has_latent_tension();
            let forces = &self.collector.problem.dataset.measurements.force_n;
            let read = |cable: usize| latent && !forces.get(*row, cable).is_nan();
            for (cable, errors) in tension.iter().enumerate().filter(|(k, _)| read(*k)) {
                self.collector
                    .tension_errors_n
                    .push((*row, cable, errors[lane]));
            }
        }
    }
}
