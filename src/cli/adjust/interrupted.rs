//! Settling an adjustment that was interrupted: the program was killed, or the connection was lost and stayed so.

use anyhow::{Result, anyhow};
use tautline_link::adjusting::{Holds, holds, settle_adjustment};
use tautline_session::{Adjustment, Outcome};
use tautline_workflow::adjusting;

use super::Arguments;
use super::document::AdjustmentDocument;
use super::writing::{WriteOutcome, conclude};
use crate::live::{Connection, SessionFile, interrupt, link_error};
use crate::settled::Settled;

/// What is left to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// Nothing.
    Done,
    /// What is there now is still to be rolled back.
    RollBack,
}

/// Reports what the controller holds, and restores the old values unless all are new or all are old.
///
/// # Errors
/// [`Settled`] where that is all that was done; or if the controller cannot be read or still holds a mixture.
pub fn settle(
    arguments: &Arguments,
    file: &mut SessionFile,
    connection: &mut Connection,
    open: &Adjustment,
) -> Result<Next> {
    let [old, new] = adjusting::old_and_new(open);
    let found = holds(&mut *connection.controller, &old, &new).map_err(link_error)?;
    let mut document = AdjustmentDocument::new(connection.controller.identity());
    document.set_interrupted(&found);
    if arguments.dry_run {
        document.outcome = "not_written".to_owned();
        document.text = Some(adjusting::found(open, &found));
        return arguments.deliver(&document).map(|()| Next::Done);
    }
    if matches!(found, Holds::Mixed(_)) {
        let robot = &arguments.robot_arguments;
        robot.require_arm("The old values were not restored")?;
        interrupt::finish_first()?;
        connection.controller.arm().map_err(link_error)?;
    }
    let attempt = settle_adjustment(&mut *connection.controller, &old, &new).map_err(link_error)?;
    let (outcome, text) = adjusting::settled(open, &found, &attempt);
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
    written.tell(&mut document);
    arguments.deliver(&document)?;
    match written.outcome {
        Outcome::Unsettled(text) => Err(anyhow!("{text}")),
        // Asked for, and so it is.
        _ if arguments.roll_back => Ok(Next::Done),
        _ => Err(Settled.into()),
    }
}
