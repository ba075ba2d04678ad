//! Writing identified values to a controller: the choice of values, reports and records, for window and commands.
//!
//! An adjustment is recorded before the first value is written and concluded once the state of the controller is known.
//! Until then it is [open](Adjustment::is_open): nothing moves, and nothing else is written, before it is settled with the
//! same old and new values.

mod adaptation;
mod checklist;
mod document;
mod doubts;
mod record;
mod review;

use tautline_link::ParameterInfo;
use tautline_link::adjusting::{self, ControllerValues, Difference};
use tautline_session::{
    Adjustment, CheckRow, NamedValue, Outcome, Session, Stage, StoppedVerification, Timestamp,
    ValueChange,
};

use crate::wording::count;
pub use adaptation::Adaptation;
pub use checklist::{AdjustmentStep, Check, CheckState, checklist};
pub use document::{AdjustmentDocument, DifferenceRow};
pub use doubts::{Doubt, DoubtKind, doubts, finding, implausible, unanswered};
pub use record::{Written, verified_before_last_write, written};
pub use review::Review;

/// Purpose of writing values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Write identified values.
    Adjust,
    /// Restore the previous values.
    RollBack,
}

/// Reason why nothing is written if the controller corrects an unknown effect, which would remain: one sentence without full
/// stop.
#[must_use]
pub fn refusal(differences: &[Difference]) -> Option<String> {
    let unknown = differences.iter().find(|line| line.is_unknown_effect())?;
    Some(format!(
        "the controller has {} = {} of an effect that the model lacks and this program does not know, so nothing is written: \
         end this correction at the controller first",
        unknown.name,
        unknown.controller.unwrap_or(f64::NAN)
    ))
}

/// The last adjustment that changed the controller.
#[must_use]
pub fn in_effect(session: &Session) -> Option<&Adjustment> {
    let mut all = session.adjustments().iter().rev();
    all.find(|adjustment| !matches!(adjustment.outcome, Outcome::Failed(_)))
}

/// The last adjustment, if it can be rolled back.
#[must_use]
pub fn revertible(session: &Session) -> Option<&Adjustment> {
    let last = in_effect(session)?;
    (last.outcome == Outcome::Written && !last.changes.is_empty()).then_some(last)
}

/// The stopped verification that can be continued: nothing was verified or written since.
#[must_use]
pub fn to_continue(session: &Session, stage: Stage) -> Option<&StoppedVerification> {
    let mut stopped = session.stopped_verifications().iter().rev();
    let last = stopped.find(|run| run.stage == stage)?;
    let mut runs = session.verifications().iter();
    let is_replaced = runs.any(|run| run.stage == stage && run.time >= last.time);
    let mut written = session.adjustments().iter();
    let is_other = written.any(|adjustment| adjustment.time >= last.time);
    (!is_replaced && !is_other).then_some(last)
}

/// Summary of a stopped verification, in two sentences.
#[must_use]
pub fn stopped_in_words(run: &StoppedVerification) -> String {
    let all: Vec<f64> = run.rows.iter().map(CheckRow::distance_m).collect();
    let mean_mm = 1e3 * all.iter().sum::<f64>() / all.len().max(1) as f64;
    let largest_mm = 1e3 * all.iter().copied().fold(0.0, f64::max);
    format!(
        "{}: stopped after {} of {} measurements, which are {mean_mm:.2} mm off on average and {largest_mm:.2} mm at most. It \
         continues where it stopped; no accuracy follows from a part.",
        title(run.stage),
        run.rows.len(),
        run.planned
    )
}

/// The adjustment that remains to be settled.
#[must_use]
pub fn open(session: &Session) -> Option<&Adjustment> {
    session.adjustments().last().filter(|last| last.is_open())
}

/// Reason why nothing may move and nothing else may be written: one sentence without full stop, to which the caller adds how to
/// settle the adjustment.
#[must_use]
pub fn unsettled(session: &Session) -> Option<String> {
    let open = open(session)?;
    Some(format!(
        "an adjustment of the controller was interrupted, so {} may be old or new ones",
        match open.changes.len() {
            1 => "1 value".to_owned(),
            values => format!("its {}", count(values, "value")),
        }
    ))
}

/// The values before an adjustment, except those that were not numbers.
#[must_use]
pub fn former_values(adjustment: &Adjustment) -> Vec<(String, f64)> {
    let changes = adjustment.changes.iter();
    changes
        .filter(|change| change.before.is_finite())
        .map(|change| (change.name.clone(), change.before))
        .collect()
}

/// Old and new values of an adjustment, from which it can be settled.
#[must_use]
pub fn old_and_new(adjustment: &Adjustment) -> [Vec<(String, f64)>; 2] {
    let named = |value: fn(&ValueChange) -> f64| {
        let changes = adjustment.changes.iter();
        changes.map(|c| (c.name.clone(), value(c))).collect()
    };
    [named(|change| change.before), named(|change| change.after)]
}

/// The record of an attempt that starts now.
#[must_use]
pub fn begun(
    (controller, operator): (String, String),
    parameters: &[ParameterInfo],
    values: &[(String, f64)],
    purpose: Purpose,
    now: Timestamp,
) -> Adjustment {
    let held = |name: &str| parameters.iter().find(|p| p.name == name);
    let old = values.iter().filter_map(|(name, _)| held(name));
    let old: Vec<(String, f64)> = old.map(|p| (p.name.clone(), p.value)).collect();
    Adjustment {
        time: now,
        operator,
        controller,
        changes: changes(parameters, &old, values),
        outcome: Outcome::Begun,
        read_back: Vec::new(),
        restores: purpose == Purpose::RollBack,
    }
}

/// The state found after an interrupted adjustment, in one sentence.
#[must_use]
pub fn found(open: &Adjustment, found: &ControllerValues) -> String {
    let values = count(open.changes.len(), "value");
    let was = match found {
        ControllerValues::Old => format!("the controller still held all {values} from before"),
        ControllerValues::New => {
            format!("the controller held all {values} that were to be written")
        }
        ControllerValues::Mixed(others) => format!(
            "{} of {values} in the controller differed from before",
            others.len()
        ),
        ControllerValues::Unknown => "the controller did not answer".to_owned(),
    };
    let when = open.time;
    let what = if open.restores {
        "roll-back"
    } else {
        "adjustment"
    };
    format!("The {what} of {when} was interrupted: {was}.")
}

/// The result of settling an adjustment: the outcome for the record, and a text for the operator, which names the values that
/// a roll-back did [not restore](not_restored).
#[must_use]
pub fn settled(
    open: &Adjustment,
    found: &ControllerValues,
    settled: &adjusting::Adjustment,
    not_restored: Option<&str>,
) -> (Outcome, String) {
    let now = match &settled.holds {
        ControllerValues::New => {
            "It is complete: verify the values with a verification run.".to_owned()
        }
        ControllerValues::Old if *found == ControllerValues::Old => {
            "Nothing was written.".to_owned()
        }
        ControllerValues::Old => "The values from before were written and read back.".to_owned(),
        ControllerValues::Mixed(_) | ControllerValues::Unknown => String::new(),
    };
    // The advice names values that are not numbers.
    let advice = match &settled.holds {
        ControllerValues::New => "",
        ControllerValues::Old if *found == ControllerValues::Old => "",
        _ => settled.advice.as_str(),
    };
    let is_rolled_back = settled.holds == ControllerValues::New && open.restores;
    let kept = not_restored.filter(|_| is_rolled_back).unwrap_or_default();
    let parts = [
        self::found(open, found),
        now,
        advice.to_owned(),
        kept.to_owned(),
    ];
    let text = parts
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(" ");
    let outcome = match (&settled.holds, open.restores) {
        (ControllerValues::New, false) => Outcome::Written,
        (ControllerValues::New, true) => Outcome::RolledBack,
        (ControllerValues::Old, false) if *found != ControllerValues::Old => Outcome::RolledBack,
        (ControllerValues::Old, _) => Outcome::Failed(text.clone()),
        (ControllerValues::Mixed(_) | ControllerValues::Unknown, _) => {
            Outcome::Unsettled(text.clone())
        }
    };
    (outcome, text)
}

/// The values that a roll-back of the last written adjustment cannot restore, because they were not numbers before.
#[must_use]
pub fn not_restorable(session: &Session) -> Vec<&ValueChange> {
    let mut all = session.adjustments().iter().rev();
    let written = all.find(|last| !last.restores && last.outcome == Outcome::Written);
    let changes = written.into_iter().flat_map(|written| &written.changes);
    changes
        .filter(|change| !change.before.is_finite())
        .collect()
}

/// Names the values that a roll-back did not restore; `None` if it restored all.
#[must_use]
pub fn not_restored(session: &Session) -> Option<String> {
    let kept = not_restorable(session);
    let list: Vec<String> = kept
        .iter()
        .map(|change| {
            format!(
                "{} was {} and keeps {}",
                change.name, change.before, change.after
            )
        })
        .collect();
    (!list.is_empty()).then(|| {
        format!(
            "Set by hand what was not a number before and cannot be written: {}.",
            list.join("; ")
        )
    })
}

/// Summary of an attempt to write `values` values, for the operator; a roll-back names the values that are
/// [not restored](not_restored).
#[must_use]
pub fn summary(
    adjustment: &adjusting::Adjustment,
    purpose: Purpose,
    values: usize,
    not_restored: Option<&str>,
) -> String {
    let what = match (&adjustment.holds, purpose) {
        (ControllerValues::New, Purpose::Adjust) => {
            format!("{} written and read back.", count(values, "value"))
        }
        (ControllerValues::New, Purpose::RollBack) => match not_restored {
            None => format!("The previous values were restored ({values} changed)."),
            Some(kept) => format!("{values} of the previous values were restored. {kept}"),
        },
        (ControllerValues::Old, _) => "The values were not written.".to_owned(),
        (ControllerValues::Mixed(names), _) => {
            format!("Warning: {} values are only partly written.", names.len())
        }
        (ControllerValues::Unknown, _) => {
            "Warning: the values in the controller are not known.".to_owned()
        }
    };
    let problem = adjustment.problem.as_deref().unwrap_or_default();
    let advice = match purpose {
        Purpose::RollBack if adjustment.holds == ControllerValues::New => "",
        _ => adjustment.advice.as_str(),
    };
    let parts = [what.as_str(), problem, advice].into_iter();
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    parts.join(" ")
}

/// The outcome for the session's record, with the summary as `text`; `holds` is `None` if nothing was written.
#[must_use]
pub fn outcome(holds: Option<&ControllerValues>, purpose: Purpose, text: &str) -> Outcome {
    match (holds, purpose) {
        (Some(ControllerValues::New), Purpose::Adjust) => Outcome::Written,
        (Some(ControllerValues::New), Purpose::RollBack) => Outcome::RolledBack,
        (Some(ControllerValues::Mixed(_) | ControllerValues::Unknown), _) => {
            Outcome::Unsettled(text.to_owned())
        }
        (Some(ControllerValues::Old) | None, _) => Outcome::Failed(text.to_owned()),
    }
}

/// Old and new values side by side, with the units of the controller's parameters.
fn changes(
    parameters: &[ParameterInfo],
    old: &[(String, f64)],
    new: &[(String, f64)],
) -> Vec<ValueChange> {
    let unit = |name: &str| {
        let known = parameters.iter().find(|p| p.name == name);
        known.map_or("", |parameter| parameter.unit).to_owned()
    };
    let pairs = old.iter().zip(new);
    pairs
        .map(|((name, before), (_, after))| ValueChange {
            name: name.clone(),
            unit: unit(name),
            before: *before,
            after: *after,
        })
        .collect()
}

/// The values of a controller as the session records them.
#[must_use]
pub fn held(parameters: &[ParameterInfo]) -> Vec<NamedValue> {
    let parameters = parameters.iter();
    parameters
        .map(|parameter| NamedValue {
            name: parameter.name.clone(),
            value: parameter.value,
        })
        .collect()
}

/// Title of a verification.
#[must_use]
pub fn title(stage: Stage) -> &'static str {
    match stage {
        Stage::Before => "Before the adjustment",
        Stage::After => "After the adjustment",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(outcome: Outcome, restores: bool) -> Adjustment {
        let changes = ["a", "b", "c"].map(|name| ValueChange {
            name: name.into(),
            unit: "m".into(),
            before: 1.0,
            after: 1.5,
        });
        Adjustment {
            time: Timestamp::from_unix_seconds(0),
            operator: String::new(),
            controller: String::new(),
            changes: changes.to_vec(),
            outcome,
            read_back: Vec::new(),
            restores,
        }
    }

    fn session(adjustments: impl IntoIterator<Item = Adjustment>) -> Session {
        let robot = tautline_core::robot::presets::find("mini")
            .expect("a preset")
            .robot;
        let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        adjustments
            .into_iter()
            .for_each(|a| session.add_adjustment(a));
        session
    }

    #[test]
    fn what_is_unknown_or_mixed_stays_open_and_keeps_everything_still() {
        for holds in [
            ControllerValues::Unknown,
            ControllerValues::Mixed(vec!["a".into()]),
        ] {
            for purpose in [Purpose::Adjust, Purpose::RollBack] {
                let outcome = outcome(Some(&holds), purpose, "why");
                let session = session([record(outcome, false)]);
                assert!(open(&session).is_some());
                assert!(
                    unsettled(&session)
                        .expect("a reason")
                        .contains("its 3 values")
                );
                assert!(revertible(&session).is_none());
            }
        }
        for outcome in [
            Outcome::Written,
            Outcome::RolledBack,
            Outcome::Failed("why".into()),
        ] {
            assert!(unsettled(&session([record(outcome, false)])).is_none());
        }
    }

    #[test]
    fn a_failed_roll_back_can_be_repeated() {
        let failed = record(Outcome::Failed("why".into()), true);
        let session = session([record(Outcome::Written, false), failed]);
        assert_eq!(revertible(&session).map(|a| a.restores), Some(false));
        assert_eq!(
            in_effect(&session).map(|a| &a.outcome),
            Some(&Outcome::Written)
        );
    }

    #[test]
    fn a_roll_back_names_what_it_cannot_restore() {
        let mut written = record(Outcome::Written, false);
        written.changes[1].before = f64::NAN;
        let session = session([written, record(Outcome::Begun, true)]);
        let kept = not_restored(&session).expect("a sentence");
        assert!(kept.contains("b was NaN and keeps 1.5"), "{kept}");
        let done = adjusting::Adjustment {
            holds: ControllerValues::New,
            old: Vec::new(),
            problem: None,
            advice: String::new(),
        };
        for kept in [Some(kept.as_str()), None] {
            let text = summary(&done, Purpose::RollBack, 2, kept);
            assert_eq!(
                text.contains("The previous values were restored"),
                kept.is_none(),
                "{text}"
            );
            let open = record(Outcome::Begun, true);
            let (_, settled) = settled(&open, &ControllerValues::New, &done, kept);
            for text in [text, settled] {
                assert_eq!(text.contains("b was NaN"), kept.is_some(), "{text}");
            }
        }
    }

    #[test]
    fn settling_says_what_was_found_and_what_is_there_now() {
        let attempt = |holds| adjusting::Adjustment {
            holds,
            old: Vec::new(),
            problem: None,
            advice: "Advice.".into(),
        };
        let mixed = ControllerValues::Mixed(vec!["a".into()]);
        for (restores, found, holds, expected) in [
            (
                false,
                ControllerValues::New,
                ControllerValues::New,
                Outcome::Written,
            ),
            (
                true,
                ControllerValues::New,
                ControllerValues::New,
                Outcome::RolledBack,
            ),
            (
                false,
                mixed.clone(),
                ControllerValues::Old,
                Outcome::RolledBack,
            ),
        ] {
            let (outcome, _) = settled(
                &record(Outcome::Begun, restores),
                &found,
                &attempt(holds),
                None,
            );
            assert_eq!(outcome, expected);
        }
        let (outcome, text) = settled(
            &record(Outcome::Begun, false),
            &ControllerValues::Old,
            &attempt(ControllerValues::Old),
            None,
        );
        assert!(matches!(outcome, Outcome::Failed(_)));
        assert!(
            text.ends_with("still held all 3 values from before. Nothing was written."),
            "{text}"
        );
        let (outcome, text) = settled(
            &record(Outcome::Begun, true),
            &mixed,
            &attempt(mixed.clone()),
            None,
        );
        assert!(matches!(outcome, Outcome::Unsettled(_)));
        assert!(
            text.starts_with("The roll-back of 1970") && text.ends_with("Advice."),
            "{text}"
        );
    }
}
