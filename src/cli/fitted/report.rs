//! The readable report of an identification.

use super::Fitted;
use crate::output::say;
use crate::table;
use tautline_workflow::documents::identification::{Explains, Identification};

/// Most suspect readings that a report lists.
const SUSPECTS_SHOWN: usize = 10;

/// The readable report.
pub fn print_report(fitted: &Fitted<'_>, identification: &Identification) {
    say!("{}", headline(fitted, identification));
    say!("{}", adequacy(identification));
    print_entry_points(fitted, identification);
    if !identification.effects.is_empty() {
        print_effects(identification);
    }
    print_residuals(identification);
    for sentence in &identification.undetermined {
        say!("open: {sentence}");
    }
    print_suspects(&identification.suspect_readings);
}

/// What stands in the place of a standard deviation that there is none of.
fn no_sd() -> String {
    "-".to_owned()
}

fn print_entry_points(fitted: &Fitted<'_>, identification: &Identification) {
    let mut points = table::numbers(&[
        "Cable", "x mm", "y mm", "z mm", "sd x", "sd y", "sd z", "moved mm",
    ]);
    for (index, cable) in fitted.robot().cables.iter().enumerate() {
        let point = fitted.solution.globals.entry_points[index];
        let drawn = fitted.drawn_m[index];
        let sds = identification.entry_points_sd_m[index];
        let square: f64 = (0..3).map(|k| (point[k] - drawn[k]).powi(2)).sum();
        let mut cells = vec![cable.name.clone()];
        cells.extend(point.map(|v| table::mm(v, 2)));
        cells.extend(sds.map(|sd| sd.map_or_else(no_sd, |sd| table::mm(sd, 2))));
        cells.push(table::mm(square.sqrt(), 2));
        table::push(&mut points, &cells);
    }
    say!("{points}");
}

fn print_effects(identification: &Identification) {
    let mut effects = table::numbers(&["Effect", "value", "sd", "unit"]);
    for effect in &identification.effects {
        let on = effect.targets.join(", ");
        let cells = [
            format!("{} {} {on}", effect.effect, effect.parameter),
            format!("{:.5e}", effect.value),
            effect.sd.map_or_else(no_sd, |sd| format!("{sd:.3e}")),
            effect.unit.clone(),
        ];
        table::push(&mut effects, &cells);
    }
    say!("{effects}");
}

fn print_residuals(identification: &Identification) {
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

fn print_suspects(suspects: &[String]) {
    for suspect in suspects.iter().take(SUSPECTS_SHOWN) {
        say!("suspect: {suspect}");
    }
    if let Some(more @ 1..) = suspects.len().checked_sub(SUSPECTS_SHOWN) {
        say!("... and {more} more suspect readings");
    }
}

fn headline(fitted: &Fitted<'_>, identification: &Identification) -> String {
    let end = if identification.converged {
        "converged"
    } else {
        "did NOT converge"
    };
    format!(
        "{}: {} poses, {} method {end} after {} iterations in {:.3} ms",
        fitted.robot().name,
        identification.poses.len(),
        identification.method,
        identification.iterations,
        identification.seconds * 1e3
    )
}

/// Whether the model explains the data, in words.
fn adequacy(identification: &Identification) -> String {
    let (chi2, dof) = (identification.chi2, identification.dof);
    let figures = format!("chi-square {chi2:.1} for {dof:.0} degrees of freedom");
    let explains = Explains::of(identification.p_value);
    let words = explains.words();
    match identification.p_value {
        Some(_) if explains == Explains::No => format!(
            "{figures}: the model does NOT explain the data; the standard deviations hold only if it did"
        ),
        Some(p) if explains == Explains::Hardly => format!("{figures} (p = {p:.4}): {words}"),
        Some(p) if explains == Explains::Yes => format!("{figures} (p = {p:.3}): {words}"),
        _ => format!("{figures}: {words}"),
    }
}
