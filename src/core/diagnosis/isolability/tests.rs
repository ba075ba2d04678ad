//! Predictions against nonlinear fits and against the diagnosis.

use super::*;
use crate::effect::{BoundEffect, Search};
use crate::estimation::{Control, Options, Problem, solve};
use crate::robot::{PartTolerances, StatedTolerances, Tolerance, presets};
use crate::simulation::{SimulationOptions, TrueGeometry, simulate};

fn exact(name: &str, causes: &[BoundEffect]) -> Dataset {
    let mut preset = presets::find(name).unwrap();
    preset.robot.tolerances = Some(PartTolerances::exact());
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects: causes
            .iter()
            .map(|bound| bound.setting(&preset.robot))
            .collect(),
        ..SimulationOptions::new(20, 4)
    };
    simulate(&preset.robot, &options).unwrap().dataset
}

/// Compares with the chi-square of a nonlinear fit to data without noise, which uses neither conditions nor a Gram
/// matrix. The faults are scaled to a noncentrality of 0.01, because some are nonlinear at typical size: half the
/// stiffness doubles the elongation.
#[test]
fn noncentrality_is_the_chi_square_that_a_fit_without_the_fault_leaves() {
    const SMALL: f64 = 0.01;
    let to_rounding = Options {
        negligible: 0.0,
        ..Options::default()
    };
    for name in ["mini", "suspended"] {
        let expected = isolability(&exact(name, &[])).unwrap();
        let mut checked = 0;
        for fault in expected
            .faults
            .iter()
            .filter(|fault| fault.noncentrality > 1.0)
        {
            let mut bound = fault.cause.instances[0].clone();
            let parameters = bound.effect.parameters();
            // Effects without a slope at zero are linear in the square of their parameter only.
            let is_direct = matches!(
                bound.effect.search(),
                Search::Direct | Search::FromPose(_) | Search::AtPose(_)
            );
            if !is_direct || parameters.iter().any(|p| p.start != p.neutral) {
                continue;
            }
            for (value, p) in bound
                .values
                .iter_mut()
                .zip(parameters)
                .filter(|(_, p)| !p.discrete)
            {
                *value = p.neutral + (*value - p.neutral) * (SMALL / fault.noncentrality).sqrt();
            }
            let data = exact(name, &[bound]);
            let problem = Problem::new(&data).unwrap();
            let left = solve(&problem, &to_rounding, &mut |_| Control::Continue).unwrap();
            assert!(
                (left.chi2 / SMALL - 1.0).abs() < 0.05,
                "{name} {:?}: {}",
                fault.cause,
                left.chi2
            );
            checked += 1;
        }
        assert!(checked > 60, "{name}: {checked}");
    }
}

/// A drum that is off by 5 % of its tolerance is no fault, whatever the sensors could show of an exact drum.
#[test]
fn what_lies_within_the_tolerances_is_not_seen() {
    let winch = |tolerance: f64| {
        let mut data = exact("mini", &[]);
        data.robot.tolerances = Some(PartTolerances::Stated(StatedTolerances {
            factor: 1.0,
            effects: [(
                "winch_scale".to_owned(),
                Tolerance::ByCable([("cable-1".to_owned(), tolerance)].into()),
            )]
            .into(),
        }));
        let expected = isolability(&data).unwrap();
        let is_winch = |f: &&ExpectedFault| f.cause.effect().id() == "winch_scale";
        let winch = expected.faults.iter().find(is_winch).unwrap();
        (winch.noncentrality, winch.detection)
    };
    let size = typical_winch_scale();
    let ([exact, seen], [loose, unseen]) = (winch(1e-9).into(), winch(20.0 * size).into());
    assert!(exact > 50.0 && seen > 0.99, "{exact} {seen}");
    // A deviation of prior variance t^2 leaves lambda / (1 + t^2 lambda / size^2) of the noncentrality lambda.
    let expected = exact / (1.0 + 400.0 * exact);
    assert!((loose / expected - 1.0).abs() < 1e-3, "{loose} {expected}");
    assert!(unseen < 0.01, "{unseen}");
}

fn typical_winch_scale() -> f64 {
    let expected = isolability(&exact("mini", &[])).unwrap();
    let is_winch = |f: &&ExpectedFault| f.cause.effect().id() == "winch_scale";
    expected
        .faults
        .iter()
        .find(is_winch)
        .unwrap()
        .cause
        .instances[0]
        .values[0]
        .abs()
}

fn planar_readings() -> Dataset {
    let preset = presets::find("planar").unwrap();
    let run = simulate(&preset.robot, &SimulationOptions::new(15, 3));
    run.unwrap().dataset
}

/// All pairs, with the scores of the readings and with parts of them, which are nearer to the limits.
#[test]
fn bounds_decide_as_the_odds_do() {
    let data = planar_readings();
    let problem = problem_at_fitted_poses(&data).unwrap();
    let fit = Fit::new(&problem, &[]).unwrap();
    let at = LinearFit::new(&fit, true);
    let gram = at.gram(&at.linear.described(0));
    let pairs = gram.candidates.iter().zip(&gram.scores);
    let all: Vec<_> = pairs
        .map(|(candidate, own)| (Evidence::new(candidate, &own.information), &own.score))
        .collect();
    let mut confused = 0;
    for share in [0.3, 1.0, 3.0] {
        let scores: Vec<_> = all.iter().map(|(_, score)| *score * share).collect();
        for (one, (present, _)) in all.iter().enumerate() {
            for (other, (rival, _)) in all.iter().enumerate() {
                let [a, b] = [one, other].map(|k| scores[k].as_slice());
                let expected = is_confused(present.log_odds(a), rival.log_odds(b));
                assert_eq!(are_confused((present, a), (rival, b)), expected);
                confused += usize::from(expected);
            }
        }
    }
    let tried = 3 * all.len() * all.len();
    assert!(
        confused > tried / 100 && confused < tried,
        "{confused} of {tried}"
    );
}

#[test]
fn evidence_is_that_of_the_diagnosis() {
    use super::super::evidence::System;
    let data = planar_readings();
    let problem = problem_at_fitted_poses(&data).unwrap();
    let fit = Fit::new(&problem, &[]).unwrap();
    let at = LinearFit::new(&fit, true);
    let mut gram = at.gram(&at.linear.described(0));
    let none = System::extensible(&mut gram, &[]);
    for (index, candidate) in gram.candidates.iter().enumerate() {
        let own = &gram.scores[index];
        let found = Evidence::new(candidate, &own.information).log_odds(own.score.as_slice());
        let (gain, scale) = none.gain(&gram, index, f64::NEG_INFINITY).unwrap();
        let alone = System::new(&mut gram, &[(index, scale)]);
        let gain = gain + alone.best_scale_of(&gram, 0).unwrap().1;
        assert!(
            (found - gain).abs() < 1e-6 * (1.0 + gain.abs()),
            "{candidate:?}: {found} {gain}"
        );
    }
}

#[test]
fn equal_faults_cannot_be_told_apart() {
    let expected = isolability(&exact("mini", &[])).unwrap();
    let all = &expected.faults;
    for (index, fault) in all.iter().enumerate() {
        assert!((0.0..=1.0).contains(&fault.detection), "{:?}", fault.cause);
        assert!(fault.noncentrality >= -1e-6, "{:?}", fault.cause);
        assert_eq!(expected.pair(index, index).confusion, 0.0);
        assert!(expected.pair(index, index).log_bayes_factor.abs() < 1e-9);
    }
    // The laser cannot distinguish its bias from an offset of its target, which is estimated.
    let bias = all
        .iter()
        .find(|f| f.cause.effect().id() == "laser_bias")
        .unwrap();
    assert!(bias.detection < 0.01, "{bias:?}");
    // Large faults of different winches can be told apart.
    let winches: Vec<usize> = (0..all.len())
        .filter(|k| all[*k].cause.effect().id() == "winch_scale")
        .collect();
    assert_eq!(winches.len(), 8);
    for one in &winches {
        if all[*one].noncentrality > 300.0 {
            let other = winches.iter().find(|k| *k != one).unwrap();
            assert!(expected.pair(*one, *other).log_bayes_factor > 3.0);
        }
    }
}

#[test]
fn points_are_normal_and_independent() {
    for dimensions in 1..=4 {
        let points = normal_points(dimensions, 4096);
        let moments = &points * points.transpose() / 4096.0;
        assert!((moments - DMatrix::identity(dimensions, dimensions)).amax() < 0.01);
    }
}
