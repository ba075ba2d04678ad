//! The clock of a simulated robot, which may run faster than that of the wall.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tautline_link::Clock;

/// A clock that goes on when it is told to; clones show the same time.
///
/// While something goes on it never jumps: a busy computer makes the simulated robot slower, not its samples fewer.
#[derive(Debug, Clone)]
pub struct FastClock {
    hands: Arc<Mutex<Hands>>,
}

#[derive(Debug, Clone, Copy)]
struct Hands {
    moved: Instant,
    shown_s: f64,
    speed: f64,
}

impl FastClock {
    /// A clock that shows 0.
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

    /// Goes on by the time that has passed, by at most `longest_s` where that is given.
    pub fn go_on(&self, longest_s: Option<f64>) {
        let now = Instant::now();
        let mut hands = self.hands();
        let passed = now.saturating_duration_since(hands.moved);
        hands.moved = now;
        hands.pass(passed, longest_s);
    }

    /// Goes on by a time (s) of its own, whatever the wall's clock says.
    pub fn advance(&self, seconds: f64) {
        self.hands().shown_s += seconds.max(0.0);
    }

    /// Runs so many times faster than real from now on.
    pub fn set_speed(&self, speed: f64) {
        self.hands().speed = speed;
    }

    /// How many times faster than real it runs.
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

impl Clock for FastClock {
    fn now_s(&self) -> f64 {
        self.hands().shown_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_runs_at_its_speed_and_does_not_jump_while_something_goes_on() {
        let mut hands = Hands {
            moved: Instant::now(),
            shown_s: 10.0,
            speed: 5.0,
        };
        hands.pass(Duration::from_secs(2), None);
        assert_eq!(hands.shown_s, 20.0);
        hands.pass(Duration::from_secs(2), Some(0.25));
        assert_eq!(hands.shown_s, 20.25);
        let clock = FastClock::start(1000.0);
        assert_eq!(clock.now_s(), 0.0);
        clock.set_speed(2.0);
        clock.go_on(Some(0.0));
        assert_eq!((clock.now_s(), clock.speed()), (0.0, 2.0));
        clock.clone().advance(0.5);
        assert_eq!(clock.now_s(), 0.5);
    }
}
