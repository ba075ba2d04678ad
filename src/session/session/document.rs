//! The session file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::{FieldError, Robot};

use super::measurement_table::MeasurementTable;
use super::{LogEntry, ResultRecord, Session, Settings, Timestamp};
use crate::json::Document;
use crate::phases::PhaseData;

/// A session as it is stored. The robot inside has no `format` and `version` of its own: the
/// session's version covers it, so a migration step of the robot is one of the session, too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SessionDocument {
    /// Name by which the operator knows the session.
    name: String,
    /// When it was begun (RFC 3339, UTC).
    created: Timestamp,
    /// When it was last changed (RFC 3339, UTC).
    modified: Timestamp,
    /// The robot as in `robot.json`, without `format` and `version`.
    robot: Robot,
    /// Measured poses.
    #[serde(default)]
    measurements: MeasurementTable,
    /// Raw data of the phases around the poses.
    #[serde(default)]
    phases: PhaseData,
    /// How identification and diagnosis are to work.
    #[serde(default)]
    settings: Settings,
    /// Results, the oldest first.
    #[serde(default)]
    results: Vec<ResultRecord>,
    /// Steps of the operator, the oldest first.
    #[serde(default)]
    log: Vec<LogEntry>,
}

impl Document for SessionDocument {
    const FORMAT: &'static str = "tautline-session";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;

    fn check(&self) -> Result<(), FieldError> {
        if self.name.trim().is_empty() {
            return fail("/name".into(), "found an empty text, expected a name");
        }
        if self.modified < self.created {
            let message = format!(
                "found {}, expected a time not before {}",
                self.modified, self.created
            );
            return fail("/modified".into(), message);
        }
        self.robot.check().map_err(|error| below("/robot", error))?;
        self.measurements
            .check()
            .map_err(|error| below("/measurements", error))?;
        let alpha = self.settings.diagnosis.alpha;
        if !(alpha > 0.0 && alpha < 1.0) {
            let message = format!("found {alpha}, expected a probability between 0 and 1");
            return fail("/settings/diagnosis/alpha".into(), message);
        }
        self.check_cables()
    }
}

impl SessionDocument {
    /// The document of a session.
    pub fn of(session: &Session) -> Self {
        Self {
            name: session.name.clone(),
            created: session.created,
            modified: session.modified,
            robot: session.robot.clone(),
            measurements: MeasurementTable::of(&session.measurements),
            phases: session.phases.clone(),
            settings: session.settings.clone(),
            results: session.results.clone(),
            log: session.log.clone(),
        }
    }

    /// The session of a document that passed its check.
    pub fn into_session(self) -> Result<Session, FieldError> {
        let measurements = self
            .measurements
            .into_measurements(&self.robot)
            .map_err(|error| below("/measurements", error))?;
        Ok(Session {
            name: self.name,
            created: self.created,
            modified: self.modified,
            robot: self.robot,
            measurements,
            phases: self.phases,
            settings: self.settings,
            results: self.results,
            log: self.log,
        })
    }

    /// Raw data and settings name cables and sensors that exist.
    fn check_cables(&self) -> Result<(), FieldError> {
        let cables = self.robot.cable_count();
        let winches = self.phases.winch.iter().map(|pair| pair.cable);
        let forces = self.phases.force.iter().map(|pair| pair.cable);
        let sensors = self.phases.home.iter().map(|reading| reading.sensor);
        check_below("/phases/winch", "cable", winches, cables)?;
        check_below("/phases/force", "cable", forces, cables)?;
        check_below("/phases/home", "sensor", sensors, 6)?;
        for (k, free) in self.settings.identification.effects.iter().enumerate() {
            if let Some(name) = &free.cable
                && self.robot.cable_index(name).is_none()
            {
                let pointer = format!("/settings/identification/effects/{k}/cable");
                return fail(
                    pointer,
                    format!("found {name:?}, expected the name of a cable"),
                );
            }
        }
        Ok(())
    }
}

fn check_below(
    list: &str,
    key: &str,
    mut indices: impl Iterator<Item = usize>,
    count: usize,
) -> Result<(), FieldError> {
    match indices.position(|index| index >= count) {
        Some(k) => fail(
            format!("{list}/{k}/{key}"),
            format!(
                "found a {key} that is not there, expected 0 to {}",
                count - 1
            ),
        ),
        None => Ok(()),
    }
}

fn below(parent: &str, error: FieldError) -> FieldError {
    FieldError {
        pointer: format!("{parent}{}", error.pointer),
        ..error
    }
}

fn fail(pointer: String, message: impl Into<String>) -> Result<(), FieldError> {
    Err(FieldError {
        pointer,
        message: message.into(),
    })
}
