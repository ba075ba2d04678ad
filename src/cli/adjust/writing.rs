//! Writes values, with a record that is on disk before the first value is written.

use std::thread;
use std::time::Duration;

use anyhow::{Result, anyhow};
use tautline_link::ParameterInfo;
use tautline_link::adjusting::{
    Adjustment as Attempt, check_unchanged, write_adjustment_reconnecting,
};
use tautline_link::reconnecting::{Attempts, BackOff};
use tautline_session::{Outcome, Phase};
use tautline_workflow::adjusting::{
    Purpose, begun, held, not_restored, old_and_new, outcome, summary,
};
use tautline_workflow::audit::system_user;
use tautline_workflow::clock;
use tautline_workflow::foreign_writes::{ValuesRead, end_run};

use super::report::print;
use crate::live::{Connection, SessionFile, interrupt};
use crate::output::{ReservedOutput, note};
use tautline_workflow::adjusting::AdjustmentDocument;

/// Number of attempts to restore a lost connection.
const ATTEMPTS: u32 = 8;

/// Outcome of writing values.
pub struct WriteOutcome {
    /// The attempt; `None` if nothing was written.
    pub attempt: Option<Attempt>,
    /// Outcome for the record.
    pub outcome: Outcome,
    /// Outcome in words for the operator.
    pub text: String,
}

impl WriteOutcome {
    /// Adds the outcome to a document, and delivers it.
    ///
    /// # Errors
    /// If it cannot be written; the message starts with the state of the controller.
    pub fn deliver(&self, output: ReservedOutput, mut document: AdjustmentDocument) -> Result<()> {
        let holds = self.attempt.as_ref().map(|attempt| &attempt.holds);
        document.set_outcome(&self.outcome, holds, &self.text);
        let delivered = output.deliver(&document, || print(&document));
        delivered.map_err(|error| anyhow!("{} {error}", self.text))
    }
}

/// Writes values, and records the previous values, the operator and the outcome in the session. Disk space for the
/// outcome is reserved before anything is written.
pub fn write(
    file: &mut SessionFile,
    connection: &mut Connection,
    parameters: &[ParameterInfo],
    values: &[(String, f64)],
    purpose: Purpose,
) -> Result<WriteOutcome> {
    interrupt::finish_first()?;
    connection.arm()?;
    // The values of a killed run have not been compared yet, and are about to be replaced.
    let identity = connection.controller.identity();
    let read = ValuesRead {
        controller: &identity,
        parameters,
    };
    if let Some(text) = end_run(&mut file.session, read, None, clock::now()) {
        note!("{text}");
        file.log(Phase::Poses, text);
    }
    file.session.controller = held(parameters);
    let record = begun(
        (identity, system_user()),
        parameters,
        values,
        purpose,
        clock::now(),
    );
    file.session.add_adjustment(record);
    file.save()?;
    let kept = file.keep_space();
    let written = match &kept {
        Err(error) => unwritten(format!("Nothing was written: {error}.")),
        Ok(_) if interrupt::requested() => {
            unwritten("Nothing was written: the command was interrupted.".to_owned())
        }
        Ok(_) => attempt(file, connection, values, purpose),
    };
    drop(kept);
    conclude(file, connection, &written)?;
    Ok(written)
}

fn unwritten(text: String) -> WriteOutcome {
    WriteOutcome {
        attempt: None,
        outcome: Outcome::Failed(text.clone()),
        text,
    }
}

/// Writes values, and reconnects if the connection is lost. An interrupt takes effect once they are written or rolled back, and
/// ends the attempts to reconnect.
fn attempt(
    file: &SessionFile,
    connection: &mut Connection,
    values: &[(String, f64)],
    purpose: Purpose,
) -> WriteOutcome {
    let mut policy = Attempts {
        back_off: BackOff::default(),
        attempts: ATTEMPTS,
        late_s: connection.late_s,
        wait: wait_unless_interrupted,
        gives_up: interrupt::requested,
    };
    let controller = &mut *connection.controller;
    let recorded = file.session.adjustments().last();
    let [old, _] = recorded.map(old_and_new).unwrap_or_default();
    let attempted = check_unchanged(controller, &old)
        .and_then(|()| write_adjustment_reconnecting(controller, values, &mut policy));
    let (attempt, text) = match attempted {
        Ok(attempt) => {
            let kept = not_restored(&file.session);
            let text = summary(&attempt, purpose, values.len(), kept.as_deref());
            (Some(attempt), text)
        }
        Err(error) => (None, format!("Nothing was written: {error}.")),
    };
    let text = match interrupt::requested() {
        true => format!("The command was interrupted. {text}"),
        false => text,
    };
    let holds = attempt.as_ref().map(|attempt| &attempt.holds);
    WriteOutcome {
        outcome: outcome(holds, purpose, &text),
        attempt,
        text,
    }
}

fn wait_unless_interrupted(seconds: f64) {
    const STEP_S: f64 = 0.05;
    let mut left_s = seconds;
    while left_s > 0.0 && !interrupt::requested() {
        thread::sleep(Duration::from_secs_f64(left_s.min(STEP_S)));
        left_s -= STEP_S;
    }
}

/// Records the outcome of the open adjustment in the session, and the values of the controller.
///
/// # Errors
/// If the record cannot be saved; the message starts with the state of the controller.
pub fn conclude(
    file: &mut SessionFile,
    connection: &mut Connection,
    written: &WriteOutcome,
) -> Result<()> {
    let concluded = written.outcome.clone();
    let holds = connection.controller.parameters().ok();
    let holds = holds.as_deref().map(held);
    let session = &mut file.session;
    session.conclude_adjustment(concluded, holds.as_deref(), clock::now());
    if let Some(holds) = holds {
        session.controller = holds;
    }
    file.log(Phase::Controller, written.text.clone());
    file.save().map_err(|error| {
        anyhow!(
            "{} {} does not record this outcome, only that the adjustment was begun: {error}. Run the same command again once it can be written.",
            written.text,
            file.path.display()
        )
    })?;
    Ok(file.remove_controller()?)
}
