//! Proposals for names of channels that other programs use: most are recognised, and none is assigned wrongly.

mod damaged;
mod random_logs;
mod recordings;

use std::f64::consts::TAU;

use tautline_channels::{Channel, Format, Series, Source, split_heading};
use tautline_core::measurement::Measurements;
use tautline_core::robot::{PerAxis, Robot, Tracker, presets};
use tautline_core::simulation::{SimulationOptions, simulate};

use super::propose;
use crate::recipe::Assignment;

const NAMES: &str = include_str!("names.csv");

/// Required fraction of recognised names.
const RECOGNISED: f64 = 0.9;

/// Names of one quantity or one pose.
struct ChannelNames<'a> {
    names: Vec<&'a str>,
    unit: &'a str,
    values: &'a str,
    columns: Vec<&'a str>,
}

fn rows() -> impl Iterator<Item = ChannelNames<'static>> {
    let lines = NAMES.lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| {
        let cells: Vec<&str> = line.splitn(5, ';').collect();
        let [names, unit, values, columns, source] = cells[..] else {
            panic!("five cells, found {line}");
        };
        assert!(source.len() > 3, "a source of {names}");
        ChannelNames {
            names: names.split('|').collect(),
            unit,
            values,
            columns: columns.split('|').collect(),
        }
    })
}

/// The value of channel `k` of a row at a pose; cables and components of a pose are counted from 0.
fn value(data: &Measurements, what: &str, k: usize, row: usize) -> f64 {
    let pose = data.commanded[row].expect("commanded");
    let [w, x, y, z] = pose.orientation_wxyz();
    let at = |k: usize| pose.position.get(k).copied();
    let with_w_last = || at(k).unwrap_or_else(|| [x, y, z, w][k - 3]);
    let with_w_first = || at(k).unwrap_or_else(|| [w, x, y, z][k - 3]);
    let wave = (1.7 * row as f64 + k as f64).sin();
    let rev = |k: usize| data.revolutions.get(row, k % 8);
    // A length as a controller would state it.
    let length = |k: usize| 0.6 + 0.1257 * rev(k);
    match what {
        "time" => 0.5 * row as f64,
        "ms" => 500.0 * row as f64,
        "us" => 5e5 * row as f64,
        "ns" => 1.7e18 + 5e8 * row as f64,
        "rev" => rev(k),
        "rad" => TAU * rev(k),
        "deg" => 360.0 * rev(k),
        "counts" => (1e4 * rev(k)).round(),
        "length" => length(k),
        "force" => data.force_n.get(row, k % 8),
        "kforce" => 1e-3 * data.force_n.get(row, k % 8),
        "swivel" => 0.3 * wave,
        "laser" => data.laser_m[row],
        "lasermm" => 1e3 * data.laser_m[row],
        "temp" => 21.0 + 0.4 * wave,
        "velocity" | "torque" => 2.0 * wave,
        "noise" => 1e-3 * wave,
        "status" => f64::from(u8::from(wave > 0.0)),
        "constant" => 1.0 + k as f64,
        "angles" => 0.1 * wave,
        "pose" | "measured" | "posequat" => with_w_last(),
        "posequatw" => with_w_first(),
        "posemm" | "measuredmm" => 1e3 * with_w_last(),
        "pose6" => at(k).unwrap_or(0.1 * wave),
        _ => panic!("unknown values {what}"),
    }
}

/// A file with the channels of a row; patterns have one for each of eight cables.
fn source(row: &ChannelNames<'_>, data: &Measurements) -> Source {
    let mut channels = Vec::new();
    let mut add = |heading: &str, k: usize| {
        let (name, unit) = split_heading(heading);
        channels.push(Channel {
            name,
            unit: Some(row.unit.to_owned())
                .filter(|unit| !unit.is_empty())
                .or(unit),
            values: (0..data.len())
                .map(|at| value(data, row.values, k, at))
                .collect(),
        });
    };
    for (k, name) in row.names.iter().enumerate() {
        let pattern = ["{0}", "{1}"].into_iter().enumerate();
        match pattern
            .into_iter()
            .find(|(_, number)| name.contains(number))
        {
            Some((first, number)) => {
                for cable in 0..8 {
                    add(&name.replace(number, &(cable + first).to_string()), cable);
                }
            }
            None => add(name, k),
        }
    }
    Source {
        file: "log.csv".into(),
        format: Format::Table,
        series: vec![Series {
            name: "log".into(),
            rows: data.len(),
            channels,
            ..Series::default()
        }],
        notices: Vec::new(),
    }
}

/// Names that are assigned wrongly, missed and recognised.
#[derive(Default)]
struct Score {
    wrong: Vec<String>,
    missed: Vec<String>,
    recognised: usize,
}

impl Score {
    /// Compares the proposal for a row with what is expected.
    fn add(&mut self, row: &ChannelNames<'_>, robot: &Robot, data: &Measurements) {
        let source = source(row, data);
        let (recipe, _) = propose(std::slice::from_ref(&source), robot);
        for (name, expected) in row.names.iter().zip(&row.columns) {
            let (first, _) = split_heading(&name.replace("{0}", "0").replace("{1}", "1"));
            let is_of = |known: &&Assignment| {
                let own = known.channel.replacen("{i}", &known.first.to_string(), 1);
                own == first
            };
            let found = recipe.channels.iter().find(is_of);
            match found.map(|known| known.quantity.as_str()) {
                Some(found) if found == *expected => self.recognised += 1,
                Some(found) => self
                    .wrong
                    .push(format!("{name} is {found}, not {expected}")),
                None if *expected != "-" => self.missed.push(format!("{name} is no {expected}")),
                None => {}
            }
        }
    }
}

#[test]
fn names_of_other_laboratories_are_recognised_and_none_is_assigned_wrongly() {
    let mini = presets::find("mini").expect("a preset").robot;
    let run = simulate(&mini, &SimulationOptions::new(30, 4)).expect("measurements");
    let data = run.dataset.measurements;
    let tracked = Robot {
        tracker: Some(Tracker {
            position_sd_m: PerAxis::Same(1e-3),
            orientation_sd_rad: Some(1e-3),
        }),
        ..mini.clone()
    };
    let mut score = Score::default();
    let mut names = 0;
    for row in rows() {
        let is_measured = row.columns[0].starts_with("meas_");
        score.add(&row, if is_measured { &tracked } else { &mini }, &data);
        names += row.names.len();
    }
    let wanted = score.recognised + score.missed.len();
    println!(
        "{names} names, {} of {wanted} recognised; not: {:#?}",
        score.recognised, score.missed
    );
    assert!(names >= 150, "{names} names");
    assert_eq!(score.wrong, [""; 0]);
    let share = score.recognised as f64 / wanted as f64;
    assert!(share >= RECOGNISED, "{share}: {:#?}", score.missed);
}
