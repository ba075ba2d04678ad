//! Sessions: one calibration of one robot, with all measurements and results.

mod adjustment;
mod basis;
mod certificate;
mod check;
mod connection;
mod controller_values;
mod document;
mod foreign_write;
mod laser_settings;
mod log;
mod measured_pose;
mod measurement_table;
mod plan;
mod result_document;
mod settings;
mod simulator;
mod timestamp;
mod trail;
mod verification;

use std::collections::BTreeSet;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::{FieldError, Robot};
use tautline_files::ReadError;

use crate::dataset::DatasetFolder;
use crate::error::{Loaded, WriteError, below, fail, of_field};
use crate::json::{parse_versioned, read_versioned, write_versioned};
use crate::phases::{PhaseData, distance_readings};
use crate::poses::Columns;
pub use adjustment::{Adjustment, NamedValue, Outcome, ValueChange};
pub use certificate::{CalibratedInstrument, CertificateDetails, DecisionRule, day};
pub use connection::{
    AdsPlace, Connection, ControllerKind, OpcUaPlace, OpcUaPolicy, OpcUaSecurity, RecordingPlace,
    SymbolCommand, SymbolList, SymbolMapping, SymbolNames, SymbolParameter, SymbolPose,
    SymbolReadings, SymbolRotation, SymbolStatus, SymbolValue, UserCertificateFiles, is_per_cable,
    name_of_cable, without_user,
};
pub(crate) use document::SessionFile;
pub use foreign_write::{ForeignWrite, RunValues};
pub use laser_settings::{LaserParity, LaserPort, LaserSettings, LaserUnit, LineLaserSettings};
pub use log::{LogEntry, MeasuringWarning, Phase, ResultRecord};
pub use measured_pose::MeasuredPose;
pub(crate) use measurement_table::MeasurementTable;
pub use plan::PlannedPose;
pub use result_document::ResultDocument;
pub use settings::{DiagnosisSettings, IdentificationSettings, Method, Settings, UntilSettings};
pub use simulator::Simulator;
pub use timestamp::{NotATimestamp, Timestamp};
pub use trail::{AuditTrail, TrailAuthor, TrailEntry, TrailFault, TrailPart, TrailRecord};
pub use verification::{Acceptance, Stage, StoppedVerification, Verification};

/// One calibration of one robot.
///
/// Measurements may be incomplete: a session can be saved at any time, while a dataset folder
/// must be usable. `M` is the form of the measurements: checked values, or the table of a session file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(bound = "M: JsonSchema + Default + Serialize")]
pub struct Session<M = Measurements> {
    /// Name given by the operator.
    pub name: String,
    /// Time of creation (RFC 3339, UTC).
    pub created: Timestamp,
    /// Time of the last change (RFC 3339, UTC).
    pub modified: Timestamp,
    /// The robot as in `robot.json`, without `format` and `version`: it is covered by the version of the session, so that a
    /// migration of the robot is also one of the session.
    pub robot: Robot,
    /// Measured poses.
    #[serde(default)]
    pub measurements: M,
    /// Labels of excluded poses.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    excluded: BTreeSet<i64>,
    /// Poses to be measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plan: Vec<PlannedPose>,
    /// Raw data of the phases around the poses.
    #[serde(default)]
    pub phases: PhaseData,
    /// Settings of identification and diagnosis.
    #[serde(default)]
    pub settings: Settings,
    /// Results, the oldest first.
    #[serde(default)]
    results: Vec<ResultRecord>,
    /// The virtual robot of a demonstration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulator: Option<Simulator>,
    /// Whether a robot that was simulated from the description gave readings of this session.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub has_simulated_readings: bool,
    /// The parameters that the controller holds, so that a simulated one continues with them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub controller: Vec<NamedValue>,
    /// Start of the controller, as reported when the last pose was measured: the encoders of a controller that was
    /// restarted have lost their zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controller_started: Option<f64>,
    /// Source of the laser distance.
    #[serde(default, skip_serializing_if = "LaserSettings::is_controller")]
    pub laser_source: LaserSettings,
    /// Connection to the robot's own controller.
    #[serde(default, skip_serializing_if = "Connection::is_empty")]
    pub connection: Connection,
    /// Adjustments of the controller, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    adjustments: Vec<Adjustment>,
    /// Runs with an external instrument, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    verifications: Vec<Verification>,
    /// Runs with an external instrument that ended early, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    stopped_verifications: Vec<StoppedVerification>,
    /// Implausible readings of measured poses, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    measuring_warnings: Vec<MeasuringWarning>,
    /// Values of the controller at the start of a measuring run whose end was not compared with them yet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    run_values: Option<RunValues>,
    /// Values of the controller that others changed during measuring runs, the oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    foreign_writes: Vec<ForeignWrite>,
    /// Steps of the operator, the oldest first.
    #[serde(default)]
    log: Vec<LogEntry>,
    /// Hashes of what moved the robot or wrote to its controller, and of the log.
    #[serde(default, skip_serializing_if = "AuditTrail::is_empty")]
    trail: AuditTrail,
}

impl<M> Session<M> {
    /// The same session with another form of the measurements.
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
            has_simulated_readings: self.has_simulated_readings,
            controller: self.controller.clone(),
            controller_started: self.controller_started,
            laser_source: self.laser_source.clone(),
            connection: self.connection.clone(),
            adjustments: self.adjustments.clone(),
            verifications: self.verifications.clone(),
            stopped_verifications: self.stopped_verifications.clone(),
            measuring_warnings: self.measuring_warnings.clone(),
            run_values: self.run_values.clone(),
            foreign_writes: self.foreign_writes.clone(),
            log: self.log.clone(),
            trail: self.trail.clone(),
        }
    }
}

impl Session {
    /// Largest session file that is read (bytes).
    pub const MAX_BYTES: u64 = 1 << 30;

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
            has_simulated_readings: false,
            controller: Vec::new(),
            controller_started: None,
            laser_source: LaserSettings::default(),
            connection: Connection::default(),
            excluded: BTreeSet::new(),
            results: Vec::new(),
            adjustments: Vec::new(),
            verifications: Vec::new(),
            stopped_verifications: Vec::new(),
            measuring_warnings: Vec::new(),
            run_values: None,
            foreign_writes: Vec::new(),
            log: Vec::new(),
            trail: AuditTrail::default(),
        }
    }

    /// A session of the same robot with the same poses, settings and controller, but without measurements and results: a
    /// separate series with its own home row. Poses that were measured without a plan are planned there.
    #[must_use]
    pub fn another_series(&self, name: impl Into<String>, now: Timestamp) -> Self {
        let measured = self
            .measurements
            .labels
            .iter()
            .zip(&self.measurements.commanded);
        let unplanned = measured.filter(|(label, _)| self.plan.iter().all(|p| p.label != **label));
        let unplanned =
            unplanned.filter_map(|(label, pose)| Some(PlannedPose::new(*label, &(*pose)?)));
        Self {
            plan: unplanned.chain(self.plan.iter().copied()).collect(),
            phases: self.phases.clone(),
            settings: self.settings.clone(),
            simulator: self.simulator.clone(),
            controller: self.controller.clone(),
            laser_source: self.laser_source.clone(),
            connection: self.connection.clone(),
            ..Self::new(name, self.robot.clone(), now)
        }
    }

    /// A session of the same robot with corrected readings of the same poses, but without results.
    #[must_use]
    pub fn with_readings(
        &self,
        name: impl Into<String>,
        measurements: Measurements,
        now: Timestamp,
    ) -> Self {
        Self {
            plan: self.plan.clone(),
            excluded: self.excluded.clone(),
            has_simulated_readings: self.has_simulated_readings,
            measurements,
            ..self.another_series(name, now)
        }
    }

    /// Whether readings are known to be simulated rather than those of a real machine.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.has_simulated_readings
            || self.simulator.is_some()
            || !self.measurements.truth.poses.is_empty()
    }

    /// A session created from a dataset; the caller must show its notices.
    #[must_use]
    pub fn of_dataset(name: impl Into<String>, folder: DatasetFolder, now: Timestamp) -> Self {
        let mut session = Self::new(name, folder.dataset.robot, now);
        session.measurements = folder.dataset.measurements;
        session.measurements.distances.clear();
        session.phases = folder.phases;
        if let Some(time) = folder.measured_at {
            session.created = session.created.min(time);
            session.log.push(LogEntry {
                time,
                phase: Phase::Poses,
                text: format!("{} poses were read.", session.measurements.len()),
            });
        }
        session
    }

    /// The robot and the measurements for identification, without the poses that the
    /// operator excluded.
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
            measurements: self.with_distances().select(&kept),
        }
    }

    /// The robot and all measurements, including excluded poses.
    #[must_use]
    pub fn whole_dataset(&self) -> Dataset {
        Dataset {
            robot: self.robot.clone(),
            measurements: self.with_distances(),
        }
    }

    fn with_distances(&self) -> Measurements {
        Measurements {
            distances: distance_readings(&self.phases.distances, &self.measurements),
            ..self.measurements.clone()
        }
    }

    /// Labels of the poses excluded by the operator.
    #[must_use]
    pub fn excluded(&self) -> &BTreeSet<i64> {
        &self.excluded
    }

    /// Excludes a pose.
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

    /// Includes a pose again; returns whether it was excluded.
    pub fn include(&mut self, label: i64) -> bool {
        self.excluded.remove(&label)
    }

    /// Results, the oldest first.
    #[must_use]
    pub fn results(&self) -> &[ResultRecord] {
        &self.results
    }

    /// Adjustments of the controller, the oldest first.
    #[must_use]
    pub fn adjustments(&self) -> &[Adjustment] {
        &self.adjustments
    }

    /// Runs with an external instrument, the oldest first.
    #[must_use]
    pub fn verifications(&self) -> &[Verification] {
        &self.verifications
    }

    /// Time when its poses were last measured or imported, if it has any.
    #[must_use]
    pub fn measured(&self) -> Option<Timestamp> {
        let mut steps = self.log.iter().rev();
        let last = steps.find(|step| step.phase == Phase::Poses);
        let is_measured = !self.measurements.is_empty();
        is_measured.then(|| last.map_or(self.created, |step| step.time))
    }

    /// Runs with an external instrument that ended early, the oldest first.
    #[must_use]
    pub fn stopped_verifications(&self) -> &[StoppedVerification] {
        &self.stopped_verifications
    }

    /// Warnings of the poses that are used: measured and not excluded.
    pub fn measuring_warnings(&self) -> impl Iterator<Item = &MeasuringWarning> {
        let warnings = self.measuring_warnings.iter();
        warnings.filter(|warning| self.is_used(warning.pose))
    }

    /// Whether a pose is measured and not excluded.
    fn is_used(&self, pose: i64) -> bool {
        self.measurements.labels.contains(&pose) && !self.excluded.contains(&pose)
    }

    /// Steps of the operator, the oldest first.
    #[must_use]
    pub fn log(&self) -> &[LogEntry] {
        &self.log
    }

    /// Adds a result; results never change afterwards.
    pub fn add_result(&mut self, result: ResultRecord) {
        self.modified = self.modified.max(result.time);
        self.results.push(result);
        self.cover(TrailPart::Result(self.results.len() - 1));
    }

    /// Adds an adjustment; adjustments never change afterwards, except one that is still [open](Adjustment::is_open).
    pub fn add_adjustment(&mut self, adjustment: Adjustment) {
        self.modified = self.modified.max(adjustment.time);
        self.adjustments.push(adjustment);
        self.cover(TrailPart::Adjustment(self.adjustments.len() - 1));
    }

    /// Sets the outcome of the last adjustment if it is still [open](Adjustment::is_open), and the values that the controller
    /// `holds` after it, if they could be read; returns whether it was open.
    pub fn conclude_adjustment(
        &mut self,
        outcome: Outcome,
        holds: Option<&[NamedValue]>,
        now: Timestamp,
    ) -> bool {
        let last = self.adjustments.last_mut();
        let Some(open) = last.filter(|last| last.is_open()) else {
            return false;
        };
        open.outcome = outcome;
        let changes = &open.changes;
        let is_changed = |held: &&NamedValue| changes.iter().any(|c| c.name == held.name);
        let read_back = holds.unwrap_or_default().iter().filter(is_changed);
        open.read_back = read_back.cloned().collect();
        self.modified = self.modified.max(now);
        self.cover(TrailPart::Adjustment(self.adjustments.len() - 1));
        true
    }

    /// Adds a run with an external instrument; runs never change afterwards.
    pub fn add_verification(&mut self, verification: Verification) {
        self.modified = self.modified.max(verification.time);
        self.verifications.push(verification);
        self.cover(TrailPart::Verification(self.verifications.len() - 1));
    }

    /// Adds a run that ended early.
    pub fn add_stopped_verification(&mut self, stopped: StoppedVerification) {
        self.modified = self.modified.max(stopped.time);
        self.stopped_verifications.push(stopped);
        let number = self.stopped_verifications.len() - 1;
        self.cover(TrailPart::StoppedVerification(number));
    }

    /// Adds warnings of poses that were measured.
    pub fn add_measuring_warnings(&mut self, warnings: impl IntoIterator<Item = MeasuringWarning>) {
        self.measuring_warnings.extend(warnings);
    }

    /// Records the acceptance of the robot with the values that its controller holds, on the result of the last
    /// verification after an adjustment, if there is one.
    pub fn accept(&mut self, operator: impl Into<String>, now: Timestamp) {
        let values = Some(self.controller_fingerprint());
        let mut runs = self.verifications.iter_mut().enumerate().rev();
        if let Some((number, last)) = runs.find(|(_, run)| run.stage == Stage::After) {
            self.modified = self.modified.max(now);
            last.accepted = Some(Acceptance {
                time: now,
                operator: operator.into(),
                values,
            });
            self.cover(TrailPart::Verification(number));
        }
    }

    /// The acceptance of the robot on the result of a run; it ends when the controller gets other values.
    #[must_use]
    pub fn acceptance<'a>(&self, run: &'a Verification) -> Option<&'a Acceptance> {
        let accepted = run.accepted.as_ref()?;
        let values = accepted.values.as_ref();
        let holds = values.is_none_or(|values| *values == self.controller_fingerprint());
        holds.then_some(accepted)
    }

    /// Adds a step of the operator; the log never changes afterwards.
    pub fn record(&mut self, entry: LogEntry) {
        self.modified = self.modified.max(entry.time);
        self.log.push(entry);
        self.cover(TrailPart::Log(self.log.len() - 1));
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

/// Converts a session file whose other parts are checked already.
pub(crate) fn checked(
    loaded: Loaded<SessionFile>,
    file: &str,
) -> Result<Loaded<Session>, ReadError> {
    let session = loaded.value.with_checked_measurements();
    let mut session = session.map_err(|error| of_field(file, error))?;
    session.note_differing();
    Ok(Loaded {
        value: session,
        notices: loaded.notices,
    })
}

/// Writes a session file atomically.
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
