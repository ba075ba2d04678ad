//! Human-readable form of a history.

use tautline_core::history::{CERTAIN, Part};
use tautline_workflow::history::{
    RobotHistory, RobotRecord, change_sentence, drift_sentence, due_sentence,
};

use crate::output::say;
use crate::table::{self, mm};

/// Prints one row for each session, then what changed and when to calibrate again.
pub fn print(record: &RobotRecord, found: &RobotHistory) {
    let history = &found.history;
    say!("{}", record.title());
    let mut rows = table::numbers(&[
        "Session",
        "measured",
        "poses",
        "model explains",
        "largest sd mm",
        "largest move since before mm",
    ]);
    for (index, session) in record.sessions.iter().enumerate() {
        let solution = &session.identification.solution;
        let explains = match solution.p_value() {
            Some(p) if p < 0.01 => "no",
            Some(_) => "yes",
            None => "",
        };
        let pulleys = || {
            let parts = history.parts.iter().zip(&history.states);
            parts.filter_map(|(part, states)| matches!(part, Part::Pulley(_)).then_some(states))
        };
        let sd = pulleys().flat_map(|states| {
            states[index]
                .covariance
                .diagonal()
                .iter()
                .copied()
                .collect::<Vec<_>>()
        });
        let sd = sd.fold(0.0, f64::max).sqrt();
        let moved = index.checked_sub(1).map(|before| {
            let moves =
                pulleys().map(|states| (&states[index].value - &states[before].value).norm());
            mm(moves.fold(0.0, f64::max), 2)
        });
        table::push(
            &mut rows,
            &[
                session.name.clone(),
                session
                    .time
                    .map_or_else(String::new, |time| time.to_string()[..10].to_owned()),
                session
                    .identification
                    .dataset
                    .measurements
                    .len()
                    .to_string(),
                explains.to_owned(),
                mm(sd, 2),
                moved.unwrap_or_default(),
            ],
        );
    }
    say!("{rows}");
    for jump in &history.jumps {
        let (part, axes) = (&history.parts[jump.part], &history.axes[jump.part]);
        say!("{}", change_sentence(record, jump, part, axes));
    }
    for drift in history.evident_drifts().filter(|_| found.is_dated) {
        let (part, axes) = (&history.parts[drift.part], &history.axes[drift.part]);
        say!("{}", drift_sentence(record, drift, part, axes));
    }
    let is_certain = history.jumps.iter().any(|jump| jump.probability >= CERTAIN)
        || history
            .evident_drifts()
            .any(|drift| drift.probability >= CERTAIN);
    if !is_certain {
        say!("No change is certain: all sessions agree within the noise.");
    }
    let last = record.sessions.last().and_then(|session| session.time);
    if let Some((forecast, last)) = found.forecast.as_ref().zip(last) {
        say!("{}", due_sentence(forecast, last));
    }
}
