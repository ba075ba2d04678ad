//! Texts of other programs that are read and written: firmware and simulators.
//!
//! Each dialect is a table of [`Row`]s, what its numbers mean, and the robot that they describe. The places of the numbers are known,
//! so a calibrated robot is written by changing numbers in the user's own text, or in a new text of the same dialect.

use std::ops::Range;

use tautline_core::robot::Robot;
use tautline_session::ReadError;

use super::settings::{Settings, replaced};
use super::{klipper, maslow, reprap};

/// Meaning of a number for the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// Coordinate x, y or z of the point from which a cable is seen to come.
    EntryPoint(usize),
    /// Cable per revolution of a motor, or the radius of a drum.
    CablePerRevolution,
    /// Growth of the drums by the cable on them.
    BuildUp,
    /// Axial stiffness of the cables.
    Stiffness,
    /// Something else, which a calibration does not change.
    Other,
}

/// A number that a dialect states once or for every cable.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// Key of the setting; `{cable}` stands for the name of the cable there, `{index}` for its number from 0.
    pub(super) key: &'static str,
    /// Meaning for the robot.
    pub(super) meaning: Meaning,
    /// Unit in the text, and its SI value.
    pub(super) unit: (&'static str, f64),
    /// Value where the text does not state it, in the unit of the text; `None` if it must.
    pub(super) default: Option<f64>,
    /// How far a projection looks for a better value, in the unit of the text; 0 if it does not.
    pub(super) range: f64,
    /// Digits after the point that are written.
    pub(super) digits: usize,
}

/// Millimetres.
pub(super) const MM: (&str, f64) = ("mm", 1e-3);
/// A pure number.
pub(super) const ONE: (&str, f64) = ("", 1.0);

impl Row {
    /// A number that is read and stays as it is.
    pub(super) const fn kept(
        key: &'static str,
        unit: (&'static str, f64),
        default: Option<f64>,
    ) -> Self {
        Self {
            key,
            meaning: Meaning::Other,
            unit,
            default,
            range: 0.0,
            digits: 0,
        }
    }

    /// A coordinate of the point from which a cable is seen to come.
    pub(super) const fn anchor(key: &'static str, axis: usize, unit: (&'static str, f64)) -> Self {
        Self {
            key,
            meaning: Meaning::EntryPoint(axis),
            unit,
            default: None,
            // A pulley moves the best point by less than twice its radius.
            range: 0.1 / unit.1,
            digits: if unit.1 < 1.0 { 3 } else { 6 },
        }
    }
}

/// A number of a text that a calibration may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name in the text.
    pub key: String,
    /// Meaning for the robot.
    pub meaning: Meaning,
    /// Name of its cable, if it belongs to one.
    pub cable: Option<String>,
    /// Value in the unit of the text.
    pub value: f64,
    /// Unit of the text, and its SI value.
    pub unit: (&'static str, f64),
    /// How far a better value is sought, in the unit of the text.
    pub range: f64,
    digits: usize,
    at: Range<usize>,
}

impl Parameter {
    /// Whether a value differs from the one in the text by no more than rounding.
    #[must_use]
    pub fn is_unchanged(&self, value: f64) -> bool {
        (value - self.value).abs() <= 0.5 * 0.1_f64.powi(self.digits as i32)
    }

    /// A value as it is written.
    #[must_use]
    pub fn written(&self, value: f64) -> String {
        let text = format!("{value:.*}", self.digits);
        match text.trim_start_matches('-').trim_matches(['0', '.']) {
            "" => text.trim_start_matches('-').to_owned(),
            _ => text,
        }
    }
}

/// Numbers of a text while they are read.
pub(super) struct Numbers<'t> {
    pub(super) settings: Settings<'t>,
    parameters: Vec<Parameter>,
    used: Vec<String>,
}

impl<'t> Numbers<'t> {
    pub(super) fn of(settings: Settings<'t>) -> Self {
        Self {
            settings,
            parameters: Vec::new(),
            used: Vec::new(),
        }
    }

    /// The number of a row in SI units, for a cable with its index and name.
    pub(super) fn get(
        &mut self,
        row: &Row,
        cable: Option<(usize, &str)>,
    ) -> Result<f64, ReadError> {
        let (index, name) = cable.unwrap_or((0, ""));
        let key = row
            .key
            .replace("{cable}", name)
            .replace("{index}", &index.to_string());
        self.used.push(key.clone());
        let (unit, si) = row.unit;
        let Some(value) = self.settings.number(&key)? else {
            let message = format!("found no {key}, expected a number{}", in_unit(unit));
            let missing =
                || ReadError::new(self.settings.file, tautline_session::Place::File, message);
            return Ok(si * row.default.ok_or_else(missing)?);
        };
        if let Some(at) = self.settings.place(&key).filter(|_| row.range > 0.0) {
            self.parameters.push(Parameter {
                key,
                meaning: row.meaning,
                cable: cable.map(|(_, name)| name.to_owned()),
                value,
                unit: row.unit,
                range: row.range,
                digits: row.digits,
                at,
            });
        }
        Ok(si * value)
    }

    /// The number of a row, which must be positive.
    pub(super) fn positive(
        &mut self,
        row: &Row,
        cable: Option<(usize, &str)>,
    ) -> Result<f64, ReadError> {
        let value = self.get(row, cable)?;
        if value > 0.0 {
            return Ok(value);
        }
        let key = self.used.last().cloned().unwrap_or_default();
        let message = format!(
            "{key}: found {}, expected a positive number",
            value / row.unit.1
        );
        Err(self.settings.error(&key, message))
    }

    /// Keys with this beginning that nothing has read, a list of values as one.
    pub(super) fn unused(&self, prefix: &str) -> Vec<String> {
        let keys = self.settings.keys().filter(|key| key.starts_with(prefix));
        let keys = keys.filter(|key| !self.used.iter().any(|used| used == key));
        let is_number = |text: &str| text.parse::<u32>().is_ok();
        let of_list = |key: &str| match key.rsplit_once('.') {
            Some((list, index)) if is_number(index) => list.to_owned(),
            _ => key.to_owned(),
        };
        let mut names: Vec<String> = keys.map(of_list).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The text with its robot.
    pub(super) fn described(self, robot: Robot, notices: Vec<String>) -> ForeignRobot {
        ForeignRobot {
            robot,
            notices,
            parameters: self.parameters,
        }
    }
}

fn in_unit(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit => format!(" in {unit}"),
    }
}

/// The robot that a text describes, and the numbers in it that a calibration may change.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignRobot {
    /// The robot.
    pub robot: Robot,
    /// What was assumed, and what a robot of ours cannot express.
    pub notices: Vec<String>,
    /// The numbers that may be changed.
    pub parameters: Vec<Parameter>,
}

impl ForeignRobot {
    /// `text`, from which this was read, with exactly these values of the parameters.
    #[must_use]
    pub fn exact_text(&self, text: &str, values: &[f64]) -> String {
        let all = self.parameters.iter().zip(values);
        let parts = all.map(|(parameter, value)| (parameter.at.clone(), value.to_string()));
        replaced(text, &parts.collect::<Vec<_>>())
    }

    /// `text`, from which this was read, with these values of the parameters as the program writes them; what does not change
    /// stays as it is.
    #[must_use]
    pub fn text_with(&self, text: &str, values: &[f64]) -> String {
        let all = self.parameters.iter().zip(values);
        let changed = all.filter(|(parameter, value)| !parameter.is_unchanged(**value));
        let parts =
            changed.map(|(parameter, value)| (parameter.at.clone(), parameter.written(*value)));
        replaced(text, &parts.collect::<Vec<_>>())
    }
}

/// A program's way to describe a cable robot.
#[derive(Debug)]
pub struct Dialect {
    /// Name in commands.
    pub name: &'static str,
    /// Program and file in words.
    pub title: &'static str,
    /// Whether a text is in this dialect; the text may end early.
    pub(super) is_in: fn(&str) -> bool,
    /// Reads a text under the name of its file.
    pub(super) read: fn(&str, &str) -> Result<ForeignRobot, ReadError>,
    /// A new text for a robot.
    pub(super) new: fn(&Robot) -> Result<String, String>,
}

impl Dialect {
    /// All dialects.
    pub const ALL: [&'static Self; 3] = [&reprap::DIALECT, &maslow::DIALECT, &klipper::DIALECT];

    /// The dialect of a text, or of its beginning.
    #[must_use]
    pub fn of(text: &str) -> Option<&'static Self> {
        Self::ALL.into_iter().find(|dialect| (dialect.is_in)(text))
    }

    /// The dialect with this name in commands.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::ALL.into_iter().find(|dialect| dialect.name == name)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// If a number is missing or impossible; names the place.
    pub fn read(&self, file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
        (self.read)(file, text)
    }

    /// A new text for a robot, from its description without effects.
    ///
    /// # Errors
    /// If the dialect cannot describe such a robot; one sentence without full stop.
    pub fn new_text(&self, robot: &Robot) -> Result<String, String> {
        (self.new)(robot)
    }
}
