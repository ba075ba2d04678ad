//! Conformity of the pulleys with a tolerance on their displacements from the drawing.

use nalgebra::Vector3;
use tautline_core::conformance::joint_conformance_probability;

use super::NONE;
use super::displacements::deviations;
use crate::identification::{FitVerdict, Identification, entry_points_covariance};
use crate::report::document::{Section, Table};
use crate::report::input::ReportInput;
use crate::report::tolerance::{COVERAGE, Conformity, rule_in_words};
use crate::wording::probability::percent;
use crate::wording::units::{decimals_of_uncertainty, fixed, mm, significant};
use crate::wording::{count, list};

/// A tolerance (m) in words.
fn limit(tolerance_m: f64) -> String {
    format!("{} mm", significant(1e3 * tolerance_m, 3))
}

/// Whether the uncertainties of the identification are valid.
fn is_valid(fit: &Identification) -> bool {
    FitVerdict::of(fit.solution.p_value()).holds() && fit.solution.converged()
}

/// The verdict on all pulleys in a sentence; `None` without a tolerance.
pub fn verdict(input: &ReportInput<'_>) -> Option<String> {
    let (fit, tolerance_m) = (input.fit?, input.choice.tolerance_m?);
    let limit = limit(tolerance_m);
    if !is_valid(fit) {
        return Some(format!(
            "No pulley is judged by the tolerance of {limit}: the model does not explain the data, so the uncertainties are not valid."
        ));
    }
    let rule = input.session.settings.certificate.decision_rule;
    let pulleys = deviations(fit, None);
    let names = |wanted: Conformity| -> Vec<String> {
        let cables = fit.dataset.robot.cables.iter();
        let judged = cables.zip(&pulleys);
        judged
            .filter(|(_, pulley)| pulley.conformity(rule, tolerance_m) == wanted)
            .map(|(cable, _)| cable.name.clone())
            .collect()
    };
    let (outside, undecided) = (names(Conformity::Outside), names(Conformity::Undecided));
    let all = count(pulleys.len(), "pulley");
    Some(match (outside.is_empty(), undecided.is_empty()) {
        (true, true) => format!("All {all} are within the tolerance of {limit}."),
        _ if outside.len() == pulleys.len() => {
            format!("All {all} are outside the tolerance of {limit}.")
        }
        (true, false) => format!(
            "No pulley is outside the tolerance of {limit}; not decided: {}.",
            list(&undecided)
        ),
        (false, true) => format!(
            "Outside the tolerance of {limit}: {}. The others are within it.",
            list(&outside)
        ),
        (false, false) => format!(
            "Outside the tolerance of {limit}: {}. Not decided: {}.",
            list(&outside),
            list(&undecided)
        ),
    })
}

/// Each pulley with its verdict and the probability of conformance; `None` without a tolerance.
pub fn section(input: &ReportInput<'_>) -> Option<Section> {
    let (fit, tolerance_m) = (input.fit?, input.choice.tolerance_m?);
    let mut section = Section::new("Conformity");
    section.lead(verdict(input)?);
    if !is_valid(fit) {
        return Some(section);
    }
    let rule = input.session.settings.certificate.decision_rule;
    let pulleys = deviations(fit, None);
    let mut table = Table::new(
        format!("Displacements and the tolerance of {}", limit(tolerance_m)),
        1,
        &[
            "Pulley",
            "displacement mm",
            "expanded uncertainty (k = 2) mm",
            "conformance probability",
            "verdict",
        ],
    );
    for (cable, pulley) in fit.dataset.robot.cables.iter().zip(&pulleys) {
        let uncertainty = pulley.uncertainty_m(COVERAGE);
        let digits = uncertainty.map_or(2, |u| decimals_of_uncertainty(1e3 * u));
        table.push([
            cable.name.clone(),
            mm(pulley.by.norm(), digits),
            uncertainty.map_or_else(|| NONE.to_owned(), |u| fixed(1e3 * u, digits)),
            (pulley.conformance_probability(tolerance_m)).map_or_else(|| NONE.to_owned(), percent),
            pulley.conformity(rule, tolerance_m).words().to_owned(),
        ]);
    }
    section.table(table);
    let by: Vec<Vector3<f64>> = pulleys.iter().map(|pulley| pulley.by).collect();
    let covariance = entry_points_covariance(&fit.solution, pulleys.len());
    let joint = covariance.and_then(|all| joint_conformance_probability(&by, &all, tolerance_m));
    if let Some(probability) = joint {
        section.paragraph(format!(
            "Probability that all pulleys are within the tolerance: {} (JCGM 106, from their joint covariance).",
            percent(probability)
        ));
    }
    section.note(rule_in_words(rule));
    section.note("Conformance probability: that the true displacement is within the tolerance, given its estimate and the covariance of its coordinates, for a normal distribution.");
    Some(section)
}
