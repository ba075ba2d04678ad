//! A measured pose as delivered by the instruments.

use tautline_core::geometry::Pose;
use tautline_core::measurement::Measurements;
use tautline_core::robot::FieldError;

use super::{MeasurementTable, Session, TrailPart};
use crate::error::{below, fail};
use crate::poses::{Columns, Fault};

/// The readings at one pose.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasuredPose {
    /// The readings, as a table of one row.
    pub readings: Measurements,
    /// Label of the earlier measurement that this one replaces.
    pub repeats: Option<i64>,
    /// Start of the controller, if it reports it.
    pub started: Option<f64>,
}

impl From<Measurements> for MeasuredPose {
    /// A pose that does not replace another one, from a table of one row.
    fn from(readings: Measurements) -> Self {
        Self {
            readings,
            repeats: None,
            started: None,
        }
    }
}

impl MeasuredPose {
    /// Label of the pose, 0 for the home pose.
    #[must_use]
    pub fn label(&self) -> i64 {
        self.readings.labels.first().copied().unwrap_or_default()
    }

    /// The commanded pose.
    #[must_use]
    pub fn commanded(&self) -> Option<Pose> {
        self.readings.commanded.first().copied().flatten()
    }

    /// Relabels the readings as a repetition that replaces the pose with the old label.
    #[must_use]
    pub fn repeated_as(mut self, label: i64) -> Self {
        self.repeats = Some(self.label());
        self.readings.labels = vec![label];
        self
    }
}

impl Session {
    /// Label for a repeated pose: greater than all measured or planned labels.
    #[must_use]
    pub fn next_label(&self) -> i64 {
        let planned = self.plan.iter().map(|pose| pose.label);
        let labels = self.measurements.labels.iter().copied().chain(planned);
        labels.fold(0, i64::max).saturating_add(1)
    }

    /// Appends one measured pose. The pose that it repeats is excluded from now on.
    ///
    /// True poses of simulated data are dropped if the new row has none, because they must be known for all poses or for
    /// none.
    ///
    /// # Errors
    /// If the label already exists, the readings do not fit this robot or are not plausible, or the pose that
    /// it repeats does not exist or is the home pose; nothing changes then.
    pub fn append_pose(&mut self, pose: &MeasuredPose) -> Result<(), FieldError> {
        self.append(Columns::of(&pose.readings), pose.repeats)?;
        self.controller_started = pose.started.or(self.controller_started);
        Ok(())
    }

    /// Adds the poses that another state of the same session has and this one lacks; returns their labels.
    ///
    /// # Errors
    /// If such a pose does not fit; those before it are added nevertheless.
    pub fn append_missing(&mut self, other: &Self) -> Result<Vec<i64>, FieldError> {
        let mut added = Vec::new();
        for (row, label) in other.measurements.labels.iter().enumerate() {
            if !self.measurements.labels.contains(label) {
                self.append(Columns::of(&other.measurements.select(&[row])), None)?;
                added.push(*label);
            }
        }
        if !added.is_empty() {
            self.controller_started = other.controller_started.or(self.controller_started);
        }
        Ok(added)
    }

    /// Appends one measured pose read from a file.
    pub(crate) fn append_table(
        &mut self,
        table: MeasurementTable,
        repeats: Option<i64>,
        started: Option<f64>,
    ) -> Result<(), FieldError> {
        table.check()?;
        self.append(table.into_columns(), repeats)?;
        self.controller_started = started.or(self.controller_started);
        Ok(())
    }

    fn append(&mut self, row: Columns, repeats: Option<i64>) -> Result<(), FieldError> {
        let rows = self.measurements.len();
        let row = row.into_measurements(&self.robot).map_err(|fault| {
            let fault = Fault {
                row: fault.row.map(|_| rows),
                ..fault
            };
            below("/measurements", fault.into())
        })?;
        for label in &row.labels {
            if let Some(earlier) = self.measurements.labels.iter().position(|l| l == label) {
                let message = format!(
                    "found {label} again (value {earlier}), expected a pose that is not measured yet"
                );
                return fail(format!("/measurements/pose/{rows}"), message);
            }
        }
        self.check_same_length_reading(&row)?;
        if let Some(repeated) = repeats {
            self.exclude(repeated)?;
        }
        for label in &row.labels {
            self.include(*label);
        }
        let labels = row.labels.clone();
        self.measurements.append(row);
        for label in labels {
            self.cover(TrailPart::Pose(label));
        }
        Ok(())
    }

    /// Checks that all poses have revolutions, or all have absolute lengths.
    fn check_same_length_reading(&self, row: &Measurements) -> Result<(), FieldError> {
        let m = &self.measurements;
        let (column, expected) = if !m.revolutions.is_empty() && !row.length_m.is_empty() {
            ("length_1_m", "revolutions")
        } else if !m.length_m.is_empty() && !row.revolutions.is_empty() {
            ("rev_1", "absolute lengths")
        } else {
            return Ok(());
        };
        let message = format!("found a reading, expected {expected} as at the poses before");
        fail(format!("/measurements/columns/{column}"), message)
    }
}
