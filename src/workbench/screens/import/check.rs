//! Problems of the data, and the step that adds the poses to the session.

use egui::{CollapsingHeader, Ui};
use egui_material_icons::icons;

use tautline_workflow::readiness::{CheckItem, CheckOutcome};

use super::Bench;
use crate::model::Model;
use crate::model::command::{CUTTING, RecordingCommand};
use crate::theme;
use crate::widgets::{UiExt, Verdict, icon_button, primary};

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    ui.section("Check");
    let Some(cut) = bench.open.cut.clone() else {
        ui.muted("The readings are checked once poses are cut.");
        return;
    };
    let suggestions = bench.open.suggestions();
    for (k, suggestion) in suggestions.iter().enumerate() {
        ui.doubtful(&format!("{}.", suggestion.sentence));
        let name = format!("Correct {}", suggestion.columns.join(", "));
        if icon_button(ui, icons::ICON_BUILD, &name, true).clicked() {
            bench.outbox.send(RecordingCommand::Apply(k));
        }
    }
    match &cut.result {
        Err(error) => {
            ui.bad(&format!("{}.", error.error));
        }
        Ok(_) if suggestions.is_empty() => readings(ui, &cut.checks),
        Ok(_) => {}
    }
    let assumptions = bench.open.draft.assumptions().iter();
    let mut notices: Vec<&str> = assumptions.map(String::as_str).collect();
    if let Ok(imported) = &cut.result {
        notices.extend(imported.document.notices.iter().map(String::as_str));
    }
    if notices.is_empty() {
        return;
    }
    CollapsingHeader::new(format!("Notices ({})", notices.len()))
        .id_salt("notices of the import")
        .default_open(true)
        .show(ui, |ui| {
            for notice in notices {
                ui.muted(&format!("{notice}."));
            }
        });
}

/// Check of the poses as readings of the robot.
fn readings(ui: &mut Ui, checks: &[CheckItem]) {
    let open = checks
        .iter()
        .filter(|one| one.outcome != CheckOutcome::Pass);
    for item in open.clone() {
        let kind = match item.outcome {
            CheckOutcome::Fail => Verdict::Bad,
            CheckOutcome::Notice => Verdict::Doubtful,
            CheckOutcome::NotEvaluated | CheckOutcome::Pass => Verdict::Neutral,
        };
        ui.verdict(kind, &item.sentence);
        if let Some(action) = &item.action {
            ui.muted(action);
        }
    }
    if open.count() == 0 {
        ui.good("No mistake was found in the readings.");
    }
}

/// Draws the step that adds the poses to the session.
pub fn last_step(ui: &mut Ui, model: &Model, bench: &mut Bench<'_>) {
    let open = bench.open;
    let poses = open.cut.as_ref().and_then(|cut| {
        let imported = cut.result.as_ref().ok()?;
        Some(imported.measurements.len())
    });
    let measured = model
        .open
        .as_ref()
        .map_or(0, |open| open.session().measurements.len());
    let where_to = match measured {
        0 => "",
        _ if model.importing.replaces => " again",
        _ => " as a new session",
    };
    let is_ready = open.is_current() && poses.is_some();
    ui.horizontal_wrapped(|ui| {
        let title = match poses {
            Some(poses) => format!("Import {poses} poses{where_to}"),
            None => format!("Import{where_to}"),
        };
        if primary(ui, &title, is_ready).clicked() {
            bench.outbox.send(RecordingCommand::Finish);
        }
        let found = open.suggestions().len();
        if model.tasks.runs(CUTTING) {
            ui.spinner();
        } else if poses.is_none() || found > 0 {
            let colour = theme::of(ui).warning;
            let icon = icons::ICON_WARNING.rich_text().size(18.0);
            ui.label(icon.color(colour));
            ui.label(match (poses, found) {
                (None, _) => "See Check".to_owned(),
                (_, 1) => "A mistake was found: see Check".to_owned(),
                _ => format!("{found} mistakes were found: see Check"),
            });
        }
    });
}
