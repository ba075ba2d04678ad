//! The history of a robot in words.

use std::path::Path;

use tautline_core::effect::find;
use tautline_core::history::{Drift, Forecast, Jump, OUT_OF_TOLERANCE, RobotPart};
use tautline_core::robot::Robot;
use tautline_session::Timestamp;

use super::{RobotHistory, RobotRecord, Tolerance, date, days_after};
use crate::wording::probability::{certainty, percent};
use crate::wording::units::{quantity, significant, with_sd};
use crate::wording::{first_lower, list};

/// Days of a month, for rates that people read.
const DAYS_PER_MONTH: f64 = 30.0;

/// A part: `pulley of cable-3`, `the laser's target plane`, `winch scale (cable-2)`.
#[must_use]
pub fn part_name(part: &RobotPart, robot: &Robot) -> String {
    match part {
        RobotPart::Pulley(cable) => format!("pulley of {}", robot.cables[*cable].name),
        RobotPart::TargetPlane => "the laser's target plane".to_owned(),
        RobotPart::Effect {
            effect,
            targets,
            parameter,
            ..
        } => {
            let found = find(effect);
            let title = first_lower(found.map_or(effect.as_str(), |found| found.title()));
            let title = match targets.as_slice() {
                [] => title,
                targets => format!("{title} ({})", targets.join(", ")),
            };
            match found.map(|found| found.parameters().len()) {
                Some(1) => title,
                _ => format!("{title}, {parameter}"),
            }
        }
    }
}

/// A vector by its length and coordinates: `7.1 mm (x 5.0 ± 0.5 mm, ...)`; a single number with its standard deviation.
fn size(value: &[f64], sds: &[f64], axes: &[usize], unit: &str) -> String {
    let length = value.iter().map(|v| v * v).sum::<f64>().sqrt();
    if axes.is_empty() {
        // The two phases of a wave are one amplitude.
        return match value {
            [_, _, ..] => quantity(length, unit),
            _ => with_sd(value[0], sds[0], unit),
        };
    }
    let each = axes.iter().zip(value.iter().zip(sds));
    let each = each
        .map(|(axis, (v, sd))| format!("{} {}", ["x", "y", "z"][*axis], with_sd(*v, *sd, unit)));
    format!(
        "{} ({})",
        quantity(length, unit),
        each.collect::<Vec<_>>().join(", ")
    )
}

/// SI unit of the numbers of a part.
pub fn unit_of(part: &RobotPart) -> &str {
    match part {
        RobotPart::Pulley(_) | RobotPart::TargetPlane => "m",
        RobotPart::Effect { unit, .. } => unit,
    }
}

/// The size of a jump.
pub fn size_of_jump(jump: &Jump, part: &RobotPart, axes: &[usize]) -> String {
    let variances = jump.covariance.diagonal();
    let sds: Vec<f64> = variances.iter().map(|v| v.max(0.0).sqrt()).collect();
    size(jump.size.as_slice(), &sds, axes, unit_of(part))
}

/// Sentence on one jump: part, sessions, probability and size.
fn change_sentence(record: &RobotRecord, jump: &Jump, part: &RobotPart, axes: &[usize]) -> String {
    let [before, after] = jump.between.map(|k| record.sessions[k].name.as_str());
    let name = part_name(part, record.robot());
    let verb = match part {
        RobotPart::Pulley(_) | RobotPart::TargetPlane => "moved",
        RobotPart::Effect { .. } => "changed",
    };
    format!(
        "Between {before} and {after}{} the {} {verb} by {}, {}.",
        told_between(record, jump.between),
        name.trim_start_matches("the "),
        size_of_jump(jump, part, axes),
        certainty(jump.probability)
    )
}

/// Sentence on one drift: part, probability and rate.
fn drift_sentence(record: &RobotRecord, drift: &Drift, part: &RobotPart, axes: &[usize]) -> String {
    let robot = record.robot();
    let rate = &drift.rate * DAYS_PER_MONTH;
    let variances = drift.covariance.diagonal();
    let sds = variances.iter().map(|v| v.sqrt() * DAYS_PER_MONTH);
    let sds: Vec<f64> = sds.collect();
    let name = part_name(part, robot);
    format!(
        "The {} drifts by {} in 30 days, {}.",
        name.trim_start_matches("the "),
        size(rate.as_slice(), &sds, axes, unit_of(part)),
        certainty(drift.probability)
    )
}

/// Sentence on the date of the next calibration.
fn due_sentence(forecast: &Forecast, tolerance: Tolerance, last: Timestamp) -> String {
    let limit = quantity(tolerance.limit_m(), "m");
    let of_whom = match tolerance {
        Tolerance::Pulley(_) => "pulleys",
        Tolerance::Position { .. } => "the position of the platform",
    };
    if forecast.at_once > OUT_OF_TOLERANCE {
        let are_known = match tolerance {
            Tolerance::Pulley(_) => "The pulleys are",
            Tolerance::Position { .. } => "The position of the platform is",
        };
        return format!(
            "{are_known} known to {} mm (95 %), which is not enough for a tolerance of {limit}: measure more poses.",
            significant(1e3 * forecast.known_m, 2)
        );
    }
    let Some(due) = forecast.due_days else {
        return format!(
            "It is not expected that a tolerance of {limit} of {of_whom} is left within ten years."
        );
    };
    let out = match tolerance {
        Tolerance::Pulley(_) => {
            format!("a pulley is more than {limit} from its value in the last session")
        }
        Tolerance::Position { volume, .. } => format!(
            "the position error of the platform is more than {limit} in the {} (root mean square)",
            volume.map_or("workspace", |_| "volume")
        ),
    };
    format!(
        "Calibrate again by {}{}: then the probability reaches {} that {out}.",
        date(days_after(last, due)),
        interval(forecast, last),
        percent(OUT_OF_TOLERANCE)
    )
}

/// The interval of a date in brackets: ` (95 %: 2026-10-02 to 2027-03-01)`.
fn interval(forecast: &Forecast, last: Timestamp) -> String {
    let [from, to] = forecast
        .interval_days
        .map(|days| days.map(|days| date(days_after(last, days))));
    match (from, to) {
        (Some(from), Some(to)) => format!(" (95 %: {from} to {to})"),
        (Some(from), None) => format!(" (95 %: not before {from})"),
        (None, _) => String::new(),
    }
}

/// Events of a record between two sessions: `(cable-2 replaced on 2026-09-03)`; empty if there are none.
fn told_between(record: &RobotRecord, sessions: [usize; 2]) -> String {
    let [Some(from), Some(to)] = sessions.map(|index| record.sessions[index].time) else {
        return String::new();
    };
    let events = record.events.iter();
    let events = events.filter(|event| from < event.time && event.time <= to);
    let told: Vec<String> = events
        .map(|event| format!("{} on {}", event.text, date(event.time)))
        .collect();
    match told.is_empty() {
        true => String::new(),
        false => format!(" ({})", list(&told)),
    }
}

/// Sentences on the changes over the sessions of a record: jumps, drifts, and whether any is certain.
#[must_use]
pub fn changes(record: &RobotRecord, found: &RobotHistory) -> Vec<String> {
    let history = &found.history;
    let of = |part: usize| (&history.parts[part], &history.axes[part]);
    let mut told = Vec::new();
    for jump in &history.jumps {
        let (part, axes) = of(jump.part);
        told.push(change_sentence(record, jump, part, axes));
    }
    for drift in history.evident_drifts().filter(|_| found.is_dated) {
        let (part, axes) = of(drift.part);
        told.push(drift_sentence(record, drift, part, axes));
    }
    if !found.is_certain() {
        told.push("No change is certain: all sessions agree within the noise.".to_owned());
    }
    told
}

/// Sentence on the next calibration after the session of a file or folder; `None` if it is not in the record. The date follows
/// the last session.
#[must_use]
pub fn next_calibration_after(
    record: &RobotRecord,
    found: &RobotHistory,
    path: &Path,
) -> Option<String> {
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let own = whole(path);
    let mut sessions = record.sessions.iter();
    let index = sessions.position(|session| whole(&session.path) == own)?;
    let last = record.sessions.last()?;
    if index + 1 < record.sessions.len() {
        return Some(format!(
            "The date of the next calibration follows the last session of the record, which is {}.",
            last.date_or_name()
        ));
    }
    Some(next_calibration(record, found).unwrap_or_else(|| {
        "There is no date of the next calibration, because not all sessions of the record have dates."
            .to_owned()
    }))
}

/// Sentence on the next calibration; `None` if the sessions have no dates.
#[must_use]
pub fn next_calibration(record: &RobotRecord, found: &RobotHistory) -> Option<String> {
    let last = record.sessions.last()?.time?;
    Some(due_sentence(
        found.forecast.as_ref()?,
        found.tolerance,
        last,
    ))
}
