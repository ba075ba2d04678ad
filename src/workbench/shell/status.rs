//! Status bar: running tasks and the last message.

use egui::{Align, Layout, ProgressBar, RichText, Ui};
use egui_material_icons::icons;
use tautline_link::{Activity, LinkProtection};

use super::state::AppState;
use crate::model::command::{RobotCommand, Setup, ViewCommand};
use crate::model::messages::Severity;
use crate::screens::measuring::controller::lost_words;
use crate::theme;
use crate::widgets::{UiExt, icon_only};
use tautline_workflow::controllers::RobotKind;

pub fn show(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        last_message(ui, state);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            controller(ui, state);
            work(ui, state);
        });
    });
}

fn last_message(ui: &mut Ui, state: &mut AppState) {
    if icon_only(ui, icons::ICON_LIST, "Show the log", true).clicked() {
        state.outbox.send(ViewCommand::Log(true));
    }
    let palette = theme::of(ui);
    // Errors are shown in the alert or in the dialog they concern.
    let last = state.model.messages.last_here();
    let Some(message) = last.filter(|last| last.severity != Severity::Error) else {
        ui.muted("Ready");
        return;
    };
    let (icon, colour) = match message.severity {
        Severity::Info => (icons::ICON_INFO, palette.muted),
        Severity::Warning | Severity::Error => (icons::ICON_WARNING, palette.warning),
    };
    ui.label(icon.rich_text().size(16.0).color(colour));
    let width = ui.available_width() - 320.0;
    ui.scope(|ui| {
        ui.set_max_width(width.max(200.0));
        ui.add(egui::Label::new(&message.text).truncate())
            .on_hover_text(&message.text);
    });
}

/// State of the controller in words.
fn controller(ui: &mut Ui, state: &mut AppState) {
    let live = state.model.link.live();
    let palette = theme::of(ui);
    if let Some(lost) = &live.lost {
        let words = lost_words(lost);
        return chip(ui, state, words.trim_end_matches('.'), palette.bad);
    }
    let Some(controller) = live.state else {
        if state.model.open.is_some() {
            let words = match state.model.link.connecting {
                true => "connecting…",
                false => "not connected",
            };
            chip(ui, state, words, palette.muted);
        }
        return;
    };
    let (words, colour) = match (&controller.activity, controller.armed) {
        (Activity::Fault(_), _) => ("fault", palette.bad),
        (Activity::Moving, _) => ("moving", palette.warning),
        (_, true) => ("armed", palette.warning),
        (_, false) => ("not armed", palette.muted),
    };

    // A recording must never be mistaken for a robot.
    let words = match (state.model.robot_kind(), words) {
        (Some(RobotKind::Recording), _) => "recording, no robot".to_owned(),
        (Some(RobotKind::OfDescription), words) => format!("simulated, {words}"),
        (_, words) => words.to_owned(),
    };
    chip(ui, state, &words, colour);
}

/// Status of the controller. Without a connection it is a button that opens the connection dialog.
fn chip(ui: &mut Ui, state: &mut AppState, words: &str, colour: egui::Color32) {
    let icon = icons::ICON_PRECISION_MANUFACTURING.rich_text();
    if state.model.link.connected.is_some() {
        ui.label(RichText::new(words).small().color(colour));
        let identity = RichText::new(&state.model.link.identity).small();
        ui.add(egui::Label::new(identity).truncate());
        ui.label(icon.size(16.0).color(colour));
        protection(ui, state);
        return;
    }
    let text = RichText::new(words).small().color(colour);
    let button = egui::Button::new((icon.size(16.0).color(colour), text));
    let name = format!("Controller: {words}");
    let response = ui.add(button.frame_when_inactive(false));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if response.on_hover_text("Connect…").clicked() {
        state.outbox.send(RobotCommand::Setup(Setup::Open));
    }
}

/// Icon for the protection of the connection's messages.
fn protection(ui: &mut Ui, state: &AppState) {
    let palette = theme::of(ui);
    let lock = |ui: &mut Ui, icon: egui_material_icons::MaterialIcon, colour, text: &str| {
        let lock = icon.rich_text().size(16.0).color(colour);
        ui.label(lock).on_hover_text(text);
    };
    match &state.model.link.protection {
        None => {}
        Some(LinkProtection::Protected(text)) => lock(ui, icons::ICON_LOCK, palette.muted, text),
        Some(LinkProtection::Open) => {
            let text =
                "Everybody on the network can read and change the messages of this connection";
            let words = RichText::new("not encrypted").small();
            ui.label(words.color(palette.warning));
            lock(ui, icons::ICON_LOCK_OPEN, palette.warning, text);
        }
    }
}

fn work(ui: &mut Ui, state: &mut AppState) {
    let Some(task) = state.model.tasks.running().first() else {
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
