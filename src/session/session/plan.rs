//! Poses to be measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::geometry::Pose;

/// A pose of the plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlannedPose {
    /// Label of its measurement.
    pub label: i64,
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Platform orientation in the base frame, quaternion w first.
    pub orientation_wxyz: [f64; 4],
}

impl PlannedPose {
    /// A planned pose.
    #[must_use]
    pub fn new(label: i64, pose: &Pose) -> Self {
        Self {
            label,
            position_m: pose.position.into(),
            orientation_wxyz: pose.orientation_wxyz(),
        }
    }

    /// The pose to command.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose::from_parts(self.position_m, self.orientation_wxyz)
    }
}
