//! Poses that are measured one by one, repeated and left out.

use tautline_core::geometry::Pose;
use tautline_core::measurement::Grid;
use tautline_core::robot::presets;

use super::*;

/// A pose of the test session with a reading of every kind that its robot can have.
fn full(label: i64) -> MeasuredPose {
    let commanded = Pose::from_parts([0.1, 0.2, 0.0], [1.0, 0.0, 0.0, 0.0]);
    MeasuredPose::from(Measurements {
        labels: vec![label],
        time_s: vec![9.0],
        temperature_c: vec![21.5],
        groups: vec!["monday".into()],
        commanded: vec![Some(commanded)],
        length_m: Grid::of_row(vec![1.0, f64::NAN]),
        force_n: Grid::of_row(vec![20.0, 30.0]),
        laser_m: vec![0.4],
        swivel_rad: Grid::of_row(vec![0.1, 0.2]),
        inclination_rad: vec![[0.0, 0.1, 0.2]],
        tracked_position_m: vec![[0.1, f64::NAN, 0.3]],
        tracked_orientation_wxyz: vec![[1.0, 0.0, 0.0, 0.0]],
        tracked_position_sd_m: vec![[1e-3; 3]],
        ..Measurements::default()
    })
}

fn with_lengths(label: i64, length_m: Vec<f64>) -> MeasuredPose {
    MeasuredPose::from(Measurements {
        labels: vec![label],
        length_m: Grid::of_row(length_m),
        ..Measurements::default()
    })
}

fn with_revolutions(label: i64, revolutions: Vec<f64>) -> MeasuredPose {
    MeasuredPose::from(Measurements {
        labels: vec![label],
        revolutions: Grid::of_row(revolutions),
        ..Measurements::default()
    })
}

fn reads_back(session: &Session) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, session).expect("written");
    let read = read_session(&path).expect("a session").value;
    assert_eq!(format!("{read:?}"), format!("{session:?}"));
}

#[test]
fn a_pose_fills_the_columns_that_were_empty() {
    let mut session = session();
    session.append_pose(&full(5)).expect("a pose");
    let m = &session.measurements;
    assert_eq!(m.labels, [3, 1, 5]);
    assert_eq!(m.length_m.row(2)[0], 1.0);
    assert!(m.length_m.get(2, 1).is_nan());
    assert!(m.force_n.get(0, 0).is_nan() && m.laser_at(1).is_nan());
    assert_eq!((m.force_n.get(2, 1), m.laser_at(2)), (30.0, 0.4));
    assert_eq!(m.groups, ["", "", "monday"]);
    assert_eq!(
        m.commanded.iter().map(Option::is_some).collect::<Vec<_>>(),
        [false, false, true]
    );
    assert_eq!(m.other[0].1, ["x", "y", ""]);
    reads_back(&session);
    // A pose with fewer readings gets empty cells.
    let short = with_lengths(6, vec![1.0, 1.1]);
    session.append_pose(&short).expect("a pose");
    assert!(session.measurements.laser_at(3).is_nan());
    assert_eq!(session.measurements.swivel_rad.rows(), 4);
    reads_back(&session);
}

#[test]
fn a_session_can_be_measured_from_the_first_pose_on() {
    let robot = presets::find("mini").expect("a preset").robot;
    let mut session = Session::new("new", robot, Timestamp::from_unix_seconds(0));
    for label in 0..3 {
        let pose = with_revolutions(label, vec![label as f64; 8]);
        session.append_pose(&pose).expect("a pose");
    }
    assert_eq!(session.measurements.home_row(), Some(0));
    assert_eq!(session.measurements.revolutions.row(2), [2.0; 8]);
    assert!(session.measurements.length_m.is_empty());
    reads_back(&session);
}

#[test]
fn a_pose_that_makes_no_sense_changes_nothing() {
    type Change = fn(&mut MeasuredPose);
    let cases: [(Change, &str); 9] = [
        (
            |p| p.readings.labels = vec![1],
            "/measurements/pose/2: found 1 again (value 1)",
        ),
        (
            |p| p.readings.length_m = Grid::of_row(vec![1.0; 3]),
            "/columns/length_3_m: found cable 3, expected 1 to 2",
        ),
        (
            |p| p.readings.force_n = Grid::of_row(vec![1.0]),
            "/columns/force_2_n: missing, expected one",
        ),
        (
            |p| p.readings.length_m = Grid::default(),
            "/columns/rev_1: missing, expected rev_1, change_1_m or length_1_m",
        ),
        (
            |p| p.readings.revolutions = Grid::of_row(vec![1.0; 2]),
            "/columns/length_1_m: found beside rev_1",
        ),
        (
            |p| p.readings.length_m.set(0, 0, 900.0),
            "/columns/length_1_m/2: found 900 m in a frame",
        ),
        (
            |p| p.readings.laser_m = vec![f64::INFINITY],
            "/columns/laser_m/2: found inf, expected a finite number",
        ),
        (
            |p| p.readings.tracked_orientation_wxyz = vec![[2.0, 0.0, 0.0, 0.0]],
            "/columns/meas_qw/2: found a quaternion of norm 2",
        ),
        (
            |p| p.repeats = Some(8),
            "/excluded: found 8, expected the label of a measured pose",
        ),
    ];
    let before = session();
    for (change, message) in cases {
        let mut session = session();
        let mut pose = full(5);
        change(&mut pose);
        let error = session.append_pose(&pose).expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
        assert_eq!(format!("{session:?}"), format!("{before:?}"));
    }
}

#[test]
fn revolutions_and_lengths_do_not_mix() {
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.effects.clear();
    let mut session = Session::new("new", robot, Timestamp::from_unix_seconds(0));
    let home = with_revolutions(0, vec![0.0; 8]);
    session.append_pose(&home).expect("a pose");
    let other = with_lengths(1, vec![1.0; 8]);
    let error = session.append_pose(&other).expect_err("lengths");
    assert_eq!(
        error.to_string(),
        "/measurements/columns/length_1_m: found a reading, expected revolutions as at the poses \
         before"
    );
}

#[test]
fn a_repeated_pose_takes_the_next_label_and_the_old_one_stays_aside() {
    let mut session = session();
    assert!(session.include(3));
    assert_eq!(session.next_label(), 5, "4 is planned");
    let again = full(3).repeated_as(session.next_label());
    session.append_pose(&again).expect("a pose");
    assert_eq!(session.measurements.labels, [3, 1, 5]);
    assert_eq!(session.dataset().measurements.labels, [1, 5]);
    assert_eq!(session.whole_dataset().measurements.labels, [3, 1, 5]);
    assert_eq!(session.next_label(), 6);
}

#[test]
fn poses_are_left_out_and_taken_back_but_not_the_home_pose() {
    let mut session = session();
    assert_eq!(session.dataset().measurements.labels, [1]);
    assert!(session.include(3) && !session.include(3));
    assert_eq!(session.dataset().measurements.labels, [3, 1]);
    let error = session.exclude(0).expect_err("the home pose").to_string();
    assert!(error.contains("the home pose"), "{error}");
    let error = session.exclude(9).expect_err("not measured").to_string();
    assert!(error.contains("found 9, expected the label"), "{error}");
}

#[test]
fn truth_is_kept_only_where_it_is_known_for_all_poses() {
    let mut session = session();
    session.measurements.truth.poses = vec![Pose::identity(); 2];
    session.measurements.truth.tension_n = Grid::missing(2, 2);
    reads_back(&session);
    session.append_pose(&full(5)).expect("a pose");
    assert!(session.measurements.truth.poses.is_empty());
    assert_eq!(session.measurements.truth.tension_n.rows(), 3);
    reads_back(&session);
}

#[test]
fn group_labels_of_an_earlier_version_are_found_among_the_unknown_columns() {
    let mut document = saved();
    document["measurements"]["other"][0]["name"] = json!("group");
    let text = document.to_string();
    let read = parse_session(text.as_bytes(), "s.json").expect("a session");
    assert_eq!(read.value.measurements.groups, ["x", "y"]);
    assert!(read.value.measurements.other.is_empty());
    document["measurements"]["group"] = json!(["a"]);
    let error = parse_session(document.to_string().as_bytes(), "s.json").expect_err("too short");
    assert_eq!(
        error.to_string(),
        "s.json, /measurements/group: found 1 values, expected 2 as in /pose"
    );
}

#[test]
fn planned_poses_are_poses() {
    let pose = Pose::from_parts([0.1, 0.2, 0.3], [0.6, 0.0, 0.8, 0.0]);
    let planned = PlannedPose::new(2, &pose);
    assert_eq!(planned.label, 2);
    assert!(planned.pose().difference(&pose).norm() < 1e-15);
}

#[test]
fn poses_of_another_state_of_the_session_are_added_once() {
    let robot = presets::find("mini").expect("a preset").robot;
    let empty = Session::new("new", robot, Timestamp::from_unix_seconds(0));
    let measured = |labels: &[i64]| {
        let mut session = empty.clone();
        for label in labels {
            let pose = with_revolutions(*label, vec![*label as f64; 8]);
            session.append_pose(&pose).expect("a pose");
        }
        session
    };
    let mut session = measured(&[0, 2]);
    let other = measured(&[0, 1, 2, 5]);
    assert_eq!(session.append_missing(&other), Ok(vec![1, 5]));
    assert_eq!(session.measurements.labels, [0, 2, 1, 5]);
    assert_eq!(session.measurements.revolutions.row(3), [5.0; 8]);
    assert_eq!(session.append_missing(&other), Ok(Vec::new()));
    reads_back(&session);
}
