//! The joint of a platform: in which coordinates it moves, where it starts and how far it may go.

use tautline_core::geometry::{Coordinate, Pose};
use tautline_core::robot::{FrameTransform, Robot, WorkspaceLimits};
use tautline_core::simulation::Workspace;
use tautline_files::{ReadError, quoted};

use super::super::description::{list, pose_of};
use super::Element;

use Coordinate::{Rx, Ry, Rz, X, Y, Z};

/// Parametrisation of the orientation by the variables of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rotation {
    /// One angle for each rotation: `R = Rx Ry Rz`.
    Angles,
    /// Angles about the axes of the base: `R = Rz Ry Rx`.
    FixedAngles,
    /// Four components of a quaternion, w first.
    Quaternion,
}

/// A joint between the base and the platform.
pub(super) struct Joint {
    /// Coordinates of the motion in the order of the variables `q`.
    coordinates: Vec<Coordinate>,
    rotation: Rotation,
    /// Position of the joint on the base (m).
    origin_m: [f64; 3],
    initial: Option<Vec<f64>>,
    /// Smallest and largest `q`.
    range: Option<[Vec<f64>; 2]>,
}

impl Joint {
    /// Reads `<joint>`; `origin_m` is the position of the joint on the base.
    pub fn of(file: &str, element: &Element, origin_m: [f64; 3]) -> Result<Self, ReadError> {
        if element.attribute("actuated") == Some("true") {
            let message =
                "found an actuated joint, expected a platform that is moved by its cables only";
            return Err(element.error(file, message));
        }
        let kind = element.attribute("type").unwrap_or_default();
        let axis = element.list(file, "axis", 3)?;
        let (coordinates, rotation) = motion(kind, axis).ok_or_else(|| {
            let message = format!(
                "found the type {}, expected SPATIAL, PLANAR, T_XYZ, a translation P_ or a rotation R_ or S_ along or about axes of the base",
                quoted(kind)
            );
            element.error(file, &message)
        })?;
        let count = match rotation {
            Rotation::Quaternion => coordinates.len() + 1,
            _ => coordinates.len(),
        };
        let initial = element.list(file, "q_initial", count)?;
        let low = element.list(file, "q_min", count)?;
        let high = element.list(file, "q_max", count)?;
        if let (Some(low), Some(high)) = (&low, &high)
            && let Some(k) = (0..count).find(|k| low[*k] > high[*k])
        {
            let message = format!(
                "found q_min={} above q_max={} in place {}, expected a range",
                low[k],
                high[k],
                k + 1
            );
            return Err(element.error(file, &message));
        }
        Ok(Self {
            coordinates,
            rotation,
            origin_m,
            initial,
            range: low.zip(high).map(|(low, high)| [low, high]),
        })
    }

    /// The coordinates in which the platform can move.
    pub fn free(&self) -> Vec<Coordinate> {
        self.coordinates.clone()
    }

    /// The pose at `q_initial`, if it is stated.
    pub fn home(&self) -> Option<FrameTransform> {
        Some(self.pose(self.initial.as_ref()?))
    }

    /// The poses between `q_min` and `q_max`, if these are stated. About an axis without a limit the platform turns as little as
    /// without stated limits.
    pub fn workspace(&self) -> Option<WorkspaceLimits> {
        let [low, high] = self.range.as_ref()?;
        let mut middle: Vec<f64> = low.iter().zip(high).map(|(a, b)| (a + b) / 2.0).collect();
        let mut half_extent_m = [0.0; 3];
        let mut half_rotation_rad = f64::INFINITY;
        for (k, coordinate) in self.coordinates.iter().enumerate() {
            let half = (high[k] - low[k]) / 2.0;
            if let Some(extent) = half_extent_m.get_mut(coordinate.index()) {
                *extent = half;
            } else if self.rotation != Rotation::Quaternion && half < NO_LIMIT_RAD {
                half_rotation_rad = half_rotation_rad.min(half);
            } else {
                half_rotation_rad = half_rotation_rad.min(Workspace::USUAL_ROTATION_RAD);
                middle[k] = self.initial.as_ref().map_or(0.0, |initial| initial[k]);
            }
        }
        if self.rotation == Rotation::Quaternion {
            let at = self.coordinates.len() - 3;
            let level = vec![1.0, 0.0, 0.0, 0.0];
            let initial = self.initial.as_ref();
            middle.truncate(at);
            middle.extend(initial.map_or(level, |initial| initial[at..].to_vec()));
        }
        if !half_rotation_rad.is_finite() {
            half_rotation_rad = 0.0;
        }
        Some(WorkspaceLimits {
            center: self.pose(&middle),
            half_extent_m,
            half_rotation_rad,
        })
    }

    /// The pose of the platform for the variables of the joint.
    fn pose(&self, q: &[f64]) -> FrameTransform {
        let mut position_m = self.origin_m;
        let mut angles = [0.0; 3];
        for (coordinate, value) in self.coordinates.iter().zip(q) {
            match coordinate.index() {
                axis @ 0..3 => position_m[axis] += value,
                about => angles[about - 3] = *value,
            }
        }
        let pose = match self.rotation {
            Rotation::Angles => Pose::from_angles(position_m, angles),
            Rotation::FixedAngles => pose_of(position_m, angles),
            Rotation::Quaternion => {
                let [.., w, x, y, z] = q else {
                    return FrameTransform {
                        position_m,
                        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
                    };
                };
                Pose::from_parts(position_m, [*w, *x, *y, *z])
            }
        };
        FrameTransform {
            position_m,
            orientation_wxyz: pose.orientation_wxyz(),
        }
    }
}

/// Types of joints in new files. A platform whose coordinates none of them has becomes a free one.
const WRITTEN: &str =
    "SPATIAL_EULER_XYZ PLANAR_XY PLANAR_XZ PLANAR_YZ T_XYZ P_XY P_XZ P_X R_X R_Y R_Z S_EULER_XYZ";

/// A new file of the bodies with the joint of a robot, whose variables at home are coordinates of the home, and the space to be drawn.
pub(super) fn with_joint(text: &str, robot: &Robot) -> String {
    let free = robot.platform.freedom();
    let is_it = |kind: &&str| motion(kind, None).is_some_and(|(all, _)| all == free.coordinates());
    let kind = WRITTEN
        .split(' ')
        .find(is_it)
        .unwrap_or("SPATIAL_EULER_XYZ");
    let free = motion(kind, None).map_or_else(Vec::new, |(all, _)| all);
    let home = robot.home.map_or(Pose::identity(), |home| home.pose());
    // `R = Rx Ry Rz` is the inverse of a rotation about fixed axes by the opposite angles.
    let (roll, pitch, yaw) = home.orientation.inverse().euler_angles();
    let [x, y, z] = home.position.into();
    let size_m = robot.frame_size_m().unwrap_or_default().max(1.0);
    let range = [x, y, z].map(|at| [at - size_m, at + size_m]);
    let all = [x, y, z, -roll, -pitch, -yaw];
    let q: Vec<f64> = free.iter().map(|one| all[one.index()]).collect();
    let origin = [X, Y, Z].map(|one| f64::from(!free.contains(&one)) * all[one.index()]);
    text.replace("{joint}", kind)
        .replace("{q}", &list(&q, " "))
        .replace("{range}", &list(range.as_flattened(), " "))
        .replace("{origin}", &list(&origin, " "))
}

/// Half the range from which on an angle has no limit: files state half or a quarter of a turn, which no platform makes among its
/// cables.
const NO_LIMIT_RAD: f64 = 1.0;

/// Coordinates and rotation variables of a type of joint, those of one platform in `JointType` of CASPR.
fn motion(kind: &str, axis: Option<Vec<f64>>) -> Option<(Vec<Coordinate>, Rotation)> {
    let coordinates = match kind {
        "SPATIAL_EULER_XYZ" => Coordinate::ALL.to_vec(),
        "SPATIAL" | "SPATIAL_QUATERNION" => {
            return Some((Coordinate::ALL.to_vec(), Rotation::Quaternion));
        }
        "PLANAR_XY" => vec![X, Y, Rz],
        "PLANAR_XZ" => vec![X, Z, Ry],
        "PLANAR_YZ" => vec![Y, Z, Rx],
        "T_XYZ" => vec![X, Y, Z],
        "P_X" => vec![X],
        "P_XY" => vec![X, Y],
        "P_XZ" => vec![X, Z],
        "P_AXIS" => vec![Coordinate::ALL[along(&axis?)?]],
        "R_X" => vec![Rx],
        "R_Y" => vec![Ry],
        "R_Z" => vec![Rz],
        "R_AXIS" => vec![Coordinate::ALL[3 + along(&axis?)?]],
        "S_EULER_XYZ" => vec![Rx, Ry, Rz],
        "S_FIXED_XYZ" => return Some((vec![Rx, Ry, Rz], Rotation::FixedAngles)),
        "SPHERICAL" | "S_QUATERNION" => return Some((vec![Rx, Ry, Rz], Rotation::Quaternion)),
        _ => return None,
    };
    Some((coordinates, Rotation::Angles))
}

/// The axis of the base along which a positive vector points; `None` for an oblique or reversed one.
fn along(axis: &[f64]) -> Option<usize> {
    let mut others = (0..3).filter(|k| axis[*k] != 0.0);
    let only = others.next().filter(|k| axis[*k] > 0.0)?;
    others.next().is_none().then_some(only)
}
