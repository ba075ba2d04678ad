//! A controller guarded by the rules of this program, whatever the controller itself allows.
//!
//! * No pose outside the limits is commanded. A pose whose direct way no tensions within the limits can hold is reached over
//!   the home pose, or not at all.
//! * An overloaded cable stops the motion, each time until the operator decides.
//! * Nothing moves and nothing is written unless it was armed here, in this connection: a controller that lost its
//!   connection and re-established it on its own is not armed, even if it reports that it is.
//! * A controller that was restarted can only go home, where its encoders are zeroed again.
//! * Readings have the channels of the robot.
//! * An external laser replaces that of the controller.

mod restart;
#[cfg(test)]
mod tests;

use std::cell::Cell;

use tautline_core::geometry::Pose;

use crate::controller::{Activity, Controller, ControllerState, LinkProtection, Sample};
use crate::error::LinkError;
use crate::laser::LaserSource;
use crate::limits::Limits;
use crate::parameters::{ParameterInfo, check_finite};
use crate::pose_tracker::PoseTracker;
pub use restart::LastState;

/// A controller guarded by limits, with the external laser and the latest sample.
pub struct GuardedController<C: ?Sized> {
    inner: Box<C>,
    limits: Limits,
    laser: Option<Box<dyn LaserSource>>,
    last: Option<Sample>,
    /// Pose that was commanded last; `None` where a motion may have ended elsewhere.
    commanded: Option<Pose>,
    /// Pose to command next, on arrival at the home pose over which it is reached.
    next: Option<Pose>,
    tracker: Option<PoseTracker>,
    /// Whether the platform was stopped because of the present overload.
    stopped: bool,
    /// Force readings that the operator accepted although a cable is overloaded.
    accepted: Vec<f64>,
    /// Last known state of the controller, possibly from an earlier connection or run.
    seen: Option<LastState>,
    /// Evidence of a restart after which the robot was not homed.
    restarted: Option<String>,
    /// Whether it was armed through this guard, in a connection that is not known to have ended since.
    armed: Cell<bool>,
}

impl<C: Controller + ?Sized> GuardedController<C> {
    /// Guards a controller.
    #[must_use]
    pub fn new(inner: Box<C>, limits: Limits) -> Self {
        Self {
            inner,
            tracker: PoseTracker::of(&limits.robot),
            limits,
            laser: None,
            last: None,
            commanded: None,
            next: None,
            stopped: false,
            accepted: Vec::new(),
            seen: None,
            restarted: None,
            armed: Cell::new(false),
        }
    }

    /// Sets the state of the controller at the end of an earlier run, from which a restart since then is recognised.
    #[must_use]
    pub fn seen_before(mut self, seen: Option<LastState>) -> Self {
        self.seen = seen;
        self
    }

    /// Adds an external laser whose distance replaces that of the controller.
    #[must_use]
    pub fn with_laser(mut self, laser: Option<Box<dyn LaserSource>>) -> Self {
        self.laser = laser;
        self
    }

    /// The limits.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The external laser.
    #[must_use]
    pub fn laser(&self) -> Option<&dyn LaserSource> {
        self.laser.as_deref()
    }

    /// The latest sample of this connection.
    #[must_use]
    pub fn last(&self) -> Option<&Sample> {
        self.last.as_ref()
    }

    /// The controller without the guard.
    pub fn inner_mut(&mut self) -> &mut C {
        &mut self.inner
    }

    /// Passes on a result; a lost connection disarms.
    fn noted<T>(&self, answer: Result<T, LinkError>) -> Result<T, LinkError> {
        if answer.as_ref().is_err_and(LinkError::is_disconnection) {
            self.armed.set(false);
        }
        answer
    }

    /// Checks that motion and writing are permitted; a controller that is armed only on its own side is disarmed.
    fn check_armed(&mut self) -> Result<(), LinkError> {
        let inner = self.inner.state();
        let state = self.state();
        match state.activity {
            Activity::Disconnected => {
                let text = "it does not answer".to_owned();
                Err(LinkError::Disconnected(text))
            }
            Activity::Fault(text) => Err(LinkError::Fault(text)),
            _ if state.armed => Ok(()),
            _ => {
                if inner.armed {
                    self.inner.disarm();
                }
                Err(LinkError::NotArmed)
            }
        }
    }

    /// Resets the state that belongs to a connection.
    fn forget(&mut self) {
        self.armed.set(false);
        self.last = None;
        self.lose_way();
        self.stopped = false;
        self.accepted.clear();
        if let Some(seen) = &mut self.seen {
            seen.was_away = true;
        }
    }

    /// The motion in progress may end anywhere.
    fn lose_way(&mut self) {
        self.commanded = None;
        self.next = None;
    }

    /// The pose at which the platform rests, or else the one that its encoders show; `None` if they do not.
    fn present_pose(&mut self) -> Option<Pose> {
        let rests = self.inner.state().activity != Activity::Moving;
        let commanded = self.commanded.filter(|_| rests);
        let tracked = || Some(self.tracker.as_mut()?.of_sample(self.last.as_ref()?));
        commanded.or_else(tracked)
    }

    /// The pose to command first on the way to another: that pose, or home, from where it is reached.
    fn first_pose(&mut self, pose: &Pose) -> Result<Pose, LinkError> {
        let Some(from) = self.present_pose() else {
            return Ok(*pose);
        };
        let Err(direct) = self.limits.check_way(&from, pose) else {
            return Ok(*pose);
        };
        // Without a report whether it moves, nothing tells when it is there.
        let arrives = self.inner.state().activity != Activity::Connected;
        let home = self.limits.robot.home.filter(|_| arrives);
        let home = home.map(|home| home.pose()).filter(|home| {
            let ways = [(&from, home), (home, pose)];
            self.limits.check_pose(home).is_ok()
                && (ways.iter()).all(|(a, b)| self.limits.check_way(a, b).is_ok())
        });
        home.ok_or(direct)
    }

    /// Commands a pose.
    fn send(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.discard_reading();
        let answer = self.inner.command(pose);
        self.noted(answer)?;
        self.commanded = Some(*pose);
        self.stopped = false;
        Ok(())
    }

    /// Goes on to the pose that is reached over home once the platform is there.
    fn go_on(&mut self) -> Result<(), LinkError> {
        match self.inner.state().activity {
            Activity::Fault(_) | Activity::Disconnected => self.lose_way(),
            Activity::Still => {
                if let Some(pose) = self.next.take() {
                    return self.send(&pose);
                }
            }
            Activity::Moving | Activity::Connected => {}
        }
        Ok(())
    }

    /// Stores the present state of the controller; returns the evidence of a restart since the last one.
    fn note_restart(&mut self, sample: &Sample) -> Option<String> {
        let moving = self.inner.state().activity == Activity::Moving;
        let now = LastState::of(sample, moving);
        let seen = self.seen.replace(now.clone())?;
        let reason = seen.restart(&now, &self.limits.robot)?;
        self.restarted = Some(reason.clone());
        Some(reason)
    }

    /// Stops the platform if a cable is overloaded more than the operator accepted.
    fn check_overload(&mut self, force_n: &[f64]) -> Result<(), LinkError> {
        let Err(limit) = self.limits.check_forces(force_n, &self.accepted) else {
            if self.limits.check_forces(force_n, &[]).is_ok() {
                self.accepted.clear();
            }
            self.stopped = false;
            return Ok(());
        };
        // Once per motion, as a stop is a command, too.
        if !std::mem::replace(&mut self.stopped, true) {
            self.stop()?;
        }
        Err(limit)
    }

    fn discard_reading(&mut self) {
        if let Some(laser) = &mut self.laser {
            laser.discard_reading();
        }
    }

    /// Checks that a sample has a time and as many values as there are cables.
    fn check_channels(&self, sample: &Sample) -> Result<(), LinkError> {
        let cables = self.limits.robot.cable_count();
        if !sample.time_s.is_finite() {
            let text = "its readings have no time".to_owned();
            return Err(LinkError::Refused(text));
        }
        let swivels = sample.swivel_rad.as_ref().map_or(cables, Vec::len);
        // A robot without force sensors has no force readings at all.
        let forces = Some(sample.force_n.len()).filter(|count| *count > 0);
        for (what, count) in [
            ("revolutions", sample.revolutions.len()),
            ("forces", forces.unwrap_or(cables)),
            ("swivel angles", swivels),
        ] {
            if count != cables {
                let text = format!("it sent {count} {what} for a robot with {cables} cables");
                return Err(LinkError::Refused(text));
            }
        }
        Ok(())
    }
}

impl<C: Controller + ?Sized> Controller for GuardedController<C> {
    fn identity(&self) -> String {
        self.inner.identity()
    }

    fn protection(&self) -> Option<LinkProtection> {
        self.inner.protection()
    }

    /// Connects the controller and the external laser, both or neither.
    fn connect(&mut self) -> Result<(), LinkError> {
        self.forget();
        self.inner.connect()?;
        if self.inner.state().armed {
            self.inner.disarm();
        }
        let laser = self.laser.as_mut().map_or(Ok(()), |laser| laser.connect());
        if laser.is_err() {
            self.disconnect();
        }
        laser
    }

    fn disconnect(&mut self) {
        self.forget();
        self.inner.disconnect();
        if let Some(laser) = &mut self.laser {
            laser.disconnect();
        }
    }

    fn state(&self) -> ControllerState {
        let mut state = self.inner.state();
        if state.activity == Activity::Disconnected || !state.armed {
            self.armed.set(false);
        }
        state.armed = self.armed.get();
        if self.next.is_some() && state.activity == Activity::Still {
            state.activity = Activity::Moving;
        }
        state
    }

    fn arm(&mut self) -> Result<(), LinkError> {
        // A restarted controller may be armed so that it can go home; its lost zero is recorded here.
        if self.seen.as_ref().is_some_and(|seen| seen.was_away) {
            let sample = self.inner.sample();
            let sample = self.noted(sample)?;
            self.check_channels(&sample)?;
            self.note_restart(&sample);
        }
        let armed = self.inner.arm();
        self.noted(armed)?;
        let state = self.inner.state();
        match state.activity {
            Activity::Disconnected => {
                let text = "it does not answer".to_owned();
                Err(LinkError::Disconnected(text))
            }
            Activity::Fault(text) => Err(LinkError::Fault(text)),
            _ if state.armed => {
                self.armed.set(true);
                Ok(())
            }
            _ => Err(LinkError::Refused("it did not arm".to_owned())),
        }
    }

    fn confirm_alone(&mut self) -> Result<(), LinkError> {
        let answer = self.inner.confirm_alone();
        self.noted(answer)
    }

    fn disarm(&mut self) {
        self.lose_way();
        self.armed.set(false);
        self.inner.disarm();
    }

    /// The controller's sample with the external laser. A restart disarms the controller, an overloaded cable stops the
    /// platform; both are errors, but the sample is kept.
    fn sample(&mut self) -> Result<Sample, LinkError> {
        let sample = self.inner.sample();
        let mut sample = self.noted(sample)?;
        self.check_channels(&sample)?;
        if let Some(laser) = &self.laser {
            sample.laser_m = laser.distance_m();
        }
        self.last = Some(sample.clone());
        if let Some(reason) = self.note_restart(&sample) {
            self.disarm();
            return Err(LinkError::Restarted(reason));
        }
        self.check_overload(&sample.force_n)?;
        self.go_on()?;
        Ok(sample)
    }

    fn subscribe(&mut self, every_s: f64) -> Result<(), LinkError> {
        let answer = self.inner.subscribe(every_s);
        self.noted(answer)
    }

    /// Drops readings whose channels do not fit the robot; they do not include the external laser.
    fn sent(&mut self) -> Result<Vec<Sample>, LinkError> {
        let sent = self.inner.sent();
        let mut sent = self.noted(sent)?;
        sent.retain(|sample| self.check_channels(sample).is_ok());
        if self.laser.is_some() {
            sent.iter_mut().for_each(|sample| sample.laser_m = None);
        }
        Ok(sent)
    }

    fn home(&mut self) -> Result<(), LinkError> {
        self.check_armed()?;
        self.discard_reading();
        let answer = self.inner.home();
        self.noted(answer)?;
        // Revolutions before homing are no longer comparable, as the encoders are zeroed there.
        self.seen = None;
        self.restarted = None;
        self.stopped = false;
        self.next = None;
        self.commanded = self.limits.robot.home.map(|home| home.pose());
        Ok(())
    }

    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.check_armed()?;
        if let Some(reason) = &self.restarted {
            return Err(LinkError::Restarted(reason.clone()));
        }
        self.limits.check_pose(pose)?;
        let first = self.first_pose(pose)?;
        self.next = (first != *pose).then_some(*pose);
        self.send(&first)
    }

    fn stop(&mut self) -> Result<(), LinkError> {
        self.lose_way();
        let stopped = self.inner.stop();
        self.noted(stopped)
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        let answer = self.inner.parameters();
        self.noted(answer)
    }

    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        let answer = self.inner.read(names);
        self.noted(answer)
    }

    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        self.check_armed()?;
        check_finite(values)?;
        let written = self.inner.write(values);
        self.noted(written)
    }

    fn accept_overload(&mut self) {
        let last = self.last.as_ref();
        self.accepted = last.map_or_else(Vec::new, |sample| sample.force_n.clone());
        self.stopped = false;
    }

    fn laser_problem(&self) -> Option<String> {
        match &self.laser {
            Some(laser) => laser.problem(),
            None => self.inner.laser_problem(),
        }
    }
}
