//! Undetermined parameters and assumptions.

use tautline_core::robot::Robot;

use crate::diagnosis::HIDDEN;
use crate::report::document::Section;
use crate::report::input::ReportInput;
use crate::wording::{count, sentence};

pub fn section(input: &ReportInput<'_>) -> Section {
    let mut section = Section::new("Limits");
    if let Some(fit) = input.fit {
        if fit.open.is_empty() {
            section.paragraph("The data determine all parameters.");
        } else {
            section.paragraph("The data do not determine the following:");
            let open = fit.open.iter();
            section.list(
                open.map(|d| format!("{}.", sentence(&d.sentence)))
                    .collect(),
            );
        }
    }
    match input.diagnosis {
        Some(diagnosed) => {
            if input.diagnosis_outdated {
                section.paragraph("The model was not diagnosed after its last change; the following is of the diagnosis before.");
            }
            let hidden = diagnosed.hidden_effects();
            if !hidden.sized.is_empty() {
                section.paragraph(HIDDEN);
                section.list(hidden.sized);
            }
            if !hidden.never.is_empty() {
                section.paragraph(format!(
                    "These poses cannot reveal the following faults at any size: {}.",
                    hidden.never.join(", ")
                ));
            }
        }
        None => section.paragraph(
            "The model was not diagnosed: faults that look like a displaced pulley may have affected the values.",
        ),
    }
    section.paragraph("Assumptions:");
    section.list(assumptions(&input.session.robot, input));
    section
}

fn assumptions(robot: &Robot, input: &ReportInput<'_>) -> Vec<String> {
    let parts = match robot.tolerances {
        Some(_) => "within their tolerances of what is drawn",
        None => "as drawn",
    };
    let mut all = vec![
        format!(
            "Pulley radii, swivel axes, platform anchors and drums are {parts}, unless an effect above says otherwise."
        ),
        "The noise of the readings is as stated in the robot's description, and independent."
            .to_owned(),
    ];
    let inelastic = robot
        .cables
        .iter()
        .filter(|c| c.cable.axial_stiffness_n.is_none() && c.cable.elongation_surface.is_none());
    match inelastic.count() {
        0 => {}
        some if some == robot.cable_count() => all.push("No cable stretches.".to_owned()),
        some => all.push(format!("{} taken as inelastic.", count(some, "cable"))),
    }
    if robot.cables.iter().all(|c| c.cable.weight_n_per_m == 0.0) {
        all.push("No cable sags under its weight.".to_owned());
    }
    let is_read = !input.session.measurements.force_n.is_empty();
    if let (false, Some(limits)) = (is_read, robot.unread_tension()) {
        all.push(format!(
            "Tensions, which were not measured, are those closest to {:.0} N that balance the platform, between {:.0} N and {:.0} N.",
            limits.reference_n, limits.lower_n, limits.upper_n
        ));
    }
    if robot.platform.mass_kg.is_some() && (is_read || robot.unread_tension().is_some()) {
        all.push("The platform is at rest at every pose, and nothing but gravity and the cables acts on it.".to_owned());
    }
    if input.session.phases.home.is_empty() && robot.home.is_some() {
        all.push(
            "The platform was at its home pose when the encoders were set to zero.".to_owned(),
        );
    }
    all
}
