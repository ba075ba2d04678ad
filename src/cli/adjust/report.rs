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
        let mut lines = table::numbers(&[
            "Parameter",
            "unit",
            "controller",
            "identified",
            "difference",
            "sd",
        ]);
        for row in &rows {
            let (scale, unit) = display_unit(&row.unit);
            let number = |value: Option<f64>| {
                value.map_or_else(|| "-".to_owned(), |v| format!("{:.4}", v * scale))
            };
            let cells = [
                row.name.clone(),
                unit.to_owned(),
                row.not_a_number
                    .clone()
                    .unwrap_or_else(|| number(row.controller)),
                match row.in_model {
                    true => number(row.identified),
                    false => format!("none: {}", number(row.identified)),
                },
                number(row.difference),
                number(row.sd),
            ];
            table::push(&mut lines, &cells);
        }
        say!("{lines}");
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
