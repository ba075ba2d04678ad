//! Sessions: one calibration of one robot, with everything that was measured and concluded.

mod adjustment;
mod basis;
mod check;
mod connection;
mod document;
mod laser_settings;
mod log;
mod measured_pose;
mod measurement_table;
mod plan;
mod result_document;
mod settings;
mod simulator;
mod timestamp;
mod verification;

use std::collections::BTreeSet;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::{FieldError, Robot};

use crate::dataset::DatasetFolder;
use crate::error::{Loaded, ReadError, WriteError, below, fail};
use crate::json::{parse_versioned, read_versioned, write_versioned};
use crate::phases::PhaseData;
use crate::poses::Columns;
pub use adjustment::{Adjustment, NamedValue, Outcome, ValueChange};
pub use connection::{
    AdsPlace, Connection, ControllerKind, OpcUaPlace, RecordingPlace, SymbolCommand, SymbolList,
    SymbolMapping, SymbolNames, SymbolParameter, SymbolPose, SymbolReadings, SymbolRotation,
    SymbolStatus, SymbolValue, is_per_cable, name_of_cable,
};
pub(crate) use document::SessionFile;
pub use laser_settings::{LaserParity, LaserPort, LaserSettings, LaserUnit, LineLaserSettings};
pub use log::{LogEntry, Phase, ResultRecord};
pub use measured_pose::MeasuredPose;
pub(crate) use measurement_table::MeasurementTable;
pub use plan::PlannedPose;
pub use result_document::ResultDocument;
pub use settings::{DiagnosisSettings, IdentificationSettings, Method, Settings};
pub use simulator::Simulator;
pub use timestamp::{NotATimestamp, Timestamp};
pub use verification::{Acceptance, Stage, Verification};

/// One calibration of one robot.
///
/// Measurements may still be incomplete: a session is saved at any time, while a dataset folder
/// has to be usable. `M` is the form of the measurements: checked values, or the table of a session file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(bound = "M: JsonSchema + Default + Serialize")]
pub struct Session<M = Measurements> {
    /// Name by which the operator knows it.
    pub name: String,
    /// When it was begun (RFC 3339, UTC).
    pub created: Timestamp,
    /// When it was last changed (RFC 3339, UTC).
    pub modified: Timestamp,
    /// The robot as in `robot.json`, without `format` and `version`: the session's version covers it, so that a
    /// migration step of the robot is one of the session, too.
    pub robot: Robot,
    /// Measured poses.
    #[serde(default)]
    pub measurements: M,
    /// Labels of measured poses that are left out.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    excluded: BTreeSet<i64>,
    /// Poses that are to be measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plan: Vec<PlannedPose>,
    /// Raw data of the phases around the poses.
    #[serde(default)]
    pub phases: PhaseData,
    /// How identification and diagnosis are to work.
    #[serde(default)]
    pub settings: Settings,
    /// Results, the oldest first.
    #[serde(default)]
    results: Vec<ResultRecord>,
    /// The virtual robot of a demonstration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulator: Option<Simulator>,
    /// The parameters that the controller holds, so that a simulated one goes on where it was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub controller: Vec<NamedValue>,
    /// What the controller said of its last start when the last pose was measured: the encoders of a controller that was
    /// started again have lost their zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller_started: Option<f64>,
    /// Where the laser distance comes from.
    #[serde(default, skip_serializing_if = "LaserSettings::is_controller")]
    pub laser_source: LaserSettings,
    /// How the robot's own controller is reached.
    #[serde(default, skip_serializing_if = "Connection::is_empty")]
    pub connection: Connection,
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

impl<M> Session<M> {
    /// The same session with its measurements in another form.
    fn with_measurements<N>(&self, measurements: N) -> Session<N> {
        Session {
            name: self.name.clone(),
            created: self.created,
            modified: self.modified,
            robot: self.robot.clone(),
            measurements,
            excluded: self.excluded.clone(),
            plan: self.plan.clone(),
            phases: self.phases.clone(),
            settings: self.settings.clone(),
            results: self.results.clone(),
            simulator: self.simulator.clone(),
            controller: self.controller.clone(),
            controller_started: self.controller_started,
            laser_source: self.laser_source.clone(),
            connection: self.connection.clone(),
            adjustments: self.adjustments.clone(),
            verifications: self.verifications.clone(),
            log: self.log.clone(),
        }
    }
}

impl Session {
    /// An empty session of a robot.
    #[must_use]
    pub fn new(name: impl Into<String>, robot: Robot, now: Timestamp) -> Self {
        Self {
            name: name.into(),
            created: now,
            modified: now,
            robot,
            measurements: Measurements::default(),
            plan: Vec::new(),
            phases: PhaseData::default(),
            settings: Settings::default(),
            simulator: None,
            controller: Vec::new(),
            controller_started: None,
            laser_source: LaserSettings::default(),
            connection: Connection::default(),
            excluded: BTreeSet::new(),
            results: Vec::new(),
            adjustments: Vec::new(),
            verifications: Vec::new(),
            log: Vec::new(),
        }
    }

    /// A session of the same robot with the same plan, settings and controller, nothing measured and nothing concluded: a
    /// series of its own, with its own way home.
    #[must_use]
    pub fn another_series(&self, name: impl Into<String>, now: Timestamp) -> Self {
        Self {
            plan: self.plan.clone(),
            phases: self.phases.clone(),
            settings: self.settings.clone(),
            simulator: self.simulator.clone(),
            controller: self.controller.clone(),
            laser_source: self.laser_source.clone(),
            connection: self.connection.clone(),
            ..Self::new(name, self.robot.clone(), now)
        }
    }

    /// A session that begins with a dataset; its notices are the caller's to show.
    #[must_use]
    pub fn of_dataset(name: impl Into<String>, folder: DatasetFolder, now: Timestamp) -> Self {
        let mut session = Self::new(name, folder.dataset.robot, now);
        session.measurements = folder.dataset.measurements;
        session.phases = folder.phases;
        session
    }

    /// The robot and its measurements as identification takes them: without the poses that the
    /// operator left out.
    #[must_use]
    pub fn dataset(&self) -> Dataset {
        let labels = self.measurements.labels.iter().enumerate();
        let kept: Vec<usize> = labels
            .filter(|(_, label)| !self.excluded.contains(label))
            .map(|(row, _)| row)
            .collect();
        if kept.len() == self.measurements.len() {
            return self.whole_dataset();
        }
        Dataset {
            robot: self.robot.clone(),
            measurements: self.measurements.select(&kept),
        }
    }

    /// The robot and all its measurements, those left out as well.
    #[must_use]
    pub fn whole_dataset(&self) -> Dataset {
        Dataset {
            robot: self.robot.clone(),
            measurements: self.measurements.clone(),
        }
    }

    /// Labels of the poses that the operator left out.
    #[must_use]
    pub fn excluded(&self) -> &BTreeSet<i64> {
        &self.excluded
    }

    /// Leaves a pose out.
    ///
    /// # Errors
    /// If it is the home pose, to which all revolutions refer, or not measured.
    pub fn exclude(&mut self, label: i64) -> Result<(), FieldError> {
        check::excludable(label)?;
        if !self.measurements.labels.contains(&label) {
            let message = format!("found {label}, expected the label of a measured pose");
            return fail("/excluded", message);
        }
        self.excluded.insert(label);
        Ok(())
    }

    /// Takes a pose back in; whether it was left out.
    pub fn include(&mut self, label: i64) -> bool {
        self.excluded.remove(&label)
    }

    /// Results so far, the oldest first.
    #[must_use]
    pub fn results(&self) -> &[ResultRecord] {
        &self.results
    }

    /// Adjustments of the controller so far, the oldest first.
    #[must_use]
    pub fn adjustments(&self) -> &[Adjustment] {
        &self.adjustments
    }

    /// Runs with an external instrument so far, the oldest first.
    #[must_use]
    pub fn verifications(&self) -> &[Verification] {
        &self.verifications
    }

    /// What the operator did so far, the oldest first.
    #[must_use]
    pub fn log(&self) -> &[LogEntry] {
        &self.log
    }

    /// Adds a result; results are never changed afterwards.
    pub fn add_result(&mut self, result: ResultRecord) {
        self.modified = self.modified.max(result.time);
        self.results.push(result);
    }

    /// Adds an adjustment; adjustments are never changed afterwards, but for one that is still [open](Adjustment::is_open).
    pub fn add_adjustment(&mut self, adjustment: Adjustment) {
        self.modified = self.modified.max(adjustment.time);
        self.adjustments.push(adjustment);
    }

    /// Says what came of the last adjustment if it is still [open](Adjustment::is_open); whether it was.
    pub fn conclude_adjustment(&mut self, outcome: Outcome, now: Timestamp) -> bool {
        let last = self.adjustments.last_mut();
        let Some(open) = last.filter(|last| last.is_open()) else {
            return false;
        };
        open.outcome = outcome;
        self.modified = self.modified.max(now);
        true
    }

    /// Adds a run with an external instrument; runs are never changed afterwards.
    pub fn add_verification(&mut self, verification: Verification) {
        self.modified = self.modified.max(verification.time);
        self.verifications.push(verification);
    }

    /// The robot is accepted on the result of its last verification, if there is one.
    pub fn accept(&mut self, acceptance: Acceptance) {
        if let Some(last) = self.verifications.last_mut() {
            self.modified = self.modified.max(acceptance.time);
            last.accepted = Some(acceptance);
        }
    }

    /// Adds an operator step; the log is never changed afterwards.
    pub fn record(&mut self, entry: LogEntry) {
        self.modified = self.modified.max(entry.time);
        self.log.push(entry);
    }
}

/// Reads a session file.
///
/// # Errors
/// If the file cannot be read or is not a valid session.
pub fn read_session(path: &Path) -> Result<Loaded<Session>, ReadError> {
    checked(read_versioned(path)?, &path.display().to_string())
}

/// Reads a session from memory; `file` is the name for messages.
///
/// # Errors
/// If the bytes are no valid session.
pub fn parse_session(bytes: &[u8], file: &str) -> Result<Loaded<Session>, ReadError> {
    checked(parse_versioned(bytes, file)?, file)
}

/// The session of a session file whose other parts are checked already.
pub(crate) fn checked(
    loaded: Loaded<SessionFile>,
    file: &str,
) -> Result<Loaded<Session>, ReadError> {
    let session = loaded.value.with_checked_measurements();
    Ok(Loaded {
        value: session.map_err(|error| ReadError::field(file, error))?,
        notices: loaded.notices,
    })
}

/// Writes a session file, atomically.
///
/// # Errors
/// If the session could not be read again or the file cannot be written.
pub fn write_session(path: &Path, session: &Session) -> Result<(), WriteError> {
    let measurements = Columns::of(&session.measurements).into_measurements(&session.robot);
    measurements.map_err(|fault| WriteError::Content {
        path: path.into(),
        message: below("/measurements", fault.into()).to_string(),
    })?;
    write_versioned(path, &SessionFile::of(session))
}

#[cfg(test)]
pub(crate) mod tests;
