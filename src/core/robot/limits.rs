//! Where a robot may move and how hard its cables may pull, as its description states it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FrameTransform, Robot};

/// Limits of a robot. They belong to the description like its geometry: nothing follows from the robot's name.
///
/// What is not stated follows from the rest of the description, see [`crate::simulation::Workspace::of`] and
/// [`crate::simulation::TensionRange::of`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Limits {
    /// Where the platform may be commanded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub workspace: Option<WorkspaceLimits>,
    /// How hard cables may pull.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tension: Option<TensionLimits>,
}

/// A box of positions with a range of rotations about its centre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorkspaceLimits {
    /// Centre of the box in the base frame.
    pub center: FrameTransform,
    /// Half the extent along x, y, z (m).
    pub half_extent_m: [f64; 3],
    /// Largest rotation about each axis (rad).
    pub half_rotation_rad: f64,
}

/// Tensions that cables may have.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TensionLimits {
    /// Smallest (N).
    pub lower_n: f64,
    /// The distribution stays as close as possible to this (N).
    pub reference_n: f64,
    /// Largest (N).
    pub upper_n: f64,
}

impl TensionLimits {
    /// Standard deviation of a tension of which no more is known than the limits (N): that of the uniform distribution
    /// between them.
    #[must_use]
    pub fn sd_n(&self) -> f64 {
        (self.upper_n - self.lower_n) / 12.0_f64.sqrt()
    }
}

impl Robot {
    /// Within which limits tensions are taken to be where no force is read. `None` unless the description states them and
    /// the platform's mass: tensions are not modelled then.
    #[must_use]
    pub fn unread_tension(&self) -> Option<TensionLimits> {
        self.platform.mass_kg?;
        self.limits?.tension
    }

    /// Whether cables of a simulated robot pull.
    #[must_use]
    pub fn has_tensions(&self) -> bool {
        self.platform.mass_kg.is_some()
            && (self.has_force_sensors() || self.unread_tension().is_some())
    }
}
