//! A diagnosis with its subject and settings.

use std::sync::Arc;

use tautline_core::diagnosis::{Cause, Diagnosis};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_import::Suggestion;

/// A diagnosis with its subject and settings.
#[derive(Debug)]
pub struct Diagnosed {
    /// Robot and measurements, without excluded poses.
    pub dataset: Arc<Dataset>,
    /// Number of measured poses; the dataset has the used ones.
    pub measured: usize,
    /// Mistakes in the readings, corrected in the dataset.
    pub mistakes: Vec<Suggestion>,
    /// The result.
    pub diagnosis: Diagnosis,
    /// False-alarm probability of the tests.
    pub alpha: f64,
    /// Time taken (s).
    pub seconds: f64,
    /// Time limit (s).
    pub limit_s: f64,
    /// Whether the time limit ended the diagnosis.
    pub ended_at_limit: bool,
}

impl Diagnosed {
    /// The robot whose model was diagnosed.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.dataset.robot
    }

    /// Label of a row.
    #[must_use]
    pub fn label(&self, row: usize) -> i64 {
        self.dataset.measurements.labels[row]
    }

    /// Name of a cable.
    #[must_use]
    pub fn cable(&self, index: Option<usize>) -> Option<String> {
        index.map(|index| self.robot().cables[index].name.clone())
    }

    /// Names of the cables that a cause acts on; empty for an effect of the robot, an instrument or all cables
    /// together.
    #[must_use]
    pub fn targets(&self, cause: &Cause) -> Vec<String> {
        let cables = cause.cables().into_iter();
        cables.filter_map(|index| self.cable(Some(index))).collect()
    }
}
