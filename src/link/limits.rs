//! Our own limits: whatever a controller allows, no pose outside the workspace is commanded and no cable pulls too hard.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_core::simulation::{TensionRange, Workspace};

use crate::controller::{Controller, ControllerState, LinkError, Sample};
use crate::parameters::ParameterInfo;

/// A reading may exceed the limit of the tension by this many of its standard deviations: that is noise.
const NOISE: f64 = 6.0;

/// Where a robot may move and how hard its cables may pull.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// The robot by which tensions are predicted and read.
    pub robot: Robot,
    /// Where the platform may be commanded.
    pub workspace: Workspace,
    /// Tensions that the distribution may use; a reading above the upper one stops the motion.
    pub tension: TensionRange,
}

impl Limits {
    /// Limits that suit a robot.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        Self {
            workspace: Workspace::of(robot),
            tension: TensionRange::of(robot),
            robot: robot.clone(),
        }
    }

    /// Whether the pose is inside the workspace and tensions within the limits hold the platform there.
    ///
    /// # Errors
    /// [`LinkError::Limit`] if not.
    pub fn check_pose(&self, pose: &Pose) -> Result<(), LinkError> {
        let at = || {
            let [x, y, z] = (pose.position * 1e3).into();
            format!("position ({x:.1}, {y:.1}, {z:.1}) mm")
        };
        if !self.workspace.contains(pose) {
            let text = format!("{} or its orientation is not in the workspace", at());
            return Err(LinkError::Limit(text));
        }
        if self.robot.platform.mass_kg.is_none() || !self.robot.has_force_sensors() {
            return Ok(());
        }
        let held = self.tension.tensions(&self.robot, pose);
        let held = held.map_err(|e| LinkError::Limit(format!("at {} {e}", at())))?;
        held.map(drop).ok_or_else(|| {
            LinkError::Limit(format!(
                "no tensions between {:.0} N and {:.0} N hold the platform at {}",
                self.tension.lower_n,
                self.tension.upper_n,
                at()
            ))
        })
    }

    /// Whether no cable pulls harder than the limit, beyond the noise of its sensor.
    ///
    /// # Errors
    /// [`LinkError::Limit`] that names the cable.
    pub fn check_forces(&self, force_n: &[f64]) -> Result<(), LinkError> {
        for (cable, reading) in self.robot.cables.iter().zip(force_n) {
            let Some(sensor) = cable.force_sensor else {
                continue;
            };
            let tension = sensor.tension_n(*reading);
            if tension > self.tension.upper_n + NOISE * sensor.tension_sd_n {
                return Err(LinkError::Limit(format!(
                    "{} pulls with {tension:.0} N, at most {:.0} N are allowed",
                    cable.name, self.tension.upper_n
                )));
            }
        }
        Ok(())
    }
}

/// A controller that keeps the limits.
#[derive(Debug)]
pub struct Limited<C> {
    inner: C,
    limits: Limits,
    /// Whether a cable pulled too hard when last sampled: said once, so that the operator can still see and move.
    overloaded: bool,
}

impl<C: Controller> Limited<C> {
    /// Guards a controller.
    #[must_use]
    pub fn new(inner: C, limits: Limits) -> Self {
        Self {
            inner,
            limits,
            overloaded: false,
        }
    }

    /// The limits.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The guarded controller.
    pub fn inner_mut(&mut self) -> &mut C {
        &mut self.inner
    }
}

impl<C: Controller> Controller for Limited<C> {
    fn identity(&self) -> String {
        self.inner.identity()
    }
    fn connect(&mut self) -> Result<(), LinkError> {
        self.inner.connect()
    }
    fn disconnect(&mut self) {
        self.inner.disconnect();
    }
    fn state(&self) -> ControllerState {
        self.inner.state()
    }
    fn arm(&mut self) -> Result<(), LinkError> {
        self.inner.arm()
    }
    fn disarm(&mut self) {
        self.inner.disarm();
    }
    /// As that of the controller; where a cable begins to pull too hard the platform is stopped and the
    /// error returned, once.
    fn sample(&mut self) -> Result<Sample, LinkError> {
        let sample = self.inner.sample()?;
        let checked = self.limits.check_forces(&sample.force_n);
        let was = std::mem::replace(&mut self.overloaded, checked.is_err());
        if let (Err(limit), false) = (checked, was) {
            self.inner.stop()?;
            return Err(limit);
        }
        Ok(sample)
    }
    fn home(&mut self) -> Result<(), LinkError> {
        self.inner.home()
    }
    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.limits.check_pose(pose)?;
        self.inner.command(pose)
    }
    fn stop(&mut self) -> Result<(), LinkError> {
        self.inner.stop()
    }
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        self.inner.parameters()
    }
    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        self.inner.read(names)
    }
    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        self.inner.write(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::Fault;
    use crate::testing::{armed, limits, preset};

    #[test]
    fn poses_that_cannot_be_held_are_refused() {
        let preset = preset("mini");
        let mut limits = limits(&preset);
        let centre = preset.workspace.centre;
        limits.check_pose(&centre).unwrap();
        limits.tension.upper_n = 11.0;
        limits.tension.reference_n = 10.5;
        let held = limits.check_pose(&centre).unwrap_err().to_string();
        assert!(held.contains("no tensions between 10 N and 11 N"), "{held}");
        let mut nowhere = centre;
        nowhere.position.x = f64::NAN;
        assert!(limits.check_pose(&nowhere).is_err());
    }

    #[test]
    fn an_overloaded_cable_stops_the_motion_and_is_told_once() {
        let preset = preset("mini");
        let (mut robot, clock) = armed(&preset, |_| ());
        let mut target = preset.workspace.centre;
        target.position.x += 0.15;
        robot.command(&target).unwrap();
        clock.advance(0.5);
        let overload = Fault::Tension {
            cable: 1,
            reading_n: 400.0,
        };
        robot.inner_mut().set_faults(vec![overload]);
        let told = robot.sample().unwrap_err().to_string();
        assert!(
            told.contains("cable-2 pulls with 200 N, at most 150 N"),
            "{told}"
        );
        assert_eq!(robot.state().activity, crate::Activity::Still);
        assert!(robot.sample().is_ok());
    }
}
