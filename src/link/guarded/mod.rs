//! A controller as the rest of the program uses it: with rules of our own, whatever the controller itself allows.
//!
//! * No pose outside the limits is commanded, and an overloaded cable stops the motion.
//! * Nothing moves and nothing is written unless it was armed here, in this connection: a controller that lost its
//!   connection and re-established it by itself is not armed, even if it reports that it is.
//! * Readings have the channels that the robot has.
//! * An external laser replaces the controller's own.

#[cfg(test)]
mod tests;

use std::cell::Cell;

use tautline_core::geometry::Pose;

use crate::controller::{Activity, Controller, ControllerState, Sample};
use crate::error::LinkError;
use crate::laser::LaserSource;
use crate::limits::Limits;
use crate::parameters::ParameterInfo;

/// A controller behind our own limits, with the external laser and the latest sample.
pub struct GuardedController<C: ?Sized> {
    inner: Box<C>,
    limits: Limits,
    laser: Option<Box<dyn LaserSource>>,
    last: Option<Sample>,
    /// Whether a cable was overloaded in the latest sample: reported once, so that the operator can still see and move.
    overloaded: bool,
    /// Whether it was armed here and the connection was not seen to end since, not even by reading the state.
    armed: Cell<bool>,
}

impl<C: Controller + ?Sized> GuardedController<C> {
    /// A guard around a controller.
    #[must_use]
    pub fn new(inner: Box<C>, limits: Limits) -> Self {
        Self {
            inner,
            limits,
            laser: None,
            last: None,
            overloaded: false,
            armed: Cell::new(false),
        }
    }

    /// The same controller with an external laser whose distance replaces its own.
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

    /// The controller itself, without any rules.
    pub fn inner_mut(&mut self) -> &mut C {
        &mut self.inner
    }

    /// Passes an answer on; a lost connection disarms.
    fn noted<T>(&self, answer: Result<T, LinkError>) -> Result<T, LinkError> {
        if answer.as_ref().is_err_and(LinkError::is_disconnection) {
            self.armed.set(false);
        }
        answer
    }

    /// Whether it may move and change values; a controller that is armed on its own side only is disarmed.
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

    /// Resets what belongs to a connection.
    fn forget(&mut self) {
        self.armed.set(false);
        self.last = None;
        self.overloaded = false;
    }

    fn discard_reading(&mut self) {
        if let Some(laser) = &mut self.laser {
            laser.discard_reading();
        }
    }

    /// Whether a sample has a time and as many values as there are cables.
    fn check_channels(&self, sample: &Sample) -> Result<(), LinkError> {
        let cables = self.limits.robot.cable_count();
        if !sample.time_s.is_finite() {
            let text = "its readings have no time".to_owned();
            return Err(LinkError::Refused(text));
        }
        let swivels = sample.swivel_rad.as_ref().map_or(cables, Vec::len);
        // A robot without force sensors has no forces at all.
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
        state
    }

    fn arm(&mut self) -> Result<(), LinkError> {
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

    fn disarm(&mut self) {
        self.armed.set(false);
        self.inner.disarm();
    }

    /// The controller's sample with the external laser. A clock that runs backwards disarms the controller; a cable that
    /// becomes overloaded stops the platform and is an error once.
    fn sample(&mut self) -> Result<Sample, LinkError> {
        let sample = self.inner.sample();
        let mut sample = self.noted(sample)?;
        self.check_channels(&sample)?;
        if let Some(laser) = &self.laser {
            sample.laser_m = laser.distance_m();
        }
        // A clock that runs backwards belongs to a controller that was restarted.
        let back = (self.last.as_ref()).is_some_and(|last| sample.time_s < last.time_s);
        self.last = Some(sample.clone());
        if back {
            self.disarm();
            let text = "its clock ran backwards, so it was restarted: arm it again";
            return Err(LinkError::Refused(text.to_owned()));
        }
        let checked = self.limits.check_forces(&sample.force_n);
        let was = std::mem::replace(&mut self.overloaded, checked.is_err());
        if let (Err(limit), false) = (checked, was) {
            self.stop()?;
            return Err(limit);
        }
        Ok(sample)
    }

    fn home(&mut self) -> Result<(), LinkError> {
        self.check_armed()?;
        self.discard_reading();
        let answer = self.inner.home();
        self.noted(answer)
    }

    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.check_armed()?;
        self.limits.check_pose(pose)?;
        self.discard_reading();
        let answer = self.inner.command(pose);
        self.noted(answer)
    }

    fn stop(&mut self) -> Result<(), LinkError> {
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
        if let Some((name, value)) = values.iter().find(|(_, value)| !value.is_finite()) {
            return Err(LinkError::InvalidValue {
                name: name.clone(),
                value: *value,
                reason: "it is not a finite number".to_owned(),
            });
        }
        let written = self.inner.write(values);
        self.noted(written)
    }

    fn laser_problem(&self) -> Option<String> {
        match &self.laser {
            Some(laser) => laser.problem(),
            None => self.inner.laser_problem(),
        }
    }
}
