//! Consequences of the controller's status: disarming, or a fault.

use tautline_core::geometry::Pose;

use super::super::sample::{Status, status_of};
use super::SymbolController;
use crate::error::LinkError;

/// Largest difference between the controller's last commanded pose and that of Tautline (m and rad); allows for single precision.
const SAME_POSE: f64 = 1e-4;

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

    /// Yields the controller to another client.
    fn stand_back(&mut self, by: String) {
        self.pending = None;
        // Without the release any motion is stopped; if that cannot be written, the connection ends, which the
        // watchdog notices.
        let _ = self.release(false);
        self.armed = false;
        self.own_fault = Some(format!("another client commands it: {by}"));
    }

    /// Checks with the controller whether values may be written now.
    pub(super) fn check_writable(&mut self) -> Result<(), LinkError> {
        if let Some(text) = self.with(|program, _| program.problem())? {
            self.own_fault = Some(text.clone());
            return Err(LinkError::Refused(text));
        }
        let status = self.with(|program, layout| {
            let raw = program.read(&mut layout.status.symbols())?;
            Ok(status_of(&raw, &layout.status))
        })?;
        self.take(status);
        self.check_release();
        self.check_armed()?;
        if self.moves() {
            let text = "values can be written only while the platform stands still";
            return Err(LinkError::Refused(text.to_owned()));
        }
        Ok(())
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
