//! Machine-readable form of an adjustment: a public format.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_link::adjusting::{ControllerValues, Difference};
use tautline_session::{Outcome, ValueChange, VersionedFile};

/// An attempt to write identified values to a controller.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AdjustmentDocument {
    /// Name of the controller.
    pub controller: String,
    /// Method of identification; null if nothing was identified.
    pub method: Option<String>,
    /// Chi-square of the identification; null if nothing was identified.
    #[serde(default)]
    pub chi2: Option<f64>,
    /// State found after an interrupted adjustment: old, new or mixed values; null if there was none.
    pub interrupted: Option<String>,
    /// Values of the controller and identified values.
    pub differences: Vec<DifferenceRow>,
    /// written, rolled_back, failed (the controller holds its old values), unsettled (it may hold both old and new ones),
    /// not_written (--dry-run) or nothing_to_write.
    pub outcome: String,
    /// Values in the controller after an attempt to write: all new, all old, mixed or unknown; null
    /// if nothing was written.
    pub holds: Option<String>,
    /// Names of the values that a roll-back does not restore, because they were not numbers before.
    #[serde(default)]
    pub not_restored: Vec<String>,
    /// Summary of the outcome, and the next step.
    pub text: Option<String>,
}

/// One parameter of the controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DifferenceRow {
    /// Name in the controller.
    pub name: String,
    /// SI unit; "1" for a ratio.
    pub unit: String,
    /// Previous value in the controller; null if it has no such parameter, or its value is not a number.
    pub controller: Option<f64>,
    /// Previous value in the controller if that is not a number: NaN, inf or -inf; otherwise null.
    #[serde(default)]
    pub not_a_number: Option<String>,
    /// Identified value; of an effect that the model lacks the value without effect, null if that is not known.
    pub identified: Option<f64>,
    /// Whether the model has this parameter.
    #[serde(default = "in_model")]
    pub in_model: bool,
    /// Identified less controller.
    pub difference: Option<f64>,
    /// Standard deviation of the identified value, if it was estimated.
    pub sd: Option<f64>,
    /// Part of the platform's position error that returns if this value alone is not written (m), root mean square over the
    /// workspace; null where it is unknown.
    #[serde(default)]
    pub gain_m: Option<f64>,
    /// Whether the value is written.
    pub changes: bool,
}

impl VersionedFile for AdjustmentDocument {
    const FORMAT: &'static str = "tautline-adjustment";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl AdjustmentDocument {
    /// A document before anything was done.
    pub fn new(controller: String) -> Self {
        Self {
            controller,
            ..Self::default()
        }
    }

    /// Sets the values to be written.
    pub fn set_differences(&mut self, differences: &[Difference]) {
        let rows = differences.iter().map(|line| DifferenceRow {
            name: line.name.clone(),
            unit: line.unit.to_owned(),
            controller: line.controller.filter(|held| held.is_finite()),
            not_a_number: not_a_number(line.controller),
            identified: line.identified,
            in_model: line.in_model,
            difference: line.difference.filter(|difference| difference.is_finite()),
            sd: line.sd,
            gain_m: line.gain_m,
            changes: line.is_writable_change(),
        });
        self.differences = rows.collect();
    }

    /// Sets the state found after an interrupted adjustment.
    pub fn set_interrupted(&mut self, found: &ControllerValues) {
        self.interrupted = Some(word(found).to_owned());
    }

    /// Sets the values that a roll-back does not restore.
    pub fn set_not_restored(&mut self, changes: &[&ValueChange]) {
        self.not_restored = changes.iter().map(|change| change.name.clone()).collect();
    }

    /// Sets the outcome; `holds` is the state of the controller after an attempt to write.
    pub fn set_outcome(&mut self, outcome: &Outcome, holds: Option<&ControllerValues>, text: &str) {
        self.outcome = match outcome {
            Outcome::Written => "written",
            Outcome::RolledBack => "rolled_back",
            Outcome::Failed(_) => "failed",
            Outcome::Begun | Outcome::Unsettled(_) => "unsettled",
        }
        .to_owned();
        self.holds = holds.map(|holds| word(holds).to_owned());
        self.text = Some(text.to_owned());
    }
}

/// Files of versions that listed the parameters of the model alone.
fn in_model() -> bool {
    true
}

fn word(holds: &ControllerValues) -> &'static str {
    match holds {
        ControllerValues::New => "new",
        ControllerValues::Old => "old",
        ControllerValues::Mixed(_) => "mixed",
        ControllerValues::Unknown => "unknown",
    }
}

/// The value of a controller in words, if it is not a number.
fn not_a_number(held: Option<f64>) -> Option<String> {
    let odd = held.filter(|held| !held.is_finite())?;
    Some(odd.to_string())
}
