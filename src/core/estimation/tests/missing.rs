//! Readings, instruments and cables that are not there.

use super::*;
use crate::measurement::Grid;
use crate::robot::Robot;

/// Solves by both methods, analyses, and returns the degrees of freedom.
fn degrees_of_freedom(dataset: &Dataset) -> [f64; 2] {
    [Method::Joint, Method::Simple].map(|method| {
        let problem = Problem::new(dataset).unwrap().with_method(method);
        let solution = solved(&problem);
        // With less than six cables the poses hang on the laser and are nearly singular.
        let weak = dataset.robot.cable_count() < 6;
        assert!(solution.converged() || weak, "{:?}", solution.termination);
        assert!(solution.chi2.is_finite());
        let analysis = Analysis::new(&problem, &solution);
        assert!(
            analysis
                .observations
                .iter()
                .all(|r| r.standardised.is_finite())
        );
        let _ = rank_defects(&problem, &solution);
        if solution.covariance.is_some() && !weak {
            let readings = analysis.observations.iter().filter_map(|r| r.redundancy);
            let sum =
                readings.sum::<f64>() + analysis.prior_redundancies.iter().flatten().sum::<f64>();
            assert!((sum - solution.degrees_of_freedom).abs() < 1e-5);
        }
        solution.degrees_of_freedom
    })
}

#[test]
fn every_reading_counts_once() {
    let whole = run_of("mini", 20, 51).dataset;
    // 20 poses of 8 lengths, 21 laser readings, 21 equilibria, 31 priors and 8 more of tensions at
    // home, less 20 poses and as many parameters as priors.
    assert_eq!(
        degrees_of_freedom(&whole),
        [160.0 + 21.0 + 126.0 - 120.0, 160.0 + 21.0 - 120.0]
    );

    let mut data = whole.clone();
    data.measurements.laser_m[3] = f64::NAN;
    data.measurements.revolutions.set(5, 1, f64::NAN);
    assert_eq!(degrees_of_freedom(&data), [185.0, 59.0]);

    // A cable whose tension is not known has no usable length; the equilibrium of its pose goes, too.
    let mut data = whole.clone();
    data.measurements.force_n.set(5, 1, f64::NAN);
    assert_eq!(degrees_of_freedom(&data), [180.0, 60.0]);

    // A cable without any length: its entry point keeps its prior.
    let mut data = whole.clone();
    for row in 0..21 {
        data.measurements.revolutions.set(row, 6, f64::NAN);
    }
    assert_eq!(degrees_of_freedom(&data), [167.0, 41.0]);

    // A row without anything has no pose either.
    let mut data = whole.clone();
    for cable in 0..8 {
        data.measurements.revolutions.set(9, cable, f64::NAN);
        data.measurements.force_n.set(9, cable, f64::NAN);
    }
    data.measurements.laser_m[9] = f64::NAN;
    assert_eq!(degrees_of_freedom(&data), [187.0 - 9.0, 61.0 - 3.0]);
}

#[test]
fn robots_without_instruments_are_calibrated_as_well() {
    let whole = run_of("mini", 20, 52).dataset;
    let mut data = whole.clone();
    data.robot.platform.mass_kg = None;
    assert_eq!(degrees_of_freedom(&data), [61.0, 61.0]);

    let mut data = whole.clone();
    data.robot.laser = None;
    assert_eq!(degrees_of_freedom(&data), [166.0, 40.0]);

    let mut data = whole.clone();
    for cable in &mut data.robot.cables {
        cable.force_sensor = None;
    }
    assert_eq!(degrees_of_freedom(&data), [61.0, 61.0]);

    let mut data = whole.clone();
    data.measurements.force_n = Grid::default();
    // With limits the tensions would be estimated.
    data.robot.limits = None;
    assert_eq!(degrees_of_freedom(&data), [61.0, 61.0]);

    // One cable without sensor: no equilibrium, the other tensions are latent all the same.
    let mut data = whole;
    data.robot.cables[2].force_sensor = None;
    assert_eq!(degrees_of_freedom(&data), [61.0, 61.0]);
}

/// MINI with its cables repeated or cut to `count`.
fn with_cables(count: usize) -> Robot {
    let mut robot = presets::find("mini").unwrap().robot;
    let all = robot.cables.clone();
    robot.cables = (0..count)
        .map(|k| {
            let mut cable = all[k % 8].clone();
            cable.name = format!("cable-{}", k + 1);
            cable.pulley.entry_point_m[2] *= if k < 8 { 1.0 } else { 0.4 };
            cable
        })
        .collect();
    robot
}

#[test]
fn one_cable_and_twelve() {
    for count in [1, 2, 5, 7, 12] {
        let mut robot = with_cables(count);
        if count < 7 {
            // So few cables hold no platform: poses and lengths only.
            robot.platform.mass_kg = None;
        }
        let preset = presets::find("mini").unwrap();
        let options = SimulationOptions {
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(10, 53)
        };
        let run = simulate(&robot, &options);
        let Ok(run) = run else {
            assert_eq!(count, 7, "seven cables need not hold it");
            continue;
        };
        let [joint, simple] = degrees_of_freedom(&run.dataset);
        let open = 10.0 * (count as f64 + 1.0 - 6.0).max(0.0);
        assert_eq!(simple, open + 1.0, "{count} cables");
        assert!(joint >= simple);
    }
}

#[test]
fn a_swivel_reading_without_direction_of_zero_is_no_reading() {
    let mut dataset = run_of("mini", 12, 54).dataset;
    let before = degrees_of_freedom(&dataset);
    let rows = dataset.measurements.len();
    let mut swivels = Grid::missing(rows, 8);
    for row in 0..rows {
        for cable in 0..8 {
            swivels.set(row, cable, 0.3);
        }
    }
    dataset.measurements.swivel_rad = swivels;
    // Cable 1 has no direction of zero, the others no standard deviation.
    dataset.robot.cables[0].pulley.swivel_sd_rad = Some(5e-3);
    assert_eq!(degrees_of_freedom(&dataset), before);
}

#[test]
fn a_cable_that_reads_no_tension_at_all_does_no_harm() {
    // Exactly zero: where sag has no value.
    let mut dataset = run_of("suspended", 15, 55).dataset;
    let sensor = dataset.robot.cables[3].force_sensor.unwrap();
    dataset
        .measurements
        .force_n
        .set(4, 3, sensor.reading_n(0.0));
    for method in [Method::Joint, Method::Simple] {
        let problem = Problem::new(&dataset).unwrap().with_method(method);
        let solution = solved(&problem);
        assert!(solution.chi2.is_finite(), "{method:?}");
    }
}

#[test]
fn numbers_that_are_none_end_the_solve() {
    let mut dataset = run_of("mini", 12, 56).dataset;
    dataset.measurements.laser_m[3] = f64::INFINITY;
    let problem = Problem::new(&dataset).unwrap();
    let solution = solved(&problem);
    assert_eq!(solution.termination, Termination::Stalled);
    let _ = rank_defects(&problem, &solution);
}

#[test]
fn what_cannot_be_estimated_is_refused() {
    let whole = run_of("mini", 12, 57).dataset;
    let refused = |change: &dyn Fn(&mut Dataset)| {
        let mut dataset = whole.clone();
        change(&mut dataset);
        let problem = Problem::new(&dataset).unwrap();
        solve(&problem, &Options::default(), &mut quiet).unwrap_err()
    };
    assert_eq!(
        refused(&|d| d.measurements.revolutions = Grid::default()),
        EstimationError::NoLengths
    );
    assert_eq!(
        refused(&|d| d.measurements = d.measurements.select(&[0])),
        EstimationError::NoPoses
    );
    assert_eq!(refused(&|d| d.robot.home = None), EstimationError::NoHome);
    assert_eq!(
        refused(&|d| d.measurements.labels[0] = 99),
        EstimationError::NoHomeRow
    );
    assert_eq!(
        refused(&|d| d.measurements.force_n.set(0, 1, f64::NAN)),
        EstimationError::NoHomeTension("cable-2".to_owned())
    );
}
