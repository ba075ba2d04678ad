//! The session file.

use serde_json::{Map, Value};
use tautline_core::measurement::Measurements;
use tautline_core::robot::FieldError;

use super::{MeasurementTable, ResultRecord, Session, check, connection};
use crate::error::{below, fail};
use crate::json::VersionedFile;
use crate::poses::Columns;

/// A session in stored form.
pub(crate) type SessionFile = Session<MeasurementTable>;

impl VersionedFile for SessionFile {
    const FORMAT: &'static str = "tautline-session";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = Session::MAX_BYTES;

    fn resolve(document: &mut Map<String, Value>) -> Result<(), FieldError> {
        let mut settings = document.get_mut("settings").into_iter();
        let effects = settings.find_map(|one| one.get_mut("identification")?.get_mut("effects"));
        if let Some(Value::Array(effects)) = effects {
            // Sessions of earlier versions could hold this effect, whose functions were all zero.
            effects.retain(|effect| effect["effect"] != "unknown");
        }
        Ok(())
    }

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
        if self.settings.until.at_most == 0 {
            let message = "found 0, expected at least 1 pose";
            return fail("/settings/until/at_most", message);
        }
        let tolerance_m = self.settings.tolerance_m;
        if let Some(found) = tolerance_m.filter(|metres| !(*metres > 0.0 && metres.is_finite())) {
            let message = format!("found {found}, expected a distance greater than 0 m");
            return fail("/settings/tolerance_m", message);
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
        check::verifications(&self.verifications)?;
        check::stopped_verifications(&self.stopped_verifications)
    }
}

impl SessionFile {
    /// The stored form of a session.
    pub fn of(session: &Session) -> Self {
        session.with_measurements(MeasurementTable::of(&session.measurements))
    }

    /// The stored form of a session, without its measured poses.
    pub fn without_measurements(session: &Session) -> Self {
        session.with_measurements(MeasurementTable::default())
    }

    /// Its results.
    pub fn results_mut(&mut self) -> &mut Vec<ResultRecord> {
        &mut self.results
    }

    /// Converts a document that passed its check to a session.
    pub fn with_checked_measurements(mut self) -> Result<Session, FieldError> {
        let table = std::mem::take(&mut self.measurements);
        self.with_columns(table.into_columns())
    }

    /// Converts a document that passed its check to a session, with the given measurements instead of its own.
    pub fn with_measurements_of(&self, measurements: &Measurements) -> Result<Session, FieldError> {
        self.with_columns(Columns::of(measurements))
    }

    fn with_columns(&self, columns: Columns) -> Result<Session, FieldError> {
        let measurements = columns.into_measurements(&self.robot);
        let measurements = measurements.map_err(|fault| below("/measurements", fault.into()))?;
        Ok(self.with_measurements(measurements))
    }
}
