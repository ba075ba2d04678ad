//! Human-readable form of formulas.

use tautline_workflow::formulas::{FormulasDocument, PatternDocument};
use tautline_workflow::wording::list;
use tautline_workflow::wording::units::with_sd;

use crate::output::say;
use crate::table;

/// Prints what is unexplained, and the patterns that it looks like.
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
    let mut rows = table::numbers(&["Pattern", "probability", "size", "held-out residuals"]);
    for pattern in &document.patterns {
        table::push(
            &mut rows,
            &[
                pattern_name(pattern),
                format!("{:.0} %", 100.0 * pattern.probability),
                sizes(pattern),
                gain(pattern),
            ],
        );
    }
    say!("{rows}");
    say!(
        "Probabilities hold if one of the patterns is true. With -o FILE.toml the likeliest becomes a hypothesis file."
    );
}

fn pattern_name(pattern: &PatternDocument) -> String {
    match pattern.targets.as_slice() {
        [] => pattern.expression.clone(),
        targets => format!("{} ({})", pattern.expression, list(targets)),
    }
}

fn sizes(pattern: &PatternDocument) -> String {
    let sizes = pattern.parameters.iter().map(|parameter| {
        with_sd(
            parameter.value,
            parameter.sd.unwrap_or(f64::NAN),
            &parameter.unit,
        )
    });
    sizes.collect::<Vec<_>>().join(", ")
}

/// `1.08 instead of 4.87`, in standard deviations.
fn gain(pattern: &PatternDocument) -> String {
    let gain = pattern.gain.as_ref();
    let both = gain.and_then(|gain| gain.holdout_after.zip(gain.holdout_before));
    both.map_or_else(String::new, |(after, before)| {
        format!("{after:.2} instead of {before:.2}")
    })
}
