//! Settling an interrupted adjustment: the program was killed, or the connection was lost for good.

use anyhow::{Result, anyhow};
use tautline_link::adjusting::{ControllerValues, check_values, settle_adjustment};
use tautline_session::{Adjustment, Outcome};
use tautline_workflow::adjusting;

use super::Arguments;
use super::writing::{WriteOutcome, conclude};
use crate::failure::Reservation;
use crate::live::{Connection, SessionFile, interrupt, link_error};
use tautline_workflow::adjusting::AdjustmentDocument;

/// Remaining step after settling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// Nothing remains to be done.
    Done,
    /// The values in the controller must still be rolled back.
    RollBack,
}

/// Reports the state of the controller, and restores the old values unless all are new or all are old.
///
/// # Errors
/// [`Reservation::Settled`] if nothing else was requested; or if the controller cannot be read or still holds a mixture.
pub fn settle(
    arguments: &Arguments,
    file: &mut SessionFile,
    connection: &mut Connection,
    open: &Adjustment,
) -> Result<Next> {
    let [old, new] = adjusting::old_and_new(open);
    let found = check_values(&mut *connection.controller, &old, &new).map_err(link_error)?;
    let mut document = AdjustmentDocument::new(connection.controller.identity());
    document.set_interrupted(&found);
    if arguments.dry_run {
        document.outcome = "not_written".to_owned();
        document.text = Some(adjusting::found(open, &found));
        return arguments.deliver(&document).map(|()| Next::Done);
    }
    if matches!(found, ControllerValues::Mixed(_)) {
        let robot = &arguments.robot_arguments;
        robot.require_arm("The old values were not restored")?;
        interrupt::finish_first()?;
        connection.arm()?;
    }
    let output = arguments.json.reserve(&document)?;
    let attempt = settle_adjustment(&mut *connection.controller, &old, &new).map_err(link_error)?;
    let kept = adjusting::not_restored(&file.session);
    let (outcome, text) = adjusting::settled(open, &found, &attempt, kept.as_deref());
    let written = WriteOutcome {
        attempt: Some(attempt),
        outcome,
        text,
    };
    conclude(file, connection, &written)?;
    let goes_on = match (&written.outcome, arguments.roll_back, open.restores) {
        (Outcome::Written, true, _) | (Outcome::Failed(_), true, true) => Next::RollBack,
        _ => Next::Done,
    };
    if goes_on == Next::RollBack {
        super::message(arguments, &written.text);
        return Ok(goes_on);
    }
    written.deliver(output, document)?;
    match written.outcome {
        Outcome::Unsettled(text) => Err(anyhow!("{text}")),
        Outcome::RolledBack if arguments.roll_back && kept.is_some() => {
            Err(anyhow!("{}", kept.unwrap_or_default()))
        }
        // The old values were requested, and they are in the controller.
        _ if arguments.roll_back => Ok(Next::Done),
        _ => Err(Reservation::Settled.into()),
    }
}
