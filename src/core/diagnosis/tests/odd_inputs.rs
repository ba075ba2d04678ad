//! Unusual input: the diagnosis returns a consistent result or an error message, and never panics.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::{Diagnosis, DiagnosisOptions, diagnose};
use super::{diagnosed, run_of, run_with, setting};
use crate::effect::EffectSetting;
use crate::estimation::{Control, EstimationError, Problem};
use crate::measurement::{Dataset, Grid};
use crate::robot::{PerAxis, presets};

/// Checks that a diagnosis is consistent.
fn check(diagnosis: &Diagnosis) {
    assert!(!diagnosis.cancelled);
    check_parts(diagnosis);
}

/// Checks properties that an interrupted diagnosis has, too.
fn check_parts(diagnosis: &Diagnosis) {
    let is_probability = |p: f64| (0.0..=1.0).contains(&p);
    for adequacy in [&diagnosis.base, &diagnosis.extended] {
        assert!(adequacy.global.chi2.is_finite());
        assert!(is_probability(adequacy.global.p_value));
        assert!(adequacy.groups.iter().all(|g| is_probability(g.p_value)));
    }
    assert!(
        diagnosis.base.global.chi2 + 1e-6 >= diagnosis.extended.global.chi2
            || diagnosis.findings.is_empty()
    );
    for finding in &diagnosis.findings {
        assert!(is_probability(finding.evidence.p_value));
        let others = finding.alternatives.iter().map(|other| other.probability);
        let exclusive: Vec<f64> = others.chain([finding.probability]).collect();
        assert!(
            exclusive.iter().all(|p| is_probability(*p)),
            "{exclusive:?}"
        );
        assert!(exclusive.iter().sum::<f64>() < 1.0 + 1e-9, "{exclusive:?}");
        assert!(finding.parameters.iter().all(|p| p.value.is_finite()));
        assert!(!finding.sentence.contains("NaN"), "{}", finding.sentence);
    }
    for invisible in &diagnosis.invisible {
        assert!(
            invisible
                .smallest_visible
                .is_none_or(|s| s.is_finite() && s > 0.0)
        );
    }
}

/// Checks the diagnosis of data without hidden effects, which have a finding with a probability below 0.01.
fn check_clean(dataset: &Dataset) {
    let diagnosis = diagnosed(dataset);
    check(&diagnosis);
    let found: Vec<_> = diagnosis.findings.iter().map(|f| &f.sentence).collect();
    assert!(found.is_empty(), "{found:?}");
}

fn clean(name: &str, poses: usize) -> Dataset {
    run_with(name, poses, 81, &[]).dataset
}

#[test]
fn few_poses() {
    for poses in [1, 2, 3, 6] {
        check_clean(&clean("mini", poses));
    }
    let one = diagnosed(&clean("mini", 1));
    assert!(2 * one.invisible.len() > one.readable, "few would show");
}

#[test]
fn no_pose_at_all_is_an_error() {
    let mut dataset = clean("mini", 1);
    dataset.measurements = dataset.measurements.select(&[0]);
    let answer = diagnose(&dataset, &DiagnosisOptions::default(), &mut |_| {
        Control::Continue
    });
    assert!(matches!(answer, Err(EstimationError::NoPoses)));
}

#[test]
fn without_laser() {
    let mut dataset = clean("mini", 25);
    dataset.robot.laser = None;
    dataset.measurements.laser_m.clear();
    check_clean(&dataset);
}

/// Effects are listed as invisible if these poses do not reveal them, but not if the robot has no instrument for them.
#[test]
fn only_effects_of_present_instruments_are_listed_as_invisible() {
    let mut dataset = clean("mini", 25);
    let ids = |dataset: &Dataset| -> Vec<_> {
        let invisible = diagnosed(dataset).invisible;
        invisible.iter().map(|i| i.cause.effect().id()).collect()
    };
    let with_all = ids(&dataset);
    for id in ["swivel_offset", "heading_offset", "inclinometer_tilt"] {
        assert!(!with_all.contains(&id), "{id}");
    }
    assert!(with_all.contains(&"laser_bias"), "{with_all:?}");
    dataset.measurements.laser_m.clear();
    dataset.measurements.force_n = Grid::default();
    // Without tension limits, tensions are not estimated either.
    dataset.robot.limits = None;
    let without = ids(&dataset);
    let prefixes = ["laser", "target", "force", "payload", "pulley_friction"];
    for id in &without {
        assert!(!prefixes.iter().any(|p| id.starts_with(p)), "{id}");
    }
    assert!(!without.is_empty());
}

#[test]
fn without_force_sensors() {
    let mut preset = presets::find("mini").unwrap();
    for cable in &mut preset.robot.cables {
        cable.force_sensor = None;
    }
    check_clean(&run_of(&preset, 25, 82, &[]).dataset);
}

#[test]
fn absolute_lengths() {
    let mut preset = presets::find("mini").unwrap();
    preset.robot.home = None;
    check_clean(&run_of(&preset, 25, 83, &[]).dataset);
}

#[test]
fn readings_missing_here_and_there() {
    let mut dataset = clean("mini", 30);
    let data = &mut dataset.measurements;
    for row in 1..data.len() {
        if row % 3 == 0 {
            data.laser_m[row] = f64::NAN;
        }
        if row % 4 == 1 {
            data.revolutions.set(row, row % 8, f64::NAN);
        }
        if row % 7 == 2 {
            data.force_n.set(row, (row + 3) % 8, f64::NAN);
        }
        if row % 5 == 0 {
            data.time_s[row] = f64::NAN;
            data.temperature_c[row] = f64::NAN;
        }
    }
    check_clean(&dataset);
}

#[test]
fn no_tension_was_read_at_some_poses() {
    let mut dataset = clean("mini", 25);
    for row in [3, 4, 17] {
        for cable in 0..8 {
            dataset.measurements.force_n.set(row, cable, f64::NAN);
        }
    }
    check_clean(&dataset);
}

/// Poses with fewer readings than unknowns, or none.
#[test]
fn few_cells_or_none_were_read_at_some_poses() {
    for name in ["mini", "planar"] {
        let mut dataset = clean(name, 40);
        let data = &mut dataset.measurements;
        for (left, row) in (5..12).enumerate() {
            for cable in 0..data.revolutions.columns() {
                data.force_n.set(row, cable, f64::NAN);
                if cable >= left {
                    data.revolutions.set(row, cable, f64::NAN);
                }
            }
            data.laser_m[row] = f64::NAN;
        }
        check_clean(&dataset);
    }
}

#[test]
fn without_time_temperature_and_commanded_poses() {
    let mut dataset = clean("mini", 25);
    dataset.measurements.time_s.clear();
    dataset.measurements.temperature_c.clear();
    dataset.measurements.commanded.clear();
    check_clean(&dataset);
}

#[test]
fn the_other_presets() {
    for name in ["planar", "suspended", "hall"] {
        check_clean(&clean(name, 15));
    }
}

#[test]
fn twelve_cables() {
    let mut preset = presets::find("mini").unwrap();
    for k in 0..4 {
        let mut cable = preset.robot.cables[k].clone();
        cable.name = format!("cable-{}", k + 9);
        cable.pulley.entry_point_m[0] *= 0.6;
        cable.pulley.entry_point_m[2] *= 0.8;
        preset.robot.cables.push(cable);
    }
    check_clean(&run_of(&preset, 25, 84, &[]).dataset);
}

fn on_cable_3(scale: f64) -> EffectSetting {
    setting("winch_scale", &["cable-3"], &[("scale", scale)])
}

/// An effect that the model already has is not found again.
#[test]
fn a_held_effect_in_the_model() {
    let mut dataset = run_with("mini", 30, 85, &[on_cable_3(0.02)]).dataset;
    dataset.robot.effects.push(on_cable_3(0.02));
    check_clean(&dataset);
    dataset.robot.effects[0] = setting("cable_swap", &["cable-1", "cable-2"], &[]);
    check(&diagnosed(&dataset));
}

/// Without prior knowledge the data leave directions undetermined.
#[test]
fn an_undetermined_robot() {
    let mut dataset = clean("mini", 12);
    for cable in &mut dataset.robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::default();
    }
    if let Some(laser) = &mut dataset.robot.laser {
        laser.target_plane.offset_sd_m = None;
    }
    check(&diagnosed(&dataset));
}

/// With exact prior knowledge only the poses remain to be fitted.
#[test]
fn a_robot_that_is_known_exactly() {
    let mut preset = presets::find("mini").unwrap();
    // Without tension limits, tensions are not estimated.
    preset.robot.limits = None;
    for cable in &mut preset.robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::known(0.0);
        cable.force_sensor = None;
    }
    if let Some(laser) = &mut preset.robot.laser {
        laser.target_plane.offset_sd_m = Some(0.0);
    }
    if let Some(home) = &mut preset.robot.home {
        (home.position_sd_m, home.orientation_sd_rad) = (0.0, 0.0);
    }
    let dataset = run_of(&preset, 15, 87, &[]).dataset;
    assert!(Problem::new(&dataset).unwrap().parameters().is_empty());
    check_clean(&dataset);
}

#[test]
fn nothing_but_lengths() {
    let mut preset = presets::find("planar").unwrap();
    preset.robot.laser = None;
    for cable in &mut preset.robot.cables {
        cable.force_sensor = None;
    }
    let mut dataset = run_of(&preset, 15, 86, &[]).dataset;
    dataset.measurements.force_n = Grid::default();
    check_clean(&dataset);
}

#[test]
fn the_same_pose_over_and_over() {
    let dataset = clean("mini", 3);
    let rows = [0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2];
    let mut measurements = dataset.measurements.select(&rows);
    for (row, label) in measurements.labels.iter_mut().enumerate() {
        *label = row as i64;
    }
    let repeated = Dataset {
        measurements,
        ..dataset
    };
    check(&diagnosed(&repeated));
}

#[test]
fn a_table_that_was_appended_twice_tells_no_more_than_once() {
    let once = run_with("mini", 12, 89, &[on_cable_3(0.02)]).dataset;
    let rows: Vec<usize> = (0..once.measurements.len()).collect();
    let mut twice = once.clone();
    twice.measurements = once.measurements.select(&[rows.clone(), rows].concat());
    for (row, label) in twice.measurements.labels.iter_mut().enumerate() {
        *label = row as i64;
    }
    let [once, twice] = [once, twice].map(|dataset| diagnosed(&dataset));
    let test = |diagnosis: &Diagnosis| {
        let global = &diagnosis.base.global;
        (global.chi2, global.degrees_of_freedom)
    };
    assert_eq!(test(&once), test(&twice));
}

/// Random faults of machines, cables and tables, on random robots; every third diagnosis is interrupted.
#[test]
fn probabilities_lie_between_0_and_1_whatever_was_measured() {
    let mut rng = ChaCha8Rng::seed_from_u64(88);
    for case in 0..12 {
        let name = ["mini", "planar", "suspended", "hall"][case % 4];
        let poses = rng.random_range(2..14);
        let scale = rng.random_range(-0.1..0.1);
        let mut dataset = run_with(name, poses, case as u64, &[on_cable_3(scale)]).dataset;
        let data = &mut dataset.measurements;
        let rows = data.len();
        for _ in 0..rng.random_range(0..3) {
            let (row, cable) = (rng.random_range(1..rows), rng.random_range(0..3));
            let turns = &mut data.revolutions;
            match rng.random_range(0..6) {
                0 => turns.set(row, cable, f64::NAN),
                1 => turns.set(row, cable, 1e3 * turns.get(row, cable)),
                2 => (0..rows).for_each(|row| turns.set(row, cable, -turns.get(row, cable))),
                3 => (0..rows).for_each(|row| turns.set(row, cable, 0.5)),
                4 => (0..turns.columns()).for_each(|k| turns.set(row, k, turns.get(1, k))),
                _ => (row..rows).for_each(|row| turns.set(row, cable, 1.0 + turns.get(row, cable))),
            }
        }
        let mut left = match case % 3 {
            0 => rng.random_range(1..200),
            _ => u32::MAX,
        };
        let options = DiagnosisOptions::default();
        let answer = diagnose(&dataset, &options, &mut |_| {
            left = left.saturating_sub(1);
            match left {
                0 => Control::Cancel,
                _ => Control::Continue,
            }
        });
        // What cannot be fitted at all is an error.
        answer.iter().for_each(check_parts);
    }
}
