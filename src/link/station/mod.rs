//! A controller as the rest of the program uses it: with our own rules about it, whatever the controller itself allows.
//!
//! * No pose outside the limits is commanded, and a cable that pulls too hard stops the motion.
//! * Nothing moves and nothing is written unless it was armed here, in this connection: a controller that lost its
//!   connection and found it again by itself is not armed, even where it says so.
//! * Readings have the channels that the robot has.
//! * A laser beside the controller stands in for the controller's own.

#[cfg(test)]
mod tests;

use std::cell::Cell;

use tautline_core::geometry::Pose;

use crate::controller::{Activity, Controller, ControllerState, LinkError, Sample};
use crate::laser::LaserSource;
use crate::limits::Limits;
use crate::parameters::ParameterInfo;

/// A controller with our own limits, the laser beside it and what was read last.
pub struct Station<C> {
    inner: C,
    limits: Limits,
    laser: Option<Box<dyn LaserSource>>,
    last: Option<Sample>,
    /// Whether a cable pulled too hard when last sampled: said once, so that the operator can still see and move.
    overloaded: bool,
    /// Whether it was armed here and no end of the connection was seen since, not even by asking for the state.
    armed: Cell<bool>,
}

impl<C: Controller> Station<C> {
    /// A station around a controller.
    #[must_use]
    pub fn new(inner: C, limits: Limits) -> Self {
        Self {
            inner,
            limits,
            laser: None,
            last: None,
            overloaded: false,
            armed: Cell::new(false),
        }
    }

    /// The same station with a laser whose distance stands in for that of the controller.
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

    /// The laser beside the controller.
    #[must_use]
    pub fn laser(&self) -> Option<&dyn LaserSource> {
        self.laser.as_deref()
    }

    /// What was read last in this connection.
    #[must_use]
    pub fn last(&self) -> Option<&Sample> {
        self.last.as_ref()
    }

    /// The controller itself, without any rules.
    pub fn inner_mut(&mut self) -> &mut C {
        &mut self.inner
    }

    /// What an answer says about the connection: arming ends with it.
    fn noted<T>(&self, answer: Result<T, LinkError>) -> Result<T, LinkError> {
        if answer.as_ref().is_err_and(LinkError::is_disconnection) {
            self.armed.set(false);
        }
        answer
    }

    /// Whether it may move and change values; a controller that believes so alone is disarmed.
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

    /// Ends what belongs to a connection.
    fn forget(&mut self) {
        self.armed.set(false);
        self.last = None;
        self.overloaded = false;
    }

    fn leave(&mut self) {
        if let Some(laser) = &mut self.laser {
            laser.leave();
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
        // No forces at all are those of a robot without sensors.
        let forces = Some(sample.force_n.len()).filter(|count| *count > 0);
        for (what, count) in [
            ("revolutions", sample.revolutions.len()),
            ("forces", forces.unwrap_or(cables)),
            ("swivel angles", swivels),
        ] {
            if count != cables {
                let text = format!("it told {count} {what} of a robot with {cables} cables");
                return Err(LinkError::Refused(text));
            }
        }
        Ok(())
    }
}

impl<C: Controller> Controller for Station<C> {
    fn identity(&self) -> String {
        self.inner.identity()
    }

    /// As that of the controller; where there is a laser beside it, both are connected or none.
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

    /// As that of the controller, unless its clock went back: then it is disarmed. Where a cable begins to pull too hard the platform is stopped and the
    /// error returned, once.
    fn sample(&mut self) -> Result<Sample, LinkError> {
        let sample = self.inner.sample();
        let mut sample = self.noted(sample)?;
        self.check_channels(&sample)?;
        if let Some(laser) = &self.laser {
            sample.laser_m = laser.distance_m();
        }
        // A clock that goes back is that of a controller which was started anew.
        let back = (self.last.as_ref()).is_some_and(|last| sample.time_s < last.time_s);
        self.last = Some(sample.clone());
        if back {
            self.disarm();
            let text = "its clock went back, so it was started anew: arm it again";
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
        self.leave();
        let told = self.inner.home();
        self.noted(told)
    }

    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.check_armed()?;
        self.limits.check_pose(pose)?;
        self.leave();
        let told = self.inner.command(pose);
        self.noted(told)
    }

    fn stop(&mut self) -> Result<(), LinkError> {
        let stopped = self.inner.stop();
        self.noted(stopped)
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        let told = self.inner.parameters();
        self.noted(told)
    }

    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        let told = self.inner.read(names);
        self.noted(told)
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

    fn laser_trouble(&self) -> Option<String> {
        match &self.laser {
            Some(laser) => laser.trouble(),
            None => self.inner.laser_trouble(),
        }
    }
}
