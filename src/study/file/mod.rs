//! Study files: TOML that states what is varied and simulated, with the requirements.

mod check;

pub(crate) use check::faults as check_faults;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::effect::Hypothesis;
use tautline_core::robot::FieldError;
use tautline_session::VersionedFile;

/// Content of a study file.
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
    /// Faults of the simulated robots that are absent from their description.
    #[serde(default)]
    pub faults: Vec<Fault>,
    /// Hypotheses of the user that all robots know: texts of hypothesis files.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hypotheses: Vec<Hypothesis>,
    /// Required root mean square position error over the workspace (m); the report states which cells attain it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted_m: Option<f64>,
}

/// What is varied: every combination is a cell, or a random sample of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Design {
    /// Presets (`mini`, `hall`, `suspended`, `planar`) or robot.json files beside the study.
    pub robots: Vec<String>,
    /// Largest side of the frame (m) to which robots are scaled; empty: unscaled.
    #[serde(default)]
    pub size_m: Axis,
    /// Sensors of the catalogue, `none`, or `own` for the laser stated in the file of the robot.
    #[serde(default = "own")]
    pub lasers: Vec<String>,
    /// Numbers of poses, home not counted.
    #[serde(default = "poses")]
    pub poses: Vec<usize>,
    /// Selections of poses.
    #[serde(default = "planned")]
    pub choice: Vec<Choice>,
    /// Standard deviation of each coordinate of the home position (m); that of the orientation is scaled accordingly.
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
    /// Number of cells drawn at random instead of all combinations; required by ranges.
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
    /// These values; empty: as stated in the file of the robot.
    Values(Vec<f64>),
    /// Drawn from a range, log-uniformly.
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

/// Selection of the poses of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Choice {
    /// Planned as by the command `plan`.
    Planned,
    /// Random among the feasible poses.
    Random,
}

/// Method of identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Tensions are latent (Problem R2).
    Joint,
    /// Tensions are what the sensors say (Problem R1).
    Simple,
}

impl Method {
    /// The corresponding method of the solver.
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
    /// Fraction of the cells, drawn at random, that are simulated; with faults all of them are.
    pub share: f64,
    /// Calibrations of a chunk.
    pub chunk: u64,
    /// Significance level of the global test that detects faults.
    pub alpha: f64,
    /// Number of calibrations per cell that are diagnosed, the first ones; a diagnosis takes about a thousand times as long.
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
    /// Effect of the catalogue; its cable is drawn at random.
    pub effect: String,
    /// Probability that a calibration has it.
    pub rate: f64,
    /// Values of parameters; missing ones are drawn from their typical range.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
}

fn one() -> u64 {
    1
}

fn own() -> Vec<String> {
    vec!["own".to_owned()]
}

/// Part of the format: a study file without this key must stay the same study.
fn poses() -> Vec<usize> {
    vec![25]
}

fn planned() -> Vec<Choice> {
    vec![Choice::Planned]
}

fn joint() -> Vec<Method> {
    vec![Method::Joint]
}

impl VersionedFile for StudyFile {
    const FORMAT: &'static str = "tautline-study";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 4 << 20;
    const KEYS_ARE_CHECKED: bool = true;

    fn check(&self) -> Result<(), FieldError> {
        check::study(self)
    }
}

#[cfg(test)]
mod tests {
    use tautline_session::parse_versioned_toml;

    use super::*;

    #[test]
    fn a_mistyped_key_is_answered_with_the_nearest() {
        let text = "format = \"tautline-study\"\nversion = 1\nname = \"a\"\n[design]\nrobots = [\"mini\"]\npose = [25]\n";
        let refused = parse_versioned_toml::<StudyFile>(text.as_bytes(), "a.toml");
        assert_eq!(
            refused.expect_err("an unknown key").to_string(),
            "a.toml, /design/pose: unknown key, did you mean \"poses\"?"
        );
    }

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
                "s.toml, /design/home_sd_m: found a range, expected values; ranges require random_cells",
            ),
            (
                "[design]\nrobots = [\"mini\"]\n[simulation]\nshare = 2.0",
                "s.toml, /simulation/share: found 2, expected a fraction from 0 to 1",
            ),
        ] {
            assert_eq!(read(text).expect_err(sentence), sentence);
        }
    }
}
