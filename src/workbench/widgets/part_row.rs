//! A row for a part of a phase: how far it is, its name, one line of result; a click opens it.

use egui::{Align, Label, Layout, RichText, Role, Sense, Ui, UiBuilder, Vec2, WidgetInfo};

use crate::app::screen::Standing;
use crate::app::theme::{self, GRID};

/// Draws the row; says whether it was clicked.
pub fn part_row(ui: &mut Ui, title: &str, standing: &Standing, selected: bool) -> bool {
    let palette = theme::of(ui);
    let size = Vec2::new(ui.available_width(), 8.0 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Tab, true, selected, title));
    let fill = if selected {
        palette.raised
    } else if response.hovered() || response.has_focus() {
        palette.hovered.gamma_multiply(0.5)
    } else {
        egui::Color32::TRANSPARENT
    };
    ui.painter().rect_filled(rect, 4.0, fill);
    let inside = rect.shrink2(Vec2::new(2.0 * GRID, GRID));
    let layout = Layout::left_to_right(Align::Center);
    let builder = UiBuilder::new().max_rect(inside).layout(layout);
    let mut row = ui.new_child(builder);
    let colour = palette.progress(standing.progress);
    row.label(
        standing
            .progress
            .icon()
            .rich_text()
            .size(16.0)
            .color(colour),
    );
    row.label(RichText::new(title).font(theme::strong(13.0)));
    row.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let line = RichText::new(&standing.line).small().color(palette.muted);
        ui.add(Label::new(line).truncate());
    });
    response
        .on_hover_text(format!("{}: {}", standing.progress.words(), standing.line))
        .clicked()
}
