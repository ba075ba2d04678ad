//! Check of the readings before the identification.

use egui::{CollapsingHeader, Ui};
use tautline_session::Session;
use tautline_workflow::foreign_writes::sentences;
use tautline_workflow::importing::can_import_again;
use tautline_workflow::readiness::{CheckItem, CheckOutcome, PLAUSIBLE};

use super::Panel;
use crate::model::command::{IdentificationCommand, READINESS, Readiness, RecordingCommand};
use crate::model::next_step::{Problem, checked};
use crate::widgets::{UiExt, Verdict, fault_button, fault_window};

/// Number of warnings of the measuring run that are listed without expanding.
const WARNINGS_SHOWN: usize = 3;

/// Draws the quick checks at once, the others on request.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    ui.section("Check");
    let open = panel.open;
    let items = checked(panel.model, open);
    // Passed checks are collapsed once there is a result.
    let is_well = items.iter().all(|(_, problem)| problem.is_none());
    if is_well && open.fit_is_current() {
        ui.good("Nothing in the readings stands in the way of identification.");
        CollapsingHeader::new("All parts of the check")
            .show(ui, |ui| items.iter().for_each(|i| show_item(ui, panel, i)));
    } else {
        items.iter().for_each(|item| show_item(ui, panel, item));
    }
    warnings(ui, open.session());
    let inputs = open.inputs();
    let readiness = panel.model.identification.readiness.as_ref();
    match readiness.filter(|(of, _)| *of == inputs) {
        Some((_, found)) => faults(ui, found, &mut panel.memory.shows_faults),
        None if panel.model.tasks.runs(READINESS) => {
            ui.busy("Checking what the readings determine and which faults they would show.");
        }
        None => {
            let button = ui.button("Check geometry and faults");
            let tip = "Do the readings determine the geometry, and which faults would they show?";
            if button.on_hover_text(tip).clicked() {
                panel.outbox.send(IdentificationCommand::Check);
            }
        }
    }
}

/// Implausible readings noticed during measuring; a warning disappears when its pose is excluded.
fn warnings(ui: &mut Ui, session: &Session) {
    for text in sentences(session) {
        ui.bad(&text);
    }
    let texts: Vec<&str> = session
        .measuring_warnings()
        .map(|warning| warning.text.as_str())
        .collect();
    let title = match texts.len() {
        0 => return,
        1 => "1 warning while measuring".to_owned(),
        many => format!("{many} warnings while measuring"),
    };
    ui.doubtful(&title);
    CollapsingHeader::new("Warnings while measuring")
        .default_open(texts.len() <= WARNINGS_SHOWN)
        .show(ui, |ui| {
            for text in texts {
                ui.muted(text);
            }
        });
}

fn show_item(ui: &mut Ui, panel: &mut Panel<'_>, (item, problem): &(&CheckItem, Option<Problem>)) {
    let kind = match item.outcome {
        CheckOutcome::Pass => Verdict::Good,
        CheckOutcome::Fail if problem.is_some() => Verdict::Bad,
        CheckOutcome::Notice | CheckOutcome::Fail => Verdict::Doubtful,
        CheckOutcome::NotEvaluated => Verdict::Neutral,
    };
    let not = match item.outcome {
        CheckOutcome::NotEvaluated => " (not evaluated)",
        CheckOutcome::Pass | CheckOutcome::Notice | CheckOutcome::Fail => "",
    };
    ui.verdict(kind, &format!("{}{not}: {}", item.title(), item.sentence));
    if let Some(action) = &item.action {
        ui.muted(action);
    }
    if item.name == PLAUSIBLE && item.outcome == CheckOutcome::Fail {
        back_to_import(ui, panel);
    }
}

/// Button back to the import: a wrong sign, unit or channel is corrected in the recipe, not in the robot.
pub(super) fn back_to_import(ui: &mut Ui, panel: &mut Panel<'_>) {
    if can_import_again(panel.open.session()) {
        let button = ui.button("Back to import");
        let tip = "Corrects signs, units and channels in the recipe, and imports the readings again. This can be undone.";
        if button.on_hover_text(tip).clicked() {
            panel.outbox.send(RecordingCommand::Correct);
        }
    }
}

fn faults(ui: &mut Ui, found: &Readiness, is_shown: &mut bool) {
    let Some(table) = &found.faults else {
        return;
    };
    fault_button(ui, is_shown);
    fault_window(ui, table, is_shown);
}
