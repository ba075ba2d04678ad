//! Interrupts by the operator (Ctrl-C) or the system, which end a run in an orderly way.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use tautline_core::estimation::Control;

static LISTENS: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Whether the current work runs to its end despite interrupts, which it does if its time is bounded.
static FINISHES: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was interrupted twice.
const INTERRUPTED: i32 = 130;
/// Time that a run has to stop the robot and to withdraw the release after the second interrupt.
const STOPPING: Duration = Duration::from_secs(1);

/// From now on, the first interrupt is only noted, so that the run ends in an orderly way; a second one ends the program, even
/// if the run does not end within a second.
///
/// # Errors
/// If the operating system does not allow it; a robot must not move then.
pub fn listen() -> anyhow::Result<()> {
    if LISTENS.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    let note = || {
        if REQUESTED.swap(true, Ordering::SeqCst) && !FINISHES.load(Ordering::SeqCst) {
            thread::sleep(STOPPING);
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(note).map_err(|error| anyhow::anyhow!("Ctrl-C cannot be handled: {error}"))
}

/// From now on, interrupts are only noted: values of a controller are written or rolled back before the program ends.
///
/// # Errors
/// If the operating system does not allow it; nothing must be written then.
pub fn finish_first() -> anyhow::Result<()> {
    FINISHES.store(true, Ordering::SeqCst);
    listen()
}

/// Whether an interrupt was noted.
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// The decision for work that can be cancelled.
#[must_use]
pub fn control() -> Control {
    if requested() {
        Control::Cancel
    } else {
        Control::Continue
    }
}
