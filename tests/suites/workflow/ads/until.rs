//! Measuring until goals are reached, through real frames, by a program that is killed on the way.

use std::collections::BTreeSet;

use tautline_core::sequential::NextStep;
use tautline_validation::support::ads::symbols::Style;
use tautline_validation::support::ads::{Plant, Protocol, User};
use tautline_validation::support::decisions::check_decisions;
use tautline_validation::support::program::{Folder, heard, on_disk};
use tautline_workflow::sequential::UntilRequest;

use super::program::{controller, session};

const GOAL: &str = "accuracy=2mm";
const AT_MOST: usize = 40;

fn poses_are_decided_on_also_by_a_run_that_is_killed(protocol: Protocol) {
    let plant = Plant::fast(protocol, Style::Arrays);
    let user = User::of(&plant);
    let folder = Folder::new();
    let file = folder.join("s.json");
    let controller = controller(&plant);
    let at_most = AT_MOST.to_string();
    let words = [
        "measure",
        &file,
        "--robot",
        "mini",
        "--controller",
        &controller,
        "--until",
        GOAL,
        "--at-most",
        &at_most,
        "--arm",
    ];
    let mut told = Vec::new();
    // Among the first poses, and on the way to one that was decided on.
    for last in ["(4 of 40)", "next: pose 10 "] {
        let killed = heard(user.start(&words), |line, child| {
            if line.contains(last) {
                child.kill().expect("it can be killed");
            }
        });
        assert_eq!(killed.code, None, "{}", killed.stderr);
        told.extend(on_disk(&killed.stderr));
    }
    let ended = user.run(&words).succeeded();
    told.extend(on_disk(&ended.stderr));
    let measured = session(&file);
    let labels = &measured.measurements.labels;
    let once: BTreeSet<i64> = labels.iter().copied().collect();
    assert_eq!(once.len(), labels.len(), "a pose is measured twice");
    assert!(told.iter().all(|label| once.contains(label)), "{told:?}");
    assert_eq!(measured.audit(), []);
    let request = UntilRequest {
        goals: vec![GOAL.parse().expect("a goal")],
        at_most: AT_MOST,
        seed: 1,
        among: None,
    };
    let last = check_decisions(&measured, &request);
    assert!(matches!(last.step, NextStep::Reached), "{:?}", last.step);
    let log = measured.log();
    for label in labels.iter().filter(|label| **label != 0) {
        let chosen = format!("Pose {label} was chosen: it ");
        assert!(
            log.iter().any(|entry| entry.text.starts_with(&chosen)),
            "{chosen}{log:?}"
        );
    }
}

super::over_all! {
    poses_are_decided_on_also_by_a_run_that_is_killed,
}
