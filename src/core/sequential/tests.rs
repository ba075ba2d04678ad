use super::*;
use crate::effect::EffectSetting;
use crate::robot::presets;
use crate::simulation::{SimulationOptions, simulate};

fn design(name: &str, goals: &'static [Goal], at_most: usize) -> SequentialDesign<'static> {
    let robot = presets::find(name).unwrap().robot;
    let options = SequentialOptions {
        goals,
        at_most,
        among: None,
        plan: PlanOptions::new(1, 1),
    };
    SequentialDesign::new(&robot, options).unwrap()
}

/// Measures a simulated robot until a decision ends the run.
fn run(
    design: &SequentialDesign<'_>,
    name: &str,
    effects: &[EffectSetting],
    seed: u64,
) -> (Vec<Reason>, Decision, Measurements) {
    let robot = presets::find(name).unwrap().robot;
    let mut commanded = Vec::new();
    let mut reasons = Vec::new();
    loop {
        let options = SimulationOptions {
            effects: effects.to_vec(),
            // With noise, the earlier readings would change with each further pose.
            noise: false,
            ..SimulationOptions::new(0, seed)
        };
        let measured = simulate(&robot, &options.commanding(commanded.clone()));
        let measured = measured.unwrap().dataset.measurements;
        let decision = design.next(&measured, &[]).unwrap();
        let NextStep::Measure { pose, reason } = &decision.step else {
            return (reasons, decision, measured);
        };
        commanded.push(*pose);
        reasons.push(reason.clone());
    }
}

#[test]
fn an_accuracy_is_reached_and_not_before_it_is() {
    let design = design("mini", &[Goal::Accuracy(2.2e-3)], 40);
    let (reasons, decision, measured) = run(&design, "mini", &[], 610_001);
    assert!(matches!(decision.step, NextStep::Reached), "{decision:?}");
    let reached = decision.assessment.unwrap();
    assert!(reached.largest_sd_m.unwrap() <= 2.2e-3);
    assert!(reasons.len() > FIRST_POSES, "{}", reasons.len());
    let later = &reasons[FIRST_POSES..];
    assert!(
        later
            .iter()
            .all(|reason| matches!(reason, Reason::Narrows(_)))
    );
    // A new decision from the poses before the last one chooses the same pose again.
    let rows: Vec<usize> = (0..measured.len() - 1).collect();
    let before = design.next(&measured.select(&rows), &[]).unwrap();
    let NextStep::Measure { pose, .. } = before.step else {
        panic!("{before:?}");
    };
    let last = measured.commanded.last().unwrap().unwrap();
    assert!(pose.difference(&last).amax() < SAME);
    assert!(before.assessment.unwrap().largest_sd_m.unwrap() > 2.2e-3);
}

#[test]
fn an_accuracy_out_of_reach_is_refused_with_what_limits_it() {
    let design = design("mini", &[Goal::Accuracy(1e-6)], 40);
    let (reasons, decision, _) = run(&design, "mini", &[], 610_002);
    assert_eq!(reasons.len(), FIRST_POSES);
    let NextStep::CannotGetCloser(obstacles) = decision.step else {
        panic!("{decision:?}");
    };
    let [
        Obstacle::Accuracy {
            reachable_m,
            with_home_m,
        },
    ] = obstacles[..]
    else {
        panic!("{obstacles:?}");
    };
    assert!(reachable_m > 1e-6 && with_home_m <= reachable_m);
}

#[test]
fn a_fault_is_named_before_the_limit_and_the_robot_is_not_free_of_it() {
    let fault = EffectSetting {
        effect: "winch_scale".to_owned(),
        targets: vec!["cable-3".to_owned()],
        parameters: [("scale".to_owned(), 0.004)].into(),
    };
    let goals = &[Goal::Cause(0.9), Goal::FaultFree(0.9)];
    let design = design("hall", goals, 40);
    let (reasons, decision, _) = run(&design, "hall", &[fault], 610_003);
    assert!(reasons.len() < 40, "{}", reasons.len());
    let NextStep::CannotGetCloser(obstacles) = &decision.step else {
        panic!("{decision:?}");
    };
    let [Obstacle::Present(cause)] = &obstacles[..] else {
        panic!("{obstacles:?}");
    };
    assert_eq!(cause.effect().id(), "winch_scale");
    assert_eq!(cause.cables(), [2]);
    assert!(decision.assessment.unwrap().explained >= 0.9);
}

#[test]
fn the_limit_ends_a_run_and_excluded_poses_are_not_chosen() {
    let design = design("planar", &[Goal::Accuracy(1.4e-3)], 9);
    let (reasons, decision, measured) = run(&design, "planar", &[], 610_004);
    assert!(matches!(decision.step, NextStep::AtLimit), "{decision:?}");
    assert_eq!(reasons.len(), 9);
    let rows: Vec<usize> = (0..measured.len() - 1).collect();
    let before = measured.select(&rows);
    let excluded = measured.commanded.last().unwrap().unwrap();
    let NextStep::Measure { pose, .. } = design.next(&before, &[excluded]).unwrap().step else {
        panic!("a pose");
    };
    assert!(pose.difference(&excluded).amax() > SAME);
}
