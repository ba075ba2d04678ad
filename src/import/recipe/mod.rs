//! Recipes: the assignment of channels to quantities of the robot.

mod angles;
mod edit;
mod instrument;
mod quantity;
mod resolve;
mod text;

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;
use tautline_files::ReadError;
use tautline_session::{Loaded, VersionedFile, read_versioned};

pub use angles::{AngleOrder, Angles};
pub use instrument::{Instrument, Placement};
pub use quantity::{Quantity, QuantityKind};
pub(crate) use resolve::{Mapped, Mapping, is_series, resolve};

/// Assignment of channels of foreign files to columns of `poses.csv`, and how rows become poses.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Recipe {
    /// Channels and their quantities. If two entries assign the same quantity the later one holds, so that an entry for one
    /// cable overrides an entry for all.
    pub channels: Vec<Assignment>,
    /// How rows become poses.
    #[serde(default)]
    pub cutting: Cutting,
    /// Whether the first pose is the home pose. Labels of poses, where they are given, say it by themselves.
    #[serde(default)]
    pub first_pose_is_home: bool,
    /// Clocks of the series, where they differ.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<Clock>,
    /// Columns of `poses.csv` that stay empty, because their channel is dead.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_empty: Vec<String>,
    /// Placement of the external instrument; absent: its poses are those of the platform in the robot's frame, and what
    /// markers need is found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instrument: Option<Box<Instrument>>,
    /// Conventions of orientations that are stated as angles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angles: Option<Angles>,
    /// Encoder steps that are compensated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<Step>,
}

/// Assignment of a channel to a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Assignment {
    /// Name of the channel; `{i}` stands for the number of the cable.
    pub channel: String,
    /// Name of its series, or the end of the name; needed only where several series have a channel of this name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<String>,
    /// Column of `poses.csv`, such as `rev_{i}`, `length_3_m`, `laser_m` or `pose`; or a coordinate of a marker, `marker_1_x_m`.
    pub quantity: String,
    /// Unit of the values; absent: the one that the file states, else that of the quantity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Factor by which the values are multiplied, after the unit.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub factor: f64,
    /// Whether the sign is reversed.
    #[serde(default, skip_serializing_if = "is_false")]
    pub reversed: bool,
    /// Offset added after unit, factor and sign, in the unit of the quantity.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset: f64,
    /// Whether values count from that of the first pose.
    #[serde(default, skip_serializing_if = "is_false")]
    pub from_first_pose: bool,
    /// Number that the first cable has in the name of its channel.
    #[serde(default = "first_number", skip_serializing_if = "is_first")]
    pub first: usize,
}

impl Assignment {
    /// Assigns a channel without any conversion.
    #[must_use]
    pub fn new(channel: impl Into<String>, quantity: impl Into<String>) -> Self {
        Self {
            channel: channel.into(),
            series: None,
            quantity: quantity.into(),
            unit: None,
            factor: 1.0,
            reversed: false,
            offset: 0.0,
            from_first_pose: false,
            first: 1,
        }
    }
}

/// How rows become poses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum Cutting {
    /// Every row is a pose.
    #[default]
    Rows,
    /// Consecutive rows with the same label are one pose.
    Labels,
    /// Every standstill is a pose.
    Rest(Rest),
    /// Every row is a sample of a recording in motion; other series are interpolated at its times.
    Motion,
}

/// Criteria of a standstill.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Rest {
    /// Minimum duration of a standstill (s).
    pub minimum_s: f64,
    /// Time left out at the beginning and at the end of a standstill, while the platform settles (s).
    pub settle_s: f64,
    /// Maximum speed of cables and platform at rest (m/s).
    pub speed_m_s: f64,
    /// Maximum angular speed of pulleys and platform at rest (rad/s).
    pub turn_rad_s: f64,
}

impl Default for Rest {
    fn default() -> Self {
        Self {
            minimum_s: 0.5,
            settle_s: 0.1,
            speed_m_s: 2e-3,
            turn_rad_s: 1e-2,
        }
    }
}

/// Clock of a series.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Clock {
    /// Name of the series, or the end of the name.
    pub series: String,
    /// Offset added to its times (s).
    #[serde(default)]
    pub offset_s: f64,
    /// Rate difference (s/s), positive if it runs slower than the common clock: `drift (t - drift_from_s)` is added as well.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub drift: f64,
    /// Time on its own clock from which the drift counts (s).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub drift_from_s: f64,
    /// Whether jumps of the clock are closed, i.e. replaced by the usual step between rows.
    #[serde(default)]
    pub close_jumps: bool,
}

/// A step of an encoder, which lost or gained counts, or the end of a channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Step {
    /// Column of `poses.csv`.
    pub quantity: String,
    /// Label of the first pose after the step.
    pub from_pose: i64,
    /// Value added from there on, in the unit of the quantity; absent: readings from there on are left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub add: Option<f64>,
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_one(value: &f64) -> bool {
    *value == 1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_false(value: &bool) -> bool {
    !*value
}

fn first_number() -> usize {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_first(value: &usize) -> bool {
    *value == 1
}

impl VersionedFile for Recipe {
    const FORMAT: &'static str = "tautline-import-recipe";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;

    fn check(&self) -> Result<(), FieldError> {
        let fail = |pointer: String, message: String| Err(FieldError { pointer, message });
        for (k, assignment) in self.channels.iter().enumerate() {
            let Assignment {
                channel,
                quantity,
                factor,
                offset,
                unit,
                ..
            } = assignment;
            let at = |key: &str| format!("/channels/{k}/{key}");
            let Some(known) = Quantity::parse_pattern(quantity) else {
                let message = format!(
                    "found \"{quantity}\", expected a column of poses.csv, such as rev_{{i}}"
                );
                return fail(at("quantity"), message);
            };
            if channel.matches("{i}").count() != quantity.matches("{i}").count() {
                let message = format!(
                    "found \"{channel}\" for \"{quantity}\", expected {{i}} once in both or in neither"
                );
                return fail(at("channel"), message);
            }
            if !factor.is_finite() || *factor == 0.0 {
                return fail(
                    at("factor"),
                    format!("found {factor}, expected a number other than 0"),
                );
            }
            if !offset.is_finite() {
                return fail(at("offset"), format!("found {offset}, expected a number"));
            }
            if let Some(unit) = unit
                && known.conversion(unit).is_none()
            {
                let expected = known.expected_unit();
                return fail(at("unit"), format!("found \"{unit}\", expected {expected}"));
            }
        }
        if let Cutting::Rest(rest) = &self.cutting {
            for (key, value) in [
                ("minimum_s", rest.minimum_s),
                ("speed_m_s", rest.speed_m_s),
                ("turn_rad_s", rest.turn_rad_s),
            ] {
                if !(value.is_finite() && value > 0.0) {
                    return fail(
                        format!("/cutting/{key}"),
                        format!("found {value}, expected a positive number"),
                    );
                }
            }
            if !(rest.settle_s.is_finite() && rest.settle_s >= 0.0) {
                return fail(
                    "/cutting/settle_s".into(),
                    format!("found {}, expected 0 or more", rest.settle_s),
                );
            }
        }
        for (k, clock) in self.clocks.iter().enumerate() {
            let values = [
                ("offset_s", clock.offset_s, f64::MAX),
                ("drift", clock.drift, 0.1),
                ("drift_from_s", clock.drift_from_s, f64::MAX),
            ];
            for (key, value, most) in values {
                if value.is_nan() || value.abs() > most {
                    return fail(
                        format!("/clocks/{k}/{key}"),
                        format!("found {value}, expected a finite number"),
                    );
                }
            }
        }
        let columns = self
            .left_empty
            .iter()
            .enumerate()
            .map(|(k, column)| (format!("/left_empty/{k}"), column));
        let steps = self
            .steps
            .iter()
            .enumerate()
            .map(|(k, step)| (format!("/steps/{k}/quantity"), &step.quantity));
        for (pointer, column) in columns.chain(steps) {
            if Quantity::parse(column).is_none() {
                return fail(
                    pointer,
                    format!("found \"{column}\", expected a column of poses.csv"),
                );
            }
        }
        Ok(())
    }
}

/// Reads a recipe.
///
/// # Errors
/// If the file cannot be read or is not a recipe.
pub fn read_recipe(path: &Path) -> Result<Loaded<Recipe>, ReadError> {
    read_versioned(path)
}
