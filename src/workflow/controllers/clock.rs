//! The clock of a simulated robot, which may run faster than real time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tautline_link::Clock;

/// A clock that advances only when asked to; clones show the same time.
///
/// Its steps can be limited, so that a busy computer slows the simulated robot instead of reducing its samples.
#[derive(Debug, Clone)]
pub struct SimulationClock {
    hands: Arc<Mutex<Hands>>,
}

#[derive(Debug, Clone, Copy)]
struct Hands {
    moved: Instant,
    shown_s: f64,
    speed: f64,
}

impl SimulationClock {
    /// A clock that starts at 0.
    #[must_use]
    pub fn start(speed: f64) -> Self {
        Self {
            hands: Arc::new(Mutex::new(Hands {
                moved: Instant::now(),
                shown_s: 0.0,
                speed,
            })),
        }
    }

    fn hands(&self) -> MutexGuard<'_, Hands> {
        self.hands.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Advances by the elapsed real time, at most by `longest_s` if given.
    pub fn follow_real_time(&self, longest_s: Option<f64>) {
        let now = Instant::now();
        let mut hands = self.hands();
        let passed = now.saturating_duration_since(hands.moved);
        hands.moved = now;
        hands.pass(passed, longest_s);
    }

    /// Advances by a time (s), independently of real time.
    pub fn advance(&self, seconds: f64) {
        self.hands().shown_s += seconds.max(0.0);
    }

    /// Sets the speed relative to real time.
    pub fn set_speed(&self, speed: f64) {
        self.hands().speed = speed;
    }

    /// Speed relative to real time.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.hands().speed
    }
}

impl Hands {
    fn pass(&mut self, passed: Duration, longest_s: Option<f64>) {
        let step_s = passed.as_secs_f64() * self.speed;
        self.shown_s += step_s.min(longest_s.unwrap_or(f64::INFINITY));
    }
}

impl Clock for SimulationClock {
    fn now_s(&self) -> f64 {
        self.hands().shown_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_runs_at_its_speed_in_limited_steps() {
        let mut hands = Hands {
            moved: Instant::now(),
            shown_s: 10.0,
            speed: 5.0,
        };
        hands.pass(Duration::from_secs(2), None);
        assert_eq!(hands.shown_s, 20.0);
        hands.pass(Duration::from_secs(2), Some(0.25));
        assert_eq!(hands.shown_s, 20.25);
        let clock = SimulationClock::start(1000.0);
        assert_eq!(clock.now_s(), 0.0);
        clock.set_speed(2.0);
        clock.follow_real_time(Some(0.0));
        assert_eq!((clock.now_s(), clock.speed()), (0.0, 2.0));
        clock.clone().advance(0.5);
        assert_eq!(clock.now_s(), 0.5);
    }
}
