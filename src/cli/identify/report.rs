//! The human-readable report of an identification.

use tautline_core::robot::Robot;
use tautline_workflow::identification::{
    BudgetDocument, FitVerdict, IdentificationDocument, PulleyBudget, SourceSummary, source_title,
};
use tautline_workflow::wording::sentence;
use tautline_workflow::wording::units::{unit_of, with_sd};

use crate::output::say;
use crate::table::{self, mm};

/// Smallest share of a source that is listed.
const LISTED_SHARE: f64 = 0.01;
/// Largest number of suspect readings listed.
const SUSPECTS_SHOWN: usize = 10;

/// Prints an identification, with its entry points compared with those of a drawing.
pub fn print(identification: &IdentificationDocument, drawing: &Robot) {
    say!("{}", identification.summary(&drawing.name));
    say!("{}", adequacy(identification));
    print_entry_points(identification, drawing);
    if !identification.effects.is_empty() {
        print_effects(identification);
    }
    print_residuals(identification);
    if let Some(budget) = &identification.budget {
        print_budget(budget);
    }
    for sentence in &identification.undetermined {
        say!("undetermined: {sentence}");
    }
    print_suspects(&identification.suspect_readings);
}

/// Placeholder for a standard deviation that the data do not determine.
fn no_sd() -> String {
    "-".to_owned()
}

fn print_entry_points(identification: &IdentificationDocument, drawing: &Robot) {
    let found = identification.entry_points_m.iter();
    let found = found.zip(&identification.entry_points_sd_m);
    let sd = |sd: Option<f64>| sd.map_or_else(no_sd, |sd| mm(sd, 2));
    table::rows(drawing.cables.iter().zip(found)).print(&[
        ("Cable", &|(cable, _)| cable.name.clone()),
        ("x mm", &|(_, (point, _))| mm(point[0], 2)),
        ("y mm", &|(_, (point, _))| mm(point[1], 2)),
        ("z mm", &|(_, (point, _))| mm(point[2], 2)),
        ("sd x", &|(_, (_, sds))| sd(sds[0])),
        ("sd y", &|(_, (_, sds))| sd(sds[1])),
        ("sd z", &|(_, (_, sds))| sd(sds[2])),
        ("moved mm", &|(cable, (point, _))| {
            let drawn = cable.pulley.entry_point_m;
            let square: f64 = (0..3).map(|k| (point[k] - drawn[k]).powi(2)).sum();
            mm(square.sqrt(), 2)
        }),
    ]);
}

fn print_effects(identification: &IdentificationDocument) {
    table::rows(&identification.effects).print(&[
        ("Effect", &|one| {
            let on = one.targets.join(", ");
            format!("{} {} {on}", one.effect, one.parameter)
        }),
        ("value", &|one| {
            let unit = unit_of(&one.parameter, &one.unit);
            with_sd(one.value, one.sd.unwrap_or(f64::NAN), unit)
        }),
    ]);
}

fn print_residuals(identification: &IdentificationDocument) {
    let rms = &identification.rms;
    let show = |name: &str, value: Option<f64>, scale: f64, unit: &str| {
        if let Some(value) = value {
            say!("rms residual {name}: {:.3} {unit}", value * scale);
        }
    };
    show("of lengths", rms.length_m, 1e3, "mm");
    show("of the laser", rms.laser_m, 1e3, "mm");
    show("of tensions", rms.tension_n, 1.0, "N");
}

/// Sources of uncertainty with their shares, and the pulley in which each has its largest share.
fn print_budget(budget: &BudgetDocument) {
    if let Some(position) = &budget.position {
        let rms = mm(position.sd_m(), 2);
        say!(
            "expected rms position error at the measured poses with these values in the controller: {rms} mm"
        );
    }
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    table::rows(budget.summary(LISTED_SHARE)).print(&[
        ("Uncertainty from", &|one| {
            sentence(&source_title(&one.source))
        }),
        ("pulleys", &|one| percent(one.pulleys)),
        ("position", &|one| one.position.map_or_else(no_sd, percent)),
        ("most in", &|one| {
            let most = most_in(budget, one);
            most.map_or_else(String::new, |(cable, share)| {
                format!("{cable}: {}", percent(share))
            })
        }),
    ]);
}

/// The pulley in which a source has its largest share, and that share.
fn most_in<'a>(budget: &'a BudgetDocument, of: &SourceSummary) -> Option<(&'a str, f64)> {
    let share = |one: &'a PulleyBudget| (one.cable.as_str(), one.budget.share(&of.source));
    let shares = budget.pulleys.iter().map(share);
    shares.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn print_suspects(suspects: &[String]) {
    for suspect in suspects.iter().take(SUSPECTS_SHOWN) {
        say!("suspect: {suspect}");
    }
    if let Some(more @ 1..) = suspects.len().checked_sub(SUSPECTS_SHOWN) {
        say!("... and {more} more suspect readings");
    }
}

/// Verdict on the fit of the model, in words.
fn adequacy(identification: &IdentificationDocument) -> String {
    let (chi2, dof) = (identification.chi2, identification.dof);
    let figures = format!("chi-square {chi2:.1} for {dof:.0} degrees of freedom");
    let explains = FitVerdict::of(identification.p_value);
    let words = explains.words();
    match identification.p_value {
        Some(_) if explains == FitVerdict::Inadequate => format!(
            "{figures}: the model does NOT explain the data, so the standard deviations are not valid"
        ),
        Some(p) if explains == FitVerdict::Doubtful => format!("{figures} (p = {p:.4}): {words}"),
        Some(p) if explains == FitVerdict::Adequate => format!("{figures} (p = {p:.3}): {words}"),
        _ => format!("{figures}: {words}"),
    }
}
