//! Progress of a study, on one line of the terminal.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two updates.
const INTERVAL: Duration = Duration::from_millis(200);

/// A line on standard error that is overwritten; nothing if that is not a terminal.
pub struct Progress {
    what: &'static str,
    began: Instant,
    shown: Option<Instant>,
}

impl Progress {
    /// Progress in units of `what`.
    pub fn new(what: &'static str) -> Self {
        Self {
            what,
            began: Instant::now(),
            shown: None,
        }
    }

    /// Shows how many are done.
    pub fn show(&mut self, done: u64, all: u64) {
        let is_due = done == all || self.shown.is_none_or(|shown| shown.elapsed() >= INTERVAL);
        let mut out = std::io::stderr();
        if !is_due || !out.is_terminal() {
            return;
        }
        self.shown = Some(Instant::now());
        let rate = done as f64 / self.began.elapsed().as_secs_f64().max(1e-9);
        let end = if done == all { "\n" } else { "" };
        // Failing to write to the terminal is no reason to stop.
        let _ = write!(
            out,
            "\r{done} of {all} {}, {rate:.0} per second {end}",
            self.what
        );
        let _ = out.flush();
    }
}
