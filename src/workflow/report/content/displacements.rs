//! Displacements of the pulleys from the drawing, as drawings and judged against a tolerance.

use nalgebra::Vector3;

use super::{NONE, number};
use crate::identification::{FitVerdict, Identification, entry_point_covariance};
use crate::report::deviations::{Deviation, coordinates, views};
use crate::report::document::{Block, Section, Table};
use crate::report::tolerance::Conformity;
use crate::wording::probability::percent;
use crate::wording::units::{mm, significant};
use crate::wording::{count, list};

/// The displacement of each pulley; those not within the tolerance are highlighted.
fn deviations(fit: &Identification, tolerance_m: Option<f64>) -> Vec<Deviation> {
    let found = fit.solution.globals.entry_points.iter();
    let nominal = fit.dataset.robot.cables.iter();
    nominal
        .zip(found)
        .enumerate()
        .map(|(index, (cable, found))| {
            let from = Vector3::from(cable.pulley.entry_point_m);
            let mut deviation = Deviation {
                from,
                by: Vector3::from(*found) - from,
                covariance: entry_point_covariance(&fit.solution, index),
                is_marked: false,
            };
            deviation.is_marked = tolerance_m
                .is_some_and(|tolerance| conformity(&deviation, tolerance) == Conformity::Outside);
            deviation
        })
        .collect()
}

fn conformity(deviation: &Deviation, tolerance_m: f64) -> Conformity {
    Conformity::of(deviation.by.norm(), deviation.uncertainty_m(), tolerance_m)
}

/// Three views, and the coordinates with their intervals.
pub fn drawn(fit: &Identification, tolerance_m: Option<f64>, section: &mut Section) {
    let pulleys = deviations(fit, tolerance_m);
    draw(&pulleys, "on the drawing", tolerance_m, section);
}

/// The same for any displacements; `before` states the positions that they start from.
pub fn draw(pulleys: &[Deviation], before: &str, tolerance_m: Option<f64>, section: &mut Section) {
    let (views, magnification) = views(pulleys);
    section.heading("Displacements of the pulleys");
    let scale = match magnification > 1.0 {
        true => format!("{} times", significant(magnification, 2)),
        false => "not".to_owned(),
    };
    section.note(format!("Rings: where the pulleys are {before}. Arrows: displacements, {scale} magnified. Numbers: cables."));
    section.blocks.push(Block::Plots(views));
    section
        .blocks
        .push(Block::Plots(vec![coordinates(pulleys, tolerance_m)]));
}

/// The verdict for a tolerance in a sentence, and for each pulley.
pub fn judged(fit: &Identification, tolerance_m: f64, section: &mut Section) {
    let limit = format!("{} mm", significant(1e3 * tolerance_m, 3));
    if !FitVerdict::of(fit.solution.p_value()).holds() || !fit.solution.converged() {
        section.lead(format!(
            "No pulley is judged by the tolerance of {limit}: the model does not explain the data, so the uncertainties are not valid."
        ));
        return;
    }
    let pulleys = deviations(fit, Some(tolerance_m));
    let names = |wanted: Conformity| -> Vec<String> {
        let cables = fit.dataset.robot.cables.iter();
        let judged = cables.zip(&pulleys);
        judged
            .filter(|(_, pulley)| conformity(pulley, tolerance_m) == wanted)
            .map(|(cable, _)| cable.name.clone())
            .collect()
    };
    let (outside, undecided) = (names(Conformity::Outside), names(Conformity::Undecided));
    let all = count(pulleys.len(), "pulley");
    section.lead(match (outside.is_empty(), undecided.is_empty()) {
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
    });
    let mut table = Table::new(
        format!("Displacements and the tolerance of {limit}"),
        1,
        &[
            "Pulley",
            "displacement mm",
            "expanded uncertainty mm",
            "conformance probability",
            "verdict",
        ],
    );
    for (cable, pulley) in fit.dataset.robot.cables.iter().zip(&pulleys) {
        let uncertainty = pulley.uncertainty_m();
        table.push([
            cable.name.clone(),
            mm(pulley.by.norm(), 2),
            uncertainty.map_or_else(|| NONE.to_owned(), |u| number(1e3 * u, 2)),
            (pulley.conformance_probability(tolerance_m)).map_or_else(|| NONE.to_owned(), percent),
            conformity(pulley, tolerance_m).words().to_owned(),
        ]);
    }
    section.table(table);
    section.note("Decision rule: guarded acceptance and guarded rejection (JCGM 106, 8.3) with the expanded uncertainty, two standard deviations in the least certain direction, as guard band on either side of the limit, as in ISO 14253-1. Conformance probability: that the true displacement is within the tolerance, given its estimate and the covariance of its coordinates, for a normal distribution.");
}
