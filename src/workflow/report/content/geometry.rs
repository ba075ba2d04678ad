//! The identified parameters.

use tautline_core::estimation::ParameterId;

use super::{NONE, displacements, number, signed};
use crate::identification::{Identification, nominal_and_value, unit_of_value};
use crate::report::document::{Section, Table};
use crate::wording::units::{decimals, display_unit};
use crate::wording::{count, sentence};

/// Correlations above this magnitude are listed.
const CORRELATED: f64 = 0.9;
/// Largest number of correlations listed.
const LISTED: usize = 10;
/// Standard deviation of a part's deviation over its tolerance above which the readings say hardly more than the tolerance.
const HARDLY_KNOWN: f64 = 0.9;
/// Largest number of decimals shown.
const FINEST: usize = 4;

pub fn section(fit: &Identification, tolerance_m: Option<f64>) -> Section {
    let mut section = Section::new("Identified values");
    if fit.solution.covariance.is_none() {
        section.lead(
            "The data do not determine all of these values: there are no standard deviations.",
        );
    } else {
        section.paragraph("If the model explains the data, each true value lies within two standard deviations of the identified one with 95 % probability.");
    }
    displacements::drawn(fit, tolerance_m, &mut section);
    section.table(entry_points(fit));
    let unknown = deviations_hardly_known(fit);
    section.table(others(fit, &unknown));
    if !unknown.is_empty() {
        section.note(format!(
            "Left out: {} of parts, of which the readings say hardly more than the tolerances.",
            count(unknown.len(), "deviation")
        ));
    }
    correlations(fit, &mut section);
    section
}

/// Number of decimals for standard deviations (in the unit of the table), from their median.
fn common_decimals(sds: impl Iterator<Item = f64>) -> usize {
    let mut sds: Vec<f64> = sds.filter(|sd| sd.is_finite() && *sd > 0.0).collect();
    sds.sort_by(f64::total_cmp);
    sds.get(sds.len() / 2)
        .map_or(2, |sd| decimals(*sd).min(FINEST))
}

/// Standard deviation of a parameter; `None` if the data do not determine it.
fn sd(fit: &Identification, id: &ParameterId) -> Option<f64> {
    let index = fit.solution.parameters.iter().position(|p| p.id == *id)?;
    fit.solution.standard_deviation(index)
}

fn is_estimated(fit: &Identification, id: &ParameterId) -> bool {
    fit.solution.parameters.iter().any(|p| p.id == *id)
}

fn entry_points(fit: &Identification) -> Table {
    let mut table = Table::new(
        "Entry points of the cables at their pulleys (mm, base frame)",
        2,
        &[
            "Cable",
            "axis",
            "nominal",
            "identified",
            "difference",
            "standard deviation",
        ],
    );
    let id = |cable, axis| ParameterId::EntryPoint { cable, axis };
    let cables = &fit.dataset.robot.cables;
    let all = (0..cables.len()).flat_map(|cable| (0..3).map(move |axis| (cable, axis)));
    let digits = common_decimals(
        all.filter_map(|(c, a)| sd(fit, &id(c, a)))
            .map(|sd| 1e3 * sd),
    );
    let points = cables.iter().zip(&fit.solution.globals.entry_points);
    for (cable, (description, found)) in points.enumerate() {
        for (axis, label) in ["x", "y", "z"].into_iter().enumerate() {
            let nominal = description.pulley.entry_point_m[axis];
            let sd = match sd(fit, &id(cable, axis)) {
                Some(sd) => number(1e3 * sd, digits),
                None if is_estimated(fit, &id(cable, axis)) => "undetermined".to_owned(),
                None => "given".to_owned(),
            };
            let name = if axis == 0 { &description.name } else { "" };
            table.push([
                name.to_owned(),
                label.to_owned(),
                number(1e3 * nominal, digits),
                number(1e3 * found[axis], digits),
                signed(1e3 * (found[axis] - nominal), digits),
                sd,
            ]);
        }
    }
    table
}

/// Indices of the deviations of parts that the readings hardly determine.
fn deviations_hardly_known(fit: &Identification) -> Vec<usize> {
    let is_unknown = |index: &usize| {
        let parameter = &fit.solution.parameters[*index];
        let sd = fit.solution.standard_deviation(*index);
        let is_deviation = matches!(parameter.id, ParameterId::Deviation { .. });
        let known = sd.zip(parameter.prior_sd);
        is_deviation && known.is_some_and(|(sd, prior)| sd > HARDLY_KNOWN * prior)
    };
    (0..fit.solution.parameters.len())
        .filter(is_unknown)
        .collect()
}

/// The other parameters without those of the given indices.
fn others(fit: &Identification, left_out: &[usize]) -> Table {
    let mut table = Table::new(
        "Other identified parameters; home rotations are relative to the nominal pose",
        2,
        &[
            "Parameter",
            "unit",
            "nominal",
            "identified",
            "difference",
            "standard deviation",
        ],
    );
    for (index, parameter) in fit.solution.parameters.iter().enumerate() {
        if matches!(parameter.id, ParameterId::EntryPoint { .. }) || left_out.contains(&index) {
            continue;
        }
        let Some((nominal, found)) = nominal_and_value(fit, parameter) else {
            continue;
        };
        let (factor, unit) = display_unit(unit_of_value(fit, parameter));
        let sd = fit.solution.standard_deviation(index).map(|sd| factor * sd);
        let digits = sd.map_or(2, |sd| common_decimals(std::iter::once(sd)));
        let shown = |value: Option<f64>, text: fn(f64, usize) -> String| {
            value.map_or_else(|| NONE.to_owned(), |value| text(factor * value, digits))
        };
        table.push([
            sentence(&parameter.name),
            unit.to_owned(),
            shown(nominal, number),
            number(factor * found, digits),
            shown(nominal.map(|nominal| found - nominal), signed),
            sd.map_or_else(|| "undetermined".to_owned(), |sd| number(sd, digits)),
        ]);
    }
    table
}

fn correlations(fit: &Identification, section: &mut Section) {
    let Some(all) = fit.solution.correlations() else {
        return;
    };
    let pairs = (0..all.nrows()).flat_map(|i| (0..i).map(move |k| (i, k)));
    let mut strong: Vec<(usize, usize, f64)> = pairs
        .map(|(i, k)| (k, i, all[(i, k)]))
        .filter(|(_, _, c)| c.abs() > CORRELATED)
        .collect();
    strong.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    if strong.is_empty() {
        section.note(format!(
            "No two of these values have a correlation above {CORRELATED}."
        ));
        return;
    }
    let shown = strong.len().min(LISTED);
    let which = if shown < strong.len() {
        format!("the {shown} strongest of {} pairs", strong.len())
    } else {
        format!("pairs above {CORRELATED}")
    };
    let mut table = Table::new(
        format!(
            "Strong correlations ({which}): such values are known better in combination than individually"
        ),
        2,
        &["Parameter", "and", "correlation"],
    );
    let name = |k: usize| sentence(&fit.solution.parameters[k].name);
    for (a, b, correlation) in strong.into_iter().take(LISTED) {
        table.push([name(a), name(b), signed(correlation, 3)]);
    }
    section.table(table);
}
