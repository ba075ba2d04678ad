//! How far a study is, on one line of a terminal.

use std::io::{IsTerminal, Write};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use tautline_study::StudyError;
use tautline_study::run::{Shared, Summary};

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

    /// Runs a study beside, showing how far it is and passing on an interrupt.
    pub fn while_running(
        mut self,
        all: u64,
        interrupted: &dyn Fn() -> bool,
        work: impl FnOnce(&Shared) -> Result<Summary, StudyError> + Send,
    ) -> Result<Summary, StudyError> {
        let shared = Shared::default();
        std::thread::scope(|scope| {
            let running = scope.spawn(|| work(&shared));
            while !running.is_finished() {
                self.show(
                    shared
                        .done
                        .load(Ordering::Relaxed)
                        .min(all.saturating_sub(1)),
                    all,
                );
                if interrupted() {
                    shared.cancelled.store(true, Ordering::Relaxed);
                }
                std::thread::sleep(Duration::from_millis(20));
            }
            let ran = running.join();
            self.show(
                if matches!(ran, Ok(Ok(_))) {
                    all
                } else {
                    shared.done.load(Ordering::Relaxed)
                },
                all,
            );
            ran.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }
}
