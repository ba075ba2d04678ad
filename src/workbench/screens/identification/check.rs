//! The check before identification.

use egui::{CollapsingHeader, Ui};
use tautline_workflow::readiness::{CheckItem, CheckOutcome, check_readings};

use super::Panel;
use crate::model::command::{IdentificationCommand, READINESS, Readiness};
use crate::widgets::{Verdict, fault_window, muted, section, verdict};

/// Draws the parts that take no time at once, the others once they were asked for.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>) {
    section(ui, "Check");
    let open = panel.open;
    let key = (open.id(), open.revision());
    let readings = panel
        .memory
        .readings
        .get(key, || check_readings(&open.session().dataset()));
    let inputs = open.inputs();
    let whole = panel.run.readiness.as_ref().filter(|(of, _)| *of == inputs);
    let items = whole.map_or(readings, |(_, found)| &found.checks);
    // What is well once there is a result needs no room.
    let is_well = items.iter().all(|item| item.outcome != CheckOutcome::Fail);
    if is_well && open.fit_is_current() {
        verdict(
            ui,
            Verdict::Good,
            "Nothing in the readings stands in the way of identification.",
        );
        CollapsingHeader::new("All parts of the check")
            .show(ui, |ui| items.iter().for_each(|i| show_item(ui, i)));
    } else {
        items.iter().for_each(|item| show_item(ui, item));
    }
    match whole {
        Some((_, found)) => faults(ui, found, &mut panel.memory.shows_faults),
        None if panel.tasks.runs(READINESS) => {
            ui.horizontal(|ui| {
                ui.spinner();
                muted(
                    ui,
                    "Checking what the readings determine and which faults they would show.",
                );
            });
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

fn show_item(ui: &mut Ui, item: &CheckItem) {
    let kind = match item.outcome {
        CheckOutcome::Pass => Verdict::Good,
        CheckOutcome::Fail => Verdict::Bad,
        CheckOutcome::NotEvaluated => Verdict::Neutral,
    };
    let not = match item.outcome {
        CheckOutcome::NotEvaluated => " (not evaluated)",
        CheckOutcome::Pass | CheckOutcome::Fail => "",
    };
    verdict(
        ui,
        kind,
        &format!("{}{not}: {}", item.title(), item.sentence),
    );
    if let Some(action) = &item.action {
        muted(ui, action);
    }
}

fn faults(ui: &mut Ui, found: &Readiness, is_shown: &mut bool) {
    let Some(table) = &found.faults else {
        return;
    };
    let name = if *is_shown {
        "Hide faults"
    } else {
        "Show faults"
    };
    if ui.button(name).clicked() {
        *is_shown = !*is_shown;
    }
    fault_window(ui, table, is_shown);
}
