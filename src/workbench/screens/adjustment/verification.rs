//! Verification with an external instrument, before and after the adjustment.

use egui::Ui;
use egui_material_icons::icons;
use tautline_session::Stage;

use super::typed;
use super::{Figures, PanelState};
use crate::model::command::{Export, FileCommand, Outbox, RobotCommand};
use crate::model::link::RunStep;
use crate::model::{Model, OpenSession};
use crate::screens::measuring::motion;
use crate::theme::{self, GRID};
use crate::views::plots::small;
use crate::widgets::{Cell, TableColumn, UiExt, Verdict, icon_button, table};
use tautline_workflow::accuracy::{
    Figure, before_and_after, plot_of_errors, predicted_m, result_in_words,
};
use tautline_workflow::adjusting;
use tautline_workflow::controllers::RobotKind;
use tautline_workflow::plot::Selection;
use tautline_workflow::wording::units::fixed;

/// Draws buttons, progress and the table of both runs.
pub(super) fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.section("Verification");
    ui.muted("The robot moves to test poses, along a circle and a line; an external instrument measures its position \
         (ISO 9283). Measure once before writing and once after.");
    buttons(ui, model, outbox);
    let Some(open) = &model.open else {
        return;
    };
    imported(ui, open, outbox);
    let session = open.session();
    let stages = [Stage::Before, Stage::After].into_iter();
    for run in stages.filter_map(|stage| adjusting::to_continue(session, stage)) {
        ui.doubtful(&adjusting::stopped_in_words(run));
    }
    if session.verifications().is_empty() {
        return;
    }
    match figures(open, panel) {
        Ok((figures, ..)) => show_figures(ui, figures),
        Err(error) => ui.bad(&format!("{error}.")),
    }
}

fn buttons(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let rig = model.link.connected.as_ref().map(|c| &c.rig);
    let is_recording = rig.is_some_and(|rig| rig.kind == RobotKind::Recording);
    let by_hand = rig.is_some_and(|rig| !rig.has_instrument());
    let ready = model.link.is_armed() && !model.link.is_busy() && !is_recording;
    let hint = if is_recording {
        "Not available for a recording"
    } else {
        "Connect and arm the controller first"
    };
    if is_recording {
        ui.muted("This is a recording without test poses. Import a check.csv instead.");
    } else if by_hand {
        ui.muted("No instrument is connected: at each test pose the robot waits for your reading; or import a check.csv. \
             The circle and the line are skipped.");
    }
    ui.horizontal_wrapped(|ui| {
        for (text, stage) in [
            ("Measure before", Stage::Before),
            ("Measure after", Stage::After),
        ] {
            let button = icon_button(ui, icons::ICON_STRAIGHTEN, text, ready);
            if button.on_disabled_hover_text(hint).clicked() {
                outbox.send(RobotCommand::Verify(stage));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        let import = icon_button(ui, icons::ICON_UPLOAD_FILE, "Import check.csv…", true);
        if import.clicked() {
            outbox.send(FileCommand::AskOpen);
        }
        let open = model.open.as_ref();
        let runs = open.is_some_and(|d| !d.session().verifications().is_empty());
        let export = icon_button(ui, icons::ICON_DOWNLOAD, "Export last run…", runs);
        if export.clicked() {
            outbox.send(RobotCommand::AskExport(Export::Check));
        }
    });
}

/// Draws a running verification.
pub(super) fn under_way(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.section("Verification");
    motion::position(ui, model);
    motion::tensions(ui, model);
    match model.link.live().doing {
        RunStep::Locating { number, of } => typed::show(ui, model, panel, outbox, number, of),
        _ => typed::forget(panel),
    }
}

/// Asks which run an imported table belongs to.
fn imported(ui: &mut Ui, open: &OpenSession, outbox: &mut Outbox) {
    let session = open.session();
    let check = &session.phases.check;
    let taken = session.verifications().iter().any(|run| run.rows == *check);
    if check.is_empty() || taken {
        return;
    }
    ui.label(format!(
        "{} measurements were imported. They belong to the run",
        check.len()
    ));
    ui.horizontal(|ui| {
        for (text, stage) in [
            ("before the adjustment", Stage::Before),
            ("after it", Stage::After),
        ] {
            if ui.button(text).clicked() {
                outbox.send(RobotCommand::TakeCheck(stage));
            }
        }
    });
}

/// Draws the effect of the adjustment on the accuracy; a loss is an error if the controller holds the new values.
pub(super) fn result(ui: &mut Ui, open: &OpenSession, panel: &mut PanelState, is_held: bool) {
    let Ok((figures, predicted_m, plot)) = figures(open, panel) else {
        return;
    };
    let gain = figures.iter().find_map(Figure::gain);
    let Some((gain, text)) = gain.zip(result_in_words(figures, *predicted_m)) else {
        return;
    };
    let kind = match (gain > 0.0, is_held) {
        (true, _) => Verdict::Good,
        (false, true) => Verdict::Bad,
        (false, false) => Verdict::Doubtful,
    };
    ui.verdict(kind, &text);
    let name = "Position errors before and after";
    small::show(ui, name, plot, 40.0 * GRID, Selection::default());
}

fn figures<'a>(open: &OpenSession, panel: &'a mut PanelState) -> &'a Figures {
    let session = open.session();
    let fit = open.current_fit();
    let key = (open.id(), open.revision(), fit.is_some());
    panel.figures.get(key, || {
        let runs = session.verifications().iter();
        let after = runs.rev().find(|run| run.stage == Stage::After);
        let predicted = fit.zip(after).and_then(|(fit, run)| predicted_m(fit, run));
        let plot = plot_of_errors(session, predicted)?;
        Ok((before_and_after(session)?, predicted, plot))
    })
}

fn show_figures(ui: &mut Ui, lines: &[Figure]) {
    let columns = [
        TableColumn::words("Characteristic"),
        TableColumn::number("Before", "mm"),
        TableColumn::number("After", "mm"),
        TableColumn::number("Improvement", "%"),
    ];
    let palette = theme::of(ui);
    let millimetres =
        |m: Option<f64>| Cell::new(m.map_or_else(|| "–".to_owned(), |m| format!("{:.3}", m * 1e3)));
    let rows: Vec<Vec<Cell>> = lines
        .iter()
        .map(|line| {
            let gain = line.gain();
            let percent = gain.map_or_else(String::new, |gain| fixed(100.0 * gain, 0));
            let percent = match gain {
                Some(gain) if gain < 0.0 => Cell::new(percent).coloured(palette.warning),
                _ => Cell::new(percent),
            };
            let [before, after] = [line.before_m, line.after_m].map(millimetres);
            vec![Cell::new(&line.name), before, after, percent]
        })
        .collect();
    table(ui, &columns, &rows, None);
}
