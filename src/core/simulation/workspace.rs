//! Workspace and tension limits of a virtual robot.

use nalgebra::DVector;
use rand::{Rng, RngExt};

use crate::effect::inertia;
use crate::geometry::{Pose, Twist, Vec3};
use crate::kinematics::{
    KinematicsError, TensionDistribution, applied_wrench, distribute_tension, structure_matrix,
};
use crate::robot::{Robot, TensionLimits, WorkspaceLimits};

/// Largest strain of a cable that a derived upper tension causes: a quarter of the breaking strain of a steel rope, an
/// eighth of that of a rope of high-modulus polyethylene.
const WORKING_STRAIN: f64 = 4e-3;
/// Largest deviation of a tension from the mean of those at two samples of a path, in the middle of them, relative to its lower
/// limit: by as much it may leave its limit between the samples.
const BETWEEN_SAMPLES: f64 = 0.1;
/// Number of pieces of a path that are sampled at least, so that no two bends of the tensions look like a straight line.
const PIECES: u32 = 8;
/// Shortest piece of a path, relative to its length. If the tensions bend even in such a piece, the path is at the border of
/// feasibility.
const SHORTEST_PIECE: f64 = 1e-4;

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
    /// Smallest tension (N).
    pub lower_n: f64,
    /// Reference tension (N), to which the distribution stays as close as possible.
    pub reference_n: f64,
    /// Largest tension (N).
    pub upper_n: f64,
}

impl Workspace {
    /// Largest rotation about each axis where no limit is stated (rad).
    pub const USUAL_ROTATION_RAD: f64 = 0.1;

    /// The workspace that the description states, else one around the home pose (or the centroid of the pulleys): 30 % of
    /// the frame.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        if let Some(stated) = robot.limits.and_then(|limits| limits.workspace) {
            return stated.into();
        }
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
        // Suspended robots have all pulleys at one height, but need some height all the same.
        let least = 0.5 * half.max();
        Self {
            centre,
            half_extent_m: [0, 1, 2].map(|k| 0.3 * half[k].max(least)),
            half_rotation_rad: Self::USUAL_ROTATION_RAD,
        }
    }

    /// The box of a volume, at the orientation of this workspace's centre.
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

    /// The smallest workspace around the given poses; `None` without poses.
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

    /// Whether a pose is inside, to within 1e-9 m or rad.
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

/// The bounding box of the entry points (m).
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

impl From<WorkspaceLimits> for Workspace {
    fn from(stated: WorkspaceLimits) -> Self {
        Self {
            centre: stated.center.pose(),
            half_extent_m: stated.half_extent_m,
            half_rotation_rad: stated.half_rotation_rad,
        }
    }
}

impl From<TensionLimits> for TensionRange {
    fn from(stated: TensionLimits) -> Self {
        Self {
            lower_n: stated.lower_n,
            reference_n: stated.reference_n,
            upper_n: stated.upper_n,
        }
    }
}

impl TensionRange {
    /// The range that the description states, else that of [`Robot::unread_tension`] if no sensor reads the tensions, else one
    /// derived from the weight of the platform, the force sensors and the stiffness of the cables.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let stated = robot.limits.and_then(|limits| limits.tension);
        // Readings are held to narrower limits than those in which statics alone decide.
        let is_unread = !robot.has_force_sensors();
        if let Some(limits) = stated.or_else(|| robot.unread_tension().filter(|_| is_unread)) {
            return limits.into();
        }
        let weight_n = robot.platform.mass_kg.unwrap_or(0.0) * robot.gravity().norm();
        let sensors = robot.cables.iter().filter_map(|c| c.force_sensor);
        let noise_n = sensors.map(|s| s.tension_sd_n).fold(0.0, f64::max);
        let reference_n = (0.5 * weight_n).max(20.0 * noise_n);
        let stiffnesses = robot
            .cables
            .iter()
            .filter_map(|c| c.cable.axial_stiffness_n);
        let strained_n = WORKING_STRAIN * stiffnesses.fold(f64::INFINITY, f64::min);
        Self {
            lower_n: 0.1 * reference_n,
            reference_n,
            // A loaded platform needs room above the reference tension, however soft its cables are.
            upper_n: (10.0 * reference_n).min(strained_n.max(2.0 * reference_n)),
        }
    }

    /// The range without a fraction `part` at each end; the reference stays inside.
    #[must_use]
    pub fn inner(self, part: f64) -> Self {
        let margin_n = part * (self.upper_n - self.lower_n);
        Self {
            lower_n: (self.lower_n + margin_n).min(self.reference_n),
            upper_n: (self.upper_n - margin_n).max(self.reference_n),
            ..self
        }
    }

    /// Tensions that balance the platform at `pose`; `None` if there are none.
    ///
    /// # Errors
    /// If the pose is outside the domain of the kinematics.
    pub fn tensions(
        &self,
        robot: &Robot,
        pose: &Pose,
    ) -> Result<Option<Vec<f64>>, KinematicsError> {
        self.tensions_in_motion(robot, pose, &[Twist::zeros(); 2], &[])
    }

    /// Checks that tensions balance the platform everywhere on the straight path between two poses, turning about one axis. The
    /// path is sampled so densely that between samples no tension leaves its limit by more than a tenth of the lower limit: the
    /// tensions midway between two samples differ by no more from the mean of the samples, which is within the limits. The
    /// start is known to be balanced.
    ///
    /// # Errors
    /// A pose on the way where there are no such tensions.
    pub fn hold_between(&self, robot: &Robot, from: &Pose, to: &Pose) -> Result<(), Pose> {
        let way = to.difference(from);
        let held = |part: f64| {
            let pose = from.perturbed(&(way * part));
            let found = self
                .distribution(robot, &pose, &[Twist::zeros(); 2], &[])
                .ok();
            let held = found.filter(|found| part == 0.0 || found.balances());
            held.map(|held| (part, held.tensions_n)).ok_or(pose)
        };
        // Where the reference is far above the lower limit, that limit may be zero.
        let near_n = BETWEEN_SAMPLES * self.lower_n.max(BETWEEN_SAMPLES * self.reference_n);
        let mut last = held(0.0)?;
        let ends = (1..=PIECES).rev();
        let mut ends: Vec<_> = ends
            .map(|piece| held(f64::from(piece) / f64::from(PIECES)))
            .collect::<Result<_, _>>()?;
        while let Some(end) = ends.pop() {
            let middle = held((last.0 + end.0) / 2.0)?;
            let means = last.1.iter().zip(&end.1).map(|(a, b)| (a + b) / 2.0);
            let mut off_n = middle.1.iter().zip(means).map(|(n, mean)| (n - mean).abs());
            if off_n.all(|off_n| off_n <= near_n) {
                last = end;
            } else if end.0 - last.0 < SHORTEST_PIECE {
                return Err(from.perturbed(&(way * middle.0)));
            } else {
                ends.extend([end, middle]);
            }
        }
        Ok(())
    }

    /// Tensions that balance the platform at `pose` with a velocity and an acceleration (m, rad, s; base frame):
    /// `A^T T + w = [m a_c; c x m a_c + I alpha + w x I w]`; `None` if there are none. Slack cables pull with nothing.
    pub(super) fn tensions_in_motion(
        self,
        robot: &Robot,
        pose: &Pose,
        motion: &[Twist; 2],
        slack: &[usize],
    ) -> Result<Option<Vec<f64>>, KinematicsError> {
        let found = self.distribution(robot, pose, motion, slack)?;
        Ok(found.balances().then_some(found.tensions_n))
    }

    fn distribution(
        self,
        robot: &Robot,
        pose: &Pose,
        motion: &[Twist; 2],
        slack: &[usize],
    ) -> Result<TensionDistribution, KinematicsError> {
        let structure = structure_matrix(robot, pose)?;
        let mut wrench: DVector<f64> = applied_wrench(robot, pose)?;
        if motion.iter().any(|twist| *twist != Twist::zeros()) {
            wrench -= inertial_wrench(robot, pose, motion);
        }
        let all = |value: f64| -> Vec<f64> {
            let mut values = vec![value; robot.cable_count()];
            slack.iter().for_each(|cable| values[*cable] = 0.0);
            values
        };
        Ok(distribute_tension(
            &structure,
            &wrench,
            &all(self.reference_n),
            &all(self.lower_n),
            &all(self.upper_n),
        ))
    }
}

/// Wrench that accelerates the platform, in its free coordinates (N, N m).
fn inertial_wrench(robot: &Robot, pose: &Pose, motion: &[Twist; 2]) -> DVector<f64> {
    let inertia = inertia(robot, pose, motion);
    let [force, own] = [0, 3].map(|first| inertia.fixed_rows::<3>(first).into_owned());
    let force: Vec3 = force * robot.platform.mass_kg.unwrap_or(0.0);
    let lever = pose.orientation * Vec3::from(robot.platform.center_of_mass_m);
    let torque = own + lever.cross(&force);
    let wrench = [force.x, force.y, force.z, torque.x, torque.y, torque.z];
    let freedom = robot.platform.freedom();
    let free = freedom.coordinates().iter().map(|c| wrench[c.index()]);
    DVector::from_iterator(freedom.count(), free)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::robot::presets;

    #[test]
    fn limits_are_those_of_the_description_whatever_the_robot_is_called() {
        let mini = presets::find("mini").unwrap();
        let hall = presets::find("hall").unwrap();
        let renamed = Robot {
            name: "another".into(),
            ..mini.robot.clone()
        };
        assert_eq!(TensionRange::of(&renamed), mini.tension);
        assert_eq!(Workspace::of(&renamed), mini.workspace);
        let posing_as_mini = Robot {
            name: "mini".into(),
            ..hall.robot
        };
        assert_eq!(TensionRange::of(&posing_as_mini), hall.tension);
        assert_eq!(Workspace::of(&posing_as_mini), hall.workspace);
    }

    /// Densely sampled paths: on a feasible one no tension leaves its limit by more than a tenth of the lower limit, and on an
    /// infeasible one no tensions balance the platform somewhere. Near its pulleys a suspended robot can be held higher up than
    /// between them.
    #[test]
    fn a_way_holds_where_no_tension_leaves_its_limit() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut counts = [0; 2];
        for (name, width) in [
            ("suspended", 0.5),
            ("suspended", 0.3),
            ("suspended", 0.2),
            ("mini", 0.2),
            ("planar", 0.1),
        ] {
            let mut preset = presets::find(name).unwrap();
            if name == "suspended" {
                preset.workspace.centre.position.z = 5.0;
                preset.workspace.half_extent_m = [13.0, 8.0, 5.0];
            }
            let robot = &preset.robot;
            let lower_n = preset.tension.lower_n;
            let upper_n = lower_n + width * (preset.tension.upper_n - lower_n);
            let range = TensionRange {
                lower_n,
                upper_n,
                reference_n: (lower_n + upper_n) / 2.0,
            };
            let wider = TensionRange {
                lower_n: 0.9 * lower_n,
                upper_n: upper_n + 0.1 * lower_n,
                ..range
            };
            let holds = |range: &TensionRange, pose: &Pose| {
                range.tensions(robot, pose).unwrap_or_default().is_some()
            };
            let drawn = (0..3000).map(|_| preset.workspace.draw(robot, &mut rng));
            let mut ends: Vec<Pose> = drawn.filter(|pose| holds(&range, pose)).collect();
            ends.sort_by(|a, b| b.position.z.total_cmp(&a.position.z));
            for ends in ends[..40].windows(2) {
                let way = ends[1].difference(&ends[0]);
                let at = |k: u32| ends[0].perturbed(&(way * (f64::from(k) / 400.0)));
                let is_held = range.hold_between(robot, &ends[0], &ends[1]).is_ok();
                let dense = if is_held { &wider } else { &range };
                assert_eq!(
                    is_held,
                    (0..=400).all(|k| holds(dense, &at(k))),
                    "{name} {width}"
                );
                counts[usize::from(is_held)] += 1;
            }
        }
        assert!(counts.iter().all(|count| *count > 40), "{counts:?}");
    }

    #[test]
    fn noisy_sensors_do_not_raise_a_derived_limit_beyond_what_the_cables_bear() {
        let mut robot = presets::find("mini").unwrap().robot;
        robot.limits = None;
        for sd_n in [0.1, 1.0, 2.5, 3.9] {
            for cable in &mut robot.cables {
                cable.force_sensor.as_mut().unwrap().tension_sd_n = sd_n;
            }
            // 4e4 N of stiffness at a strain of 0.4 %.
            assert!(TensionRange::of(&robot).upper_n <= 160.0, "{sd_n} N");
        }
    }
}
