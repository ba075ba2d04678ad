//! Decisions of a measurement until goals are reached, repeated from the measured poses.

use std::thread::sleep;
use std::time::Duration;

use tautline_core::sequential::{Decision, NextStep};
use tautline_session::Session;
use tautline_workflow::sequential::{SequentialPlanner, UntilRequest};

/// The decision after each number of the first rows of a session, home included, as a run without interruptions makes it.
///
/// # Panics
/// If the session cannot be identified.
#[must_use]
pub fn decisions(session: &Session, request: &UntilRequest) -> Vec<Decision> {
    let mut planner = SequentialPlanner::start(session, request.clone(), || {}).expect("a robot");
    let after = |rows: usize| {
        let mut before = session.clone();
        let first: Vec<usize> = (0..rows).collect();
        before.measurements = session.measurements.select(&first);
        planner.ask(&before, &[]);
        loop {
            match planner.poll() {
                Some(decision) => return decision.expect("a decision"),
                None => sleep(Duration::from_millis(1)),
            }
        }
    };
    (1..=session.measurements.len()).map(after).collect()
}

/// Checks that every pose of a session but home, which was measured first, was decided on by the poses before, and returns the last
/// decision.
///
/// # Panics
/// If a pose was not decided on by those before.
#[must_use]
pub fn check_decisions(session: &Session, request: &UntilRequest) -> Decision {
    let measured = &session.measurements;
    assert_eq!(measured.labels.first(), Some(&0), "home is first");
    let mut decisions = decisions(session, request);
    let last = decisions.pop().expect("home at least");
    for (row, decision) in (1..).zip(&decisions) {
        let NextStep::Measure { pose, .. } = &decision.step else {
            panic!("pose {} is one too many", measured.labels[row]);
        };
        let commanded = measured.commanded[row].expect("a command");
        let off = pose.difference(&commanded).amax();
        assert!(off < 1e-9, "row {row} is off the decision by {off}");
    }
    last
}
