//! Texts of other programs that are read and written: firmware and simulators.
//!
//! Each dialect is a table of [`Setting`]s, with the meaning of its numbers, and the robot that they describe. The positions of
//! the numbers in the text are known, so a calibrated robot is written by changing numbers in the user's own text, or in a new
//! text of the same dialect.

use std::ops::Range;

use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_session::Loaded;

/// Meaning of a number for the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// Coordinate x, y or z of the point from which a cable is seen to come.
    EntryPoint(usize),
    /// Coordinate x, y or z of the point of the platform at which a cable ends. Every text that states it expresses the model's.
    Anchor(usize),
    /// Coordinate x, y or z of such a point from the centre of mass, which stands in another text.
    AnchorFromMass(usize),
    /// Cable per revolution of a motor, or the radius of a drum.
    CablePerRevolution,
    /// Growth of the drums by the cable on them.
    BuildUp,
    /// Axial stiffness of the cables.
    Stiffness,
    /// A number that a calibration does not change.
    Kept,
}

/// A number that a dialect states once or for every cable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Key of the setting; `{cable}` stands for the name of the cable there, `{index}` for its number from 0.
    pub(super) key: &'static str,
    /// Meaning for the robot.
    pub meaning: Meaning,
    /// Unit in the text, and how many of it are one SI unit.
    pub unit: (&'static str, f64),
    /// Default in the unit of the text; `None` if the text has to state the number.
    pub(super) default: Option<f64>,
    /// Range of the search of a projection on either side, in the unit of the text; 0 if the value is not searched.
    pub range: f64,
    /// Digits after the point that are written.
    pub digits: usize,
}

/// Metres and millimetres.
pub(super) const M: (&str, f64) = ("m", 1.0);
pub(super) const MM: (&str, f64) = ("mm", 1e3);

impl Setting {
    /// A number that is read, has a default and stays as it is.
    pub(super) const fn kept(key: &'static str, unit: (&'static str, f64), default: f64) -> Self {
        Self {
            key,
            meaning: Meaning::Kept,
            unit,
            default: Some(default),
            range: 0.0,
            digits: 0,
        }
    }

    /// A coordinate of the point from which a cable is seen to come. A pulley moves the best point by less than twice its radius.
    pub(super) const fn point(key: &'static str, axis: usize, unit: (&'static str, f64)) -> Self {
        Self {
            meaning: Meaning::EntryPoint(axis),
            default: None,
            range: 0.1 * unit.1,
            digits: if unit.1 > 1.0 { 3 } else { 6 },
            ..Self::kept(key, unit, 0.0)
        }
    }

    /// A coordinate of the point from which a cable comes in a text of geometry.
    pub(super) const fn entry(axis: usize) -> Self {
        Self::point("", axis, M)
    }

    /// A coordinate of the point of the platform at which a cable ends: it is the model's, without a search.
    pub(super) const fn anchor(axis: usize) -> Self {
        Self {
            meaning: Meaning::Anchor(axis),
            range: 0.0,
            ..Self::entry(axis)
        }
    }
}

/// A number of a text that a calibration may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name in the text.
    pub key: String,
    /// Name of its cable; empty if it belongs to all.
    pub cable: String,
    /// Value in the unit of the text.
    pub value: f64,
    /// Its setting in the table of the dialect.
    pub row: Setting,
    /// Bytes of the value in the text.
    pub(super) at: Range<usize>,
}

impl Parameter {
    /// Whether a value equals the one in the text to its rounding.
    #[must_use]
    pub fn is_unchanged(&self, value: f64) -> bool {
        (value - self.value).abs() <= 0.5 * 0.1_f64.powi(self.row.digits as i32)
    }

    /// A value as it is written.
    #[must_use]
    pub fn written(&self, value: f64) -> String {
        // Without a negative zero.
        let scale = 10_f64.powi(self.row.digits as i32);
        let rounded = (value * scale).round() / scale + 0.0;
        format!("{rounded:.*}", self.row.digits)
    }
}

/// The robot that a text describes, and the numbers in it that a calibration may change.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeignRobot {
    /// The robot, which includes assumptions for missing values.
    pub robot: Robot,
    /// Notices of reading.
    pub notices: Vec<String>,
    /// The numbers that may be changed.
    pub parameters: Vec<Parameter>,
}

impl ForeignRobot {
    pub(super) fn new(read: Loaded<Robot>, parameters: Vec<Parameter>) -> Self {
        Self {
            robot: read.value,
            notices: read.notices,
            parameters,
        }
    }

    /// `text`, from which this was read, with other values of the parameters in the form of `written`; `None` keeps the old text.
    #[must_use]
    pub fn text_with(
        &self,
        text: &str,
        values: &[f64],
        written: &dyn Fn(&Parameter, f64) -> Option<String>,
    ) -> String {
        let all = self.parameters.iter().zip(values);
        let new = all.filter_map(|(one, value)| Some((one.at.clone(), written(one, *value)?)));
        let mut new: Vec<(Range<usize>, String)> = new.collect();
        new.sort_by_key(|(at, _)| at.start);
        let mut text = text.to_owned();
        for (at, value) in new.into_iter().rev() {
            text.replace_range(at, &value);
        }
        text
    }
}

/// Text format in which a program describes a cable robot.
#[derive(Debug)]
pub struct Dialect {
    /// Name in commands.
    pub name: &'static str,
    /// Whether texts state the cable length per motor revolution; those of simulators state geometry only.
    pub has_winches: bool,
    /// Recognises a text of this dialect, or its beginning.
    pub(super) is_in: fn(&str) -> bool,
    /// Reads a text under the name of its file; errors name the place.
    pub read: fn(&str, &str) -> Result<ForeignRobot, ReadError>,
    /// A new text for a robot without effects.
    pub new_text: fn(&Robot) -> String,
    /// The text of the bodies in a dialect that has them in a file of their own.
    pub bodies: Option<fn(&Robot) -> String>,
}
