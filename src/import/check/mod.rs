//! Common mistakes in logs, found by comparing readings with their expected values at the poses.
//!
//! With commanded or measured poses, or those that redundant cables have by their lengths, every reading has an expected
//! value: lengths and swivel angles from the kinematics, laser distances from the target plane. The regression of the
//! readings on these values has a slope: 1 if all is well, -1 with the wrong sign, 360 in degrees instead of revolutions.
//! If the readings fit the values of another channel instead, channels are swapped; if they fit with one step, an encoder
//! has lost counts. Forces have no expected values, but must balance the platform.

mod expected;
mod forces;
mod lengths;
mod line;
mod suggestion;

use std::collections::BTreeMap;

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::Robot;

use crate::external::other_frame;
use crate::median::median;
use crate::recipe::{Quantity, QuantityKind as Kind};
use expected::Expected;
pub use line::Line;
pub(crate) use line::fit;
use line::{best_step, whole_turns};
pub use suggestion::{Change, Mistake, Suggestion};

/// Minimum number of poses for a check.
const FEWEST: usize = 6;
/// A channel fits if the scatter about its line is below this fraction of its own scatter.
const FITS: f64 = 0.25;
/// A channel is another cable's if its scatter about the line of that cable is smaller by this factor: errors of pulleys by
/// centimetres cause similar scatter for both.
const APART: f64 = 3.0;
/// An offset of a cable above this share of the frame is a piece of cable, if it is larger than the usual one by this factor.
const EXTENSION: f64 = 0.05;
const EXTENSIONS_APART: f64 = 10.0;
/// Share of an offset within which half of its values lie, if it is constant.
const CONSTANT: f64 = 0.05;
/// From this share on the readings of all winches are those of other drums, if they are alike within this one: below, the diagnosis
/// estimates their scale with its uncertainty.
const OTHER_DRUMS: f64 = 0.05;
const ALIKE: f64 = 0.06;
/// A slope is a known factor within this share of it. Drums and pulleys are known far better.
const FACTOR: f64 = 0.12;

/// Readings at the poses before any plausibility check.
#[derive(Clone)]
pub(crate) struct Readings {
    /// Labels of the poses.
    pub labels: Vec<i64>,
    /// Values by column; NaN where there is none.
    pub columns: BTreeMap<Quantity, Vec<f64>>,
}

impl Readings {
    /// The columns of a table of poses.
    fn of_measurements(data: &Measurements) -> Self {
        let rows = data.len();
        let mut columns = BTreeMap::new();
        let mut add = |kind, count: usize, value: &dyn Fn(usize, usize) -> f64| {
            for index in 0..count {
                let values = (0..rows).map(|row| value(row, index)).collect();
                columns.insert(Quantity { kind, index }, values);
            }
        };
        let grids = [
            (Kind::Revolutions, &data.revolutions),
            (Kind::Length, &data.length_m),
            (Kind::Force, &data.force_n),
            (Kind::Swivel, &data.swivel_rad),
        ];
        let is_read = |(_, grid): &(Kind, &Grid)| !grid.is_empty();
        for (kind, grid) in grids.into_iter().filter(is_read) {
            add(kind, grid.columns(), &|row, cable| grid.get(row, cable));
        }
        add(Kind::Laser, data.laser_m.len().min(1), &|row, _| {
            data.laser_m[row]
        });
        let vectors = [
            (Kind::Inclination, &data.inclination_rad),
            (Kind::Tracked, &data.tracked_position_m),
        ];
        for (kind, vectors) in vectors {
            add(kind, 3 * vectors.len().min(1), &|row, k| vectors[row][k]);
        }
        add(Kind::Commanded, 7, &|row, k| {
            let pose = data.commanded.get(row).copied().flatten();
            pose.map_or(f64::NAN, |pose| match k {
                0..3 => pose.position[k],
                _ => pose.orientation_wxyz()[k - 3],
            })
        });
        Self {
            labels: data.labels.clone(),
            columns,
        }
    }

    /// Measured positions (m) with the poses of these rows, where both are known. A coordinate that is not measured, such as the
    /// height of a plotter, is that of the pose.
    fn measured_with(&self, poses: &[Option<Pose>]) -> Option<Vec<(Vec3, Pose)>> {
        let kind = Kind::Tracked;
        let column = |index: usize| self.columns.get(&Quantity { kind, index });
        let (x, y, z) = (column(0)?, column(1)?, column(2)?);
        let at = |(row, pose): (usize, &Option<Pose>)| {
            let read = Vec3::new(x[row], y[row], z[row]);
            let is_there = read.iter().filter(|v| v.is_finite()).count() > 1;
            let or_pose = |read: f64, of_pose: f64| if read.is_finite() { read } else { of_pose };
            let pose = pose.filter(|_| is_there)?;
            Some((read.zip_map(&pose.position, or_pose), pose))
        };
        Some(poses.iter().enumerate().filter_map(at).collect())
    }

    /// All columns of one kind with their quantities.
    fn of(&self, kind: Kind) -> Vec<(Quantity, &[f64])> {
        let found = self
            .columns
            .iter()
            .filter(|(quantity, _)| quantity.kind == kind);
        found
            .map(|(quantity, values)| (*quantity, values.as_slice()))
            .collect()
    }
}

/// Result of the check of a table of poses.
#[derive(Debug, Clone)]
pub struct TableCheck {
    /// Mistakes, with corrections.
    pub suggestions: Vec<Suggestion>,
    /// Changes of length that are read, against those expected at the poses, for each cable; `None` if they cannot be
    /// compared.
    pub lengths: Vec<Option<Line>>,
}

/// Checks a table of poses.
#[must_use]
pub fn check_table(measurements: &Measurements, robot: &Robot) -> TableCheck {
    let readings = Readings::of_measurements(measurements);
    let expected = Expected::of(&readings, robot);
    let kind = match measurements.revolutions.is_empty() {
        true => Kind::Length,
        false => Kind::Revolutions,
    };
    let line = |index: usize| {
        let quantity = Quantity { kind, index };
        fit(expected.column(quantity)?, readings.columns.get(&quantity)?)
    };
    TableCheck {
        suggestions: suggestions(&readings, &expected, robot),
        lengths: (0..robot.cable_count()).map(line).collect(),
    }
}

/// Finds mistakes and suggests corrections.
pub(crate) fn check(readings: &Readings, robot: &Robot) -> Vec<Suggestion> {
    suggestions(readings, &Expected::of(readings, robot), robot)
}

fn suggestions(readings: &Readings, expected: &Expected, robot: &Robot) -> Vec<Suggestion> {
    let mut found = Vec::new();
    dead_channels(readings, &mut found);
    if readings.labels.len() < FEWEST {
        return found;
    }
    for kind in [Kind::Commanded, Kind::Tracked] {
        positions_in_other_unit(readings, robot, kind, &mut found);
    }
    if !found
        .iter()
        .any(|suggestion| suggestion.is_of(Kind::Commanded))
    {
        for kind in [
            Kind::Revolutions,
            Kind::Change,
            Kind::Length,
            Kind::Swivel,
            Kind::Laser,
            Kind::Inclination,
            Kind::Tracked,
        ] {
            let is_dead = |quantity: &Quantity| {
                found.iter().any(|suggestion: &Suggestion| {
                    suggestion.mistake == Mistake::DeadChannel
                        && suggestion.columns.contains(&quantity.column())
                })
            };
            let columns: Vec<Comparison<'_>> = readings
                .of(kind)
                .into_iter()
                .filter(|(quantity, _)| !is_dead(quantity))
                .filter_map(|(quantity, values)| {
                    Some(Comparison {
                        quantity,
                        values,
                        expected: expected.column(quantity)?,
                    })
                })
                .collect();
            let in_other_unit = found.iter().any(|suggestion| {
                suggestion.is_of(kind) && suggestion.mistake == Mistake::WrongUnit
            });
            if !in_other_unit {
                compare(&columns, readings, expected, robot, &mut found);
            }
        }
        frame(readings, expected, robot, &mut found);
        forces::check(readings, expected, robot, &mut found);
    }
    angles_in_degrees(readings, &mut found);
    found
}

/// A column with its expected values.
struct Comparison<'a> {
    quantity: Quantity,
    values: &'a [f64],
    expected: &'a [f64],
}

/// Factors by which values differ in common wrong units.
fn factors(kind: Kind) -> &'static [(f64, &'static str)] {
    match kind {
        Kind::Revolutions => &[(360.0, "degrees"), (std::f64::consts::TAU, "radians")],
        Kind::Swivel | Kind::Inclination => &[(180.0 / std::f64::consts::PI, "degrees")],
        _ => &[
            (1e3, "millimetres"),
            (1e2, "centimetres"),
            (1.0 / 0.0254, "inches"),
        ],
    }
}

/// Factors of a channel whose drive has another number of counts per revolution.
const COUNTS: [(f64, &str); 4] = [
    (2.0, COUNTED),
    (4.0, COUNTED),
    (8.0, COUNTED),
    (16.0, COUNTED),
];
const COUNTED: &str = "micro-steps or counts per revolution are other ones than stated";

/// Finds channels that are constant while others of their kind vary.
fn dead_channels(readings: &Readings, found: &mut Vec<Suggestion>) {
    for kind in [
        Kind::Revolutions,
        Kind::Change,
        Kind::Length,
        Kind::Force,
        Kind::Swivel,
    ] {
        let columns = readings.of(kind);
        let dead: Vec<(String, usize)> = columns
            .iter()
            .filter_map(|(quantity, values)| Some((quantity.column(), constant_from(values)?)))
            .collect();
        if dead.len() * 2 > columns.len() {
            continue;
        }
        for (column, first) in dead {
            let whole = first == readings.labels.len();
            let since = (!whole).then(|| readings.labels[first]);
            let when = match since {
                None => "over all poses".to_owned(),
                Some(label) => format!("from pose {label} on"),
            };
            let sentence = format!(
                "{column} is constant {when} while the other cables change: a dead channel; leave it empty{}",
                if whole { "" } else { " there" }
            );
            let change = Change::LeaveEmpty {
                column,
                from_pose: since,
            };
            found.push(Suggestion::new(sentence, change));
        }
    }
}

/// The row from which on the readings stay constant; the number of rows if all are equal, `None` if they vary until the end.
fn constant_from(values: &[f64]) -> Option<usize> {
    let there: Vec<usize> = (0..values.len())
        .filter(|row| !values[*row].is_nan())
        .collect();
    let last = values[*there.last()?];
    let same = there
        .iter()
        .rev()
        .take_while(|row| values[**row] == last)
        .count();
    match (same >= FEWEST, same == there.len()) {
        (true, true) => Some(values.len()),
        // The first of equal readings is the last one that was read.
        (true, false) => Some(there[there.len() - same + 1]),
        (false, _) => None,
    }
}

/// Finds positions many times larger than the frame.
fn positions_in_other_unit(
    readings: &Readings,
    robot: &Robot,
    kind: Kind,
    found: &mut Vec<Suggestion>,
) {
    let Some(frame_m) = robot.frame_size_m() else {
        return;
    };
    let columns = readings.of(kind);
    let positions = columns.iter().filter(|(quantity, _)| quantity.index < 3);
    let largest = positions
        .clone()
        .flat_map(|(_, values)| values.iter())
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    if largest < 10.0 * frame_m {
        return;
    }
    let factor = factors(kind)
        .iter()
        .find(|(factor, _)| largest / factor < 3.0 * frame_m && largest / factor > 1e-3 * frame_m);
    if let Some((factor, unit)) = factor {
        let sentence = |names: &str| {
            format!("{names} reach {largest:.0} m in a frame of {frame_m:.1} m: {unit}, not metres")
        };
        let columns = positions.map(|(quantity, _)| quantity.column());
        found.push(Suggestion::multiply(
            columns.collect(),
            1.0 / factor,
            sentence,
        ));
    }
}

/// Finds measured positions in another frame: rotated or shifted relative to the robot's.
fn frame(readings: &Readings, expected: &Expected, robot: &Robot, found: &mut Vec<Suggestion>) {
    let Some(robot_m) = robot.frame_size_m() else {
        return;
    };
    if found
        .iter()
        .any(|suggestion| suggestion.is_of(Kind::Tracked))
    {
        return;
    }
    let (kind, index) = (Kind::Tracked, 0);
    // Measured poses that serve as expected ones are in the frame of the robot.
    if expected.column(Quantity { kind, index }).is_none() {
        return;
    }
    let Some(positions) = readings.measured_with(&expected.poses) else {
        return;
    };
    if let Some(sentence) = other_frame(&positions, robot_m) {
        found.push(Suggestion::new(sentence, Change::AlignInstrument));
    }
}

/// Inclinometer angles beyond a full turn must be degrees.
fn angles_in_degrees(readings: &Readings, found: &mut Vec<Suggestion>) {
    for kind in [Kind::Inclination, Kind::Swivel] {
        let columns = readings.of(kind);
        let beyond = columns.iter().any(|(_, values)| {
            values
                .iter()
                .any(|value| value.abs() > 2.0 * std::f64::consts::PI)
        });
        if beyond
            && !found.iter().any(|suggestion| {
                suggestion.is_of(kind) && suggestion.mistake == Mistake::WrongUnit
            })
        {
            let sentence =
                |names: &str| format!("{names} exceed a full turn: degrees, not radians");
            let columns = columns.iter().map(|(quantity, _)| quantity.column());
            let factor = std::f64::consts::PI / 180.0;
            found.push(Suggestion::multiply(columns.collect(), factor, sentence));
        }
    }
}

/// Compares the columns of a kind with their expected values.
fn compare(
    columns: &[Comparison<'_>],
    readings: &Readings,
    expected: &Expected,
    robot: &Robot,
    found: &mut Vec<Suggestion>,
) {
    let mut values: Vec<Vec<f64>> = columns
        .iter()
        .map(|column| column.values.to_vec())
        .collect();
    // Poses that are computed from the lengths would move with the step.
    let moved = (columns.iter().zip(&mut values)).filter(|_| !expected.from_lengths);
    for (column, values) in moved {
        steps(column, values, readings, robot, found);
    }
    let own: Vec<Option<Line>> = columns
        .iter()
        .zip(&values)
        .map(|(column, values)| fit(column.expected, values))
        .collect();
    let mut exchanged = vec![false; columns.len()];
    for i in 0..columns.len() {
        for j in 0..i {
            // With either sign, the values of another cable fit the channel many times better than its own.
            let fits = |value: usize, expected: usize| {
                let Some(as_other) = fit(columns[expected].expected, &values[value]) else {
                    return false;
                };
                as_other.slope > 0.0
                    && as_other.scatter < FITS
                    && own[value].is_some_and(|line| line.scatter > APART * as_other.scatter)
            };
            if !exchanged[i] && !exchanged[j] && fits(i, j) && fits(j, i) {
                exchanged[i] = true;
                exchanged[j] = true;
                let (a, b) = (columns[j].quantity.column(), columns[i].quantity.column());
                let sentence = format!(
                    "{a} follows the expected values of {b}, and vice versa: their channels are swapped"
                );
                found.push(Suggestion::new(sentence, Change::Exchange { a, b }));
            }
        }
    }
    let fitting: Vec<(usize, Line)> = (0..columns.len())
        .filter_map(|k| Some((k, own[k]?)))
        .filter(|(k, line)| line.scatter < FITS && !exchanged[*k])
        .collect();
    signs(columns, &fitting, found);
    units(columns, &fitting, found);
    if let Some(first) = readings.labels.first().filter(|_| !expected.from_lengths) {
        extensions(columns, &fitting, robot, found, *first);
    }
}

/// Finds encoder steps and removes them from the values.
fn steps(
    column: &Comparison<'_>,
    values: &mut [f64],
    readings: &Readings,
    robot: &Robot,
    found: &mut Vec<Suggestion>,
) {
    let unit_m = match column.quantity.kind {
        Kind::Revolutions => robot.cables[column.quantity.index]
            .winch
            .cable_per_revolution_m(),
        Kind::Change | Kind::Length => 1.0,
        _ => return,
    };
    if column.quantity.kind == Kind::Revolutions {
        for (row, turns) in whole_turns(column.expected, values) {
            let from_pose = readings.labels[row];
            let name = column.quantity.column();
            let many = if turns.abs() == 1.0 { "turn" } else { "turns" };
            let sentence = format!(
                "{name} jumps by {turns:+} whole {many} at pose {from_pose} and keeps the offset: the encoder lost its count of turns"
            );
            values[row..].iter_mut().for_each(|value| *value -= turns);
            let (column, add) = (name, -turns);
            let change = Change::TakeBack {
                column,
                from_pose,
                add,
            };
            found.push(Suggestion {
                mistake: Mistake::LostTurns,
                ..Suggestion::new(sentence, change)
            });
        }
    }
    let Some(step) = best_step(column.expected, values) else {
        return;
    };
    // The size is in the unit of the column, whatever the unit of the values.
    let size_m = step.size / step.slope.abs() * unit_m;
    if size_m.abs() < 5e-3 {
        return;
    }
    let from_pose = readings.labels[step.row];
    let name = column.quantity.column();
    let sentence = format!(
        "{name} jumps by {:.4} ({:.1} mm of cable) at pose {from_pose} and keeps the offset: the encoder lost counts, or the cable slipped",
        step.size,
        1e3 * size_m
    );
    values[step.row..]
        .iter_mut()
        .for_each(|value| *value -= step.size);
    found.push(Suggestion::new(
        sentence,
        Change::TakeBack {
            column: name,
            from_pose,
            add: -step.size,
        },
    ));
}

/// Finds a cable that is longer by the same large amount at all poses, as by a piece that robot.json does not state.
fn extensions(
    columns: &[Comparison<'_>],
    fitting: &[(usize, Line)],
    robot: &Robot,
    found: &mut Vec<Suggestion>,
    first_pose: i64,
) {
    let Some(frame_m) = robot.frame_size_m() else {
        return;
    };
    let is_right = |line: &Line| (line.slope - 1.0).abs() < FACTOR;
    let of_length = |k: &usize| columns[*k].quantity.kind == Kind::Length;
    let offsets: Vec<(usize, f64, f64)> = fitting
        .iter()
        .filter(|(k, line)| of_length(k) && is_right(line))
        .filter_map(|(k, _)| {
            let pairs = columns[*k].values.iter().zip(columns[*k].expected);
            let off = pairs.map(|(read, expected)| read - expected);
            let there = off.filter(|off| off.is_finite());
            let middle = median(there.clone())?;
            let varies = median(there.map(|off| (off - middle).abs()))?;
            Some((*k, middle, varies))
        })
        .collect();
    for (k, off, varies) in &offsets {
        let others = offsets.iter().filter(|(other, ..)| other != k);
        let usual = median(others.map(|(_, off, _)| off.abs())).unwrap_or(f64::INFINITY);
        // A pulley elsewhere makes a cable longer at some poses than at others.
        let is_constant = *varies < CONSTANT * off.abs();
        if is_constant && off.abs() > EXTENSION * frame_m && off.abs() > EXTENSIONS_APART * usual {
            let column = columns[*k].quantity.column();
            let sentence = format!(
                "{column} is {:.3} m {} at all poses than these require: a piece of cable that robot.json does not state, or another zero",
                off.abs(),
                if *off > 0.0 { "longer" } else { "shorter" }
            );
            let (from_pose, add) = (first_pose, -off);
            let change = Change::TakeBack {
                column,
                from_pose,
                add,
            };
            found.push(Suggestion {
                mistake: Mistake::Extension,
                ..Suggestion::new(sentence, change)
            });
        }
    }
}

fn signs(columns: &[Comparison<'_>], fitting: &[(usize, Line)], found: &mut Vec<Suggestion>) {
    // Distances and lengths have no sign that could be reversed, but one that is wrong.
    let may_be_reversed = |k: usize| match columns[k].quantity.kind {
        Kind::Laser | Kind::Length => {
            let there = columns[k].values.iter().copied();
            median(there.filter(|value| value.is_finite())).is_some_and(|middle| middle < 0.0)
        }
        _ => true,
    };
    let negative: Vec<usize> = fitting
        .iter()
        .filter(|(k, line)| line.slope < 0.0 && may_be_reversed(*k))
        .map(|(k, _)| *k)
        .collect();
    let name = |k: usize| columns[k].quantity.column();
    let what = |columns: &[String]| match columns {
        [one] => format!("{one} falls where it should rise: its sign is reversed"),
        _ => format!(
            "{} fall where they should rise: their signs are reversed",
            columns.join(", ")
        ),
    };
    // If all signs are reversed it is one mistake; otherwise each channel has its own.
    let whole = negative.len() == fitting.len() && fitting.len() > 1;
    let groups: Vec<Vec<String>> = match whole {
        true => vec![negative.iter().map(|k| name(*k)).collect()],
        false => negative.iter().map(|k| vec![name(*k)]).collect(),
    };
    for columns in groups {
        let sentence = what(&columns);
        found.push(Suggestion::new(sentence, Change::Reverse { columns }));
    }
}

fn units(columns: &[Comparison<'_>], fitting: &[(usize, Line)], found: &mut Vec<Suggestion>) {
    let Some(kind) = columns.first().map(|column| column.quantity.kind) else {
        return;
    };
    let counts = match kind {
        Kind::Revolutions | Kind::Change | Kind::Length => &COUNTS[..],
        _ => &[],
    };
    let mut is_known = false;
    for (factor, unit) in factors(kind).iter().chain(counts) {
        for (inverse, factor) in [(false, *factor), (true, 1.0 / factor)] {
            let is_factor = |line: &Line| (line.slope.abs() / factor - 1.0).abs() < FACTOR;
            let columns: Vec<String> = fitting
                .iter()
                .filter(|(_, line)| is_factor(line))
                .map(|(k, _)| columns[*k].quantity.column())
                .collect();
            if columns.is_empty() {
                continue;
            }
            let times = if inverse { 1.0 / factor } else { factor };
            let how = if inverse { "too small" } else { "too large" };
            let why = match (*unit, inverse) {
                (COUNTED, _) => COUNTED.to_owned(),
                (_, true) => "a unit was converted twice".to_owned(),
                (_, false) => format!("{unit}, not the unit of the column"),
            };
            let sentence =
                |names: &str| format!("{names}: {times:.4} times {how} for these poses: {why}");
            found.push(Suggestion::multiply(columns, 1.0 / factor, sentence));
            is_known = true;
        }
    }
    let counts_from_home = matches!(kind, Kind::Revolutions | Kind::Change);
    if counts_from_home && !is_known && fitting.len() == columns.len() {
        other_drums(columns, fitting, found);
    }
}

/// Finds a ratio by which the readings of all winches differ, as those of a machine with other drums or gears.
fn other_drums(columns: &[Comparison<'_>], fitting: &[(usize, Line)], found: &mut Vec<Suggestion>) {
    let slopes = fitting.iter().map(|(_, line)| line.slope);
    let Some(ratio) = median(slopes.clone()).filter(|ratio| *ratio > 0.0) else {
        return;
    };
    let is_alike = |slope: f64| (slope / ratio - 1.0).abs() < ALIKE;
    if slopes.into_iter().all(is_alike) && (ratio - 1.0).abs() > OTHER_DRUMS {
        let columns = columns.iter().map(|column| column.quantity.column());
        let sentence = |names: &str| {
            format!(
                "{names}: all {ratio:.3} times what these poses need: drums, gears or counts of another machine"
            )
        };
        found.push(Suggestion::multiply(
            columns.collect(),
            1.0 / ratio,
            sentence,
        ));
    }
}

#[cfg(test)]
mod tests;
