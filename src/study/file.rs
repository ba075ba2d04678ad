//! Study files: what is varied, what is simulated, what is asked. TOML, checked with one sentence for each mistake.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect;
use tautline_core::robot::FieldError;
use tautline_session::VersionedFile;

/// A study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyFile {
    /// Title of its report.
    pub name: String,
    /// Seed of all random numbers.
    #[serde(default = "one")]
    pub seed: u64,
    /// What is varied.
    pub design: Design,
    /// What is simulated.
    #[serde(default)]
    pub simulation: Simulation,
    /// Faults that simulated robots have and their description does not know.
    #[serde(default)]
    pub faults: Vec<Fault>,
    /// Root mean square position error over the workspace that is wanted (m); the report says which cells reach it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted_m: Option<f64>,
}

/// What is varied: every combination is a cell, or so many of them at random.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Design {
    /// Presets (`mini`, `hall`, `suspended`, `planar`) or robot.json files beside the study.
    pub robots: Vec<String>,
    /// Largest side of the frame (m) to which robots are scaled; none: as they are.
    #[serde(default)]
    pub size_m: Axis,
    /// Sensors of the catalogue, `none`, or `own` for the laser as the robot's file states it.
    #[serde(default = "own")]
    pub lasers: Vec<String>,
    /// Numbers of poses, home not counted.
    #[serde(default = "poses")]
    pub poses: Vec<usize>,
    /// How poses are chosen.
    #[serde(default = "planned")]
    pub choice: Vec<Choice>,
    /// Standard deviation of each coordinate of the home position (m); its orientation gets better and worse with it.
    #[serde(default)]
    pub home_sd_m: Axis,
    /// Standard deviation of an inclinometer (rad); 0 is none.
    #[serde(default)]
    pub inclinometer_sd_rad: Axis,
    /// Standard deviation of a length reading (m).
    #[serde(default)]
    pub length_sd_m: Axis,
    /// Standard deviation of a tension (N).
    #[serde(default)]
    pub tension_sd_n: Axis,
    /// Methods of identification.
    #[serde(default = "joint")]
    pub methods: Vec<Method>,
    /// So many cells at random instead of all; ranges need it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub random_cells: Option<usize>,
}

/// Values of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected an array of numbers or { from = .., to = .. }"
)]
pub enum Axis {
    /// These; none: as the robot's file states.
    Values(Vec<f64>),
    /// At random in a range, uniform in the logarithm.
    Range {
        /// Smallest.
        from: f64,
        /// Largest.
        to: f64,
    },
}

impl Default for Axis {
    fn default() -> Self {
        Self::Values(Vec::new())
    }
}

/// How the poses of a cell are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Choice {
    /// As the command `plan` chooses them.
    Planned,
    /// At random among those that can be measured.
    Random,
}

/// A method of identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Tensions are latent (Problem R2).
    Joint,
    /// Tensions are what the sensors say (Problem R1).
    Simple,
}

impl Method {
    /// That of the solver.
    #[must_use]
    pub fn of_solver(self) -> tautline_core::estimation::Method {
        match self {
            Self::Joint => tautline_core::estimation::Method::Joint,
            Self::Simple => tautline_core::estimation::Method::Simple,
        }
    }
}

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Simulation {
    /// Simulated calibrations of a cell.
    pub calibrations: u64,
    /// Part of the cells, drawn at random, that are simulated; with faults all of them are.
    pub share: f64,
    /// Calibrations of a chunk.
    pub chunk: u64,
    /// Level of the global test that detects faults.
    pub alpha: f64,
    /// Calibrations of a cell, the first ones, after which the doctor is asked; it takes a thousand times as long.
    pub diagnosed: u64,
}

impl Default for Simulation {
    fn default() -> Self {
        Self {
            calibrations: 1000,
            share: 0.1,
            chunk: 20_000,
            alpha: 0.01,
            diagnosed: 0,
        }
    }
}

/// A fault and how often it occurs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fault {
    /// Effect of the catalogue; its cable is drawn.
    pub effect: String,
    /// Probability that a calibration has it.
    pub rate: f64,
    /// Values of parameters; those that are not given are drawn from their typical sizes.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
}

fn one() -> u64 {
    1
}

fn own() -> Vec<String> {
    vec!["own".to_owned()]
}

fn poses() -> Vec<usize> {
    vec![25]
}

fn planned() -> Vec<Choice> {
    vec![Choice::Planned]
}

fn joint() -> Vec<Method> {
    vec![Method::Joint]
}

/// Most poses of a cell, faults and calibrations of a study.
const MOST_POSES: usize = 1000;
const MOST_FAULTS: usize = 8;
const MOST_CALIBRATIONS: u64 = 1_000_000_000;

impl VersionedFile for StudyFile {
    const FORMAT: &'static str = "tautline-study";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 4 << 20;

    fn check(&self) -> Result<(), FieldError> {
        self.design.check()?;
        let simulation = &self.simulation;
        let whole = 1..=MOST_CALIBRATIONS;
        let number = |key: &str, value: u64| {
            expect(
                whole.contains(&value),
                &format!("/simulation/{key}"),
                value,
                "a number from 1 to 1e9",
            )
        };
        number("calibrations", simulation.calibrations)?;
        number("chunk", simulation.chunk)?;
        let part = |value: f64| (0.0..=1.0).contains(&value);
        expect(
            part(simulation.share),
            "/simulation/share",
            simulation.share,
            "a part from 0 to 1",
        )?;
        let level = simulation.alpha > 0.0 && simulation.alpha < 1.0;
        expect(
            level,
            "/simulation/alpha",
            simulation.alpha,
            "a level between 0 and 1",
        )?;
        if self.faults.len() > MOST_FAULTS {
            return fail(
                "/faults",
                format!(
                    "found {} faults, expected at most {MOST_FAULTS}",
                    self.faults.len()
                ),
            );
        }
        for (index, fault) in self.faults.iter().enumerate() {
            let at = |key: &str| format!("/faults/{index}/{key}");
            expect(
                part(fault.rate),
                &at("rate"),
                fault.rate,
                "a part from 0 to 1",
            )?;
            let Some(found) = effect::find(&fault.effect) else {
                let message = format!(
                    "found \"{}\", expected an effect that the command effects lists",
                    fault.effect
                );
                return fail(at("effect"), message);
            };
            if matches!(found.scope(), effect::Scope::Pair | effect::Scope::Reading) {
                let message = format!(
                    "found \"{}\", expected an effect of one cable or of the robot",
                    fault.effect
                );
                return fail(at("effect"), message);
            }
            let names: Vec<&str> = found.parameters().iter().map(|p| p.name).collect();
            if let Some(unknown) = fault
                .parameters
                .keys()
                .find(|name| !names.contains(&name.as_str()))
            {
                let message = format!(
                    "found the parameter \"{unknown}\", expected {}",
                    names.join(", ")
                );
                return fail(at("parameters"), message);
            }
        }
        match self.wanted_m {
            Some(wanted) => expect(
                wanted > 0.0 && wanted.is_finite(),
                "/wanted_m",
                wanted,
                "a number greater than 0",
            ),
            None => Ok(()),
        }
    }
}

impl Design {
    fn check(&self) -> Result<(), FieldError> {
        for (key, is_empty) in [
            ("robots", self.robots.is_empty()),
            ("lasers", self.lasers.is_empty()),
            ("poses", self.poses.is_empty()),
            ("choice", self.choice.is_empty()),
            ("methods", self.methods.is_empty()),
        ] {
            if is_empty {
                return fail(
                    format!("/design/{key}"),
                    "found an empty array, expected one value or more",
                );
            }
        }
        for (index, poses) in self.poses.iter().enumerate() {
            let good = (1..=MOST_POSES).contains(poses);
            expect(
                good,
                &format!("/design/poses/{index}"),
                poses,
                "a number from 1 to 1000",
            )?;
        }
        let random = self.random_cells;
        if random == Some(0) {
            return fail("/design/random_cells", "found 0, expected 1 or more");
        }
        for (key, axis, may_be_0) in [
            ("size_m", &self.size_m, false),
            ("home_sd_m", &self.home_sd_m, false),
            ("inclinometer_sd_rad", &self.inclinometer_sd_rad, true),
            ("length_sd_m", &self.length_sd_m, false),
            ("tension_sd_n", &self.tension_sd_n, false),
        ] {
            axis.check(&format!("/design/{key}"), may_be_0, random.is_some())?;
        }
        Ok(())
    }
}

impl Axis {
    fn check(&self, pointer: &str, may_be_0: bool, is_random: bool) -> Result<(), FieldError> {
        let good = |value: f64| value.is_finite() && (value > 0.0 || may_be_0 && value == 0.0);
        match self {
            Self::Values(values) => match values.iter().position(|value| !good(*value)) {
                Some(index) => expect(
                    false,
                    &format!("{pointer}/{index}"),
                    values[index],
                    "a number greater than 0",
                ),
                None => Ok(()),
            },
            Self::Range { from, to } if !(*from > 0.0 && to > from && to.is_finite()) => fail(
                pointer,
                format!("found {from} to {to}, expected a rising range above 0"),
            ),
            Self::Range { .. } if !is_random => fail(
                pointer,
                "found a range, expected values, or a number of random_cells beside",
            ),
            Self::Range { .. } => Ok(()),
        }
    }
}

fn expect(
    is_good: bool,
    pointer: &str,
    found: impl std::fmt::Display,
    expected: &str,
) -> Result<(), FieldError> {
    if is_good {
        return Ok(());
    }
    fail(pointer, format!("found {found}, expected {expected}"))
}

fn fail<T>(pointer: impl Into<String>, message: impl Into<String>) -> Result<T, FieldError> {
    Err(FieldError {
        pointer: pointer.into(),
        message: message.into(),
    })
}

#[cfg(test)]
mod tests {
    use tautline_session::parse_versioned_toml;

    use super::*;

    fn read(rest: &str) -> Result<StudyFile, String> {
        let text = format!("format = \"tautline-study\"\nversion = 1\nname = \"s\"\n{rest}");
        let read = parse_versioned_toml(text.as_bytes(), "s.toml");
        read.map(|read| read.value)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn the_shortest_study_has_defaults() {
        let study = read("[design]\nrobots = [\"mini\"]\n").expect("valid");
        assert_eq!(study.design.poses, [25]);
        assert_eq!(study.simulation, Simulation::default());
    }

    #[test]
    fn mistakes_are_one_sentence_with_their_field() {
        for (text, sentence) in [
            ("", "s.toml: has no key \"design\", expected one"),
            (
                "[design]\nrobots = []",
                "s.toml, /design/robots: found an empty array, expected one value or more",
            ),
            (
                "[design]\nrobots = [\"mini\"]\nposes = [0]",
                "s.toml, /design/poses/0: found 0, expected a number from 1 to 1000",
            ),
            (
                "[design]\nrobots = [\"mini\"]\nhome_sd_m = [nan]",
                "s.toml, /design/home_sd_m: found an array of 1, expected an array of numbers or { from = .., to = .. }",
            ),
            (
                "[design]\nrobots = [\"mini\"]\nhome_sd_m = {from = 1e-5, to = 1e-3}",
                "s.toml, /design/home_sd_m: found a range, expected values, or a number of random_cells beside",
            ),
            (
                "[design]\nrobots = [\"mini\"]\n[[faults]]\neffect = \"rust\"\nrate = 0.1",
                "s.toml, /faults/0/effect: found \"rust\", expected an effect that the command effects lists",
            ),
            (
                "[design]\nrobots = [\"mini\"]\n[simulation]\nshare = 2.0",
                "s.toml, /simulation/share: found 2, expected a part from 0 to 1",
            ),
        ] {
            assert_eq!(read(text).expect_err(sentence), sentence);
        }
    }
}
