//! Effects of the model, which are estimated with every set of causes.

use super::{diagnosed, found, run_with, setting};
use crate::effect::EffectSetting;

fn scale(value: f64) -> EffectSetting {
    setting("winch_scale", &["cable-3"], &[("scale", value)])
}

fn slip(pose: f64) -> EffectSetting {
    let parameters = [("step", 0.012), ("pose", pose)];
    setting("cable_slip", &["cable-1"], &parameters)
}

/// A cause that was identified without another one is biased by it.
#[test]
fn they_are_estimated_again_with_every_cause() {
    let mut dataset = run_with("mini", 25, 31, &[scale(0.02), slip(16.0)]).dataset;
    dataset.robot.effects = vec![scale(0.011)];
    let diagnosis = diagnosed(&dataset);
    assert_eq!(found(&diagnosis), [("cable_slip", vec![0])]);
    assert!(diagnosis.extended.adequate);
    let [in_model, cause] = &diagnosis.extended_solution.globals.effects[..] else {
        panic!("an effect of the model and a cause");
    };
    assert!((in_model.values[0] - 0.02).abs() < 2e-3, "{in_model:?}");
    assert_eq!(
        cause.values,
        diagnosis.findings[0].cause().unwrap().instances[0].values
    );
}

#[test]
fn they_are_neither_found_again_nor_called_undetectable() {
    let effects = [scale(0.02), slip(16.0)];
    let mut dataset = run_with("mini", 25, 31, &effects).dataset;
    dataset.robot.effects = effects.to_vec();
    let diagnosis = diagnosed(&dataset);
    assert!(diagnosis.base.adequate && diagnosis.findings.is_empty());
    let is_in_model = |id: &str, cables: &[usize]| {
        let mut invisible = diagnosis.invisible.iter();
        invisible.any(|one| one.cause.effect().id() == id && one.cause.cables() == cables)
    };
    assert!(!is_in_model("winch_scale", &[2]));
    assert_eq!(diagnosis.held, 0);
}

#[test]
fn those_that_no_reading_depends_on_are_held() {
    let mut dataset = run_with("mini", 25, 31, &[]).dataset;
    let drift = setting("encoder_drift", &["cable-2"], &[("rate", 1e-7)]);
    dataset.robot.effects = vec![slip(99.0), drift];
    dataset.measurements.time_s.clear();
    let diagnosis = diagnosed(&dataset);
    assert!(diagnosis.held >= 1 && diagnosis.base.adequate);
    assert_eq!(diagnosis.base_solution.globals.effects[0].values[1], 99.0);
}
