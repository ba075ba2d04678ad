//! Rail of the five phases, on the left.

use egui::{Align, Layout, Rangef, RichText, Sense, Ui, UiBuilder, Vec2};

use super::state::AppState;
use crate::model::command::ViewCommand;
use crate::model::phase::{Phase, PhaseStatus, Screen};
use crate::model::phase_status;
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, row_ground};

/// Width of the rail with icons only, including margins.
pub const NARROW: f32 = 68.0;

/// Height of an entry (points), from a low to a high window.
const ENTRY: Rangef = Rangef {
    min: 9.0 * GRID,
    max: 17.0 * GRID,
};
/// Height (points) from which the number fits below the icon.
const BELOW: f32 = 13.0 * GRID;

/// Draws the rail; with icons only if `narrow`.
pub fn show(ui: &mut Ui, state: &mut AppState, narrow: bool) {
    ui.spacing_mut().item_spacing.y = GRID;
    let count = Phase::ALL.len() as f32;
    let height = ENTRY.clamp((ui.available_height() + GRID) / count - GRID);
    // Text needs the full height.
    let height = if narrow { height } else { ENTRY.max };
    egui::ScrollArea::vertical()
        .id_salt("rail")
        .auto_shrink(false)
        .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden)
        .show(ui, |ui| entries(ui, state, narrow, height));
}

fn entries(ui: &mut Ui, state: &mut AppState, narrow: bool, height: f32) {
    for phase in Phase::ALL {
        let Some(open) = &state.model.open else {
            return;
        };
        let status = phase_status::of(&state.model, open, phase);
        let selected = state.model.screen == Screen::Phase(phase);
        if entry(ui, phase, &status, selected, narrow, height) {
            state.outbox.send(ViewCommand::Go(Screen::Phase(phase)));
        }
    }
}

fn entry(
    ui: &mut Ui,
    phase: Phase,
    status: &PhaseStatus,
    selected: bool,
    narrow: bool,
    height: f32,
) -> bool {
    let palette = theme::of(ui);
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(Vec2::new(width, height), Sense::click());
    let title = format!("{}. {}", phase.number(), phase.title());
    let name = format!("Phase {}: {}", phase.number(), phase.title());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, selected, &name));
    row_ground(ui, &response, 4.0, selected);
    if selected {
        let edge = rect.with_max_x(rect.min.x + 3.0);
        ui.painter().rect_filled(edge, 1.0, palette.accent);
    }
    let margin = if height < ENTRY.max { GRID } else { 2.0 * GRID };
    let inside = rect.shrink2(Vec2::new(2.0 * GRID, margin));
    let builder = UiBuilder::new()
        .max_rect(inside)
        .layout(Layout::top_down(Align::Min));
    let mut inner = ui.new_child(builder);
    if narrow {
        icon(&mut inner, phase, status, height < BELOW);
    } else {
        words(&mut inner, &title, status);
    }
    response
        .on_hover_text(format!(
            "{title}\n{}: {}",
            status.progress.words(),
            status.line
        ))
        .clicked()
}

fn words(ui: &mut Ui, title: &str, status: &PhaseStatus) {
    let palette = theme::of(ui);
    ui.spacing_mut().item_spacing = Vec2::new(1.5 * GRID, 0.5 * GRID);
    ui.horizontal(|ui| {
        let icon = status.progress.icon().rich_text().size(16.0);
        ui.label(icon.color(palette.progress(status.progress)));
        ui.label(RichText::new(title).font(theme::strong(13.0)));
    });
    let line = RichText::new(&status.line).small().color(palette.muted);
    ui.wrapped(line);
}

fn icon(ui: &mut Ui, phase: Phase, status: &PhaseStatus, is_low: bool) {
    let colour = theme::of(ui).progress(status.progress);
    let parts = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing = Vec2::splat(0.5 * GRID);
        ui.label(status.progress.icon().rich_text().size(18.0).color(colour));
        ui.label(RichText::new(phase.number().to_string()).font(theme::strong(13.0)));
    };
    match is_low {
        true => ui.horizontal_centered(parts).inner,
        false => ui.vertical_centered(parts).inner,
    }
}
