//! Residual analysis at a solution: standardised residuals, redundancies, reliability, suspicious readings.
//!
//! With the estimate `e = w^T r` of the noise of a reading in its standard deviations, a function `w` of the whitened rows
//! `r` ([`super::evaluator`]), and the covariance `I - H` of these rows after the fit, the redundancy is
//! `w^T (I - H) w`: the share of an error in that reading that shows in its residual (Baarda 1968). `e` over its
//! square root is standard normal if model and noise are right. The redundancies of all readings, equations and priors sum to
//! the degrees of freedom.
//!
//! With the derivative `g` of `e` with respect to the common parameters (poses re-estimated) and their covariance `C`, an
//! error of one standard deviation in the reading changes the parameters by `C g`.

mod connected;
mod home;
mod poses;

use connected::ConnectedPoses;
use home::HomeReadings;
use poses::AnalysePoses;

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

use super::distances::Distances;
use super::evaluated::Evaluated;
use super::observation::{DetectionTest, EntryPointSensitivity, Observation, ObservationKind};
use super::options::Division;
use super::parameter::{Parameter, ParameterId};
use super::problem::Problem;
use super::solution::Solution;
use super::system::{Priors, System};
use crate::real::{Lanes, Packet};

/// Significance level, for all readings together, at which single readings are called suspect.
pub const SUSPECT_LEVEL: f64 = 0.01;
/// Smaller normalised residuals are never suspect: a single reading at [`SUSPECT_LEVEL`] would need 2.58.
const NEVER_SUSPECT: f64 = 2.5;

/// Residuals of all readings at a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Every reading and every equilibrium equation, in the order of the rows; empty in a summary.
    pub observations: Vec<Observation>,
    /// Redundancy of the prior of each parameter; `None` if it has no prior, and for the errors of tension readings
    /// at home, which are among the observations.
    pub prior_redundancies: Vec<Option<f64>>,
    sums: ResidualSums,
}

/// Sums over the readings.
#[derive(Debug, Clone, Default, PartialEq)]
struct ResidualSums {
    /// Number of readings and sum of squared residuals of each kind (SI units).
    kinds: Vec<(ObservationKind, usize, f64)>,
    /// Number of readings so far.
    count: usize,
    /// Readings whose normalised residual is improbably large.
    suspects: Vec<Observation>,
}

impl Analysis {
    /// Analyses the residuals of `problem` at `solution`.
    #[must_use]
    pub fn new(problem: &Problem<'_>, solution: &Solution) -> Self {
        Self::divided(problem, solution, Division::default())
    }

    /// As [`Self::new`], with another division of the poses.
    pub(super) fn divided(problem: &Problem<'_>, solution: &Solution, division: Division) -> Self {
        Arch::new().dispatch(Dispatch {
            problem,
            solution,
            keeps_all: true,
            division,
        })
    }

    /// As [`Self::new`], without the list of single readings, which takes most of the memory if there are many poses.
    #[must_use]
    pub fn summary(problem: &Problem<'_>, solution: &Solution) -> Self {
        Arch::new().dispatch(Dispatch {
            problem,
            solution,
            keeps_all: false,
            division: Division::default(),
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

    /// The test of single readings behind [`Self::suspects`], at the power customary in geodesy.
    #[must_use]
    pub fn test(&self) -> DetectionTest {
        DetectionTest {
            level: self.sums.level(),
            power: DetectionTest::USUAL_POWER,
        }
    }

    /// Readings whose normalised residual is improbably large, the worst first: two-sided, at a level of 1 % for all
    /// readings together (Bonferroni).
    #[must_use]
    pub fn suspects(&self) -> &[Observation] {
        &self.sums.suspects
    }
}

fn root_mean_square((count, square): (usize, f64)) -> Option<f64> {
    (count > 0).then(|| (square / count as f64).sqrt())
}

/// Magnitude of the normalised residual; 0 where the reading is hardly controlled.
fn size(reading: &Observation) -> f64 {
    reading.normalised().map_or(0.0, f64::abs)
}

impl ResidualSums {
    fn add(&mut self, reading: &Observation) {
        self.add_squares((reading.kind, 1, reading.residual().powi(2)));
        self.count += 1;
        // The level only falls as readings are added, so no suspect is missed.
        if size(reading) > NEVER_SUSPECT && self.is_suspect(reading) {
            self.suspects.push(*reading);
        }
    }

    /// Adds readings of one kind, as their number and the sum of their squared residuals.
    fn add_squares(&mut self, (kind, more, squares): (ObservationKind, usize, f64)) {
        match self.kinds.iter_mut().find(|(known, ..)| *known == kind) {
            Some((_, count, sum)) => {
                *count += more;
                *sum += squares;
            }
            None => self.kinds.push((kind, more, squares)),
        }
    }

    /// Adds the sums over other readings. These were fewer and judged at a higher level, so no suspect is missing.
    fn add_sums(&mut self, other: Self) {
        other
            .kinds
            .into_iter()
            .for_each(|one| self.add_squares(one));
        self.count += other.count;
        self.suspects.extend(other.suspects);
    }

    /// Level of the test of one reading.
    fn level(&self) -> f64 {
        SUSPECT_LEVEL / self.count.max(1) as f64
    }

    fn is_suspect(&self, reading: &Observation) -> bool {
        crate::statistics::normal_two_sided(size(reading)) < self.level()
    }

    /// Drops the candidates that are not suspect at the final level, and sorts the rest.
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
    division: Division,
}

impl WithSimd for Dispatch<'_> {
    type Output = Analysis;
    fn with_simd<S: Simd>(self, simd: S) -> Analysis {
        analyse::<Lanes<S>>(simd, &self)
    }
}

fn analyse<T: Packet>(token: T::Token, dispatch: &Dispatch<'_>) -> Analysis {
    let (problem, solution) = (dispatch.problem, dispatch.solution);
    let mut at = Evaluated::<T>::at(token, problem, solution, dispatch.division);
    let distances = at.distances(problem, (&solution.globals, &solution.parameters));
    let own = covariance_at(&mut at, problem, solution, distances.as_ref());
    let covariance = own.as_ref();
    let by_column = covariance.map(|c| at.map.column_covariance(&at.home, c));
    let collector = || Collector {
        problem,
        covariance: by_column.as_ref(),
        keeps_all: dispatch.keeps_all,
        observations: Vec::new(),
        sums: ResidualSums::default(),
    };
    let readings = ReadingsOfParameters::new(problem, solution, covariance);
    let mut home_readings = Vec::new();
    if let Some((row, evaluator)) = &mut at.home_evaluator {
        let home = HomeReadings {
            problem,
            solution,
            parameters: readings,
            row: *row,
        };
        home_readings.extend(home.instruments(evaluator, &at.home));
        home_readings.extend(home.tensions());
    }
    if let Some(distances) = &distances {
        let connected = ConnectedPoses::new(problem, solution, readings);
        home_readings.extend(connected.readings(distances));
    }
    let mut others = home_readings.into_iter();
    let with_home = || {
        // The readings at home and those that distances connect precede those of the first part.
        let mut collector = collector();
        others.by_ref().for_each(|one| collector.add(one));
        collector
    };
    let parts = at.poses.work_out(with_home, |evaluator, collector| {
        T::run(
            token,
            AnalysePoses {
                evaluator,
                collector,
                token,
            },
        );
    });
    let parts = parts.into_iter();
    let mut all = parts
        .reduce(Collector::followed_by)
        .unwrap_or_else(collector);
    if distances.is_some() {
        all.observations.sort_by_key(|reading| reading.row);
    }
    Analysis {
        observations: all.observations,
        sums: all.sums.finish(),
        prior_redundancies: prior_redundancies(problem, solution, covariance),
    }
}

/// Covariance of the parameters with the equations linearised at the solution itself; the covariance in the
/// solution belongs to the state before the last step.
fn covariance_at<T: Packet>(
    at: &mut Evaluated<'_, T>,
    problem: &Problem<'_>,
    solution: &Solution,
    distances: Option<&Distances>,
) -> Option<DMatrix<f64>> {
    solution.covariance.as_ref()?;
    at.poses.find_tensions();
    at.poses.assemble(None, 0.0);
    let priors = Priors::evaluate(problem, &solution.globals, &solution.parameters);
    let mut system = System::build(at.poses.sums(), &at.map, &at.home, &priors);
    distances
        .into_iter()
        .for_each(|all| system.add_distances(all));
    system.covariance()
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
        let parameter = &solution.parameters[k];
        parameter.prior_sd?;
        if let ParameterId::HomeTension { .. } = parameter.id {
            return None;
        }
        let covariance = covariance?;
        Some(1.0 - rows[k].dot(&(covariance * &rows[k])))
    };
    (0..n).map(redundancy).collect()
}

/// Readings whose residuals depend on the common parameters.
#[derive(Clone, Copy)]
struct ReadingsOfParameters<'a> {
    parameters: &'a [Parameter],
    cables: usize,
    covariance: Option<&'a DMatrix<f64>>,
}

impl<'a> ReadingsOfParameters<'a> {
    fn new(
        problem: &Problem<'_>,
        solution: &'a Solution,
        covariance: Option<&'a DMatrix<f64>>,
    ) -> Self {
        Self {
            parameters: &solution.parameters,
            cables: problem.dataset.robot.cable_count(),
            covariance,
        }
    }

    /// A reading, from the share of its variance that is left with known parameters and its derivative by these.
    fn observation(
        &self,
        (row, kind, sd): (usize, ObservationKind, f64),
        standardised: f64,
        (left, gradient): (f64, &DVector<f64>),
    ) -> Observation {
        let moved = self.covariance.map(|c| c * gradient);
        Observation {
            row,
            kind,
            standardised,
            sd,
            redundancy: moved.as_ref().map(|moved| left - gradient.dot(moved)),
            pull: moved.and_then(|moved| self.pull(&moved)),
        }
    }

    fn pull(&self, moved: &DVector<f64>) -> Option<EntryPointSensitivity> {
        let mut squares = vec![0.0; self.cables];
        for (parameter, moved) in self.parameters.iter().zip(moved) {
            if let ParameterId::EntryPoint { cable, .. } = parameter.id {
                squares[cable] += moved * moved;
            }
        }
        let squares = squares.into_iter().enumerate();
        let (cable, square) = squares.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (square > 0.0).then(|| EntryPointSensitivity {
            cable,
            per_sd_m: square.sqrt(),
        })
    }
}

struct Collector<'a> {
    problem: &'a Problem<'a>,
    covariance: Option<&'a DMatrix<f64>>,
    /// Whether single readings are kept rather than only their sums.
    keeps_all: bool,
    observations: Vec<Observation>,
    sums: ResidualSums,
}

impl Collector<'_> {
    fn add(&mut self, reading: Observation) {
        self.sums.add(&reading);
        if self.keeps_all {
            self.observations.push(reading);
        }
    }

    /// Whether a distance moves the pose of a row, see [`ConnectedPoses`].
    fn is_connected(&self, row: usize) -> bool {
        let mut distances = self.problem.dataset.measurements.distances.iter();
        distances.any(|one| one.rows.contains(&row))
    }

    /// Appends the readings of later poses.
    fn followed_by(mut self, next: Self) -> Self {
        self.observations.extend(next.observations);
        self.sums.add_sums(next.sums);
        self
    }
}
