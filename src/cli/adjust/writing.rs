//! Writing with a record that is on disk before the first value is written.

use std::thread;
use std::time::Duration;

use anyhow::Result;
use tautline_link::ParameterInfo;
use tautline_link::adjusting::{Adjustment as Attempt, write_adjustment_reconnecting};
use tautline_link::reconnecting::{Attempts, BackOff};
use tautline_session::{Adjustment, Outcome, Phase};

use crate::live::{Connection, SessionFile, link_error};
use tautline_workflow::adjusting::Purpose;
use tautline_workflow::adjusting::{changes, held, outcome, summary};
use tautline_workflow::clock;

/// Attempts to restore a lost connection.
const ATTEMPTS: u32 = 8;
/// Time after which nothing sent over a lost connection can still arrive (s): longer than the timeout of any answer.
const LATE_S: f64 = 1.5;

/// Outcome of writing values.
pub struct WriteOutcome {
    /// The attempt; `None` where nothing was written.
    pub attempt: Option<Attempt>,
    /// For the record.
    pub outcome: Outcome,
    /// For the operator.
    pub text: String,
}

/// Writes values, and records in the session the previous values, the operator and the outcome.
pub fn write(
    file: &mut SessionFile,
    connection: &mut Connection,
    parameters: &[ParameterInfo],
    values: &[(String, f64)],
    purpose: Purpose,
) -> Result<WriteOutcome> {
    connection.controller.arm().map_err(link_error)?;
    let now = clock::now();
    file.session.controller = held(parameters);
    file.session.add_adjustment(Adjustment {
        time: now,
        operator: operator(),
        controller: connection.controller.identity(),
        changes: changes(parameters, &old_values(parameters, values), values),
        outcome: Outcome::Begun,
    });
    file.save()?;
    let written = attempt(connection, values, purpose);
    conclude(file, connection, &written)?;
    Ok(written)
}

/// Writes values, reconnecting where the connection is lost.
pub fn attempt(
    connection: &mut Connection,
    values: &[(String, f64)],
    purpose: Purpose,
) -> WriteOutcome {
    let mut policy = Attempts {
        back_off: BackOff::default(),
        attempts: ATTEMPTS,
        late_s: LATE_S,
        wait: |seconds| thread::sleep(Duration::from_secs_f64(seconds)),
    };
    let controller = &mut *connection.controller;
    let (attempt, text) = match write_adjustment_reconnecting(controller, values, &mut policy) {
        Ok(attempt) => {
            let text = summary(&attempt, purpose, values.len());
            (Some(attempt), text)
        }
        Err(error) => (None, format!("Nothing was written: {error}.")),
    };
    let holds = attempt.as_ref().map(|attempt| &attempt.holds);
    WriteOutcome {
        outcome: outcome(holds, purpose, &text),
        attempt,
        text,
    }
}

/// Records in the session the outcome of the attempt that was begun, and the values of the controller.
pub fn conclude(
    file: &mut SessionFile,
    connection: &mut Connection,
    written: &WriteOutcome,
) -> Result<()> {
    let concluded = written.outcome.clone();
    file.session.conclude_adjustment(concluded, clock::now());
    if let Ok(parameters) = connection.controller.parameters() {
        file.session.controller = held(&parameters);
    }
    file.log(Phase::Accuracy, written.text.clone());
    file.save()?;
    Ok(file.remove_controller()?)
}

/// Present values of the parameters that are to be written.
fn old_values(parameters: &[ParameterInfo], values: &[(String, f64)]) -> Vec<(String, f64)> {
    let known = |name: &str| parameters.iter().find(|p| p.name == name);
    let old = values.iter().filter_map(|(name, _)| known(name));
    old.map(|p| (p.name.clone(), p.value)).collect()
}

/// The user who runs the program.
fn operator() -> String {
    let names = ["USER", "LOGNAME", "USERNAME"].iter();
    let mut found = names.filter_map(|name| std::env::var(name).ok());
    found.find(|name| !name.is_empty()).unwrap_or_default()
}
