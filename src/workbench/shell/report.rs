//! Report dialog: path, heading, certificate, sections.

use std::collections::BTreeSet;

use egui::{Grid, Ui};

use super::{AppState, certificate, save};
use crate::model::command::{DIAGNOSING, IDENTIFYING, Outbox, ReportCommand, ReportDraft};
use crate::model::phase::Screen;
use crate::model::{self, Model};
use crate::theme::GRID;
use crate::widgets::{Entered, Number, UiExt, checkbox, form, modal, number, primary, text_row};
use tautline_workflow::report::{Part, ReportChoice, ReportFormat};

/// Draws the report dialog.
pub fn show(ui: &mut Ui, state: &mut AppState, mut draft: ReportDraft) {
    let format = draft.format;
    let ((), is_left) = modal(ui, "save report", 520.0, |ui| {
        ui.heading(format!("Save the report as {}", format.title()));
        let is_of_session = matches!(state.model.screen, Screen::Phase(_));
        if is_of_session {
            out_of_date(ui, &state.model, &mut state.outbox);
        }
        let asked = save::form(ui, &mut draft.form, None);
        if asked.browse {
            state.outbox.send(ReportCommand::Browse(format));
        }
        let height = (ui.ctx().content_rect().height() - 180.0).max(80.0);
        egui::ScrollArea::vertical()
            .max_height(height)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                head(ui, &mut draft.choice);
                if is_of_session {
                    if let Some(open) = &state.model.open {
                        certificate::form(ui, &mut draft, &open.session().robot);
                    }
                    tolerance(ui, &mut draft.choice);
                    if format != ReportFormat::Dcc {
                        sections(ui, &mut draft.choice);
                    }
                }
            });
        ui.add_space(2.0 * GRID);
        ui.horizontal(|ui| {
            let can_save = draft.form.can_save();
            let is_saved = primary(ui, "Save report", can_save).clicked();
            if let Some(path) = draft
                .form
                .target()
                .filter(|_| is_saved || asked.entered && can_save)
            {
                state.outbox.send(ReportCommand::Save(path));
            }
            if ui.button("Cancel").clicked() {
                state.outbox.send(ReportCommand::Cancel);
            }
        });
    });
    if is_left {
        state.outbox.send(ReportCommand::Cancel);
    }
    let options = &state.views.robot_3d.options;
    draft.pinned = match options.callouts {
        true => options.pinned.clone(),
        false => BTreeSet::new(),
    };
    state.model.dialogs.report = Some(draft);
}

/// Results that are out of date, with buttons that update them.
fn out_of_date(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let mut computing = [IDENTIFYING, DIAGNOSING].into_iter();
    if let Some(title) = computing.find(|title| model.tasks.runs(title)) {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("{title}…"));
        });
        return;
    }
    for part in model::out_of_date(model) {
        ui.doubtful(part.sentence);
        if let Some((name, command)) = part.remedy
            && ui.button(name).clicked()
        {
            outbox.send(command);
        }
    }
}

fn head(ui: &mut Ui, choice: &mut ReportChoice) {
    ui.section("Heading");
    form("head of the report").show(ui, |ui| {
        for (name, text, hint) in [
            ("Title", &mut choice.title, "Name of the session"),
            ("Header line", &mut choice.header, "None"),
            ("Company", &mut choice.company, "None"),
            ("Operator", &mut choice.operator, "None"),
        ] {
            text_row(ui, name, text, hint, 320.0);
        }
    });
}

fn tolerance(ui: &mut Ui, choice: &mut ReportChoice) {
    ui.horizontal(|ui| {
        ui.label("Tolerance of the pulleys");
        let tolerance_mm = choice.tolerance_m.map(|m| 1e3 * m);
        let field = Number::of("Tolerance of the pulleys (mm)", tolerance_mm, 2, "mm", 90.0);
        match number(ui, &field.optional(true)) {
            Some(Entered::Nothing) => choice.tolerance_m = None,
            Some(Entered::Value(mm)) if mm > 0.0 => choice.tolerance_m = Some(1e-3 * mm),
            Some(Entered::Value(_) | Entered::Wrong(_)) | None => {}
        }
        ui.muted("Without one, no verdict is given.");
    });
}

fn sections(ui: &mut Ui, choice: &mut ReportChoice) {
    ui.section("Sections");
    Grid::new("parts of the report")
        .num_columns(2)
        .spacing([6.0 * GRID, GRID])
        .show(ui, |ui| {
            for (k, part) in Part::ALL.iter().enumerate() {
                let mut wanted = !choice.without.contains(part);
                if checkbox(ui, &mut wanted, part.title()).changed() {
                    if wanted {
                        choice.without.remove(part);
                    } else {
                        choice.without.insert(*part);
                    }
                }
                if k % 2 == 1 {
                    ui.end_row();
                }
            }
        });
}
