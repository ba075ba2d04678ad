//! Poses in the representation of a controller.

use nalgebra::{UnitQuaternion, Vector3};
use tautline_core::geometry::Pose;
use tautline_session::{SymbolPose, SymbolRotation};

/// The numbers of a pose in the controller.
pub(super) fn numbers_of(pose: &Pose, written: &SymbolPose) -> Vec<f64> {
    let mut numbers: Vec<f64> = pose
        .position
        .iter()
        .map(|metres| metres / written.length_scale)
        .collect();
    let angle = |radians: &f64| radians / written.angle_scale;
    match written.rotation {
        SymbolRotation::Quaternion => numbers.extend(pose.orientation_wxyz()),
        SymbolRotation::RotationVector => {
            numbers.extend(pose.orientation.scaled_axis().iter().map(angle));
        }
        SymbolRotation::RollPitchYaw => {
            numbers.extend(roll_pitch_yaw(&pose.orientation).iter().map(angle));
        }
    }
    numbers
}

/// The pose for the controller's numbers; `None` if they are not a valid pose.
pub(super) fn pose_of(numbers: &[f64], written: &SymbolPose) -> Option<Pose> {
    if numbers.iter().any(|number| !number.is_finite()) {
        return None;
    }
    let (position, rotation) = numbers.split_at_checked(3)?;
    let position = Vector3::from_column_slice(position) * written.length_scale;
    let orientation = match (written.rotation, rotation) {
        (SymbolRotation::Quaternion, &[w, x, y, z]) => {
            let quaternion = nalgebra::Quaternion::new(w, x, y, z);
            let given = quaternion.norm() > 0.5;
            given.then(|| UnitQuaternion::from_quaternion(quaternion))?
        }
        (SymbolRotation::RotationVector, &[x, y, z]) => {
            UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z) * written.angle_scale)
        }
        (SymbolRotation::RollPitchYaw, &[roll, pitch, yaw]) => {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll * written.angle_scale)
                * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch * written.angle_scale)
                * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw * written.angle_scale)
        }
        _ => return None,
    };
    Some(Pose {
        position,
        orientation,
    })
}

/// Angles (rad) of `R = Rx(roll) Ry(pitch) Rz(yaw)`.
fn roll_pitch_yaw(orientation: &UnitQuaternion<f64>) -> [f64; 3] {
    let r = orientation.to_rotation_matrix();
    let cosine = r[(0, 0)].hypot(r[(0, 1)]);
    let pitch = r[(0, 2)].atan2(cosine);
    if cosine < 1e-9 {
        // Gimbal lock: roll and yaw rotate about the same axis, so all of it is assigned to roll.
        return [r[(1, 0)].atan2(r[(1, 1)]) * r[(0, 2)].signum(), pitch, 0.0];
    }
    let roll = (-r[(1, 2)]).atan2(r[(2, 2)]);
    let yaw = (-r[(0, 1)]).atan2(r[(0, 0)]);
    [roll, pitch, yaw]
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_session::SymbolNames;

    fn written(rotation: SymbolRotation) -> SymbolPose {
        SymbolPose {
            symbol: SymbolNames::One("P".into()),
            rotation,
            length_scale: 1e-3,
            angle_scale: std::f64::consts::PI / 180.0,
        }
    }

    #[test]
    fn poses_come_back_from_their_numbers() {
        for rotation in [
            SymbolRotation::Quaternion,
            SymbolRotation::RotationVector,
            SymbolRotation::RollPitchYaw,
        ] {
            let written = written(rotation);
            for axis in [[0.0, 0.0, 0.0], [0.3, -1.0, 2.0], [-2.0, 0.2, 0.1]] {
                let pose = Pose {
                    position: Vector3::new(0.1, -0.2, 0.3),
                    orientation: UnitQuaternion::from_scaled_axis(axis.into()),
                };
                let numbers = numbers_of(&pose, &written);
                assert_eq!(numbers.len(), rotation.pose_values());
                assert!((numbers[0] - 100.0).abs() < 1e-12);
                let again = pose_of(&numbers, &written).unwrap();
                assert!(again.difference(&pose).norm() < 1e-12);
            }
            assert!(pose_of(&[0.0; 5], &written).is_none());
        }
    }

    #[test]
    fn angles_are_about_x_then_y_then_z_of_the_platform() {
        let written = written(SymbolRotation::RollPitchYaw);
        let pose = pose_of(&[0.0, 0.0, 0.0, 90.0, 0.0, 90.0], &written).unwrap();
        // Yaw takes the platform's x to its y, roll takes that to the base's z.
        let moved = pose.transform(&Vector3::x());
        assert!((moved - Vector3::z()).norm() < 1e-12, "{moved}");
    }

    #[test]
    fn straight_up_has_its_angles_too() {
        let written = written(SymbolRotation::RollPitchYaw);
        for pitch in [90.0, -90.0] {
            let pose = pose_of(&[0.0, 0.0, 0.0, 20.0, pitch, 30.0], &written).unwrap();
            let again = pose_of(&numbers_of(&pose, &written), &written).unwrap();
            assert!(again.difference(&pose).norm() < 1e-7, "{pitch}");
        }
    }

    #[test]
    fn numbers_without_an_orientation_are_no_pose() {
        let written = written(SymbolRotation::Quaternion);
        assert!(pose_of(&[0.0; 7], &written).is_none());
        assert!(pose_of(&[f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], &written).is_none());
    }
}
