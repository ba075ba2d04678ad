//! Editor of a hypothesis, with its effect on the residuals while it is typed.

mod editor;
mod known;
mod preview;

use egui::{Align, Label, Layout, Rangef, RichText, Ui};
use egui_material_icons::icons;

use crate::model::Model;
use crate::model::command::{HypothesisCommand, Outbox, ViewCommand};
use crate::model::hypothesis::HypothesisDraft;
use crate::model::phase::Screen;
use crate::theme::{self, GRID};
use crate::widgets::{icon_button, primary};

/// Width of the screen (points) below which the residuals are below the text.
const NARROW: f32 = 860.0;
/// Share of the text in a wide screen, and its limits (points).
const TEXT: f32 = 0.52;
const TEXT_RANGE: Rangef = Rangef {
    min: 420.0,
    max: 720.0,
};

pub fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let Some(draft) = &model.hypothesis.draft else {
        outbox.send(HypothesisCommand::Show);
        return;
    };
    let inputs = model.open.as_ref().map(|open| open.inputs());
    if draft.lacks_preview(inputs) {
        outbox.send(HypothesisCommand::Try);
    }
    egui::Frame::new().inner_margin(4.0 * GRID).show(ui, |ui| {
        head(ui, model, draft, outbox);
        ui.add_space(GRID);
        actions(ui, model, draft, outbox);
        ui.add_space(2.0 * GRID);
        if ui.available_width() < NARROW {
            egui::ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| {
                    editor::show(ui, draft, 320.0, outbox);
                    ui.add_space(2.0 * GRID);
                    preview::show(ui, model, draft, outbox);
                });
            return;
        }
        ui.horizontal_top(|ui| {
            let height = ui.available_height();
            let width = TEXT_RANGE.clamp(TEXT * ui.available_width());
            ui.vertical(|ui| {
                ui.set_width(width);
                editor::show(ui, draft, height, outbox);
            });
            ui.add_space(4.0 * GRID);
            ui.vertical(|ui| {
                egui::ScrollArea::vertical()
                    .id_salt("what it does")
                    .auto_shrink(false)
                    .show(ui, |ui| preview::show(ui, model, draft, outbox));
            });
        });
    });
}

fn head(ui: &mut Ui, model: &Model, draft: &HypothesisDraft, outbox: &mut Outbox) {
    let name = draft.checked().map(|hypothesis| hypothesis.title());
    let state = if draft.is_unsaved() {
        ", not saved"
    } else {
        ""
    };
    let name = format!("{}{state}", name.unwrap_or("with a mistake"));
    ui.horizontal(|ui| {
        // Buttons are placed first; the name gets the remaining width.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, icons::ICON_ARROW_BACK, "Back", true).clicked() {
                outbox.send(ViewCommand::Go(model.previous_screen()));
            }
            if icon_button(ui, icons::ICON_GRID_VIEW, "Gallery of effects", true).clicked() {
                outbox.send(ViewCommand::Go(Screen::Gallery));
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.heading("Hypothesis");
                let name = RichText::new(name).color(theme::of(ui).muted);
                ui.add(Label::new(name).truncate());
            });
        });
    });
}

fn actions(ui: &mut Ui, model: &Model, draft: &HypothesisDraft, outbox: &mut Outbox) {
    let is_right = draft.checked().is_ok();
    let session = model.open.as_ref().map(|open| open.session());
    let is_measured = model.measured().is_some();
    let is_in_session = session.is_some_and(|session| {
        let mut texts = session.robot.hypotheses.iter();
        texts.any(|text| text == draft.text())
    });
    ui.horizontal_wrapped(|ui| {
        let ask = primary(ui, "Ask the doctor", is_right && is_measured);
        let ask = ask.on_hover_text(
            "Puts the hypothesis into the session and weighs it against the catalogue",
        );
        let why = match is_measured {
            true => "Correct the text first",
            false => "Open a session with measured poses first",
        };
        if ask.on_disabled_hover_text(why).clicked() {
            outbox.send(HypothesisCommand::AskDoctor);
        }
        let can_save = is_right && session.is_some() && !is_in_session;
        let name = match is_in_session {
            true => "In the session",
            false => "Save into the session",
        };
        if icon_button(ui, icons::ICON_SAVE, name, can_save).clicked() {
            outbox.send(HypothesisCommand::SaveInSession);
        }
        if icon_button(ui, icons::ICON_DOWNLOAD, "Save as file…", true).clicked() {
            outbox.send(HypothesisCommand::AskSave);
        }
        if icon_button(ui, icons::ICON_CONTENT_COPY, "Copy", true).clicked() {
            ui.ctx().copy_text(draft.text().to_owned());
        }
        ui.separator();
        if icon_button(ui, icons::ICON_ADD, "New", true).clicked() {
            outbox.send(HypothesisCommand::New);
        }
        if icon_button(ui, icons::ICON_FOLDER_OPEN, "Open…", true).clicked() {
            outbox.send(HypothesisCommand::AskOpen);
        }
        known::show(ui, model, outbox);
    });
}
