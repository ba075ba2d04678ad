//! Orientations of poses from three angles.

use tautline_core::geometry::Pose;

use crate::cutting::{Averaged, CutPose};
use crate::recipe::{AngleOrder, Quantity, QuantityKind as Kind, Recipe};

/// Scatter of an angle within a pose that only a jump by a whole turn causes (rad).
const JUMPS: f64 = 1.0;

/// Replaces angles by the quaternions that they state; angles that jump by a turn within a pose are left out.
pub(crate) fn turn_angles(poses: &mut [CutPose], recipe: &Recipe, notices: &mut Vec<String>) {
    let stated = recipe.angles.unwrap_or_default();
    for (angles, kind, order, key) in [
        (
            Kind::CommandedAngle,
            Kind::Commanded,
            stated.commanded,
            "commanded",
        ),
        (
            Kind::TrackedAngle,
            Kind::Tracked,
            stated.measured,
            "measured",
        ),
    ] {
        let mut is_any = false;
        for pose in &mut *poses {
            let taken = [0, 1, 2].map(|index| {
                pose.readings.remove(&Quantity {
                    kind: angles,
                    index,
                })
            });
            if let [Some(first), Some(second), Some(third)] = taken {
                is_any = true;
                turn(
                    pose,
                    kind,
                    [first, second, third],
                    order.unwrap_or(AngleOrder::XYZ),
                );
            }
        }
        if is_any && order.is_none() {
            notices.push(format!(
                "the angles of {key} poses are taken for R = Rx Ry Rz: state another order as angles, {key} in the recipe, or with --angles zyx"
            ));
        }
    }
}

fn turn(pose: &mut CutPose, kind: Kind, angles: [Averaged; 3], order: AngleOrder) {
    if angles.iter().any(|angle| angle.sd > JUMPS) {
        return;
    }
    let turned = Pose {
        orientation: order.orientation(angles.map(|angle| angle.mean)),
        ..Pose::identity()
    };
    for (k, mean) in turned.orientation_wxyz().into_iter().enumerate() {
        let reading = Averaged {
            mean,
            sd: f64::NAN,
            number: angles[0].number,
        };
        let index = 3 + k;
        pose.readings.insert(Quantity { kind, index }, reading);
    }
}
