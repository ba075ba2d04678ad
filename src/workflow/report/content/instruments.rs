//! The instruments with their uncertainties, and the signatures.

use tautline_core::robot::Robot;
use tautline_session::{Session, Timestamp};

use super::certificate;
use crate::report::document::{Section, Table};
use crate::report::input::ReportInput;
use crate::wording::count;
use crate::wording::units::{quantity, significant};

pub fn section(session: &Session, now: Timestamp) -> Section {
    let mut section = Section::new("Instruments and conditions");
    section.paragraph("Standard deviations as stated in the robot's description.");
    let mut table = Table::new(
        "Readings and their standard deviations",
        2,
        &["Instrument", "reads", "number", "standard deviation"],
    );
    for (name, reads, number, sd) in instruments(&session.robot) {
        table.push([name.into(), reads.into(), number.to_string(), sd]);
    }
    section.table(table);
    certificate::conditions(session, now, &mut section);
    section
}

type Instrument = (&'static str, &'static str, usize, String);

fn instruments(robot: &Robot) -> Vec<Instrument> {
    let cables = &robot.cables;
    let lengths = cables.iter().map(|cable| cable.winch.length_sd_m);
    let mut all: Vec<Instrument> = vec![(
        "Winch encoder",
        "length of a cable",
        cables.len(),
        span(lengths.map(|sd| 1e3 * sd).collect(), "mm"),
    )];
    let tensions: Vec<f64> = cables
        .iter()
        .filter_map(|cable| Some(cable.force_sensor?.tension_sd_n))
        .collect();
    if !tensions.is_empty() {
        let number = tensions.len();
        all.push((
            "Force sensor",
            "tension of a cable",
            number,
            span(tensions, "N"),
        ));
    }
    if let Some(laser) = &robot.laser {
        let sd = quantity(laser.sd_m, "m");
        all.push(("Laser distance sensor", "distance to the target", 1, sd));
    }
    let swivels: Vec<f64> = cables
        .iter()
        .filter_map(|cable| cable.pulley.swivel_sd_rad)
        .map(f64::to_degrees)
        .collect();
    if !swivels.is_empty() {
        let number = swivels.len();
        let sd = span(swivels, "degrees");
        all.push(("Swivel encoder", "direction of a pulley", number, sd));
    }
    if let Some(inclinometer) = &robot.inclinometer {
        let sd = quantity(inclinometer.sd_rad, "rad");
        all.push(("Inclinometer", "rotation of the platform", 1, sd));
    }
    if let Some(tracker) = &robot.tracker {
        let sd = tracker.position_sd_m.each().into_iter().fold(0.0, f64::max);
        let sd = quantity(sd, "m");
        all.push(("External instrument", "pose of the platform", 1, sd));
    }
    if let Some(home) = &robot.home {
        let sd = quantity(home.position_sd_m, "m");
        all.push(("Home reference", "pose from which lengths count", 1, sd));
    }
    all
}

/// One number if all are equal, else the smallest and the largest.
fn span(values: Vec<f64>, unit: &str) -> String {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match significant(least, 3) == significant(greatest, 3) {
        true => format!("{} {unit}", significant(greatest, 3)),
        false => format!(
            "{} to {} {unit}",
            significant(least, 3),
            significant(greatest, 3)
        ),
    }
}

/// What the document says of itself, the tolerance, and lines for signatures.
pub fn signatures(input: &ReportInput<'_>) -> Section {
    let is_simulated = input.session.is_simulated();
    let signed = super::signatures(input.choice, "Measured by", is_simulated);
    let mut section = Section::new(signed.title);
    certificate::scope(input, &mut section);
    if let Some(tolerance_m) = input.choice.tolerance_m {
        section.note(format!(
            "The tolerance of {} for {} was given by the operator.",
            quantity(tolerance_m, "m"),
            count(input.session.robot.cable_count(), "pulley")
        ));
    }
    section.blocks.extend(signed.blocks);
    section
}
