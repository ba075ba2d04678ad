//! Comparisons of simulated runs. Seeds are fixed.

use super::*;
use crate::effect::EffectRequest;
use crate::estimation::{Control, Options, solve};
use crate::measurement::Dataset;
use crate::robot::{PartTolerances, Robot, presets};
use crate::simulation::{SimulationOptions, TrueGeometry, simulate};

const LEVEL: f64 = 0.05;

/// A robot that differs from the drawing of a preset.
fn true_robot(name: &str) -> Robot {
    let preset = presets::find(name).unwrap();
    simulate(&preset.robot, &SimulationOptions::new(1, 77))
        .unwrap()
        .truth
}

/// The same of parts that deviate within typical tolerances, which the drawing states.
fn true_machine(name: &str) -> Robot {
    let mut drawing = presets::find(name).unwrap().robot;
    drawing.tolerances = Some(PartTolerances::typical());
    simulate(&drawing, &SimulationOptions::new(1, 77))
        .unwrap()
        .truth
}

/// Measurements on a robot as it truly is, with the drawing as its description.
fn run_on(truth: &Robot, name: &str, poses: usize, seed: u64) -> Dataset {
    let mut preset = presets::find(name).unwrap();
    preset.robot.tolerances = truth.tolerances.clone();
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    };
    let run = simulate(truth, &options).unwrap();
    Dataset {
        robot: preset.robot,
        measurements: run.dataset.measurements,
    }
}

fn compared_with(first: &Dataset, second: &Dataset, effects: [&str; 2]) -> Comparison {
    let [one, other] = [(first, effects[0]), (second, effects[1])].map(|(dataset, effects)| {
        let mut problem = Problem::new(dataset).unwrap();
        let names = effects.split(',').filter(|name| !name.is_empty());
        let requests: Vec<_> = names
            .map(|name| EffectRequest::parse(name).unwrap())
            .collect();
        problem.free(&requests).unwrap();
        let solved = |problem: &Problem<'_>| {
            let solution = solve(problem, &Options::default(), &mut |_| Control::Continue).unwrap();
            assert!(solution.converged());
            solution
        };
        let mut solution = solved(&problem);
        if let Some(tolerances) = &dataset.robot.tolerances {
            problem = problem.with_tolerances(tolerances).at_poses_of(&solution);
            solution = solved(&problem);
        }
        (problem, solution)
    });
    let [one, other] = [&one, &other].map(|(problem, solution)| Identified { problem, solution });
    compare(&one, &other, LEVEL).unwrap()
}

fn compared(first: &Dataset, second: &Dataset) -> Comparison {
    compared_with(first, second, ["", ""])
}

fn moved(comparison: &Comparison) -> Vec<&str> {
    let pulleys = comparison.pulleys.iter().filter(|pulley| pulley.moved);
    pulleys.map(|pulley| pulley.cable.as_str()).collect()
}

#[test]
fn probabilities_are_corrected_as_by_hand() {
    let corrected = holm(&[0.04, 0.01, 0.03, 0.5]);
    for (value, by_hand) in corrected.iter().zip([0.09, 0.04, 0.09, 0.5]) {
        assert!((value - by_hand).abs() < 1e-12, "{corrected:?}");
    }
    assert!(holm(&[]).is_empty());
}

/// Number of pairs of runs of one robot, out of `pairs`, that are called different, and the mean of their chi-square.
fn differences_of_pairs(truth: &Robot, pairs: u64) -> (usize, f64) {
    let (mut different, mut chi2) = (0, 0.0);
    for pair in 0..pairs {
        let first = run_on(truth, "mini", 20, 1000 + 2 * pair);
        let second = run_on(truth, "mini", 20, 1001 + 2 * pair);
        let comparison = compared(&first, &second);
        different += usize::from(comparison.is_different());
        let global = comparison.global.unwrap();
        assert_eq!(global.degrees_of_freedom, 19);
        chi2 += global.chi2 / pairs as f64;
    }
    (different, chi2)
}

#[test]
fn two_runs_of_one_robot_are_called_different_as_often_as_stated() {
    // Called different with 5 % at most: more than 10 of 60 with a probability below 0.001. The mean of
    // chi-square with 19 degrees of freedom is outside 19 +- 4 sqrt(38/60) = 19 +- 3.2 with a probability below 1e-4.
    let (different, chi2) = differences_of_pairs(&true_robot("mini"), 60);
    assert!(different <= 10, "{different}");
    assert!((chi2 - 19.0).abs() < 3.2, "{chi2}");
}

#[test]
fn parts_that_deviate_in_both_runs_alike_are_no_difference() {
    // As above, of 30 pairs: 19 +- 4 sqrt(38/30) = 19 +- 4.5.
    let (different, chi2) = differences_of_pairs(&true_machine("mini"), 30);
    assert!(different <= 7, "{different}");
    assert!((chi2 - 19.0).abs() < 4.5, "{chi2}");
}

#[test]
fn a_moved_pulley_is_found_as_precisely_as_on_exact_parts() {
    let [exact, machine] = [true_robot("mini"), true_machine("mini")].map(|truth| {
        let mut changed = truth.clone();
        changed.cables[2].pulley.entry_point_m[0] += 0.01;
        let first = run_on(&truth, "mini", 25, 300);
        let second = run_on(&changed, "mini", 25, 400);
        let comparison = compared(&first, &second);
        assert_eq!(moved(&comparison), ["cable-3"]);
        comparison.pulleys[2].relative.unwrap().length_sd_m()
    });
    assert!(machine < 1.2 * exact, "{machine} {exact}");
}

#[test]
fn one_moved_pulley_is_found_and_only_that() {
    // Another pulley is called moved as well with a probability of 5 % at most per run: none in 5 runs here.
    let truth = true_robot("mini");
    let mut changed = truth.clone();
    changed.cables[2].pulley.entry_point_m[0] += 0.01;
    for seed in 0..5 {
        let first = run_on(&truth, "mini", 25, 300 + seed);
        let second = run_on(&changed, "mini", 25, 400 + seed);
        let comparison = compared(&first, &second);
        assert_eq!(moved(&comparison), ["cable-3"], "{seed}");
        let found = comparison.pulleys[2].relative.unwrap();
        let off = found.vector_m - Vec3::new(0.01, 0.0, 0.0);
        let chi2 = off.dot(&(found.covariance.try_inverse().unwrap() * off));
        // Chi-square with 3 degrees of freedom exceeds 21.1 with a probability of 1e-4.
        assert!(chi2 < 21.1, "{chi2} {found:?}");
        assert!((found.length_m() - 0.01).abs() < 5.0 * found.length_sd_m());
        assert!(comparison.global.unwrap().p_value < 1e-4);
        assert!(comparison.is_different());
    }
}

#[test]
fn a_common_shift_moves_no_pulley() {
    let truth = true_robot("mini");
    // The platform was 5 mm and 0.3 degrees elsewhere when the encoders were zeroed, which nobody knows.
    let mut elsewhere = truth.clone();
    let home = elsewhere.home.as_mut().unwrap();
    home.position_m[0] += 5e-3;
    let first = run_on(&truth, "mini", 25, 11);
    let second = run_on(&elsewhere, "mini", 25, 12);
    let comparison = compared(&first, &second);
    assert!(moved(&comparison).is_empty(), "{:?}", comparison.pulleys);
    assert!(!comparison.is_different());
    let motion = comparison.motion.clone().unwrap();
    assert_eq!(motion.freedom, 6);
    // The platform is taken to be at home, so the pulleys seem to be where the home pose has them.
    let sd = motion.covariance[(0, 0)].sqrt();
    assert!((motion.shift_m.x + 5e-3).abs() < 5.0 * sd, "{motion:?}");
    assert!(motion.test.unwrap().p_corrected < 1e-3);
    let raw = comparison.pulleys.iter().map(|p| p.raw.vector_m.x);
    assert!(raw.sum::<f64>() / 8.0 < -3e-3);
}

#[test]
fn known_coordinates_leave_no_motion_in_their_directions() {
    // Across the plane the pulleys of the planar robot are known, so x, y and the rotation about z remain.
    let truth = true_robot("planar");
    let first = run_on(&truth, "planar", 25, 21);
    let second = run_on(&truth, "planar", 25, 22);
    let comparison = compared(&first, &second);
    let motion = comparison.motion.clone().unwrap();
    assert_eq!(motion.freedom, 3);
    assert!(motion.shift_m.z.abs() < 1e-12 && motion.rotation_rad.x.abs() < 1e-12);
    assert_eq!(comparison.pulleys[0].test.unwrap().degrees_of_freedom, 2);
    assert!(comparison.pulleys.iter().all(|p| p.raw.vector_m.z == 0.0));
    assert!(!comparison.is_different());

    let exactly = |mut dataset: Dataset| {
        let home = dataset.robot.home.as_mut().unwrap();
        (home.position_sd_m, home.orientation_sd_rad) = (0.0, 0.0);
        dataset
    };
    let comparison = compared(&exactly(first), &exactly(second));
    assert_eq!((comparison.motion, comparison.home), (None, None));
}

#[test]
fn effects_are_compared_by_name() {
    let truth = true_robot("mini");
    let mut drifting = truth.clone();
    drifting.effects.push(crate::effect::EffectSetting {
        effect: "winch_scale".into(),
        targets: vec!["cable-2".into()],
        parameters: [("scale".to_owned(), 0.01)].into(),
    });
    let first = run_on(&truth, "mini", 25, 31);
    let second = run_on(&drifting, "mini", 25, 32);
    let both = compared_with(
        &first,
        &second,
        ["winch_scale:cable-2", "winch_scale:cable-2,laser_scale"],
    );
    let scale = &both.effects[0];
    assert_eq!(
        (scale.effect.as_str(), scale.targets[0].as_str()),
        ("winch_scale", "cable-2")
    );
    assert!((scale.size.difference.abs() - 0.01).abs() < 5.0 * scale.size.sd);
    assert!(scale.size.test.unwrap().p_corrected < LEVEL);
    let only = &both.effects[1];
    assert!(only.size.first.is_none() && only.size.second.is_some());
    assert!(moved(&both).is_empty());
}

#[test]
fn other_robots_are_refused() {
    let mini = run_on(&true_robot("mini"), "mini", 20, 1);
    let planar = run_on(&true_robot("planar"), "planar", 20, 1);
    let problems = [&mini, &planar].map(|dataset| Problem::new(dataset).unwrap());
    let solutions = problems
        .each_ref()
        .map(|problem| solve(problem, &Options::default(), &mut |_| Control::Continue).unwrap());
    let [one, other] = [0, 1].map(|k| Identified {
        problem: &problems[k],
        solution: &solutions[k],
    });
    let error = compare(&one, &other, LEVEL).unwrap_err();
    assert!(matches!(error, ComparisonError::OtherCables { .. }));
}
