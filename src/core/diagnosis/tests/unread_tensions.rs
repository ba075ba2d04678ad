//! Effects that act through tensions are also found without force sensors, if the mass and the tension limits are
//! described.

use super::*;
use crate::effect::EffectSetting;
use crate::measurement::Grid;

/// A run without force readings.
fn unread(name: &str, seed: u64, effects: &[EffectSetting]) -> Dataset {
    let mut dataset = run_with(name, 40, seed, effects).dataset;
    for cable in &mut dataset.robot.cables {
        cable.force_sensor = None;
    }
    dataset.measurements.force_n = Grid::default();
    dataset
}

#[test]
fn stretch_and_sag_are_seen_without_force_sensors() {
    let softer = setting("cable_stiffness", &[], &[("change", -0.4)]);
    let heavier = setting("cable_sag", &[], &[("weight", 4.0)]);
    for (effect, seed) in [(softer, 41), (heavier, 42)] {
        let diagnosis = diagnosed(&unread("suspended", seed, std::slice::from_ref(&effect)));
        let listed: Vec<_> = diagnosis.findings.iter().flat_map(names).collect();
        assert!(
            listed.contains(&(effect.effect.as_str(), vec![])),
            "{listed:?}"
        );
    }
}

/// At the default level the probability of a finding in ten clean datasets is below 0.1, of two or more below 0.005.
#[test]
fn clean_data_without_force_sensors_have_no_findings() {
    let runs = (0..10).map(|seed| (["mini", "suspended"][seed as usize % 2], 900 + seed));
    let alarms: Vec<_> = runs
        .map(|(name, seed)| found(&diagnosed(&unread(name, seed, &[]))))
        .filter(|names| !names.is_empty())
        .collect();
    assert!(alarms.len() < 2, "{alarms:?}");
}

#[test]
fn missing_sensors_have_no_faults() {
    let dataset = unread("mini", 45, &[]);
    let diagnosis = diagnosed(&dataset);
    let asked: Vec<&str> = diagnosis
        .invisible
        .iter()
        .map(|i| i.cause.effect().id())
        .collect();
    assert!(asked.contains(&"payload_com"), "{asked:?}");
    assert!(
        asked.iter().all(|id| !id.starts_with("force_")),
        "{asked:?}"
    );
}
