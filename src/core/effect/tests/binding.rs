//! Requests and settings that cannot be attached, and their messages.

use crate::effect::{BoundEffect, EffectRequest, EffectSetting};
use crate::estimation::Problem;
use crate::robot::presets;
use crate::simulation::{SimulationOptions, simulate};

fn refused(request: &str) -> String {
    let robot = presets::find("mini").unwrap().robot;
    let error = EffectRequest::parse(request)
        .and_then(|parsed| parsed.bind(&robot))
        .unwrap_err();
    error.to_string()
}

fn setting(effect: &str, targets: &[&str], parameters: &[(&str, f64)]) -> EffectSetting {
    EffectSetting {
        effect: effect.to_owned(),
        targets: targets.iter().map(|t| (*t).to_owned()).collect(),
        parameters: parameters
            .iter()
            .map(|(k, v)| ((*k).to_owned(), *v))
            .collect(),
    }
}

#[test]
fn a_missing_pose_is_an_error_in_plain_words() {
    let expected = "effect \"cable_slip\" needs a number for \"pose\", which cannot be estimated: give pose=NUMBER";
    assert_eq!(refused("cable_slip:cable-2"), expected);
    let robot = presets::find("mini").unwrap().robot;
    let model = setting("cable_slip", &["cable-2"], &[("step", 0.01)]);
    let error = BoundEffect::from_setting(&model, &robot).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn what_makes_no_sense_is_refused() {
    for (request, part) in [
        (
            "cable_slip:cable-2:pose=x",
            "found \"pose=x\", expected NAME=NUMBER",
        ),
        ("cable_slip:cable-9:pose=3", "no cable \"cable-9\""),
        (
            "cable_slip:cable-2:where=3",
            "no parameter \"where\"; it has step, pose",
        ),
        ("laser_bias:cable-2", "concerns the whole robot"),
        ("cable_swap", "no parameter that can be estimated"),
        ("laser_outliers:error=0.01", "needs a number for \"pose\""),
        ("encoder_outlier:cable-1", "needs a number for \"pose\""),
    ] {
        let message = refused(request);
        assert!(message.contains(part), "{request}: {message}");
    }
    let robot = presets::find("mini").unwrap().robot;
    for targets in [&[][..], &["cable-1"], &["cable-1", "cable-1"]] {
        let swap = setting("cable_swap", targets, &[]);
        let error = BoundEffect::from_setting(&swap, &robot).unwrap_err();
        assert!(error.to_string().contains("two different cables"));
    }
}

#[test]
fn parameters_not_given_are_neutral_in_a_model_and_start_where_they_can_be_estimated() {
    let robot = presets::find("mini").unwrap().robot;
    let sag = setting("cable_sag", &["cable-1"], &[]);
    let model = BoundEffect::from_setting(&sag, &robot).unwrap();
    let free = BoundEffect::to_estimate(&sag, &robot).unwrap();
    let parameters = model.effect.parameters();
    let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    assert_eq!(model.values, model.effect.neutral_values());
    assert_eq!(free.values, start);
    assert_ne!(free.values, model.values);
    let slip = setting("cable_slip", &["cable-2"], &[("step", 0.01)]);
    assert!(BoundEffect::to_estimate(&slip, &robot).is_err());
}

#[test]
fn given_parameters_keep_their_value() {
    let preset = presets::find("mini").unwrap();
    let run = simulate(&preset.robot, &SimulationOptions::new(3, 1)).unwrap();
    let mut problem = Problem::new(&run.dataset).unwrap();
    let request = EffectRequest::parse("cable_slip:cable-2:pose=2,step=0.003").unwrap();
    problem.free(&[request]).unwrap();
    assert_eq!(problem.free_effects[0].values, [0.003, 2.0]);
    let names: Vec<_> = problem.parameters().into_iter().map(|p| p.name).collect();
    let title = problem.free_effects[0].effect.title();
    assert!(names.contains(&format!("{title} of cable-2, step")));
    assert!(!names.iter().any(|name| name.contains(", pose")));
}

#[test]
fn a_pose_that_is_not_there_is_refused() {
    let preset = presets::find("mini").unwrap();
    for (effect, target, size) in [
        ("laser_outliers", None, "error"),
        ("encoder_outlier", Some("cable-1"), "error"),
        ("cable_slip", Some("cable-1"), "step"),
    ] {
        let targets: Vec<_> = target.into_iter().collect();
        let hidden = |pose: f64| {
            let hidden = setting(effect, &targets, &[("pose", pose), (size, 0.01)]);
            let options = SimulationOptions {
                effects: vec![hidden],
                ..SimulationOptions::new(3, 1)
            };
            simulate(&preset.robot, &options)
        };
        assert!(hidden(3.0).is_ok());
        let message = hidden(9.0).unwrap_err().to_string();
        let expected = format!("effect \"{effect}\": there is no pose labelled 9");
        assert_eq!(message, expected);
    }
}
