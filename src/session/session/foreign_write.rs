//! Values of the controller that others change while poses are measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{NamedValue, Session, Timestamp, TrailPart, ValueChange};

/// The values of the controller at the start of a measuring run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunValues {
    /// Time at which they were read.
    pub time: Timestamp,
    /// Name of the controller.
    pub controller: String,
    /// The values.
    pub values: Vec<NamedValue>,
    /// Labels of the poses that were measured before.
    pub measured: Vec<i64>,
}

/// Values of the controller that were others at the end of a measuring run than at its start, although Tautline wrote none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForeignWrite {
    /// Start of the run.
    pub begun: Timestamp,
    /// Time at which the other values were read.
    pub noticed: Timestamp,
    /// Labels of the poses that were measured in between.
    pub poses: Vec<i64>,
    /// The values that changed.
    pub changes: Vec<ValueChange>,
}

impl Session {
    /// Keeps the values of the controller at the start of a measuring run.
    pub fn begin_run(&mut self, controller: &str, values: Vec<NamedValue>, now: Timestamp) {
        self.run_values = Some(RunValues {
            time: now,
            controller: controller.to_owned(),
            values,
            measured: self.measurements.labels.clone(),
        });
        self.modified = self.modified.max(now);
    }

    /// Takes the values at the start of the run with a controller, to be compared with those at its end.
    pub fn take_run(&mut self, controller: &str) -> Option<RunValues> {
        let run = &mut self.run_values;
        run.take_if(|run| run.controller == controller)
    }

    /// Whether the values at the start of a run with this controller still have to be compared with those at its end.
    #[must_use]
    pub fn is_run_open(&self, controller: &str) -> bool {
        let run = self.run_values.as_ref();
        run.is_some_and(|run| run.controller == controller)
    }

    /// Adds values that others changed.
    pub fn add_foreign_write(&mut self, write: ForeignWrite) {
        self.modified = self.modified.max(write.noticed);
        self.foreign_writes.push(write);
        self.cover(TrailPart::ForeignWrite(self.foreign_writes.len() - 1));
    }

    /// Values that others changed while poses were measured of which at least one is used, that is, not excluded.
    pub fn foreign_writes(&self) -> impl Iterator<Item = &ForeignWrite> {
        let writes = self.foreign_writes.iter();
        writes.filter(|write| !self.marked_poses(write).is_empty())
    }

    /// Labels of the used poses that are marked because others changed values of the controller.
    #[must_use]
    pub fn marked_poses(&self, write: &ForeignWrite) -> Vec<i64> {
        let labels = write.poses.iter().copied();
        labels.filter(|label| self.is_used(*label)).collect()
    }
}
