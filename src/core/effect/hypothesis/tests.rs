//! Hypothesis files: their meaning, the catalogue as text, which predicts the same as the catalogue, and rejected files.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::check::SampleRow;
use super::{Hypothesis, HypothesisNotAdded, MAX_HYPOTHESIS_BYTES};
use crate::effect::{
    AsText, BoundEffect, CablePort, CablePorts, Dual, Effect, EffectError, EffectRequest,
    EffectSetting, PlatformPort, PlatformPorts, Scope, Search, Stage, every_effect, find,
};
use crate::estimation::{Control, Options, Problem, solve};
use crate::robot::{Robot, presets};
use crate::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

pub(crate) const CROSSTALK: &str = r#"
id = "encoder_crosstalk"
title = "Crosstalk between neighbouring encoders"
scope = "cable"
cause = "The encoder of {cable} picks up {share} of the revolutions of its neighbour."
workshop = "Separate the two encoder cables and ground their shields."
[parameters.share]
unit = "1"
typical = [0.001, 0.01]
[change]
paid = "paid + share * paid_of(next)"
"#;

fn mini() -> Robot {
    presets::find("mini").unwrap().robot
}

fn hypothesis(text: &str) -> Hypothesis {
    Hypothesis::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Crosstalk with another formula and parameter.
fn with_formula(formula: &str, parameter: &str) -> String {
    let text = CROSSTALK.replace("paid + share * paid_of(next)", formula);
    text.replace("unit = \"1\"\ntypical = [0.001, 0.01]", parameter)
}

fn setting(effect: &str, targets: &[&str], values: &[(&str, f64)]) -> EffectSetting {
    EffectSetting {
        effect: effect.to_owned(),
        targets: targets.iter().map(|t| (*t).to_owned()).collect(),
        parameters: values.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
    }
}

fn run(robot: &Robot, effects: Vec<EffectSetting>, poses: usize) -> Simulated {
    let preset = presets::find("mini").unwrap();
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects,
        ..SimulationOptions::new(poses, 11)
    };
    simulate(robot, &options).unwrap()
}

/// All ports after an effect on the second cable of a made-up row.
fn ports_after(effect: &'static Effect, values: &[Dual], row: usize) -> Vec<Dual> {
    let robot = mini();
    let sample = SampleRow::new(row, 8);
    let bound = BoundEffect {
        effect,
        cables: vec![1],
        targeted: true,
        values: values.iter().map(|v| v.value).collect(),
    };
    let mut cable = CablePorts::nominal(&robot.cables[1], 0.4, 120.0);
    cable.weight = Dual::constant(0.3);
    let mut platform = PlatformPorts::nominal(&robot);
    bound.change_cable(values, sample.contexts(), 1, &mut cable);
    bound.change_platform(values, sample.contexts(), &mut platform);
    let of_cable = CablePort::ALL.iter().map(|port| cable.get(*port));
    let of_platform = PlatformPort::ALL.iter().map(|port| platform.get(*port));
    of_cable.chain(of_platform).collect()
}

/// The catalogue's effects that can be written as text, with that text.
fn as_texts() -> Vec<(&'static Effect, Hypothesis)> {
    let robot = mini();
    let written = every_effect().filter_map(|e| Some((e, e.as_text(&robot).ok()?)));
    written.map(|(e, text)| (e, hypothesis(&text))).collect()
}

#[test]
fn a_hypothesis_is_an_effect() {
    let effect = hypothesis(CROSSTALK).effect();
    assert_eq!(effect.id(), "encoder_crosstalk");
    assert_eq!(effect.scope(), Scope::Cable);
    assert_eq!(effect.parameters()[0].typical, [0.001, 0.01]);
    assert!(effect.is_hypothesis() && effect.is_estimable() && !effect.is_in_motion());
    // The same text is the same effect, however often it is read.
    assert!(std::ptr::eq(effect, hypothesis(CROSSTALK).effect()));
    let other = CROSSTALK.replace("0.01]", "0.02]");
    assert!(!std::ptr::eq(effect, hypothesis(&other).effect()));

    let mut robot = mini();
    robot.add_hypothesis(&hypothesis(CROSSTALK)).unwrap();
    let stated = setting("encoder_crosstalk", &["cable-3"], &[("share", 0.0031)]);
    let bound = BoundEffect::from_setting(&stated, &robot).unwrap();
    assert_eq!(
        bound.cause(&robot),
        "The encoder of cable 3 picks up 0.31 % of the revolutions of its neighbour."
    );
    // No other robot knows it.
    let unknown = BoundEffect::from_setting(&stated, &mini()).unwrap_err();
    assert_eq!(
        unknown,
        EffectError::UnknownEffect("encoder_crosstalk".to_owned())
    );
}

#[test]
fn values_of_another_cable_are_its_readings() {
    for (selector, of) in [("next", 2), ("previous", 0), ("4", 3)] {
        let text = CROSSTALK.replace("next", selector);
        let share = [Dual::variable(0.01)];
        let row = SampleRow::new(3, 8);
        let after = ports_after(hypothesis(&text).effect(), &share, 3);
        let other = row.contexts().cables[of].paid_m;
        assert!(
            (after[0].value - (0.4 + 0.01 * other)).abs() < 1e-15,
            "{selector}"
        );
        assert!((after[0].slope - other).abs() < 1e-15);
    }
    let mut planar = presets::find("planar").unwrap().robot;
    planar
        .add_hypothesis(&hypothesis(&CROSSTALK.replace("next", "9")))
        .unwrap();
    let stated = setting("encoder_crosstalk", &["cable-1"], &[]);
    let error = BoundEffect::from_setting(&stated, &planar).unwrap_err();
    assert!(
        error.to_string().ends_with("the robot has no cable \"9\""),
        "{error}"
    );
}

#[test]
fn the_other_cable_of_a_pair_is_known() {
    let text = CROSSTALK
        .replace("\"cable\"", "\"cable_pair\"")
        .replace("next", "other");
    let mut robot = mini();
    robot.add_hypothesis(&hypothesis(&text)).unwrap();
    let stated = setting(
        "encoder_crosstalk",
        &["cable-2", "cable-4"],
        &[("share", 0.01)],
    );
    let bound = BoundEffect::from_setting(&stated, &robot).unwrap();
    let row = SampleRow::new(0, 8);
    let request = EffectRequest::parse("encoder_crosstalk:cable-2:cable-4").unwrap();
    assert_eq!(request.bind(&robot).unwrap()[0].cables, [1, 3]);
    let request = EffectRequest::parse("winch_scale:cable-2:cable-4").unwrap();
    let error = request.bind(&robot).unwrap_err().to_string();
    assert!(error.ends_with("expected one cable"), "{error}");
    for (cable, other) in [(1, 3), (3, 1)] {
        let mut ports = CablePorts::nominal(&robot.cables[cable], 0.4, 120.0);
        let values = [Dual::constant(0.01)];
        bound.change_cable(&values, row.contexts(), cable, &mut ports);
        let expected = 0.4 + 0.01 * row.contexts().cables[other].paid_m;
        assert!((ports.paid.value - expected).abs() < 1e-15);
    }
}

#[test]
fn every_effect_is_text_or_says_why_not() {
    let impossible: Vec<&str> = every_effect()
        .filter_map(|effect| match effect.as_text {
            AsText::Impossible(reason) => {
                assert!(reason.len() > 20, "{}", effect.id());
                Some(effect.id())
            }
            AsText::Formulas(_) => None,
        })
        .collect();
    assert_eq!(
        impossible,
        [
            "cable_swap",
            "pulley_axis_tilt",
            "laser_beam_tilt",
            "target_tilt",
            "inclinometer_tilt",
            "slack_cable",
            "tracker_frame",
            "tracker_tilt",
            "tracker_axes",
            "tracker_moved",
            "tape_scale",
            "tape_outlier",
            "tracker_latency",
            "tracker_clock",
            "encoder_latency",
            "force_latency",
            "laser_latency",
        ]
    );
    let error = find("cable_swap").unwrap().as_text(&mini()).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("effect \"cable_swap\" cannot be written as text: it exchanges")
    );
    assert_eq!(as_texts().len(), every_effect().count() - impossible.len());
}

#[test]
fn the_catalogue_as_text_is_the_catalogue() {
    for (effect, text) in as_texts() {
        let other = text.effect();
        let id = effect.id();
        assert_eq!(other.id(), format!("my_{id}"));
        assert_eq!(
            (other.scope(), other.search()),
            (effect.scope(), effect.search()),
            "{id}"
        );
        assert_eq!(
            (other.variable(), other.is_damage()),
            (effect.variable(), effect.is_damage())
        );
        assert_eq!(
            (other.needs_sag, other.is_in_motion()),
            (effect.needs_sag, effect.is_in_motion())
        );
        if text.definition.formulas.changes(CablePort::Paid) {
            assert_eq!(other.stage, effect.stage, "{id}");
        }
        if text.definition.formulas.changes(CablePort::Tension) {
            assert_eq!(other.stage, effect.stage, "{id}");
        }
        for (one, same) in effect.parameters().iter().zip(other.parameters()) {
            let values = |p: &crate::effect::EffectParameter| {
                (
                    p.prior_sd, p.typical, p.neutral, p.start, p.bounds, p.discrete,
                )
            };
            // The label of a pose has no prior.
            if !one.discrete {
                assert_eq!(values(one), values(same), "{id} {}", one.name);
            }
        }
        assert_eq!(effect.parameters().len(), other.parameters().len());
    }
}

#[test]
fn the_catalogue_as_text_has_the_same_ports_and_slopes() {
    for (effect, text) in as_texts() {
        let parameters = effect.parameters();
        for row in 0..6 {
            let value = |p: &crate::effect::EffectParameter| match p.discrete {
                true => 13.0,
                false => 0.6 * p.typical[0] + 0.4 * p.typical[1],
            };
            for chosen in 0..parameters.len() {
                let seed = |(k, p): (usize, &crate::effect::EffectParameter)| match k == chosen {
                    true => Dual::variable(value(p)),
                    false => Dual::constant(value(p)),
                };
                let values: Vec<Dual> = parameters.iter().enumerate().map(seed).collect();
                // In hours and the like, a parameter is another number of SI units, but the slope is by the parameter.
                let one = ports_after(effect, &values, row);
                let same = ports_after(text.effect(), &values, row);
                for (a, b) in one.iter().zip(&same) {
                    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + a.abs());
                    assert!(near(a.value, b.value), "{} {a:?} {b:?}", effect.id());
                    assert!(near(a.slope, b.slope), "{} {a:?} {b:?}", effect.id());
                }
            }
        }
    }
}

/// An equipped robot in which every effect at rest shows.
fn equipped() -> Robot {
    let mut robot = crate::effect::tests::recovery::equipped("mini");
    for (_, text) in as_texts() {
        robot.add_hypothesis(&text).unwrap();
    }
    robot
}

#[test]
fn the_catalogue_as_text_predicts_the_same_readings() {
    let robot = equipped();
    for (effect, text) in as_texts() {
        if effect.is_in_motion() {
            continue;
        }
        let mut stated = crate::effect::tests::recovery::typical(effect.id());
        stated
            .parameters
            .entry("pose".to_owned())
            .and_modify(|pose| *pose = 3.0);
        let mut same = stated.clone();
        same.effect = text.id().to_owned();
        let names = effect.parameters().iter().zip(text.effect().parameters());
        same.parameters = names
            .map(|(a, b)| (b.name.to_owned(), stated.parameters[a.name]))
            .collect();
        let [one, other] = [stated, same].map(|s| run(&robot, vec![s], 8).dataset.measurements);
        let grids = |m: &crate::measurement::Measurements| -> Vec<f64> {
            let grids = [&m.revolutions, &m.force_n, &m.swivel_rad];
            let cells = grids.into_iter().flat_map(|g| {
                (0..g.rows()).flat_map(move |row| (0..8).map(move |k| g.get(row, k)))
            });
            let angles = m.inclination_rad.iter().flatten().copied();
            cells
                .chain(m.laser_m.iter().copied())
                .chain(angles)
                .collect()
        };
        let (one, other) = (grids(&one), grids(&other));
        assert!(one.len() > 200 && one.len() == other.len());
        for (a, b) in one.iter().zip(&other) {
            assert!(
                (a - b).abs() <= 1e-12 * (1.0 + a.abs()),
                "{}: {a} {b}",
                effect.id()
            );
        }
    }
}

#[test]
fn crosstalk_comes_back() {
    let mut robot = crate::effect::tests::recovery::equipped("mini");
    robot.add_hypothesis(&hypothesis(CROSSTALK)).unwrap();
    let hidden = setting("encoder_crosstalk", &["cable-3"], &[("share", 0.004)]);
    let run = run(&robot, vec![hidden], 30);
    let request = EffectRequest::parse("encoder_crosstalk:cable-3").unwrap();
    let mut problem = Problem::new(&run.dataset).unwrap();
    problem.free(&[request]).unwrap();
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue).unwrap();
    assert!(solution.converged());
    assert!((solution.globals.effects[0].values[0] - 0.004).abs() < 4e-9);
}

#[test]
fn formulas_are_arithmetic() {
    let share = 0.3_f64;
    for (formula, parameter, expected) in [
        (
            "paid + 2 [mm] * share ^ 2 / 0.3",
            "start = 0.1",
            0.4 + 0.002 * share * share / 0.3,
        ),
        ("paid - -share * 1e-3 [km] * 0.5", "", 0.4 + share * 0.5),
        (
            "paid * (1 + sin(share) * cos(0))",
            "",
            0.4 * (1.0 + share.sin()),
        ),
        (
            "paid + sqrt(4 [m^2]) * tan(share)",
            "",
            0.4 + 2.0 * share.tan(),
        ),
        ("paid + max(share, -2) * 1 [m] + min(0, 3)", "", 0.4 + share),
        (
            "paid + (acos(-share) - pi / 2) * 1 [m] * 2 - asin(share) * 1 [m]",
            "",
            0.4 + share.asin(),
        ),
        (
            "paid + atan2(share, 2) * 1 [m] + abs(0 [m])",
            "",
            0.4 + share.atan2(2.0),
        ),
        (
            "paid + (exp(share) - 1) * 2 ^ -1 [1] * 1 [m]",
            "",
            0.4 + 0.5 * share.exp_m1(),
        ),
        (
            "paid + ln(1 + share) * 1 [m] * sign(tension)",
            "",
            0.4 + share.ln_1p(),
        ),
        (
            "paid + atan(share) * 1 [m] ^ 2 / 1 [m]",
            "",
            0.4 + share.atan(),
        ),
    ] {
        let text = with_formula(
            formula,
            &format!("unit = \"1\"\ntypical = [0.1, 0.5]\n{parameter}"),
        );
        let effect = hypothesis(&text).effect();
        let found = ports_after(effect, &[Dual::variable(share)], 2)[0];
        assert!(
            (found.value - expected).abs() < 1e-14,
            "{formula}: {found:?}"
        );
        let [plus, minus] =
            [1e-6, -1e-6].map(|h| ports_after(effect, &[Dual::constant(share + h)], 2)[0].value);
        assert!(
            (found.slope - (plus - minus) / 2e-6).abs() < 1e-8,
            "{formula}: {found:?}"
        );
    }
}

#[test]
fn units_of_parameters_are_converted() {
    let text = with_formula("paid + share * time", "unit = \"mm/h\"\ntypical = [1, 10]");
    let row = SampleRow::new(1, 8);
    let found = ports_after(hypothesis(&text).effect(), &[Dual::constant(5.0)], 1)[0].value;
    let expected = 0.4 + 5e-3 / 3600.0 * row.contexts().platform.time_s;
    assert!((found - expected).abs() < 1e-15);
}

#[test]
fn where_a_formula_has_no_value_nothing_changes() {
    let text = with_formula(
        "paid + share * 1 [m] * sqrt(direction)",
        "unit = \"1\"\ntypical = [0.1, 0.5]",
    );
    let effect = hypothesis(&text).effect();
    let mut seen = [false; 2];
    for row in 0..12 {
        let direction = SampleRow::new(row, 8).contexts().cables[1].direction;
        let found = ports_after(effect, &[Dual::variable(0.2)], row)[0];
        let expected = if direction > 0.0 { 0.4 + 0.2 } else { 0.4 };
        assert_eq!(found.value, expected);
        seen[usize::from(direction > 0.0)] = true;
    }
    assert!(seen[0] && seen[1]);
}

#[test]
fn events_and_waves_are_recognised() {
    let slip = find("cable_slip").unwrap().as_text(&mini()).unwrap();
    assert_eq!(hypothesis(&slip).effect().search(), Search::FromPose(1));
    let wave = find("laser_cyclic").unwrap().as_text(&mini()).unwrap();
    let search = Search::Wave {
        phase: 2,
        period: Some(1),
    };
    assert_eq!(hypothesis(&wave).effect().search(), search);
    let wrong = wave.replace(
        "sin(2 * pi * laser / period + phase)",
        "sin(2 * pi * laser / period + phase) ^ 3",
    );
    let error = Hypothesis::parse(&wrong).unwrap_err();
    assert!(
        error.message.contains("something that is no wave"),
        "{error}"
    );
    let wrong = wave.replace("laser / period", "position_x / period");
    assert!(Hypothesis::parse(&wrong).is_err());
    let bias = find("force_bias").unwrap().as_text(&mini()).unwrap();
    assert_eq!(hypothesis(&bias).effect().stage, Stage::Sensor);
}

#[test]
fn a_robot_carries_its_hypotheses() {
    let mut robot = mini();
    robot.add_hypothesis(&hypothesis(CROSSTALK)).unwrap();
    robot.effects = vec![setting(
        "encoder_crosstalk",
        &["cable-3"],
        &[("share", 0.004)],
    )];
    robot.check().unwrap();
    let other = hypothesis(&CROSSTALK.replace("0.01]", "0.02]"));
    let error = robot.add_hypothesis(&other).unwrap_err();
    assert_eq!(error, HypothesisNotAdded::OtherText(other.id().to_owned()));
    robot.hypotheses.push(other.text().to_owned());
    let error = robot.check().unwrap_err();
    assert_eq!(error.pointer, "/hypotheses/1");
    robot.hypotheses = vec![CROSSTALK.replace("next", "neighbour")];
    let error = robot.check().unwrap_err();
    let expected = "/hypotheses/0: line 11, column 32: found \"neighbour\", expected next";
    assert!(error.to_string().starts_with(expected), "{error}");
    robot.hypotheses.clear();
    let error = robot.check().unwrap_err();
    assert_eq!(
        error.to_string(),
        "/effects/0: unknown effect \"encoder_crosstalk\""
    );
}

/// The value that a formula changes is tried near what was read, on both sides of the mean.
#[test]
fn a_formula_may_compare_a_quantity_with_what_was_read() {
    let formula = |formula: &str| {
        let text = CROSSTALK.replace("paid = \"paid + share * paid_of(next)\"", formula);
        hypothesis(&text)
    };
    formula("tension = \"tension + share * max(tension - mean_tension, 0 [N])\"");
    formula("paid = \"paid + share * min(paid, 0 [m])\"");
}

#[test]
fn mistakes_are_named_with_their_place() {
    for (from, to, expected) in [
        (
            "paid_of(next)",
            "tension_of(next)",
            "line 11, column 16: found N, expected the unit of the term before it, m",
        ),
        (
            "share * paid_of(next)",
            "tension",
            "line 11, column 16: found N, expected the unit of the term before it, m",
        ),
        (
            "paid_of(next)",
            "revolution",
            "line 11, column 24: found \"revolution\", expected a parameter or a quantity, such as \"revolutions\"",
        ),
        (
            "paid_of(next)",
            "paid_of(paid_of(next))",
            "line 11, column 32: found \"paid_of\", expected next, previous or the number of a cable",
        ),
        (
            "paid_of(next)",
            "paid_of(other)",
            "line 11, column 32: found \"other\", expected next, previous or the number of a cable",
        ),
        (
            "paid_of(next)",
            "paid_of(65)",
            "line 11, column 32: found \"65\", expected next",
        ),
        (
            "paid_of(next)",
            "paid_of(next",
            "line 11, column 36: found the end, expected \")\"",
        ),
        (
            "paid_of(next)",
            "time_of(next)",
            "line 11, column 24: found \"time_of(\", but \"time\" is the same for all cables",
        ),
        (
            "paid_of(next)",
            "system(1)",
            "line 11, column 24: found \"system(\", expected a function",
        ),
        (
            "paid_of(next)",
            "strain",
            "line 11, column 24: found \"strain\", which only its own formula can use",
        ),
        (
            "paid_of(next)",
            "1 [furlong]",
            "line 11, column 27: found \"furlong\", expected a unit such as m, N/m or 1/K",
        ),
        (
            "paid_of(next)",
            "paid ^ share",
            "line 11, column 31: found an exponent that is not a constant",
        ),
        (
            "paid_of(next)",
            "1 [m] / 0",
            "line 11, column 32: found a division by 0",
        ),
        (
            "paid_of(next)",
            "sin(time) * 1 [m]",
            "line 11, column 28: found s, expected a number or an angle in sin(..)",
        ),
        (
            "paid_of(next)",
            "1e999 [m]",
            "line 11, column 24: found \"1e999\", expected a number",
        ),
        (
            "paid_of(next)",
            "1 [m] 2",
            "line 11, column 30: found \"2\", expected an operator or the end",
        ),
        (
            "paid_of(next)",
            "1 [m]; 2",
            "line 11, column 29: found \";\", expected an operator or the end",
        ),
        (
            "paid_of(next)",
            "",
            "line 11, column 24: found the end, expected a number, a name or \"(\"",
        ),
        (
            "paid_of(next)",
            "step(share)",
            "line 11, column 29: found \"share\", expected a parameter with unit = \"pose\"",
        ),
        (
            "paid = ",
            "pade = ",
            "line 11, column 1: found \"pade\", expected a quantity that can be changed, such as \"paid\"",
        ),
        (
            "paid = ",
            "mass = ",
            "line 11, column 1: found \"mass\", which this scope cannot change; expected a quantity of the cables",
        ),
        (
            "paid + share",
            "share",
            "found a formula that changes its quantity although all parameters are neutral",
        ),
        (
            "share * paid_of",
            "0 * share * paid_of",
            "found nothing that changes with \"share\" at its start value 0",
        ),
        (
            "share * paid_of",
            "paid_of",
            "found the parameter \"share\", which no formula uses",
        ),
        (
            "\"encoder_crosstalk\"",
            "\"winch_scale\"",
            "line 2, column 6: found \"winch_scale\", which is an effect of the catalogue",
        ),
        (
            "\"encoder_crosstalk\"",
            "\"A b\"",
            "line 2, column 6: found \"A b\", expected small letters, digits and _",
        ),
        (
            "title = \"C",
            "titel = \"C",
            "line 3, column 1: not a hypothesis (unknown field `titel`",
        ),
        (
            "\"cable\"",
            "\"cabel\"",
            "line 4, column 9: found \"cabel\", expected one of cable, cable_or_all, cable_pair, tension, laser, robot",
        ),
        (
            "{share}",
            "{shear}",
            "line 5, column 42: found the field {shear}, expected a parameter",
        ),
        (
            "unit = \"1\"",
            "unit = \"l\"",
            "line 8, column 8: found \"l\", expected a unit",
        ),
        (
            "[0.001, 0.01]",
            "[0.01, 0.001]",
            "line 9, column 11: found 0.01 to 0.001, expected the smallest and the largest typical size",
        ),
        (
            "[0.001, 0.01]",
            "\"small\"",
            "line 9, column 11: not a hypothesis (invalid type: string \"small\"",
        ),
        (
            "[parameters.share]",
            "[parameters.tension]",
            "found the parameter \"tension\", which is the name of a quantity",
        ),
        (
            "workshop = ",
            "prior = 2\nworkshop = ",
            "line 6, column 9: found 2, expected a prior above 0",
        ),
        (
            "workshop = ",
            "stage = \"late\"\nworkshop = ",
            "line 6, column 9: found \"late\", expected sensor",
        ),
        (
            "workshop = ",
            "variable = \"colour\"\nworkshop = ",
            "line 6, column 12: found \"colour\", expected one of cable length",
        ),
    ] {
        assert!(CROSSTALK.contains(from), "{from}");
        let text = CROSSTALK.replacen(from, to, 1);
        let error = Hypothesis::parse(&text).expect_err(to).to_string();
        assert!(error.contains(expected), "{to}: {error}");
        assert!(!error.contains('\n') && error.len() < 600, "{error}");
    }
    for key in ["id", "title", "scope", "cause", "workshop"] {
        let text: Vec<&str> = CROSSTALK.lines().filter(|l| !l.starts_with(key)).collect();
        let error = Hypothesis::parse(&text.join("\n")).expect_err(key);
        assert!(
            error
                .message
                .starts_with(&format!("found no {key}, expected")),
            "{error}"
        );
    }
}

#[test]
fn nothing_grows_without_bound() {
    let deep = |open: &str, close: &str, count: usize| {
        let formula = format!("{}paid{}", open.repeat(count), close.repeat(count));
        Hypothesis::parse(&with_formula(&formula, "unit = \"1\"\ntypical = [0, 1]"))
    };
    let error = deep("(", ")", 20_000).unwrap_err();
    assert!(
        error
            .message
            .starts_with("found more than 48 levels of nesting"),
        "{error}"
    );
    assert!(deep("-", "", 20_000).is_err() && deep("sin(", ")", 10_000).is_err());
    assert!(deep("paid + (", ")", 40).is_err(), "a stack of 40");
    let long = vec!["share * 1 [m]"; 4000].join(" + ");
    let error = Hypothesis::parse(&with_formula(
        &format!("paid + {long}"),
        "unit = \"1\"\ntypical = [0, 1]",
    ));
    assert!(
        error
            .unwrap_err()
            .message
            .starts_with("found more than 512 operations")
    );
    let huge = format!("# {}\n{CROSSTALK}", "x".repeat(1_000_000));
    let error = Hypothesis::parse(&huge).unwrap_err().to_string();
    assert!(
        error.ends_with(&format!("expected at most {MAX_HYPOTHESIS_BYTES}")),
        "{error}"
    );
    let nested = format!("id = {}{}", "[".repeat(30_000), "]".repeat(30_000));
    assert!(Hypothesis::parse(&nested).is_err());
    let many: String = (0..9)
        .map(|k| format!("[parameters.p{k}]\nunit = \"1\"\ntypical = [0, 1]\n"))
        .collect();
    let error =
        Hypothesis::parse(&CROSSTALK.replace("[change]", &format!("{many}[change]"))).unwrap_err();
    assert!(
        error.message.starts_with("found more than 8 parameters"),
        "{error}"
    );
}

/// A quick fuzzing: every file gives a hypothesis or a message.
#[test]
fn damaged_files_are_refused_in_one_sentence() {
    let seeds: Vec<String> = as_texts()
        .into_iter()
        .map(|(_, text)| text.text().to_owned())
        .collect();
    let pieces = [
        "(",
        ")",
        "paid",
        "_of(next)",
        "^",
        "1e308",
        "-",
        "[m]",
        "step(pose)",
        "\"",
        "=",
        "\n",
        "é",
        "sqrt(",
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut accepted = 0;
    for round in 0..4000 {
        let mut text = seeds[round % seeds.len()].clone();
        for _ in 0..rng.random_range(1..4) {
            let at = text.floor_char_boundary(rng.random_range(0..text.len()));
            let end = text.floor_char_boundary((at + rng.random_range(0..6)).min(text.len()));
            text.replace_range(at..end, pieces[rng.random_range(0..pieces.len())]);
        }
        match Hypothesis::parse(&text) {
            Ok(_) => accepted += 1,
            Err(error) => {
                let message = error.to_string();
                assert!(
                    !message.chars().any(char::is_control) && message.len() < 1500,
                    "{message}"
                );
            }
        }
    }
    assert!((20..2000).contains(&accepted), "{accepted}");
}
