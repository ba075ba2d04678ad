//! Bar of a share.

use egui::{Color32, Rect, Response, Role, Sense, Ui, WidgetInfo, vec2};

use crate::theme::{self, GRID};

/// Draws a share from 0 to 1 as a bar over the full width, with a mark at `mark`; `name` is its accessible name.
pub fn meter(ui: &mut Ui, name: &str, share: f64, colour: Color32, mark: Option<f64>) -> Response {
    let palette = theme::of(ui);
    let size = vec2(ui.available_width(), 1.5 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Meter, true, name));
    let part = |share: f64| {
        let width = rect.width() * share.clamp(0.0, 1.0) as f32;
        Rect::from_min_size(rect.min, vec2(width, rect.height()))
    };
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, palette.line);
    painter.rect_filled(part(share), 3.0, colour);
    if let Some(mark) = mark {
        let line = egui::Stroke::new(1.0, palette.text);
        painter.vline(part(mark).right(), rect.y_range(), line);
    }
    response
}
