//! The virtual robot behind a demonstration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::Robot;

/// A robot that exists in the program only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Simulator {
    /// What it is really like, hidden effects included.
    pub truth: Robot,
    /// Seed of its noise.
    pub seed: u64,
    /// Whether the operator has been shown the truth.
    #[serde(default)]
    pub revealed: bool,
}
