//! Inverse kinematics: what every cable does at a pose, and how its length depends on the geometry.
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

/// Closer than this to the swivel axis (m), the direction in which a pulley faces is undefined.
const AXIS_CLEARANCE_M: f64 = 1e-9;
/// Largest deviation of the norm of a swivel axis from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Why a cable has no path at a pose, or a robot no kinematics.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum KinematicsError {
    /// The anchor is nearer to the pulley centre than the radius.
    #[error("the platform anchor of {cable} is inside its pulley")]
    AnchorInsidePulley {
        /// Name of the cable.
        cable: String,
    },
    /// The pulley does not know where to face.
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
    /// A direction is not a unit vector.
    #[error("the swivel axis of {cable} is not a unit vector")]
    SwivelAxisNotUnit {
        /// Name of the cable.
        cable: String,
    },
    /// The zero direction of the swivel angle has no component across the axis.
    #[error("the swivel zero direction of {cable} is along its swivel axis")]
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
    /// Gravity cannot be applied.
    #[error("the mass of the platform is not given")]
    MassNotGiven,
    /// The number of cables is outside 1 to 64.
    #[error("a robot with {count} cables; 1 to 64 are possible")]
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

/// Refuses pulleys whose numbers cannot be used.
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
    // Written so that NaN, from a pose that is no pose, is refused too.
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

/// Checks that `cable` has a path when the platform is at `pose`.
///
/// # Errors
/// Why it has none.
pub fn check_path_at(cable: &Cable, pose: &Pose) -> Result<(), KinematicsError> {
    LocatedCable::new(cable, pose).map(|_| ())
}

/// Every cable of `robot` at `pose`, in the robot's order.
///
/// # Errors
/// The first cable that has no path at this pose, by name.
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
pub(super) fn swivel_angle(
    cable: &Cable,
    path: &CablePath<f64>,
) -> Result<Option<f64>, KinematicsError> {
    let Some(zero) = cable.pulley.swivel_zero else {
        return Ok(None);
    };
    let axis = Vec3::from(cable.pulley.swivel_axis);
    let zero = Vec3::from(zero);
    let across = zero - axis * axis.dot(&zero);
    // Written so that NaN is refused too.
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
/// The first cable that has no path at this pose, by name.
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
#[path = "inverse_tests.rs"]
mod tests;
