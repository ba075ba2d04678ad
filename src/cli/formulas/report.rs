//! Human-readable form of formulas.

use tautline_workflow::formulas::FormulasDocument;

use crate::output::say;
use crate::table;

/// Prints the unexplained error, and the patterns that it resembles.
pub fn print(document: &FormulasDocument) {
    if document.unexplained.is_empty() {
        say!("Nothing is unexplained: there is no error that formulas could describe.");
        return;
    }
    for sentence in &document.unexplained {
        say!("{sentence}");
    }
    if document.patterns.is_empty() {
        say!("No pattern of the readings describes it.");
        return;
    }
    say!(
        "It looks like one of these patterns. None of them is a cause: what depends on these quantities?"
    );
    table::rows(&document.patterns).print(&[
        ("Pattern", &|one| one.title()),
        ("probability", &|one| {
            format!("{:.0} %", 100.0 * one.probability)
        }),
        ("size", &|one| one.sizes()),
        ("held-out residuals", &|one| {
            one.held_out().unwrap_or_default()
        }),
    ]);
    say!(
        "Probabilities hold if one of the patterns is true. With -o FILE.toml the likeliest becomes a hypothesis file."
    );
}
