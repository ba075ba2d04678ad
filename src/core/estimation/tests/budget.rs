//! Budgets of uncertainty: they sum to the variance, and each share is that of readings with this noise alone.

use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::*;
use crate::estimation::linearisation::LinearisedProblem;
use crate::kinematics::length_gradients;
use crate::measurement::Grid;
use crate::planning::{PlanOptions, position_jacobians, random_poses};
use crate::robot::{
    Inclinometer, PartTolerances, PerAxis, Robot, StatedTolerances, Tolerance, Tracker,
};
use crate::simulation::RepeatedRuns;

/// Solution with the parts exact, then one with these tolerances, if any.
fn solved_with<'a>(
    dataset: &'a Dataset,
    tolerances: Option<&PartTolerances>,
) -> (Problem<'a>, Solution) {
    let exact = Problem::new(dataset).unwrap();
    let first = solved(&exact);
    let Some(tolerances) = tolerances else {
        return (exact, first);
    };
    let problem = exact.with_tolerances(tolerances).at_poses_of(&first);
    let solution = solved(&problem);
    (problem, solution)
}

/// Standard deviation of the cable that winches pay out per revolution.
const WINCH_SCALE: f64 = 5e-4;

/// Tolerances of the winches alone.
fn of_winches() -> PartTolerances {
    let scale = [("winch_scale".to_owned(), Tolerance::Same(WINCH_SCALE))];
    PartTolerances::Stated(StatedTolerances {
        factor: 1.0,
        effects: scale.into(),
    })
}

/// Runs of all presets; of one also with more instruments, and without force sensors.
fn datasets() -> Vec<(&'static str, Dataset)> {
    let presets = presets::NAMES.map(|name| (name, run_of(name, 20, 5).dataset));
    let mut robot = presets::find("mini").unwrap().robot;
    robot.inclinometer = Some(Inclinometer { sd_rad: 1e-3 });
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-3),
        orientation_sd_rad: Some(1e-3),
    });
    for cable in &mut robot.cables {
        cable.pulley.swivel_zero = Some([1.0, 0.0, 0.0]);
        cable.pulley.swivel_sd_rad = Some(5e-3);
    }
    let instruments = simulate(&robot, &SimulationOptions::new(20, 6)).unwrap();
    let mut unread = run_of("mini", 20, 7).dataset;
    for cable in &mut unread.robot.cables {
        cable.force_sensor = None;
    }
    unread.measurements.force_n = Grid::default();
    let others = [
        ("instruments", instruments.dataset),
        ("assumed tensions", unread),
    ];
    presets.into_iter().chain(others).collect()
}

#[test]
fn contributions_sum_to_the_variance_and_none_is_negative() {
    let typical = PartTolerances::typical();
    for (name, dataset) in datasets() {
        let simple = Problem::new(&dataset).unwrap().with_method(Method::Simple);
        let solution = solved(&simple);
        let joint = [None, Some(&typical)].map(|tolerances| solved_with(&dataset, tolerances));
        for (problem, solution) in joint.into_iter().chain([(simple, solution)]) {
            let divided = CovarianceBySource::new(&problem, &solution).unwrap();
            let linear = Linearisation::new(&problem, &solution);
            let covariance = covariance_of(&linear.design.tr_mul(&linear.design)).unwrap();
            let stated = solution.covariance.as_ref().unwrap();
            for (k, parameter) in solution.parameters.iter().enumerate() {
                let ParameterId::EntryPoint { cable, axis } = parameter.id else {
                    continue;
                };
                let budget = divided.entry_point_coordinate(cable, axis).unwrap();
                let contributions = &budget.contributions;
                assert!(contributions.iter().all(|one| one.variance >= 0.0));
                let off = budget.variance() / covariance[(k, k)] - 1.0;
                assert!(off.abs() < 1e-9, "{name}: {off}");
                // The covariance of a solution is that of the state before its last step.
                let off = budget.variance() / stated[(k, k)] - 1.0;
                assert!(off.abs() < 1e-3, "{name}: {off}");
            }
            let position = divided.position().unwrap();
            let contributions = &position.contributions;
            assert!(contributions.iter().all(|one| one.variance >= 0.0));
            let shares: f64 = position.shares().map(|(_, share)| share).sum();
            assert!((shares - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn every_instrument_of_the_robot_is_a_source() {
    use UncertaintySource as Source;
    let (_, dataset) = datasets().swap_remove(4);
    let (problem, solution) = solved_with(&dataset, None);
    let divided = CovarianceBySource::new(&problem, &solution).unwrap();
    let sources: Vec<_> = divided.sources.iter().map(|(source, _)| *source).collect();
    let expected = [
        Source::Encoders,
        Source::ForceSensors,
        Source::UnexplainedWrench,
        Source::Laser,
        Source::SwivelSensors,
        Source::Inclinometer,
        Source::ExternalInstrument,
        Source::HomePose,
        Source::Drawing,
        Source::TargetPlane,
    ];
    assert_eq!(sources, expected);
    assert!(divided.entry_point(99).is_none());
    let robust = Problem {
        loss: Loss::Huber(1.5),
        ..problem
    };
    assert!(CovarianceBySource::new(&robust, &solution).is_none());
}

/// The position error of a controller follows from the kinematics alone if cables do not stretch.
#[test]
fn position_errors_are_those_of_the_kinematics() {
    let mut run = run_of("mini", 12, 8);
    for cable in &mut run.dataset.robot.cables {
        (cable.cable.axial_stiffness_n, cable.cable.weight_n_per_m) = (None, 0.0);
    }
    let tolerances = of_winches();
    let (problem, solution) = solved_with(&run.dataset, Some(&tolerances));
    let model = solution.globals.model(&run.dataset.robot);
    let mut linear = LinearisedProblem::new(&problem, &solution);
    let fitted: Vec<_> = solution.poses[1..].iter().map(|(_, pose)| *pose).collect();
    let parameters = &solution.parameters;
    let expected = position_jacobians(&model, &fitted, parameters).unwrap();
    for (index, (pose, mut expected)) in fitted.iter().zip(expected).enumerate() {
        let there = length_gradients(&model, pose).unwrap();
        let by_pose = DMatrix::from_fn(there.len(), 6, |i, k| there[i].pose[k]);
        let inverse = by_pose.pseudo_inverse(1e-9).unwrap();
        for (k, parameter) in parameters.iter().enumerate() {
            if let ParameterId::Deviation { deviation, .. } = parameter.id {
                let cable = problem.deviations[deviation].bound.cables[0];
                // The cable paid out by the winch as described, of which the error of the scale is a part.
                let winch = &model.cables[cable].winch;
                let row = solution.poses[1 + index].0;
                let revolutions = run.dataset.measurements.revolutions.get(row, cable);
                let paid = revolutions * winch.cable_per_revolution_m();
                let column = -paid * inverse.column(cable).rows(0, 3);
                expected.column_mut(k).copy_from(&column);
            }
        }
        let found = linear.position_by_parameter(index).unwrap();
        let off = (&found - &expected).norm() / expected.norm();
        assert!(off < 1e-6, "{off}");
    }
}

/// A kind of noise that a simulation has alone.
type Noise = fn(&Robot, &mut Robot);

/// The kinds of noise, each with the source that the estimator attributes it to.
const NOISES: [(UncertaintySource, Noise); 6] = [
    (UncertaintySource::Encoders, |from, to| {
        for (to, from) in to.cables.iter_mut().zip(&from.cables) {
            to.winch.length_sd_m = from.winch.length_sd_m;
        }
    }),
    (UncertaintySource::ForceSensors, |from, to| {
        for (to, from) in to.cables.iter_mut().zip(&from.cables) {
            to.force_sensor = from.force_sensor;
        }
    }),
    (UncertaintySource::Laser, |from, to| {
        to.laser.as_mut().unwrap().sd_m = from.laser.unwrap().sd_m;
    }),
    (UncertaintySource::HomePose, |from, to| to.home = from.home),
    (UncertaintySource::Drawing, |from, to| {
        for (to, from) in to.cables.iter_mut().zip(&from.cables) {
            to.pulley.entry_point_sd_m = from.pulley.entry_point_sd_m;
        }
    }),
    // Winches that are off by their tolerance; the readings are changed below.
    (UncertaintySource::Tolerance("winch_scale"), |_, _| {}),
];

/// The robot with exact readings and known exactly.
fn exact(robot: &Robot) -> Robot {
    let mut exact = robot.clone();
    for cable in &mut exact.cables {
        cable.winch.length_sd_m = 0.0;
        cable.pulley.entry_point_sd_m = PerAxis::Same(Some(0.0));
        cable.force_sensor.as_mut().unwrap().tension_sd_n = 0.0;
    }
    let laser = exact.laser.as_mut().unwrap();
    (laser.sd_m, laser.target_plane.offset_sd_m) = (0.0, Some(0.0));
    let home = exact.home.as_mut().unwrap();
    (home.position_sd_m, home.orientation_sd_rad) = (0.0, 0.0);
    exact
}

const RUNS: usize = 300;

/// Monte Carlo: of many calibrations with one source of noise, identified with the weights of all sources, the errors have
/// the variance that the budget attributes to the source. Nothing of the budget takes part in making the readings.
///
/// The mean over the runs of the squared errors of all pulleys has the standard error `sqrt(2 tr(V^2) / runs)`. It is
/// compared within four of them, 6e-5 for a normal mean, so a correct program fails one of the twelve with a probability
/// below 1e-3.
#[test]
fn a_share_is_the_variance_of_errors_from_this_source_alone() {
    let tolerances = of_winches();
    for name in ["mini", "hall"] {
        let robot = presets::find(name).unwrap().robot;
        let poses = random_poses(&robot, &PlanOptions::new(20, 4)).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(31);
        for (source, noise) in NOISES {
            let mut noisy = exact(&robot);
            noise(&robot, &mut noisy);
            let runs = RepeatedRuns::new(&noisy, poses.clone(), None).unwrap();
            let (mut sum, mut expected) = (0.0, None);
            for _ in 0..RUNS {
                let mut run = runs.simulate(&mut rng).unwrap();
                run.dataset.robot = robot.clone();
                if source == UncertaintySource::Tolerance("winch_scale") {
                    misread_winches(&mut run.dataset, &mut rng);
                }
                let (problem, solution) = solved_with(&run.dataset, Some(&tolerances));
                expected.get_or_insert_with(|| of_all_pulleys(&problem, &solution, source));
                let found = solution.globals.entry_points.iter();
                for (found, truth) in found.zip(&run.truth.cables) {
                    let truth = truth.pulley.entry_point_m;
                    sum += (0..3).map(|k| (found[k] - truth[k]).powi(2)).sum::<f64>();
                }
            }
            let (mean, own) = (sum / RUNS as f64, expected.unwrap());
            let standard_error = (2.0 * own.norm_squared() / RUNS as f64).sqrt();
            let off = (mean - own.trace()) / standard_error;
            assert!(off.abs() < 4.0, "{name} {source:?}: {off}");
        }
    }
}

/// Makes every winch pay out more or less cable per revolution than described.
fn misread_winches(dataset: &mut Dataset, rng: &mut ChaCha8Rng) {
    let revolutions = &mut dataset.measurements.revolutions;
    for cable in 0..dataset.robot.cable_count() {
        let scale = 1.0 + WINCH_SCALE * rng.sample::<f64, _>(StandardNormal);
        for row in 0..revolutions.rows() {
            revolutions.set(row, cable, revolutions.get(row, cable) / scale);
        }
    }
}

/// Covariance of all entry points due to a source.
fn of_all_pulleys(
    problem: &Problem<'_>,
    solution: &Solution,
    source: UncertaintySource,
) -> DMatrix<f64> {
    let divided = CovarianceBySource::new(problem, solution).unwrap();
    let is_entry = |k: &usize| {
        let id = &divided.parameters[*k].id;
        matches!(id, ParameterId::EntryPoint { .. })
    };
    let picked: Vec<usize> = (0..divided.parameters.len()).filter(is_entry).collect();
    let (_, own) = divided.sources.iter().find(|(s, _)| *s == source).unwrap();
    own.select_rows(&picked).select_columns(&picked)
}
