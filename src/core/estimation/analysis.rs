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

/// Level for all readings together at which single readings are called suspect.
pub const SUSPECT_LEVEL: f64 = 0.01;
/// Normalised residuals of less are suspect at no number of readings: one alone at [`SUSPECT_LEVEL`] would need 2.58.
const NEVER_SUSPECT: f64 = 2.5;

/// Residuals of all readings at a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Every reading that was made and every equilibrium equation, in the order of the rows; none in a summary.
    pub observations: Vec<Observation>,
    /// Estimated error of each tension reading (N): row, cable, value; none in a summary.
    pub tension_errors_n: Vec<(usize, usize, f64)>,
    /// Redundancy of the prior of each parameter.
    pub prior_redundancies: Vec<Option<f64>>,
    sums: ResidualSums,
}

/// What is summed up over the readings.
#[derive(Debug, Clone, Default, PartialEq)]
struct ResidualSums {
    /// Number of readings and sum of squared residuals of each kind (SI units).
    kinds: Vec<(ObservationKind, usize, f64)>,
    /// The same of the estimated errors of the tension readings (N).
    tensions: (usize, f64),
    /// Readings so far.
    count: usize,
    /// Readings whose normalised residual is improbable.
    suspects: Vec<Observation>,
}

impl Analysis {
    /// Analyses the residuals of `problem` at `solution`.
    #[must_use]
    pub fn new(problem: &Problem<'_>, solution: &Solution) -> Self {
        Arch::new().dispatch(Dispatch {
            problem,
            solution,
            keeps_all: true,
        })
    }

    /// The same without the list of single readings, which takes most of the memory where poses are many.
    #[must_use]
    pub fn summary(problem: &Problem<'_>, solution: &Solution) -> Self {
        Arch::new().dispatch(Dispatch {
            problem,
            solution,
            keeps_all: false,
        })
    }

    /// Root mean square residual of the readings that `pick` accepts (SI units).
    #[must_use]
    pub fn rms(&self, pick: impl Fn(ObservationKind) -> bool) -> Option<f64> {
        let picked = self.sums.kinds.iter().filter(|(kind, ..)| pick(*kind));
        root_mean_square(picked.fold((0, 0.0), |(n, s), (_, count, square)| {
            (n + count, s + square)
        }))
    }

    /// Root mean square of the estimated errors of the tension readings (N).
    #[must_use]
    pub fn tension_rms_n(&self) -> Option<f64> {
        root_mean_square(self.sums.tensions)
    }

    /// Readings whose normalised residual is improbable, the worst first: two-sided, at a level of 1 % for all
    /// readings together (Bonferroni).
    #[must_use]
    pub fn suspects(&self) -> &[Observation] {
        &self.sums.suspects
    }
}

fn root_mean_square((count, square): (usize, f64)) -> Option<f64> {
    (count > 0).then(|| (square / count as f64).sqrt())
}

/// Size of a normalised residual, 0 where the reading is hardly controlled.
fn size(reading: &Observation) -> f64 {
    reading.normalised().map_or(0.0, f64::abs)
}

impl ResidualSums {
    fn add(&mut self, reading: &Observation) {
        let square = reading.residual().powi(2);
        match self
            .kinds
            .iter_mut()
            .find(|(kind, ..)| *kind == reading.kind)
        {
            Some((_, count, sum)) => {
                *count += 1;
                *sum += square;
            }
            None => self.kinds.push((reading.kind, 1, square)),
        }
        self.count += 1;
        // More readings only lower the level, so that nothing is missed.
        if size(reading) > NEVER_SUSPECT && self.is_suspect(reading) {
            self.suspects.push(*reading);
        }
    }

    fn add_tension(&mut self, error: f64) {
        self.tensions.0 += 1;
        self.tensions.1 += error * error;
    }

    fn is_suspect(&self, reading: &Observation) -> bool {
        let level = SUSPECT_LEVEL / self.count.max(1) as f64;
        crate::statistics::normal_two_sided(size(reading)) < level
    }

    /// All readings are in.
    fn finish(mut self) -> Self {
        let mut suspects = std::mem::take(&mut self.suspects);
        suspects.retain(|reading| self.is_suspect(reading));
        suspects.sort_by(|a, b| size(b).total_cmp(&size(a)));
        self.suspects = suspects;
        self
    }
}

struct Dispatch<'a> {
    problem: &'a Problem<'a>,
    solution: &'a Solution,
    keeps_all: bool,
}

impl WithSimd for Dispatch<'_> {
    type Output = Analysis;
    fn with_simd<S: Simd>(self, simd: S) -> Analysis {
        analyse::<Lanes<S>>(simd, &self)
    }
}

fn analyse<T: Packet>(token: T::Token, dispatch: &Dispatch<'_>) -> Analysis {
    let (problem, solution) = (dispatch.problem, dispatch.solution);
    let mut at = Evaluated::<T>::at(token, problem, solution);
    let own = covariance_at(&mut at, problem, solution);
    let covariance = own.as_ref();
    let mut collector = Collector {
        problem,
        covariance: covariance.map(|c| at.map.column_covariance(&at.home, c)),
        keeps_all: dispatch.keeps_all,
        observations: Vec::new(),
        tension_errors_n: Vec::new(),
        sums: ResidualSums::default(),
    };
    if let Some((row, evaluator)) = &mut at.home_evaluator {
        for reading in home_observations(evaluator, problem, covariance, &at.home, *row) {
            collector.add(reading);
        }
    }
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
        sums: collector.sums.finish(),
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
    at.poses.assemble(None, 0.0);
    at.poses.assemble(None, 0.0);
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
    /// Whether single readings are kept.
    keeps_all: bool,
    observations: Vec<Observation>,
    tension_errors_n: Vec<(usize, usize, f64)>,
    sums: ResidualSums,
}

impl Collector<'_> {
    fn add(&mut self, reading: Observation) {
        self.sums.add(&reading);
        if self.keeps_all {
            self.observations.push(reading);
        }
    }

    fn add_tension(&mut self, row: usize, cable: usize, error: f64) {
        self.sums.add_tension(error);
        if self.keeps_all {
            self.tension_errors_n.push((row, cable, error));
        }
    }
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

/// The values of each lane.
fn lanes<T: Packet>(values: impl Iterator<Item = T>) -> Vec<f64> {
    let mut lanes = vec![0.0; values.size_hint().0 * T::LANES];
    for (k, value) in values.enumerate() {
        value.store(&mut lanes, k);
    }
    lanes
}

impl<T: Packet> AnalysePoses<'_, '_, T> {
    fn collect(&mut self, batch: usize, layout: &Layout, fitted: &[T], tension: &[T]) {
        let equations = self.evaluator.equations();
        let residual = lanes(equations.residual.iter().copied());
        let present = lanes(equations.present.iter().copied());
        let weights = lanes(equations.length_by_cable.iter().map(|g| g[3]));
        let fitted = lanes(fitted.iter().copied());
        let tension = lanes(tension.iter().copied());
        let collector = &mut *self.collector;
        let problem = collector.problem;
        let known = collector.covariance.is_some();
        let latent = problem.has_latent_tension();
        let forces = &problem.dataset.measurements.force_n;
        let rows = self.evaluator.rows().iter();
        for (lane, row) in rows.skip(batch * T::LANES).take(T::LANES).enumerate() {
            let at = |k: usize| k * T::LANES + lane;
            for k in (0..layout.rows).filter(|k| present[at(*k)] > 0.0) {
                let kind = layout.kinds[k];
                let weight = weights.get(at(k)).map_or(1.0, |w| -w);
                collector.add(Observation {
                    row: *row,
                    kind,
                    standardised: residual[at(k)],
                    sd: sd_of(problem, kind, *row, weight),
                    redundancy: known.then(|| 1.0 - fitted[at(k)]),
                });
            }
            for cable in (0..layout.cables).filter(|_| latent) {
                if !forces.get(*row, cable).is_nan() {
                    collector.add_tension(*row, cable, tension[at(cable)]);
                }
            }
        }
    }
}
