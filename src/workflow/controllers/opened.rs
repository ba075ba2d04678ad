//! Opening a connection.

use std::sync::Arc;

use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_link::laser::{ExternalLaser, ManualLaser};
use tautline_link::simulated::{SimulatedRobot, SimulatedSetup};
use tautline_link::{
    Controller, GuardedController, Instrument, LinkError, ReplayController, SystemClock, ads, opcua,
};
use tautline_session::read_dataset;

use super::clock::SimulationClock;
use super::setup::{ConnectionSetup, Source, seed_after};
use super::stored::{Stored, held_values};

/// Noise of the simulated tracker (m, rad).
const TRACKER_SD: (f64, f64) = (2e-5, 5e-5);

/// A controller that is not connected yet, with the other parts of its connection.
pub struct Opened {
    /// The controller, guarded by its limits.
    pub controller: GuardedController<dyn Controller>,
    /// The laser whose distances are typed by the operator.
    pub manual_laser: Option<ManualLaser>,
    /// The external instrument that observes a simulated robot.
    pub instrument: Option<Box<dyn Instrument>>,
    /// The instrument that measures the home pose of a simulated robot, with the accuracy of its description.
    pub home_instrument: Option<Box<dyn Instrument>>,
    /// The clock of the controller.
    pub clock: SimulationClock,
}

/// Errors of opening a controller.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// A required file cannot be used.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The controller cannot be set up.
    #[error(transparent)]
    Link(#[from] LinkError),
}

/// A controller, its external instrument, and the instrument that measures the home pose.
type Parts = (
    Box<dyn Controller>,
    Option<Box<dyn Instrument>>,
    Option<Box<dyn Instrument>>,
);

impl ConnectionSetup {
    /// Opens the connection; simulated and recorded robots run `speed` times faster than real time.
    ///
    /// # Errors
    /// If a file is missing or wrong, or the controller cannot be set up.
    pub fn open(&self, speed: f64) -> Result<Opened, OpenError> {
        let clock = SimulationClock::start(if self.runs_in_real_time() { 1.0 } else { speed });
        let (controller, instrument, home_instrument) = match &self.source {
            Source::Simulated(setup) => self.simulated(setup, &clock)?,
            Source::Replay(folder) => {
                let dataset = read_dataset(folder)?.dataset;
                let place = folder.display().to_string();
                check_robot(&place, &dataset.robot, self.robot())?;
                let replay = ReplayController::new(dataset, Arc::new(clock.clone()));
                let replay = replay.map_err(|e| LinkError::Setup(format!("{place}: {e}")))?;
                (Box::new(replay) as Box<dyn Controller>, None, None)
            }
            Source::Ads(address, mapping, options) => {
                let clock = Arc::new(SystemClock::start());
                let robot = self.robot();
                let ads = ads::controller(address.clone(), mapping, robot, *options, clock)?;
                (Box::new(ads) as Box<dyn Controller>, None, None)
            }
            Source::OpcUa(server, mapping) => {
                let clock = Arc::new(SystemClock::start());
                let robot = self.robot();
                let opcua = opcua::controller((**server).clone(), mapping, robot, clock)?;
                (Box::new(opcua) as Box<dyn Controller>, None, None)
            }
        };
        let laser = ExternalLaser::of(&self.laser, Arc::new(SystemClock::start()));
        let manual_laser = laser.as_ref().and_then(ExternalLaser::manual);
        Ok(Opened {
            controller: GuardedController::new(controller, self.limits.clone())
                .seen_before(self.seen.clone())
                .with_laser(laser.map(ExternalLaser::into_source)),
            manual_laser,
            instrument,
            home_instrument,
            clock,
        })
    }

    fn simulated(
        &self,
        setup: &SimulatedSetup,
        clock: &SimulationClock,
    ) -> Result<Parts, OpenError> {
        let mut setup = setup.clone();
        if let Some(path) = &self.values_file
            && let Some(held) = held_values(path)?
        {
            let values = held.into_iter().map(|held| (held.name, held.value));
            setup.parameters = values.collect();
        }
        let seed = setup.seed.wrapping_add(1);
        let home_sds = setup
            .truth
            .home
            .map(|home| (home.position_sd_m, home.orientation_sd_rad));
        let robot = SimulatedRobot::new(setup, Arc::new(clock.clone()))?;
        let (position_sd_m, orientation_sd_rad) = TRACKER_SD;
        let tracker = robot.tracker(position_sd_m, orientation_sd_rad, seed);
        let seed = seed_after(seed.wrapping_add(1), self.home_measurements);
        let home = home_sds.map(|(position_sd_m, orientation_sd_rad)| {
            Box::new(robot.tracker(position_sd_m, orientation_sd_rad, seed)) as Box<dyn Instrument>
        });
        let controller: Box<dyn Controller> = match &self.values_file {
            Some(path) => Box::new(Stored {
                inner: robot,
                path: path.clone(),
            }),
            None => Box::new(robot),
        };
        Ok((controller, Some(Box::new(tracker)), home))
    }
}

/// Checks that a recording belongs to the robot of the session.
fn check_robot(place: &str, recorded: &Robot, expected: &Robot) -> Result<(), LinkError> {
    let names = |robot: &Robot| -> Vec<String> {
        let cables = robot.cables.iter();
        cables.map(|cable| cable.name.clone()).collect()
    };
    let refuse = |text: String| Err(LinkError::Setup(format!("{place}: {text}")));
    if recorded.name != expected.name {
        return refuse(format!(
            "found a recording of the robot \"{}\", expected one of \"{}\", the robot of the session",
            recorded.name, expected.name
        ));
    }
    if names(recorded) != names(expected) {
        return refuse(
            "found cables with other names than those of the session's robot".to_owned(),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_session::{Session, Timestamp};

    use super::*;
    use crate::controllers::ControllerChoice;

    fn open(choice: &str, session: &Session) -> Result<Opened, OpenError> {
        let choice: ControllerChoice = choice.parse().expect("a choice");
        ConnectionSetup::chosen(session, &[], &choice, None).open(1.0)
    }

    fn session(name: &str) -> Session {
        let robot = presets::find(name).expect("a preset").robot;
        Session::new("test", robot, Timestamp::from_unix_seconds(0))
    }

    #[test]
    fn a_simulated_robot_comes_with_an_instrument() {
        let mut opened = open("sim", &session("mini")).expect("opened");
        assert!(opened.instrument.is_some());
        opened.controller.connect().expect("connected");
        assert_eq!(opened.controller.identity(), "Simulated mini");
    }

    #[test]
    fn what_is_not_there_is_said_in_a_sentence() {
        let told = |choice: &str| open(choice, &session("mini")).err().map(|e| e.to_string());
        let missing = told("replay:no/such/folder").expect("an error");
        assert!(missing.contains("no/such/folder: not found"), "{missing}");
        // Opening a controller does not use the network.
        assert_eq!(told("ads:robot/1.2.3.4.1.1"), None);
        assert_eq!(told("opc.tcp://robot"), None);
    }
}
