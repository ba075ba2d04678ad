//! The first page: the result.

use tautline_core::diagnosis::{Diagnosis, Finding};
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::estimation::Solution;
use tautline_session::Session;

use super::{accuracy, adjustments, certificate, conformity, when};
use crate::diagnosis::proposal;
use crate::identification::{Identification, effect_sizes, effects_title, same_effect};
use crate::report::document::{Block, Section};
use crate::report::input::ReportInput;
use crate::wording::probability::certainty;
use crate::wording::units::quantity;
use crate::wording::{self, count};

/// What is said where no record is known. One session does not show how fast the robot changes.
const NO_RECORD: &str = "The date of the next calibration follows from a record of the robot; none was given, so there is no date.";
/// Probability below which the model does not explain the data.
const DOUBT: f64 = 0.01;

pub fn section(input: &ReportInput<'_>) -> Section {
    let mut section = Section::new("Result");
    for text in certificate::overdue_when_used(input.session, input.now) {
        section.lead(text);
    }
    if input.outdated {
        section.lead(
            "The data or the model changed after this identification: identify again before you use the values.",
        );
    }
    if input.fit.is_some_and(|fit| !fit.solution.converged()) {
        section.lead("The identification did NOT converge: do not rely on its values.");
    }
    state(input, &mut section);
    if let Some(text) = input
        .fit
        .and_then(|fit| adjustments::state(input.session, fit))
    {
        section.paragraph(text);
    }
    if let Some(text) = accuracy::summary(input.session) {
        section.paragraph(text);
    }
    if let Some(fit) = input.fit {
        section.paragraph(moved(fit));
        if let Some(text) = conformity::verdict(input) {
            section.lead(text);
        }
        section.paragraph(input.next_calibration.unwrap_or(NO_RECORD));
        for deficiency in &fit.open {
            section.paragraph(format!("Open: {}.", deficiency.sentence));
        }
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

/// Whether the identified model explains the readings, its effects, and what is known to be missing from it.
fn state(input: &ReportInput<'_>, section: &mut Section) {
    let Some(fit) = input.fit else {
        return section.lead(nothing(input.session));
    };
    let diagnosis = input.current_diagnosis();
    section.lead(match diagnosis {
        Some(diagnosed) => diagnosed.headline(),
        None => verdict(&fit.solution, input.session),
    });
    if let Some(p_value) = fit.solution.p_value() {
        section.paragraph(format!(
            "Global test of the model: chi-square {:.1} for {:.0} degrees of freedom, {}.",
            fit.solution.chi2,
            fit.solution.degrees_of_freedom,
            wording::p_value(p_value)
        ));
    }
    if let Some(diagnosed) = diagnosis {
        let findings = diagnosed.diagnosis.findings.iter();
        section.list(findings.map(|f| diagnosed.heading(f)).collect());
        if let Some(text) = largest_gain(&diagnosed.diagnosis) {
            section.paragraph(text);
        }
    }
    let effects = input.added_effects();
    if !effects.is_empty() {
        section.paragraph("Effects that were added to the model and identified with the pulleys:");
        let groups = effects.chunk_by(|one, other| one.effect == other.effect);
        section.list(
            groups
                .map(|group| added(input.session, fit, group))
                .collect(),
        );
    }
    if let Some(earlier) = input.diagnosis.filter(|_| diagnosis.is_none()) {
        section.paragraph(
            "The model was not diagnosed after the last change: the diagnosis in this report is an earlier one.",
        );
        let is_added = |bound: &BoundEffect| {
            let setting = bound.setting(earlier.robot());
            effects.iter().any(|one| same_effect(one, &setting))
        };
        let findings = earlier.diagnosis.findings.iter();
        let is_missing = |finding: &&Finding| {
            let cause = finding.cause();
            !cause.is_some_and(|cause| cause.instances.iter().all(is_added))
        };
        let missing = findings.filter(is_missing);
        let missing: Vec<String> = missing.map(|finding| earlier.heading(finding)).collect();
        if !missing.is_empty() {
            section.paragraph("It found the following, which the model does not have:");
            section.list(missing);
        }
    }
}

/// An effect of the model on all of its cables: its size, and the diagnosis that found it.
fn added(session: &Session, fit: &Identification, effects: &[EffectSetting]) -> String {
    let proposal = effects.first().and_then(|one| proposal(session, one));
    let origin = proposal.map_or_else(String::new, |proposal| {
        format!(
            ". Found by the diagnosis of {}: {}",
            when(proposal.time),
            certainty(proposal.probability)
        )
    });
    format!(
        "{}: {}{origin}.",
        effects_title(&session.robot, effects),
        effect_sizes(fit, effects).join("; ")
    )
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
    let poses = count(solution.poses.len(), "pose");
    match solution.p_value() {
        None => format!(
            "{name}: there are only just enough readings to identify the pulleys, so the model cannot be tested."
        ),
        Some(p) if p < DOUBT => format!(
            "{name}: the model does NOT explain the readings of {poses}. The standard deviations are not valid."
        ),
        Some(_) => format!("{name}: the model explains the readings of {poses}."),
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
