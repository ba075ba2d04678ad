//! Scenes of the presets.

use tautline_core::geometry::Vec3;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::presets;

use super::*;
use crate::model::Selection;

#[test]
fn the_cable_runs_from_the_entry_over_the_rim_in_the_plane_of_its_wheel() {
    for name in presets::NAMES {
        let robot = presets::find(name).unwrap().robot;
        let scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        let states = inverse_kinematics(&robot, &scene.pose).unwrap();
        for (cable, state) in scene.cables.iter().zip(&states) {
            let wheel = &cable.wheel;
            for point in &cable.path {
                let off = (point - wheel.centre).dot(&wheel.normal);
                assert!(off.abs() < 1e-12, "{name}: in the plane");
            }
            let exit = cable.path[cable.path.len() - 2];
            assert!((exit - state.exit_point).norm() < 1e-12, "{name}");
            assert_eq!(cable.path.last(), Some(&state.anchor_in_base));
            let arc = &cable.path[1..cable.path.len() - 1];
            assert!(
                (arc[0] - wheel.entry).norm() < 1e-12,
                "{name}: from the entry"
            );
            for point in arc {
                let distance = (point - wheel.centre).norm();
                assert!(
                    (distance - wheel.radius_m).abs() < 1e-12,
                    "{name}: on the rim"
                );
            }
        }
    }
}

#[test]
fn sag_adds_the_length_that_the_model_has() {
    let robot = presets::find("suspended").unwrap().robot;
    let tension_n = 900.0;
    let mut force_n = Grid::new(8);
    force_n.push_row(&[2.0 * tension_n; 8]);
    let data = Measurements {
        labels: vec![0],
        force_n,
        ..Measurements::default()
    };
    let scene = SceneInputs::new(&robot, &data).scene();
    for (cable, description) in scene.cables.iter().zip(&robot.cables) {
        assert_eq!(cable.tension_n, Some(tension_n));
        let free = cable.free_m.unwrap();
        let pieces = cable.path.windows(2).rev().take(24);
        let drawn: f64 = pieces.map(|ends| (ends[1] - ends[0]).norm()).sum();
        let [exit, anchor] = [
            cable.path[cable.path.len() - 25],
            *cable.path.last().unwrap(),
        ];
        let horizontal = (anchor - exit).xy().norm();
        let weight = description.cable.weight_n_per_m;
        let modelled = (weight * horizontal / tension_n).powi(2) * free / 24.0;
        // The chords of 24 segments are shorter than the parabola by 1/576 of the extra length.
        assert!(modelled > 1e-4 && (drawn - free - modelled).abs() < 0.02 * modelled);
        let middle = cable.path[cable.path.len() - 13];
        assert!(middle.z < exit.lerp(&anchor, 0.5).z, "it hangs down");
    }
}

#[test]
fn the_frame_holds_the_pulleys_and_stands_on_the_floor() {
    for name in presets::NAMES {
        let robot = presets::find(name).unwrap().robot;
        let scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        let local = scene.directions.transpose();
        let heights = scene.frame.corners.iter().map(|c| (local * c).z);
        let lowest = heights.fold(f64::INFINITY, f64::min);
        let floor = &scene.frame.floor;
        assert!(
            floor
                .corners
                .iter()
                .all(|c| ((local * c).z - lowest).abs() < 1e-9)
        );
        let target = scene.laser.unwrap().spot.unwrap();
        assert!((local * target).z >= lowest - 1e-9, "{name}");
        let expected = if name == "planar" { 4 } else { 12 };
        assert_eq!(scene.frame.members.len(), expected, "{name}");
        let (centre, radius) = scene.bounds(&[]);
        let far = scene
            .extent()
            .iter()
            .map(|p| (p - centre).norm())
            .fold(0.0, f64::max);
        assert!(far < radius);
    }
}

#[test]
fn the_selected_pose_is_shown_with_its_own_tensions() {
    let robot = presets::find("mini").unwrap().robot;
    let mut force_n = Grid::new(8);
    force_n.push_row(&[80.0; 8]);
    force_n.push_row(&[100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN]);
    let pose = Pose::from_parts([0.1, 0.0, 0.05], [1.0, 0.0, 0.0, 0.0]);
    let data = Measurements {
        labels: vec![0, 7],
        commanded: vec![None, Some(pose)],
        force_n,
        ..Measurements::default()
    };
    let mut subject = SceneInputs::new(&robot, &data);
    assert_eq!(subject.scene().shown, ShownPose::Home);
    assert_eq!(subject.scene().cables[0].tension_n, Some(40.0));
    subject.selection = Selection::pose(7);
    let scene = subject.scene();
    assert_eq!((scene.shown, scene.pose), (ShownPose::Given(7), pose));
    assert_eq!(scene.cables[0].tension_n, Some(50.0));
    assert_eq!(scene.cables[7].tension_n, None);
    assert_eq!(scene.measured.len(), 1);
    assert_eq!(scene.measured[0].position, Vec3::new(0.1, 0.0, 0.05));
}

#[test]
fn the_sensors_of_the_home_platform_are_drawn_at_home_alone() {
    let demo = tautline_workflow::samples::demo(3, tautline_workflow::clock::now());
    let robot = demo.expect("a demonstration").robot;
    let mut pose = robot.home.expect("a home pose").pose();
    assert!(!platform::home_beams(&robot, &pose).is_empty());
    pose.position.x += 0.1;
    assert!(platform::home_beams(&robot, &pose).is_empty());
}
