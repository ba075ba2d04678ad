//! Decisions as part of the document of a measuring run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::Robot;
use tautline_core::sequential::{Assessment, Decision, Goal, NextStep};

use super::wording::{obstacle_in_words, set_in_words};

/// A goal, and whether it is reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GoalDocument {
    /// The goal as given on the command line.
    pub goal: String,
    /// Whether the goal is reached.
    pub reached: bool,
}

/// A pose that was chosen because of the goals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DecidedPose {
    /// Label of the pose.
    pub pose: i64,
    /// Reason for the choice.
    pub reason: String,
}

/// A set of causes that is possible.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PossibleSet {
    /// The causes in words.
    pub causes: String,
    /// Posterior probability, as computed.
    pub probability: f64,
}

/// Smallest probability of a set that is listed.
const LISTED: f64 = 0.01;

/// Result of a run that measured until its goals were reached.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UntilDocument {
    /// The goals.
    pub goals: Vec<GoalDocument>,
    /// Reason why the run ended: reached, cannot_get_closer or at_limit; null if it was interrupted.
    pub end: Option<String>,
    /// Advice, one sentence for each goal that cannot be reached.
    pub help: Vec<String>,
    /// Probability that the findings are what is wrong and nothing else is; null if causes were not asked for.
    pub explained: Option<f64>,
    /// Probability that no fault is present that the instruments can show; null if causes were not asked for.
    pub fault_free: Option<f64>,
    /// The sets of causes that are possible, most probable first.
    pub sets: Vec<PossibleSet>,
    /// The poses chosen in this run, with the reasons.
    pub poses: Vec<DecidedPose>,
}

impl UntilDocument {
    /// The document of a run with its last decision.
    #[must_use]
    pub fn of(
        robot: &Robot,
        goals: &[Goal],
        last: Option<&Decision>,
        poses: Vec<DecidedPose>,
    ) -> Self {
        let known = last.and_then(|decision| decision.assessment.as_ref());
        let reached = |goal: &Goal| known.is_some_and(|known| known.reaches(*goal));
        let step = last.map(|decision| &decision.step);
        let help = match step {
            Some(NextStep::CannotGetCloser(obstacles)) => obstacles
                .iter()
                .map(|obstacle| obstacle_in_words(robot, obstacle))
                .collect(),
            _ => Vec::new(),
        };
        let about_causes = known.filter(|_| {
            let mut goals = goals.iter();
            goals.any(|goal| !matches!(goal, Goal::Accuracy(_)))
        });
        Self {
            goals: goals
                .iter()
                .map(|goal| GoalDocument {
                    goal: goal.to_string(),
                    reached: reached(goal),
                })
                .collect(),
            end: step.and_then(end).map(str::to_owned),
            help,
            explained: about_causes.map(|known| known.explained),
            fault_free: about_causes.map(Assessment::fault_free),
            sets: about_causes.map_or_else(Vec::new, |known| sets(robot, known)),
            poses,
        }
    }
}

fn end(step: &NextStep) -> Option<&'static str> {
    match step {
        NextStep::Measure { .. } => None,
        NextStep::Reached => Some("reached"),
        NextStep::CannotGetCloser(_) => Some("cannot_get_closer"),
        NextStep::AtLimit => Some("at_limit"),
    }
}

fn sets(robot: &Robot, known: &Assessment) -> Vec<PossibleSet> {
    let listed = known.sets.iter().filter(|set| set.probability >= LISTED);
    listed
        .map(|set| PossibleSet {
            causes: set_in_words(robot, &set.causes),
            probability: set.probability,
        })
        .collect()
}
