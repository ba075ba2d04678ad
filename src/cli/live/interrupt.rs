//! The operator's interrupt, Ctrl-C, or the request of the system to end, which ends a run in an orderly way.

use std::sync::atomic::{AtomicBool, Ordering};

use tautline_core::estimation::Control;

static LISTENS: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Whether what goes on is finished, however often it is interrupted: it takes a bounded time.
static FINISHES: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was interrupted twice.
const INTERRUPTED: i32 = 130;

/// From now on notes an interrupt instead of ending the program; the second one ends it.
///
/// # Errors
/// If the operating system does not allow it: then a robot must not move.
pub fn listen() -> anyhow::Result<()> {
    if LISTENS.swap(true, Ordering::SeqCst) {
        return Ok(());
    }
    let note = || {
        if REQUESTED.swap(true, Ordering::SeqCst) && !FINISHES.load(Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(note).map_err(|error| anyhow::anyhow!("Ctrl-C cannot be handled: {error}"))
}

/// From now on only notes interrupts: values of a controller are written, or taken back, before the program ends.
///
/// # Errors
/// If the operating system does not allow it: then nothing must be written.
pub fn finish_first() -> anyhow::Result<()> {
    FINISHES.store(true, Ordering::SeqCst);
    listen()
}

/// Whether there was an interrupt.
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// What an interrupt asks of work that can be cancelled.
#[must_use]
pub fn control() -> Control {
    if requested() {
        Control::Cancel
    } else {
        Control::Continue
    }
}
