//! What makes a report a certificate of calibration (ISO/IEC 17025:2017, 7.8.2 and 7.8.4): number, laboratory, item, dates, conditions.

use tautline_core::robot::Robot;
use tautline_session::{CalibratedInstrument, CertificateDetails, Session, Timestamp, day};

use crate::history::date;
use crate::report::document::{Section, Table};
use crate::report::input::ReportInput;
use crate::wording::list;
use crate::wording::units::{decimals_of_uncertainty, fixed, significant};

/// Last line of every certificate.
pub const END: &str = "End of the document.";
/// Reference temperature of lengths, ISO 1 (degrees Celsius).
const REFERENCE_C: f64 = 20.0;
/// What every certificate says of its own reach.
pub const SCOPE: &str = "The results relate only to the robot named above, as it was when it was measured. This document must not be reproduced except in full without approval of who issued it.";

/// Name of the certificate; empty without a number.
pub fn reference(session: &Session) -> String {
    match session.settings.certificate.number.trim() {
        "" => String::new(),
        number => format!("Calibration certificate {number}"),
    }
}

/// Lines below the title: item, laboratory, place and days of measuring.
pub fn head(input: &ReportInput<'_>) -> Vec<String> {
    let details = &input.session.settings.certificate;
    let mut lines = vec![format!("Robot {}", input.session.robot.label())];
    let days = [&details.measured_from, &details.measured_to].map(|day| day.trim());
    let measured = match days {
        ["", ""] => String::new(),
        ["", one] | [one, ""] => one.to_owned(),
        [from, to] if from == to => from.to_owned(),
        [from, to] => format!("{from} to {to}"),
    };
    for (what, text) in [
        ("Made by", details.manufacturer.as_str()),
        ("Laboratory", &details.laboratory),
        ("Measured at", &details.place),
        ("Measured", &measured),
    ] {
        if !text.trim().is_empty() {
            lines.push(format!("{what}: {}", text.trim()));
        }
    }
    lines
}

/// What a complete certificate would state and this one does not: the names of the fields, with what was found in those that are not
/// understood.
#[must_use]
pub fn missing_details(details: &CertificateDetails, robot: &Robot) -> Vec<String> {
    let mut missing = Vec::new();
    for (field, text) in [
        ("Number of the certificate", details.number.as_str()),
        ("Laboratory", &details.laboratory),
        ("Place of measuring", &details.place),
        ("Maker of the robot", &details.manufacturer),
        (
            "Serial number of the robot (in its description)",
            robot.serial_number.as_deref().unwrap_or_default(),
        ),
        ("Load, speed and warming up", &details.operation),
    ] {
        if text.trim().is_empty() {
            missing.push(field.to_owned());
        }
    }
    let mut dates = vec![
        ("First day of measuring".to_owned(), &details.measured_from),
        ("Last day of measuring".to_owned(), &details.measured_to),
    ];
    for instrument in &details.instruments {
        let name = label(instrument);
        for (field, text) in [
            ("serial number", &instrument.serial_number),
            ("certificate", &instrument.certificate),
            ("traceability", &instrument.traceable_to),
        ] {
            if text.trim().is_empty() {
                missing.push(format!("{name}: {field}"));
            }
        }
        dates.push((format!("{name}: calibrated on"), &instrument.calibrated_on));
        dates.push((format!("{name}: due on"), &instrument.due_on));
    }
    for (field, text) in dates {
        match text.trim() {
            "" => missing.push(field),
            text if day(text).is_none() => missing.push(format!(
                "{field}: found \"{text}\", expected a date such as 2026-11-28"
            )),
            _ => {}
        }
    }
    if !details.has_country() {
        missing.push("Country of the laboratory, two capital letters".to_owned());
    }
    if details.temperature_c.is_none() || details.temperature_sd_k.is_none() {
        missing.push("Temperature with its uncertainty".to_owned());
    }
    if details.instruments.is_empty() {
        missing.push("Instruments with their calibrations".to_owned());
    }
    missing
}

/// Instruments of a session whose calibration was due before its last day of measuring, or before `now` if that is not stated.
pub fn overdue_when_used(session: &Session, now: Timestamp) -> Vec<String> {
    let details = &session.settings.certificate;
    overdue(&details.instruments, when_used(details, now))
}

/// When the instruments were last used.
fn when_used(details: &CertificateDetails, now: Timestamp) -> Timestamp {
    day(&details.measured_to).unwrap_or(now)
}

/// Instruments whose calibration was due before a time, one sentence each.
#[must_use]
pub fn overdue(instruments: &[CalibratedInstrument], now: Timestamp) -> Vec<String> {
    let overdue = instruments.iter().filter(|one| one.is_overdue(now));
    let sentence = |instrument: &CalibratedInstrument| {
        format!(
            "{}: its calibration was due on {}.",
            label(instrument),
            instrument.due_on
        )
    };
    overdue.map(sentence).collect()
}

fn label(instrument: &CalibratedInstrument) -> &str {
    match instrument.name.trim() {
        "" => "Instrument without a name",
        name => name,
    }
}

/// The calibrations of the instruments, and the conditions of measuring.
pub fn conditions(session: &Session, now: Timestamp, section: &mut Section) {
    let details = &session.settings.certificate;
    let used = when_used(details, now);
    let caption = "Calibrations of the instruments, to which the results are traceable";
    section.table(Table::of(caption, 6, &details.instruments).columns(&[
        ("Instrument", &|one| label(one).to_owned()),
        ("serial number", &|one| one.serial_number.clone()),
        ("certificate", &|one| one.certificate.clone()),
        ("calibrated on", &|one| one.calibrated_on.clone()),
        ("due on", &|one| match one.is_overdue(used) {
            true => format!("{}, overdue", one.due_on),
            false => one.due_on.clone(),
        }),
        ("traceable to", &|one| one.traceable_to.clone()),
    ]));
    let mut facts = Vec::new();
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    if let Some(celsius) = details.temperature_c {
        let sd = details.temperature_sd_k;
        let with = sd.map_or_else(String::new, |kelvin| {
            format!(", standard uncertainty {} K", significant(kelvin, 2))
        });
        add(
            "Temperature",
            format!("{} degrees Celsius{with}", significant(celsius, 4)),
        );
        if let Some(expansion) = details.expansion_per_k {
            let shorter_mm = 1e3 * expansion * (celsius - REFERENCE_C);
            let direction = if shorter_mm < 0.0 {
                "longer"
            } else {
                "shorter"
            };
            let sd_mm = sd.map(|kelvin| 1e3 * expansion * kelvin);
            let size = match sd_mm.filter(|sd_mm| *sd_mm > 0.0) {
                Some(sd_mm) => {
                    let digits = decimals_of_uncertainty(sd_mm);
                    let shown = |mm: f64| fixed(mm, digits);
                    format!("{} ± {}", shown(shorter_mm.abs()), shown(sd_mm))
                }
                None => significant(shorter_mm.abs(), 3),
            };
            add(
                "Reference temperature",
                format!(
                    "The values hold at the temperature of measuring. At 20 degrees Celsius (ISO 1) distances are {direction} by {size} mm per metre."
                ),
            );
        }
    }
    if !details.operation.trim().is_empty() {
        add("Operation", details.operation.trim().to_owned());
    }
    if !facts.is_empty() {
        section.facts(facts);
    }
}

/// What the document states of itself, and what is not stated.
pub fn scope(input: &ReportInput<'_>, section: &mut Section) {
    section.paragraph(SCOPE);
    if !input.session.settings.certificate.number.trim().is_empty() {
        let issued = format!("Issued on {}.", date(input.now));
        section.paragraph(issued);
        let session = input.session;
        let missing = missing_details(&session.settings.certificate, &session.robot);
        if !missing.is_empty() {
            section.paragraph(format!("Not stated: {}.", list(&missing)));
        }
    }
}
