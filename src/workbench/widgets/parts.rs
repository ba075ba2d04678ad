//! Parts of a phase as rows with progress, title and one line of result; a click opens a part.

use egui::{Align, Label, Layout, RichText, Role, Sense, Ui, UiBuilder, Vec2, WidgetInfo};

use super::row_ground;
use crate::model::phase::PhaseStatus;
use crate::theme::{self, GRID};

/// Draws the parts as rows; a click chooses one.
pub fn parts<P: Copy + PartialEq, const N: usize>(
    ui: &mut Ui,
    parts: [(P, &str, PhaseStatus); N],
    chosen: &mut P,
) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.5 * GRID;
        for (part, title, standing) in parts {
            if row(ui, title, &standing, *chosen == part) {
                *chosen = part;
            }
        }
    });
    ui.add_space(2.0 * GRID);
}

/// Draws a row; returns whether it was clicked.
fn row(ui: &mut Ui, title: &str, standing: &PhaseStatus, selected: bool) -> bool {
    let palette = theme::of(ui);
    let size = Vec2::new(ui.available_width(), 8.0 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Tab, true, selected, title));
    row_ground(ui, &response, 4.0, selected);
    let inside = rect.shrink2(Vec2::new(2.0 * GRID, GRID));
    let layout = Layout::left_to_right(Align::Center);
    let builder = UiBuilder::new().max_rect(inside).layout(layout);
    let mut line = ui.new_child(builder);
    let colour = palette.progress(standing.progress);
    let icon = standing.progress.icon().rich_text().size(16.0);
    line.label(icon.color(colour));
    line.label(RichText::new(title).font(theme::strong(13.0)));
    line.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let line = RichText::new(&standing.line).small().color(palette.muted);
        ui.add(Label::new(line).truncate());
    });
    response
        .on_hover_text(format!("{}: {}", standing.progress.words(), standing.line))
        .clicked()
}
