//! Placement of an external instrument.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::geometry::Pose;

/// Known placement of an external instrument; absent fields are estimated.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Instrument {
    /// Pose of the instrument's frame in the robot's frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<Placement>,
    /// Pose of the tracked body in the platform's frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<Placement>,
    /// Positions of the markers on that body (m), in order; null if unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers_m: Option<Vec<Option<[f64; 3]>>>,
}

/// Pose of a frame in another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Placement {
    /// Position of its origin (m).
    pub position_m: [f64; 3],
    /// Rotation from it to the other frame, quaternion with w first.
    pub orientation_wxyz: [f64; 4],
}

impl From<Pose> for Placement {
    fn from(pose: Pose) -> Self {
        Self {
            position_m: pose.position.into(),
            orientation_wxyz: pose.orientation_wxyz(),
        }
    }
}

impl From<Placement> for Pose {
    fn from(placement: Placement) -> Self {
        Self::from_parts(placement.position_m, placement.orientation_wxyz)
    }
}
