//! Playback of a recorded dataset as a controller.
//!
//! Only recorded poses can be commanded: the nearest one is looked up, moving to it takes some time, and then the
//! recorded readings are returned. If the recording has time stamps, the controller's clock shows them, as long as the
//! pauses between poses are acceptably short. Parameters are those of the recorded robot and read-only.

mod recording;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use tautline_core::geometry::Pose;
use tautline_core::measurement::Dataset;

use crate::clock::Clock;
use crate::controller::{Activity, Controller, ControllerState, Sample};
use crate::error::LinkError;
use crate::parameters::{ParameterInfo, parameters_of, values_of};
use recording::Recording;

/// Duration of a motion if the recording has no time stamps (s).
const WAY_S: f64 = 1.0;
/// Shortest and longest duration of a motion (s); longer pauses of the recording are shortened.
const WAY_LIMITS_S: [f64; 2] = [0.1, 30.0];
/// Time (s) by which the platform arrives before the recorded time, which is that of the mean of the samples.
const REST_S: f64 = 1.5;

/// A motion between two recorded poses.
#[derive(Debug, Clone, Copy)]
struct Way {
    from: usize,
    to: usize,
    start_s: f64,
    duration_s: f64,
}

/// A controller that plays a recorded dataset back.
pub struct ReplayController {
    recording: Recording,
    name: String,
    parameters: Vec<ParameterInfo>,
    clock: Arc<dyn Clock>,
    /// Corresponding start times of the clock and of the controller (s).
    start_s: (f64, f64),
    way: Way,
    commanded: Option<Pose>,
    connected: bool,
    armed: bool,
}

impl ReplayController {
    /// Plays `dataset` back at the speed of `clock`; not connected.
    ///
    /// # Errors
    /// If no row has a commanded pose, or lengths were recorded instead of revolutions.
    pub fn new(dataset: Dataset, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        let name = format!("Recording of {}", dataset.robot.name);
        let parameters = parameters_of(&dataset.robot);
        let recording = Recording::new(dataset)?;
        let first = recording.first();
        let begins_s = recording.time_s(first).map_or(0.0, |time_s| {
            // So that the first pose also arrives as early as the others.
            time_s - REST_S - WAY_LIMITS_S[0]
        });
        Ok(Self {
            start_s: (clock.now_s(), begins_s),
            way: Way {
                from: first,
                to: first,
                start_s: begins_s,
                duration_s: 0.0,
            },
            recording,
            name,
            parameters,
            clock,
            commanded: None,
            connected: false,
            armed: false,
        })
    }

    fn now_s(&self) -> f64 {
        let (clock_s, begins_s) = self.start_s;
        self.clock.now_s() - clock_s + begins_s
    }

    /// Completed fraction of the motion.
    fn part(&self, now_s: f64) -> f64 {
        let passed_s = now_s - self.way.start_s;
        if passed_s < self.way.duration_s {
            passed_s / self.way.duration_s
        } else {
            1.0
        }
    }

    fn check_connected(&self) -> Result<(), LinkError> {
        match self.connected {
            true => Ok(()),
            false => Err(LinkError::Disconnected(
                "the recording is closed".to_owned(),
            )),
        }
    }

    fn check_armed(&self) -> Result<(), LinkError> {
        self.check_connected()?;
        match self.armed {
            true => Ok(()),
            false => Err(LinkError::NotArmed),
        }
    }

    fn go_to(&mut self, row: usize) {
        let now_s = self.now_s();
        let [shortest_s, longest_s] = WAY_LIMITS_S;
        let duration_s = match self.recording.time_s(row) {
            Some(time_s) => (time_s - REST_S - now_s).clamp(shortest_s, longest_s),
            None => WAY_S,
        };
        self.way = Way {
            from: self.way.to,
            to: row,
            start_s: now_s,
            duration_s,
        };
        self.recording.visit(row);
        self.commanded = self.recording.commanded(row);
    }
}

impl Controller for ReplayController {
    fn identity(&self) -> String {
        self.name.clone()
    }

    fn connect(&mut self) -> Result<(), LinkError> {
        self.armed &= self.connected;
        self.connected = true;
        Ok(())
    }

    fn disconnect(&mut self) {
        self.connected = false;
        self.armed = false;
    }

    fn state(&self) -> ControllerState {
        let activity = if !self.connected {
            Activity::Disconnected
        } else if self.part(self.now_s()) < 1.0 {
            Activity::Moving
        } else {
            Activity::Still
        };
        ControllerState {
            activity,
            armed: self.armed,
        }
    }

    fn arm(&mut self) -> Result<(), LinkError> {
        self.check_connected()?;
        self.armed = true;
        Ok(())
    }

    fn disarm(&mut self) {
        self.armed = false;
    }

    fn sample(&mut self) -> Result<Sample, LinkError> {
        self.check_connected()?;
        let now_s = self.now_s();
        let (from, to) = (self.way.from, self.way.to);
        let mut sample = self.recording.between(from, to, self.part(now_s));
        sample.time_s = now_s;
        sample.commanded = self.commanded;
        Ok(sample)
    }

    fn home(&mut self) -> Result<(), LinkError> {
        self.check_armed()?;
        let row = self.recording.home().ok_or_else(|| {
            LinkError::Refused("the recording has no home pose (label 0)".to_owned())
        })?;
        self.go_to(row);
        Ok(())
    }

    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.check_armed()?;
        let row = self.recording.nearest(pose)?;
        self.go_to(row);
        Ok(())
    }

    /// A recording has no drives: it stays at the last commanded pose.
    fn stop(&mut self) -> Result<(), LinkError> {
        self.check_connected()?;
        self.way.duration_s = 0.0;
        Ok(())
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        self.check_connected()?;
        Ok(self.parameters.clone())
    }

    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        self.check_connected()?;
        values_of(&self.parameters, names)
    }

    fn write(&mut self, _: &[(String, f64)]) -> Result<(), LinkError> {
        self.check_connected()?;
        let text = "this is a recording: its parameters can be read but not changed";
        Err(LinkError::Refused(text.to_owned()))
    }
}
