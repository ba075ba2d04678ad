//! Changes of the ports by the effects, against numbers worked out by hand from the formulas of the table.

use super::slopes::ports_after;
use crate::effect::{CablePorts, Dual, EffectSetting, PlatformPorts, find};
use crate::robot::presets;
use crate::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

fn after(id: &str, values: &[f64]) -> (CablePorts, PlatformPorts) {
    let values: Vec<Dual> = values.iter().map(|v| Dual::constant(*v)).collect();
    ports_after(find(id).unwrap(), &values)
}

fn near(found: Dual, expected: f64) {
    let allowed = 1e-9 * expected.abs();
    assert!(
        (found.value - expected).abs() <= allowed,
        "{} instead of {expected}",
        found.value
    );
}

/// Cable paid out 0.4 m, 120 N against a mean of 80 N, reeled in, 1200 s and 3 K after home.
#[test]
fn lengths_and_strains() {
    near(after("winch_backlash", &[0.002]).0.paid, 0.4 - 0.001);
    near(after("encoder_drift", &[0.006]).0.paid, 0.4 + 0.002);
    near(after("cable_slip", &[0.01, 41.0]).0.paid, 0.41);
    near(after("cable_slip", &[0.01, 42.0]).0.paid, 0.4);
    near(after("cable_thermal", &[2e-5]).0.strain, 6e-5);
    // ln(1 + 1200/600) = ln 3.
    near(after("cable_creep", &[1e-3]).0.strain, 1.098_612_288_668e-3);
    // 1 + 0.2 (120/80 - 1) = 1.1, on 1/40000 N.
    near(after("cable_stiffening", &[0.2]).0.compliance, 2.75e-5);
    near(after("cable_sag", &[0.5]).0.weight, 0.8);
    // 2.3 revolutions of the motor, a quarter of that of the drum: sin(207 degrees).
    near(
        after("drum_eccentricity", &[1e-3, 0.0]).0.paid,
        0.4 - 4.539_904_997_395e-4,
    );
}

#[test]
fn tensions() {
    // exp(-0.02 * 1.3), reeled in: less at the platform.
    near(
        after("pulley_friction", &[0.02]).0.tension,
        120.0 * 0.974_335_089_6,
    );
    near(after("force_gain", &[0.2]).0.tension, 100.0);
    near(after("force_bias", &[10.0]).0.tension, 115.0);
}

#[test]
fn geometry() {
    let shift = after("frame_compliance", &[1e-5]).0.entry_shift;
    for (found, expected) in shift.into_iter().zip([7.2e-4, -3.6e-4, 1.2e-4]) {
        near(found, expected);
    }
    let shift = after("frame_thermal", &[1e-5]).0.entry_shift;
    for (found, expected) in shift.into_iter().zip([3e-5, -6e-5, 9e-5]) {
        near(found, expected);
    }
    let shift = after("frame_shift", &[0.01, 0.02, 0.03, 42.0])
        .0
        .entry_shift;
    assert!(shift.iter().all(|s| s.value == 0.0));
    near(
        after("frame_shift", &[0.01, 0.02, 0.03, 41.0])
            .0
            .entry_shift[2],
        0.03,
    );
    // The axis of cable 3 points down; across it x and -y.
    let axis = after("pulley_axis_tilt", &[0.1, 0.0]).0.axis;
    near(axis[1], 0.1_f64.sin());
    near(axis[2], -(0.1_f64.cos()));
    let axis = after("pulley_axis_tilt", &[0.0, 0.1]).0.axis;
    near(axis[0], 0.1_f64.sin());
}

#[test]
fn platform_and_its_instruments() {
    near(after("payload_mass", &[0.2]).1.mass, 3.0);
    near(
        after("payload_com", &[0.0, 0.02, 0.0]).1.center_of_mass[1],
        0.02,
    );
    // 1 - exp(-1200/900).
    near(
        after("laser_drift", &[0.001]).1.laser_bias,
        7.364_028_618_842e-4,
    );
    // 0.47 m at a period of 0.1 m: 4.7 turns, sin(252 degrees).
    near(
        after("laser_cyclic", &[1e-3, 0.1, 0.0]).1.laser_bias,
        -9.510_565_162_952e-4,
    );
    near(after("heading_offset", &[0.5]).1.inclination_offset[2], 0.5);
    // A sensor tilted about x on a platform that is level and turned by 90 degrees shows it as pitch.
    let effect = find("inclinometer_tilt").unwrap();
    let robot = presets::find("mini").unwrap().robot;
    let mut ports = PlatformPorts::nominal(&robot);
    let mut at = super::slopes::at_platform();
    at.inclination_rad = [0.0, 0.01, std::f64::consts::FRAC_PI_2];
    let tilt = [0.01, 0.0].map(Dual::constant);
    (effect.change_platform)(&tilt, &at, &mut ports);
    let [roll, pitch, yaw] = ports.inclination_offset.map(|o| o.value);
    assert!((pitch - 0.01).abs() < 1e-12 && roll.abs() < 1e-12 && yaw.abs() < 1e-12);
}

fn run_with(effects: Vec<EffectSetting>) -> Simulated {
    let preset = presets::find("mini").unwrap();
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects,
        ..SimulationOptions::new(6, 2)
    };
    simulate(&preset.robot, &options).unwrap()
}

fn hidden(effect: &str, targets: &[&str], parameters: &[(&str, f64)]) -> Simulated {
    run_with(vec![EffectSetting {
        effect: effect.to_owned(),
        targets: targets.iter().map(|t| (*t).to_owned()).collect(),
        parameters: parameters
            .iter()
            .map(|(k, v)| ((*k).to_owned(), *v))
            .collect(),
    }])
}

/// Readings of simulated data change by the formulas: the true poses are the same with and without.
#[test]
fn simulated_readings_change_by_the_formulas() {
    let plain = run_with(Vec::new());
    let robot = &plain.dataset.robot;
    let per_revolution = robot.cables[0].winch.cable_per_revolution_m();
    let before = &plain.dataset.measurements;
    let slipped = hidden("cable_slip", &["cable-1"], &[("step", 0.01), ("pose", 4.0)]);
    let gained = hidden("force_gain", &[], &[("change", 0.1)]);
    let biased = hidden("force_bias", &["cable-2"], &[("bias", 7.0)]);
    let drifted = hidden("encoder_drift", &["cable-1"], &[("rate", 0.006)]);
    let warmed = hidden("laser_drift", &[], &[("drift", 0.002)]);
    let cyclic = hidden(
        "laser_cyclic",
        &[],
        &[("amplitude", 1e-3), ("period", 0.1), ("phase", 0.5)],
    );
    let one = |run: &Simulated, row: usize| run.dataset.measurements.revolutions.get(row, 0);
    let near = |found: f64, expected: f64| {
        assert!(
            (found - expected).abs() < 1e-9,
            "{found} instead of {expected}"
        );
    };
    for row in 1..7 {
        let paid = (one(&slipped, row) - one(&plain, row)) * per_revolution;
        near(paid, if row >= 4 { -0.01 } else { 0.0 });
        let paid = (one(&drifted, row) - one(&plain, row)) * per_revolution;
        near(paid, -0.006 * 30.0 * row as f64 / 3600.0);
        let force = |run: &Simulated, cable| run.dataset.measurements.force_n.get(row, cable);
        near(force(&gained, 3), 1.1 * force(&plain, 3));
        near(force(&biased, 1), force(&plain, 1) + 7.0);
        near(force(&biased, 0), force(&plain, 0));
        let laser = |run: &Simulated| run.dataset.measurements.laser_m[row];
        let drift = 0.002 * (1.0 - (-30.0 * row as f64 / 900.0).exp());
        near(laser(&warmed) - before.laser_m[row], drift);
        let angle = std::f64::consts::TAU * laser(&cyclic) / 0.1 + 0.5;
        near(laser(&cyclic) - before.laser_m[row], 1e-3 * angle.sin());
    }
}

#[test]
fn wrong_readings_are_wrong_where_they_should_be() {
    let plain = run_with(Vec::new());
    let before = &plain.dataset.measurements;
    let per_revolution = plain.dataset.robot.cables[0].winch.cable_per_revolution_m();
    let spot = hidden("laser_outliers", &[], &[("pose", 3.0), ("error", 0.05)]);
    let jump = hidden(
        "encoder_outlier",
        &["cable-2"],
        &[("pose", 2.0), ("error", 0.03)],
    );
    let swap = hidden("cable_swap", &["cable-1", "cable-4"], &[]);
    for row in 0..7 {
        let laser = spot.dataset.measurements.laser_m[row] - before.laser_m[row];
        assert!((laser - if row == 3 { 0.05 } else { 0.0 }).abs() < 1e-15);
        for cable in 0..8 {
            let change = jump.dataset.measurements.revolutions.get(row, cable)
                - before.revolutions.get(row, cable);
            let expected = if (row, cable) == (2, 1) { 0.03 } else { 0.0 };
            assert!((change * per_revolution - expected).abs() < 1e-14);
            let from = match cable {
                0 => 3,
                3 => 0,
                other => other,
            };
            let swapped = swap.dataset.measurements.revolutions.get(row, cable);
            assert_eq!(swapped, before.revolutions.get(row, from));
        }
    }
}
