//! Inverse kinematics: length and path of every cable at a pose, and derivatives of the length.
//!
//! Platform at position `r` with rotation `R`, anchor `b` in the platform frame: `B = r + R b`. The
//! path from the entry point `a` over the pulley to `B` is that of [`PulleyGeometry`]; with `u` the
//! unit vector from `B` to the exit point and a twist `[d; phi]` in base coordinates
//!
//! - `dl/d[d; phi] = -[u; (R b) x u]`, `dl/da = u`, `dl/db = -R^T u`,
//! - `dl/drp = theta - sin(theta)`, and for a rotation of the swivel axis about `a`: `(B - a) x u`.
//!
//! Lengths in metres, angles in radians, base frame unless said otherwise.
//! Source: Jin et al. 2018, equations 3 and 4; derivatives as in [`PulleyGeometry`]'s file.

use crate::geometry::{Pose, Twist, Vec3};
use crate::robot::{Cable, Robot};

use super::{CablePath, PulleyGeometry};

/// Closer than this to the swivel axis (m), the facing direction of a pulley is undefined.
const AXIS_CLEARANCE_M: f64 = 1e-9;
/// Largest deviation of the norm of a swivel axis from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Reasons why the kinematics of a robot has no solution at a pose.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum KinematicsError {
    /// The anchor is nearer to the pulley centre than the radius.
    #[error("the platform anchor of {cable} is inside its pulley")]
    AnchorInsidePulley {
        /// Name of the cable.
        cable: String,
    },
    /// The facing direction of the pulley is undefined.
    #[error("the platform anchor of {cable} is on the swivel axis of its pulley")]
    AnchorOnSwivelAxis {
        /// Name of the cable.
        cable: String,
    },
    /// The cable has no direction.
    #[error("the platform anchor of {cable} is at its entry point")]
    AnchorAtEntryPoint {
        /// Name of the cable.
        cable: String,
    },
    /// The anchor is behind the pulley.
    #[error("{cable} would wrap more than half a turn around its pulley")]
    WrapBeyondHalfTurn {
        /// Name of the cable.
        cable: String,
    },
    /// The swivel axis is not a unit vector.
    #[error("the swivel axis of {cable} is not a unit vector")]
    SwivelAxisNotUnit {
        /// Name of the cable.
        cable: String,
    },
    /// The zero direction of the swivel angle has no component normal to the axis.
    #[error("the swivel zero direction of {cable} is parallel to its swivel axis")]
    SwivelZeroAlongAxis {
        /// Name of the cable.
        cable: String,
    },
    /// A coordinate is not a finite number.
    #[error("a coordinate of {cable} is not a finite number")]
    NotFinite {
        /// Name of the cable.
        cable: String,
    },
    /// The mass of the platform is unknown.
    #[error("the mass of the platform is not given")]
    MassNotGiven,
    /// The number of cables is outside 1 to 64.
    #[error("found {count} cables, expected 1 to 64")]
    CableCount {
        /// Number of cables.
        count: usize,
    },
}

/// One cable at one pose.
#[derive(Debug, Clone, PartialEq)]
pub struct CableState {
    /// Length `l` from entry point to platform anchor (m).
    pub length_m: f64,
    /// Straight part `l_f` (m).
    pub free_length_m: f64,
    /// Wrap angle `theta` on the pulley (rad); 0 to pi.
    pub wrap_rad: f64,
    /// Swivel angle of the pulley (rad), right-handed about the swivel axis from the zero
    /// direction, in `(-pi, pi]`; `None` without a zero direction, or for an eyelet whose cable
    /// runs along the axis.
    pub swivel_rad: Option<f64>,
    /// Exit point `c` in the base frame (m).
    pub exit_point: Vec3,
    /// Platform anchor `B` in the base frame (m).
    pub anchor_in_base: Vec3,
    /// Unit vector `u` from the anchor to the exit point: the direction in which the cable pulls.
    pub toward_exit: Vec3,
}

/// Derivatives of one cable's length.
#[derive(Debug, Clone, PartialEq)]
pub struct LengthGradient {
    /// With respect to the twist of the platform (m/m, m/rad); see [`Self::pose_free`].
    pub pose: Twist,
    /// With respect to the entry point (m/m).
    pub entry_point: Vec3,
    /// With respect to the pulley radius (m/m).
    pub radius: f64,
    /// With respect to a rotation vector of the swivel axis about the entry point (m/rad).
    pub axis_rotation: Vec3,
    /// With respect to the anchor in the platform frame (m/m).
    pub platform_anchor: Vec3,
}

impl LengthGradient {
    /// The derivatives with respect to the robot's free coordinates, in their order.
    #[must_use]
    pub fn pose_free(&self, robot: &Robot) -> Vec<f64> {
        let freedom = robot.platform.freedom();
        let free = freedom.coordinates().iter();
        free.map(|c| self.pose[c.index()]).collect()
    }
}

/// A cable's path at a pose with the vectors that statics and derivatives need.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocatedCable {
    pub(super) pulley: PulleyGeometry<f64>,
    /// `R b` (m).
    pub(super) arm: Vec3,
    /// `B` (m).
    pub(super) anchor: Vec3,
    pub(super) path: CablePath<f64>,
}

impl LocatedCable {
    /// Unit vector `u` from the anchor to the exit point.
    pub(super) fn toward_exit(&self) -> Vec3 {
        self.path.toward_exit.into()
    }

    /// The path of `cable` at `pose`, if there is one.
    pub(super) fn new(cable: &Cable, pose: &Pose) -> Result<Self, KinematicsError> {
        check_pulley(cable)?;
        let arm = pose.orientation * Vec3::from(cable.platform_anchor_m);
        let anchor = pose.position + arm;
        let pulley = pulley_geometry(cable);
        let path = pulley.path_to(anchor.into());
        check_path(cable, &path)?;
        Ok(Self {
            pulley,
            arm,
            anchor,
            path,
        })
    }
}

/// The pulley of a cable at its nominal place.
pub(super) fn pulley_geometry(cable: &Cable) -> PulleyGeometry<f64> {
    PulleyGeometry {
        entry: cable.pulley.entry_point_m,
        axis: cable.pulley.swivel_axis,
        radius: cable.pulley.radius_m,
    }
}

/// Rejects pulleys with invalid geometry.
pub(super) fn check_pulley(cable: &Cable) -> Result<(), KinematicsError> {
    let pulley = &cable.pulley;
    let numbers = pulley.entry_point_m.iter().chain(&pulley.swivel_axis);
    let mut numbers = numbers.chain(&cable.platform_anchor_m);
    if !(numbers.all(|v| v.is_finite()) && pulley.radius_m.is_finite()) {
        let cable = cable.name.clone();
        return Err(KinematicsError::NotFinite { cable });
    }
    if (Vec3::from(pulley.swivel_axis).norm() - 1.0).abs() > UNIT_TOLERANCE {
        let cable = cable.name.clone();
        return Err(KinematicsError::SwivelAxisNotUnit { cable });
    }
    Ok(())
}

fn check_path(cable: &Cable, path: &CablePath<f64>) -> Result<(), KinematicsError> {
    let name = || cable.name.clone();
    let has_pulley = cable.pulley.radius_m > 0.0;
    // The comparison is false for NaN, so that an invalid pose is rejected too.
    let clear = path.clearance > AXIS_CLEARANCE_M * AXIS_CLEARANCE_M;
    if !clear && has_pulley {
        return Err(KinematicsError::AnchorInsidePulley { cable: name() });
    }
    if !clear {
        return Err(KinematicsError::AnchorAtEntryPoint { cable: name() });
    }
    if has_pulley && path.inverse_axis_distance > 1.0 / AXIS_CLEARANCE_M {
        return Err(KinematicsError::AnchorOnSwivelAxis { cable: name() });
    }
    if path.wrap < 0.0 {
        return Err(KinematicsError::WrapBeyondHalfTurn { cable: name() });
    }
    Ok(())
}

/// Checks that `cable` has a path with the platform at `pose`.
///
/// # Errors
/// The reason why it has none.
pub fn check_path_at(cable: &Cable, pose: &Pose) -> Result<(), KinematicsError> {
    LocatedCable::new(cable, pose).map(|_| ())
}

/// Every cable of `robot` at `pose`, in the robot's order.
///
/// # Errors
/// Names the first cable that has no path at this pose.
pub fn inverse_kinematics(robot: &Robot, pose: &Pose) -> Result<Vec<CableState>, KinematicsError> {
    let cables = robot.cables.iter();
    cables.map(|cable| cable_state(cable, pose)).collect()
}

fn cable_state(cable: &Cable, pose: &Pose) -> Result<CableState, KinematicsError> {
    let located = LocatedCable::new(cable, pose)?;
    let path = &located.path;
    Ok(CableState {
        length_m: path.length,
        free_length_m: path.free_length,
        wrap_rad: path.wrap,
        swivel_rad: swivel_angle(cable, path)?,
        exit_point: located.pulley.exit_point(path).into(),
        anchor_in_base: located.anchor,
        toward_exit: located.toward_exit(),
    })
}

/// Swivel angle of a cable's pulley (rad), where it is defined.
pub(crate) fn swivel_angle(
    cable: &Cable,
    path: &CablePath<f64>,
) -> Result<Option<f64>, KinematicsError> {
    let Some(zero) = cable.pulley.swivel_zero else {
        return Ok(None);
    };
    let axis = Vec3::from(cable.pulley.swivel_axis);
    let zero = Vec3::from(zero);
    let across = zero - axis * axis.dot(&zero);
    // The comparison is false for NaN, which is rejected too.
    if across.norm() > 1e-9 {
        let facing = Vec3::from(path.facing);
        let angle = axis.cross(&across).dot(&facing).atan2(across.dot(&facing));
        let defined = path.inverse_axis_distance < 1.0 / AXIS_CLEARANCE_M;
        return Ok(defined.then_some(angle));
    }
    let cable = cable.name.clone();
    Err(KinematicsError::SwivelZeroAlongAxis { cable })
}

/// Derivatives of every cable's length at `pose`, in the robot's order.
///
/// # Errors
/// Names the first cable that has no path at this pose.
pub fn length_gradients(
    robot: &Robot,
    pose: &Pose,
) -> Result<Vec<LengthGradient>, KinematicsError> {
    let cables = robot.cables.iter();
    cables.map(|cable| length_gradient(cable, pose)).collect()
}

fn length_gradient(cable: &Cable, pose: &Pose) -> Result<LengthGradient, KinematicsError> {
    let located = LocatedCable::new(cable, pose)?;
    let u = located.toward_exit();
    let torque = located.arm.cross(&u);
    let offset = located.anchor - Vec3::from(located.pulley.entry);
    Ok(LengthGradient {
        pose: Twist::new(-u.x, -u.y, -u.z, -torque.x, -torque.y, -torque.z),
        entry_point: u,
        radius: located.path.wrap - located.path.sin_wrap,
        axis_rotation: offset.cross(&u),
        platform_anchor: -(pose.orientation.inverse() * u),
    })
}

#[cfg(test)]
mod tests {
    use super::super::samples::{self, PlatformKind};
    use super::*;
    use crate::geometry::Coordinate;
    use rand::RngExt;

    fn length(robot: &Robot, pose: &Pose, cable: usize) -> f64 {
        inverse_kinematics(robot, pose).unwrap()[cable].length_m
    }

    /// Central difference of a cable's length when `change` is applied with +h and -h.
    fn slope(
        robot: &Robot,
        pose: &Pose,
        i: usize,
        change: impl Fn(&mut Robot, &mut Pose, f64),
    ) -> f64 {
        let h = 1e-6;
        let at = |s: f64| {
            let (mut robot, mut pose) = (robot.clone(), *pose);
            change(&mut robot, &mut pose, s);
            length(&robot, &pose, i)
        };
        (at(h) - at(-h)) / (2.0 * h)
    }

    fn check_gradients(robot: &Robot, pose: &Pose) {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 5e-9, "{a} {b}");
        for (i, gradient) in length_gradients(robot, pose).unwrap().iter().enumerate() {
            for k in 0..6 {
                let twist = |s: f64| Twist::from_fn(|q, _| if q == k { s } else { 0.0 });
                let numeric = slope(robot, pose, i, |_, p, s| *p = p.perturbed(&twist(s)));
                near(gradient.pose[k], numeric);
            }
            for k in 0..3 {
                let numeric = slope(robot, pose, i, |r, _, s| {
                    r.cables[i].pulley.entry_point_m[k] += s;
                });
                near(gradient.entry_point[k], numeric);
                let numeric = slope(robot, pose, i, |r, _, s| {
                    r.cables[i].platform_anchor_m[k] += s;
                });
                near(gradient.platform_anchor[k], numeric);
                let numeric = slope(robot, pose, i, |r, _, s| {
                    let axis = &mut r.cables[i].pulley.swivel_axis;
                    let turn = nalgebra::Rotation3::new(Vec3::ith(k, s));
                    *axis = (turn * Vec3::from(*axis)).into();
                });
                near(gradient.axis_rotation[k], numeric);
            }
            if robot.cables[i].pulley.radius_m > 0.0 {
                let numeric = slope(robot, pose, i, |r, _, s| r.cables[i].pulley.radius_m += s);
                near(gradient.radius, numeric);
            }
            let free = robot.platform.freedom();
            assert_eq!(gradient.pose_free(robot).len(), free.count());
        }
    }

    #[test]
    fn gradients_match_finite_differences() {
        use Coordinate::{Rz, X, Y, Z};
        let mut rng = samples::generator(11);
        for count in 1..=12 {
            for free in [&Coordinate::ALL[..], &[X, Y, Rz], &[X, Y, Z], &[X, Y]] {
                let (robot, pose) = samples::anywhere(&mut rng, free, count);
                check_gradients(&robot, &pose);
            }
        }
        for kind in [
            PlatformKind::Spatial,
            PlatformKind::Planar,
            PlatformKind::PointMass,
        ] {
            for radius in [0.0, 0.02] {
                let robot = samples::of_kind(kind, radius);
                let twist = Twist::from_fn(|_, _| rng.random_range(-0.1..0.1));
                check_gradients(&robot, &Pose::identity().perturbed(&twist));
            }
        }
    }

    #[test]
    fn eyelet_length_is_the_distance() {
        let mut rng = samples::generator(12);
        for _ in 0..50 {
            let (mut robot, pose) = samples::anywhere(&mut rng, &Coordinate::ALL, 4);
            for cable in &mut robot.cables {
                cable.pulley.radius_m = 0.0;
            }
            for (cable, state) in robot
                .cables
                .iter()
                .zip(inverse_kinematics(&robot, &pose).unwrap())
            {
                let anchor = pose.transform(&Vec3::from(cable.platform_anchor_m));
                let distance = (anchor - Vec3::from(cable.pulley.entry_point_m)).norm();
                assert!((state.length_m - distance).abs() < 1e-14);
                assert!((state.free_length_m - distance).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn swivel_angle_is_right_handed_about_the_axis() {
        let mut robot = samples::spatial(0.02);
        robot.cables.truncate(1);
        let pulley = &mut robot.cables[0].pulley;
        pulley.entry_point_m = [0.0; 3];
        pulley.swivel_zero = Some([2.0, 0.0, 0.5]);
        for (axis, sign) in [([0.0, 0.0, 1.0], 1.0), ([0.0, 0.0, -1.0], -1.0)] {
            robot.cables[0].pulley.swivel_axis = axis;
            for angle in [-3.0_f64, -1.0, 0.2, 2.5] {
                let target = Vec3::new(angle.cos(), angle.sin(), 0.3);
                let mut pose = Pose::identity();
                pose.position = target - Vec3::from(robot.cables[0].platform_anchor_m);
                let state = &inverse_kinematics(&robot, &pose).unwrap()[0];
                assert!((state.swivel_rad.unwrap() - sign * angle).abs() < 1e-12);
            }
        }
        robot.cables[0].pulley.swivel_zero = Some([0.0, 0.0, 1.0]);
        let error = inverse_kinematics(&robot, &Pose::from_parts([1.0; 3], [1.0, 0.0, 0.0, 0.0]));
        let cable = robot.cables[0].name.clone();
        assert_eq!(error, Err(KinematicsError::SwivelZeroAlongAxis { cable }));
    }

    /// Inverse kinematics of one cable with entry point 0 and axis +z.
    fn verdict(radius: f64, anchor: [f64; 3]) -> Result<Vec<CableState>, KinematicsError> {
        let cable = samples::cable("winch 3", Vec3::zeros(), Vec3::z(), radius, Vec3::zeros());
        let robot = samples::robot(&Coordinate::ALL, vec![cable]);
        inverse_kinematics(&robot, &Pose::from_parts(anchor, [1.0, 0.0, 0.0, 0.0]))
    }

    #[test]
    fn impossible_poses_are_named() {
        let text = |r: Result<Vec<CableState>, KinematicsError>| r.unwrap_err().to_string();
        assert_eq!(
            text(verdict(0.1, [0.12, 0.01, 0.02])),
            "the platform anchor of winch 3 is inside its pulley"
        );
        assert_eq!(
            text(verdict(0.1, [0.0, 0.0, 1.0])),
            "the platform anchor of winch 3 is on the swivel axis of its pulley"
        );
        assert_eq!(
            text(verdict(0.0, [0.0; 3])),
            "the platform anchor of winch 3 is at its entry point"
        );
        assert_eq!(
            text(verdict(0.1, [0.05, 0.0, -1.0])),
            "winch 3 would wrap more than half a turn around its pulley"
        );
        assert!(verdict(0.1, [f64::NAN, 0.0, 1.0]).is_err());
        let on_axis = verdict(0.0, [0.0, 0.0, -1.5]).unwrap();
        assert!((on_axis[0].length_m - 1.5).abs() < 1e-15);
        assert!((on_axis[0].toward_exit - Vec3::z()).norm() < 1e-15);
    }
}
