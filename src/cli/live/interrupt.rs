//! The operator's interrupt, Ctrl-C: what goes on is ended in order.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was interrupted twice.
const INTERRUPTED: i32 = 130;

/// Notes an interrupt from now on instead of ending the program; the second one ends it.
///
/// # Errors
/// If the operating system does not allow it: then a robot must not move.
pub fn listen() -> anyhow::Result<()> {
    let note = || {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(note)
        .map_err(|error| anyhow::anyhow!("Ctrl-C cannot be listened to: {error}"))
}

/// Whether there was one.
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
