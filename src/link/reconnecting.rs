//! Reconnecting with growing pauses. Nothing here waits: the caller ticks.

use crate::controller::{Activity, Controller};
use crate::error::LinkError;

/// Pauses between attempts to connect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackOff {
    /// Pause before the second attempt (s).
    pub first_s: f64,
    /// Ratio of consecutive pauses.
    pub factor: f64,
    /// Longest pause (s).
    pub longest_s: f64,
}

impl Default for BackOff {
    fn default() -> Self {
        Self {
            first_s: 0.25,
            factor: 2.0,
            longest_s: 10.0,
        }
    }
}

impl BackOff {
    /// The pause after `failed` failed attempts (s); zero before the first.
    #[must_use]
    pub fn pause_s(&self, failed: u32) -> f64 {
        if failed == 0 {
            return 0.0;
        }
        let steps = i32::try_from(failed - 1).unwrap_or(i32::MAX);
        let pause = self.first_s * self.factor.powi(steps);
        if pause.is_finite() {
            pause.clamp(0.0, self.longest_s)
        } else {
            self.longest_s
        }
    }
}

/// Result of a tick of [`Reconnect`].
#[derive(Debug, Clone, PartialEq)]
pub enum Reconnected {
    /// The controller is connected; a new connection is disarmed.
    Connected,
    /// The next attempt is due at this time (s) of the caller's clock.
    Waiting(f64),
    /// An attempt failed; the next is due at this time (s).
    Failed(LinkError, f64),
}

/// Attempts to connect, each after a longer pause.
#[derive(Debug, Clone)]
pub struct Reconnect {
    back_off: BackOff,
    failed: u32,
    due_s: f64,
}

impl Reconnect {
    /// The first attempt is due immediately.
    #[must_use]
    pub fn new(back_off: BackOff) -> Self {
        Self {
            back_off,
            failed: 0,
            due_s: f64::NEG_INFINITY,
        }
    }

    /// Connects if there is no connection and an attempt is due.
    pub fn tick(&mut self, controller: &mut dyn Controller, now_s: f64) -> Reconnected {
        if controller.state().activity != Activity::Disconnected {
            self.failed = 0;
            self.due_s = f64::NEG_INFINITY;
            return Reconnected::Connected;
        }
        if now_s < self.due_s {
            return Reconnected::Waiting(self.due_s);
        }
        match controller.connect() {
            Ok(()) => {
                self.failed = 0;
                self.due_s = f64::NEG_INFINITY;
                Reconnected::Connected
            }
            Err(error) => {
                self.failed = self.failed.saturating_add(1);
                self.due_s = now_s + self.back_off.pause_s(self.failed);
                Reconnected::Failed(error, self.due_s)
            }
        }
    }
}

/// Restores a lost connection while values are being written.
pub trait ReconnectPolicy {
    /// Reconnects the controller. It is not armed, as only the operator may do that.
    ///
    /// # Errors
    /// If it gave up.
    fn restore(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError>;

    /// Waits until nothing sent over the lost connection can still arrive.
    fn pause(&mut self);
}

/// Attempts with growing pauses; `wait` is called with each pause (s).
#[derive(Debug)]
pub struct Attempts<W, G = fn() -> bool> {
    /// Pauses.
    pub back_off: BackOff,
    /// Largest number of attempts to connect.
    pub attempts: u32,
    /// Time after which nothing sent over a lost connection can arrive (s).
    pub late_s: f64,
    /// Waits for a number of seconds.
    pub wait: W,
    /// Returns whether to give up.
    pub gives_up: G,
}

impl<W: FnMut(f64), G: Fn() -> bool> ReconnectPolicy for Attempts<W, G> {
    fn restore(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError> {
        let mut last = LinkError::Disconnected("no attempt was allowed".to_owned());
        for failed in 0..self.attempts {
            (self.wait)(self.back_off.pause_s(failed));
            if (self.gives_up)() {
                return Err(LinkError::Refused("it was interrupted".to_owned()));
            }
            match controller.connect() {
                Ok(()) => return Ok(()),
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    fn pause(&mut self) {
        (self.wait)(self.late_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::Fault;
    use crate::testing::{armed, preset};

    #[test]
    fn pauses_grow_up_to_the_longest() {
        let back_off = BackOff::default();
        let pauses: Vec<f64> = (0..9).map(|failed| back_off.pause_s(failed)).collect();
        assert_eq!(pauses, [0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 10.0, 10.0]);
        assert_eq!(back_off.pause_s(u32::MAX), 10.0);
    }

    #[test]
    fn a_lost_connection_is_made_anew_when_it_is_due() {
        let (mut robot, _) = armed(&preset("mini"), |_| ());
        let mut reconnect = Reconnect::new(BackOff::default());
        assert_eq!(reconnect.tick(&mut robot, 0.0), Reconnected::Connected);
        robot.inner_mut().set_faults(vec![Fault::ConnectionLost]);
        let failed = reconnect.tick(&mut robot, 1.0);
        assert!(matches!(failed, Reconnected::Failed(_, 1.25)), "{failed:?}");
        assert_eq!(reconnect.tick(&mut robot, 1.2), Reconnected::Waiting(1.25));
        let failed = reconnect.tick(&mut robot, 1.25);
        assert!(matches!(failed, Reconnected::Failed(_, 1.75)), "{failed:?}");
        robot.inner_mut().set_faults(Vec::new());
        assert_eq!(reconnect.tick(&mut robot, 1.8), Reconnected::Connected);
        assert!(!robot.state().armed);
    }
}
