//! A connected controller and its clock.

use crate::output::{message, note};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use tautline_link::laser::ManualLaser;
use tautline_link::{Activity, Clock, Controller, Instrument, LinkError};

use super::LinkArguments;
use super::credentials::SignIn;
use crate::BadInput;
use tautline_workflow::controllers::{ConnectionSetup, OpenError, SimulationClock};

/// Sampling interval in real time.
const TICK: Duration = Duration::from_millis(20);
/// Shortest sampling interval of a robot that runs faster than real time.
const SHORTEST_TICK: Duration = Duration::from_millis(1);
/// Sampling interval of a robot that runs as fast as it can be computed (s).
const STEP_S: f64 = 0.05;
/// Longest time step of a simulated robot (s).
const LONGEST_STEP_S: f64 = 0.2;
/// Longest time in which a controller's watchdog ends the release of a program that was killed.
const WATCHDOG: Duration = Duration::from_secs(5);
/// Timeout of homing (s) on the controller's clock.
const HOMING_S: f64 = 120.0;

/// Passage of time.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pace {
    /// Equal steps without waiting.
    Computed,
    /// Wall-clock time times this factor, for a simulated robot.
    Faster(f64),
    /// Wall-clock time.
    Real,
}

/// A connected controller.
pub struct Connection {
    /// The controller, guarded by its limits.
    pub controller: Box<dyn Controller>,
    /// The external instrument of a simulated robot.
    pub instrument: Option<Box<dyn Instrument>>,
    /// The instrument that measures the home pose of a simulated robot.
    pub home_instrument: Option<Box<dyn Instrument>>,
    /// The laser whose distances are typed by the operator.
    pub manual_laser: Option<ManualLaser>,
    /// Time after which nothing that was sent over a lost connection can still arrive (s).
    pub late_s: f64,
    clock: SimulationClock,
    pace: Pace,
}

impl Connection {
    /// Opens the connection; without a `speed`, a robot that is not real runs as fast as it can be computed.
    pub fn open(setup: &ConnectionSetup, link: &LinkArguments, speed: Option<f64>) -> Result<Self> {
        let pace = match speed {
            _ if setup.runs_in_real_time() => Pace::Real,
            Some(speed) => Pace::Faster(speed),
            None => Pace::Computed,
        };
        let signed_in = SignIn::of(setup, &link.passwords)?;
        let setup = &signed_in.setup;
        let opened = setup.open(speed.unwrap_or(1.0));
        let opened = opened.map_err(|error| match error {
            OpenError::Read(error) => error.into(),
            OpenError::Link(error) => link_error(error),
        })?;
        let mut controller: Box<dyn Controller> = Box::new(opened.controller);
        let connected = controller.connect();
        connected.map_err(|error| signed_in.refused(error))?;
        signed_in.accepted();
        for warning in setup.warnings(controller.protection().as_ref()) {
            note!("{warning}");
        }
        if let Some(sentence) = setup.robot().unchecked_tensions() {
            note!("{sentence}");
        }
        Ok(Self {
            controller,
            instrument: opened.instrument,
            home_instrument: opened.home_instrument,
            manual_laser: opened.manual_laser,
            late_s: setup.late_s(),
            clock: opened.clock,
            pace,
        })
    }

    /// Arms the controller. The release of a program that was killed is waited for, until the controller's watchdog ends it.
    pub fn arm(&mut self) -> Result<()> {
        let begun = Instant::now();
        let mut is_told = false;
        loop {
            match self.controller.arm() {
                Err(error @ LinkError::Occupied(_))
                    if begun.elapsed() < WATCHDOG && !super::interrupt::requested() =>
                {
                    if !std::mem::replace(&mut is_told, true) {
                        note!("{error}: waiting up to {} s", WATCHDOG.as_secs());
                    }
                    thread::sleep(10 * TICK);
                }
                armed => return armed.map_err(link_error),
            }
        }
    }

    /// Time (s) on the controller's clock.
    pub fn now_s(&self) -> f64 {
        self.clock.now_s()
    }

    /// Waits for the next sample.
    pub fn step(&self) {
        match self.pace {
            Pace::Computed => self.clock.advance(STEP_S),
            Pace::Faster(speed) => {
                thread::sleep(TICK.div_f64(speed.max(1.0)).max(SHORTEST_TICK));
                self.clock.follow_real_time(Some(LONGEST_STEP_S));
            }
            Pace::Real => {
                thread::sleep(TICK);
                self.clock.follow_real_time(None);
            }
        }
    }

    /// Whether time stands still during a computation. For a robot that runs as fast as it can be computed, hours would
    /// otherwise pass meanwhile.
    pub fn stands_still(&self) -> bool {
        let stands = self.pace == Pace::Computed;
        if stands {
            thread::sleep(SHORTEST_TICK);
        }
        stands
    }

    /// Moves home and waits until the platform is there; `false` if the operator interrupted it.
    pub fn go_home(&mut self) -> Result<bool> {
        let begun_s = self.now_s();
        self.controller.home().map_err(link_error)?;
        loop {
            self.step();
            // A controller reports its state together with its readings, and stops if they are not requested.
            self.controller.sample().map_err(link_error)?;
            match self.controller.state().activity {
                Activity::Moving => {}
                Activity::Fault(text) => return Err(link_error(LinkError::Fault(text))),
                Activity::Disconnected => {
                    return Err(anyhow!("the connection to the controller is lost"));
                }
                Activity::Connected | Activity::Still => return Ok(true),
            }
            if super::interrupt::requested() {
                self.stop();
                return Ok(false);
            }
            if self.now_s() - begun_s > HOMING_S {
                self.stop();
                return Err(anyhow!(
                    "the platform has not reached home after {HOMING_S:.0} s"
                ));
            }
        }
    }

    /// Stops the platform.
    pub fn stop(&mut self) {
        if let Err(error) = self.controller.stop() {
            message(format!("The stop command failed: {error}"));
        }
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.controller.disconnect();
    }
}

/// Converts errors; those of the setup are bad input, which the user can correct.
pub fn link_error(error: LinkError) -> anyhow::Error {
    match error {
        LinkError::Setup(text) => BadInput::new(text),
        LinkError::Untrusted(server) => {
            let fingerprint = server.fingerprint;
            anyhow!("{server}. To trust it, add --trust-server {fingerprint}")
        }
        other => anyhow!("{other}"),
    }
}
