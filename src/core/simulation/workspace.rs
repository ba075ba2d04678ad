//! Where a virtual robot moves and how its cables are tensioned.

use nalgebra::DVector;
use rand::{Rng, RngExt};

use crate::geometry::{Pose, Vec3};
use crate::kinematics::{
    Feasibility, KinematicsError, applied_wrench, distribute_tension, structure_matrix,
};
use crate::robot::Robot;

/// A box of positions with a range of rotations about its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workspace {
    /// Centre pose.
    pub centre: Pose,
    /// Half the extent along x, y, z (m).
    pub half_extent_m: [f64; 3],
    /// Largest rotation about each axis (rad).
    pub half_rotation_rad: f64,
}

/// Limits within which tensions are distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TensionRange {
    /// Smallest (N).
    pub lower_n: f64,
    /// The distribution stays as close as possible to this (N).
    pub reference_n: f64,
    /// Largest (N).
    pub upper_n: f64,
}

impl Workspace {
    /// A workspace around the home pose (or the middle of the pulleys): 30 % of the frame.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let (low, high) = bounds(robot);
        let middle = (low + high) / 2.0;
        let centre = robot.home.map_or(
            Pose {
                position: middle,
                ..Pose::identity()
            },
            |home| home.pose(),
        );
        let half = (high - low) / 2.0;
        // Suspended robots have all pulleys at one height: allow some height all the same.
        let least = 0.5 * half.max();
        Self {
            centre,
            half_extent_m: [0, 1, 2].map(|k| 0.3 * half[k].max(least)),
            half_rotation_rad: 0.1,
        }
    }

    /// The positions of a box at the orientation of this workspace's centre.
    pub(crate) fn of_volume(&self, centre_m: [f64; 3], half_extent_m: [f64; 3]) -> Self {
        Self {
            centre: Pose {
                position: centre_m.into(),
                ..self.centre
            },
            half_extent_m,
            half_rotation_rad: 0.0,
        }
    }

    /// The smallest workspace around given poses; `None` without any.
    pub(crate) fn around<'p>(poses: impl Iterator<Item = &'p Pose>) -> Option<Self> {
        let poses: Vec<&Pose> = poses.collect();
        let centre = *poses.first()?;
        let infinite = Vec3::repeat(f64::INFINITY);
        let (mut low, mut high, mut turn) = (infinite, -infinite, 0.0_f64);
        for pose in &poses {
            low = low.inf(&pose.position);
            high = high.sup(&pose.position);
            let rotation = centre.difference(pose);
            turn = turn.max(rotation.fixed_rows::<3>(3).amax());
        }
        Some(Self {
            centre: Pose {
                position: (low + high) / 2.0,
                orientation: centre.orientation,
            },
            half_extent_m: ((high - low) / 2.0).into(),
            half_rotation_rad: turn,
        })
    }

    /// Whether a pose is inside, up to a nanometre and a nanoradian.
    #[must_use]
    pub fn contains(&self, pose: &Pose) -> bool {
        let off = pose.difference(&self.centre);
        (0..6).all(|k| off[k].abs() <= self.half_range(k) + 1e-9)
    }

    /// A random pose in the coordinates in which the platform is free.
    pub fn draw(&self, robot: &Robot, rng: &mut impl Rng) -> Pose {
        let freedom = robot.platform.freedom();
        let twist = freedom.twist(|k| self.half_range(k) * rng.random_range(-1.0..=1.0));
        self.centre.perturbed(&twist)
    }

    /// Half the extent along coordinate `k` of a [`Twist`](crate::geometry::Twist) (m, rad).
    pub(crate) fn half_range(&self, k: usize) -> f64 {
        self.half_extent_m
            .get(k)
            .copied()
            .unwrap_or(self.half_rotation_rad)
    }
}

/// The smallest box around the entry points (m).
pub(crate) fn bounds(robot: &Robot) -> (Vec3, Vec3) {
    let points = robot
        .cables
        .iter()
        .map(|c| Vec3::from(c.pulley.entry_point_m));
    let infinite = Vec3::repeat(f64::INFINITY);
    points.fold((infinite, -infinite), |(low, high), p| {
        (low.inf(&p), high.sup(&p))
    })
}

impl TensionRange {
    /// A range that suits the weight of the platform and the force sensors.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let weight_n = robot.platform.mass_kg.unwrap_or(0.0) * robot.gravity().norm();
        let sensors = robot.cables.iter().filter_map(|c| c.force_sensor);
        let noise_n = sensors.map(|s| s.tension_sd_n).fold(0.0, f64::max);
        let reference_n = (0.5 * weight_n).max(20.0 * noise_n);
        Self {
            lower_n: 0.1 * reference_n,
            reference_n,
            upper_n: 10.0 * reference_n,
        }
    }

    /// The range without a part of it at each end; the reference stays inside.
    #[must_use]
    pub fn inner(self, part: f64) -> Self {
        let margin_n = part * (self.upper_n - self.lower_n);
        Self {
            lower_n: (self.lower_n + margin_n).min(self.reference_n),
            upper_n: (self.upper_n - margin_n).max(self.reference_n),
            ..self
        }
    }

    /// Tensions that balance the platform at `pose`, if there are any.
    ///
    /// # Errors
    /// If the pose is outside the domain of the kinematics.
    pub fn tensions(
        &self,
        robot: &Robot,
        pose: &Pose,
    ) -> Result<Option<Vec<f64>>, KinematicsError> {
        let structure = structure_matrix(robot, pose)?;
        let wrench: DVector<f64> = applied_wrench(robot, pose)?;
        let all = |value: f64| vec![value; robot.cable_count()];
        let found = distribute_tension(
            &structure,
            &wrench,
            &all(self.reference_n),
            &all(self.lower_n),
            &all(self.upper_n),
        );
        Ok((found.feasibility == Feasibility::Feasible).then_some(found.tensions_n))
    }
}
