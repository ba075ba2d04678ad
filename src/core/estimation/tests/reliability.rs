//! Residuals, redundancies and reliability against solutions with a changed reading, which share no code with them; and the
//! power of the test in a simulation.
//!
//! The least sum of squares, as a function of an error `d` of one reading in its standard deviations, has the
//! derivative `-2 e` and the second derivative `2 r`, with the standardised residual `e` and the redundancy `r` of the
//! reading (envelope theorem; exact where the model is linear).

use super::*;
use crate::geometry::Vec3;
use crate::statistics::normal_two_sided;

/// The data with an error of `deviations` standard deviations in one reading.
fn with_error(dataset: &Dataset, reading: &Observation, deviations: f64) -> Dataset {
    let mut changed = dataset.clone();
    let data = &mut changed.measurements;
    let (row, by) = (reading.row, deviations * reading.sd);
    match reading.kind {
        ObservationKind::Length(cable) if data.length_m.is_empty() => {
            let winch = &dataset.robot.cables[cable].winch;
            let per_turn = std::f64::consts::PI * winch.drum_diameter_m / winch.gear_ratio;
            let turns = data.revolutions.get(row, cable) + by / per_turn;
            data.revolutions.set(row, cable, turns);
        }
        ObservationKind::Length(cable) => {
            let length = data.length_m.get(row, cable) + by;
            data.length_m.set(row, cable, length);
        }
        ObservationKind::Tension(cable) => {
            let sensor = dataset.robot.cables[cable].force_sensor.unwrap();
            let tension = sensor.tension_n(data.force_n.get(row, cable)) + by;
            data.force_n.set(row, cable, sensor.reading_n(tension));
        }
        ObservationKind::Laser => data.laser_m[row] += by,
        ObservationKind::Swivel(cable) => {
            let angle = data.swivel_rad.get(row, cable) + by;
            data.swivel_rad.set(row, cable, angle);
        }
        ObservationKind::TrackerPosition(k) => data.tracked_position_m[row][k] += by,
        ObservationKind::Inclination(k) => data.inclination_rad[row][k] += by,
        kind => panic!("{kind:?} is not read, or not to be changed alone"),
    }
    changed
}

fn can_be_changed(reading: &Observation) -> bool {
    use ObservationKind::{Equilibrium, TrackerOrientation};
    !matches!(reading.kind, Equilibrium(_) | TrackerOrientation(_))
}

#[test]
fn residuals_and_redundancies_are_the_derivatives_of_the_sum_of_squares() {
    const STEP: f64 = 0.3;
    // Third derivatives of the sum of squares: the model is not linear.
    const CURVATURE: f64 = 0.01;
    for name in presets::NAMES {
        let run = run_of(name, 12, 31);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        let analysis = Analysis::new(&problem, &solution);
        let chi2 = |reading, by| {
            let changed = with_error(&run.dataset, reading, by);
            solved(&Problem::new(&changed).unwrap()).chi2
        };
        let readings = analysis.observations.iter().filter(|r| can_be_changed(r));
        let mut kinds = std::collections::HashSet::new();
        for reading in readings.step_by(5) {
            let [less, more] = [-STEP, STEP].map(|by| chi2(reading, by));
            let residual = (less - more) / (4.0 * STEP);
            let redundancy = (less + more - 2.0 * solution.chi2) / (2.0 * STEP * STEP);
            let [off, off_redundancy] = [
                reading.standardised - residual,
                reading.redundancy.unwrap() - redundancy,
            ];
            assert!(off.abs() < CURVATURE, "{name}, {reading:?}: {off:e}");
            assert!(
                off_redundancy.abs() < CURVATURE,
                "{name}, {reading:?}: {off_redundancy:e}"
            );
            kinds.insert(std::mem::discriminant(&reading.kind));
        }
        assert!(kinds.len() >= 2, "{name}: {} kinds", kinds.len());
    }
}

#[test]
fn an_error_moves_the_pulleys_as_far_as_stated() {
    for name in presets::NAMES {
        let run = run_of(name, 12, 32);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        let analysis = Analysis::new(&problem, &solution);
        let readings = analysis.observations.iter().filter(|r| can_be_changed(r));
        for reading in readings.step_by(11) {
            let pulled = reading.pull.expect("every reading moves something");
            // So little that the model is linear.
            let changed = with_error(&run.dataset, reading, 0.1);
            let moved = solved(&Problem::new(&changed).unwrap());
            let entries = |s: &Solution| s.globals.entry_points.clone();
            let by: Vec<f64> = std::iter::zip(entries(&moved), entries(&solution))
                .map(|(a, b)| 10.0 * (Vec3::from(a) - Vec3::from(b)).norm())
                .collect();
            let most = by.iter().copied().fold(0.0, f64::max);
            let off = (most - pulled.per_sd_m).abs();
            // Gauss and Newton leave out the curvature of the model times the residuals.
            assert!(off < 0.03 * most, "{name}, {reading:?}: {most} m");
            assert!(by[pulled.cable] > 0.97 * most, "{name}, {reading:?}");
        }
    }
}

/// Errors as large as stated are found with the power that is stated, and readings without an error at the level of the
/// test. The numbers found are binomial: each of the figures is off by `LIMIT` standard deviations with a probability
/// below 1e-5 for a correct program.
#[test]
fn an_error_of_the_smallest_detectable_size_is_detected_with_the_stated_power() {
    const LIMIT: f64 = 4.5;
    const RUNS: u64 = 300;
    let test = DetectionTest {
        level: 0.05,
        power: DetectionTest::USUAL_POWER,
    };
    let kinds = [
        ObservationKind::Length(1),
        ObservationKind::Tension(1),
        ObservationKind::Laser,
    ];
    for kind in kinds {
        let (mut found, mut false_alarms, mut runs) = (0.0, 0.0, 0.0);
        for seed in 0..RUNS {
            let run = run_of("mini", 14, 5000 + seed);
            let reading = |dataset: &Dataset| {
                let problem = Problem::new(dataset).unwrap();
                let analysis = Analysis::new(&problem, &solved(&problem));
                let of_kind = |r: &&Observation| r.kind == kind && r.row == 6;
                *analysis.observations.iter().find(of_kind).unwrap()
            };
            let without = reading(&run.dataset);
            let error = without.reliability(test).unwrap().smallest_error / without.sd;
            let with = reading(&with_error(&run.dataset, &without, error));
            let is_found = |r: Observation| {
                let size = r.normalised().unwrap();
                f64::from(u8::from(normal_two_sided(size) < test.level))
            };
            found += is_found(with);
            false_alarms += is_found(without);
            runs += 1.0;
        }
        for (count, share) in [(found, test.power), (false_alarms, test.level)] {
            let away = (count - share * runs) / (runs * share * (1.0 - share)).sqrt();
            assert!(away.abs() < LIMIT, "{kind:?}: {count} of {runs}, {share}");
        }
    }
}

/// The readings of poses, by SIMD lanes, are those of the linearisation, by dense matrices.
#[test]
fn the_analysis_agrees_with_the_linearisation() {
    for name in presets::NAMES {
        let run = run_of(name, 15, 33);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        let analysis = Analysis::new(&problem, &solution);
        let linear = Linearisation::new(&problem, &solution);
        let information = linear.design.tr_mul(&linear.design);
        let covariance = information.try_inverse().unwrap();
        let mut compared = 0;
        for pose in &linear.poses {
            for (k, row) in pose.rows.clone().enumerate() {
                let RowKind::Observation(kind) = linear.rows[row].kind else {
                    panic!("a pose has no priors");
                };
                let is_same = |one: &&Observation| one.row == pose.row && one.kind == kind;
                let one = analysis.observations.iter().find(is_same).unwrap();
                let design = linear.design.row(row).transpose();
                let fitted = design.dot(&(&covariance * &design));
                let redundancy = pose.remainder.row(k).norm_squared() - fitted;
                // Latent tensions come from another number of passes.
                let off = one.standardised - linear.residual[row];
                assert!(off.abs() < 1e-3, "{name}, {one:?}: {off:e}");
                let off = one.redundancy.unwrap() - redundancy;
                assert!(off.abs() < 1e-3, "{name}, {one:?}: {off:e}");
                assert!((one.sd / linear.rows[row].sd - 1.0).abs() < 1e-12, "{name}");
                compared += 1;
            }
        }
        assert!(compared > 60, "{name}: {compared} readings");
    }
}
