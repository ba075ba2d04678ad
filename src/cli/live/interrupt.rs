//! The operator's interrupt, Ctrl-C, which ends a run in an orderly way.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was interrupted twice.
const INTERRUPTED: i32 = 130;

/// From now on notes an interrupt instead of ending the program; the second one ends it.
///
/// # Errors
/// If the operating system does not allow it: then a robot must not move.
pub fn listen() -> anyhow::Result<()> {
    let note = || {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(note).map_err(|error| anyhow::anyhow!("Ctrl-C cannot be handled: {error}"))
}

/// Whether there was an interrupt.
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
