//! Effect of the hypothesis on the residuals.

use egui::{CollapsingHeader, ComboBox, RichText, Ui};
use tautline_core::effect::{FORMULA_QUANTITIES, formula_functions};
use tautline_workflow::plot::Selection;
use tautline_workflow::signature::{Image, Placement, Signature, Trial};

use crate::model::Model;
use crate::model::command::PreviewResult;
use crate::model::command::{HypothesisCommand, Outbox, TRYING, ViewCommand};
use crate::model::hypothesis::HypothesisDraft;
use crate::theme::GRID;
use crate::views::plots::small;
use crate::widgets::UiExt;

/// Height of a plot (points).
const PLOT: f32 = 190.0;

pub(super) fn show(ui: &mut Ui, model: &Model, draft: &HypothesisDraft, outbox: &mut Outbox) {
    vocabulary(ui, draft.checked().is_err());
    ui.section("What it does to the residuals");
    let inputs = model.open.as_ref().map(|open| open.inputs());
    if draft.checked().is_err() {
        ui.muted("Appears here once the text has no error.");
        return;
    }
    let is_fitting = model.tasks.runs(TRYING) || draft.lacks_preview(inputs);
    if is_fitting {
        ui.busy("Fitting it to the readings…");
    }
    // The last preview stays, dimmed, until the next one is ready, so that the layout is stable while typing.
    ui.scope(|ui| {
        if is_fitting {
            ui.set_opacity(0.4);
        }
        match draft.preview.as_ref().map(|preview| &preview.result) {
            None => {}
            Some(Err(why)) => ui.doubtful(why),
            Some(Ok(PreviewResult::Measured(trial))) => measured(ui, model, draft, trial, outbox),
            Some(Ok(PreviewResult::Simulated(signature))) => {
                simulated(ui, model, signature, outbox);
            }
        }
    });
}

/// Quantities and functions for formulas; expanded while there is no preview.
fn vocabulary(ui: &mut Ui, is_open: bool) {
    let header = CollapsingHeader::new("Quantities and functions").default_open(is_open);
    header.show(ui, |ui| {
        for quantity in FORMULA_QUANTITIES {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(quantity.name).monospace());
                let unit = match quantity.unit {
                    "1" => String::new(),
                    unit => format!(" ({unit})"),
                };
                ui.muted(&format!("{}{unit}", quantity.meaning));
            });
        }
        ui.muted("Quantities of a cable exist for other cables too, as in paid_of(next).");
        let functions: Vec<&str> = formula_functions().collect();
        ui.wrapped(RichText::new(functions.join(", ")).monospace());
    });
}

fn measured(
    ui: &mut Ui,
    model: &Model,
    draft: &HypothesisDraft,
    trial: &Trial,
    outbox: &mut Outbox,
) {
    let Some(placement) = trial
        .placements
        .get(draft.placement)
        .or(trial.placements.first())
    else {
        return;
    };
    let name = |index: usize, placement: &Placement| match index {
        0 => format!("{}, where it fits best", placement.target),
        _ => placement.target.clone(),
    };
    if trial.placements.len() > 1 {
        ui.horizontal(|ui| {
            let label = ui.label("On");
            let shown = draft.placement.min(trial.placements.len() - 1);
            ComboBox::from_id_salt("target")
                .selected_text(name(shown, placement))
                .width(240.0)
                .show_ui(ui, |ui| {
                    for (index, one) in trial.placements.iter().enumerate() {
                        let chosen = ui.selectable_label(index == shown, name(index, one));
                        if chosen.clicked() {
                            outbox.send(HypothesisCommand::ChoosePlacement(index));
                        }
                    }
                })
                .response
                .labelled_by(label.id);
        });
    }
    ui.wrapped(format!("Size on {}: {}", placement.target, placement.size));
    ui.wrapped(placement.sentence());
    ui.muted("Filled marks are the residuals without it, circles the part that it explains. Another cause may explain them better: ask the doctor.");
    images(ui, &placement.images, model.selection, outbox);
}

fn simulated(ui: &mut Ui, model: &Model, signature: &Signature, outbox: &mut Outbox) {
    ui.wrapped(&signature.cause);
    ui.muted("Nothing is measured yet: this is what it would leave in the residuals at a typical size, without noise.");
    match &signature.images {
        Ok(all) => images(ui, all, model.selection, outbox),
        Err(why) => ui.neutral(why),
    }
}

fn images(ui: &mut Ui, images: &[Image], selection: Selection, outbox: &mut Outbox) {
    for image in images {
        ui.add_space(2.0 * GRID);
        ui.muted(&image.name);
        let name = format!("Residuals: {}", image.name);
        if let Some(chosen) = small::show(ui, &name, &image.figure, PLOT, selection) {
            outbox.send(ViewCommand::Select(chosen));
        }
    }
}
