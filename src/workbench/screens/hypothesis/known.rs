//! Hypotheses of the session and effects of the catalogue, as a basis for a new one.

use egui::{ScrollArea, Ui};
use egui_material_icons::icons;
use tautline_core::effect::{Hypothesis, every_effect};

use crate::model::Model;
use crate::model::command::{HypothesisCommand, Outbox};
use crate::theme::GRID;
use crate::widgets::{UiExt, icon_only};

pub(super) fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let session = model.open.as_ref().map(|open| open.session());
    let texts = session.map_or(&[][..], |session| &session.robot.hypotheses);
    if !texts.is_empty() {
        ui.menu_button("In the session", |ui| of_session(ui, texts, outbox));
    }
    ui.menu_button("Start from an effect", |ui| {
        ScrollArea::vertical()
            .max_height(420.0)
            .show(ui, |ui| of_catalogue(ui, model, outbox));
    });
}

fn of_session(ui: &mut Ui, texts: &[String], outbox: &mut Outbox) {
    for hypothesis in texts.iter().filter_map(|text| Hypothesis::parse(text).ok()) {
        ui.horizontal(|ui| {
            if ui.button(hypothesis.title()).clicked() {
                outbox.send(HypothesisCommand::Begin(hypothesis.text().to_owned()));
                ui.close();
            }
            let name = format!("Take {} out of the session", hypothesis.title());
            if icon_only(ui, icons::ICON_DELETE, &name, true).clicked() {
                outbox.send(HypothesisCommand::Remove(hypothesis.id().to_owned()));
                ui.close();
            }
        });
    }
}

fn of_catalogue(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let Some((robot, _)) = model.robot_of_effects() else {
        return;
    };
    ui.muted("Begin with the formulas of an effect:");
    ui.add_space(GRID);
    for effect in every_effect() {
        // Not every effect can be written as text.
        let Ok(text) = effect.as_text(&robot) else {
            continue;
        };
        if ui.button(effect.title()).clicked() {
            outbox.send(HypothesisCommand::Begin(text));
            ui.close();
        }
    }
}
