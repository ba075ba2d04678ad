//! Checks that readings are complete and plausible, without a fit.

use tautline_core::measurement::{Dataset, Grid};
use tautline_core::robot::Cable;
use tautline_core::simulation::TensionRange;
use tautline_import::{Line, Mistake, Quantity, QuantityKind as Kind, Suggestion, TableCheck};
use tautline_link::measuring::TensionFault;

use super::faults::{self, ReadingFault};
use super::{COMPLETE, CheckItem, CheckOutcome, PLAUSIBLE};
use crate::wording::units::significant;
use crate::wording::{count, list, sentence};

/// Largest fraction of a cable's readings that may be missing.
const MISSING: f64 = 0.5;
/// Scatter of read about expected lengths, relative to that of the read ones, above which something else was read.
const SCATTERED: f64 = 0.6;
/// Plausible ratio of read to expected changes of length.
const RATIOS: std::ops::Range<f64> = 0.7..1.4;
/// Tension within the noise of nothing, in standard deviations of its sensor.
const NOTHING: f64 = 2.0;
/// Plausible difference between read and expected laser distance (m).
const LASER_OFF_M: f64 = 0.3;

/// Readings that every cable has, with their names.
fn grids(dataset: &Dataset) -> Vec<(&'static str, &Grid)> {
    let data = &dataset.measurements;
    let all = [
        ("revolutions", &data.revolutions),
        ("lengths", &data.length_m),
        ("force readings", &data.force_n),
        ("swivel angles", &data.swivel_rad),
    ];
    all.into_iter()
        .filter(|(_, grid)| !grid.is_empty())
        .collect()
}

/// `said` says a fault with its place.
pub(super) fn complete(dataset: &Dataset, said: &dyn Fn(&ReadingFault) -> String) -> CheckItem {
    let item = |outcome, sentence: String| CheckItem::new(COMPLETE, outcome, sentence);
    let data = &dataset.measurements;
    let poses = data.len() - usize::from(dataset.robot.home.is_some() && data.home_row().is_some());
    let lengths = !data.revolutions.is_empty() || !data.length_m.is_empty();
    if data.is_empty() {
        return item(CheckOutcome::Fail, "No pose was measured.".to_owned())
            .with("Measure the planned poses first.");
    }
    if !lengths {
        return item(
            CheckOutcome::Fail,
            "Neither revolutions nor lengths of the cables were read.".to_owned(),
        )
        .with("Record the motor encoders, and import the readings again.");
    }
    if !data.revolutions.is_empty() && dataset.robot.home.is_some() && data.home_row().is_none() {
        return item(
            CheckOutcome::Fail,
            "The home pose (label 0), from which revolutions count, is missing.".to_owned(),
        )
        .with("Measure the home pose, and give it the label 0.");
    }
    if let Some(fault) = faults::no_lengths(dataset) {
        return item(CheckOutcome::Fail, said(&fault))
            .with("Record the motor encoders, and import the readings again.");
    }
    if let Some(fault) = faults::few_rows(dataset) {
        return item(CheckOutcome::Fail, said(&fault)).with("Measure the planned poses first.");
    }
    let mut missing = 0;
    let mut poor = Vec::new();
    for (name, grid) in grids(dataset) {
        for (cable, described) in dataset.robot.cables.iter().enumerate() {
            let holes = (0..grid.rows())
                .filter(|row| grid.get(*row, cable).is_nan())
                .count();
            missing += holes;
            if holes as f64 > MISSING * grid.rows() as f64 {
                poor.push(format!("{name} of {}", described.name));
            }
        }
    }
    if !poor.is_empty() {
        let what = list(&poor);
        return item(
            CheckOutcome::Fail,
            format!("More than half of the {what} are missing."),
        )
        .with("Check the wiring and the recording of these channels, and measure again.");
    }
    let lasers = data
        .laser_m
        .iter()
        .filter(|distance| distance.is_nan())
        .count();
    let holes = match missing + lasers {
        0 => "all channels were read at each".to_owned(),
        holes => format!(
            "{} missing, which identification leaves out",
            count(holes, "reading")
        ),
    };
    let found = item(
        CheckOutcome::Pass,
        format!("{}; {holes}.", sentence(&count(poses, "pose"))),
    );
    let mut cables = dataset.robot.cables.iter();
    let is_elastic = cables.any(|c| c.cable.axial_stiffness_n.is_some());
    if is_elastic && data.force_n.is_empty() && dataset.robot.unread_tension().is_none() {
        return found.with(
            "Forces were not read: state the mass and the tension limits in robot.json, so that stretch, sag and \
             gravity are modelled.",
        );
    }
    found
}

/// `said` says a fault with its place.
pub(super) fn plausible(
    dataset: &Dataset,
    found: &TableCheck,
    said: &dyn Fn(&ReadingFault) -> String,
) -> CheckItem {
    let item = |outcome, sentence: String| CheckItem::new(PLAUSIBLE, outcome, sentence);
    let mut problems: Vec<String> = Vec::new();
    problems.extend(implausible_lengths(dataset, found));
    problems.extend(faults::turned_at_home(dataset).iter().map(said));
    problems.extend(faults::pushing_cables(dataset).iter().map(said));
    problems.extend(slack_cables(dataset));
    problems.extend(implausible_distances(dataset));
    if !problems.is_empty() {
        return item(CheckOutcome::Fail, problems.join(" ")).with(
            "Correct sign, unit or channel in the recording, or exclude the poses concerned.",
        );
    }
    let are_compared = found.lengths.iter().any(Option::is_some);
    let lengths = match are_compared {
        true => "Changes of length match the poses",
        false => "Lengths were not compared: too few poses are known",
    };
    if let Some(outside) = tensions_outside_limits(dataset) {
        return item(CheckOutcome::Notice, format!("{lengths}. {outside}")).with(
            "Plan poses at which all tensions are within the limits, or find out why a cable pulls otherwise.",
        );
    }
    match are_compared {
        true => item(
            CheckOutcome::Pass,
            format!("{lengths}, and tensions and distances are plausible."),
        ),
        false => item(CheckOutcome::NotEvaluated, format!("{lengths}.")).with(
            "Record the commanded poses (columns x_m, y_m, z_m, qw, qx, qy, qz of poses.csv).",
        ),
    }
}

/// Cables with very low tension at some poses, in one sentence for each: a slack cable is longer than the distance that it
/// spans.
fn slack_cables(dataset: &Dataset) -> Vec<String> {
    let data = &dataset.measurements;
    if data.force_n.is_empty() {
        return Vec::new();
    }
    let slack = |(cable, described): (usize, &Cable)| {
        let sensor = described.force_sensor?;
        let tension_n = |row: usize| sensor.tension_n(data.force_n.get(row, cable));
        let mut rows =
            (0..data.len()).filter(|row| tension_n(*row).abs() < NOTHING * sensor.tension_sd_n);
        let first = rows.next()?;
        let more = match rows.count() {
            0 => String::new(),
            more => format!(" (and at {more} more)"),
        };
        Some(format!(
            "{} pulls with {:.1} N at pose {}{more}, which is within the noise of zero: it is slack there, and its length is too long.",
            sentence(&described.name),
            tension_n(first),
            data.labels[first]
        ))
    };
    let cables = dataset.robot.cables.iter().enumerate();
    cables.filter_map(slack).collect()
}

/// Tensions outside the limits that the description states, in one sentence with the first of each cable.
fn tensions_outside_limits(dataset: &Dataset) -> Option<String> {
    dataset.robot.limits?.tension?;
    let range = TensionRange::of(&dataset.robot);
    let data = &dataset.measurements;
    if data.force_n.is_empty() {
        return None;
    }
    let outside = dataset.robot.cables.iter().enumerate();
    let outside = outside.filter_map(|(cable, described)| {
        let sensor = described.force_sensor?;
        let tensions = (0..data.len()).map(|row| sensor.tension_n(data.force_n.get(row, cable)));
        let mut outside = tensions
            .zip(&data.labels)
            .filter(|(tension_n, _)| TensionFault::of(&sensor, *tension_n, &range).is_some());
        let (tension_n, label) = outside.next()?;
        let more = match outside.count() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let name = &described.name;
        Some(format!("{name} at pose {label}{more} ({tension_n:.1} N)"))
    });
    let outside: Vec<String> = outside.collect();
    let [lower, upper] = [range.lower_n, range.upper_n].map(|limit_n| significant(limit_n, 3));
    (!outside.is_empty()).then(|| {
        let outside = list(&outside);
        format!("Tensions outside of {lower} to {upper} N: {outside}.")
    })
}

/// Mistakes of sign, unit and channel, and changes of length that have no such reason.
fn implausible_lengths(dataset: &Dataset, found: &TableCheck) -> Vec<String> {
    let cables = &dataset.robot.cables;
    let mut problems = Vec::new();
    let mut named = vec![false; cables.len()];
    let is_wrong = |one: &&Suggestion| {
        one.mistake.is_of_channel()
            || matches!(
                one.mistake,
                Mistake::DeadChannel | Mistake::LostTurns | Mistake::Extension
            )
    };
    for suggestion in found.suggestions.iter().filter(is_wrong) {
        let columns = suggestion.columns.iter();
        let of_length = columns.filter_map(|column| {
            Quantity::parse(column).filter(|q| matches!(q.kind, Kind::Revolutions | Kind::Length))
        });
        let indices: Vec<usize> = of_length.map(|quantity| quantity.index).collect();
        match (suggestion.mistake, &indices[..]) {
            (_, []) => {
                problems.push(format!("{}.", sentence(&suggestion.sentence)));
            }
            (Mistake::ReversedSign, reversed) => problems.extend(reversed.iter().map(|cable| {
                let name = &cables[*cable].name;
                format!("The length of {name} changes with the wrong sign.")
            })),
            (Mistake::Exchanged, [a, b]) => {
                named[*a] = true;
                named[*b] = true;
                problems.push(format!(
                    "The length of {} changes as that of {} should: the channels may be swapped.",
                    cables[*a].name, cables[*b].name
                ));
            }
            (_, cables) => {
                cables.iter().for_each(|cable| named[*cable] = true);
                problems.push(format!("{}.", sentence(&suggestion.sentence)));
            }
        }
    }
    let follows = |line: &Line| line.scatter <= SCATTERED;
    let lines = found.lengths.iter().flatten();
    let off = lines.filter(|line| !follows(line)).count();
    if 2 * off > cables.len() {
        problems.push(format!(
            "The lengths of {off} of {} cables do not follow the poses: is this the robot that was measured?",
            cables.len()
        ));
        return problems;
    }
    for (cable, line) in found.lengths.iter().enumerate() {
        let name = &cables[cable].name;
        problems.push(match line {
            Some(line) if !follows(line) && !named[cable] => {
                format!("The length of {name} does not follow the poses.")
            }
            Some(line) if follows(line) && !RATIOS.contains(&line.slope.abs()) && !named[cable] => {
                format!(
                    "The length of {name} changes {:.3} times as much as the poses require: unit, drum or gear may be wrong.",
                    line.slope.abs()
                )
            }
            _ => continue,
        });
    }
    problems
}

fn implausible_distances(dataset: &Dataset) -> Option<String> {
    let data = &dataset.measurements;
    let laser = dataset.robot.laser.as_ref()?;
    let plane = &laser.target_plane;
    let normal = nalgebra::Vector3::from(plane.normal);
    let expected = |row: usize| {
        let pose = data.commanded.get(row).copied().flatten()?;
        let towards = normal.dot(&(pose.orientation * nalgebra::Vector3::from(laser.direction)));
        Some((plane.offset_m - normal.dot(&pose.transform(&laser.origin_m.into()))) / towards)
    };
    let is_off = |row: &usize| {
        let distance = data.laser_at(*row);
        let allowed = LASER_OFF_M.max(5.0 * plane.offset_sd_m.unwrap_or(f64::INFINITY));
        distance <= 0.0 || expected(*row).is_some_and(|e| (distance - e).abs() > allowed)
    };
    let off: Vec<usize> = (0..data.laser_m.len()).filter(is_off).collect();
    let first = *off.first()?;
    Some(format!(
        "The laser reads {:.3} m at pose {}{}, which is far from the distance at the commanded pose.",
        data.laser_at(first),
        data.labels[first],
        if off.len() == 1 {
            String::new()
        } else {
            format!(" (and is off at {} more)", off.len() - 1)
        }
    ))
}
