//! Hypotheses of the user compete with the catalogue, and do not outweigh it.

use super::{diagnosed, found, run_of, run_with, setting};
use crate::diagnosis::{Verdict, single_causes};
use crate::effect::{CROSSTALK, EffectSetting, Hypothesis, find};
use crate::measurement::Dataset;
use crate::robot::presets;

/// Formulas of other physics: quantity, its formula, unit and largest typical size of the parameter `size`.
const IRRELEVANT: [(&str, &str, &str, &str); 10] = [
    (
        "paid",
        "paid + size * sin(3 * pi * drum_revolutions)",
        "m",
        "0.001",
    ),
    ("paid", "paid + size * paid_of(previous)", "1", "0.01"),
    ("paid", "paid + size * direction * tension", "m/N", "1e-5"),
    (
        "paid",
        "paid * (1 + size * temperature ^ 2)",
        "1/K^2",
        "1e-4",
    ),
    ("strain", "strain + size * sin(time / 300 [s])", "1", "1e-3"),
    ("tension", "tension * (1 + size * wrap)", "1", "0.05"),
    ("tension", "tension + size * time", "N/h", "20"),
    ("radius", "radius * (1 + size * swivel)", "1", "0.1"),
    ("anchor_z", "anchor_z + size * tension", "m/N", "1e-4"),
    (
        "entry_shift_x",
        "entry_shift_x + size * time",
        "m/h",
        "0.01",
    ),
];

fn hypothesis(text: &str) -> Hypothesis {
    Hypothesis::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn irrelevant() -> Vec<String> {
    let numbered = IRRELEVANT.iter().enumerate();
    let text = |(k, (quantity, formula, unit, largest)): (usize, &(&str, &str, &str, &str))| {
        format!(
            "id = \"other_{k}\"\ntitle = \"Other physics\"\nscope = \"cable\"\n\
             cause = \"{{cable}} has {{size}} of it.\"\nworkshop = \"Look.\"\nprior = 1\n\
             [parameters.size]\nunit = \"{unit}\"\ntypical = [{}, {largest}]\n\
             [change]\n{quantity} = \"{formula}\"\n",
            0.1 * largest.parse::<f64>().unwrap()
        )
    };
    numbered
        .map(|one| hypothesis(&text(one)).text().to_owned())
        .collect()
}

/// A run of the MINI robot that knows a hypothesis and has its effect.
fn hidden(text: &str, effect: EffectSetting, seed: u64) -> Dataset {
    let mut preset = presets::find("mini").unwrap();
    preset.robot.add_hypothesis(&hypothesis(text)).unwrap();
    run_of(&preset, 40, seed, &[effect]).dataset
}

fn crosstalk() -> Dataset {
    let effect = setting("encoder_crosstalk", &["cable-3"], &[("share", 0.01)]);
    hidden(CROSSTALK, effect, 5)
}

#[test]
fn a_cause_outside_the_catalogue_is_named_with_its_hypothesis() {
    let dataset = crosstalk();
    let diagnosis = diagnosed(&dataset);
    assert_eq!(found(&diagnosis), [("encoder_crosstalk", vec![2])]);
    assert_eq!(diagnosis.findings[0].verdict(), Verdict::Named);
    let cause = diagnosis.findings[0].cause().unwrap();
    assert!((cause.instances[0].values[0] - 0.01).abs() < 3e-3);
    assert!(diagnosis.extended.adequate);
}

#[test]
fn among_ten_others_it_is_still_named() {
    let mut dataset = crosstalk();
    dataset.robot.hypotheses.extend(irrelevant());
    assert_eq!(
        found(&diagnosed(&dataset)),
        [("encoder_crosstalk", vec![2])]
    );
}

#[test]
fn a_pair_of_cables_is_searched() {
    let text = CROSSTALK
        .replace("\"cable\"", "\"cable_pair\"")
        .replace("next", "other");
    let cables = ["cable-2", "cable-6"];
    let effect = setting("encoder_crosstalk", &cables, &[("share", 0.01)]);
    let dataset = hidden(&text, effect, 6);
    assert_eq!(
        found(&diagnosed(&dataset)),
        [("encoder_crosstalk", vec![1, 5])]
    );
}

/// Each of the ten asks for all of the prior; together they get the share that is granted.
#[test]
fn ten_irrelevant_hypotheses_change_no_verdict() {
    let faults: [&[EffectSetting]; 5] = [
        &[],
        &[setting("winch_scale", &["cable-3"], &[("scale", 0.02)])],
        &[setting(
            "cable_slip",
            &["cable-1"],
            &[("step", 0.012), ("pose", 16.0)],
        )],
        &[setting("force_bias", &["cable-5"], &[("bias", 20.0)])],
        &[setting("laser_scale", &[], &[("scale", 0.006)])],
    ];
    let mut named = 0;
    for (effects, seed) in faults.iter().zip(31..) {
        let mut dataset = run_with("mini", 25, seed, effects).dataset;
        let without = diagnosed(&dataset);
        dataset.robot.hypotheses = irrelevant();
        let with = diagnosed(&dataset);
        assert_eq!(found(&with), found(&without), "{effects:?}");
        assert_eq!(with.base.adequate, without.base.adequate);
        for (one, other) in with.findings.iter().zip(&without.findings) {
            assert_eq!(one.verdict(), other.verdict(), "{effects:?}");
        }
        named += found(&with).len();
    }
    assert_eq!(named, 4);
}

#[test]
fn an_effect_alone_is_weighed_on_each_target_and_at_the_best_place() {
    let dataset = crosstalk();
    let crosstalk = dataset.robot.effect("encoder_crosstalk").unwrap();
    let found = single_causes(&dataset, crosstalk).unwrap();
    assert_eq!(found.len(), dataset.robot.cable_count());
    let [first, second] = [&found[0], &found[1]];
    assert_eq!(first.cause.cables(), [2]);
    assert!(
        first.log_odds > second.log_odds + 3.0,
        "{first:?} {second:?}"
    );
    let share = first.cause.instances[0].values[0];
    // Within a third, as a linear estimate beside noise of a tenth.
    assert!((0.007..0.013).contains(&share), "{share}");
    // An event is placed at its pose.
    let slip = setting(
        "cable_slip",
        &["cable-2"],
        &[("step", 0.02), ("pose", 15.0)],
    );
    let dataset = run_with("mini", 40, 7, &[slip]).dataset;
    let found = single_causes(&dataset, find("cable_slip").unwrap()).unwrap();
    let bound = &found[0].cause.instances[0];
    assert_eq!(bound.cables, [1]);
    let pose = bound.values[bound.effect.pose_parameter().unwrap()];
    assert!((pose - 15.0).abs() <= 1.0, "{pose}");
}
