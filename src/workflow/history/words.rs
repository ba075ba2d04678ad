//! The life of a robot in words.

use tautline_core::effect::find;
use tautline_core::history::{Drift, Forecast, Jump, OUT_OF_TOLERANCE, Part};
use tautline_core::robot::Robot;
use tautline_session::Timestamp;

use super::{RobotRecord, days_after};
use crate::wording::probability::{certainty, percent};
use crate::wording::units::{quantity, with_sd};

/// Days of a month, for rates that people read.
const DAYS_PER_MONTH: f64 = 30.0;

/// A part: `pulley of cable-3`, `the laser's target plane`, `winch scale (cable-2)`.
#[must_use]
pub fn part_name(part: &Part, robot: &Robot) -> String {
    match part {
        Part::Pulley(cable) => format!("pulley of {}", robot.cables[*cable].name),
        Part::TargetPlane => "the laser's target plane".to_owned(),
        Part::Effect {
            effect,
            targets,
            parameter,
            ..
        } => {
            let title = find(effect).map_or(effect.as_str(), |found| found.title());
            match targets.as_slice() {
                [] => format!("{title}, {parameter}"),
                targets => format!("{title} ({}), {parameter}", targets.join(", ")),
            }
        }
    }
}

/// A vector by its length and coordinates: `7.1 mm (x 5.0 ± 0.5 mm, ...)`; a single number with its standard deviation.
fn size(value: &[f64], sds: &[f64], axes: &[usize], unit: &str) -> String {
    if axes.is_empty() {
        return with_sd(value[0], sds[0], unit);
    }
    let length = value.iter().map(|v| v * v).sum::<f64>().sqrt();
    let each = axes.iter().zip(value.iter().zip(sds));
    let each = each
        .map(|(axis, (v, sd))| format!("{} {}", ["x", "y", "z"][*axis], with_sd(*v, *sd, unit)));
    format!(
        "{} ({})",
        quantity(length, unit),
        each.collect::<Vec<_>>().join(", ")
    )
}

fn unit_of(part: &Part) -> &str {
    match part {
        Part::Pulley(_) | Part::TargetPlane => "m",
        Part::Effect { unit, .. } => unit,
    }
}

/// One jump: what moved, between which sessions, how certainly, by how much.
#[must_use]
pub fn change_sentence(record: &RobotRecord, jump: &Jump, part: &Part, axes: &[usize]) -> String {
    let robot = record.robot();
    let sds: Vec<f64> = jump
        .covariance
        .diagonal()
        .iter()
        .map(|v| v.sqrt())
        .collect();
    let [before, after] = jump.between.map(|k| record.sessions[k].name.as_str());
    let name = part_name(part, robot);
    let verb = match part {
        Part::Pulley(_) | Part::TargetPlane => "moved",
        Part::Effect { .. } => "changed",
    };
    format!(
        "Between {before} and {after} the {} {verb} by {}, {}.",
        name.trim_start_matches("the "),
        size(jump.size.as_slice(), &sds, axes, unit_of(part)),
        certainty(jump.probability)
    )
}

/// One drift: what drifts, how certainly, how fast.
#[must_use]
pub fn drift_sentence(record: &RobotRecord, drift: &Drift, part: &Part, axes: &[usize]) -> String {
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

/// When to calibrate again.
#[must_use]
pub fn due_sentence(forecast: &Forecast, last: Timestamp) -> String {
    let tolerance = quantity(forecast.tolerance_m, "m");
    if forecast.at_once > OUT_OF_TOLERANCE {
        return format!(
            "The values of the last session are too uncertain for a tolerance of {tolerance}: measure more poses."
        );
    }
    match forecast.due_days {
        Some(days) => {
            let due = days_after(last, days).to_string();
            let (date, _) = due.split_at(10);
            format!(
                "Calibrate again by {date}: then the probability reaches {} that a pulley is more than {tolerance} from its value in \
                 the last session.",
                percent(OUT_OF_TOLERANCE)
            )
        }
        None => {
            format!("No pulley is expected to leave a tolerance of {tolerance} within ten years.")
        }
    }
}
