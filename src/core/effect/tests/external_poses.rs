//! Recovery of effects of an external instrument, from simulated readings and from readings displaced independently of the
//! effects.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::recovery::{check_run, equipped, hide, typical};
use crate::effect::{EffectSetting, OF_EXTERNAL_POSES};
use crate::estimation::Method;
use crate::geometry::Pose;
use crate::robot::{PerAxis, Robot, Tracker};

/// A robot with an external instrument.
fn tracked(orientation: bool) -> Robot {
    let mut robot = equipped("mini");
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-7),
        orientation_sd_rad: orientation.then_some(1e-7),
    });
    robot
}

/// Half a turn is Rodrigues' parameters of the rotation.
fn rotation(turn: [f64; 3]) -> UnitQuaternion<f64> {
    let half = Vector3::from(turn) * 0.5;
    UnitQuaternion::from_quaternion(Quaternion::from_parts(1.0, half))
}

#[test]
fn all_come_back_together() {
    // A common scale is one of the scales of the axes.
    let all = OF_EXTERNAL_POSES.iter().map(|effect| effect.id());
    let settings: Vec<EffectSetting> = all
        .filter(|id| *id != "tracker_scale")
        .map(typical)
        .collect();
    let run = hide(&tracked(true), &settings);
    check_run(&run, &settings, Method::Joint, 1e-6);
}

#[test]
fn a_frame_and_a_point_come_back_from_positions_alone() {
    let settings = ["tracker_frame", "tracker_target"].map(typical);
    let run = hide(&tracked(false), &settings);
    check_run(&run, &settings, Method::Joint, 1e-6);
}

/// Shares no code with the prediction: poses of another program, moved by its quaternions.
#[test]
fn readings_in_another_frame_of_another_body_are_understood() {
    let mut run = hide(&tracked(true), &[]);
    let (shift, turn) = ([0.013, -0.007, 0.004], [0.004, -0.006, 0.009]);
    let (point, tilt) = ([0.011, 0.006, -0.017], [0.002, 0.003, -0.001]);
    let data = &mut run.dataset.measurements;
    let positions = data.tracked_position_m.iter_mut();
    for (position, q) in positions.zip(&mut data.tracked_orientation_wxyz) {
        let pose = Pose::from_parts(*position, *q);
        let at = pose.position + pose.orientation * Vector3::from(point);
        *position = (Vector3::from(shift) + rotation(turn) * at).into();
        let orientation = rotation(turn) * pose.orientation * rotation(tilt);
        *q = Pose {
            orientation,
            ..pose
        }
        .orientation_wxyz();
    }
    let setting = |id: &str, values: &[f64]| {
        let mut setting = typical(id);
        let names = crate::effect::find(id).unwrap().parameters();
        for (parameter, value) in names.iter().zip(values) {
            setting.parameters.insert(parameter.name.into(), *value);
        }
        setting
    };
    let settings = [
        setting("tracker_frame", &[shift, turn].concat()),
        setting("tracker_target", &point),
        setting("tracker_tilt", &tilt),
    ];
    // Half the cross product of turn and tilt, 1e-5 rad of 1e-3, is left out where both meet.
    check_run(&run, &settings, Method::Joint, 0.02);
}
