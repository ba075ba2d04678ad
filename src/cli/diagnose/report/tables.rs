//! The statistics behind a diagnosis.

use comfy_table::Table;
use tautline_core::diagnosis::{Adequacy, Discrepancy, Finding, GroupTest};

use super::Diagnosed;
use crate::table;
use tautline_workflow::wording::units::{quantity, unit_of};

/// All statistics behind the conclusions.
pub fn lines(diagnosed: &Diagnosed) -> Vec<String> {
    let diagnosis = &diagnosed.diagnosis;
    let mut lines = Vec::new();
    let mut add = |title: String, table: &Table| {
        if !table.is_empty() {
            lines.extend([String::new(), title, table.to_string()]);
        }
    };
    for (index, finding) in diagnosis.findings.iter().enumerate() {
        let number = index + 1;
        let title = format!("Finding {number}: {}", evidence(finding));
        add(title, &ranking(diagnosed, finding));
        add(
            format!("Finding {number}: readings at held-out poses, rms over sd"),
            &kinds(finding),
        );
    }
    add(
        format!("Tests of the original model: {}", global(&diagnosis.base)),
        &groups_table(diagnosed, &diagnosis.base),
    );
    if !diagnosis.findings.is_empty() {
        add(
            format!(
                "Tests of the extended model: {}",
                global(&diagnosis.extended)
            ),
            &groups_table(diagnosed, &diagnosis.extended),
        );
    }
    add(
        "Residuals of the original model that depend on a variable".to_owned(),
        &discrepancy_table(diagnosed, &diagnosis.discrepancies),
    );
    add(
        "Residuals of the extended model that depend on a variable".to_owned(),
        &discrepancy_table(diagnosed, &diagnosis.remaining),
    );
    add(
        "Smallest sizes that would be found in 9 of 10 cases".to_owned(),
        &invisible_table(diagnosed),
    );
    lines
}

fn evidence(finding: &Finding) -> String {
    let evidence = &finding.evidence;
    format!(
        "chi-square falls by {:.1} for {} more parameters, p = {} corrected for {} tests; ranking:",
        evidence.delta_chi2,
        evidence.parameters,
        probability(evidence.p_value),
        evidence.questions
    )
}

fn global(adequacy: &Adequacy) -> String {
    let test = adequacy.global;
    format!(
        "chi-square {:.1} for {:.0} degrees of freedom, p = {}",
        test.chi2,
        test.degrees_of_freedom,
        probability(test.p_value)
    )
}

fn probability(p_value: f64) -> String {
    if p_value >= 0.001 {
        format!("{p_value:.3}")
    } else {
        format!("{p_value:.1e}")
    }
}

fn kinds(finding: &Finding) -> Table {
    let mut rows = table::numbers(&["Reading", "before", "after"]);
    for kind in &finding.gain.kinds {
        let cells = [
            kind.quantity.name().to_owned(),
            format!("{:.3}", kind.before),
            format!("{:.3}", kind.after),
        ];
        table::push(&mut rows, &cells);
    }
    rows
}

fn ranking(diagnosed: &Diagnosed, finding: &Finding) -> Table {
    let mut rows = table::numbers(&["Cause", "gained", "parameters", "held out"]);
    for rival in &finding.evidence.ranking {
        let cells = [
            diagnosed.title(&rival.cause),
            format!("{:.1}", rival.delta_chi2),
            rival.parameters.to_string(),
            format!("{:.3}", rival.holdout),
        ];
        table::push(&mut rows, &cells);
    }
    rows
}

fn groups_table(diagnosed: &Diagnosed, adequacy: &Adequacy) -> Table {
    let mut rows = table::numbers(&["Reading", "cable", "readings", "rms/sd", "p"]);
    for group in &adequacy.groups {
        let GroupTest { rms_over_sd, .. } = group;
        let cells = [
            group.quantity.name().to_owned(),
            diagnosed
                .cable(group.cable)
                .unwrap_or_else(|| "all".to_owned()),
            group.readings.to_string(),
            format!("{rms_over_sd:.3}"),
            probability(group.p_value),
        ];
        table::push(&mut rows, &cells);
    }
    rows
}

fn discrepancy_table(diagnosed: &Diagnosed, discrepancies: &[Discrepancy]) -> Table {
    let mut rows = table::numbers(&["Reading", "cable", "depends on", "rms/sd", "p"]);
    for found in discrepancies {
        let cells = [
            found.quantity.name().to_owned(),
            diagnosed.cable(found.cable).unwrap_or_default(),
            found.variable.name().to_owned(),
            format!("{:.3}", found.rms_over_sd),
            probability(found.p_value),
        ];
        table::push(&mut rows, &cells);
    }
    rows
}

fn invisible_table(diagnosed: &Diagnosed) -> Table {
    let mut rows = table::numbers(&["Effect", "parameter", "visible from"]);
    for invisible in &diagnosed.diagnosis.invisible {
        let (parameter, unit) = invisible.parameter;
        let smallest = invisible.smallest_visible;
        let cells = [
            diagnosed.title(&invisible.cause),
            parameter.to_owned(),
            smallest.map_or_else(
                || "never".to_owned(),
                |size| quantity(size, unit_of(parameter, unit)),
            ),
        ];
        table::push(&mut rows, &cells);
    }
    rows
}
