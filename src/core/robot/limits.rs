//! Workspace and tension limits of a robot, as stated in its description.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FrameTransform, Robot};

/// Limits of a robot. They are part of the description like its geometry.
///
/// Limits that are not stated follow from the rest of the description, see [`crate::simulation::Workspace::of`] and
/// [`crate::simulation::TensionRange::of`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Limits {
    /// Poses to which the platform may be commanded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub workspace: Option<WorkspaceLimits>,
    /// Admissible tensions of the cables.
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

/// Admissible tensions of the cables.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TensionLimits {
    /// Smallest tension (N).
    pub lower_n: f64,
    /// Reference tension (N), to which tension distributions stay as close as possible.
    pub reference_n: f64,
    /// Largest tension (N).
    pub upper_n: f64,
}

/// Tensions that statics alone determine lie within these multiples of the weight: cables at an angle of up to a few degrees to the
/// horizontal.
const LIGHTEST: f64 = 0.001;
const HEAVIEST: f64 = 10.0;

impl TensionLimits {
    /// Standard deviation of a tension of which only the limits are known (N): that of the uniform distribution
    /// between them.
    #[must_use]
    pub fn sd_n(&self) -> f64 {
        (self.upper_n - self.lower_n) / 12.0_f64.sqrt()
    }
}

impl Robot {
    /// Limits of tensions that no sensor reads: those that the description states, else such wide ones that the weight of the
    /// platform alone determines them. `None` without its mass or where statics leave the tensions undetermined, as they are not
    /// modelled then.
    #[must_use]
    pub fn unread_tension(&self) -> Option<TensionLimits> {
        let mass_kg = self.platform.mass_kg?;
        let stated = self.limits.and_then(|limits| limits.tension);
        stated.or_else(|| self.tension_of_weight(mass_kg))
    }

    /// Limits of the tensions of a platform that hangs in as many cables as it has free coordinates.
    fn tension_of_weight(&self, mass_kg: f64) -> Option<TensionLimits> {
        let free = &self.platform.free;
        let hangs = (0..3).any(|k| {
            self.gravity_m_s2[k] != 0.0 && free.iter().any(|coordinate| coordinate.index() == k)
        });
        let weight_n = mass_kg * self.gravity_m_s2.iter().map(|g| g * g).sum::<f64>().sqrt();
        (hangs && self.cable_count() == free.len()).then(|| TensionLimits {
            lower_n: LIGHTEST * weight_n,
            reference_n: weight_n / self.cable_count() as f64,
            upper_n: HEAVIEST * weight_n,
        })
    }

    /// Reason why it cannot be checked before a motion that tensions within their limits hold the platform, in one sentence;
    /// `None` if it can be checked.
    #[must_use]
    pub fn unchecked_tensions(&self) -> Option<&'static str> {
        if self.platform.mass_kg.is_none() {
            Some(
                "Nothing checks before a motion whether the cables can hold the platform: robot.json states no mass.",
            )
        } else if !self.has_tensions() {
            Some(
                "Nothing checks before a motion whether the cables can hold the platform: robot.json states no tension limits.",
            )
        } else if self.cable_count() < self.platform.freedom().count() {
            Some(
                "Nothing checks on the way between two poses whether the cables can hold the platform: it has fewer cables than \
                 free coordinates.",
            )
        } else {
            None
        }
    }

    /// Whether the tensions of the cables can be computed: the mass is given, and either all force sensors or tension limits are, or
    /// statics alone determine them.
    #[must_use]
    pub fn has_tensions(&self) -> bool {
        self.platform.mass_kg.is_some()
            && (self.has_force_sensors() || self.unread_tension().is_some())
    }

    /// Whether the weight of the platform decides where it comes to rest: it has fewer cables than free coordinates.
    #[must_use]
    pub fn hangs_freely(&self) -> bool {
        self.has_tensions() && self.cable_count() < self.platform.freedom().count()
    }
}
