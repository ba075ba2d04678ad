//! Moving to the targets of a verification.

use anyhow::{Result, anyhow};
use tautline_link::Instrument;
use tautline_link::verifying::{CheckTarget, VerifyingEvent, VerifyingOptions, VerifyingRun};
use tautline_session::{CheckKind, CheckRow};

use super::typed::{Target, TypedInstrument};
use crate::BadInput;
use crate::live::{Connection, interrupt};
use crate::progress::ProgressLine;
use tautline_workflow::wording::sentence;

/// Moves home and then to every target in every cycle.
///
/// # Errors
/// If the controller or the instrument fails, or the operator interrupts it; nothing is kept then.
pub fn drive(
    connection: &mut Connection,
    targets: Vec<CheckTarget>,
    cycles: usize,
) -> Result<Vec<CheckRow>> {
    let typed = connection.instrument.is_none();
    let target = Target::default();
    let mut instrument: Box<dyn Instrument> = match connection.instrument.take() {
        Some(instrument) => instrument,
        None => Box::new(TypedInstrument(target.clone())),
    };
    let mut options = VerifyingOptions {
        cycles,
        ..VerifyingOptions::default()
    };
    if typed {
        options.measurements = 1;
        // The operator may take any amount of time.
        options.timeout_s = f64::INFINITY;
    }
    let mut run = VerifyingRun::new(targets.clone(), options);
    if !connection.go_home()? {
        return Err(interrupted());
    }
    let mut rows = Vec::new();
    let mut progress = ProgressLine::new();
    loop {
        if interrupt::requested() {
            connection.stop();
            return Err(interrupted());
        }
        connection.step();
        match run.tick(&mut *connection.controller, instrument.as_mut()) {
            Some(VerifyingEvent::Commanded { done, of }) => {
                let name = name(&targets, done);
                // A question names its target.
                if !typed {
                    progress.show(|| format!("target {done} of {of}: {name}"));
                }
                target.set(name);
            }
            Some(VerifyingEvent::Attained(row)) => rows.push(row),
            Some(VerifyingEvent::Finished) => return Ok(rows),
            Some(VerifyingEvent::Failed(text)) => {
                connection.stop();
                let text = sentence(&text);
                return Err(match target.is_missed() {
                    true => BadInput::new(text),
                    false => anyhow!("{text}"),
                });
            }
            Some(VerifyingEvent::Wanted { .. }) | None => {}
        }
    }
}

fn interrupted() -> anyhow::Error {
    anyhow!("Stopped by the operator: this verification is discarded")
}

/// Name of the target number `done`, counted from 1.
fn name(targets: &[CheckTarget], done: usize) -> String {
    let target = &targets[done.saturating_sub(1) % targets.len()];
    match target.kind {
        CheckKind::Pose => target.target.clone(),
        CheckKind::Path => format!("{}, point {}", target.target, target.sample),
    }
}
