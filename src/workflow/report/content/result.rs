//! The first page: the result.

use tautline_core::diagnosis::Diagnosis;
use tautline_core::estimation::Solution;
use tautline_session::Session;

use super::{accuracy, displacements};
use crate::identification::Identification;
use crate::report::document::{Block, Section};
use crate::report::input::ReportInput;
use crate::wording::count;
use crate::wording::units::quantity;

/// Probability below which the model does not explain the data.
const DOUBT: f64 = 0.01;

pub fn section(input: &ReportInput<'_>) -> Section {
    let mut section = Section::new("Result");
    if input.outdated {
        section.lead("The session has changed since this was computed: identify again before you use the values.");
    }
    if input.fit.is_some_and(|fit| !fit.solution.converged()) {
        section.lead("The identification did NOT converge: do not rely on its values.");
    }
    match (input.diagnosis, input.fit) {
        (Some(diagnosed), _) => {
            section.lead(diagnosed.headline());
            let findings = diagnosed.diagnosis.findings.iter();
            section.list(findings.map(|f| diagnosed.heading(f)).collect());
        }
        (None, Some(fit)) => section.lead(verdict(&fit.solution, input.session)),
        (None, None) => section.lead(nothing(input.session)),
    }
    if let Some(fit) = input.fit {
        section.paragraph(moved(fit));
        if let Some(tolerance_m) = input.choice.tolerance_m {
            displacements::judged(fit, tolerance_m, &mut section);
        }
        for deficiency in &fit.open {
            section.paragraph(format!("Open: {}.", deficiency.sentence));
        }
    }
    if let Some(text) = input.diagnosis.and_then(|d| largest_gain(&d.diagnosis)) {
        section.paragraph(text);
    }
    if let Some(text) = accuracy::summary(input.session) {
        section.paragraph(text);
    }
    if let Some(png) = input.picture {
        section.blocks.push(Block::Picture {
            png: png.to_vec(),
            caption: match input.fit {
                Some(_) => format!(
                    "{}: arrows point from the nominal to the identified pulleys, enlarged",
                    input.session.robot.name
                ),
                None => format!("{} with its cables", input.session.robot.name),
            },
        });
    }
    section
}

fn nothing(session: &Session) -> String {
    match session.measurements.len() {
        0 => "No pose has been measured yet: this report describes the robot and the preparations."
            .to_owned(),
        poses => format!("{} measured, nothing identified yet.", count(poses, "pose")),
    }
}

/// Whether the model explains the readings, without a diagnosis.
fn verdict(solution: &Solution, session: &Session) -> String {
    let name = &session.robot.name;
    match solution.p_value() {
        None => format!(
            "{name}: there are only just enough readings to identify the pulleys, so the model cannot be tested."
        ),
        Some(p) if p < DOUBT => format!(
            "{name}: the model does NOT explain the readings. The standard deviations are not valid."
        ),
        Some(_) => format!("{name}: the model explains the readings."),
    }
}

/// Largest displacement of a pulley from the drawing.
fn moved(fit: &Identification) -> String {
    let nominal = &fit.dataset.robot.cables;
    let distances = fit.displacements_m(&fit.dataset.robot).into_iter();
    let distances = distances.zip(nominal.iter().map(|cable| cable.name.as_str()));
    let farthest = distances.max_by(|a, b| a.0.total_cmp(&b.0));
    let poses = count(fit.dataset.measurements.len(), "pose");
    match farthest {
        Some((distance, name)) if distance > 0.0 => format!(
            "Identified from {poses}. Largest displacement from the drawing: the pulley of {name}, {}.",
            quantity(distance, "m")
        ),
        _ => format!("Identified from {poses}. No pulley is displaced from the drawing."),
    }
}

/// Effect of the most important finding on the position of the platform.
fn largest_gain(diagnosis: &Diagnosis) -> Option<String> {
    let positions = diagnosis.findings.iter().map(|f| f.gain.position);
    let largest = positions.max_by(|a, b| a.rms_m.total_cmp(&b.rms_m))?;
    Some(format!(
        "The most important finding moves the platform by {} rms (up to {}).",
        quantity(largest.rms_m, "m"),
        quantity(largest.largest_m, "m")
    ))
}
