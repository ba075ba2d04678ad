//! Before and after an adjustment of the simulated MINI robot.

use std::collections::BTreeMap;

use tautline_core::accuracy::iso9283::{Target, path_accuracy, pose_accuracy};
use tautline_session::CheckKind;

use super::*;
use crate::adjusting::{ControllerValues, plan_adjustment, write_adjustment};
use crate::clock::ManualClock;
use crate::simulated::{SimulatedSetup, SimulatedTracker};
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
            Some(VerifyingEvent::Commanded { .. } | VerifyingEvent::Wanted { .. }) | None => {}
        }
    }
}

/// Mean position accuracy of the poses and accuracy of the circle (m).
fn figures(rows: &[CheckRow]) -> (f64, f64) {
    let poses = pose_accuracy(&targets_of(rows, CheckKind::Pose)).unwrap();
    let circle = path_accuracy(&targets_of(rows, CheckKind::Path)).unwrap();
    (poses.mean_accuracy_m, circle.accuracy_m)
}

/// Figures before and after an adjustment by 25 measured poses.
fn before_and_after(change: impl FnOnce(&mut SimulatedSetup)) -> [(f64, f64); 2] {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |setup| {
        setup.seed = 5;
        change(setup);
    });
    let mut tracker = robot.inner_mut().tracker(2e-5, 5e-5, 8);
    let mut targets = cube_poses(&preset.robot, &preset.workspace);
    targets.extend(circle(&preset.robot, &preset.workspace, 24));
    let before = figures(&verify(&targets, &mut robot, &mut tracker, &clock));
    let data = measured(&preset, 25, &mut robot, &clock);
    let solution = identified(&data);
    let model = solution.globals.model(&preset.robot);
    let plan = plan_adjustment(&robot.parameters().unwrap(), &model, Some(&solution));
    let changes = plan.iter().filter(|d| d.is_writable_change());
    let values: Vec<_> = changes
        .filter_map(|d| Some((d.name.clone(), d.identified?)))
        .collect();
    let adjustment = write_adjustment(&mut robot, &values).unwrap();
    assert_eq!(adjustment.holds, ControllerValues::New);
    let after = figures(&verify(&targets, &mut robot, &mut tracker, &clock));
    [before, after]
}

#[test]
fn an_adjustment_makes_the_robot_accurate() {
    // The drawing's error of 10 mm moves the platform by 0.8 mm only, as lengths count from home. Of that noise and
    // the unknown home pose (0.1 mm along each axis) leave 0.14 to 0.51 mm over seeds: a gain of 35 to 82 %, and
    // 0.12 to 0.44 mm on the circle.
    let [before, after] = before_and_after(|_| ());
    assert!(before.0 > 6e-4, "{}", before.0);
    assert!(after.0 < 0.3 * before.0, "{before:?} {after:?}");
    assert!(after.1 < 3e-4, "{}", after.1);
}

#[test]
fn without_noise_and_error_of_the_home_pose_little_remains() {
    // The rest is noise of the tracker, and the priors where the data determine little.
    let [before, after] = before_and_after(|setup| {
        setup.noise = false;
        setup.truth.home = setup.nominal.home;
    });
    assert!(after.0 < 0.1 * before.0, "{before:?} {after:?}");
    assert!(after.1 < 0.1 * before.1, "{before:?} {after:?}");
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

#[test]
fn typed_poses_are_waited_for_as_long_as_it_takes() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let targets = cube_poses(&preset.robot, &preset.workspace)[..2].to_vec();
    let mut instrument = TypedInstrument::default();
    let mut run = VerifyingRun::new(targets.clone(), VerifyingOptions::typed())
        .asking(Some(instrument.clone()));
    let mut rows = Vec::new();
    let mut asked = Vec::new();
    loop {
        clock.advance(0.1);
        match run.tick(&mut robot, &mut instrument) {
            Some(VerifyingEvent::Wanted { number }) => {
                // Longer than any motion takes.
                for _ in 0..20 {
                    clock.advance(10.0);
                    assert_eq!(run.tick(&mut robot, &mut instrument), None);
                }
                let position_m = [0.1 * number as f64, 0.0, 0.0];
                let pose = CheckPose {
                    position_m,
                    orientation_wxyz: None,
                };
                instrument.answer(number, pose).unwrap();
                asked.push(number);
            }
            Some(VerifyingEvent::Attained(row)) => rows.push(row),
            Some(VerifyingEvent::Finished) => break,
            Some(VerifyingEvent::Failed(text)) => panic!("{text}"),
            Some(VerifyingEvent::Commanded { .. }) | None => {}
        }
    }
    assert_eq!(asked, [1, 2]);
    let names: Vec<&str> = rows.iter().map(|row| row.target.as_str()).collect();
    assert_eq!(names, [&*targets[0].target, &*targets[1].target]);
    assert!((rows[1].attained.position_m[0] - 0.2).abs() < 1e-12);
    assert_eq!(rows[1].attained.orientation_wxyz, None);
}
