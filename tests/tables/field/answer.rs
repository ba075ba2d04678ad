//! Right answers as data, and what is made of the answer of a diagnosis.

use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{DrawingPattern, Finding, Subject, Verdict};
use tautline_core::effect::Search;
use tautline_workflow::diagnosis::Diagnosed;

/// What should be said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Right {
    /// Causes by effect and cables, counted from 1; an empty list stands for any cables.
    Causes(Vec<(&'static str, Vec<usize>)>),
    /// A wrong reading by its effect, and the label of its pose or the number of its distance.
    WrongReading(&'static str, i64),
    /// Columns in which there is a mistake, beside which nothing is named but an offset.
    Mistake(Vec<String>),
    /// Cable, counted from 1, and labels of the poses at which it is slack.
    Slack(usize, Vec<i64>),
    /// The places of the pulleys.
    Drawing(Option<DrawingPattern>),
    /// Nothing is wrong, or nothing that these readings say.
    Nothing,
    /// Something remains, and one of these may be named.
    AtMost(Vec<&'static str>),
}

/// What an answer is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer {
    /// The cause is named or the mistake said; nothing is said where nothing is wrong.
    Right,
    /// The cause is among those that are possible.
    Listed,
    /// The model explains the readings as it is, and nothing is said.
    Quiet,
    /// It is not said, and nothing else is named.
    Missed,
    /// Something else is named.
    False(String),
}

/// Effect, cables counted from 1, and of a wrong reading the label of its pose or the number of its distance.
type Cause = (&'static str, Vec<usize>, Option<i64>);

fn causes(finding: &Finding) -> impl Iterator<Item = Cause> {
    finding.causes().map(|cause| {
        let cables = cause.cables().into_iter().map(|cable| cable + 1);
        let bound = &cause.instances[0];
        let place = match bound.effect.search() {
            Search::AtPose(k) | Search::AtDistance(k) => Some(bound.values[k] as i64),
            _ => None,
        };
        (cause.effect().id(), cables.collect(), place)
    })
}

/// The cause that states exchanged channels, which the check may leave to the diagnosis.
const EXCHANGED: &str = "cable_swap";
/// Causes that may be named beside a mistake in the readings: what its correction leaves.
const BESIDE_MISTAKES: [&str; 4] = [
    "winch_offset",
    EXCHANGED,
    "tracker_frame",
    "winch_scale_common",
];

/// Judges an answer.
#[must_use]
pub fn judged(told: &Diagnosed, right: &Right) -> Answer {
    let findings = &told.diagnosis.findings;
    let named: Vec<Cause> = (findings.iter())
        .filter(|finding| finding.verdict() == Verdict::Named)
        .flat_map(causes)
        .collect();
    let listed: Vec<Cause> = findings.iter().flat_map(causes).collect();
    let is = |one: &Cause, wanted: &Cause| {
        one.0 == wanted.0
            && (wanted.1.is_empty() || one.1 == wanted.1)
            && (wanted.2.is_none() || one.2 == wanted.2)
    };
    let said: Vec<&str> = (told.mistakes.iter())
        .flat_map(|one| &one.columns)
        .map(String::as_str)
        .collect();
    let slack = told.diagnosis.slack.as_ref();
    let may_be_slack = slack.map(|slack| slack.cable + 1);
    let slack = slack.filter(|slack| slack.is_left_out);
    let may_be_drawing = told.diagnosis.drawing.as_ref();
    let drawing = may_be_drawing.filter(|drawing| drawing.is_named());
    let wanted: Vec<Cause> = match right {
        Right::Causes(wanted) => (wanted.iter())
            .map(|(effect, cables)| (*effect, cables.clone(), None))
            .collect(),
        Right::WrongReading(effect, place) => vec![(*effect, Vec::new(), Some(*place))],
        _ => Vec::new(),
    };
    let is_meant = |one: &Cause| match right {
        Right::Mistake(_) => BESIDE_MISTAKES.contains(&one.0),
        Right::AtMost(effects) => effects.contains(&one.0),
        _ => wanted.iter().any(|wanted| is(one, wanted)),
    };
    let mut other: Vec<String> = (named.iter().filter(|one| !is_meant(one)))
        .map(|one| format!("{one:?}"))
        .collect();
    if !said.is_empty() && !matches!(right, Right::Mistake(_)) {
        other.push(format!("mistake in {said:?}"));
    }
    let has_slack = matches!(right, Right::Slack(..));
    other
        .extend((slack.filter(|_| !has_slack)).map(|one| format!("cable {} slack", one.cable + 1)));
    let has_drawing = matches!(right, Right::Drawing(_) | Right::AtMost(_));
    other
        .extend((drawing.filter(|_| !has_drawing)).map(|one| format!("drawing {:?}", one.pattern)));
    if !other.is_empty() {
        return Answer::False(other.join(", "));
    }
    let all = |among: &[Cause]| {
        let is_there = |wanted| among.iter().any(|one| is(one, wanted));
        wanted.iter().all(is_there)
    };
    let is_right = match right {
        Right::Causes(_) | Right::WrongReading(..) => match all(&listed) {
            true if !all(&named) => return Answer::Listed,
            is_listed => is_listed,
        },
        Right::Mistake(columns) => {
            let exchanged = named.iter().filter(|(effect, ..)| *effect == EXCHANGED);
            let exchanged: Vec<String> = exchanged
                .flat_map(|(_, cables, _)| cables)
                .flat_map(|cable| [format!("rev_{cable}"), format!("length_{cable}_m")])
                .collect();
            let is_said =
                |column: &String| said.contains(&column.as_str()) || exchanged.contains(column);
            columns.iter().all(is_said)
        }
        Right::Slack(cable, _) if slack.is_none() && may_be_slack == Some(*cable) => {
            return Answer::Listed;
        }
        Right::Slack(cable, poses) => {
            slack.is_some_and(|slack| slack.cable + 1 == *cable && slack.poses == *poses)
        }
        Right::Drawing(pattern) => {
            let is_it = |found| pattern.is_none_or(|wanted| wanted == found);
            let mut subjects = (findings.iter().flat_map(|finding| &finding.alternatives))
                .map(|other| &other.subject);
            if subjects.any(|one| matches!(one, Subject::WrongDrawing(found) if is_it(*found))) {
                return Answer::Listed;
            }
            match may_be_drawing {
                Some(found) if !found.is_named() && is_it(found.pattern) => return Answer::Listed,
                found => found.is_some_and(|found| is_it(found.pattern)),
            }
        }
        Right::Nothing => findings.is_empty() && may_be_drawing.is_none() && may_be_slack.is_none(),
        Right::AtMost(_) => true,
    };
    match is_right {
        true => Answer::Right,
        false if told.diagnosis.base.adequate && findings.is_empty() => Answer::Quiet,
        false => Answer::Missed,
    }
}
