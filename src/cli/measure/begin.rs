//! Creation of a new session.

use std::path::Path;

use crate::BadInput;
use anyhow::Result;
use tautline_core::robot::Robot;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, true_robot};
use tautline_session::{LogEntry, Phase, Session, Simulator, read_session};
use tautline_workflow::clock;
use tautline_workflow::controllers::ControllerChoice;
use tautline_workflow::machines;

use super::Arguments;
use crate::input;

/// A session of the requested robot, without measurements.
pub fn session(arguments: &Arguments, choice: &ControllerChoice) -> Result<Session> {
    if let Some(path) = &arguments.series_of {
        return another_series(path, arguments);
    }
    let mut robot = match (&arguments.robot, choice) {
        (Some(name), _) => input::robot(name)?.robot,
        (None, ControllerChoice::Replay(folder)) => input::dataset(folder)?.robot,
        (None, _) => {
            let place = arguments.session.display();
            let message = format!("{place}: not found, expected --robot to create a new session");
            return Err(BadInput::new(message));
        }
    };
    arguments.hypotheses.add_to(&mut robot)?;
    let stem = arguments.session.file_stem();
    let name = stem.map_or(robot.name.clone(), |s| s.to_string_lossy().into_owned());
    let now = clock::now();
    let mut session = Session::new(name, robot, now);
    if *choice == ControllerChoice::Simulated {
        session.simulator = Some(Simulator {
            truth: truth(&session.robot, arguments)?,
            seed: arguments.seed,
            revealed: false,
        });
    } else if !arguments.effects.is_empty() {
        let message = "--effect: only a new session with --controller sim can have hidden effects";
        return Err(BadInput::new(message));
    }
    session.record(LogEntry {
        time: now,
        phase: Phase::Session,
        text: format!("Created by command with the controller {choice}."),
    });
    Ok(session)
}

/// A session with the same robot, plan and settings as another one, without measurements.
fn another_series(path: &Path, arguments: &Arguments) -> Result<Session> {
    let read = read_session(path)?;
    let stem = arguments.session.file_stem();
    let name = stem.map_or(read.value.name.clone(), |s| {
        s.to_string_lossy().into_owned()
    });
    let mut session = read.value.another_series(name, clock::now());
    session.record(LogEntry {
        time: clock::now(),
        phase: Phase::Session,
        text: format!("Another series of {}.", path.display()),
    });
    Ok(session)
}

/// The true robot: the measured one of a known machine, otherwise drawn from the priors.
fn truth(robot: &Robot, arguments: &Arguments) -> Result<Robot> {
    let machine = arguments.robot.as_deref().and_then(machines::find);
    let measured = machine.and_then(|machine| machine.measured_entry_points_m);
    let options = SimulationOptions {
        geometry: measured.map_or(TrueGeometry::Drawn, TrueGeometry::EntryPoints),
        effects: arguments.effects.settings(robot)?,
        ..SimulationOptions::new(0, arguments.seed)
    };
    Ok(true_robot(robot, &options))
}
