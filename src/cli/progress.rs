//! Progress on one line of the terminal.

use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

use crate::output::is_quiet;

/// Time between two updates; shorter work shows none.
const INTERVAL: Duration = Duration::from_millis(250);
/// Returns to the beginning of the line and clears it.
const CLEAR: &str = "\r\x1b[2K";

/// Whether progress is shown: on a terminal, unless the command is to be quiet.
pub fn is_shown() -> bool {
    stderr().is_terminal() && !is_quiet()
}

/// Replaces the text of the line. Failing to write to the terminal is no reason to stop.
pub fn overwrite(out: &mut impl Write, text: &str) {
    let _ = write!(out, "{CLEAR}{text}");
    let _ = out.flush();
}

/// Line on standard error that is overwritten, and cleared when it is dropped.
pub struct ProgressLine {
    is_shown: bool,
    updated: Instant,
    has_text: bool,
}

impl ProgressLine {
    /// An empty line.
    pub fn new() -> Self {
        Self {
            is_shown: is_shown(),
            updated: Instant::now(),
            has_text: false,
        }
    }

    /// Shows a text, at most a few times a second.
    pub fn show(&mut self, text: impl FnOnce() -> String) {
        if !self.is_shown || self.updated.elapsed() < INTERVAL {
            return;
        }
        self.updated = Instant::now();
        self.has_text = true;
        overwrite(&mut stderr(), &text());
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if self.has_text {
            overwrite(&mut stderr(), "");
        }
    }
}
