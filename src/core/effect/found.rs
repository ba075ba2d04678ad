//! An identified effect, described for the people who repair the robot.

use super::BoundEffect;
use super::words::{
    degrees, displacement, list, millimetres, milliseconds, newtons, percent, sentence, size,
};
use crate::robot::Robot;

/// An effect with its targets and values, on the robot where it was identified.
#[derive(Debug, Clone, Copy)]
pub struct FoundEffect<'a> {
    robot: &'a Robot,
    bound: &'a BoundEffect,
    /// Whether sentences are templates: they keep their fields, with the names of parameters.
    as_template: bool,
}

/// Parts of which the robot has one per cable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CablePart {
    /// The cable itself.
    Cable,
    /// Its winch.
    Winch,
    /// Its pulley.
    Pulley,
    /// Its force sensor.
    ForceSensor,
}

impl CablePart {
    /// Singular and plural.
    fn nouns(self) -> [&'static str; 2] {
        match self {
            Self::Cable => ["cable", "cables"],
            Self::Winch => ["winch", "winches"],
            Self::Pulley => ["pulley", "pulleys"],
            Self::ForceSensor => ["force sensor", "force sensors"],
        }
    }
}

impl<'a> FoundEffect<'a> {
    /// The effect `bound` on `robot`.
    pub fn new(robot: &'a Robot, bound: &'a BoundEffect) -> Self {
        Self {
            robot,
            bound,
            as_template: false,
        }
    }

    /// The same, with sentences that keep their fields, as in a hypothesis file.
    pub(super) fn as_template(robot: &'a Robot, bound: &'a BoundEffect) -> Self {
        Self {
            as_template: true,
            ..Self::new(robot, bound)
        }
    }

    /// Sentences of cause and workshop of a hypothesis.
    pub(super) fn sentences_of_text(&self) -> [&'static str; 2] {
        let physics = self.bound.effect.text_physics;
        physics.map_or([""; 2], |physics| physics.sentences())
    }

    /// The robot.
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// Indices of the cables that share the values.
    pub fn cables(&self) -> &'a [usize] {
        &self.bound.cables
    }

    /// Value of a parameter (SI units).
    pub fn value(&self, parameter: usize) -> f64 {
        self.bound.values[parameter]
    }

    /// Fills in a sentence about this effect: fields in braces are replaced, the first letter becomes a capital.
    ///
    /// - `{cable}`, `{winch}`, `{pulley}`, `{force sensor}`: these parts of the cables concerned, see [`Self::name`];
    /// - `{is|are}`: the first for one cable, the second for several;
    /// - `{0:more|less}`: the first for a value of parameter 0 that is not negative, the second for one below 0;
    /// - `{0:mm}`, `{0:%}`, `{0:deg}`, `{0:ms}`, `{0:N}`, `{0:unit}`: size of parameter 0 in millimetres, percent,
    ///   degrees, milliseconds, newtons, its own unit;
    /// - `{0:pose}`: the pose of which parameter 0 is the label; `{0:row}`: the row with this number;
    /// - `{scale}`, `{scale:%}`: the parameter of this name, in the form that suits its unit or in a given one;
    /// - `{displacement}`: the first three parameters as a displacement;
    /// - `{revolutions:a|b}`: the first where winches count revolutions, the second where lengths are read.
    pub fn say(&self, text: &str) -> String {
        self.say_with(text, "")
    }

    /// As [`Self::say`], with `insert` in place of the field `{}`.
    pub fn say_with(&self, text: &str, insert: &str) -> String {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            let (field, after) = after.split_once('}').unwrap_or((after, ""));
            filled += before;
            filled += &match field {
                "" if self.as_template => NOT_A_FIELD.to_owned(),
                _ if self.as_template => self.named_field(field),
                "" => insert.to_owned(),
                _ => self.field(field),
            };
            rest = after;
        }
        filled += rest;
        sentence(&filled)
    }

    /// Replacement of a field; the field itself, in braces, if it is unknown.
    fn field(&self, field: &str) -> String {
        let unknown = || format!("{{{field}}}");
        let names = self.bound.effect.parameters.iter().map(|p| p.name);
        let either = |choice: &str, first: bool| match choice.split_once('|') {
            Some((one, other)) => if first { one } else { other }.to_owned(),
            None => unknown(),
        };
        match field.split_once(':') {
            None => match field {
                "cable" => self.name(CablePart::Cable),
                "winch" => self.name(CablePart::Winch),
                "pulley" => self.name(CablePart::Pulley),
                "force sensor" => self.name(CablePart::ForceSensor),
                "displacement" => match self.bound.values.get(..3) {
                    Some(vector) => displacement(vector),
                    None => unknown(),
                },
                _ => match names.clone().position(|name| name == field) {
                    Some(index) => self.in_its_unit(index),
                    None => either(field, self.cables().len() == 1),
                },
            },
            Some(("revolutions", choice)) => either(choice, self.counts_revolutions()),
            Some((parameter, form)) => {
                let by_name = || names.clone().position(|name| name == parameter);
                let Some(index) = parameter
                    .parse()
                    .ok()
                    .or_else(by_name)
                    .filter(|k| *k < self.bound.values.len())
                else {
                    return unknown();
                };
                let value = self.value(index);
                match form {
                    "mm" => millimetres(value),
                    "%" => percent(value),
                    "ms" => milliseconds(value),
                    "N" => newtons(value),
                    "deg" => degrees(value),
                    "unit" => self.with_its_unit(index),
                    "pose" | "row" => format!("{form} {value:.0}"),
                    _ => either(form, value >= 0.0),
                }
            }
        }
    }

    fn with_its_unit(&self, index: usize) -> String {
        let unit = self.bound.effect.parameters[index].unit;
        match unit {
            "1" => size(self.value(index)),
            _ => format!("{} {unit}", size(self.value(index))),
        }
    }

    /// A parameter in the form that suits its unit.
    fn in_its_unit(&self, index: usize) -> String {
        let value = self.value(index);
        let parameter = &self.bound.effect.parameters[index];
        match parameter.unit {
            _ if parameter.discrete => format!("pose {value:.0}"),
            "1" => percent(value),
            "m" => millimetres(value),
            "s" => milliseconds(value),
            "N" => newtons(value),
            "rad" => degrees(value),
            _ => self.with_its_unit(index),
        }
    }

    /// A field with the number of a parameter replaced by its name.
    fn named_field(&self, field: &str) -> String {
        let named = field.split_once(':').and_then(|(index, form)| {
            let index: usize = index.parse().ok()?;
            let name = self.bound.effect.parameters.get(index)?.name;
            Some(format!("{{{name}:{form}}}"))
        });
        named.unwrap_or_else(|| format!("{{{field}}}"))
    }

    /// Whether winches count revolutions from a home pose, rather than reading the length of a cable.
    pub fn counts_revolutions(&self) -> bool {
        self.robot.home.is_some()
    }

    /// The parts of the cables concerned, without capital: `winch 3`, `winches 1, 4 and 5`, `all winches`, `the
    /// winch of left-front`.
    pub fn name(&self, part: CablePart) -> String {
        let [one, several] = part.nouns();
        let cables = self.cables();
        if cables.len() > 1 && cables.len() == self.robot.cable_count() {
            return format!("all {several}");
        }
        let noun = if cables.len() == 1 { one } else { several };
        let numbers: Option<Vec<String>> = cables.iter().map(|i| self.number(*i)).collect();
        if let Some(numbers) = numbers {
            return format!("{noun} {}", list(&numbers));
        }
        let names: Vec<String> = cables
            .iter()
            .map(|i| self.robot.cables[*i].name.clone())
            .collect();
        match part {
            CablePart::Cable => format!("{noun} {}", list(&names)),
            _ => format!("the {noun} of {}", list(&names)),
        }
    }

    /// Number of a cable, counted from 1, if its name contains nothing else.
    fn number(&self, index: usize) -> Option<String> {
        let name = self.robot.cables[index].name.to_lowercase();
        let name = name.strip_prefix("cable").unwrap_or(&name);
        let digits = name.trim_start_matches(['-', '_', ' ']);
        let number = (index + 1).to_string();
        (digits == number).then_some(number)
    }

    /// The value that the cables concerned have in common; `None` if they differ.
    pub(super) fn common<T: PartialEq>(&self, of: impl Fn(usize) -> T) -> Option<T> {
        let mut values = self.cables().iter().map(|index| of(*index));
        let first = values.next()?;
        values.all(|value| value == first).then_some(first)
    }
}

/// Placeholder in a template for text that only code can fill in.
pub(super) const NOT_A_FIELD: &str = "{}";

/// Offset and text of the first field of a sentence that cannot be filled in, given the names of the parameters.
pub(super) fn unknown_field<'t>(text: &'t str, parameters: &[&str]) -> Option<(usize, &'t str)> {
    let mut from = 0;
    while let Some(open) = text[from..].find('{') {
        let at = from + open;
        let length = text[at + 1..].find('}').unwrap_or(text.len() - at - 1);
        let field = &text[at + 1..at + 1 + length];
        if !is_field(field, parameters) {
            return Some((at, field));
        }
        from = at + 1 + length;
    }
    None
}

fn is_field(field: &str, parameters: &[&str]) -> bool {
    let is_choice = |text: &str| text.contains('|');
    match field.split_once(':') {
        None if field == "displacement" => parameters.len() >= 3,
        None => {
            let parts = ["cable", "winch", "pulley", "force sensor"];
            parts.contains(&field) || parameters.contains(&field) || is_choice(field)
        }
        Some(("revolutions", choice)) => is_choice(choice),
        Some((name, form)) => {
            let forms = ["mm", "%", "ms", "N", "deg", "unit", "pose"];
            parameters.contains(&name) && (forms.contains(&form) || is_choice(form))
        }
    }
}

impl BoundEffect {
    /// Sentence on the fault for a technician.
    pub fn cause(&self, robot: &Robot) -> String {
        (self.effect.cause)(&FoundEffect::new(robot, self))
    }

    /// Advice for the workshop.
    pub fn workshop(&self, robot: &Robot) -> String {
        (self.effect.workshop)(&FoundEffect::new(robot, self))
    }

    /// A sentence about the effect with its fields filled in.
    pub(crate) fn say(&self, robot: &Robot, text: &str) -> String {
        FoundEffect::new(robot, self).say(text)
    }
}
