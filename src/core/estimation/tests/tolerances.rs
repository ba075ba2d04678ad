//! Estimation with tolerances of the parts.

use super::*;
use crate::effect::EffectSetting;
use crate::robot::PartTolerances;
use crate::simulation::run_of_machine;

const POSES: usize = 30;
const RUNS: u64 = 10;

/// Solution with the stated tolerances, or with all parts exact.
fn fitted(run: &Simulated, with_tolerances: bool) -> Solution {
    let exact = Problem::new(&run.dataset).unwrap();
    let first = solved(&exact);
    if !with_tolerances {
        return first;
    }
    let tolerances = run.dataset.robot.tolerances.clone().unwrap();
    let problem = exact.with_tolerances(&tolerances).at_poses_of(&first);
    let solution = solved(&problem);
    assert!(solution.converged());
    solution
}

/// Squared errors of the entry points in their standard deviations.
fn squared_errors(run: &Simulated, solution: &Solution) -> Vec<f64> {
    let parameters = solution.parameters.iter().enumerate();
    let square = |(k, parameter): (usize, &Parameter)| {
        let ParameterId::EntryPoint { cable, axis } = parameter.id else {
            return None;
        };
        let truth = run.truth.cables[cable].pulley.entry_point_m[axis];
        let error = solution.globals.entry_points[cable][axis] - truth;
        Some((error / solution.standard_deviation(k).unwrap()).powi(2))
    };
    parameters.filter_map(square).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The machines are made by changing their descriptions, so no effect takes part in making the readings. Each run has
/// about ten independent errors among its 24; the mean of 100 squares lies outside 0.5 to 1.6 with a probability below
/// 1e-3.
#[test]
fn standard_deviations_are_right_on_machines_whose_parts_are_off() {
    let (mut exact, mut tolerant, mut misfit) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..RUNS {
        let run = run_of_machine("mini", POSES, 100 + seed);
        exact.extend(squared_errors(&run, &fitted(&run, false)));
        let solution = fitted(&run, true);
        tolerant.extend(squared_errors(&run, &solution));
        misfit.push(solution.chi2 / solution.degrees_of_freedom);
    }
    let (exact, tolerant, misfit) = (mean(&exact), mean(&tolerant), mean(&misfit));
    assert!((0.5..1.6).contains(&tolerant), "{tolerant}");
    assert!(exact > 1.3 * tolerant, "{exact} and {tolerant}");
    // The mean of ten chi-squares of 264 degrees of freedom has a standard deviation of 0.03.
    assert!((misfit - 1.0).abs() < 0.12, "{misfit}");
}

/// A deviation that a model states is the same as a description with the deviating value.
#[test]
fn a_stated_deviation_changes_the_prediction_as_its_part_does() {
    let run = run_of("mini", POSES, 3);
    let mut stated = run.dataset.clone();
    stated.robot.deviations = vec![
        EffectSetting {
            effect: "winch_scale".into(),
            targets: vec!["cable-3".into()],
            parameters: [("scale".to_owned(), 2e-3)].into(),
        },
        EffectSetting {
            effect: "platform_anchor".into(),
            targets: vec!["cable-5".into()],
            parameters: [("x".to_owned(), 1e-3)].into(),
        },
    ];
    let mut described = run.dataset.clone();
    described.robot.cables[2].winch.drum_diameter_m *= 1.0 + 2e-3;
    described.robot.cables[4].platform_anchor_m[0] += 1e-3;
    let [stated, described] = [stated, described].map(|dataset| {
        let problem = Problem::new(&dataset).unwrap();
        let first = solved(&problem);
        solved(&problem.at_poses_of(&first)).chi2
    });
    // The pitch of the drum's helix is part of the cable per revolution, but not of the diameter.
    assert!(
        (stated / described - 1.0).abs() < 1e-3,
        "{stated} and {described}"
    );
}

/// A free effect stands for the whole deviation of its part, which therefore has no parameter of its own.
#[test]
fn a_free_effect_replaces_the_deviation_of_its_part() {
    let run = run_of("mini", POSES, 4);
    let typical = PartTolerances::typical();
    let mut problem = Problem::new(&run.dataset)
        .unwrap()
        .with_tolerances(&typical);
    let all = problem.deviations.len();
    problem
        .free(&[crate::effect::EffectRequest::parse("winch_scale:cable-2").unwrap()])
        .unwrap();
    assert_eq!(problem.deviations.len(), all - 1);
    let solution = solved(&problem);
    let rebuilt = Problem::new(&run.dataset)
        .unwrap()
        .with_effects(problem.free_effects.clone())
        .with_deviations_of(&solution);
    assert_eq!(rebuilt.parameters(), solution.parameters);
}
