//! The clock of a simulated robot, which may run faster than that of the wall.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use tautline_link::Clock;

/// A clock whose speed can be changed; clones show the same time.
#[derive(Debug, Clone)]
pub(super) struct FastClock {
    start: Instant,
    line: Arc<Mutex<Line>>,
}

/// Time as a straight line since the last change of speed.
#[derive(Debug, Clone, Copy)]
struct Line {
    real_s: f64,
    shown_s: f64,
    speed: f64,
}

impl FastClock {
    /// A clock that starts at 0 now.
    pub fn start(speed: f64) -> Self {
        let line = Line {
            real_s: 0.0,
            shown_s: 0.0,
            speed,
        };
        Self {
            start: Instant::now(),
            line: Arc::new(Mutex::new(line)),
        }
    }

    /// Runs so many times faster than real from now on.
    pub fn set_speed(&self, speed: f64) {
        let real_s = self.start.elapsed().as_secs_f64();
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        *line = Line {
            real_s,
            shown_s: line.at(real_s),
            speed,
        };
    }

    /// How many times faster than real it runs.
    pub fn speed(&self) -> f64 {
        self.line
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .speed
    }
}

impl Line {
    fn at(&self, real_s: f64) -> f64 {
        self.shown_s + (real_s - self.real_s) * self.speed
    }
}

impl Clock for FastClock {
    fn now_s(&self) -> f64 {
        let real_s = self.start.elapsed().as_secs_f64();
        let line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        line.at(real_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_does_not_jump_when_the_speed_changes() {
        let line = Line {
            real_s: 2.0,
            shown_s: 10.0,
            speed: 5.0,
        };
        assert_eq!(line.at(4.0), 20.0);
        let clock = FastClock::start(1000.0);
        let before_s = clock.now_s();
        clock.set_speed(1.0);
        assert!(clock.now_s() >= before_s);
        assert_eq!(clock.speed(), 1.0);
    }
}
