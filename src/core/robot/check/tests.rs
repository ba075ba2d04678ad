use super::*;
use crate::geometry::{Coordinate, Pose};
use crate::robot::{CableMaterial, Pulley, Winch};

fn robot() -> Robot {
    let corners = [[-2.0, -1.5, 2.0], [2.0, -1.5, 2.0], [0.0, 1.5, 2.0]];
    let platform = Platform {
        free: vec![Coordinate::X, Coordinate::Y, Coordinate::Z],
        ..Platform::spatial(None)
    };
    Robot::new(
        "three",
        platform,
        corners.iter().enumerate().map(cable).collect(),
    )
}

fn cable((index, entry_point_m): (usize, &[f64; 3])) -> Cable {
    Cable {
        name: format!("cable-{}", index + 1),
        pulley: Pulley::new(*entry_point_m, [0.0, 0.0, -1.0], 0.05),
        platform_anchor_m: [0.0; 3],
        winch: Winch {
            drum_diameter_m: 0.1,
            drum_pitch_m: 0.0,
            gear_ratio: 1.0,
            length_to_pulley_m: 0.0,
            length_sd_m: 1e-3,
        },
        cable: CableMaterial::default(),
        force_sensor: None,
    }
}

#[test]
fn a_plain_robot_passes() {
    assert_eq!(robot().check(), Ok(()));
}

#[test]
fn pairs_of_pulleys_on_one_post_pass() {
    // CoGiRo's two pulleys on a post are 0.2 m from each other, 1.1 % of its frame.
    let mut pair = robot();
    for (cable, entry) in pair.cables.iter_mut().zip([
        [-7.175, -5.244, 5.462],
        [-7.316, -5.103, 5.473],
        [7.3, 5.2, 5.4],
    ]) {
        cable.pulley.entry_point_m = entry;
    }
    assert_eq!(pair.check(), Ok(()));
}

#[test]
fn a_telescope_passes_and_millimetres_do_not() {
    // The six towers of FAST stand on a circle of 600 m; its cabin is 13 m wide.
    let mut telescope = robot();
    for cable in &mut telescope.cables {
        cable.pulley.entry_point_m = cable.pulley.entry_point_m.map(|value| 150.0 * value);
        cable.platform_anchor_m = [6.5, 0.0, 0.0];
        cable.winch.drum_diameter_m = 1.8;
    }
    assert_eq!(telescope.check(), Ok(()));
    let mut points_in_mm = telescope.clone();
    points_in_mm.cables[0].winch.drum_diameter_m = 0.05;
    let mut all_in_mm = telescope;
    all_in_mm.cables[0].platform_anchor_m = [50.0, 0.0, 0.0];
    for robot in [points_in_mm, all_in_mm] {
        let error = robot.check().expect_err("refused");
        assert!(error.message.contains("millimetres"), "{error:?}");
    }
}

#[test]
fn only_side_by_side_cables_may_have_close_pulleys() {
    let mut close = robot();
    close.cables[1].pulley.entry_point_m = [-1.98, -1.5, 2.0];
    let error = close.check().expect_err("refused");
    assert_eq!(error.pointer, "/cables/1/pulley/entry_point_m");
    close.cables[1].platform_anchor_m = [0.02, 0.0, 0.0];
    assert_eq!(close.check(), Ok(()));
}

#[test]
fn two_cables_may_leave_one_eyelet_but_not_one_pulley() {
    let mut crane = robot();
    crane.cables[1].pulley.entry_point_m = crane.cables[0].pulley.entry_point_m;
    crane.cables[1].platform_anchor_m = [0.8, 0.4, 0.0];
    crane.check().expect_err("two pulleys in one place");
    for cable in &mut crane.cables {
        cable.pulley.radius_m = 0.0;
    }
    assert_eq!(crane.check(), Ok(()));
    crane.cables[1].platform_anchor_m = crane.cables[0].platform_anchor_m;
    crane.check().expect_err("one cable twice");
}

#[test]
fn cables_that_cannot_reach_are_told_apart() {
    let reach = |x: f64, z: f64| {
        let pose = Pose::from_parts([-2.0 + x, -1.5, 2.0 - z], [1.0, 0.0, 0.0, 0.0]);
        robot().check_reach(&pose).map_err(|error| error.message)
    };
    assert!(
        reach(0.05, 0.01)
            .expect_err("inside")
            .contains("inside its pulley")
    );
    assert!(
        reach(0.0, 0.5)
            .expect_err("on the axis")
            .contains("on the swivel axis")
    );
    assert_eq!(reach(0.11, 0.0), Ok(()));
}

#[test]
fn values_that_json_cannot_hold_are_refused_too() {
    let mut broken = robot();
    broken.cables[2].pulley.entry_point_m[1] = f64::NAN;
    let error = broken.check().expect_err("refused");
    assert_eq!(error.pointer, "/cables/2/pulley/entry_point_m/1");
    assert_eq!(error.message, "found NaN, expected a finite number");
}
