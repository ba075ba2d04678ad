//! Checks of simulated runs, good and spoilt.

use super::*;
use nalgebra::{UnitQuaternion, Vector3};
use tautline_core::geometry::Pose;
use tautline_core::robot::{PerAxis, Tracker, presets};
use tautline_core::simulation::{SimulationOptions, simulate};

fn measured() -> Dataset {
    let preset = presets::find("mini").expect("a preset");
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(41, 3)
    };
    simulate(&preset.robot, &options)
        .expect("simulated")
        .dataset
}

fn outcomes(items: &[CheckItem]) -> Vec<CheckOutcome> {
    items.iter().map(|item| item.outcome).collect()
}

#[test]
fn a_good_run_is_ready() {
    let found = check(&measured(), None, true);
    assert!(found.ready, "{:?}", found.checks);
    assert_eq!(
        outcomes(&found.checks),
        [CheckOutcome::Pass; 4],
        "{:?}",
        found.checks
    );
    assert!(found.isolability.is_some());
}

#[test]
fn poses_that_hide_most_faults_are_a_notice_not_a_failure() {
    let mut dataset = measured();
    let first: Vec<usize> = (0..=25).collect();
    dataset.measurements = dataset.measurements.select(&first);
    let found = check(&dataset, None, true);
    assert!(found.ready, "{:?}", found.checks);
    let item = &found.checks[3];
    assert_eq!(item.outcome, CheckOutcome::Notice, "{item:?}");
    assert_eq!(item.action.as_deref(), Some(BETTER_POSES));
}

#[test]
fn poses_in_the_frame_of_a_camera_determine_no_geometry() {
    let preset = presets::find("mini").expect("a preset");
    let mut robot = preset.robot;
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-3),
        orientation_sd_rad: Some(1e-3),
    });
    let run = simulate(&robot, &SimulationOptions::new(25, 3));
    let mut dataset = run.expect("simulated").dataset;
    dataset.measurements.commanded = vec![None; dataset.measurements.len()];
    assert_eq!(geometry_of(&dataset).outcome, CheckOutcome::Pass);
    let turned = UnitQuaternion::from_euler_angles(0.2, 0.1, 1.3);
    for position in &mut dataset.measurements.tracked_position_m {
        *position = (turned * Vector3::from(*position) + Vector3::new(0.4, -2.0, 1.1)).into();
    }
    for wxyz in &mut dataset.measurements.tracked_orientation_wxyz {
        *wxyz = Pose {
            orientation: turned * Pose::from_parts([0.0; 3], *wxyz).orientation,
            ..Pose::identity()
        }
        .orientation_wxyz();
    }
    let found = geometry_of(&dataset);
    assert_eq!(found.outcome, CheckOutcome::Fail);
    assert!(
        found
            .sentence
            .starts_with("Pose 0, meas_x_m: the measured poses are in another frame"),
        "{found:?}"
    );
}

fn geometry_of(dataset: &Dataset) -> CheckItem {
    check(dataset, None, false).checks.remove(2)
}

#[test]
fn wrong_signs_units_and_channels_are_named() {
    let change = |of: fn(&mut Dataset)| {
        let mut dataset = measured();
        of(&mut dataset);
        let item = check_readings(&dataset, None).remove(1);
        assert_eq!(item.outcome, CheckOutcome::Fail, "{item:?}");
        assert!(item.action.is_some());
        item.sentence
    };
    let sign = change(|d| {
        let grid = &mut d.measurements.revolutions;
        (0..grid.rows()).for_each(|row| grid.set(row, 2, -grid.get(row, 2)));
    });
    assert!(
        sign.contains("cable-3 changes with the wrong sign"),
        "{sign}"
    );
    let unit = change(|d| {
        let grid = &mut d.measurements.revolutions;
        (0..grid.rows()).for_each(|row| grid.set(row, 2, 360.0 * grid.get(row, 2)));
    });
    assert!(unit.contains("Rev_3: 360.0000 times too large"), "{unit}");
    let exchanged = change(|d| {
        let grid = &mut d.measurements.revolutions;
        for row in 0..grid.rows() {
            let (a, b) = (grid.get(row, 0), grid.get(row, 5));
            grid.set(row, 0, b);
            grid.set(row, 5, a);
        }
    });
    assert!(
        exchanged.contains("cable-1 changes as that of cable-6 should"),
        "{exchanged}"
    );
    let pushing = change(|d| d.measurements.force_n.set(4, 1, -50.0));
    assert!(
        pushing.starts_with("Pose 4, force_2_n: found -50 N, a negative tension of cable-2"),
        "{pushing}"
    );
    let turned = change(|d| d.measurements.revolutions.set(0, 2, 3.5));
    assert!(
        turned.starts_with("Pose 0, rev_3: found 3.5 revolutions of cable-3 at home, expected 0"),
        "{turned}"
    );
    let distance = change(|d| d.measurements.laser_m[3] = 7.0);
    assert!(
        distance.contains("The laser reads 7.000 m at pose 3"),
        "{distance}"
    );
}

#[test]
fn tensions_outside_the_stated_limits_are_named() {
    let mut dataset = measured();
    let tension = dataset.robot.limits.and_then(|limits| limits.tension);
    let lower_n = tension.expect("MINI states its limits").lower_n;
    let sensor = dataset.robot.cables[2].force_sensor.expect("a sensor");
    // Within the noise of the sensor, and outside all the same.
    let reading_n = sensor.tension_gain * (lower_n - 2.7) + sensor.bias_n;
    dataset.measurements.force_n.set(4, 2, reading_n);
    let found = &check_readings(&dataset, None)[1];
    assert_eq!(found.outcome, CheckOutcome::Notice, "{found:?}");
    let label = dataset.measurements.labels[4];
    let expected = format!("Tensions outside of 10 to 150 N: cable-3 at pose {label} (7.3 N).");
    assert!(found.sentence.ends_with(&expected), "{found:?}");
    assert!(found.action.is_some());
}

#[test]
fn what_is_missing_is_named() {
    let mut dataset = measured();
    let grid = &mut dataset.measurements.revolutions;
    (1..30).for_each(|row| grid.set(row, 3, f64::NAN));
    let found = check_readings(&dataset, None);
    assert_eq!(found[0].outcome, CheckOutcome::Fail);
    assert!(
        found[0].sentence.contains("revolutions of cable-4"),
        "{found:?}"
    );
    let mut dataset = measured();
    let grid = &mut dataset.measurements.revolutions;
    (1..grid.rows()).for_each(|row| (0..8).for_each(|cable| grid.set(row, cable, f64::NAN)));
    let found = check_readings(&dataset, None);
    assert!(
        found[0]
            .sentence
            .starts_with("Pose 1, rev_1: found no number"),
        "{found:?}"
    );
    let mut dataset = measured();
    let two = Dataset {
        measurements: dataset.measurements.select(&[0, 1]),
        ..dataset.clone()
    };
    let found = check_readings(&two, None);
    assert_eq!(found[0].outcome, CheckOutcome::Fail);
    assert!(
        found[0]
            .sentence
            .contains("found 2 rows in all, which cannot determine the robot"),
        "{found:?}"
    );
    dataset.measurements.commanded.fill(None);
    // Eight cables show by their lengths whether they agree; at three poses there is too little to compare.
    assert_eq!(
        check_readings(&dataset, None)[1].outcome,
        CheckOutcome::Pass
    );
    let few = Dataset {
        measurements: dataset.measurements.select(&[0, 1, 2]),
        ..dataset.clone()
    };
    assert_eq!(
        check_readings(&few, None)[1].outcome,
        CheckOutcome::NotEvaluated
    );
    let home = dataset.measurements.select(&[0]);
    dataset.measurements = home;
    let found = check(&dataset, None, true);
    assert!(!found.ready);
    let expected = [
        CheckOutcome::Fail,
        CheckOutcome::NotEvaluated,
        CheckOutcome::NotEvaluated,
        CheckOutcome::NotEvaluated,
    ];
    assert_eq!(outcomes(&found.checks), expected, "{:?}", found.checks);
}
