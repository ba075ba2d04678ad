//! Logs of channels with names of other programs: in any order, with other channels between them, in other units, with signs
//! reversed. The proposal is right, or a sentence reports the doubt.

use rand::seq::{IndexedRandom, SliceRandom};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_channels::{Channel, MemoryBudget, Source};
use tautline_core::measurement::Measurements;
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{SimulationOptions, simulate};

use super::{ChannelNames, rows, source};
use crate::proposal::propose;
use crate::{Imported, import_corrected};

const LOGS: u64 = 300;
/// Share of the logs for which the proposal has to be right.
const RIGHT: f64 = 0.95;
/// Relative difference below which values are equal: units are converted and nothing else.
const EQUAL: f64 = 1e-6;

/// Rows of the list of names whose channels hold one of these kinds of values.
fn of<'a>(
    all: &'a [ChannelNames<'static>],
    column: &str,
    values: &[&str],
) -> Vec<&'a ChannelNames<'static>> {
    let is_meant =
        |row: &&ChannelNames<'_>| row.columns[0] == column && values.contains(&row.values);
    all.iter().filter(is_meant).collect()
}

/// A log, and whether each quantity is in it.
struct Log {
    sources: [Source; 1],
    names: Vec<String>,
}

fn log(all: &[ChannelNames<'static>], data: &Measurements, rng: &mut ChaCha8Rng) -> Log {
    let wanted = [
        (1.0, of(all, "rev_{i}", &["rev", "rad", "deg"])),
        (0.8, of(all, "force_{i}_n", &["force", "kforce"])),
        (0.7, of(all, "laser_m", &["laser", "lasermm"])),
        (0.9, of(all, "x_m", &["pose", "posemm", "posequatw"])),
    ];
    let others = of(
        all,
        "-",
        &["velocity", "torque", "noise", "status", "constant"],
    );
    let mut chosen: Vec<&ChannelNames<'_>> = Vec::new();
    for (share, rows) in &wanted {
        if rng.random_bool(*share) {
            chosen.extend(rows.choose(rng).copied());
        }
    }
    chosen.extend(others.sample(rng, 4));
    let mut log = source(chosen[0], data);
    let mut channels: Vec<Channel> = Vec::new();
    for row in chosen {
        let more = source(row, data).series.remove(0).channels;
        let is_new = |one: &Channel| channels.iter().all(|known| known.name != one.name);
        if more.iter().all(is_new) {
            channels.extend(more);
        }
    }
    let names = channels
        .iter()
        .map(|channel| channel.name.clone())
        .collect();
    // A winch that counts the other way round, or all of them.
    let rev = source(chosen_rev(&wanted[0].1, &channels), data)
        .series
        .remove(0)
        .channels;
    let turned: Vec<&str> = match rng.random_range(0..3) {
        0 => rev.iter().map(|channel| channel.name.as_str()).collect(),
        1 => vec![rev[rng.random_range(0..rev.len())].name.as_str()],
        _ => Vec::new(),
    };
    for channel in &mut channels {
        if turned.contains(&channel.name.as_str()) {
            channel.values = channel.values.iter().map(|value| -value).collect();
        }
    }
    channels.shuffle(rng);
    log.series[0].channels = channels;
    Log {
        sources: [log],
        names,
    }
}

/// The row whose channels are the winches of a log.
fn chosen_rev<'a>(
    rows: &[&'a ChannelNames<'static>],
    channels: &[Channel],
) -> &'a ChannelNames<'static> {
    let is_there = |row: &&&ChannelNames<'_>| {
        let name = row.names[0].replace("{0}", "0").replace("{1}", "1");
        let (name, _) = tautline_channels::split_heading(&name);
        channels[0].name == name
    };
    rows.iter().find(is_there).copied().expect("winches first")
}

/// Columns of the import that differ from the readings that the log holds.
fn differing(imported: &Imported, data: &Measurements) -> Vec<String> {
    let mut wrong = Vec::new();
    let read = &imported.measurements;
    let differs = |found: f64, expected: f64| {
        let off = (found - expected).abs();
        off.is_nan() || off > EQUAL * expected.abs().max(1e-3)
    };
    let grids = [
        ("rev", &read.revolutions, &data.revolutions),
        ("force", &read.force_n, &data.force_n),
    ];
    for (name, found, expected) in grids {
        for cable in 0..found.columns() {
            let mut rows = 0..found.rows();
            if rows.any(|row| differs(found.get(row, cable), expected.get(row, cable))) {
                wrong.push(format!("{name}_{}", cable + 1));
            }
        }
    }
    let mut laser = read.laser_m.iter().zip(&data.laser_m);
    if laser.any(|(found, expected)| differs(*found, *expected)) {
        wrong.push("laser_m".into());
    }
    for (found, expected) in read.commanded.iter().zip(&data.commanded) {
        let (Some(found), Some(expected)) = (found, expected) else {
            continue;
        };
        if (found.position - expected.position).norm() > EQUAL {
            wrong.push("x_m".into());
            break;
        }
    }
    wrong
}

#[test]
fn proposals_for_random_logs_are_right_or_say_what_is_doubtful() {
    let robot: Robot = presets::find("mini").expect("a preset").robot;
    let runs: Vec<Measurements> = (0..10)
        .map(|seed| {
            let run = simulate(&robot, &SimulationOptions::new(25, 40 + seed));
            run.expect("measurements").dataset.measurements
        })
        .collect();
    let all: Vec<ChannelNames<'static>> = rows().collect();
    let mut not_right = Vec::new();
    let mut silent = Vec::new();
    for seed in 0..LOGS {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let data = &runs[rng.random_range(0..runs.len())];
        let log = log(&all, data, &mut rng);
        let (recipe, notices) = propose(&log.sources, &robot);
        let budget = MemoryBudget::default();
        let imported = import_corrected(&log.sources, &recipe, "recipe", &robot, (false, &budget));
        let imported = match imported {
            Ok(imported) => imported,
            Err(error) => {
                not_right.push(format!("{seed}: {error}; {:?}", log.names));
                continue;
            }
        };
        let wrong = differing(&imported, data);
        let is_complete = imported.measurements.revolutions.columns() == robot.cable_count();
        if !wrong.is_empty() || !is_complete {
            not_right.push(format!("{seed}: {wrong:?} of {:?}; {notices:?}", log.names));
        }
        let told = imported
            .document
            .suggestions
            .iter()
            .flat_map(|one| &one.columns);
        let told: Vec<&String> = told.collect();
        let is_told = |column: &String| {
            told.iter().any(|told| told.starts_with(column.as_str()))
                || notices
                    .iter()
                    .chain(&imported.document.notices)
                    .any(|notice| notice.contains("assumed") || notice.contains("taken for"))
        };
        silent.extend(
            wrong
                .into_iter()
                .filter(|column| !is_told(column))
                .map(|column| format!("{seed}: {column} of {:?}", log.names)),
        );
    }
    println!(
        "{LOGS} random logs: {} right",
        LOGS as usize - not_right.len()
    );
    assert_eq!(silent, [""; 0]);
    let share = 1.0 - not_right.len() as f64 / LOGS as f64;
    assert!(share >= RIGHT, "{share}\n{}", not_right.join("\n"));
}
