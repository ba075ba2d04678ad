//! `tautline effects`.

use tautline_core::effect::{CATALOGUE, Scope};

use super::output::say;
use super::table;

/// Lists the effects that `simulate` can hide, and says which of them `identify` can free.
pub fn run() {
    let mut rows = table::texts(&[
        "Effect",
        "title",
        "on",
        "can be freed",
        "parameters (typical size)",
    ]);
    for effect in CATALOGUE {
        let on = match effect.scope() {
            Scope::Cable => "each cable",
            Scope::CableOrAll => "one cable or all",
            Scope::Pair => "two cables",
            Scope::Robot => "the robot",
            Scope::Reading => "one reading",
        };
        let parameter = |p: &tautline_core::effect::EffectParameter| {
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
        };
        let parameters: Vec<_> = effect.parameters().iter().map(parameter).collect();
        let freed = if effect.is_estimable() { "yes" } else { "no" };
        let cells = [
            effect.id(),
            effect.title(),
            on,
            freed,
            &parameters.join(", "),
        ];
        rows.add_row(cells);
    }
    say!("{rows}");
}

/// A typical size without digits that say nothing.
fn short(size: f64) -> String {
    if size.abs() < 1.0 {
        size.to_string()
    } else {
        format!("{:.1}", size).trim_end_matches(".0").to_owned()
    }
}
