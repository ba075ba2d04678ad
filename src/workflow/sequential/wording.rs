//! Decisions in words.

use tautline_core::diagnosis::Cause;
use tautline_core::robot::Robot;
use tautline_core::sequential::{Assessment, FIRST_POSES, Goal, NextStep, Obstacle, Reason};

use crate::diagnosis::cause_title;
use crate::wording::{count, first_lower, list, units};

/// Reason why a pose was chosen, to follow its label: `separates winch scale (cable-3) from platform anchor (cable-3)`.
#[must_use]
pub fn reason_in_words(robot: &Robot, reason: &Reason) -> String {
    match reason {
        Reason::First => format!("is one of the {FIRST_POSES} poses that fix the geometry"),
        Reason::Narrows(cable) => format!("narrows the pulley of {}", robot.cables[*cable].name),
        Reason::Separates(one, other) => format!(
            "separates {} from {}",
            set_in_words(robot, one),
            set_in_words(robot, other)
        ),
        Reason::Tests(cause) => format!("shows whether there is {}", name(robot, cause)),
    }
}

/// Goals as a phrase for the middle of a sentence.
#[must_use]
pub fn goals_in_words(goals: &[Goal]) -> String {
    let words: Vec<String> = goals.iter().map(|goal| goal_in_words(*goal)).collect();
    list(&words)
}

fn goal_in_words(goal: Goal) -> String {
    // One decimal only where it says something.
    let percent = |probability: f64| (1e3 * probability).round() / 10.0;
    match goal {
        Goal::Accuracy(limit_m) => {
            format!("all pulleys are accurate to {} mm", units::mm(limit_m, 2))
        }
        Goal::Cause(probability) => {
            format!("it is known to {} % what is wrong", percent(probability))
        }
        Goal::FaultFree(probability) => {
            format!("the robot is free of faults to {} %", percent(probability))
        }
    }
}

/// Reason why a run ended, to follow the measured poses; `None` for a step that does not end it.
#[must_use]
pub fn end_in_words(step: &NextStep) -> Option<&'static str> {
    match step {
        NextStep::Measure { .. } => None,
        NextStep::Reached => Some("all goals reached"),
        NextStep::AtLimit => Some("the largest number of poses reached"),
        NextStep::CannotGetCloser(_) => Some("no pose would bring the goals closer"),
    }
}

/// A set of causes in the middle of a sentence.
#[must_use]
pub fn set_in_words(robot: &Robot, causes: &[Cause]) -> String {
    if causes.is_empty() {
        return "no fault".to_owned();
    }
    let names: Vec<String> = causes.iter().map(|cause| name(robot, cause)).collect();
    list(&names)
}

fn name(robot: &Robot, cause: &Cause) -> String {
    first_lower(&cause_title(robot, cause))
}

/// Reason why a goal cannot be reached, and advice, in one sentence.
#[must_use]
pub fn obstacle_in_words(robot: &Robot, obstacle: &Obstacle) -> String {
    match obstacle {
        Obstacle::Accuracy {
            reachable_m,
            with_home_m,
        } => {
            let mm = |value_m: f64| units::mm(value_m, 2);
            let home = match with_home_m < &(WORTH_SAYING * reachable_m) {
                true => format!(
                    "a more exact home pose ({} mm if it were known exactly) or ",
                    mm(*with_home_m)
                ),
                false => String::new(),
            };
            format!(
                "However many poses are measured, the pulleys stay uncertain by {} mm: {home}another instrument would help.",
                mm(*reachable_m)
            )
        }
        Obstacle::Present(cause) => format!(
            "The robot is not free of faults: there is {}. Mend it and measure another series, or add it to the model.",
            name(robot, cause)
        ),
        Obstacle::Inseparable(one, other) => {
            let checks = checks(one, other);
            let help = match checks.is_empty() {
                true => "a wider workspace or a reading of another kind would".to_owned(),
                false => format!("a check in the workshop does: {}", checks.join(" ")),
            };
            format!(
                "No pose of this workspace tells {} from {}; {help}{}",
                set_in_words(robot, one),
                set_in_words(robot, other),
                if help.ends_with('.') { "" } else { "." }
            )
        }
        Obstacle::NoPoseLeft => {
            "All poses that may be measured are measured: a wider workspace would help.".to_owned()
        }
    }
}

/// Share of the uncertainty above which a more exact home pose is no help.
const WORTH_SAYING: f64 = 0.95;

/// The checks that confirm the causes by which two sets differ.
fn checks(one: &[Cause], other: &[Cause]) -> Vec<&'static str> {
    let mut checks: Vec<&str> = one
        .iter()
        .chain(other)
        .filter_map(|cause| cause.effect().check())
        .collect();
    checks.dedup();
    checks
}

/// Progress towards the goals, in one line.
#[must_use]
pub fn progress_in_words(robot: &Robot, known: &Assessment) -> String {
    let mut parts = Vec::new();
    if let Some(sd_m) = known.largest_sd_m {
        parts.push(format!("pulleys to {} mm", units::mm(sd_m, 2)));
    }
    let percent = |probability: f64| format!("{:.0} %", 100.0 * probability);
    if known.no_further_fault > 0.0 {
        let causes: Vec<Cause> = known
            .findings
            .iter()
            .filter_map(|finding| finding.cause().cloned())
            .collect();
        parts.push(match known.findings.is_empty() {
            true => format!("free of faults {}", percent(known.fault_free())),
            false => format!(
                "{} and nothing else {}",
                set_in_words(robot, &causes),
                percent(known.explained)
            ),
        });
    }
    format!("after {}: {}", count(known.poses, "pose"), parts.join(", "))
}
