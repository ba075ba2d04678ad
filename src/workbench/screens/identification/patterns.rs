//! Patterns of an error without a known cause, and their addition to the model.

use egui::Ui;
use egui_material_icons::icons;
use tautline_workflow::formulas::PatternDocument;

use super::Panel;
use crate::model::command::{FORMULAS, HypothesisCommand, IdentificationCommand};
use crate::model::findings;
use crate::theme::GRID;
use crate::widgets::{UiExt, icon_button, named, probability};

/// Button that starts the search, and the patterns found.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    ui.add_space(GRID);
    if panel.model.tasks.runs(FORMULAS) {
        ui.busy("Trying patterns…");
        return;
    }
    let inputs = panel.open.inputs();
    let found = panel.model.identification.patterns.as_ref();
    match found.filter(|(of, _)| *of == inputs) {
        None => {
            let title = "What does it look like?";
            let button = icon_button(ui, icons::ICON_FUNCTION, title, true);
            if button
                .on_hover_text("Weighs formulas of position, tension, time and other quantities beside the catalogue")
                .clicked()
            {
                panel.outbox.send(IdentificationCommand::FindFormulas);
            }
        }
        Some((_, Err(error))) => ui.bad(error),
        Some((_, Ok(patterns))) if patterns.is_empty() => {
            ui.muted("No pattern of the quantities at hand describes it.");
        }
        Some((_, Ok(patterns))) => {
            ui.muted("It looks like one of these patterns. None of them is a cause: what depends on these quantities?");
            for pattern in patterns {
                one(ui, panel, pattern);
            }
        }
    }
}

fn one(ui: &mut Ui, panel: &mut Panel<'_>, pattern: &PatternDocument) {
    let name = pattern.title();
    ui.add_space(GRID);
    ui.wrapped(&name);
    probability(ui, &name, pattern.probability);
    let sizes = pattern.sizes();
    if !sizes.is_empty() {
        ui.muted(&format!("Size: {sizes}"));
    }
    if let Some(residuals) = pattern.held_out() {
        ui.muted(&format!(
            "At poses held out of the fit, residuals are {residuals} times the expected noise."
        ));
    }
    let edit = ui.button("Edit as a hypothesis");
    if named(edit, &format!("Edit {name} as a hypothesis")).clicked() {
        panel
            .outbox
            .send(HypothesisCommand::Begin(pattern.hypothesis.clone()));
    }
    let extend = ui.button("Extend the model by this pattern");
    if named(extend, &format!("Extend the model by {name}")).clicked() {
        panel.outbox.send(findings::extending(pattern));
    }
}
