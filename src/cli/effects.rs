//! `tautline effects`.

use tautline_core::effect::{Effect, EffectParameter, Scope, Search, every_effect};

use super::output::say;
use super::table;

/// Lists the effects that `simulate` can hide, whether `identify` can estimate them, and how `diagnose` searches for them.
pub fn run() {
    let mut rows = table::texts(&[
        "Effect",
        "title",
        "on",
        "can be estimated",
        "diagnose tests it",
        "parameters (typical size)",
        "typical tolerance",
    ]);
    for effect in every_effect() {
        let parameters: Vec<_> = effect.parameters().iter().map(parameter).collect();
        let freed = if effect.is_estimable() { "yes" } else { "no" };
        let cells = [
            effect.id(),
            effect.title(),
            on(effect),
            freed,
            tried(effect),
            &parameters.join(", "),
            &tolerance(effect),
        ];
        rows.add_row(cells);
    }
    say!("{rows}");
}

fn on(effect: &Effect) -> &'static str {
    match effect.scope() {
        Scope::Cable => "each cable",
        Scope::CableOrAll => "one cable or all",
        Scope::Pair => "two cables",
        Scope::Robot => "the robot",
    }
}

fn tried(effect: &Effect) -> &'static str {
    match effect.search() {
        Search::Direct => "always",
        Search::Wave { period: None, .. } => "at any phase",
        Search::Wave { .. } => "at any phase and period",
        Search::FromPose(_) => "from every pose on",
        Search::AtPose(_) => "at every pose",
        Search::Exchange => "if residuals are huge",
    }
}

fn parameter(p: &EffectParameter) -> String {
    if p.discrete {
        return format!("{} (given)", p.name);
    }
    let [least, most] = p.typical.map(short);
    let unit = if p.unit == "1" {
        String::new()
    } else {
        format!(" {}", p.unit)
    };
    format!("{} ({least} to {most}{unit})", p.name)
}

/// By how much sound parts deviate, on small machines and on large ones if they differ.
fn tolerance(effect: &Effect) -> String {
    let mut stated = effect.parameters().iter();
    let stated = stated.find_map(|p| p.tolerance.map(|typical| (p.unit, typical)));
    let Some((unit, typical)) = stated else {
        return String::new();
    };
    let unit = match unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let [small, large] = [typical.small, typical.large].map(short);
    match small == large {
        true => format!("{small}{unit}"),
        false => format!("{small}{unit}, large machine {large}{unit}"),
    }
}

/// A typical size without insignificant digits.
fn short(size: f64) -> String {
    if size.abs() < 1.0 {
        size.to_string()
    } else {
        format!("{:.1}", size).trim_end_matches(".0").to_owned()
    }
}
