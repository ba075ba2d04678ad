//! Checks of the parts of a session other than the robot and its measurements.
//!
//! Numbers that JSON cannot represent are rejected here, before a file is written that could not be read again.

use std::collections::HashSet;

use tautline_core::effect::EffectSetting;
use tautline_core::robot::{FieldError, Robot};

use super::{Adjustment, NamedValue, PlannedPose, StoppedVerification, Verification};
use crate::error::{below, fail};
use crate::phases::{CheckPose, CheckRow, PhaseData};
use crate::table::quaternion_fault;

type Checked = Result<(), FieldError>;

/// Checks that a pose can be excluded, as all but the home pose can.
pub(super) fn excludable(label: i64) -> Checked {
    if label == 0 {
        let message = "found 0, the home pose, which all revolutions count from, \
                       expected the label of another pose";
        return fail("/excluded", message);
    }
    Ok(())
}

/// Checks that raw data refer to cables and sensors that exist, and that all numbers are finite.
pub(super) fn phases(phases: &PhaseData, robot: &Robot) -> Checked {
    let cables = robot.cable_count();
    for (k, pair) in phases.winch.iter().enumerate() {
        let at = format!("/phases/winch/{k}");
        index(&at, "cable", pair.cable, cables)?;
        finite(&at, "revolutions", pair.revolutions)?;
        finite(&at, "length_m", pair.length_m)?;
        optional(&at, "tension_n", pair.tension_n)?;
    }
    for (k, pair) in phases.force.iter().enumerate() {
        let at = format!("/phases/force/{k}");
        index(&at, "cable", pair.cable, cables)?;
        finite(&at, "reading_n", pair.reading_n)?;
        finite(&at, "load_n", pair.load_n)?;
    }
    for (k, reading) in phases.home.iter().enumerate() {
        let at = format!("/phases/home/{k}");
        index(&at, "sensor", reading.sensor, 6)?;
        finite(&at, "reading", reading.reading)?;
    }
    for (k, pose) in phases.home_poses.iter().enumerate() {
        let at = format!("/phases/home_poses/{k}");
        numbers(&at, "position_m", &pose.position_m)?;
        quaternion(&at, &pose.orientation_wxyz)?;
        positive(&at, "position_sd_m", pose.position_sd_m)?;
        positive(&at, "orientation_sd_rad", pose.orientation_sd_rad)?;
    }
    for (k, point) in phases.elongation.iter().enumerate() {
        let at = format!("/phases/elongation/{k}");
        finite(&at, "length_m", point.length_m)?;
        finite(&at, "tension_n", point.tension_n)?;
        finite(&at, "elongation_m", point.elongation_m)?;
    }
    for (k, one) in phases.distances.iter().enumerate() {
        let at = format!("/phases/distances/{k}");
        positive(&at, "distance_m", one.distance_m)?;
        positive(&at, "sd_m", one.sd_m)?;
        numbers(&at, "point_m", &one.point_m)?;
    }
    check_rows("/phases/check", &phases.check)
}

/// Checks that the effects to be identified can be attached to the robot.
pub(super) fn effects(effects: &[EffectSetting], robot: &Robot) -> Checked {
    if effects.is_empty() {
        return Ok(());
    }
    let model = Robot {
        effects: effects.to_vec(),
        ..robot.clone()
    };
    let checked = model.check();
    checked.map_err(|error| below("/settings/identification", error))
}

/// Checks that planned poses have different labels and valid numbers.
pub(super) fn plan(plan: &[PlannedPose]) -> Checked {
    let mut labels = HashSet::with_capacity(plan.len());
    for (k, planned) in plan.iter().enumerate() {
        let at = format!("/plan/{k}");
        if !labels.insert(planned.label) {
            let message = format!("found {} again, expected each label once", planned.label);
            return fail(format!("{at}/label"), message);
        }
        numbers(&at, "position_m", &planned.position_m)?;
        quaternion(&at, &planned.orientation_wxyz)?;
    }
    Ok(())
}

/// Checks that parameters of the controller have different names. Their values may be NaN or infinite.
pub(super) fn controller(values: &[NamedValue]) -> Checked {
    let mut names = HashSet::with_capacity(values.len());
    for (k, value) in values.iter().enumerate() {
        let at = format!("/controller/{k}");
        if !names.insert(&value.name) {
            let message = format!("found {:?} again, expected each name once", value.name);
            return fail(format!("{at}/name"), message);
        }
    }
    Ok(())
}

/// Checks that the values written by adjustments are finite. Previous values may be NaN or infinite.
pub(super) fn adjustments(adjustments: &[Adjustment]) -> Checked {
    for (k, adjustment) in adjustments.iter().enumerate() {
        for (j, change) in adjustment.changes.iter().enumerate() {
            let at = format!("/adjustments/{k}/changes/{j}");
            finite(&at, "after", change.after)?;
        }
    }
    Ok(())
}

/// Checks the poses of verification runs.
pub(super) fn verifications(runs: &[Verification]) -> Checked {
    for (k, run) in runs.iter().enumerate() {
        check_rows(&format!("/verifications/{k}/rows"), &run.rows)?;
    }
    Ok(())
}

pub(super) fn stopped_verifications(runs: &[StoppedVerification]) -> Checked {
    for (k, run) in runs.iter().enumerate() {
        check_rows(&format!("/stopped_verifications/{k}/rows"), &run.rows)?;
    }
    Ok(())
}

fn check_rows(list: &str, rows: &[CheckRow]) -> Checked {
    for (k, row) in rows.iter().enumerate() {
        let at = format!("{list}/{k}");
        optional(&at, "time_s", row.time_s)?;
        check_pose(&format!("{at}/commanded"), &row.commanded)?;
        check_pose(&format!("{at}/attained"), &row.attained)?;
    }
    Ok(())
}

fn check_pose(at: &str, pose: &CheckPose) -> Checked {
    numbers(at, "position_m", &pose.position_m)?;
    match &pose.orientation_wxyz {
        Some(wxyz) => quaternion(at, wxyz),
        None => Ok(()),
    }
}

fn index(at: &str, key: &str, index: usize, count: usize) -> Checked {
    if index < count {
        return Ok(());
    }
    let message = format!(
        "found a {key} that does not exist, expected 0 to {}",
        count - 1
    );
    fail(format!("{at}/{key}"), message)
}

fn finite(at: &str, key: &str, value: f64) -> Checked {
    if value.is_finite() {
        return Ok(());
    }
    let message = format!("found {value}, expected a finite number");
    fail(format!("{at}/{key}"), message)
}

fn positive(at: &str, key: &str, value: f64) -> Checked {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    let message = format!("found {value}, expected a number greater than 0");
    fail(format!("{at}/{key}"), message)
}

fn optional(at: &str, key: &str, value: Option<f64>) -> Checked {
    value.map_or(Ok(()), |value| finite(at, key, value))
}

fn numbers(at: &str, key: &str, values: &[f64]) -> Checked {
    let at = format!("{at}/{key}");
    let mut numbered = values.iter().enumerate();
    numbered.try_for_each(|(k, value)| finite(&at, &k.to_string(), *value))
}

fn quaternion(at: &str, wxyz: &[f64; 4]) -> Checked {
    numbers(at, "orientation_wxyz", wxyz)?;
    match quaternion_fault(wxyz) {
        Some((_, message)) => fail(format!("{at}/orientation_wxyz"), message),
        None => Ok(()),
    }
}
