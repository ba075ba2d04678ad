//! Driving to the targets of a verification.

use anyhow::{Result, anyhow};
use tautline_link::Instrument;
use tautline_link::verifying::{CheckTarget, VerifyingEvent, VerifyingOptions, VerifyingRun};
use tautline_session::{CheckKind, CheckRow};

use super::typed::Typed;
use crate::cli::live::{Connection, interrupt};
use crate::wording::sentence;

/// Drives home and then to every target in every cycle.
///
/// # Errors
/// If the controller or the instrument fails, or the operator interrupts it: then nothing is kept.
pub fn drive(
    connection: &mut Connection,
    targets: Vec<CheckTarget>,
    cycles: usize,
) -> Result<Vec<CheckRow>> {
    let typed = connection.instrument.is_none();
    let mut instrument: Box<dyn Instrument> = match connection.instrument.take() {
        Some(instrument) => instrument,
        None => Box::new(Typed),
    };
    let mut options = VerifyingOptions {
        cycles,
        ..VerifyingOptions::default()
    };
    if typed {
        options.measurements = 1;
        // Nobody is hurried.
        options.timeout_s = f64::INFINITY;
    }
    let mut run = VerifyingRun::new(targets.clone(), options);
    if !connection.go_home()? {
        return Err(interrupted());
    }
    let mut rows = Vec::new();
    loop {
        if interrupt::requested() {
            connection.stop();
            return Err(interrupted());
        }
        connection.step();
        match run.tick(&mut *connection.controller, instrument.as_mut()) {
            Some(VerifyingEvent::Commanded { done, of }) => {
                eprintln!("{}", told(&targets, done, of, typed));
            }
            Some(VerifyingEvent::Attained(row)) => rows.push(row),
            Some(VerifyingEvent::Finished) => return Ok(rows),
            Some(VerifyingEvent::Failed(text)) => {
                connection.stop();
                return Err(anyhow!("{}", sentence(&text)));
            }
            None => {}
        }
    }
}

fn interrupted() -> anyhow::Error {
    anyhow!("Stopped by the operator: nothing of this verification is kept")
}

/// Where the platform is going; what is to be typed there.
fn told(targets: &[CheckTarget], done: usize, of: usize, typed: bool) -> String {
    let count = targets.len().max(1);
    let target = &targets[done.saturating_sub(1) % count];
    let point = match target.kind {
        CheckKind::Pose => String::new(),
        CheckKind::Path => format!(", point {}", target.sample),
    };
    let ask = match typed {
        true => ": x y z [mm]",
        false => "",
    };
    format!("target {done} of {of}: {}{point}{ask}", target.target)
}
