//! The record of a robot: the sessions of one machine in the order of time, and what changed between them.

mod document;
mod words;

use std::fs;
use std::path::{Path, PathBuf};

use tautline_core::comparison::Identified;
use tautline_core::estimation::Control;
use tautline_core::history::{DatedRun, Forecast, History, forecast, smooth};
use tautline_core::robot::Robot;
use tautline_session::{Import, Session, Timestamp, import, is_own};

use crate::comparison::{as_session, identify_to_compare};
use crate::identification::Identification;
use crate::wording::count;
pub use document::{
    ChangeDocument, DriftDocument, HistoryDocument, HistorySession, NextCalibration,
};
pub use words::{change_sentence, drift_sentence, due_sentence, part_name};

/// Largest displacement of a pulley that is tolerable if nothing else is said (m).
pub const TOLERANCE_M: f64 = 5e-3;
/// Distance between pulleys of two descriptions, over the size of the frame, from which they are of different robots.
const OTHER_FRAME: f64 = 0.1;
/// Days between sessions without dates, of which only the order is known.
const DAYS_WITHOUT_DATE: f64 = 30.0;
const SECONDS_PER_DAY: f64 = 86_400.0;

/// One session of a record.
#[derive(Debug, Clone)]
pub struct RecordedSession {
    /// Its file or folder.
    pub path: PathBuf,
    /// Name of the file or folder without extension.
    pub name: String,
    /// When its poses were read, if known.
    pub time: Option<Timestamp>,
    /// What was identified.
    pub identification: Identification,
    /// Whether values were written to the controller in it.
    pub adjusted: bool,
}

/// The sessions of one machine, in the order of time.
#[derive(Debug, Clone, Default)]
pub struct RobotRecord {
    /// The sessions.
    pub sessions: Vec<RecordedSession>,
    /// What was left out, and other notices, one sentence each.
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
    Read(#[from] tautline_session::ReadError),
    /// The sessions have no common history.
    #[error("{}: {message}", .folder.display())]
    History {
        /// The folder.
        folder: PathBuf,
        /// Reason, one sentence.
        message: String,
    },
}

/// The life of a robot and what is expected of it.
#[derive(Debug, Clone)]
pub struct RobotHistory {
    /// States, jumps and drifts.
    pub history: History,
    /// Whether all sessions have dates; otherwise nothing is said of rates and dates.
    pub is_dated: bool,
    /// When it should be calibrated again; `None` without dates.
    pub forecast: Option<Forecast>,
}

impl RobotRecord {
    /// Reads and identifies all sessions and dataset folders in a folder. They are in the order of the times when their poses were
    /// read or, if one has none, of their names.
    ///
    /// # Errors
    /// If a session cannot be read or identified, or is of another robot than the first one.
    pub fn open(folder: &Path, now: Timestamp) -> Result<Self, RecordError> {
        let unreadable = |error| RecordError::Folder {
            folder: folder.to_owned(),
            error,
        };
        let mut paths = Vec::new();
        for entry in fs::read_dir(folder).map_err(unreadable)? {
            paths.push(entry.map_err(unreadable)?.path());
        }
        paths.sort();
        let mut record = Self::default();
        for path in paths {
            let is_hidden = path
                .file_name()
                .is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if is_hidden {
                continue;
            }
            if !is_own(&path)? {
                record.notices.push(format!(
                    "{}: neither a session nor a dataset folder, left out",
                    path.display()
                ));
                continue;
            }
            let loaded = import(&path, None)?;
            record.notices.extend(loaded.notices);
            let date_of_folder = match &loaded.value {
                Import::Dataset(folder) => Some(folder.measured_at),
                _ => None,
            };
            let session =
                as_session(&path, loaded.value, now).map_err(|message| RecordError::Session {
                    path: path.clone(),
                    message,
                });
            let (session, _) = session?;
            let time = date_of_folder.unwrap_or_else(|| session.measured());
            record.add(path, &session, time)?;
        }
        record.sort();
        Ok(record)
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
        if let Some(first) = self.sessions.first() {
            let robots = [&first.identification.dataset.robot, &session.robot];
            let size = robots[0].frame_size_m().unwrap_or(1.0);
            for (own, other) in robots[0].cables.iter().zip(&robots[1].cables) {
                let points = [own, other].map(|c| c.pulley.entry_point_m);
                let apart = (0..3)
                    .map(|k| (points[0][k] - points[1][k]).powi(2))
                    .sum::<f64>()
                    .sqrt();
                if apart > OTHER_FRAME * size {
                    return Err(failed(format!(
                        "is of another robot than {}: the pulley of {} is described {:.0} mm from there",
                        first.path.display(),
                        own.name,
                        1e3 * apart
                    )));
                }
            }
        }
        self.sessions.push(RecordedSession {
            name: name_of(&path),
            time,
            identification,
            adjusted: !session.adjustments().is_empty(),
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
    /// If there are fewer than two sessions, or they are of different robots.
    pub fn history(&self, folder: &Path, tolerance_m: f64) -> Result<RobotHistory, RecordError> {
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
                follows_event: index > 0 && self.sessions[index - 1].adjusted,
            });
        }
        let history = smooth(&runs).map_err(|error| failed(error.to_string()))?;
        Ok(RobotHistory {
            forecast: is_dated.then(|| forecast(&history, tolerance_m)),
            history,
            is_dated,
        })
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
        format!("{sessions} of {}", self.robot().name)
    }
}

/// Name of a file without the extensions of sessions, or of a folder.
fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".json").unwrap_or(&name);
    name.strip_suffix(".tautline").unwrap_or(name).to_owned()
}

/// Time a number of days after another.
#[must_use]
pub fn days_after(time: Timestamp, days: f64) -> Timestamp {
    Timestamp::from_unix_seconds(time.unix_seconds() + (days * SECONDS_PER_DAY) as i64)
}
