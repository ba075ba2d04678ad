//! Footer of a phase: its state, the next step, and the one after it.

use egui::{Align, Button, Layout, ProgressBar, RichText, Role, Ui, WidgetInfo, vec2};

use crate::model::command::Outbox;
use crate::model::next_step::{Action, KEYS, NextStep};
use crate::theme::{self, GRID};
use crate::widgets::UiExt;

pub fn show(ui: &mut Ui, step: NextStep, outbox: &mut Outbox) {
    let palette = theme::of(ui);
    ui.spacing_mut().item_spacing.y = 1.5 * GRID;
    ui.horizontal_top(|ui| {
        let icon = step.progress.icon().rich_text().size(16.0);
        ui.label(icon.color(palette.progress(step.progress)));
        ui.wrapped(full_stop(&step.done));
    });
    if let Some(share) = step.share {
        ui.add(ProgressBar::new(share).desired_height(1.5 * GRID));
    }
    if let Some(action) = step.action {
        button(ui, action, outbox);
    }
    if !step.then.is_empty() {
        let then = RichText::new(&step.then).small().color(palette.muted);
        ui.wrapped(then);
    }
}

/// Button of the next step, at the same place in every phase.
fn button(ui: &mut Ui, action: Action, outbox: &mut Outbox) {
    let palette = theme::of(ui);
    let label = RichText::new(&action.title)
        .font(theme::strong(14.0))
        .color(palette.on_accent);
    let size = vec2(ui.available_width(), 8.0 * GRID);
    let button = Button::new(label).fill(palette.accent).truncate();
    let layout = Layout::centered_and_justified(ui.layout().main_dir());
    let response = ui
        .allocate_ui_with_layout(size, layout.with_cross_align(Align::Center), |ui| {
            ui.add(button)
        })
        .inner;
    let name = format!("Next: {}", action.title);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    let keys = ui.ctx().format_shortcut(&KEYS);
    let hint = format!("{} ({keys})", action.title);
    if response.on_hover_text(hint).clicked() {
        for command in action.commands {
            outbox.send(command);
        }
    }
}

fn full_stop(text: &str) -> String {
    match text.ends_with(['.', '?', '…']) {
        true => text.to_owned(),
        false => format!("{text}."),
    }
}
