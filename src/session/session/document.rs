//! The session file.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::measurement::Measurements;
use tautline_core::robot::{FieldError, Robot};

use super::{
    Adjustment, Connection, LaserSettings, LogEntry, MeasurementTable, NamedValue, PlannedPose,
    ResultRecord, Session, Settings, Simulator, Timestamp, Verification, below, check, connection,
    fail,
};
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
    /// Labels of measured poses that are left out.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    excluded: BTreeSet<i64>,
    /// Poses that are to be measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    plan: Vec<PlannedPose>,
    /// Raw data of the phases around the poses.
    #[serde(default)]
    phases: PhaseData,
    /// How identification and diagnosis are to work.
    #[serde(default)]
    settings: Settings,
    /// Results, the oldest first.
    #[serde(default)]
    results: Vec<ResultRecord>,
    /// The virtual robot of a demonstration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    simulator: Option<Simulator>,
    /// The parameters that the controller holds.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    controller: Vec<NamedValue>,
    /// Where the laser distance comes from.
    #[serde(default, skip_serializing_if = "LaserSettings::is_controller")]
    laser_source: LaserSettings,
    /// How the robot's own controller is reached.
    #[serde(default, skip_serializing_if = "Connection::is_empty")]
    connection: Connection,
    /// Adjustments of the controller, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    adjustments: Vec<Adjustment>,
    /// Runs with an external instrument, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    verifications: Vec<Verification>,
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
            return fail("/name", "found an empty text, expected a name");
        }
        if self.modified < self.created {
            let message = format!(
                "found {}, expected a time not before {}",
                self.modified, self.created
            );
            return fail("/modified", message);
        }
        self.robot.check().map_err(|error| below("/robot", error))?;
        self.measurements
            .check()
            .map_err(|error| below("/measurements", error))?;
        let alpha = self.settings.diagnosis.alpha;
        if !(alpha > 0.0 && alpha < 1.0) {
            let message = format!("found {alpha}, expected a probability between 0 and 1");
            return fail("/settings/diagnosis/alpha", message);
        }
        check::phases(&self.phases, &self.robot)?;
        check::effects(&self.settings.identification.effects, &self.robot)?;
        self.excluded
            .iter()
            .try_for_each(|label| check::excludable(*label))?;
        check::plan(&self.plan)?;
        if let Some(simulator) = &self.simulator {
            let truth = simulator.truth.check();
            truth.map_err(|error| below("/simulator/truth", error))?;
        }
        check::controller(&self.controller)?;
        let laser = self.laser_source.check();
        laser.map_err(|error| below("/laser_source", error))?;
        connection::check(&self.connection, &self.robot)?;
        check::adjustments(&self.adjustments)?;
        check::verifications(&self.verifications)
    }
}

impl SessionDocument {
    /// The document of a session.
    pub fn of(session: &Session) -> Self {
        Self {
            measurements: MeasurementTable::of(&session.measurements),
            ..Self::without_measurements(session)
        }
    }

    /// The document of a session, its measured poses left out.
    pub fn without_measurements(session: &Session) -> Self {
        Self {
            name: session.name.clone(),
            created: session.created,
            modified: session.modified,
            robot: session.robot.clone(),
            measurements: MeasurementTable::default(),
            excluded: session.excluded.clone(),
            plan: session.plan.clone(),
            phases: session.phases.clone(),
            settings: session.settings.clone(),
            results: session.results.clone(),
            simulator: session.simulator.clone(),
            controller: session.controller.clone(),
            laser_source: session.laser_source.clone(),
            connection: session.connection.clone(),
            adjustments: session.adjustments.clone(),
            verifications: session.verifications.clone(),
            log: session.log.clone(),
        }
    }

    /// Its results.
    pub fn results_mut(&mut self) -> &mut Vec<ResultRecord> {
        &mut self.results
    }

    /// The session of a document that passed its check, with these measurements instead of its own.
    pub fn into_session_with(self, measurements: &Measurements) -> Result<Session, FieldError> {
        let measurements = MeasurementTable::of(measurements);
        Self {
            measurements,
            ..self
        }
        .into_session()
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
            excluded: self.excluded,
            plan: self.plan,
            phases: self.phases,
            settings: self.settings,
            results: self.results,
            simulator: self.simulator,
            controller: self.controller,
            laser_source: self.laser_source,
            connection: self.connection,
            adjustments: self.adjustments,
            verifications: self.verifications,
            log: self.log,
        })
    }
}
