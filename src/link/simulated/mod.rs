//! A simulated controller with its robot.
//!
//! The controller uses its own parameters. A commanded pose becomes motor revolutions by its inverse
//! kinematics, with the tensions that it distributes; the true robot rests where these revolutions put it (see
//! [`QuasiStaticRobot::at_revolutions`]). So the platform misses its target by the error of the parameters.
//! Readings follow the same prediction as [`tautline_core::simulation::simulate`]; how the noise of single
//! samples relates to that of their mean is described at [`SimulatedSetup::repeating_share`]. Effects at a pose count
//! commanded poses since home, from 1. Swapped channels affect the readings, not the regulation of the
//! drives.

mod fault;
mod motion;
mod readings;
mod setup;
#[cfg(test)]
mod tests;
mod tracker;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_core::simulation::{
    Epoch, QuasiStaticRobot, RestState, SimulationError, TensionRange, ambient_temperature_c,
};

pub use fault::Fault;
pub use setup::SimulatedSetup;
pub use tracker::SimulatedTracker;

use crate::clock::Clock;
use crate::controller::{Activity, Controller, ControllerState, Sample};
use crate::error::LinkError;
use crate::parameters::{ParameterInfo, parameters_of, set_parameter, values_of};
use motion::{Motion, Pace, PathPoint};
use readings::{Noise, row_of, sample_of};

/// Number of pieces of a path, between which readings are interpolated while the platform moves.
const PIECES: usize = 8;
/// Time between the two instants at which drifting readings are computed at rest (s).
const DRIFT_S: f64 = 10.0;

/// State shared by the robot and the instruments that observe it.
struct Shared {
    clock: Arc<dyn Clock>,
    start_s: f64,
    speed: f64,
    motion: Mutex<Motion>,
}

impl Shared {
    /// Simulated time (s).
    fn now_s(&self) -> f64 {
        (self.clock.now_s() - self.start_s) * self.speed
    }

    fn motion(&self) -> MutexGuard<'_, Motion> {
        self.motion.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A simulated controller with its robot.
pub struct SimulatedRobot {
    setup: SimulatedSetup,
    parameters: Vec<ParameterInfo>,
    believed: QuasiStaticRobot,
    real: QuasiStaticRobot,
    shared: Arc<Shared>,
    noise: Noise,
    zeroed: Epoch,
    /// Number of commanded poses since home.
    visits: i64,
    /// Last rest pose of the platform, and the corresponding pose in the controller.
    rested: Pose,
    commanded: Pose,
    connected: bool,
    armed: bool,
    faults: Vec<Fault>,
}

fn moment(label: i64, time_s: f64) -> Epoch {
    Epoch {
        label,
        time_s,
        temperature_c: ambient_temperature_c(time_s),
    }
}

fn impossible(error: &SimulationError) -> LinkError {
    LinkError::Setup(format!("this robot cannot be simulated: {error}"))
}

fn refused(error: &SimulationError) -> LinkError {
    LinkError::Refused(error.to_string())
}

impl SimulatedRobot {
    /// A robot at home with zeroed encoders, not connected.
    ///
    /// # Errors
    /// If the robot has no home pose or cannot be held there, an effect or parameter does not exist, or a speed is
    /// not positive.
    pub fn new(setup: SimulatedSetup, clock: Arc<dyn Clock>) -> Result<Self, LinkError> {
        setup.check()?;
        let mut parameters = parameters_of(&setup.nominal);
        for (name, value) in &setup.parameters {
            set_parameter(&mut setup.nominal.clone(), name, *value)?;
            for known in parameters.iter_mut().filter(|p| p.name == *name) {
                known.value = *value;
            }
        }
        let zeroed = moment(0, 0.0);
        let robot = believed_robot(&setup.nominal, &parameters)?;
        let believed = standing(robot, setup.tension, zeroed)?;
        let real = standing(setup.truth.clone(), setup.tension, zeroed)?;
        let place = place_of(&real, &real.at_home().map_err(|e| impossible(&e))?);
        let noise = Noise::new(&setup, ChaCha8Rng::seed_from_u64(setup.seed));
        let shared = Shared {
            start_s: clock.now_s(),
            clock,
            speed: setup.speed,
            motion: Mutex::new(Motion::resting(place.clone(), 0.0)),
        };
        let mut robot = Self {
            commanded: home_of(&believed),
            rested: place.pose,
            parameters,
            believed,
            real,
            shared: Arc::new(shared),
            noise,
            zeroed,
            visits: 0,
            connected: false,
            armed: false,
            faults: Vec::new(),
            setup,
        };
        robot.noise.renew();
        Ok(robot)
    }

    /// True pose of the platform now.
    #[must_use]
    pub fn true_pose(&self) -> Pose {
        self.shared.motion().at(self.shared.now_s()).pose
    }

    /// An external instrument that observes the platform, with the standard deviations of its position (m) and
    /// rotation vector (rad).
    #[must_use]
    pub fn tracker(
        &self,
        position_sd_m: f64,
        orientation_sd_rad: f64,
        seed: u64,
    ) -> SimulatedTracker {
        let sds = (position_sd_m, orientation_sd_rad);
        SimulatedTracker::new(Arc::clone(&self.shared), sds, seed)
    }

    /// Replaces the present faults.
    pub fn set_faults(&mut self, faults: Vec<Fault>) {
        self.faults = faults;
        if self.faults.contains(&Fault::ConnectionLost) {
            self.drop_connection();
        }
        if self.drive_fault().is_some() {
            self.halt();
        }
    }

    fn drive_fault(&self) -> Option<&str> {
        self.faults.iter().find_map(|fault| match fault {
            Fault::Drive(text) => Some(text.as_str()),
            _ => None,
        })
    }

    fn drop_connection(&mut self) {
        self.connected = false;
        self.armed = false;
        self.halt();
    }

    /// Stops the drives at once, as losing the connection does.
    fn halt(&mut self) {
        let now_s = self.shared.now_s();
        let mut motion = self.shared.motion();
        if motion.is_moving(now_s) {
            let place = motion.at(now_s);
            self.rested = place.pose;
            *motion = Motion::resting(place, now_s);
        }
    }

    fn check_connected(&self) -> Result<(), LinkError> {
        match self.connected {
            true => Ok(()),
            false => Err(LinkError::Disconnected("it does not answer".to_owned())),
        }
    }

    fn check_able(&self) -> Result<(), LinkError> {
        self.check_connected()?;
        match self.drive_fault() {
            Some(text) => Err(LinkError::Fault(text.to_owned())),
            None => Ok(()),
        }
    }

    fn check_armed(&self) -> Result<(), LinkError> {
        self.check_able()?;
        if self.armed {
            Ok(())
        } else {
            Err(LinkError::NotArmed)
        }
    }

    fn pace(&self) -> Pace {
        Pace {
            velocity_m_s: self.setup.velocity_m_s,
            turning_rad_s: self.setup.turning_rad_s,
            acceleration_m_s2: self.setup.acceleration_m_s2,
        }
    }

    /// The rest state after a commanded pose at a time, if it can be reached.
    fn rest_for(&self, pose: &Pose, at: Epoch) -> Result<RestState, SimulationError> {
        let wanted = self.believed.at(at, &self.commanded, pose)?;
        let revolutions = wanted.readings.revolutions.row(0);
        self.real
            .at_revolutions(at, &self.rested, (revolutions, pose))
    }

    /// Starts the motion from the present pose to a rest state.
    fn start(&mut self, (start_s, duration_s): (f64, f64), rest: &RestState, label: i64) {
        let from = self.shared.motion().at(start_s);
        let way = rest.pose.difference(&from.pose);
        let mut places = vec![from.clone()];
        // A piece without a kinematic solution is left out, as the platform only passes there.
        for piece in 1..PIECES {
            let part = piece as f64 / PIECES as f64;
            let pose = from.pose.perturbed(&(way * part));
            let at = moment(label, start_s + part * duration_s);
            if let Ok(passed) = self.real.at(at, &self.rested, &pose) {
                places.push(place_of(&self.real, &passed));
            }
        }
        // Pieces must be equally long, so if one is left out only the two ends are used.
        if places.len() < PIECES {
            places.truncate(1);
        }
        places.push(place_of(&self.real, rest));
        let docks = label == 0;
        *self.shared.motion() = Motion::along(places, (start_s, duration_s), docks);
        self.rested = rest.pose;
        self.noise.renew();
    }

    fn write_one(&mut self, name: &str, value: f64) -> Result<(), LinkError> {
        let mut arrives = value;
        for fault in &mut self.faults {
            if let Fault::WriteDiffers {
                name: at,
                by,
                times,
            } = fault
                && at == name
                && *times > 0
            {
                *times -= 1;
                arrives += *by;
            }
        }
        set_parameter(&mut self.setup.nominal.clone(), name, arrives)?;
        let known = self.parameters.iter_mut().find(|p| p.name == name);
        let known = known.ok_or_else(|| LinkError::UnknownParameter(name.to_owned()))?;
        known.value = arrives;
        Ok(())
    }

    /// Applies a fault to the writing of value number `index`, from 0.
    fn fail_write(&mut self, index: usize) -> Result<(), LinkError> {
        let fails = |fault: &Fault| *fault == Fault::WriteFails { after: index };
        if let Some(at) = self.faults.iter().position(fails) {
            self.faults.remove(at);
            return Err(LinkError::Timeout {
                request: "to write a value".to_owned(),
                seconds: 1.0,
            });
        }
        if (self.faults).contains(&Fault::AnotherArms { after: index }) {
            return self.confirm_alone();
        }
        if (self.faults).contains(&Fault::WriteDisconnects { after: index }) {
            self.drop_connection();
            let text = "it broke while values were written";
            return Err(LinkError::Disconnected(text.to_owned()));
        }
        Ok(())
    }

    fn rebuild(&mut self) -> Result<(), LinkError> {
        let robot = believed_robot(&self.setup.nominal, &self.parameters)?;
        let built = QuasiStaticRobot::new(robot, self.setup.tension, self.zeroed);
        self.believed = built.map_err(|e| refused(&e))?;
        Ok(())
    }
}

fn standing(
    robot: Robot,
    range: TensionRange,
    zeroed: Epoch,
) -> Result<QuasiStaticRobot, LinkError> {
    QuasiStaticRobot::new(robot, range, zeroed).map_err(|e| impossible(&e))
}

fn believed_robot(nominal: &Robot, parameters: &[ParameterInfo]) -> Result<Robot, LinkError> {
    let mut robot = nominal.clone();
    for parameter in parameters {
        set_parameter(&mut robot, &parameter.name, parameter.value)?;
    }
    Ok(robot)
}

fn home_of(robot: &QuasiStaticRobot) -> Pose {
    let home = robot.truth().home;
    home.map_or_else(Pose::identity, |home| home.pose())
}

fn place_of(robot: &QuasiStaticRobot, rest: &RestState) -> PathPoint {
    PathPoint {
        pose: rest.pose,
        row: row_of(&robot.as_read(rest), robot.truth().cable_count()),
    }
}

impl Controller for SimulatedRobot {
    fn identity(&self) -> String {
        format!("Simulated {}", self.setup.nominal.name)
    }

    fn connect(&mut self) -> Result<(), LinkError> {
        if self.faults.contains(&Fault::ConnectionLost) {
            return Err(LinkError::Disconnected("it does not answer".to_owned()));
        }
        self.connected = true;
        Ok(())
    }

    fn disconnect(&mut self) {
        self.drop_connection();
    }

    fn state(&self) -> ControllerState {
        let activity = match self.drive_fault() {
            _ if !self.connected => Activity::Disconnected,
            Some(text) => Activity::Fault(text.to_owned()),
            None if self.shared.motion().is_moving(self.shared.now_s()) => Activity::Moving,
            None => Activity::Still,
        };
        ControllerState {
            activity,
            armed: self.armed,
        }
    }

    fn arm(&mut self) -> Result<(), LinkError> {
        self.check_able()?;
        self.confirm_alone()?;
        self.armed = true;
        Ok(())
    }

    fn confirm_alone(&mut self) -> Result<(), LinkError> {
        let is_another = |fault: &Fault| matches!(fault, Fault::AnotherArms { .. });
        if !self.faults.iter().any(is_another) {
            return Ok(());
        }
        self.armed = false;
        Err(LinkError::Occupied("its watchdog is not ours".to_owned()))
    }

    fn disarm(&mut self) {
        self.armed = false;
        self.halt();
    }

    fn sample(&mut self) -> Result<Sample, LinkError> {
        self.check_connected()?;
        let now_s = self.shared.now_s();
        let cables = self.real.truth().cable_count();
        let (mut row, moving) = {
            let motion = self.shared.motion();
            (motion.at(now_s).row, motion.is_moving(now_s))
        };
        let zeroed = self.visits == 0 && !moving;
        self.noise.add_to(&mut row, if zeroed { cables } else { 0 });
        let mut sample = sample_of(&row, cables, self.setup.laser_range_m);
        sample.time_s = now_s;
        sample.temperature_c = Some(ambient_temperature_c(now_s));
        sample.commanded = Some(self.commanded);
        for fault in &self.faults {
            fault.change(&mut sample);
        }
        Ok(sample)
    }

    fn home(&mut self) -> Result<(), LinkError> {
        self.check_armed()?;
        let now_s = self.shared.now_s();
        let home = self.real.truth().home.map(|home| home.pose());
        let from = self.shared.motion().at(now_s).pose;
        let duration_s = home.map_or(0.0, |home| self.pace().duration_s(&from, &home));
        self.zeroed = moment(0, now_s + duration_s);
        let range = self.setup.tension;
        let real = standing(self.real.truth().clone(), range, self.zeroed)?;
        let rest = real.at_home().map_err(|e| refused(&e))?;
        // Until arrival, the readings still count from the previous zero.
        self.start((now_s, duration_s), &rest, 0);
        self.real = real;
        self.visits = 0;
        self.rebuild()?;
        self.commanded = home_of(&self.believed);
        Ok(())
    }

    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.check_armed()?;
        let now_s = self.shared.now_s();
        let duration_s = self.pace().duration_s(&self.true_pose(), pose);
        let label = self.visits + 1;
        let arrival_s = now_s + duration_s;
        let found = self.rest_for(pose, moment(label, arrival_s));
        let rest = found.map_err(|e| refused(&e))?;
        let drifts = !self.real.truth().effects.is_empty();
        let later = drifts.then(|| self.rest_for(pose, moment(label, arrival_s + DRIFT_S)));
        self.start((now_s, duration_s), &rest, label);
        if let Some(Ok(later)) = later {
            self.shared.motion().later = Some((DRIFT_S, place_of(&self.real, &later)));
        }
        self.visits = label;
        self.commanded = *pose;
        Ok(())
    }

    fn stop(&mut self) -> Result<(), LinkError> {
        self.check_connected()?;
        self.halt();
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

    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        self.check_armed()?;
        if self.state().activity == Activity::Moving {
            let text = "values can be written only while the platform stands still";
            return Err(LinkError::Refused(text.to_owned()));
        }
        let written = values
            .iter()
            .enumerate()
            .try_for_each(|(index, (name, value))| {
                self.fail_write(index)?;
                self.write_one(name, *value)
            });
        let rebuilt = self.rebuild();
        written.and(rebuilt)
    }
}
