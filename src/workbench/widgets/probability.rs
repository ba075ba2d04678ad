//! A probability as a bar with its words.

use egui::{Rect, Response, Role, Sense, Ui, WidgetInfo, vec2};
use tautline_core::diagnosis::NAMING_PROBABILITY;
use tautline_workflow::wording::probability::certainty;
use tautline_workflow::wording::sentence;

use crate::theme::{self, GRID};

/// Draws the probability of `what`: a bar from 0 to 1, marked at 0.95 from where a cause is named, and the words below,
/// which are returned.
pub fn probability(ui: &mut Ui, what: &str, probability: f64) -> Response {
    ui.add_space(0.5 * GRID);
    let palette = theme::of(ui);
    let size = vec2(ui.available_width(), 1.5 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let words = certainty(probability);
    let name = format!("Probability of {what}: {words}");
    response.widget_info(|| WidgetInfo::labeled(Role::Meter, true, &name));
    let part = |share: f64| {
        let width = rect.width() * share.clamp(0.0, 1.0) as f32;
        Rect::from_min_size(rect.min, vec2(width, rect.height()))
    };
    let colour = if probability >= NAMING_PROBABILITY {
        palette.good
    } else {
        palette.warning
    };
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, palette.line);
    painter.rect_filled(part(probability), 3.0, colour);
    let mark = part(NAMING_PROBABILITY).right();
    let line = egui::Stroke::new(1.0, palette.text);
    painter.vline(mark, rect.y_range(), line);
    response.on_hover_text(format!(
        "{name}. The mark is at 95 %, from where a cause is named."
    ));
    ui.add(egui::Label::new(sentence(&words)).wrap())
}
