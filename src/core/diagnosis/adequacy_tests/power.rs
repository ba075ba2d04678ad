//! Hidden effects show in the readings and along the variables where they act.

use super::super::noise::noise_statements;
use super::*;

#[test]
fn an_eccentric_drum_shows_along_its_turn() {
    let hidden = setting(
        "drum_eccentricity",
        &["cable-3"],
        &[("amplitude", 0.001), ("phase", 0.7)],
    );
    let run = run_with("mini", 60, 21, &[hidden]);
    let found = Fitted::new(&run.dataset).discrepancies(0.01);
    let first = &found[0];
    assert_eq!((first.quantity, first.cable), (Quantity::Length, Some(2)));
    assert_eq!(first.variable, Variable::DrumFraction);
    assert!(first.rms_over_sd > 1.2 && first.points.len() == 60);
}

#[test]
fn a_drift_of_the_laser_shows_along_time() {
    let hidden = setting("laser_drift", &[], &[("drift", 0.004)]);
    let run = run_with("mini", 60, 22, &[hidden]);
    let found = Fitted::new(&run.dataset).discrepancies(0.01);
    assert_eq!((found[0].quantity, found[0].cable), (Quantity::Laser, None));
    // The simulated hall warms up steadily, so temperature is as good a predictor as time.
    let first = found[0].variable;
    assert!(
        matches!(first, Variable::Time | Variable::Temperature),
        "{first:?}"
    );
    assert!(found.iter().any(|d| d.variable == Variable::Time));
}

#[test]
fn noise_of_the_laser_is_distinguished_from_structure() {
    let mut run = run_with("mini", 60, 23, &[]);
    if let Some(laser) = &mut run.dataset.robot.laser {
        laser.sd_m /= 2.1;
    }
    let fitted = Fitted::new(&run.dataset);
    let structure = fitted.discrepancies(0.01);
    assert!(structure.is_empty(), "{:?}", structure[0].variable);
    let found = noise_statements(&fitted.space, &structure, 0.01);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].quantity, found[0].cable), (Quantity::Laser, None));
    let [low, high] = found[0].interval;
    assert!(low < 2.1 && 2.1 < high && found[0].ratio > low, "{found:?}");
}

#[test]
fn noise_of_one_force_sensor_is_distinguished_from_the_others() {
    let mut run = run_with("mini", 60, 24, &[]);
    for cable in &mut run.dataset.robot.cables {
        if let (Some(sensor), true) = (&mut cable.force_sensor, cable.name == "cable-5") {
            sensor.tension_sd_n /= 3.0;
        }
    }
    let fitted = Fitted::new(&run.dataset);
    let found = noise_statements(&fitted.space, &[], 0.01);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0].quantity, found[0].cable),
        (Quantity::Tension, Some(4))
    );
    let [low, high] = found[0].interval;
    assert!(low < 3.0 && 3.0 < high, "{found:?}");
}

#[test]
fn noise_smaller_than_described_is_reported() {
    let mut run = run_with("mini", 60, 25, &[]);
    for cable in &mut run.dataset.robot.cables {
        if let Some(sensor) = &mut cable.force_sensor {
            sensor.tension_sd_n *= 2.0;
        }
    }
    let fitted = Fitted::new(&run.dataset);
    let found = noise_statements(&fitted.space, &fitted.discrepancies(0.01), 0.01);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0].quantity, found[0].cable),
        (Quantity::Tension, None)
    );
    let [low, high] = found[0].interval;
    assert!(low < 0.5 && 0.5 < high, "{found:?}");
}

#[test]
fn structure_is_not_called_noise() {
    let hidden = setting("laser_drift", &[], &[("drift", 0.005)]);
    let run = run_with("mini", 60, 26, &[hidden]);
    let fitted = Fitted::new(&run.dataset);
    let structure = fitted.discrepancies(0.01);
    assert!(!structure.is_empty());
    let found = noise_statements(&fitted.space, &structure, 0.01);
    assert!(
        found.iter().all(|n| n.quantity != Quantity::Laser),
        "{found:?}"
    );
}

#[test]
fn structure_of_one_cable_is_not_called_noise_of_the_others() {
    let hidden = [
        setting("laser_drift", &[], &[("drift", 0.004)]),
        setting(
            "drum_eccentricity",
            &["cable-3"],
            &[("amplitude", 0.001), ("phase", 0.7)],
        ),
    ];
    let run = run_with("mini", 40, 27, &hidden);
    let fitted = Fitted::new(&run.dataset);
    let structure = fitted.discrepancies(0.01);
    let of = |quantity, cable| {
        let same = |d: &&Discrepancy| (d.quantity, d.cable) == (quantity, cable);
        structure.iter().find(same).map(|d| d.variable)
    };
    assert_eq!(of(Quantity::Length, Some(2)), Some(Variable::DrumFraction));
    assert!(of(Quantity::Laser, None).is_some());
    assert_eq!(noise_statements(&fitted.space, &structure, 0.01), []);
}
