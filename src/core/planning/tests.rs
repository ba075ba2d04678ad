//! Plans of the presets. Seeds are fixed.

use super::*;
use crate::effect::EffectRequest;
use crate::estimation::{Options, ParameterId, Problem, Solution, solve};
use crate::kinematics::equilibrium_residual;
use crate::measurement::{Dataset, DistanceReading};
use crate::robot::PartTolerances;
use crate::robot::presets::{self, Preset};
use crate::simulation::{SimulationOptions, TrueGeometry, simulate};

fn quiet(_: &PlanProgress) -> Control {
    Control::Continue
}

fn options_of<'a>(preset: &Preset, poses: usize) -> PlanOptions<'a> {
    PlanOptions {
        candidates: 600,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..PlanOptions::new(poses, 3)
    }
}

fn planned(preset: &Preset, poses: usize) -> Plan {
    plan(&preset.robot, &options_of(preset, poses), &mut quiet).unwrap()
}

fn poses_of(plan: &Plan) -> Vec<Pose> {
    plan.poses.iter().map(|planned| planned.pose).collect()
}

/// A run at the poses of a plan on the robot as it is described.
fn measured(preset: &Preset, poses: Vec<Pose>, noise: bool, seed: u64) -> Dataset {
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(0, seed).commanding(poses)
    };
    simulate(&preset.robot, &options).unwrap().dataset
}

fn identified(dataset: &Dataset) -> Solution {
    let problem = Problem::new(dataset).unwrap().with_stated_tolerances();
    // To rounding: the information is that of the last state evaluated.
    let options = Options {
        negligible: 0.0,
        ..Options::default()
    };
    let solution = solve(&problem, &options, &mut |_| Control::Continue).unwrap();
    assert!(solution.converged());
    solution
}

#[test]
fn information_before_measuring_is_that_of_the_solution() {
    for name in ["mini", "suspended", "planar"] {
        let preset = presets::find(name).unwrap();
        let options = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            noise: false,
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(12, 5)
        };
        let dataset = simulate(&preset.robot, &options).unwrap().dataset;
        let problem = Problem::new(&dataset).unwrap();
        let poses = &dataset.measurements.truth.poses[1..];
        let expected = ExpectedInformation::new(&problem, poses);
        let solution = identified(&dataset);
        assert_eq!(expected.parameters, solution.parameters);
        let sum = expected.of(0..poses.len());
        for i in 0..sum.nrows() {
            for k in 0..sum.ncols() {
                let scale = (sum[(i, i)] * sum[(k, k)]).sqrt();
                let off = (sum[(i, k)] - solution.information[(i, k)]).abs();
                assert!(off < 1e-6 * scale, "{name} {i} {k}: {off} of {scale}");
            }
        }
        // As few rows as readings more than coordinates.
        let free = preset.robot.platform.freedom().count();
        let readings = preset.robot.cable_count() + free + 1;
        assert!(
            expected
                .poses
                .iter()
                .all(|rows| rows.nrows() == readings - free)
        );
    }
}

#[test]
fn plans_beat_the_best_random_set() {
    for name in presets::NAMES {
        let preset = presets::find(name).unwrap();
        let plan = planned(&preset, 15);
        assert_eq!(plan.poses.len(), 15);
        let d = plan.expected.criteria.log_det;
        assert!(d > plan.best_random_log_det, "{name} {d}");
        let planned_mean = plan.expected.criteria.mean_m.unwrap();
        let random_mean = plan.random.criteria.mean_m.unwrap();
        assert!(planned_mean < random_mean, "{name}");
        assert!(plan.expected.criteria.worst_m.unwrap() > planned_mean);
    }
}

#[test]
fn exchanges_gain_over_the_greedy_choice_and_end() {
    let preset = presets::find("mini").unwrap();
    let options = options_of(&preset, 12);
    let mut exchanges = Vec::new();
    plan(&preset.robot, &options, &mut |progress| {
        if let PlanProgress::Exchanged { exchanges: so_far } = progress {
            exchanges.push(*so_far);
        }
        Control::Continue
    })
    .unwrap();
    let gained = exchanges.last().is_some_and(|last| *last > 0);
    assert!(gained && exchanges.len() < 30, "{exchanges:?}");
}

#[test]
fn expected_standard_deviations_are_those_of_identification() {
    // The commanded poses differ from the true ones by about 8 mm, the standard deviations therefore by per cents.
    for (name, tolerances) in [
        ("mini", None),
        ("planar", None),
        ("suspended", None),
        ("mini", Some(PartTolerances::typical())),
    ] {
        let mut preset = presets::find(name).unwrap();
        preset.robot.tolerances = tolerances;
        let plan = planned(&preset, 20);
        let dataset = measured(&preset, poses_of(&plan), true, 8);
        let solution = identified(&dataset);
        // What the readings say of stiffnesses depends on the tensions, which a controller keeps otherwise than planned.
        let all = solution.parameters.iter().enumerate();
        for (k, parameter) in all.filter(|(_, p)| !matches!(p.id, ParameterId::Deviation { .. })) {
            let ratio = plan.expected.sd[k].unwrap() / solution.standard_deviation(k).unwrap();
            assert!(
                (ratio - 1.0).abs() < 0.1,
                "{name} {}: {ratio}",
                parameter.name
            );
        }
    }
}

#[test]
fn errors_scatter_as_expected() {
    // Squared errors of identified entry points over expected variances, summed in the metric of the expected
    // covariance, are chi-square with 24 degrees of freedom per run: the mean over 40 runs is outside
    // 24 +- 4 * sqrt(48 / 40) = 24 +- 4.4 with a probability below 1e-4.
    let preset = presets::find("mini").unwrap();
    let plan = planned(&preset, 20);
    let poses = poses_of(&plan);
    let entry: Vec<usize> = (0..plan.parameters().len())
        .filter(|k| matches!(plan.parameters()[*k].id, ParameterId::EntryPoint { .. }))
        .collect();
    let total = plan.information.of(0..plan.poses.len());
    let covariance = covariance_of(&total).unwrap();
    let covariance = covariance.select_rows(&entry).select_columns(&entry);
    let weight = covariance.try_inverse().unwrap();
    let mut sum = 0.0;
    for seed in 0..40 {
        // The truth is drawn, because the expectation includes the prior.
        let options = SimulationOptions {
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(0, 100 + seed).commanding(poses.clone())
        };
        let run = simulate(&preset.robot, &options).unwrap();
        let solution = identified(&run.dataset);
        let errors = entry.iter().map(|k| match plan.parameters()[*k].id {
            ParameterId::EntryPoint { cable, axis } => {
                solution.globals.entry_points[cable][axis]
                    - run.truth.cables[cable].pulley.entry_point_m[axis]
            }
            _ => unreachable!("only entry points are picked"),
        });
        let errors = nalgebra::DVector::from_iterator(entry.len(), errors);
        sum += errors.dot(&(&weight * &errors));
    }
    let mean = sum / 40.0;
    assert!((mean - 24.0).abs() < 4.4, "{mean}");
}

#[test]
fn distances_of_a_tape_gain_what_is_promised() {
    let mut preset = presets::find("mini").unwrap();
    preset.robot.laser = None;
    let plan = planned(&preset, 12);
    let mut dataset = plan.dataset.clone();
    let place_of = |place: Option<usize>| match place {
        Some(place) => plan.poses[place].pose.position,
        None => preset.robot.home.unwrap().pose().position,
    };
    let platform_m = |dataset: &Dataset| {
        let solution = identified(dataset);
        let weights = position_weights(&preset.robot, &preset.workspace, &solution.parameters);
        weights.unwrap().dot(&solution.covariance.unwrap()).sqrt()
    };
    let promised = plan.distances.iter().map(|distance| distance.platform_m);
    let promised: Vec<f64> = promised.collect();
    let expected = plan.expected.criteria.platform_m.unwrap();
    assert!(promised.is_sorted_by(|a, b| a > b) && promised[0] < expected);
    assert!((platform_m(&dataset) / expected - 1.0).abs() < 1e-3);
    for (distance, promised) in plan.distances.iter().zip(promised) {
        let rows = distance.between.map(|place| place.map_or(0, |k| k + 1));
        let places = distance.between.map(place_of);
        assert!(((places[1] - places[0]).norm() - distance.distance_m).abs() < 1e-9);
        dataset.measurements.distances.push(DistanceReading {
            number: 1,
            rows,
            point_m: [0.0; 3],
            distance_m: distance.distance_m,
            sd_m: TAPE_SD_M,
        });
        let reached = platform_m(&dataset);
        assert!(
            (reached / promised - 1.0).abs() < 1e-3,
            "{reached} {promised}"
        );
    }
}

#[test]
fn the_order_is_short_and_follows_no_coordinate() {
    for name in presets::NAMES {
        let preset = presets::find(name).unwrap();
        let plan = planned(&preset, 25);
        let order = &plan.order;
        assert!(
            order.travel_m < 0.9 * order.unordered_travel_m,
            "{name} {order:?}"
        );
        assert!(order.worst_correlation() < 0.3, "{name} {order:?}");
        let mut sequence = order.sequence.clone();
        sequence.sort_unstable();
        assert_eq!(sequence, (0..25).collect::<Vec<_>>());
        let labels: Vec<i64> = plan.poses.iter().map(|p| p.label).collect();
        assert_eq!(labels, (1..=25).collect::<Vec<_>>());
    }
}

#[test]
fn more_poses_tell_more() {
    let preset = presets::find("mini").unwrap();
    let plan = planned(&preset, 15);
    assert_eq!(plan.after(15), plan.expected);
    assert_eq!(plan.after(99), plan.expected);
    let course: Vec<f64> = (0..=15)
        .map(|n| plan.after(n).criteria.mean_m.unwrap())
        .collect();
    assert!(
        course.windows(2).all(|pair| pair[1] <= pair[0]),
        "{course:?}"
    );
    // Before any pose little more is known than the drawing: the balance at home.
    assert!(course[0] <= 8e-3 && course[0] > 6e-3, "{}", course[0]);
    let of_first = plan.expected.entry_point_sd_m(plan.parameters(), 0);
    assert!(of_first.iter().all(|sd| sd.unwrap() < 2e-3), "{of_first:?}");
}

#[test]
fn a_plan_completes_what_was_measured() {
    let preset = presets::find("mini").unwrap();
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(10, 6)
    };
    let run = simulate(&preset.robot, &options).unwrap();
    let options = PlanOptions {
        existing: Some(&run.dataset.measurements),
        ..options_of(&preset, 5)
    };
    let plan = plan(&preset.robot, &options, &mut quiet).unwrap();
    let solution = identified(&run.dataset);
    for k in 0..solution.parameters.len() {
        let now = solution.standard_deviation(k).unwrap();
        assert!((plan.after(0).sd[k].unwrap() / now - 1.0).abs() < 1e-3);
        assert!(plan.expected.sd[k].unwrap() < now * 1.001);
    }
    assert_eq!(plan.poses[0].label, 11);
}

#[test]
fn effects_are_planned_for() {
    let preset = presets::find("mini").unwrap();
    let request = EffectRequest::parse("laser_drift").unwrap();
    let effects = request.bind(&preset.robot).unwrap();
    let options = PlanOptions {
        effects: &effects,
        ..options_of(&preset, 15)
    };
    let plan = plan(&preset.robot, &options, &mut quiet).unwrap();
    let last = plan.parameters().len() - 1;
    assert!(matches!(
        plan.parameters()[last].id,
        ParameterId::Effect { .. }
    ));
    let prior = plan.parameters()[last].prior_sd.unwrap();
    assert!(plan.expected.sd[last].unwrap() < prior);
}

#[test]
fn what_cannot_be_planned_is_said() {
    let preset = presets::find("mini").unwrap();
    let none = PlanOptions::new(0, 1);
    assert_eq!(
        plan(&preset.robot, &none, &mut quiet).unwrap_err(),
        PlanError::NoPoses
    );
    let far = PlanOptions {
        laser_range_m: [5.0, 6.0],
        candidates: 50,
        ..options_of(&preset, 5)
    };
    let Err(PlanError::TooFewPoses { found, refused, .. }) = plan(&preset.robot, &far, &mut quiet)
    else {
        panic!("the laser cannot measure there");
    };
    assert_eq!((found, refused.laser + refused.frame), (0, refused.tried));
    let mut known = preset.robot.clone();
    // Without limits no tensions are estimated.
    known.limits = None;
    for cable in &mut known.cables {
        cable.pulley.entry_point_sd_m = crate::robot::PerAxis::known(0.0);
        cable.force_sensor = None;
    }
    if let (Some(home), Some(laser)) = (&mut known.home, &mut known.laser) {
        (home.position_sd_m, home.orientation_sd_rad) = (0.0, 0.0);
        laser.target_plane.offset_sd_m = Some(0.0);
    }
    let nothing = plan(&known, &options_of(&preset, 5), &mut quiet).unwrap_err();
    assert_eq!(nothing, PlanError::NothingToEstimate);
    let cancelled = plan(&preset.robot, &options_of(&preset, 5), &mut |_| {
        Control::Cancel
    });
    assert_eq!(cancelled.unwrap_err(), PlanError::Cancelled);
}

#[test]
fn commanded_poses_are_those_given() {
    let preset = presets::find("mini").unwrap();
    let poses = poses_of(&planned(&preset, 6));
    let dataset = measured(&preset, poses.clone(), true, 2);
    let commanded: Vec<Pose> = (dataset.measurements.commanded.iter())
        .skip(1)
        .map(|pose| pose.unwrap())
        .collect();
    assert_eq!(commanded, poses);
}

#[test]
fn what_a_plan_promises_is_expected_of_its_poses_again() {
    let preset = presets::find("mini").unwrap();
    let options = options_of(&preset, 12);
    let planned = plan(&preset.robot, &options, &mut quiet).unwrap();
    let again = evaluate(&preset.robot, &poses_of(&planned), &options, &mut quiet).unwrap();
    assert_eq!(again.expected, planned.expected);
    assert_eq!(again.random, planned.random);
    assert_eq!(again.after(5), planned.after(5));
    assert!((again.order.travel_m - planned.order.travel_m).abs() < 1e-12);
    let mut poses = poses_of(&planned);
    poses[3].position += crate::geometry::Vec3::new(50.0, 0.0, 0.0);
    let error = evaluate(&preset.robot, &poses, &options, &mut quiet).unwrap_err();
    assert_eq!(error, PlanError::NotHeld { number: 4 });
}

/// Each goal is reached better by a plan for it than by plans for the other goals or by poses in a small part of the workspace.
#[test]
fn each_goal_is_reached_best_by_its_own_plan() {
    let preset = presets::find("mini").unwrap();
    let volume = Volume {
        low_m: [0.0, -0.05, 0.0],
        high_m: [0.15, 0.05, 0.1],
    };
    let goals = [
        Goal::Geometry,
        Goal::Faults,
        Goal::Both,
        Goal::Accuracy(volume),
    ];
    let options = |goal| PlanOptions {
        candidates: 150,
        goal,
        ..options_of(&preset, 12)
    };
    let plans = goals.map(|goal| plan(&preset.robot, &options(goal), &mut quiet).unwrap());
    for (own, goal) in goals.into_iter().enumerate() {
        let reached = |of: &Plan| {
            let again = evaluate(&preset.robot, &poses_of(of), &options(goal), &mut quiet);
            again.unwrap().reached.unwrap()
        };
        let all: Vec<f64> = plans.iter().map(reached).collect();
        assert_eq!(plans[own].goal, goal);
        assert!(
            (plans[own].reached.unwrap() - all[own]).abs() < 1e-6,
            "{goal:?} {all:?}"
        );
        for (other, value) in all.iter().enumerate() {
            assert!(other == own || *value < all[own], "{goal:?} {all:?}");
        }
    }
    let error = |plan: &Plan| plan.expected.criteria.platform_m.unwrap();
    let of_geometry = evaluate(
        &preset.robot,
        &poses_of(&plans[0]),
        &options(goals[3]),
        &mut quiet,
    );
    assert!(error(&plans[3]) < error(&of_geometry.unwrap()));
}

#[test]
fn faults_are_planned_for_on_top_of_what_was_measured() {
    let preset = presets::find("planar").unwrap();
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(10, 6)
    };
    let run = simulate(&preset.robot, &options).unwrap();
    let reached = |existing| {
        let options = PlanOptions {
            existing,
            goal: Goal::Both,
            candidates: 100,
            ..options_of(&preset, 5)
        };
        let plan = plan(&preset.robot, &options, &mut quiet).unwrap();
        (plan.dataset.measurements.len(), plan.reached.unwrap())
    };
    let (alone, without) = reached(None);
    let (together, with) = reached(Some(&run.dataset.measurements));
    assert_eq!((alone, together), (6, 16));
    assert!(with > without, "{with} {without}");
}

/// A platform that hangs in four cables rests only where they balance it, at poses that its weight decides.
#[test]
fn a_platform_on_fewer_cables_than_coordinates_is_planned_and_simulated() {
    let mut preset = presets::find("mini").unwrap();
    let cables = &mut preset.robot.cables;
    cables.retain(|cable| cable.pulley.entry_point_m[2] > 0.0);
    cables.truncate(4);
    for cable in cables {
        let [x, y, _] = cable.pulley.entry_point_m;
        cable.platform_anchor_m = [0.06 * x.signum(), 0.045 * y.signum(), 0.05];
    }
    preset.robot.platform.center_of_mass_m = [0.004, 0.0, -0.03];
    preset.tension.lower_n = 1.0;
    let robot = &preset.robot;
    let plan = planned(&preset, 12);
    assert_eq!(plan.poses.len(), 12);
    for pose in poses_of(&plan) {
        let held = preset.tension.tensions(robot, &pose).unwrap().unwrap();
        let off = equilibrium_residual(robot, &pose, &held).unwrap();
        assert!(off.amax() < 1e-6, "{off}");
    }
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(25, 4)
    };
    let run = simulate(robot, &options).unwrap();
    let truth = &run.dataset.measurements.truth;
    for (row, pose) in truth.poses.iter().enumerate() {
        let off = equilibrium_residual(&run.truth, pose, truth.tension_n.row(row)).unwrap();
        assert!(off.amax() < 1e-6, "{off}");
    }
    let solution = identified(&run.dataset);
    let off = solution.chi2 / solution.degrees_of_freedom - 1.0;
    // Six standard deviations of a chi-square.
    assert!(
        off.abs() < 6.0 * (2.0 / solution.degrees_of_freedom).sqrt(),
        "{off}"
    );
}
