//! Time supplied by the caller, so that tests need not wait.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A source of time.
pub trait Clock: Send + Sync {
    /// Seconds since an arbitrary fixed instant; never decreases.
    fn now_s(&self) -> f64;
}

/// The clock of the computer, from 0 at its start.
#[derive(Debug, Clone, Copy)]
pub struct SystemClock {
    start: Instant,
}

impl SystemClock {
    /// A clock that starts now.
    #[must_use]
    pub fn start() -> Self {
        Self {
            start: Instant::now(),
        }
    }
}

impl Clock for SystemClock {
    fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

/// A clock set by hand; clones show the same time.
#[derive(Debug, Clone, Default)]
pub struct ManualClock {
    /// The bits of the time (s).
    now: Arc<AtomicU64>,
}

impl ManualClock {
    /// Advances the clock.
    pub fn advance(&self, seconds: f64) {
        let next = self.now_s() + seconds.max(0.0);
        self.now.store(next.to_bits(), Ordering::Relaxed);
    }
}

impl Clock for ManualClock {
    fn now_s(&self) -> f64 {
        f64::from_bits(self.now.load(Ordering::Relaxed))
    }
}
