//! Consequences of the controller's status: disarming, or a fault.

use std::thread;
use std::time::Duration;

use tautline_core::geometry::Pose;

use super::super::sample::Status;
use super::SymbolController;
use crate::controller::Controller;
use crate::error::LinkError;

/// Largest difference between the controller's last commanded pose and that of Tautline (m and rad); allows for single precision.
const SAME_POSE: f64 = 1e-4;
/// Number of times that the controller's clock must change while the release stays.
const CONFIRMING_CYCLES: usize = 3;
/// Shortest time for which the release must stay (s).
const CONFIRMING_S: f64 = 0.3;
/// The same for a controller without a clock, whose cycles cannot be counted (s).
const CONFIRMING_WITHOUT_CLOCK_S: f64 = 1.0;
/// Time within which a controller's clock must have changed that often (s); some count whole seconds.
const LONGEST_CONFIRMING_S: f64 = 5.0;
/// Pause between two samples while the release is confirmed.
const CONFIRMING_PAUSE: Duration = Duration::from_millis(50);

impl SymbolController {
    /// Processes a status of the controller.
    pub(super) fn take(&mut self, status: Status) {
        self.status = status;
        self.check_alone();
        self.check_acknowledgement();
    }

    /// Disarms if the controller accepted a command of another client: two clients driving it at the same time are dangerous,
    /// and readings would not belong to the commanded pose.
    fn check_alone(&mut self) {
        if let Some(text) = self.foreign_count().filter(|_| self.armed) {
            // At rest nothing more is written; a motion must not go on without this program's supervision.
            return match self.moves() {
                true => self.stand_back(text),
                false => self.yield_to(&text),
            };
        }
        if !self.armed || self.layout.command.is_none() {
            return;
        }
        let taken = self.status.acknowledged;
        let before = self.number.wrapping_sub(1);
        if taken == self.number || (self.pending.is_some() && taken == before) {
            return;
        }
        let ours = self.number;
        self.stand_back(format!(
            "it took command {taken}, the last one of Tautline was {ours}"
        ));
    }

    /// Disarms also if a command of another client had the same number, which shows in the commanded pose.
    pub(super) fn check_last_commanded(&mut self, last: Option<&Pose>) {
        // An unreachable target is also accepted, and becomes a fault.
        let taken = self.armed && self.pending.is_none() && self.status.fault.is_none();
        let ours = self.last_commanded.filter(|_| taken);
        let Some((ours, last)) = ours.zip(last) else {
            return;
        };
        if last.difference(&ours).amax() > SAME_POSE {
            let text = "its last commanded pose is not that of Tautline";
            self.stand_back(text.to_owned());
        }
    }

    /// Stops any motion and yields the controller to another client.
    fn stand_back(&mut self, by: String) {
        // Without the release any motion is stopped; if that cannot be written, the connection ends, which the
        // watchdog notices.
        let _ = self.release(false);
        self.yield_to(&by);
    }

    fn yield_to(&mut self, by: &str) {
        self.pending = None;
        self.armed = false;
        self.own_fault = Some(format!("another client commands it: {by}"));
    }

    /// The number of the watchdog, in words, unless this program wrote it. `None` for a controller without a release.
    pub(super) fn foreign_count(&self) -> Option<String> {
        self.layout.status.release?;
        let (found, [first, last]) = (self.status.watchdog?, self.counted);
        (found.wrapping_sub(first) > last.wrapping_sub(first))
            .then(|| format!("its watchdog is {found}, the last number of Tautline was {last}"))
    }

    /// Refuses a release that this program has not set.
    pub(super) fn check_free(&self) -> Result<(), LinkError> {
        let is_own = self.status.watchdog.is_some() && self.foreign_count().is_none();
        if self.layout.status.release.is_none() || !self.status.released || is_own {
            return Ok(());
        }
        let text = "its release is TRUE. That of a program that was killed ends within seconds, by the controller's watchdog";
        Err(LinkError::Occupied(text.to_owned()))
    }

    /// Checks with the controller whether values may be written now.
    pub(super) fn check_writable(&mut self) -> Result<(), LinkError> {
        if let Some(text) = self.with(|program, _| program.problem())? {
            self.own_fault = Some(text.clone());
            return Err(LinkError::Refused(text));
        }
        self.confirm_alone()?;
        self.check_release();
        self.check_armed()?;
        if self.moves() {
            let text = "values can be written only while the platform stands still";
            return Err(LinkError::Refused(text.to_owned()));
        }
        Ok(())
    }

    /// Waits until the release has outlasted several cycles of the controller's program, as a switch that is off revokes it
    /// only in the next cycle. Meanwhile the watchdog may be what it was `before`, but no number of another program.
    pub(super) fn confirm_release(&mut self, before: Option<u32>) -> Result<(), LinkError> {
        if self.layout.status.release.is_none() {
            return Ok(());
        }
        let shortest_s = match self.layout.readings.time {
            Some(_) => CONFIRMING_S,
            None => CONFIRMING_WITHOUT_CLOCK_S,
        };
        let begun_s = self.clock.now_s();
        let (mut cycles, mut last_s) = (0, None);
        loop {
            let time_s = self.poll()?.time_s;
            self.check_fault()?;
            if !self.status.released {
                let text = "it revoked the release at once: turn on the switch at the robot, then arm it again";
                return Err(LinkError::Refused(text.to_owned()));
            }
            let changed = |last_s: f64| (time_s - last_s).abs() > 0.0;
            cycles += usize::from(last_s.replace(time_s).is_some_and(changed));
            let passed_s = self.clock.now_s() - begun_s;
            let is_confirmed = cycles >= CONFIRMING_CYCLES && passed_s >= shortest_s;
            if let Some(text) = self.foreign_count()
                && (is_confirmed || self.status.watchdog != before)
            {
                return Err(LinkError::Occupied(text));
            }
            if is_confirmed {
                return Ok(());
            }
            if passed_s > LONGEST_CONFIRMING_S {
                let text = format!(
                    "its time changed {cycles} times in {passed_s:.0} s, expected at least {CONFIRMING_CYCLES}: does its program run, and is its time the symbol of the mapping?"
                );
                return Err(LinkError::Refused(text));
            }
            self.count_sample()?;
            thread::sleep(CONFIRMING_PAUSE);
        }
    }

    /// Disarms if the controller has revoked the release, as a command in progress must not count as completed.
    pub(super) fn check_release(&mut self) {
        if self.armed && !self.status.released {
            self.armed = false;
            self.pending = None;
            let text = "it revoked the release, by its switch or because its watchdog saw no samples: arm it again";
            self.own_fault = Some(text.to_owned());
        }
    }

    /// Checks whether the controller has acknowledged the last command.
    fn check_acknowledgement(&mut self) {
        let Some(pending) = self.pending else { return };
        if self.status.acknowledged == pending.number {
            self.pending = None;
        } else if self.clock.now_s() - pending.since_s > self.acknowledge_s {
            self.pending = None;
            self.own_fault = Some(format!(
                "it did not acknowledge command {} within {:.1} s",
                pending.number, self.acknowledge_s
            ));
        }
    }
}
