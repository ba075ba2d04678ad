//! The record of a robot: the sessions of one machine in the order of time, and what changed between them.

mod document;
mod figure;
mod rows;
mod words;

use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::slice;

use tautline_core::comparison::Identified;
use tautline_core::estimation::Control;
use tautline_core::geometry::Vec3;
use tautline_core::history::{self, CERTAIN, DatedRun, Forecast, History, forecast, smooth};
use tautline_core::planning::Volume;
use tautline_core::robot::Robot;
use tautline_files::open_input;
use tautline_session::{
    EVENTS, Import, Loaded, RobotEvent, Session, Stage, Timestamp, import, is_own, read_events,
};

use crate::accuracy;
use crate::comparison::{as_session, identify_to_compare};
use crate::identification::{Identification, effects_title};
use crate::wording::count;
pub use document::{
    ChangeDocument, Changed, DriftDocument, HistoryDocument, HistorySession, NextCalibration,
    ToleranceOf,
};
pub use figure::lane;
pub use rows::{RecordRow, pulleys_csv, rows};
use words::unit_of;
pub use words::{changes, next_calibration, next_calibration_after, part_name, size_of_jump};

/// Default tolerance: largest tolerable displacement of a pulley (m). It is larger than the uncertainty of the pulleys of a
/// small robot after one calibration with the usual number of poses, so that a first record has a date.
pub const TOLERANCE_M: f64 = 10e-3;

/// Default tolerance of the position of the platform (m).
pub const POSITION_TOLERANCE_M: f64 = 1e-3;

/// Quantity with a tolerance until the next calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Displacement of a pulley from its value in the last session (m).
    Pulley(f64),
    /// Root mean square position error of the platform over a volume (m).
    Position {
        /// The tolerance (m).
        limit_m: f64,
        /// The volume; `None` for the workspace of the robot.
        volume: Option<Volume>,
    },
}

impl Default for Tolerance {
    fn default() -> Self {
        Self::Pulley(TOLERANCE_M)
    }
}

impl Tolerance {
    /// The tolerance (m).
    #[must_use]
    pub fn limit_m(self) -> f64 {
        match self {
            Self::Pulley(limit_m) | Self::Position { limit_m, .. } => limit_m,
        }
    }

    /// The same with another number (m).
    #[must_use]
    pub fn with_limit(self, limit_m: f64) -> Self {
        match self {
            Self::Pulley(_) => Self::Pulley(limit_m),
            Self::Position { volume, .. } => Self::Position { limit_m, volume },
        }
    }
}

/// Distance between pulleys of two descriptions, over the size of the frame, from which they are of different robots.
const OTHER_FRAME: f64 = 0.1;
/// Days between sessions without dates, of which only the order is known.
pub(crate) const DAYS_WITHOUT_DATE: f64 = 30.0;
const SECONDS_PER_DAY: f64 = 86_400.0;

/// One session of a record.
#[derive(Debug, Clone)]
pub struct RecordedSession {
    /// Its file or folder.
    pub path: PathBuf,
    /// Name of the file or folder without extension.
    pub name: String,
    /// Time of the readings, if known.
    pub time: Option<Timestamp>,
    /// Result of the identification.
    pub identification: Identification,
    /// Whether the readings are of a simulated robot.
    pub is_simulated: bool,
    /// Whether values were written to the controller in the session.
    pub adjusted: bool,
    /// Operator who wrote values to the controller or accepted the robot in the session.
    pub operator: Option<String>,
    /// Mean pose accuracy that was measured after the adjustment (m).
    pub accuracy_after_m: Option<f64>,
    /// Effects in the model of the session, with their cables.
    pub effects: Vec<String>,
}

impl RecordedSession {
    /// The date when its poses were read, or its name if that is unknown.
    #[must_use]
    pub fn date_or_name(&self) -> String {
        self.time.map_or_else(|| self.name.clone(), date)
    }
}

/// The date of a point in time: `2018-07-23`.
#[must_use]
pub fn date(time: Timestamp) -> String {
    time.to_string()[..10].to_owned()
}

/// The sessions of one machine, in the order of time.
#[derive(Debug, Clone, Default)]
pub struct RobotRecord {
    /// The sessions.
    pub sessions: Vec<RecordedSession>,
    /// Events in the life of the robot, in the order of time, from `events.csv` in the folder.
    pub events: Vec<RobotEvent>,
    /// Omissions and other notices, one sentence each.
    pub notices: Vec<String>,
}

/// Errors of a record.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The folder cannot be read.
    #[error("{}: {error}", .folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Reason.
        error: std::io::Error,
    },
    /// A session cannot be read or identified.
    #[error("{}: {message}", .path.display())]
    Session {
        /// Its file or folder.
        path: PathBuf,
        /// Reason, one sentence.
        message: String,
    },
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] tautline_files::ReadError),
    /// Reading was stopped.
    #[error("reading the record was stopped")]
    Stopped,
    /// The sessions have no common history.
    #[error("{}: {message}", .folder.display())]
    History {
        /// The folder.
        folder: PathBuf,
        /// Reason, one sentence.
        message: String,
    },
}

/// History of a robot with its forecast.
#[derive(Debug, Clone)]
pub struct RobotHistory {
    /// States, jumps and drifts.
    pub history: History,
    /// Whether all sessions have dates; otherwise rates and dates are not stated.
    pub is_dated: bool,
    /// Quantity with a tolerance.
    pub tolerance: Tolerance,
    /// Forecast of the next calibration; `None` without dates.
    pub forecast: Option<Forecast>,
}

impl RobotHistory {
    /// Whether any jump or drift is certain.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        let jumps = self.history.jumps.iter().map(|jump| jump.probability);
        let drifts = self.history.evident_drifts().map(|drift| drift.probability);
        jumps
            .chain(drifts)
            .any(|probability| probability >= CERTAIN)
    }

    /// Changes the tolerance, on which the date of the next calibration depends. `record` must be the one of this history.
    /// # Errors
    /// One sentence without its end, if the position error of the platform cannot be predicted.
    pub fn set_tolerance(
        &mut self,
        record: &RobotRecord,
        tolerance: Tolerance,
    ) -> Result<(), String> {
        self.forecast = match self.is_dated {
            true => Some(record.forecast(&self.history, tolerance)?),
            false => None,
        };
        self.tolerance = tolerance;
        Ok(())
    }
}

impl RobotRecord {
    /// Reads and identifies all sessions and dataset folders in a folder, in the order of the times of their readings or, if
    /// one has none, of their names. `observe` gets the number of sessions that are read and of all, and may stop.
    ///
    /// # Errors
    /// If a session cannot be read or identified, or is of another robot than the first one; or if it was stopped.
    pub fn open(
        folder: &Path,
        now: Timestamp,
        observe: &mut dyn FnMut(usize, usize) -> Control,
    ) -> Result<Self, RecordError> {
        let unreadable = |error| RecordError::Folder {
            folder: folder.to_owned(),
            error,
        };
        let paths = entries(folder).map_err(unreadable)?;
        let mut record = Self::default();
        for (index, path) in paths.iter().enumerate() {
            if observe(index, paths.len()) == Control::Cancel {
                return Err(RecordError::Stopped);
            }
            if path.file_name().is_some_and(|name| name == EVENTS) {
                record.read_events(path)?;
                continue;
            }
            if !is_own(path)? {
                record.notices.push(format!(
                    "{}: neither a session nor a dataset folder, left out",
                    path.display()
                ));
                continue;
            }
            let read = dated_session(path, now)?;
            record.notices.extend(read.notices);
            let (session, time) = read.value;
            record.add(path.clone(), &session, time)?;
        }
        record.sort();
        Ok(record)
    }

    fn read_events(&mut self, path: &Path) -> Result<(), RecordError> {
        let file = path.display().to_string();
        let read = read_events(BufReader::new(open_input(path, &file)?), &file)?;
        self.notices.extend(read.notices);
        self.events = read.value;
        Ok(())
    }

    /// Whether an event happened between the previous session and this one.
    fn follows_event(&self, index: usize) -> bool {
        let Some(before) = index.checked_sub(1) else {
            return false;
        };
        let [before, this] = [before, index].map(|index| &self.sessions[index]);
        let is_between = |from: Timestamp, to: Timestamp| {
            let mut events = self.events.iter();
            events.any(|event| from < event.time && event.time <= to)
        };
        let times = before.time.zip(this.time);
        before.adjusted || times.is_some_and(|(from, to)| is_between(from, to))
    }

    fn add(
        &mut self,
        path: PathBuf,
        session: &Session,
        time: Option<Timestamp>,
    ) -> Result<(), RecordError> {
        let failed = |message: String| RecordError::Session {
            path: path.clone(),
            message,
        };
        let identification = identify_to_compare(session, &mut |_| Control::Continue);
        let identification = identification.map_err(|error| failed(error.to_string()))?;
        // Not all sessions need to have a serial number.
        for known in &self.sessions {
            let robot = &known.identification.dataset.robot;
            same_machine(robot, &session.robot).map_err(|why| {
                let known = known.path.display();
                failed(format!("is of another robot: {why} as in {known}"))
            })?;
        }
        self.sessions.push(RecordedSession {
            name: name_of(&path),
            time,
            identification,
            is_simulated: session.is_simulated(),
            adjusted: !session.adjustments().is_empty(),
            operator: operator(session),
            accuracy_after_m: accuracy_after_m(session),
            effects: (session.settings.identification.effects.iter())
                .map(|effect| effects_title(&session.robot, slice::from_ref(effect)))
                .collect(),
            path,
        });
        Ok(())
    }

    /// Sorts the sessions by time, if all have one.
    fn sort(&mut self) {
        let undated: Vec<&str> = (self.sessions.iter())
            .filter(|session| session.time.is_none())
            .map(|session| session.name.as_str())
            .collect();
        if undated.is_empty() {
            self.sessions.sort_by_key(|session| session.time);
        } else if !self.events.is_empty() {
            self.notices.push(format!(
                "{EVENTS} is not used: no date when the poses were read: {}",
                undated.join(", ")
            ));
        } else if undated.len() < self.sessions.len() {
            self.notices.push(format!(
                "no date when the poses were read: {}; all sessions are taken in the order of their names",
                undated.join(", ")
            ));
        }
    }

    /// Smooths the state of the robot over all sessions. `folder` is the record's, for messages.
    ///
    /// # Errors
    /// If there are fewer than two sessions, they are of different robots, or the position error of the platform cannot be predicted
    /// although it has a tolerance.
    pub fn history(
        &self,
        folder: &Path,
        tolerance: Tolerance,
    ) -> Result<RobotHistory, RecordError> {
        let failed = |message: String| RecordError::History {
            folder: folder.to_owned(),
            message,
        };
        let is_dated = self.sessions.iter().all(|session| session.time.is_some());
        let problems = self
            .sessions
            .iter()
            .map(|session| session.identification.problem());
        let problems: Result<Vec<_>, _> = problems.collect();
        let problems = problems.map_err(|error| failed(error.to_string()))?;
        let mut runs = Vec::with_capacity(problems.len());
        for (index, (session, problem)) in self.sessions.iter().zip(&problems).enumerate() {
            let seconds = session.time.map(|time| time.unix_seconds() as f64);
            let by_order = DAYS_WITHOUT_DATE * index as f64;
            runs.push(DatedRun {
                run: Identified {
                    problem,
                    solution: &session.identification.solution,
                },
                days: seconds
                    .filter(|_| is_dated)
                    .map_or(by_order, |s| s / SECONDS_PER_DAY),
                follows_event: self.follows_event(index),
            });
        }
        let history = smooth(&runs).map_err(|error| failed(error.to_string()))?;
        let mut found = RobotHistory {
            forecast: None,
            history,
            is_dated,
            tolerance,
        };
        found.set_tolerance(self, tolerance).map_err(failed)?;
        Ok(found)
    }

    fn forecast(&self, history: &History, tolerance: Tolerance) -> Result<Forecast, String> {
        let identification = &self.sessions[self.sessions.len() - 1].identification;
        let problem = identification
            .problem()
            .map_err(|error| error.to_string())?;
        let tolerance = match tolerance {
            Tolerance::Pulley(limit_m) => history::Tolerance::Pulley(limit_m),
            Tolerance::Position { limit_m, volume } => history::Tolerance::Position {
                limit_m,
                volume,
                last: Identified {
                    problem: &problem,
                    solution: &identification.solution,
                },
            },
        };
        forecast(history, tolerance).map_err(|error| error.to_string())
    }

    /// The robot as the first session describes it.
    ///
    /// # Panics
    /// If there are no sessions.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.sessions[0].identification.dataset.robot
    }

    /// The record in a few words: `12 sessions of mini`.
    ///
    /// # Panics
    /// If there are no sessions.
    #[must_use]
    pub fn title(&self) -> String {
        let sessions = count(self.sessions.len(), "session");
        format!("{sessions} of {}", self.robot().label())
    }
}

/// Paths in a folder, in the order of names, without hidden ones and notes in Markdown.
fn entries(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut paths = entries.collect::<std::io::Result<Vec<PathBuf>>>()?;
    paths.retain(|path| {
        let name = path.file_name();
        let is_hidden = name.is_some_and(|name| name.to_string_lossy().starts_with('.'));
        !is_hidden && path.extension().is_none_or(|extension| extension != "md")
    });
    paths.sort();
    Ok(paths)
}

/// Whether a path is the record of a robot: a folder with at least two sessions or dataset folders, which is not one itself.
#[must_use]
pub fn is_record(path: &Path) -> bool {
    let is_session = |path: &PathBuf| is_own(path).unwrap_or(false);
    let holds =
        || entries(path).is_ok_and(|paths| paths.iter().filter(|p| is_session(p)).nth(1).is_some());
    path.is_dir() && !is_own(path).unwrap_or(false) && holds()
}

/// Operator who last wrote values to the controller, or else accepted the robot.
fn operator(session: &Session) -> Option<String> {
    let wrote = session.adjustments().last().map(|last| &last.operator);
    let accepted = session.verifications().iter().rev();
    let accepted = accepted.filter_map(|run| run.accepted.as_ref());
    let known = wrote.or(accepted.map(|accepted| &accepted.operator).next());
    known.filter(|name| !name.trim().is_empty()).cloned()
}

/// Mean pose accuracy of the last verification after an adjustment.
fn accuracy_after_m(session: &Session) -> Option<f64> {
    let mut runs = session.verifications().iter().rev();
    let last = runs.find(|run| run.stage == Stage::After)?;
    let figures = accuracy::figures(&last.rows).ok()?;
    Some(figures.poses?.mean_accuracy_m)
}

/// Name of a file without the extensions of sessions, or of a folder.
fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".json").unwrap_or(&name);
    name.strip_suffix(".tautline").unwrap_or(name).to_owned()
}

/// Reads a session, or a dataset folder as one, with the time when its poses were read, if known.
///
/// # Errors
/// If it cannot be read, or is neither.
pub fn dated_session(
    path: &Path,
    now: Timestamp,
) -> Result<Loaded<(Session, Option<Timestamp>)>, RecordError> {
    let loaded = import(path, None)?;
    // A folder without a date was measured at an unknown time, not when it is read.
    let of_folder = match &loaded.value {
        Import::Dataset(folder) => Some(folder.measured_at),
        _ => None,
    };
    let session = as_session(path, loaded.value, now);
    let (session, notices) = session.map_err(|message| RecordError::Session {
        path: path.to_owned(),
        message,
    })?;
    let time = of_folder.unwrap_or_else(|| session.measured());
    Ok(Loaded {
        value: (session, time),
        notices: [loaded.notices, notices].concat(),
    })
}

/// Checks that two descriptions are of one machine: the same serial number, if both have one, and pulleys at about the same
/// places.
///
/// # Errors
/// One sentence without its end, which names the other description.
pub fn same_machine(known: &Robot, other: &Robot) -> Result<(), String> {
    let numbers = [known, other].map(|robot| robot.serial_number.as_ref());
    if let [Some(known), Some(other)] = numbers
        && known != other
    {
        return Err(format!(
            "serial_number: found {other:?}, expected {known:?}"
        ));
    }
    let names = [known, other].map(|robot| {
        let cables = robot.cables.iter();
        cables.map(|cable| cable.name.as_str()).collect::<Vec<_>>()
    });
    if names[0] != names[1] {
        return Err(format!(
            "found the cables {}, expected {}",
            names[1].join(", "),
            names[0].join(", ")
        ));
    }
    let size = known.frame_size_m().unwrap_or(1.0);
    for (cable, moved) in known.cables.iter().zip(&other.cables) {
        let [a, b] = [cable, moved].map(|c| Vec3::from(c.pulley.entry_point_m));
        let apart = (a - b).norm();
        if apart > OTHER_FRAME * size {
            return Err(format!(
                "found the pulley of {} {:.0} mm away, expected it",
                cable.name,
                1e3 * apart
            ));
        }
    }
    Ok(())
}

/// Days from one point in time to another.
#[must_use]
pub fn days_between(from: Timestamp, to: Timestamp) -> f64 {
    (to.unix_seconds() - from.unix_seconds()) as f64 / SECONDS_PER_DAY
}

/// Time a number of days after another.
#[must_use]
pub fn days_after(time: Timestamp, days: f64) -> Timestamp {
    Timestamp::from_unix_seconds(time.unix_seconds() + (days * SECONDS_PER_DAY) as i64)
}
