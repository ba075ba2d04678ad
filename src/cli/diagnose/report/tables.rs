//! The statistics behind a diagnosis.

use comfy_table::Table;
use tautline_core::diagnosis::{Adequacy, Discrepancy, Finding, Invisible};

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
    table::rows(&finding.gain.kinds).table(&[
        ("Reading", &|kind| kind.quantity.name().to_owned()),
        ("before", &|kind| format!("{:.3}", kind.before)),
        ("after", &|kind| format!("{:.3}", kind.after)),
    ])
}

fn ranking(diagnosed: &Diagnosed, finding: &Finding) -> Table {
    table::rows(&finding.evidence.ranking).table(&[
        ("Cause", &|rival| diagnosed.title(&rival.cause)),
        ("gained", &|rival| format!("{:.1}", rival.delta_chi2)),
        ("parameters", &|rival| rival.parameters.to_string()),
        ("held out", &|rival| format!("{:.3}", rival.holdout)),
    ])
}

fn groups_table(diagnosed: &Diagnosed, adequacy: &Adequacy) -> Table {
    table::rows(&adequacy.groups).table(&[
        ("Reading", &|group| group.quantity.name().to_owned()),
        ("cable", &|group| {
            diagnosed
                .cable(group.cable)
                .unwrap_or_else(|| "all".to_owned())
        }),
        ("readings", &|group| group.readings.to_string()),
        ("rms/sd", &|group| format!("{:.3}", group.rms_over_sd)),
        ("p", &|group| probability(group.p_value)),
    ])
}

fn discrepancy_table(diagnosed: &Diagnosed, discrepancies: &[Discrepancy]) -> Table {
    table::rows(discrepancies).table(&[
        ("Reading", &|found| found.quantity.name().to_owned()),
        ("cable", &|found| {
            diagnosed.cable(found.cable).unwrap_or_default()
        }),
        ("depends on", &|found| found.variable.name().to_owned()),
        ("rms/sd", &|found| format!("{:.3}", found.rms_over_sd)),
        ("p", &|found| probability(found.p_value)),
    ])
}

fn invisible_table(diagnosed: &Diagnosed) -> Table {
    let smallest = |one: &Invisible| {
        let (parameter, unit) = one.parameter;
        let smallest = one.smallest_visible;
        smallest.map(|size| quantity(size, unit_of(parameter, unit)))
    };
    table::rows(&diagnosed.diagnosis.invisible).table(&[
        ("Effect", &|one| diagnosed.title(&one.cause)),
        ("parameter", &|one| one.parameter.0.to_owned()),
        ("visible from", &|one| {
            smallest(one).unwrap_or_else(|| "never".to_owned())
        }),
    ])
}
