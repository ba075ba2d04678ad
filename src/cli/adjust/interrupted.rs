//! Recovery from an adjustment during which the program was killed.

use anyhow::{Result, anyhow};
use tautline_link::ParameterInfo;
use tautline_link::adjusting::Difference;
use tautline_session::{Adjustment, Outcome, Session, ValueChange};

use super::document::AdjustmentDocument;
use super::writing::{WriteOutcome, attempt, conclude};
use super::{Arguments, message, parameters};
use crate::live::{Connection, SessionFile, link_error};
use tautline_workflow::adjusting::Purpose;
use tautline_workflow::adjusting::former_values;
use tautline_workflow::wording::count;

/// Values of a controller after an interrupted adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InterruptedState {
    /// All old values.
    Old,
    /// All new values.
    New,
    /// Some of both, or others: so many are not the old ones.
    Mixed(usize),
}

/// Whether the last adjustment was interrupted.
pub fn is(session: &Session) -> bool {
    let last = session.adjustments().last();
    last.is_some_and(|last| last.outcome == Outcome::Begun)
}

/// Compares the values of a controller with those from before and those that were to be written.
pub fn found(adjustment: &Adjustment, parameters: &[ParameterInfo]) -> InterruptedState {
    let is_held = |change: &ValueChange, value: f64| {
        let known = parameters.iter().find(|p| p.name == change.name);
        known.is_some_and(|p| {
            let compared = Difference {
                name: String::new(),
                unit: p.unit,
                controller: Some(p.value),
                identified: value,
                difference: None,
                sd: None,
            };
            !compared.is_writable_change()
        })
    };
    let changes = &adjustment.changes;
    let others = changes.iter().filter(|c| !is_held(c, c.before)).count();
    if others == 0 {
        InterruptedState::Old
    } else if changes.iter().all(|c| is_held(c, c.after)) {
        InterruptedState::New
    } else {
        InterruptedState::Mixed(others)
    }
}

/// Reports the values of the controller, and restores the old ones unless all are new.
pub fn settle(
    arguments: &Arguments,
    file: &mut SessionFile,
    connection: &mut Connection,
) -> Result<()> {
    let Some(begun) = file.session.adjustments().last().cloned() else {
        return Ok(());
    };
    let found = found(&begun, &parameters(connection)?);
    let values = count(begun.changes.len(), "value");
    let what = match found {
        InterruptedState::Old => format!("the controller still holds all {values} from before"),
        InterruptedState::New => {
            format!("the controller holds all {values} that were to be written")
        }
        InterruptedState::Mixed(others) => {
            format!(
                "{others} of {values} in the controller differ from before: old and new ones are mixed"
            )
        }
    };
    message(
        arguments,
        &format!("The adjustment of {} was interrupted: {what}.", begun.time),
    );
    let mut document = AdjustmentDocument::new(connection.controller.identity());
    document.set_interrupted(found);
    if arguments.dry_run {
        document.outcome = "not_written".to_owned();
        return arguments.deliver(&document);
    }
    let written = match found {
        InterruptedState::New => WriteOutcome {
            attempt: None,
            outcome: Outcome::Written,
            text: "The adjustment is complete.".to_owned(),
        },
        InterruptedState::Old => WriteOutcome {
            attempt: None,
            outcome: Outcome::Failed("The program ended before a value was written.".to_owned()),
            text: "Nothing was written; the same command writes the values.".to_owned(),
        },
        InterruptedState::Mixed(_) => {
            let robot = &arguments.robot_arguments;
            robot.require_arm("The old values were not restored")?;
            connection.controller.arm().map_err(link_error)?;
            attempt(connection, &former_values(&begun), Purpose::RollBack)
        }
    };
    conclude(file, connection, &written)?;
    document.set_outcome(&written);
    arguments.deliver(&document)?;
    match (found, &written.outcome) {
        (InterruptedState::Mixed(_), Outcome::Failed(text)) => Err(anyhow!("{text}")),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(name: &str) -> ValueChange {
        ValueChange {
            name: name.into(),
            unit: "m".into(),
            before: 1.0,
            after: 1.5,
        }
    }

    #[test]
    fn what_the_controller_holds_is_told_from_its_values() {
        let adjustment = Adjustment {
            time: tautline_workflow::clock::now(),
            operator: String::new(),
            controller: String::new(),
            changes: ["a", "b", "c"].map(change).to_vec(),
            outcome: Outcome::Begun,
        };
        let holding = |values: [f64; 3]| {
            let named = ["a", "b", "c"].iter().zip(values);
            let parameters = named.map(|(name, value)| ParameterInfo {
                name: (*name).to_owned(),
                unit: "m",
                value,
            });
            found(&adjustment, &parameters.collect::<Vec<_>>())
        };
        assert_eq!(holding([1.0, 1.0, 1.0]), InterruptedState::Old);
        assert_eq!(holding([1.5, 1.5, 1.5 + 1e-8]), InterruptedState::New);
        assert_eq!(holding([1.5, 1.0, 1.0]), InterruptedState::Mixed(1));
        assert_eq!(holding([1.5, 1.5, 1.2]), InterruptedState::Mixed(3));
    }
}
