//! Progress of reading, on the terminal.

use std::cell::Cell;
use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

/// Time between two updates; shorter work shows none.
const EVERY: Duration = Duration::from_millis(250);

/// Progress line on the terminal that is cleared when it is dropped.
pub struct Progress {
    last: Cell<Instant>,
    is_shown: Cell<bool>,
}

impl Progress {
    pub fn new() -> Self {
        Self {
            last: Cell::new(Instant::now()),
            is_shown: Cell::new(false),
        }
    }

    /// Shows the fraction read so far.
    pub fn show(&self, part: f64) {
        if self.last.get().elapsed() < EVERY || !stderr().is_terminal() {
            return;
        }
        self.last.set(Instant::now());
        self.is_shown.set(true);
        let _ = write!(stderr(), "\r\x1b[2Kreading: {:.0} %", 100.0 * part);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.is_shown.get() {
            let _ = write!(stderr(), "\r\x1b[2K");
        }
    }
}
