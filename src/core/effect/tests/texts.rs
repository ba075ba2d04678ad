//! Texts of the effects, in the words of those who repair the robot.

use crate::effect::{BoundEffect, Effect, Scope, Search, every_effect, find};
use crate::robot::{Robot, presets};

/// All cables of the mini robot.
const ALL: &[usize] = &[0, 1, 2, 3, 4, 5, 6, 7];

fn mini() -> Robot {
    presets::find("mini").unwrap().robot
}

/// A robot whose cables read lengths and are named after their corners.
fn absolute() -> Robot {
    let mut robot = mini();
    robot.home = None;
    robot.cables[2].name = "left-front".to_owned();
    robot.cables[4].name = "right-back".to_owned();
    robot
}

fn bound(effect: &'static Effect, cables: &[usize], values: Vec<f64>) -> BoundEffect {
    BoundEffect {
        effect,
        cables: cables.to_vec(),
        targeted: cables.len() < 8,
        values,
    }
}

/// Sizes in the typical range, all of this sign, at a pose or in a row.
fn sizes(effect: &Effect, share: f64, sign: f64) -> Vec<f64> {
    let value = |(k, p): (usize, &crate::effect::EffectParameter)| {
        let [low, high] = p.typical;
        let size = low + (share + 0.1 * k as f64) * (high - low);
        if p.discrete && !p.optional {
            17.0
        } else {
            sign * size
        }
    };
    effect.parameters().iter().enumerate().map(value).collect()
}

/// The numbers of cables that an effect can be attached to.
fn targets(effect: &Effect) -> &'static [&'static [usize]] {
    match effect.scope() {
        Scope::Cable | Scope::CableOrAll => &[&[2], &[2, 4], &[0, 3, 4], ALL],
        Scope::Pair => &[&[2, 4]],
        Scope::Robot => &[ALL],
    }
}

/// Calls `check` with every effect, target, size and sign on both robots.
fn everywhere(mut check: impl FnMut(&Robot, &BoundEffect)) {
    for robot in [mini(), absolute()] {
        for effect in every_effect() {
            for cables in targets(effect) {
                for (share, sign) in [(0.0, 1.0), (0.33, 1.0), (0.33, -1.0), (1.0, 1.0)] {
                    check(&robot, &bound(effect, cables, sizes(effect, share, sign)));
                }
            }
        }
    }
}

/// Whether the text has a negative number; a minus sign before an axis is a direction.
fn has_negative_number(text: &str) -> bool {
    let minus = text.split('-').skip(1);
    let followed = |after: &str| after.starts_with(|c: char| c.is_ascii_digit());
    minus
        .zip(text.split('-'))
        .any(|(after, before)| followed(after) && before.ends_with(|c: char| c.is_whitespace()))
}

#[test]
fn every_effect_says_whole_sentences() {
    everywhere(|robot, bound| {
        for text in [bound.cause(robot), bound.workshop(robot)] {
            assert!(text.starts_with(char::is_uppercase), "{text}");
            assert!(text.ends_with('.') && !text.ends_with(".."), "{text}");
            assert!(!text.contains("  ") && !text.contains(" ."), "{text}");
            assert!(!text.contains("NaN") && !text.contains("inf "), "{text}");
            assert!(!has_negative_number(&text), "{text}");
            assert!(
                !text.contains(['{', '}', '|']),
                "a field without meaning: {text}"
            );
        }
        let cause = bound.cause(robot);
        assert_eq!(cause.matches(". ").count(), 0, "{cause}");
        assert!(bound.workshop(robot).matches(". ").count() <= 1);
        assert!(!bound.effect.source().is_empty());
    });
}

#[test]
fn every_effect_has_a_check_in_the_workshop() {
    for effect in every_effect() {
        let check = effect.check().unwrap_or_else(|| panic!("{}", effect.id()));
        assert!(check.starts_with(char::is_uppercase), "{check}");
        assert!(check.ends_with('.') && !check.contains(". "), "{check}");
        assert!(!check.contains("  "), "{check}");
        // What to do about it is another thing than how to be sure of it.
        let other = bound(effect, targets(effect)[0], sizes(effect, 0.3, 1.0));
        assert_ne!(check, other.workshop(&mini()));
    }
}

#[test]
fn ratios_are_not_told_as_bare_numbers() {
    everywhere(|robot, bound| {
        let cause = bound.cause(robot);
        for (parameter, value) in bound.effect.parameters().iter().zip(&bound.values) {
            if parameter.unit == "1" && !parameter.discrete {
                let bare = format!(" {} ", value.abs());
                assert!(!cause.contains(&bare), "{cause}");
            }
        }
    });
}

#[test]
fn the_sign_of_a_value_changes_the_words() {
    for robot in [mini(), absolute()] {
        for effect in every_effect().filter(|effect| effect.is_estimable()) {
            // The sign of a wave is a matter of its phase.
            if matches!(effect.search(), Search::Wave { .. }) {
                continue;
            }
            let cables = targets(effect)[0];
            let says = |sign| bound(effect, cables, sizes(effect, 0.3, sign)).cause(&robot);
            assert_ne!(says(1.0), says(-1.0));
        }
    }
}

#[test]
fn every_target_is_named() {
    for effect in every_effect() {
        let texts = targets(effect).iter().map(|cables| {
            let bound = bound(effect, cables, sizes(effect, 0.3, 1.0));
            bound.cause(&mini())
        });
        let texts: Vec<String> = texts.collect();
        for (text, cables) in texts.iter().zip(targets(effect)) {
            assert_eq!(texts.iter().filter(|other| *other == text).count(), 1);
            let of_cables = effect.scope() != Scope::Robot;
            let named = match cables {
                [2] => text.contains(" 3"),
                [2, 4] => text.contains(" 3 and 5"),
                [0, 3, 4] => text.contains(" 1, 4 and 5"),
                _ => text.to_lowercase().contains("all "),
            };
            assert!(named || !of_cables, "{text}");
        }
    }
}

/// The sentence of an effect on the mini robot.
fn says(id: &str, cables: &[usize], values: &[f64]) -> String {
    bound(find(id).unwrap(), cables, values.to_vec()).cause(&mini())
}

const ABOUT_CABLES: &[(&str, &[usize], &[f64], &str)] = &[
    (
        "winch_scale",
        &[2],
        &[0.0031],
        "Winch 3 pays out 0.31 % more cable per revolution than its drum diameter implies.",
    ),
    (
        "winch_scale",
        &[0, 3],
        &[-0.0031],
        "Winches 1 and 4 pay out 0.31 % less cable per revolution than their drum diameters imply.",
    ),
    (
        "winch_scale_common",
        ALL,
        &[-0.0031],
        "All winches pay out 0.31 % less cable per revolution than their drum diameters imply.",
    ),
    (
        "winch_offset",
        &[1],
        &[-0.0123],
        "Cable 2 is 12.3 mm shorter than its reading says at every pose but home.",
    ),
    (
        "encoder_drift",
        &[4],
        &[0.0034],
        "The length reading of cable 5 drifts: the cable gets longer than the reading says by 3.4 mm/h.",
    ),
    (
        "cable_slip",
        &[7],
        &[-0.0052, 17.0],
        "Cable 8 slipped: from pose 17 on, it is 5.2 mm shorter than its reading says.",
    ),
    (
        "cable_creep",
        ALL,
        &[0.001],
        "All cables creep under load: in the first hour each metre gets 1.95 mm longer.",
    ),
    (
        "cable_swap",
        &[0, 1],
        &[1.0],
        "The encoders of winches 1 and 2 are swapped.",
    ),
    (
        "cable_swap",
        &[0, 1],
        &[2.0],
        "Force sensors 1 and 2 are swapped.",
    ),
    (
        "cable_swap",
        &[0, 1],
        &[3.0],
        "The encoders of winches 1 and 2 are swapped, and so are their force sensors.",
    ),
    (
        "platform_anchor",
        &[2],
        &[0.0031, 0.0001, -0.0028],
        "The attachment point of cable 3 on the platform is off by 3.1 mm towards +x and 2.8 mm towards -z (platform axes).",
    ),
    (
        "force_bias",
        &[2],
        &[-12.0],
        "Force sensor 3 reads 12 N too low, whatever the tension.",
    ),
];

#[test]
fn sentences_about_cables() {
    for (id, cables, values, expected) in ABOUT_CABLES {
        assert_eq!(says(id, cables, values), *expected);
    }
}

const ABOUT_THE_ROBOT: &[(&str, &[f64], &str)] = &[
    (
        "payload_mass",
        &[-0.2],
        "The platform is 20 % lighter than stated: 2 kg instead of 2.5 kg.",
    ),
    (
        "laser_scale",
        &[-0.0012],
        "The laser reads distances 0.12 % too short.",
    ),
    (
        "laser_outliers",
        &[17.0, 0.034],
        "The laser reading at pose 17 is 34 mm too long.",
    ),
    (
        "frame_thermal",
        &[1.2e-5],
        "The frame gets 0.012 mm longer per metre and per kelvin of warming.",
    ),
    (
        "heading_offset",
        &[-std::f64::consts::FRAC_PI_6],
        "The yaw reading of the platform is 30 degrees too small.",
    ),
];

#[test]
fn sentences_about_the_robot() {
    for (id, values, expected) in ABOUT_THE_ROBOT {
        assert_eq!(says(id, ALL, values), *expected);
    }
}

#[test]
fn cables_with_names_keep_them() {
    let robot = absolute();
    let radius = |cables: &[usize]| {
        let effect = find("pulley_radius").unwrap();
        bound(effect, cables, vec![0.5]).cause(&robot)
    };
    assert_eq!(
        radius(&[2]),
        "The pulley of left-front has a radius 50 % larger than stated: 27 mm instead of 18 mm."
    );
    let offset = find("winch_offset").unwrap();
    assert_eq!(
        bound(offset, &[2, 4], vec![0.012]).cause(&robot),
        "Cables left-front and right-back are 12 mm longer than their readings say at every pose."
    );
}

/// A name that is a number is one only where the cable is.
#[test]
fn numbers_are_those_of_the_rows_of_the_description() {
    let mut robot = mini();
    robot.cables[2].name = "3".to_owned();
    robot.cables[4].name = "cable-7".to_owned();
    let effect = find("force_gain").unwrap();
    let on = |cable: usize| bound(effect, &[cable], vec![0.1]).cause(&robot);
    assert_eq!(on(2), "Force sensor 3 reads 10 % too high.");
    assert_eq!(on(4), "The force sensor of cable-7 reads 10 % too high.");
}
