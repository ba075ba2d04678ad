//! Rows to poses.

mod clock;
mod interpolation;
mod rest;

use std::collections::BTreeMap;
use std::ops::Range;

use tautline_channels::{MemoryBudget, Series, Source};
use tautline_core::measurement::{SampledChannel, follows_a_motion};
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError, quoted};

use crate::recipe::{
    Cutting, Mapped, Mapping, Quantity, QuantityKind as Kind, Recipe, Rest, resolve,
};
pub(crate) use clock::Times;
use rest::Limits;

/// Maximum number of samples of a recording in motion that a dataset gets: far more than are independent.
const MOST_IMPORTED_SAMPLES: usize = 60_000;
/// Minimum number of rows of a recording: fewer rows are poses, one per row.
const RECORDING: usize = 100;
/// Minimum number of standstills of a recording of poses at rest: any recording may begin and end with one.
const FEWEST_RESTS: usize = 3;
/// Bytes of a reading of a pose: with its deviation here and in the document, as a column of the checks, as text, and as a measurement.
const READING: u64 = 256;

/// A pose with its mean readings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CutPose {
    /// Label, if the recipe assigns one.
    pub label: Option<String>,
    /// Group, if the recipe assigns one.
    pub group: Option<String>,
    /// Begin and end (s).
    pub time_s: Option<[f64; 2]>,
    /// First row in the main series.
    pub first_row: usize,
    /// Number of rows of the pose.
    pub rows: usize,
    /// Means of the quantities.
    pub readings: BTreeMap<Quantity, Averaged>,
}

/// Mean of the readings of one channel at a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Averaged {
    pub mean: f64,
    /// Standard deviation of a single reading; NaN if there is only one.
    pub sd: f64,
    pub number: usize,
}

/// Whether a series has at least the number of rows of a recording.
pub(crate) fn is_recording(series: &Series) -> bool {
    series.rows >= RECORDING
}

/// Whether a recording has poses at rest: several standstills, with more than five rows each on average.
pub(crate) fn sampled_at_rest(sources: &[Source], recipe: &Recipe, robot: &Robot) -> bool {
    let Ok(mapping) = resolve(sources, recipe, "recipe", robot.cable_count()) else {
        return false;
    };
    let main = main_series(&mapping);
    let times = Times::of(&mapping, main, recipe);
    let Some(time_s) = &times.time_s else {
        return false;
    };
    let limits = Limits::of(robot, &Rest::default());
    let rests = rest::find(&mapping, main, time_s, &Rest::default(), &limits);
    rests.len() >= FEWEST_RESTS && rests.len() * 5 < time_s.len()
}

/// Whether the rows of the main series are samples of a motion.
pub(crate) fn sampled_in_motion(sources: &[Source], recipe: &Recipe, robot: &Robot) -> bool {
    let Ok(mapping) = resolve(sources, recipe, "recipe", robot.cable_count()) else {
        return false;
    };
    let main = main_series(&mapping);
    let Some(time_s) = Times::of(&mapping, main, recipe).time_s else {
        return false;
    };
    let moving = mapping.quantities.iter();
    let moving: Vec<_> = moving
        .filter(|(quantity, mapped)| mapped.series == main && quantity.moves())
        .map(|(quantity, mapped)| {
            let values = &mapping.series[main].channels[mapped.channel].values;
            let value = |row: usize| mapped.factor * values.at(row);
            (value, reading_sd(robot, *quantity))
        })
        .collect();
    let channels: Vec<SampledChannel<'_>> = (moving.iter())
        .map(|(value, sd)| SampledChannel { value, sd: *sd })
        .collect();
    // As long as no channel that varies with the pose is assigned, rows with times count as samples.
    let moves = || channels.is_empty() || follows_a_motion(&time_s, &channels);
    is_recording(mapping.series[main]) && moves()
}

/// Standard deviation of the readings of a winch; 0 for other quantities.
fn reading_sd(robot: &Robot, quantity: Quantity) -> f64 {
    let winch = robot.cables.get(quantity.index).map(|cable| &cable.winch);
    match (quantity.kind, winch) {
        (Kind::Revolutions, Some(winch)) => winch.revolutions_sd(),
        (Kind::Change | Kind::Length, Some(winch)) => winch.length_sd_m,
        _ => 0.0,
    }
}

/// The series with most of the quantities that move with the platform.
pub(crate) fn main_series(mapping: &Mapping<'_>) -> usize {
    let mut counts = vec![0_usize; mapping.series.len()];
    for (quantity, mapped) in &mapping.quantities {
        counts[mapped.series] += if quantity.is_per_cable() { 64 } else { 1 };
    }
    (0..counts.len())
        .rev()
        .max_by_key(|k| counts[*k])
        .unwrap_or(0)
}

/// Cuts sources into poses.
///
/// # Errors
/// If series cannot be matched, no pose is found, or there are more than the budget has memory for.
pub(crate) fn cut(
    mapping: &Mapping<'_>,
    recipe: &Recipe,
    (robot, budget): (&Robot, &MemoryBudget),
    file: &str,
    notices: &mut Vec<String>,
) -> Result<Vec<CutPose>, ReadError> {
    if mapping.quantities.is_empty() {
        let message = "no channel is assigned to a quantity of the robot: expected a recipe that assigns at least one";
        return Err(ReadError::new(file, Location::File, message));
    }
    let main = main_series(mapping);
    let all: Vec<Times> = (0..mapping.series.len())
        .map(|k| Times::of(mapping, k, recipe))
        .collect();
    for (k, times) in all.iter().enumerate() {
        if mapping.quantities.values().any(|mapped| mapped.series == k) {
            notices.extend(times.notices(&mapping.series[k].name));
        }
    }
    let rows = mapping.series[main].rows;
    let ranges: Vec<Range<usize>> = match &recipe.cutting {
        Cutting::Rows => (0..rows).map(|row| row..row + 1).collect(),
        Cutting::Motion => {
            all[main].expected_of(
                &mapping.series[main].name,
                file,
                "for a recording in motion",
            )?;
            let every = rows.div_ceil(MOST_IMPORTED_SAMPLES).max(1);
            if every > 1 {
                notices.push(format!("a recording of {rows} rows: one row in {every} is used, which leaves more than {} samples", MOST_IMPORTED_SAMPLES / 2));
            }
            (0..rows).step_by(every).map(|row| row..row + 1).collect()
        }
        Cutting::Labels => by_labels(mapping, main, file)?,
        Cutting::Rest(rest) => {
            let time_s =
                all[main].expected_of(&mapping.series[main].name, file, "to find rests")?;
            let limits = Limits::of(robot, rest);
            let found = rest::find(mapping, main, time_s, rest, &limits);
            if found.is_empty() {
                let message = format!(
                    "found no standstill of {} s in {rows} rows, expected poses at rest (minimum_s, speed_m_s in the recipe), or \"motion\" as the cutting of a recording in motion",
                    rest.minimum_s
                );
                return Err(ReadError::new(file, Location::File, message));
            }
            let kept: usize = found.iter().map(Range::len).sum();
            notices.push(format!("{} standstills with {kept} of {rows} rows; the other rows, in motion or settling, are not used", found.len()));
            found
        }
    };
    // A pose without readings takes as much as four readings.
    let readings = ranges.len().saturating_mul(4 + mapping.quantities.len());
    let taken = budget.temporary().take(READING * readings as u64);
    taken.map_err(|over| {
        let message = format!("a table of {} poses {over}", ranges.len());
        ReadError::new(file, Location::File, message)
    })?;
    let mut poses = Vec::with_capacity(ranges.len());
    for range in &ranges {
        poses.push(match recipe.cutting {
            Cutting::Motion => sample(mapping, main, &all, range.start),
            _ => pose(mapping, main, &all, range, file)?,
        });
    }
    from_first_pose(mapping, &mut poses);
    Ok(poses)
}

/// Runs of rows with the same label.
fn by_labels(
    mapping: &Mapping<'_>,
    main: usize,
    file: &str,
) -> Result<Vec<Range<usize>>, ReadError> {
    let label = mapping
        .quantities
        .iter()
        .find(|(quantity, mapped)| quantity.kind == Kind::Label && mapped.series == main);
    let Some((_, label)) = label else {
        let message =
            "cutting by labels needs a channel assigned to pose in the series of the cables";
        return Err(ReadError::new(file, Location::File, message));
    };
    let series = mapping.series[main];
    let same = |row: usize| match label.is_text {
        true => {
            series.texts[label.channel].codes[row] == series.texts[label.channel].codes[row - 1]
        }
        false => {
            let values = &series.channels[label.channel].values;
            values.at(row) == values.at(row - 1)
        }
    };
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for row in 0..series.rows {
        match ranges.last_mut() {
            Some(range) if same(row) => range.end = row + 1,
            _ => ranges.push(row..row + 1),
        }
    }
    Ok(ranges)
}

/// Mean readings over a range of rows of the main series, and over the matching rows of the other series.
fn pose(
    mapping: &Mapping<'_>,
    main: usize,
    times: &[Times],
    range: &Range<usize>,
    file: &str,
) -> Result<CutPose, ReadError> {
    let time_s = times[main]
        .time_s
        .as_ref()
        .map(|time_s| [time_s[range.start], time_s[range.end - 1]]);
    let mut pose = CutPose {
        label: None,
        group: None,
        time_s,
        first_row: range.start,
        rows: range.len(),
        readings: BTreeMap::new(),
    };
    let label = mapping
        .quantities
        .iter()
        .find(|(quantity, mapped)| quantity.kind == Kind::Label && mapped.series == main);
    pose.label = label.map(|(_, mapped)| text_at(mapping.series[main], mapped, range.start));
    for (quantity, mapped) in &mapping.quantities {
        let rows = if mapped.series == main {
            Some(range.clone())
        } else {
            other_rows(
                mapping,
                main,
                times,
                mapped.series,
                range,
                pose.label.as_deref(),
                file,
            )?
        };
        let Some(rows) = rows else { continue };
        if quantity.is_text() {
            if quantity.kind == Kind::Group {
                pose.group = Some(text_at(mapping.series[mapped.series], mapped, rows.start));
            }
            continue;
        }
        let values = &mapping.series[mapped.series].channels[mapped.channel].values;
        if let Some(mut averaged) = average(values.range(rows)) {
            averaged.mean = mapped.factor * averaged.mean + mapped.offset;
            averaged.sd *= mapped.factor.abs();
            pose.readings.insert(*quantity, averaged);
        }
    }
    align_quaternions(mapping, &mut pose);
    Ok(pose)
}

/// Readings at one row of the main series; other series are interpolated at its time, since they are never sampled synchronously.
fn sample(mapping: &Mapping<'_>, main: usize, times: &[Times], row: usize) -> CutPose {
    let at_s = times[main].time_s.as_ref().map(|time_s| time_s[row]);
    let mut sample = CutPose {
        label: None,
        group: None,
        time_s: at_s.map(|time| [time; 2]),
        first_row: row,
        rows: 1,
        readings: BTreeMap::new(),
    };
    for (quantity, mapped) in mapping
        .quantities
        .iter()
        .filter(|(quantity, _)| !quantity.is_text())
    {
        let values = &mapping.series[mapped.series].channels[mapped.channel].values;
        let other = &times[mapped.series];
        let value = match (mapped.series == main, &other.time_s, at_s) {
            (false, Some(time_s), Some(at_s)) => {
                interpolation::value_at(time_s, values, other.usual_s, at_s)
            }
            _ => values.get(row).filter(|value| !value.is_nan()),
        };
        if let Some(value) = value {
            let mean = mapped.factor * value + mapped.offset;
            // An interpolated value is made of several readings, hence two.
            let number = if mapped.series == main { 1 } else { 2 };
            let sd = f64::NAN;
            sample
                .readings
                .insert(*quantity, Averaged { mean, sd, number });
        }
    }
    align_quaternions(mapping, &mut sample);
    sample
}

fn text_at(series: &Series, mapped: &Mapped, row: usize) -> String {
    match mapped.is_text {
        true => series.texts[mapped.channel].at(row).to_owned(),
        false => series.channels[mapped.channel].values.at(row).to_string(),
    }
}

/// Rows of another series that match rows of the main one: by label, by time, or one to one.
fn other_rows(
    mapping: &Mapping<'_>,
    main: usize,
    times: &[Times],
    other: usize,
    range: &Range<usize>,
    label: Option<&str>,
    file: &str,
) -> Result<Option<Range<usize>>, ReadError> {
    let series = mapping.series[other];
    let names = series
        .texts
        .iter()
        .find(|text| crate::naming::is_label(&text.name));
    if let (Some(names), Some(label)) = (names, label) {
        let row = (0..series.rows).find(|row| same_label(names.at(*row), label));
        return Ok(row.map(|row| row..row + 1));
    }
    if let (Some(ours), Some(theirs)) = (&times[main].time_s, &times[other].time_s) {
        let (from, to) = (ours[range.start], ours[range.end - 1]);
        let start = theirs.partition_point(|time| *time < from);
        let end = theirs.partition_point(|time| *time <= to);
        return Ok((start < end).then_some(start..end));
    }
    if series.rows == mapping.series[main].rows {
        return Ok(Some(range.clone()));
    }
    let message = format!(
        "the series {} has {} rows and {} has {}, expected times or pose labels in both, or equal numbers of rows",
        quoted(&mapping.series[main].name),
        mapping.series[main].rows,
        quoted(&series.name),
        series.rows
    );
    Err(ReadError::new(file, Location::File, message))
}

/// Whether two labels denote one pose: equal, or with the same number, such as P7 and 7.
fn same_label(a: &str, b: &str) -> bool {
    a == b || matches!((number_of(a), number_of(b)), (Some(a), Some(b)) if a == b)
}

/// The number in a label, if there is exactly one.
pub(crate) fn number_of(label: &str) -> Option<i64> {
    let digits: Vec<&str> = label
        .split(|letter: char| !letter.is_ascii_digit())
        .filter(|part| !part.is_empty())
        .collect();
    match digits[..] {
        [number] => number.parse().ok(),
        _ => None,
    }
}

/// Mean and standard deviation of the existing values. The mean of equal values is exactly that value.
fn average(values: impl Iterator<Item = f64>) -> Option<Averaged> {
    let mut there = values.filter(|value| !value.is_nan());
    let first = there.next()?;
    let (mut sum, mut squares, mut number) = (0.0, 0.0, 1_usize);
    for value in there {
        let step = value - first;
        sum += step;
        squares += step * step;
        number += 1;
    }
    let mean = sum / number as f64;
    let sd = match number {
        1 => f64::NAN,
        number => ((squares - sum * mean).max(0.0) / (number as f64 - 1.0)).sqrt(),
    };
    Some(Averaged {
        mean: first + mean,
        sd,
        number,
    })
}

/// Normalises the means of quaternions. If the sign changes within a pose the mean is invalid and left out.
fn align_quaternions(mapping: &Mapping<'_>, pose: &mut CutPose) {
    for kind in [Kind::Commanded, Kind::Tracked] {
        let components = (3..7).map(|index| Quantity { kind, index });
        let components: Vec<Quantity> = components
            .filter(|quantity| mapping.quantities.contains_key(quantity))
            .collect();
        let norm = components
            .iter()
            .filter_map(|quantity| pose.readings.get(quantity))
            .map(|reading| reading.mean.powi(2))
            .sum::<f64>()
            .sqrt();
        for quantity in &components {
            match pose.readings.get_mut(quantity) {
                Some(reading) if norm > 0.9 && reading.number > 1 => reading.mean /= norm,
                Some(reading) if reading.number > 1 => {
                    pose.readings.remove(quantity);
                }
                _ => {}
            }
        }
    }
}

/// Subtracts the values at the first pose where the recipe requires it.
fn from_first_pose(mapping: &Mapping<'_>, poses: &mut [CutPose]) {
    for (quantity, mapped) in mapping
        .quantities
        .iter()
        .filter(|(_, mapped)| mapped.from_first_pose)
    {
        let first = poses
            .iter()
            .find_map(|pose| pose.readings.get(quantity))
            .map(|reading| reading.mean - mapped.offset);
        let Some(first) = first else { continue };
        for reading in poses
            .iter_mut()
            .filter_map(|pose| pose.readings.get_mut(quantity))
        {
            reading.mean -= first;
        }
    }
}
