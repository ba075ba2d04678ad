//! Mistakes planted in simulated readings.

use tautline_core::robot::{Inclinometer, PerAxis, Tracker, presets};
use tautline_core::simulation::{SimulationOptions, simulate};

use super::*;
use crate::recipe::{Assignment, Recipe};

/// Readings of a simulated robot with all instruments, and pulleys that are not where the drawing has them.
fn readings(preset: &str, seed: u64) -> (Readings, Robot) {
    let mut robot = presets::find(preset).expect("a preset").robot;
    robot.inclinometer = Some(Inclinometer { sd_rad: 2e-3 });
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-3),
        orientation_sd_rad: Some(1e-3),
    });
    let data = simulate(&robot, &SimulationOptions::new(30, seed))
        .expect("simulated")
        .dataset
        .measurements;
    (Readings::of_measurements(&data), robot)
}

fn scale(readings: &mut Readings, kind: Kind, factor: f64) {
    let columns = readings.columns.iter_mut().filter(|(quantity, _)| {
        quantity.kind == kind && (kind != Kind::Commanded || quantity.index < 3)
    });
    columns.for_each(|(_, values)| values.iter_mut().for_each(|value| *value *= factor));
}

fn column(readings: &mut Readings, kind: Kind, index: usize) -> &mut Vec<f64> {
    readings
        .columns
        .get_mut(&Quantity { kind, index })
        .expect("a column")
}

fn swap(readings: &mut Readings, kind: Kind, i: usize, j: usize) {
    let first = std::mem::take(column(readings, kind, i));
    let second = std::mem::replace(column(readings, kind, j), first);
    *column(readings, kind, i) = second;
}

const SEEDS: std::ops::Range<u64> = 100..120;

/// Name of a mistake, function that makes it, its kind, and the first column that the suggestion has to name.
type Planted = (&'static str, fn(&mut Readings), Mistake, &'static str);

const PLANTED: [Planted; 15] = [
    (
        "revolutions in degrees",
        |r| scale(r, Kind::Revolutions, 360.0),
        Mistake::WrongUnit,
        "rev_1",
    ),
    (
        "revolutions in radians",
        |r| scale(r, Kind::Revolutions, std::f64::consts::TAU),
        Mistake::WrongUnit,
        "rev_1",
    ),
    (
        "all revolutions reversed",
        |r| scale(r, Kind::Revolutions, -1.0),
        Mistake::ReversedSign,
        "rev_1",
    ),
    (
        "one winch reversed",
        |r| {
            column(r, Kind::Revolutions, 2)
                .iter_mut()
                .for_each(|v| *v = -*v);
        },
        Mistake::ReversedSign,
        "rev_3",
    ),
    (
        "two winches exchanged",
        |r| swap(r, Kind::Revolutions, 1, 4),
        Mistake::Exchanged,
        "rev_2",
    ),
    (
        "an encoder lost part of a turn",
        |r| {
            column(r, Kind::Revolutions, 5)[14..]
                .iter_mut()
                .for_each(|v| *v += 0.45);
        },
        Mistake::EncoderStep,
        "rev_6",
    ),
    (
        "a dead encoder",
        |r| {
            column(r, Kind::Revolutions, 3)
                .iter_mut()
                .for_each(|v| *v = 0.25);
        },
        Mistake::DeadChannel,
        "rev_4",
    ),
    (
        "laser in millimetres",
        |r| scale(r, Kind::Laser, 1e3),
        Mistake::WrongUnit,
        "laser_m",
    ),
    (
        "forces in kilonewtons",
        |r| scale(r, Kind::Force, 1e-3),
        Mistake::WrongUnit,
        "force_1_n",
    ),
    (
        "forces negative",
        |r| scale(r, Kind::Force, -1.0),
        Mistake::ReversedSign,
        "force_1_n",
    ),
    (
        "inclinometer in degrees",
        |r| scale(r, Kind::Inclination, 180.0 / std::f64::consts::PI),
        Mistake::WrongUnit,
        "roll_rad",
    ),
    (
        "tracker in millimetres",
        |r| scale(r, Kind::Tracked, 1e3),
        Mistake::WrongUnit,
        "meas_x_m",
    ),
    (
        "axes of the tracker exchanged",
        |r| swap(r, Kind::Tracked, 1, 2),
        Mistake::Exchanged,
        "meas_y_m",
    ),
    (
        "commanded poses in millimetres",
        |r| scale(r, Kind::Commanded, 1e3),
        Mistake::WrongUnit,
        "x_m",
    ),
    (
        "tracker in a frame of its own",
        in_another_frame,
        Mistake::OtherFrame,
        "meas_x_m",
    ),
];

/// Mistakes that show only where poses are known.
const PLANTED_AT_POSES: [Planted; 3] = [
    (
        "an encoder lost one turn",
        |r| {
            column(r, Kind::Revolutions, 5)[14..]
                .iter_mut()
                .for_each(|v| *v += 1.0);
        },
        Mistake::LostTurns,
        "rev_6",
    ),
    (
        "half of the micro-steps",
        |r| {
            column(r, Kind::Revolutions, 2)
                .iter_mut()
                .for_each(|v| *v *= 0.5);
        },
        Mistake::WrongUnit,
        "rev_3",
    ),
    (
        "an encoder that stops",
        |r| {
            let values = column(r, Kind::Revolutions, 3);
            let last = values[15];
            values[16..].fill(last);
        },
        Mistake::DeadChannel,
        "rev_4",
    ),
];

/// Measured positions as an instrument reads them that stands elsewhere and is turned.
fn in_another_frame(readings: &mut Readings) {
    let turned = nalgebra::Rotation3::from_euler_angles(0.7, -0.3, 1.1);
    for row in 0..readings.labels.len() {
        let at = [0, 1, 2].map(|index| column(readings, Kind::Tracked, index)[row]);
        let seen = turned * Vec3::from(at) + Vec3::new(0.4, -1.2, 0.9);
        for index in 0..3 {
            column(readings, Kind::Tracked, index)[row] = seen[index];
        }
    }
}

#[test]
fn planted_mistakes_are_found_and_rightly_named() {
    let mut missed = Vec::new();
    let mut tries = 0;
    for seed in SEEDS {
        let (clean, robot) = readings("mini", seed);
        for (what, plant, mistake, first) in PLANTED.iter().chain(&PLANTED_AT_POSES) {
            let mut readings = clean.clone();
            plant(&mut readings);
            let found = check(&readings, &robot);
            tries += 1;
            let rightly =
                matches!(&found[..], [one] if one.mistake == *mistake && one.columns[0] == *first);
            if !rightly {
                missed.push(format!(
                    "{what}, seed {seed}: {:?}",
                    found.iter().map(|s| &s.sentence).collect::<Vec<_>>()
                ));
            }
        }
    }
    // At least 95 of 100.
    assert!(
        missed.len() * 20 <= tries,
        "{} of {tries} missed\n{}",
        missed.len(),
        missed.join("\n")
    );
}

/// Without poses the lengths of eight cables contradict each other where a channel is wrong.
#[test]
fn mistakes_of_winches_are_found_without_any_poses() {
    let mut missed = Vec::new();
    let mut tries = 0;
    for seed in SEEDS {
        let (mut clean, robot) = readings("mini", seed);
        clean
            .columns
            .retain(|quantity, _| !matches!(quantity.kind, Kind::Commanded | Kind::Tracked));
        let planted = PLANTED.iter().filter(|(_, _, mistake, first)| {
            first.starts_with("rev_") && *mistake != Mistake::EncoderStep
        });
        for (what, plant, mistake, first) in planted {
            let mut readings = clean.clone();
            plant(&mut readings);
            let found = check(&readings, &robot);
            tries += 1;
            let rightly =
                matches!(&found[..], [one] if one.mistake == *mistake && one.columns[0] == *first);
            if !rightly {
                let sentences: Vec<_> = found.iter().map(|one| &one.sentence).collect();
                missed.push(format!("{what}, seed {seed}: {sentences:?}"));
            }
        }
        let found = check(&clean, &robot);
        assert!(found.is_empty(), "seed {seed}: {found:?}");
    }
    // At least 95 of 100.
    assert!(
        missed.len() * 20 <= tries,
        "{} of {tries} missed\n{}",
        missed.len(),
        missed.join("\n")
    );
}

/// The table of a simulated robot with lengths in place of revolutions.
fn with_lengths(seed: u64) -> (Measurements, Robot) {
    let robot = presets::find("mini").expect("a preset").robot;
    let run = simulate(&robot, &SimulationOptions::new(30, seed)).expect("simulated");
    let mut data = run.dataset.measurements;
    let home = tautline_core::kinematics::inverse_kinematics(&robot, &robot.home.unwrap().pose());
    let home = home.expect("lengths at home");
    let mut lengths = Grid::missing(data.len(), robot.cable_count());
    for row in 0..data.len() {
        for (cable, described) in robot.cables.iter().enumerate() {
            let change =
                data.revolutions.get(row, cable) * described.winch.cable_per_revolution_m();
            lengths.set(row, cable, home[cable].length_m + change);
        }
    }
    data.length_m = lengths;
    data.revolutions = Grid::default();
    (data, robot)
}

#[test]
fn a_piece_of_cable_is_found_and_a_sound_table_of_lengths_has_none() {
    for seed in SEEDS {
        let (mut data, robot) = with_lengths(seed);
        assert!(check_table(&data, &robot).suggestions.is_empty());
        for row in 0..data.len() {
            data.length_m.set(row, 4, data.length_m.get(row, 4) + 1.0);
        }
        let found = check_table(&data, &robot).suggestions;
        let [one] = &found[..] else {
            panic!("{found:?}");
        };
        assert_eq!(one.mistake, Mistake::Extension, "{one:?}");
        assert_eq!(one.columns, ["length_5_m"]);
        assert!(one.correct(&mut data));
        let left = check_table(&data, &robot).suggestions;
        assert!(left.is_empty(), "{left:?}");
    }
}

/// The suggestion for a table, applied to the table, undoes the mistake.
#[test]
fn a_correction_undoes_the_mistake_in_the_table() {
    let robot = presets::find("mini").expect("a preset").robot;
    let run = simulate(&robot, &SimulationOptions::new(30, 5)).expect("simulated");
    let clean = run.dataset.measurements;
    let cells = |data: &Measurements| -> Vec<f64> {
        let rows = (0..data.len()).flat_map(|row| data.revolutions.row(row).to_vec());
        rows.collect()
    };
    let per_cable = |change: &dyn Fn(usize, usize, f64) -> f64| {
        let mut data = clean.clone();
        for row in 0..data.len() {
            for cable in 0..robot.cable_count() {
                let value = change(row, cable, clean.revolutions.get(row, cable));
                data.revolutions.set(row, cable, value);
            }
        }
        data
    };
    let exchanged = |row: usize, cable: usize, value: f64| match cable {
        1 => clean.revolutions.get(row, 4),
        4 => clean.revolutions.get(row, 1),
        _ => value,
    };
    let tables = [
        per_cable(&exchanged),
        per_cable(&|_, cable, value| if cable == 2 { -value } else { value }),
        per_cable(&|_, cable, value| if cable == 2 { 0.5 * value } else { value }),
        per_cable(&|row, cable, value| {
            if cable == 5 && row > 12 {
                value - 2.0
            } else {
                value
            }
        }),
        per_cable(&|_, _, value| 360.0 * value),
    ];
    for mut data in tables {
        let found = check_table(&data, &robot).suggestions;
        assert!(!found.is_empty());
        assert!(found.iter().all(|one| one.correct(&mut data)));
        let off = cells(&data).into_iter().zip(cells(&clean));
        let off = off.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-9, "{off}, {found:?}");
    }
    let mut data = per_cable(&|row, cable, value| match (cable, row > 14) {
        (3, true) => clean.revolutions.get(14, 3),
        _ => value,
    });
    let found = check_table(&data, &robot).suggestions;
    assert!(found[0].correct(&mut data));
    let is_left = |row: usize| !data.revolutions.get(row, 3).is_nan();
    assert!(
        (0..15).all(is_left) && !(15..data.len()).any(is_left),
        "{found:?}"
    );
}

#[test]
fn clean_readings_have_no_suggestions() {
    let mut wrong = Vec::new();
    for preset in ["mini", "hall", "suspended", "planar"] {
        for seed in 0..50 {
            let (readings, robot) = readings(preset, seed);
            let found = check(&readings, &robot);
            wrong.extend(
                found
                    .iter()
                    .map(|suggestion| format!("{preset}, seed {seed}: {}", suggestion.sentence)),
            );
        }
    }
    // At most 1 of 100.
    assert!(
        wrong.len() <= 2,
        "{} of 200\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn a_suggestion_changes_the_recipe_where_it_is_meant() {
    let mut recipe = Recipe {
        channels: vec![
            Assignment {
                first: 0,
                ..Assignment::new("W{i}", "rev_{i}")
            },
            Assignment::new("L", "laser_m"),
        ],
        ..Recipe::default()
    };
    let apply = |recipe: &mut Recipe, change: Change| {
        Suggestion::new(String::new(), change).apply(recipe);
    };
    let all: Vec<String> = (1..=8).map(|k| format!("rev_{k}")).collect();
    apply(
        &mut recipe,
        Change::Multiply {
            columns: all,
            factor: 0.5,
        },
    );
    assert_eq!((recipe.channels.len(), recipe.channels[0].factor), (2, 0.5));
    apply(
        &mut recipe,
        Change::Reverse {
            columns: vec!["rev_3".into()],
        },
    );
    let third = &recipe.channels[2];
    assert_eq!(
        (
            third.channel.as_str(),
            third.quantity.as_str(),
            third.reversed,
            third.factor
        ),
        ("W2", "rev_3", true, 0.5)
    );
    apply(
        &mut recipe,
        Change::Exchange {
            a: "rev_1".into(),
            b: "rev_3".into(),
        },
    );
    let pairs: Vec<(&str, &str, bool)> = recipe.channels[3..]
        .iter()
        .map(|entry| {
            (
                entry.channel.as_str(),
                entry.quantity.as_str(),
                entry.reversed,
            )
        })
        .collect();
    assert_eq!(pairs, [("W0", "rev_3", false), ("W2", "rev_1", true)]);
    apply(
        &mut recipe,
        Change::CloseJumps {
            series: "log".into(),
        },
    );
    assert!(recipe.clocks[0].close_jumps);
}
