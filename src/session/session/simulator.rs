//! The virtual robot behind a demonstration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::Robot;

/// A robot that exists only in the program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Simulator {
    /// The true robot, including hidden effects.
    pub truth: Robot,
    /// Seed of its noise.
    pub seed: u64,
    /// Whether the operator has been shown the truth.
    #[serde(default)]
    pub revealed: bool,
}
