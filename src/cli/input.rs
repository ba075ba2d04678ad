//! Reading of input files; notices about them go to standard error.

use crate::output::note;
use std::path::Path;

use crate::output::is_standard;
use crate::{BadInput, standard_input};
use anyhow::Result;
use clap::builder::RangedU64ValueParser;
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_session::{
    IdentificationSettings, Loaded, PoseLines, Session, Timestamp, import, read_dataset,
};
use tautline_workflow::comparison::as_session;
use tautline_workflow::machines::{self, Machine};
use tautline_workflow::readiness::{ReadingFault, reading_faults};
use tautline_workflow::{audit, clock};

/// Largest number of poses that is planned or measured: more take months.
pub const MOST_POSES: u64 = 10_000;
/// Largest number of poses that is simulated, or from which a plan chooses.
pub const MOST_SIMULATED: u64 = 1_000_000;

/// Parses a number that has an upper bound, as each unit takes memory and time.
pub fn at_most(most: u64) -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(..=most)
}

/// Prints the notices and returns what was read.
pub fn noticed<T>(read: Loaded<T>) -> T {
    for notice in &read.notices {
        note!("{notice}");
    }
    read.value
}

/// Reads a session, or creates one from a robot or a dataset folder; readings that cannot be right are noted.
pub fn session(path: &Path) -> Result<Session> {
    let session = read_session(path)?;
    note_faults(&session.dataset(), None);
    Ok(session)
}

fn read_session(path: &Path) -> Result<Session> {
    if is_standard(path) {
        let session = noticed(standard_input::session()?);
        if let Some(text) = audit::notice(&session) {
            note!("{text}");
        }
        return Ok(session);
    }
    if !path.exists() {
        let place = path.display();
        let message = format!("{place}: not found, expected a session file or a dataset folder");
        return Err(BadInput::new(message));
    }
    let imported = noticed(import(path, None)?);
    let (session, notices) = as_session(path, imported, clock::now()).map_err(BadInput::new)?;
    for notice in &notices {
        note!("{notice}");
    }
    Ok(session)
}

/// Measurements of a session or of a dataset folder.
pub struct Measured {
    /// Robot and measurements; without the excluded poses of a session.
    pub dataset: Dataset,
    /// Lines of the table of poses in a dataset folder.
    pub lines: Option<PoseLines>,
    /// Time at which the poses were read, if known.
    pub measured_at: Option<Timestamp>,
    /// Method and effects of a session; the defaults for a dataset folder.
    pub identification: IdentificationSettings,
}

/// Reads a session or a dataset folder.
pub fn measured(path: &Path) -> Result<Measured> {
    if !path.is_dir() {
        let session = read_session(path)?;
        return Ok(Measured {
            dataset: session.dataset(),
            lines: None,
            measured_at: session.measured(),
            identification: session.settings.identification,
        });
    }
    let read = read_dataset(path)?;
    for notice in &read.notices {
        note!("{notice}");
    }
    Ok(Measured {
        dataset: read.dataset,
        lines: Some(read.lines),
        measured_at: read.measured_at,
        identification: IdentificationSettings::default(),
    })
}

/// The measurements of a session or a dataset folder; readings that cannot be right are noted.
pub fn dataset(path: &Path) -> Result<Dataset> {
    let read = measured(path)?;
    note_faults(&read.dataset, read.lines.as_ref());
    Ok(read.dataset)
}

/// A session, or a dataset folder as one, with the time at which its poses were read, if known: the time at which a folder
/// is read says nothing about its measurement.
pub fn dated_session(path: &Path) -> Result<(Session, Option<Timestamp>)> {
    let session = session(path)?;
    let is_dated = !path.is_dir() || read_dataset(path)?.measured_at.is_some();
    let time = session.measured().filter(|_| is_dated);
    Ok((session, time))
}

/// Reads measurements from which a robot can be identified.
pub fn identifiable(path: &Path) -> Result<Measured> {
    let read = measured(path)?;
    let faults = reading_faults(&read.dataset);
    if let Some(fault) = faults.iter().find(|fault| fault.prevents_identification) {
        let message = || fault.sentence(&read.dataset, None);
        return Err(match &read.lines {
            Some(lines) => lines.error(fault.row, &fault.column, &fault.message).into(),
            None => BadInput::new(format!("{}: {}", path.display(), message())),
        });
    }
    note_sentences(&faults, &read.dataset, read.lines.as_ref());
    Ok(read)
}

fn note_faults(dataset: &Dataset, table: Option<&PoseLines>) {
    note_sentences(&reading_faults(dataset), dataset, table);
}

fn note_sentences(faults: &[ReadingFault], dataset: &Dataset, table: Option<&PoseLines>) {
    for fault in faults {
        note!("{}", fault.sentence(dataset, table));
    }
}

/// A robot named by an argument.
pub struct RobotSource {
    /// The robot.
    pub robot: Robot,
    /// The known machine, if it does not come from a file.
    pub machine: Option<Machine>,
}

/// The machine with this name, or the robot of this file.
pub fn robot(name: &str) -> Result<RobotSource> {
    if let Some(machine) = machines::find(name) {
        return Ok(RobotSource {
            robot: machine.robot.clone(),
            machine: Some(machine),
        });
    }
    let path = Path::new(name);
    if !is_standard(path) && !path.exists() {
        let names = machines::names().join(", ");
        let message = format!("--robot: found \"{name}\", expected a file or one of {names}");
        return Err(BadInput::new(message));
    }
    Ok(RobotSource {
        robot: noticed(standard_input::versioned(path)?),
        machine: None,
    })
}

/// Help of an argument that is a machine or a file.
pub fn robot_help(what: &str) -> String {
    let names = machines::names().join(", ");
    format!("{what}: a known machine ({names}) or a robot.json; - is standard input")
}
