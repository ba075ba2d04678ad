//! An effect that was found on a robot, in the words of those who repair it.

use super::BoundEffect;
use super::words::{degrees, list, millimetres, percent, size};
use crate::robot::Robot;

/// An effect with its targets and values, on its robot.
#[derive(Debug, Clone, Copy)]
pub struct FoundEffect<'a> {
    robot: &'a Robot,
    bound: &'a BoundEffect,
}

/// What a cable has of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The cable itself.
    Cable,
    /// Its winch.
    Winch,
    /// Its pulley.
    Pulley,
    /// Its force sensor.
    ForceSensor,
}

impl Part {
    /// One of them, and several.
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
    /// `bound` on `robot`.
    #[must_use]
    pub fn new(robot: &'a Robot, bound: &'a BoundEffect) -> Self {
        Self { robot, bound }
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// Indices of the cables that share the values.
    #[must_use]
    pub fn cables(&self) -> &'a [usize] {
        &self.bound.cables
    }

    /// Value of a parameter (SI units).
    #[must_use]
    pub fn value(&self, parameter: usize) -> f64 {
        self.bound.values[parameter]
    }

    /// Size of a parameter in metres, in words: `5.2 mm`.
    #[must_use]
    pub fn millimetres(&self, parameter: usize) -> String {
        millimetres(self.value(parameter))
    }

    /// Size of a ratio in words: `0.31 %`.
    #[must_use]
    pub fn percent(&self, parameter: usize) -> String {
        percent(self.value(parameter))
    }

    /// Size of a parameter in radians, in words: `2.1 degrees`.
    #[must_use]
    pub fn degrees(&self, parameter: usize) -> String {
        degrees(self.value(parameter))
    }

    /// Size of a parameter in its own unit: `12 N`.
    #[must_use]
    pub fn in_its_unit(&self, parameter: usize) -> String {
        let unit = self.bound.effect.parameters()[parameter].unit;
        format!("{} {unit}", size(self.value(parameter)))
    }

    /// A parameter that is the label of a pose: `pose 17`.
    #[must_use]
    pub fn pose(&self, parameter: usize) -> String {
        format!("pose {:.0}", self.value(parameter))
    }

    /// The first word for a value of 0 or more, the second for one below.
    #[must_use]
    pub fn way(&self, parameter: usize, positive: &'a str, negative: &'a str) -> &'a str {
        if self.value(parameter) < 0.0 {
            negative
        } else {
            positive
        }
    }

    /// The first word for one cable, the second for several.
    #[must_use]
    pub fn either(&self, one: &'a str, several: &'a str) -> &'a str {
        if self.bound.cables.len() == 1 {
            one
        } else {
            several
        }
    }

    /// Whether winches count revolutions from a home pose, rather than reading the length of a cable.
    #[must_use]
    pub fn counts_revolutions(&self) -> bool {
        self.robot.home.is_some()
    }

    /// The part of the cables concerned, without capital: `winch 3`, `winches 1, 4 and 5`, `all winches`, `the
    /// winch of left-front`.
    #[must_use]
    pub fn name(&self, part: Part) -> String {
        let [one, several] = part.nouns();
        let cables = self.cables();
        if cables.len() > 1 && cables.len() == self.robot.cable_count() {
            return format!("all {several}");
        }
        let noun = self.either(one, several);
        let numbers: Option<Vec<String>> = cables.iter().map(|i| self.number(*i)).collect();
        if let Some(numbers) = numbers {
            return format!("{noun} {}", list(&numbers));
        }
        let names: Vec<String> = cables
            .iter()
            .map(|i| self.robot.cables[*i].name.clone())
            .collect();
        match part {
            Part::Cable => format!("{noun} {}", list(&names)),
            _ => format!("the {noun} of {}", list(&names)),
        }
    }

    /// The number of a cable whose name says no more than that, counted from 1.
    fn number(&self, index: usize) -> Option<String> {
        let name = self.robot.cables[index].name.to_lowercase();
        let name = name.strip_prefix("cable").unwrap_or(&name);
        let digits = name.trim_start_matches(['-', '_', ' ']);
        let number = (index + 1).to_string();
        (digits == number).then_some(number)
    }

    /// What the cables concerned have in common: `None` if they differ.
    pub(super) fn common<T: PartialEq>(&self, of: impl Fn(usize) -> T) -> Option<T> {
        let mut values = self.cables().iter().map(|index| of(*index));
        let first = values.next()?;
        values.all(|value| value == first).then_some(first)
    }
}

impl BoundEffect {
    /// What is the matter, in the sentence that a technician reads.
    #[must_use]
    pub fn cause(&self, robot: &Robot) -> String {
        (self.effect.cause)(&FoundEffect::new(robot, self))
    }

    /// What to do about it in the workshop.
    #[must_use]
    pub fn workshop(&self, robot: &Robot) -> String {
        (self.effect.workshop)(&FoundEffect::new(robot, self))
    }
}
