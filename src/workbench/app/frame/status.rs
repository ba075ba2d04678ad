//! The bar at the bottom: running work and the last message.

use egui::{Align, Layout, ProgressBar, RichText, Ui};
use egui_material_icons::icons;
use tautline_link::Activity;

use crate::app::commands::{RobotCommand, ViewCommand};
use crate::app::messages::Severity;
use crate::app::state::State;
use crate::app::theme;
use crate::widgets::{icon_only, muted};

/// Draws the bar.
pub fn show(ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        last_message(ui, state);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            controller(ui, state);
            work(ui, state);
        });
    });
}

fn last_message(ui: &mut Ui, state: &mut State) {
    if icon_only(ui, icons::ICON_LIST, "Show the log", true).clicked() {
        state.outbox.send(ViewCommand::Log(true));
    }
    let palette = theme::of(ui);
    let Some(message) = state.messages.last() else {
        muted(ui, "Ready");
        return;
    };
    let (icon, colour) = match message.severity {
        Severity::Info => (icons::ICON_INFO, palette.muted),
        Severity::Warning => (icons::ICON_WARNING, palette.warning),
        Severity::Error => (icons::ICON_ERROR, palette.bad),
    };
    ui.label(icon.rich_text().size(16.0).color(colour));
    let width = ui.available_width() - 320.0;
    ui.scope(|ui| {
        ui.set_max_width(width.max(200.0));
        ui.add(egui::Label::new(&message.text).truncate())
            .on_hover_text(&message.text);
    });
}

/// The controller in words; a robot that moves can be stopped from everywhere.
fn controller(ui: &mut Ui, state: &mut State) {
    let Some(controller) = state.link.live().state else {
        return;
    };
    let palette = theme::of(ui);
    let moving = controller.activity == Activity::Moving;
    if (moving || state.link.is_busy())
        && icon_only(ui, icons::ICON_STOP_CIRCLE, "Stop the robot", true).clicked()
    {
        state.outbox.send(RobotCommand::Stop);
    }
    let (words, colour) = match (&controller.activity, controller.armed) {
        (Activity::Fault(_), _) => ("fault", palette.bad),
        (Activity::Moving, _) => ("moving", palette.warning),
        (_, true) => ("armed", palette.warning),
        (_, false) => ("not armed", palette.muted),
    };
    ui.label(RichText::new(words).small().color(colour));
    ui.label(RichText::new(&state.link.identity).small());
    let icon = icons::ICON_PRECISION_MANUFACTURING.rich_text();
    ui.label(icon.size(16.0).color(colour));
}

fn work(ui: &mut Ui, state: &mut State) {
    let Some(task) = state.tasks.running().first() else {
        return;
    };
    let progress = task.progress();
    if icon_only(
        ui,
        icons::ICON_CLOSE,
        &format!("Cancel: {}", task.title),
        true,
    )
    .clicked()
    {
        task.cancel();
    }
    match progress.fraction {
        Some(fraction) => {
            ui.add(ProgressBar::new(fraction).desired_width(120.0));
        }
        None => {
            ui.spinner();
        }
    }
    let text = if progress.text.is_empty() {
        task.title.clone()
    } else {
        format!("{}: {}", task.title, progress.text)
    };
    ui.add(egui::Label::new(RichText::new(text).small()).truncate());
}
