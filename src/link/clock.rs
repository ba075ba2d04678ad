//! Time as callers give it, so that a test need not wait.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Where time comes from.
pub trait Clock: Send + Sync {
    /// Seconds since any fixed moment; never goes back.
    fn now_s(&self) -> f64;
}

/// The clock of the machine, from 0 at its start.
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

/// A clock that is set by hand; clones show the same time.
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
