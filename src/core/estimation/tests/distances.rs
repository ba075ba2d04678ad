//! Distances between poses: against the same least-squares problem solved without elimination, and by simulation.

use nalgebra::{DMatrix, DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::globals::Globals;
use super::super::system::Priors;
use super::*;
use crate::geometry::{Pose, Twist};
use crate::measurement::DistanceReading;

/// Cable lengths and the distances between neighbouring poses, and between the home pose and the last one.
fn planar_with_distances(seed: u64, sd_m: f64) -> Simulated {
    let preset = presets::find("planar").unwrap();
    let mut robot = preset.robot.clone();
    robot.laser = None;
    for cable in &mut robot.cables {
        cable.cable.axial_stiffness_n = None;
        cable.force_sensor = None;
    }
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(6, seed)
    };
    let mut run = simulate(&robot, &options).unwrap();
    run.dataset.robot.limits = None;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xd157);
    let data = &mut run.dataset.measurements;
    let point_m = [0.1, -0.05, 0.02];
    let pairs = (1..data.len())
        .map(|row| [row - 1, row])
        .chain([[0, data.len() - 1]]);
    let truth = &data.truth.poses;
    let reading = |(k, rows): (usize, [usize; 2])| {
        let [a, b] = rows.map(|row| truth[row].transform(&Vector3::from(point_m)));
        let noise: f64 = rng.sample(rand_distr::StandardNormal);
        DistanceReading {
            number: k + 1,
            rows,
            point_m,
            distance_m: (a - b).norm() + sd_m * noise,
            sd_m,
        }
    };
    data.distances = pairs.enumerate().map(reading).collect();
    run
}

/// The whole problem: all whitened residuals as a function of the steps of parameters and poses.
struct Whole<'a> {
    problem: &'a Problem<'a>,
    solution: &'a Solution,
    rows: Vec<usize>,
    poses: Vec<Pose>,
}

impl<'a> Whole<'a> {
    fn new(problem: &'a Problem<'a>, solution: &'a Solution) -> Self {
        let home = problem.home_row();
        let estimated = solution.poses.iter().filter(|(row, _)| Some(*row) != home);
        let (rows, poses) = estimated.copied().unzip();
        Self {
            problem,
            solution,
            rows,
            poses,
        }
    }

    fn size(&self) -> usize {
        self.solution.parameters.len() + 3 * self.poses.len()
    }

    fn residuals(&self, step: &DVector<f64>) -> DVector<f64> {
        let (problem, parameters): (_, &[Parameter]) = (self.problem, &self.solution.parameters);
        let mut globals: Globals = self.solution.globals.clone();
        globals.step(problem, parameters, &step.as_slice()[..parameters.len()]);
        let moved = |(k, pose): (usize, &Pose)| {
            let own = step.rows(parameters.len() + 3 * k, 3);
            pose.perturbed(&Twist::new(own[0], own[1], 0.0, 0.0, 0.0, own[2]))
        };
        let poses: Vec<Pose> = self.poses.iter().enumerate().map(moved).collect();
        let cables = &problem.dataset.robot.cables;
        let mut all = Vec::new();
        for row in residuals_at(problem, &globals, &self.rows, &poses) {
            let lengths = row.length_m.iter().zip(cables);
            all.extend(lengths.map(|(length, cable)| length / cable.winch.length_sd_m));
        }
        for one in &problem.dataset.measurements.distances {
            let place = |row: usize| {
                let at = self.rows.iter().position(|own| *own == row);
                let pose = at.map_or(globals.home, |k| poses[k]);
                pose.transform(&Vector3::from(one.point_m))
            };
            let [a, b] = one.rows.map(place);
            all.push(((a - b).norm() - one.distance_m) / one.sd_m);
        }
        all.extend(Priors::evaluate(problem, &globals, parameters).residuals);
        DVector::from_vec(all)
    }

    /// Derivative of the residuals by central differences.
    fn jacobian(&self) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = (0..self.size())
            .map(|k| {
                let mut step = DVector::zeros(self.size());
                step[k] = 1e-6;
                (self.residuals(&step) - self.residuals(&-step)) / 2e-6
            })
            .collect();
        DMatrix::from_columns(&columns)
    }
}

#[test]
fn the_solution_is_that_of_the_whole_problem() {
    // Distances far better and far worse than the lengths.
    for sd_m in [2e-6, 1e-4, 1e-2] {
        let run = planar_with_distances(3, sd_m);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        assert!(solution.converged());
        let whole = Whole::new(&problem, &solution);
        let residuals = whole.residuals(&DVector::zeros(whole.size()));
        let jacobian = whole.jacobian();
        let information = jacobian.tr_mul(&jacobian);
        let covariance = information.cholesky().unwrap().inverse();
        // The remaining step, in standard deviations.
        let step = &covariance * jacobian.tr_mul(&residuals);
        let largest = (0..step.len())
            .map(|k| step[k].abs() / covariance[(k, k)].sqrt())
            .fold(0.0, f64::max);
        assert!(largest < 1e-3, "{sd_m}: {largest}");
        assert!((solution.chi2 - residuals.norm_squared()).abs() < 1e-4 * solution.chi2);
        let own = solution.covariance.as_ref().unwrap();
        let n = own.nrows();
        let expected = covariance.view((0, 0), (n, n));
        for k in 0..n {
            let ratio = own[(k, k)] / expected[(k, k)];
            assert!((ratio - 1.0).abs() < 1e-3, "{sd_m}, parameter {k}: {ratio}");
        }
        // The linearised problem has the same information and the same loss.
        let linear = Linearisation::new(&problem, &solution);
        let from_rows = linear.design.tr_mul(&linear.design);
        assert!((&from_rows - &solution.information).norm() < 1e-6 * from_rows.norm());
        assert!((linear.residual.norm_squared() - solution.chi2).abs() < 1e-6 * solution.chi2);
        let analysis = Analysis::new(&problem, &solution);
        let readings = analysis.observations.iter();
        let squares: f64 = readings.clone().map(|one| one.standardised.powi(2)).sum();
        let priors = Priors::evaluate(&problem, &solution.globals, &solution.parameters);
        assert!((squares + priors.loss - solution.chi2).abs() < 1e-4 * solution.chi2);
        let redundancies = readings.map(|one| one.redundancy.unwrap());
        let of_priors = analysis.prior_redundancies.iter().flatten();
        let sum = redundancies.sum::<f64>() + of_priors.sum::<f64>();
        assert!((sum - solution.degrees_of_freedom).abs() < 1e-5, "{sum}");
    }
}

#[test]
fn chi_square_and_errors_are_as_large_as_stated() {
    // Two figures, five standard deviations each: below 2e-6.
    let (mut chi2, mut freedom, mut error, mut coordinates) = (0.0, 0.0, 0.0, 0.0);
    for seed in 100..140 {
        let run = planar_with_distances(seed, 5e-4);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        chi2 += solution.chi2;
        freedom += solution.degrees_of_freedom;
        let (own, count) = entry_error(&run, &solution);
        error += own;
        coordinates += count;
    }
    for (sum, expected) in [(chi2, freedom), (error, coordinates)] {
        let away = (sum - expected) / (2.0_f64 * expected).sqrt();
        assert!(away.abs() < 5.0, "{sum} of {expected}");
    }
}

#[test]
fn a_wrong_distance_is_suspect_and_counts_little_with_a_robust_loss() {
    let mut run = planar_with_distances(7, 5e-4);
    let problem = Problem::new(&run.dataset).unwrap();
    let right = solved(&problem);
    run.dataset.measurements.distances[2].distance_m += 0.05;
    let problem = Problem::new(&run.dataset).unwrap();
    let square = solved(&problem);
    let analysis = Analysis::new(&problem, &square);
    assert_eq!(analysis.suspects()[0].kind, ObservationKind::Distance(2));
    let huber = Problem {
        loss: Loss::Huber(1.5),
        ..problem
    };
    let robust = solved(&huber);
    assert!(robust.converged());
    let moved = |solution: &Solution| {
        let places = solution.globals.entry_points.iter();
        let pairs = places.zip(&right.globals.entry_points);
        let squares = pairs.map(|(a, b)| (Vector3::from(*a) - Vector3::from(*b)).norm_squared());
        squares.sum::<f64>().sqrt()
    };
    assert!(moved(&robust) < 0.2 * moved(&square));
}
