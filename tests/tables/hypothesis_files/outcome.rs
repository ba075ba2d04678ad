//! Data sets of the study, and what is found in them.

use serde::{Deserialize, Serialize};

use crate::tables::hidden::Found;

/// What kind of machine is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Machine {
    /// Every part is as drawn.
    Exact,
    /// Every part deviates by typical tolerances.
    WellKept,
}

impl Machine {
    /// Both kinds.
    pub const ALL: [Self; 2] = [Self::Exact, Self::WellKept];

    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::WellKept => "well-kept",
        }
    }
}

/// One data set.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Case {
    /// Name of the robot.
    pub robot: String,
    /// What is hidden; `None` for causes of the catalogue by chance, and ten files that have nothing to do with them.
    pub form: Option<String>,
    /// What kind of machine it is.
    pub machine: Machine,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// What is found in a data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// With a form that the catalogue does not have.
    Tried(Tried),
    /// With ten irrelevant files.
    Crowd(Crowd),
}

/// What is found of a form.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Tried {
    /// Chi-square that readings without noise leave of it.
    pub noncentrality: f64,
    /// Causes that the doctor names without a file.
    pub named: Vec<String>,
    /// Whether it leaves something unexplained.
    pub is_unexplained: bool,
    /// Whether exact evidence separates the form from the grammar and the catalogue; `None` if it is not in the grammar.
    pub form_is_separated: Option<bool>,
    /// Number of patterns listed.
    pub patterns: usize,
    /// Place of the form among them.
    pub place: Option<usize>,
    /// Residuals at held-out poses without and with the first pattern, over the noise.
    pub gain: Option<(f64, f64)>,
    /// Causes of the catalogue that are named where the patterns are weighed.
    pub named_beside_patterns: Vec<String>,
    /// Held-out error of the model with the first pattern relative to that of the true model.
    pub held_out_ratio: Option<f64>,
    /// Why no file can describe it on this robot.
    pub not_a_file: Option<String>,
    /// Whether exact evidence separates its file from the catalogue.
    pub file_is_separated: Option<bool>,
    /// Verdict with its file beside the data.
    pub found: Option<Found>,
    /// Whether the file of another form is named.
    pub wrong_file_is_named: Option<bool>,
}

/// What ten irrelevant files change.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Crowd {
    /// Whether all verdicts are the same.
    pub is_same: bool,
    /// Verdicts without the files and with them.
    pub answers: [String; 2],
    /// Whether one of the files is named.
    pub is_file_named: bool,
    /// Processor time without the files and with them (s).
    pub seconds: [f64; 2],
}
