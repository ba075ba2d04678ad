//! An adjustment as text.

use tautline_workflow::adjusting::{AdjustmentDocument, DifferenceRow};
use tautline_workflow::wording::units::display_unit;

use crate::output::say;
use crate::table;

/// Prints the document.
pub fn print(document: &AdjustmentDocument) {
    let is_shown = |row: &&DifferenceRow| row.changes || row.sd.is_some();
    let rows: Vec<&DifferenceRow> = document.differences.iter().filter(is_shown).collect();
    if !document.differences.is_empty() {
        let number = |row: &DifferenceRow, value: Option<f64>| {
            let (scale, _) = display_unit(&row.unit);
            value.map_or_else(|| "-".to_owned(), |v| format!("{:.4}", v * scale))
        };
        table::rows(&rows).print(&[
            ("Parameter", &|row| row.name.clone()),
            ("unit", &|row| display_unit(&row.unit).1.to_owned()),
            ("controller", &|row| {
                let odd = row.not_a_number.clone();
                odd.unwrap_or_else(|| number(row, row.controller))
            }),
            ("identified", &|row| match row.in_model {
                true => number(row, row.identified),
                false => format!("none: {}", number(row, row.identified)),
            }),
            ("difference", &|row| number(row, row.difference)),
            ("sd", &|row| number(row, row.sd)),
            ("gain mm", &|row| {
                let gain_m = row.gain_m;
                gain_m.map_or_else(|| "-".to_owned(), |gain_m| format!("{:.2}", 1e3 * gain_m))
            }),
        ]);
        let same = document.differences.len() - rows.len();
        say!("{same} other parameters are unchanged");
    }
    let text = document
        .text
        .as_deref()
        .unwrap_or(match document.outcome.as_str() {
            "nothing_to_write" => "The controller already holds the identified values.",
            _ => "Nothing was written.",
        });
    say!("{}: {text}", document.controller);
}
