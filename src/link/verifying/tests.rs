//! Before and after an adjustment of the simulated MINI robot.

use std::collections::BTreeMap;

use tautline_core::accuracy::iso9283::{Target, path_accuracy, pose_accuracy};
use tautline_session::CheckKind;

use super::*;
use crate::adjusting::{Holds, plan_adjustment, write_adjustment};
use crate::clock::ManualClock;
use crate::simulated::SimulatedTracker;
use crate::testing::{armed, identified, measured, preset};

fn pose_of(pose: &CheckPose) -> Pose {
    Pose::from_parts(pose.position_m, pose.orientation_wxyz.unwrap())
}

fn targets_of(rows: &[CheckRow], kind: CheckKind) -> Vec<Target> {
    let mut targets: BTreeMap<(String, i64), Target> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.kind == kind) {
        let key = (row.target.clone(), row.sample);
        let target = targets.entry(key).or_insert(Target {
            commanded: pose_of(&row.commanded),
            attained: Vec::new(),
        });
        target.attained.push(pose_of(&row.attained));
    }
    targets.into_values().collect()
}

fn verify(
    targets: &[CheckTarget],
    robot: &mut dyn Controller,
    tracker: &mut SimulatedTracker,
    clock: &ManualClock,
) -> Vec<CheckRow> {
    let mut run = VerifyingRun::new(targets.to_vec(), VerifyingOptions::default());
    let mut rows = Vec::new();
    loop {
        clock.advance(0.1);
        match run.tick(robot, tracker) {
            Some(VerifyingEvent::Attained(row)) => rows.push(row),
            Some(VerifyingEvent::Finished) => return rows,
            Some(VerifyingEvent::Failed(text)) => panic!("{text}"),
            Some(VerifyingEvent::Commanded { .. }) | None => {}
        }
    }
}

/// Mean position accuracy of the poses and accuracy of the circle (m).
fn figures(rows: &[CheckRow]) -> (f64, f64) {
    let poses = pose_accuracy(&targets_of(rows, CheckKind::Pose)).unwrap();
    let circle = path_accuracy(&targets_of(rows, CheckKind::Path)).unwrap();
    (poses.mean_accuracy_m, circle.accuracy_m)
}

#[test]
fn an_adjustment_makes_the_robot_accurate() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut tracker = robot.inner_mut().tracker(2e-5, 5e-5, 8);
    let mut targets = cube_poses(&preset.robot, &preset.workspace);
    targets.extend(circle(&preset.robot, &preset.workspace, 24));
    let before = figures(&verify(&targets, &mut robot, &mut tracker, &clock));
    let data = measured(&preset, 25, &mut robot, &clock);
    let solution = identified(&data);
    let model = solution.globals.model(&preset.robot);
    let plan = plan_adjustment(&robot.parameters().unwrap(), &model, Some(&solution));
    let changes = plan.iter().filter(|d| d.is_writable_change());
    let values: Vec<_> = changes.map(|d| (d.name.clone(), d.identified)).collect();
    let adjustment = write_adjustment(&mut robot, &values).unwrap();
    assert_eq!(adjustment.holds, Holds::New);
    let after = figures(&verify(&targets, &mut robot, &mut tracker, &clock));
    println!(
        "poses {:.3} -> {:.3} mm, circle {:.3} -> {:.3} mm",
        before.0 * 1e3,
        after.0 * 1e3,
        before.1 * 1e3,
        after.1 * 1e3
    );
    let gain = 1.0 - after.0 / before.0;
    assert!(gain > 0.95, "{gain}");
    assert!(after.1 < 3e-4, "{}", after.1);
}

#[test]
fn cubes_of_the_mini_robot_are_those_of_the_paper() {
    let preset = preset("mini");
    let edges = cube_edges_m(&preset.robot, &preset.workspace);
    for (edge, published) in edges.iter().zip([0.312, 0.2496, 0.156]) {
        assert!((edge - published).abs() < 1e-12);
    }
    let poses = cube_poses(&preset.robot, &preset.workspace);
    assert_eq!(poses.len(), 15);
    assert!((poses[0].pose.position.x - 0.4 * 0.312).abs() < 1e-12);
    for name in ["hall", "suspended", "planar"] {
        let preset = crate::testing::preset(name);
        let limits = crate::testing::limits(&preset);
        let mut all = cube_poses(&preset.robot, &preset.workspace);
        all.extend(circle(&preset.robot, &preset.workspace, 12));
        all.extend(line(&preset.robot, &preset.workspace, 5));
        assert_eq!(all.len(), 15 + 12 + 5);
        for target in all {
            limits.check_pose(&target.pose).unwrap();
        }
    }
}
