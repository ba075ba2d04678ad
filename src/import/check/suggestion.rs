//! Mistakes in the data, and the changes of the recipe that correct them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use tautline_core::measurement::Measurements;

use crate::external::align_measured;
use crate::recipe::{Assignment, Clock, Quantity, QuantityKind as Kind, Recipe, Step};

/// Kind of a mistake in the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mistake {
    /// Values in a unit other than the stated or assumed one.
    WrongUnit,
    /// Values with the wrong sign.
    ReversedSign,
    /// Two channels swapped.
    Exchanged,
    /// An encoder that lost or gained counts.
    EncoderStep,
    /// An encoder that lost or gained whole turns.
    LostTurns,
    /// A piece of cable that the description of the robot does not have.
    Extension,
    /// A clock that was adjusted during the recording.
    ClockJump,
    /// A channel with a constant reading.
    DeadChannel,
    /// Measured poses in another frame than the robot's.
    OtherFrame,
}

impl Mistake {
    /// Whether the mistake is a wrong sign, unit or channel in the recipe.
    #[must_use]
    pub fn is_of_channel(self) -> bool {
        matches!(self, Self::WrongUnit | Self::ReversedSign | Self::Exchanged)
    }
}

/// A mistake and its correction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Suggestion {
    /// Kind of mistake.
    pub mistake: Mistake,
    /// Columns of `poses.csv` concerned.
    pub columns: Vec<String>,
    /// Description in one sentence.
    pub sentence: String,
    /// Change of the recipe that corrects it.
    pub change: Change,
    /// Whether it follows from the mass of the platform only: if that is a guess, the readings may be right.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub by_mass: bool,
}

/// A change of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Change {
    /// Multiplies columns.
    Multiply {
        /// Columns of poses.csv.
        columns: Vec<String>,
        /// Factor.
        factor: f64,
    },
    /// Reverses the sign of columns.
    Reverse {
        /// Columns of poses.csv.
        columns: Vec<String>,
    },
    /// Swaps the channels of two columns.
    Exchange {
        /// One column.
        a: String,
        /// The other.
        b: String,
    },
    /// Compensates a step.
    TakeBack {
        /// Column of poses.csv.
        column: String,
        /// Label of the first pose after the step.
        from_pose: i64,
        /// Value added from there on, in the unit of the column.
        add: f64,
    },
    /// Leaves a column empty.
    LeaveEmpty {
        /// Column of poses.csv.
        column: String,
        /// Label of the first pose at which it is empty, if it is not empty everywhere.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        from_pose: Option<i64>,
    },
    /// Transforms measured poses into the robot's frame.
    AlignInstrument,
    /// Closes the jumps of a clock.
    CloseJumps {
        /// Name of the series.
        series: String,
    },
}

impl Suggestion {
    /// The mistake that a change corrects, in the columns that it affects.
    pub(crate) fn new(sentence: String, change: Change) -> Self {
        let (mistake, columns) = match &change {
            Change::Multiply { columns, .. } => (Mistake::WrongUnit, columns.clone()),
            Change::Reverse { columns } => (Mistake::ReversedSign, columns.clone()),
            Change::Exchange { a, b } => (Mistake::Exchanged, vec![a.clone(), b.clone()]),
            Change::TakeBack { column, .. } => (Mistake::EncoderStep, vec![column.clone()]),
            Change::LeaveEmpty { column, .. } => (Mistake::DeadChannel, vec![column.clone()]),
            Change::AlignInstrument => (
                Mistake::OtherFrame,
                ["meas_x_m", "meas_y_m", "meas_z_m"]
                    .map(str::to_owned)
                    .to_vec(),
            ),
            Change::CloseJumps { .. } => (Mistake::ClockJump, vec!["time_s".into()]),
        };
        Self {
            mistake,
            columns,
            sentence,
            change,
            by_mass: false,
        }
    }

    /// A factor for columns in a wrong unit; `sentence` describes the mistake, given their names.
    pub(super) fn multiply(
        columns: Vec<String>,
        factor: f64,
        sentence: impl Fn(&str) -> String,
    ) -> Self {
        Self::new(
            sentence(&columns.join(", ")),
            Change::Multiply { columns, factor },
        )
    }

    /// Whether the suggestion concerns a column of this quantity.
    pub(super) fn is_of(&self, kind: Kind) -> bool {
        self.columns
            .iter()
            .any(|column| Quantity::parse(column).is_some_and(|quantity| quantity.kind == kind))
    }

    /// Corrects the readings of a table of poses. Returns whether that is possible: the clock of a recording is not in its table.
    pub fn correct(&self, data: &mut Measurements) -> bool {
        let labels = data.labels.clone();
        let from = |label: Option<i64>| {
            let first = label.and_then(|label| labels.iter().position(|other| *other == label));
            move |row: usize| first.is_none_or(|first| row >= first)
        };
        match &self.change {
            Change::Multiply { columns, factor } => {
                change(data, columns, |_, value| value * factor)
            }
            Change::Reverse { columns } => change(data, columns, |_, value| -value),
            Change::Exchange { a, b } => {
                let mut values = [Vec::new(), Vec::new()];
                for (column, values) in [a, b].into_iter().zip(&mut values) {
                    change(data, std::slice::from_ref(column), |_, value| {
                        values.push(value);
                        value
                    });
                }
                let [of_a, of_b] = values;
                change(data, std::slice::from_ref(a), |row, _| of_b[row])
                    && change(data, std::slice::from_ref(b), |row, _| of_a[row])
            }
            Change::TakeBack {
                column,
                from_pose,
                add,
            } => {
                let is_after = from(Some(*from_pose));
                let taken_back = |row, value| if is_after(row) { value + add } else { value };
                change(data, std::slice::from_ref(column), taken_back)
            }
            Change::LeaveEmpty { column, from_pose } => {
                let is_after = from(*from_pose);
                let left = |row, value| if is_after(row) { f64::NAN } else { value };
                change(data, std::slice::from_ref(column), left)
            }
            Change::AlignInstrument => align_measured(data),
            Change::CloseJumps { .. } => false,
        }
    }

    /// Applies the correction to a recipe.
    pub fn apply(&self, recipe: &mut Recipe) {
        match &self.change {
            Change::Multiply { columns, factor } => edit(recipe, columns, |entry| {
                entry.factor *= factor;
                entry.offset *= factor;
            }),
            Change::Reverse { columns } => edit(recipe, columns, |entry| {
                entry.reversed = !entry.reversed;
                entry.offset = -entry.offset;
            }),
            Change::Exchange { a, b } => {
                if let (Some(mut first), Some(mut second)) =
                    (entry_of(recipe, a), entry_of(recipe, b))
                {
                    std::mem::swap(&mut first.quantity, &mut second.quantity);
                    recipe.channels.extend([first, second]);
                }
            }
            Change::TakeBack {
                column,
                from_pose,
                add,
            } => {
                recipe.steps.push(Step {
                    quantity: column.clone(),
                    from_pose: *from_pose,
                    add: Some(*add),
                });
            }
            Change::LeaveEmpty { column, from_pose } => match from_pose {
                None => recipe.left_empty.push(column.clone()),
                Some(label) => recipe.steps.push(Step {
                    quantity: column.clone(),
                    from_pose: *label,
                    add: None,
                }),
            },
            Change::AlignInstrument => recipe.instrument = Some(Box::default()),
            Change::CloseJumps { series } => match recipe
                .clocks
                .iter_mut()
                .find(|clock| clock.series == *series)
            {
                Some(clock) => clock.close_jumps = true,
                None => recipe.clocks.push(Clock {
                    series: series.clone(),
                    close_jumps: true,
                    ..Clock::default()
                }),
            },
        }
    }
}

/// Changes the values of columns, given the row; whether all of them are there.
fn change(
    data: &mut Measurements,
    columns: &[String],
    mut change: impl FnMut(usize, f64) -> f64,
) -> bool {
    let mut are_there = true;
    for Quantity { kind, index } in columns.iter().filter_map(|column| Quantity::parse(column)) {
        let grid = match kind {
            Kind::Revolutions => Some(&mut data.revolutions),
            Kind::Length => Some(&mut data.length_m),
            Kind::Force => Some(&mut data.force_n),
            Kind::Swivel => Some(&mut data.swivel_rad),
            _ => None,
        };
        if let Some(grid) = grid {
            for row in 0..grid.rows() {
                grid.set(row, index, change(row, grid.get(row, index)));
            }
            continue;
        }
        let vectors = match kind {
            Kind::Inclination => &mut data.inclination_rad,
            Kind::Tracked if index < 3 => &mut data.tracked_position_m,
            Kind::Laser => {
                for (row, value) in data.laser_m.iter_mut().enumerate() {
                    *value = change(row, *value);
                }
                continue;
            }
            _ => {
                are_there = false;
                continue;
            }
        };
        for (row, vector) in vectors.iter_mut().enumerate() {
            vector[index] = change(row, vector[index]);
        }
    }
    are_there
}

/// Changes the entries of columns. A pattern is changed itself if all of its columns are affected; otherwise entries for
/// single columns are added after it.
fn edit(recipe: &mut Recipe, columns: &[String], change: impl Fn(&mut Assignment)) {
    let is_meant = |entry: &Assignment, column: &str| {
        entry.quantity == column || pattern_number(entry, column).is_some()
    };
    let whole = columns.len() > 1 && {
        let holders = recipe
            .channels
            .iter()
            .filter(|entry| columns.iter().any(|column| is_meant(entry, column)));
        holders.clone().count() == 1 || holders.clone().all(|entry| !entry.quantity.contains("{i}"))
    };
    if whole {
        for entry in &mut recipe.channels {
            if columns.iter().any(|column| is_meant(entry, column)) {
                change(entry);
            }
        }
        return;
    }
    for column in columns {
        if let Some(entry) = recipe
            .channels
            .iter_mut()
            .rev()
            .find(|entry| is_meant(entry, column))
            && entry.quantity == *column
        {
            change(entry);
        } else if let Some(mut entry) = entry_of(recipe, column) {
            change(&mut entry);
            recipe.channels.push(entry);
        }
    }
}

/// The effective entry of a column, as an entry for that column alone.
fn entry_of(recipe: &Recipe, column: &str) -> Option<Assignment> {
    recipe.channels.iter().rev().find_map(|entry| {
        if entry.quantity == column {
            return Some(entry.clone());
        }
        let number = pattern_number(entry, column)?;
        let channel = entry
            .channel
            .replacen("{i}", &(number - 1 + entry.first).to_string(), 1);
        Some(Assignment {
            channel,
            quantity: column.into(),
            first: 1,
            ..entry.clone()
        })
    })
}

/// Number of the cable for which a pattern yields a column.
fn pattern_number(entry: &Assignment, column: &str) -> Option<usize> {
    let quantity = Quantity::parse(column).filter(|quantity| quantity.is_per_cable())?;
    (entry.quantity == quantity.kind.column_of("{i}")).then_some(quantity.index + 1)
}
