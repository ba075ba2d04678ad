//! Exchanged channels are corrected by a model that names them.

use std::borrow::Cow;

use crate::effect::{EffectSetting, measurements_as_modelled};
use crate::estimation::{Control, Geometry, Options, Problem, solve};
use crate::measurement::{Dataset, Measurements};
use crate::robot::{Robot, presets};
use crate::simulation::{Simulated, SimulationOptions, simulate};

/// Readings with these pairs of cables exchanged, one after the other.
fn exchanged(pairs: &[[&str; 2]]) -> Simulated {
    let preset = presets::find("mini").unwrap();
    let setting = |pair: &[&str; 2]| EffectSetting {
        effect: "cable_swap".to_owned(),
        targets: pair.map(str::to_owned).to_vec(),
        parameters: std::collections::BTreeMap::new(),
    };
    let options = SimulationOptions {
        effects: pairs.iter().map(setting).collect(),
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(20, 5)
    };
    simulate(&preset.robot, &options).unwrap()
}

fn p_value(robot: &Robot, measurements: &Measurements) -> f64 {
    let dataset = Dataset {
        robot: robot.clone(),
        measurements: measurements.clone(),
    };
    let mut problem = Problem::new(&dataset).unwrap();
    problem.geometry = Geometry::Held;
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue).unwrap();
    solution.p_value().unwrap()
}

#[test]
fn a_model_that_names_an_exchange_explains_the_readings() {
    let run = exchanged(&[["cable-2", "cable-5"]]);
    let read = &run.dataset.measurements;
    let modelled = measurements_as_modelled(&run.truth, read).unwrap();
    assert!(p_value(&run.truth, &modelled) > 1e-3);
    assert!(p_value(&run.truth, read) < 1e-9);
}

#[test]
fn exchanges_are_undone_last_first() {
    let plain = exchanged(&[]);
    let run = exchanged(&[["cable-1", "cable-2"], ["cable-2", "cable-3"]]);
    let read = &run.dataset.measurements;
    assert_ne!(read, &plain.dataset.measurements);
    let modelled = measurements_as_modelled(&run.truth, read).unwrap();
    assert_eq!(modelled.revolutions, plain.dataset.measurements.revolutions);
}

#[test]
fn without_an_exchange_nothing_is_copied() {
    let run = exchanged(&[]);
    let read = &run.dataset.measurements;
    let modelled = measurements_as_modelled(&run.truth, read).unwrap();
    assert!(matches!(modelled, Cow::Borrowed(_)));
}
