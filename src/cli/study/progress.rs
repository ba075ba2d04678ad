//! How far a study is, on one line of a terminal.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between two updates.
const INTERVAL: Duration = Duration::from_millis(200);

/// A line on standard error that is written over; nothing where that is no terminal.
pub struct Progress {
    what: &'static str,
    began: Instant,
    shown: Option<Instant>,
}

impl Progress {
    /// Of a number of these.
    pub fn new(what: &'static str) -> Self {
        Self {
            what,
            began: Instant::now(),
            shown: None,
        }
    }

    /// Shows how much is done.
    pub fn show(&mut self, done: u64, all: u64) {
        let is_due = done == all || self.shown.is_none_or(|shown| shown.elapsed() >= INTERVAL);
        let mut out = std::io::stderr();
        if !is_due || !out.is_terminal() {
            return;
        }
        self.shown = Some(Instant::now());
        let rate = done as f64 / self.began.elapsed().as_secs_f64().max(1e-9);
        let end = if done == all { "\n" } else { "" };
        // A terminal that takes nothing is no reason to stop.
        let _ = write!(
            out,
            "\r{done} of {all} {}, {rate:.0} per second {end}",
            self.what
        );
        let _ = out.flush();
    }
}
