//! What a recipe says of an external instrument.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::geometry::Pose;

/// What is known of an external instrument; what is absent is found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Instrument {
    /// Where its frame is in the robot's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<Placement>,
    /// Where the body that it follows is on the platform.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<Placement>,
    /// Where the markers are on that body (m), from the first; null for one that is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers_m: Option<Vec<Option<[f64; 3]>>>,
}

/// Place and orientation of a frame in another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Placement {
    /// Its origin (m).
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
