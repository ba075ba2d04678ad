//! Structure without a name: its functions, what it adds to which reading, and what it says.

use super::slopes::{at_cable, at_platform};
use crate::effect::unknown::{FIRST, FUNCTIONS, Form, READING, SCALE};
use crate::effect::{
    BiasedReading, BoundEffect, CablePort, CablePorts, Dual, PlatformPort, PlatformPorts, Shape,
    UNKNOWN, find,
};
use crate::measurement::Variable;
use crate::robot::presets;

/// A value of each variable, different for all.
fn variables() -> [f64; Variable::COUNT] {
    std::array::from_fn(|k| 0.05 + 0.05 * k as f64)
}

const SHAPES: [Shape; 3] = [Shape::Smooth, Shape::Wave, Shape::Surface];

fn form(shape: Shape, variable: Variable) -> Form {
    Form {
        shape,
        variable,
        range: [-0.1, 1.2],
        other: Variable::Position(2),
        other_range: [-0.3, 0.9],
        terms: FUNCTIONS,
    }
}

fn values(reading: usize, form: &Form) -> Vec<f64> {
    let mut values = vec![0.0; FIRST + FUNCTIONS];
    form.write(&mut values);
    (values[READING], values[SCALE]) = (reading as f64, 0.003);
    for (k, value) in values[FIRST..].iter_mut().enumerate() {
        *value = 0.4 - 0.3 * k as f64;
    }
    values
}

fn neutral(values: &[f64]) -> Vec<f64> {
    let mut neutral = values.to_vec();
    neutral[FIRST..].fill(0.0);
    neutral
}

/// All ports after it acted at home or elsewhere; `chosen` is the parameter whose slopes are asked.
fn ports(values: &[f64], chosen: Option<usize>, is_home: bool) -> Vec<Dual> {
    let dual = |(k, value): (usize, &f64)| match chosen {
        Some(chosen) if chosen == k => Dual::variable(*value),
        _ => Dual::constant(*value),
    };
    let values: Vec<Dual> = values.iter().enumerate().map(dual).collect();
    let robot = presets::find("mini").unwrap().robot;
    let mut cable = CablePorts::nominal(&robot.cables[2], 0.4, 120.0);
    let mut platform = PlatformPorts::nominal(&robot);
    let (mut at_cable, mut at_platform) = (at_cable(), at_platform());
    (at_cable.variables, at_platform.variables) = (variables(), variables());
    (at_cable.is_home, at_platform.is_home) = (is_home, is_home);
    (UNKNOWN.change_cable)(&values, &at_cable, &mut cable);
    (UNKNOWN.change_platform)(&values, &at_platform, &mut platform);
    let of_cable = CablePort::ALL.iter().map(|port| cable.get(*port));
    let of_platform = PlatformPort::ALL.iter().map(|port| platform.get(*port));
    of_cable.chain(of_platform).collect()
}

#[test]
fn slopes_match_differences() {
    for reading in 0..BiasedReading::ALL.len() {
        for (k, variable) in Variable::ALL.into_iter().enumerate() {
            let values = values(reading, &form(SHAPES[k % 3], variable));
            let mut acting = 0;
            for chosen in FIRST..values.len() {
                let with = |step: f64| {
                    let mut moved = values.clone();
                    moved[chosen] += step;
                    ports(&moved, None, false)
                };
                let exact = ports(&values, Some(chosen), false);
                for ((slope, plus), minus) in exact.iter().zip(with(1e-3)).zip(with(-1e-3)) {
                    // Linear: differences are exact but for rounding.
                    let numeric = (plus.value - minus.value) / 2e-3;
                    let rounding = 1e-12 * (1.0 + slope.value.abs());
                    assert!((slope.slope - numeric).abs() < rounding, "{variable:?}");
                }
                acting += exact.iter().filter(|dual| dual.slope != 0.0).count();
            }
            assert!(acting > 0, "{reading} {variable:?}");
        }
    }
}

/// One port changes, by the sum of the functions.
#[test]
fn it_adds_its_functions_to_one_reading() {
    for reading in 0..BiasedReading::ALL.len() {
        for shape in SHAPES {
            let form = form(shape, Variable::Position(1));
            let values = values(reading, &form);
            let terms = values[FIRST..].iter().zip(form.functions(&variables()));
            let expected = values[SCALE] * terms.map(|(c, f)| c * f).sum::<f64>();
            let before = ports(&neutral(&values), None, false);
            let after = ports(&values, None, false);
            let changes = before.iter().zip(&after).map(|(a, b)| b.value - a.value);
            let changes: Vec<f64> = changes.filter(|change| *change != 0.0).collect();
            assert_eq!(changes.len(), 1, "{reading}");
            assert!((changes[0] - expected).abs() < 1e-13, "{reading}");
        }
    }
}

/// Readings of cables count from home; instruments on the platform read there as elsewhere.
#[test]
fn at_home_cables_have_none() {
    for (reading, kind) in BiasedReading::ALL.iter().enumerate() {
        let values = values(reading, &form(Shape::Smooth, Variable::Position(1)));
        let (with, without) = (
            ports(&values, None, true),
            ports(&neutral(&values), None, true),
        );
        let same = with.iter().zip(&without).all(|(a, b)| a.value == b.value);
        assert_eq!(same, kind.is_of_cable(), "{kind:?}");
    }
}

#[test]
fn functions_are_bounded_and_none_where_nothing_is_known() {
    for (k, variable) in Variable::ALL.into_iter().enumerate() {
        let form = Form {
            range: [0.0, 1.0],
            other_range: [0.0, 1.0],
            ..form(SHAPES[k % 3], variable)
        };
        assert_eq!(
            form.functions(&[f64::NAN; Variable::COUNT]),
            [0.0; FUNCTIONS]
        );
        for value in [0.0, 0.3, 1.0] {
            let all = form.functions(&[value; Variable::COUNT]);
            assert_eq!(all[0], 1.0);
            assert!(all.iter().all(|f| f.abs() <= 1.0 + 1e-15));
            let few = Form { terms: 2, ..form }.functions(&[value; Variable::COUNT]);
            assert_eq!(
                (few[..2].to_vec(), [0.0; 4]),
                (all[..2].to_vec(), few[2..].try_into().unwrap())
            );
        }
    }
    let drum = form(Shape::Smooth, Variable::DrumFraction);
    let turns = [0.2, 1.2].map(|turn| drum.functions(&[turn; Variable::COUNT]));
    assert!((0..FUNCTIONS).all(|k| (turns[0][k] - turns[1][k]).abs() < 1e-14));
}

#[test]
fn it_says_on_which_reading_and_along_what() {
    let robot = presets::find("mini").unwrap().robot;
    let says = |reading: usize, cables: &[usize]| {
        let mut values = values(reading, &form(Shape::Smooth, Variable::Position(0)));
        values[FIRST..].fill(0.0);
        // From +3 mm (N, rad) at one end to -3 mm at the other.
        values[FIRST + 1] = 1.0;
        let bound = BoundEffect {
            effect: find("unknown").unwrap(),
            cables: cables.to_vec(),
            targeted: !cables.is_empty(),
            values,
        };
        (bound.cause(&robot), bound.workshop(&robot))
    };
    let (laser, workshop) = says(3, &[]);
    assert_eq!(
        laser,
        "The laser reading has an error that changes with the position x by up to 6 mm; no known cause explains it."
    );
    assert!(workshop.ends_with('.'));
    let (length, _) = says(0, &[2]);
    assert!(length.starts_with("The length reading of cable 3 has an error"));
    let (swivel, _) = says(2, &[2]);
    assert!(swivel.starts_with("The swivel reading of pulley 3 has an error"));
    assert!(swivel.contains("0.344 degrees"), "{swivel}");
}

/// A model file with numbers that mean nothing changes nothing.
#[test]
fn numbers_without_meaning_change_nothing() {
    let values = values(3, &form(Shape::Surface, Variable::Position(1)));
    let without = ports(&neutral(&values), None, false);
    for given in 0..FIRST {
        let mut wrong = values.clone();
        wrong[given] = 99.0;
        let with = ports(&wrong, None, false);
        assert!(with.iter().all(|port| port.value.is_finite()));
        let name = UNKNOWN.parameters()[given].name;
        if ["reading", "variable", "other"].contains(&name) {
            let same = with.iter().zip(&without).all(|(a, b)| a.value == b.value);
            assert!(same, "{name}");
        }
    }
}
