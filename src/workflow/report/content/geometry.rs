//! The identified parameters.

use tautline_core::estimation::ParameterId;

use super::{NONE, displacements, number, signed};
use crate::identification::{
    FitVerdict, Identification, PulleyInspection, nominal_and_value, unit_of_value,
};
use crate::report::document::{Section, Table};
use crate::report::input::ReportInput;
use crate::wording::units::{decimals_of_uncertainty, display_unit};
use crate::wording::{count, sentence};

/// Correlations above this magnitude are listed.
const CORRELATED: f64 = 0.9;
/// Largest number of correlations listed.
const LISTED: usize = 10;
/// Number of tolerances within which the deviation of a part is nothing unusual.
const USUAL: f64 = 2.0;
/// Largest number of decimals shown.
const FINEST: usize = 4;

pub fn section(input: &ReportInput<'_>) -> Option<Section> {
    let fit = input.fit?;
    let mut section = Section::new("Identified values");
    if fit.solution.covariance.is_none() {
        section.lead(
            "The data do not determine all of these values: there are no standard deviations.",
        );
    } else if explains(fit) {
        section.paragraph("Each true value lies within the expanded uncertainty of the identified one with 95 % probability.");
    } else {
        section.lead("The model does not explain the data: true values may lie far outside the expanded uncertainty.");
    }
    let rule = input.session.settings.certificate.decision_rule;
    let judged = input.choice.tolerance_m.map(|limit_m| (rule, limit_m));
    displacements::drawn(fit, judged, &mut section);
    section.table(entry_points(fit));
    let appended = appended_deviations(fit);
    let caption = "Other identified parameters; home rotations are relative to the nominal pose";
    section.table(others(fit, caption, |index| !appended.contains(&index)));
    if !appended.is_empty() {
        let deviations = sentence(&count(appended.len(), "deviation"));
        section.paragraph(match explains(fit) {
            true => format!(
                "{deviations} of parts lie within {USUAL:.0} tolerances; they are in the appendix."
            ),
            false => format!("{deviations} of parts are in the appendix."),
        });
    }
    correlations(fit, &mut section);
    Some(section)
}

/// The deviations of parts that are no result; `None` if there are none.
pub fn deviations(fit: &Identification) -> Option<Section> {
    let appended = appended_deviations(fit);
    let mut section = Section::new("Appendix: deviations of the parts");
    let caption = "Deviations of the parts from their description";
    section.table(others(fit, caption, |index| appended.contains(&index)));
    (!appended.is_empty()).then_some(section)
}

fn explains(fit: &Identification) -> bool {
    fit.solution.converged() && FitVerdict::of(fit.solution.p_value()).holds()
}

/// Number of decimals for standard deviations (in the unit of the table), from their median.
fn common_decimals(sds: impl Iterator<Item = f64>) -> usize {
    let mut sds: Vec<f64> = sds.filter(|sd| sd.is_finite() && *sd > 0.0).collect();
    sds.sort_by(f64::total_cmp);
    sds.get(sds.len() / 2)
        .map_or(2, |sd| decimals_of_uncertainty(*sd).min(FINEST))
}

fn entry_points(fit: &Identification) -> Table {
    let robot = &fit.dataset.robot;
    let cables = 0..robot.cable_count();
    let pulleys = cables.filter_map(|cable| PulleyInspection::of(robot, Some(fit), cable));
    let pulleys: Vec<PulleyInspection> = pulleys.collect();
    let budget = fit.budget();
    let rows = pulleys.iter().flat_map(|pulley| {
        let factor = (budget.as_ref()).and_then(|all| all.coverage_factor_of(&pulley.name));
        let axes = (0..3).filter_map(move |axis| Some((pulley.identified.as_ref()?, axis)));
        axes.map(move |(found, axis)| (pulley, factor, found, axis))
    });
    let rows: Vec<_> = rows.collect();
    let sds = rows
        .iter()
        .filter_map(|(.., found, axis)| found.coordinates[*axis].sd_m);
    let digits = common_decimals(sds.map(|sd| 1e3 * sd));
    let caption = "Entry points of the cables at their pulleys (mm, base frame)";
    Table::of(caption, 2, &rows).columns(&[
        ("Cable", &|(pulley, .., axis)| match axis {
            0 => pulley.name.clone(),
            _ => String::new(),
        }),
        ("axis", &|(.., axis)| ["x", "y", "z"][*axis].to_owned()),
        ("nominal", &|(pulley, .., axis)| {
            number(1e3 * pulley.nominal_m[*axis], digits)
        }),
        ("identified", &|(.., found, axis)| {
            number(1e3 * found.entry_m[*axis], digits)
        }),
        ("difference", &|(.., found, axis)| {
            signed(1e3 * found.coordinates[*axis].change_m, digits)
        }),
        (
            "standard deviation",
            &|(.., found, axis)| match found.coordinates[*axis].sd_m {
                Some(0.0) => "given".to_owned(),
                Some(sd) => number(1e3 * sd, digits),
                None => "undetermined".to_owned(),
            },
        ),
        ("expanded uncertainty", &|(_, factor, found, axis)| {
            let sd = found.coordinates[*axis].sd_m.filter(|sd| *sd != 0.0);
            let expanded = sd.zip(*factor).map(|(sd, factor)| 1e3 * factor * sd);
            expanded.map_or_else(|| NONE.to_owned(), |mm| number(mm, digits))
        }),
    ])
}

/// Indices of the deviations of parts that lie within their tolerances, and of all deviations where the model does not explain
/// the data: parts that are not at fault take over what it lacks.
fn appended_deviations(fit: &Identification) -> Vec<usize> {
    let explains = explains(fit);
    let is_appended = |index: &usize| {
        let parameter = &fit.solution.parameters[*index];
        let is_deviation = matches!(parameter.id, ParameterId::Deviation { .. });
        let found = nominal_and_value(fit, parameter);
        let off = found.map(|(nominal, found)| (found - nominal.unwrap_or(0.0)).abs());
        let known = off.zip(parameter.prior_sd);
        let is_usual = known.is_some_and(|(off, tolerance)| off <= USUAL * tolerance);
        is_deviation && (is_usual || !explains)
    };
    (0..fit.solution.parameters.len())
        .filter(is_appended)
        .collect()
}

/// The wanted of the other parameters, by their indices.
fn others(fit: &Identification, caption: &str, is_wanted: impl Fn(usize) -> bool) -> Table {
    let mut table = Table::new(
        caption,
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
        if matches!(parameter.id, ParameterId::EntryPoint { .. }) || !is_wanted(index) {
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
        let name = &parameter.name;
        table.push([
            sentence(name.strip_prefix("deviation: ").unwrap_or(name)),
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
