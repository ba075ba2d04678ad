//! Effects of the catalogue as hypothesis files.

use super::super::found::NOT_A_FIELD;
use super::super::{
    AsText, BoundEffect, Effect, EffectParameter, FoundEffect, Scope, Search, Stage,
};
use super::formula::is_reserved;
use super::unit::Unit;
use crate::robot::Robot;

/// An effect that no hypothesis file can express.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("effect \"{effect}\" cannot be written as text: it {reason}")]
pub struct NotAsText {
    /// The effect.
    pub effect: &'static str,
    /// Property of the effect that formulas cannot express, as a verb phrase.
    pub reason: &'static str,
}

impl Effect {
    /// The text of a hypothesis file with the same physics, parameters and priors, in sentences about a robot like this one;
    /// its identifier begins with `my_`. For a hypothesis, its own text.
    ///
    /// # Errors
    /// If formulas cannot express it.
    pub fn as_text(&'static self, robot: &Robot) -> Result<String, NotAsText> {
        if let Some(physics) = self.text_physics {
            return Ok(physics.text().to_owned());
        }
        let formulas = match self.as_text {
            AsText::Formulas(formulas) => formulas,
            AsText::Impossible(reason) => {
                return Err(NotAsText {
                    effect: self.id,
                    reason,
                });
            }
        };
        let names: Vec<String> = (self.parameters.iter())
            .map(|p| name_in_file(p.name, formulas))
            .collect();
        let mut text = format!(
            "# The effect {} of the catalogue as a hypothesis, to be copied and changed.\n",
            self.id
        );
        let mut line = |key: &str, value: String| text += &format!("{key} = {value}\n");
        line("id", quoted(&format!("my_{}", self.id)));
        line("title", quoted(self.title));
        line("scope", quoted(scope_in_file(self.scope)));
        let [cause, workshop] = self.templates(robot, &names);
        line("cause", quoted(&cause));
        line("workshop", quoted(&workshop));
        if let Some(check) = self.check {
            line("check", quoted(check));
        }
        line("source", quoted(self.source));
        if self.stage == Stage::Sensor {
            line("stage", quoted("sensor"));
        }
        if let Some(variable) = self.variable {
            line("variable", quoted(variable.name()));
        }
        if self.is_damage {
            line("damage", "true".to_owned());
        }
        for (index, (parameter, name)) in self.parameters.iter().zip(&names).enumerate() {
            text += &format!("\n[parameters.{name}]\n");
            text += &self.parameter_in_file(index, parameter);
        }
        text += "\n[change]\n";
        for (changed, formula) in formulas {
            text += &format!("{changed} = {}\n", quoted(formula));
        }
        Ok(text)
    }

    fn parameter_in_file(&self, index: usize, p: &EffectParameter) -> String {
        let is_pose = self.pose_parameter() == Some(index);
        let unit = match Unit::parse(p.unit) {
            _ if is_pose => "pose",
            Some(_) => p.unit,
            None => "1",
        };
        let [low, high] = p.typical;
        let mut text = format!("unit = {}\ntypical = [{low:?}, {high:?}]\n", quoted(unit));
        if is_pose {
            return text;
        }
        let mut line = |key: &str, value: String| text += &format!("{key} = {value}\n");
        if p.prior_sd != low.abs().max(high.abs()) {
            line("prior_sd", format!("{:?}", p.prior_sd));
        }
        if p.neutral != 0.0 {
            line("neutral", format!("{:?}", p.neutral));
        }
        if p.start != p.neutral {
            line("start", format!("{:?}", p.start));
        }
        let [least, most] = p.bounds;
        if p.bounds != [f64::NEG_INFINITY, f64::INFINITY] {
            line("bounds", format!("[{least:?}, {most:?}]"));
        }
        if let Search::Wave { phase, period } = self.search {
            if phase == index {
                line("role", quoted("phase"));
            } else if period == Some(index) {
                line("role", quoted("period"));
            }
        }
        text
    }

    /// Sentences of cause and workshop with fields. One that only code can fill in is replaced by the sizes.
    fn templates(&'static self, robot: &Robot, names: &[String]) -> [String; 2] {
        let bound = BoundEffect {
            effect: self,
            cables: vec![0],
            targeted: true,
            values: self.parameters.iter().map(|p| p.typical[1]).collect(),
        };
        let found = FoundEffect::as_template(robot, &bound);
        [(self.cause)(&found), (self.workshop)(&found)].map(|template| {
            let added_at_the_end = format!("{NOT_A_FIELD}.");
            let mut text = match template.strip_suffix(&added_at_the_end) {
                Some(before) if !before.ends_with(' ') => format!("{before}."),
                _ => template,
            };
            if text.contains(NOT_A_FIELD) {
                let sizes = self.parameters.iter().filter(|p| !p.discrete);
                let sizes: Vec<String> = sizes
                    .map(|p| format!("{} {{{}:unit}}", p.name, p.name))
                    .collect();
                let place = if self.scope == Scope::Robot {
                    ""
                } else {
                    " on {cable}"
                };
                text = format!("{}{place}: {}.", self.title, sizes.join(", "));
            }
            for (p, name) in self.parameters.iter().zip(names) {
                text = text.replace(&format!("{{{}:", p.name), &format!("{{{name}:"));
            }
            text
        })
    }
}

/// Name of a parameter that is not that of a quantity or function.
fn name_in_file(name: &str, formulas: &[(&str, &str)]) -> String {
    let is_taken = is_reserved(name) || formulas.iter().any(|(changed, _)| *changed == name);
    match is_taken {
        true => format!("{name}_change"),
        false => name.to_owned(),
    }
}

fn scope_in_file(scope: Scope) -> &'static str {
    match scope {
        Scope::Cable => "cable",
        Scope::CableOrAll => "cable_or_all",
        Scope::Pair => "cable_pair",
        Scope::Robot => "robot",
    }
}

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}
