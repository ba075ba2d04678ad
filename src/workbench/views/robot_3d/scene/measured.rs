//! Measured poses, which do not change while the platform moves.

use std::ops::Deref;

use tautline_core::geometry::Vec3;

use super::bounds;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPose {
    pub label: i64,
    /// Position of the platform, fitted if possible (m).
    pub position: Vec3,
    /// Largest residual of its lengths, or that of the selected cable; `None` if it was not fitted.
    pub residual: Option<f64>,
}

/// All measured poses, shared by the scenes that have the same ones.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPoses {
    poses: Vec<MeasuredPose>,
    /// Smallest and largest coordinates (m); infinite and reversed if there are none.
    pub(super) bounds: [Vec3; 2],
}

impl MeasuredPoses {
    /// Measured poses with their bounds.
    #[must_use]
    pub fn new(poses: Vec<MeasuredPose>) -> Self {
        let bounds = bounds(poses.iter().map(|pose| &pose.position));
        Self { poses, bounds }
    }

    /// Pose of a label, whose index is at most `place`: less if poses before it have no known position.
    #[must_use]
    pub fn of(&self, place: usize, label: i64) -> Option<&MeasuredPose> {
        let is_it = |pose: &&MeasuredPose| pose.label == label;
        let end = self.poses.len().min(place + 1);
        let usual = self.poses.get(place).filter(is_it);
        usual.or_else(|| self.poses[..end].iter().rev().find(is_it))
    }
}

impl Default for MeasuredPoses {
    fn default() -> Self {
        Self::new(Vec::new())
    }
}

impl Deref for MeasuredPoses {
    type Target = [MeasuredPose];

    fn deref(&self) -> &[MeasuredPose] {
        &self.poses
    }
}
