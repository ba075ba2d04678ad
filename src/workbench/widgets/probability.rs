//! Probability as a bar with text.

use egui::{Response, Ui};
use tautline_core::diagnosis::NAMING_PROBABILITY;
use tautline_workflow::wording::probability::certainty;
use tautline_workflow::wording::sentence;

use super::{UiExt, meter};
use crate::theme::{self, GRID};

/// Draws the probability of `what`: a bar from 0 to 1, marked at 0.95, above which a cause is named, and a text below,
/// which is returned.
pub fn probability(ui: &mut Ui, what: &str, probability: f64) -> Response {
    ui.add_space(0.5 * GRID);
    let palette = theme::of(ui);
    let words = certainty(probability);
    let name = format!("Probability of {what}: {words}");
    let colour = if probability >= NAMING_PROBABILITY {
        palette.good
    } else {
        palette.warning
    };
    let bar = meter(ui, &name, probability, colour, Some(NAMING_PROBABILITY));
    bar.on_hover_text(format!(
        "{name}. The mark is at 95 %, from where a cause is named."
    ));
    ui.wrapped(sentence(&words))
}
