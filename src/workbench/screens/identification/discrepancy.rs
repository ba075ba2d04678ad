//! Dependences of residuals on variables.

use egui::{CollapsingHeader, Label, Sense, Ui};
use tautline_core::diagnosis::Discrepancy;

use super::Panel;
use crate::model::command::ViewCommand;
use crate::widgets::UiExt;
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::diagnosis::dependences::groups;
use tautline_workflow::wording::{list, p_value, ratio, readings, sentence};

/// Draws the dependences, collapsed, grouped by reading; a click on one plots it.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed) {
    let found = &diagnosed.diagnosis.discrepancies;
    // They no longer apply once the findings are in the model.
    if found.is_empty() || !panel.open.is_model_diagnosed() {
        return;
    }
    let title = "Dependences of the residuals";
    CollapsingHeader::new(title).show(ui, |ui| {
        for group in groups(found) {
            line(ui, panel, diagnosed, found, &group);
        }
    });
}

/// One dependence: reading, excess, variables. A click plots it.
fn line(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    diagnosed: &Diagnosed,
    found: &[Discrepancy],
    group: &[usize],
) {
    let Some(first) = group.first().map(|index| &found[*index]) else {
        return;
    };
    let cable = diagnosed.cable(first.cable);
    let text = format!(
        "{}: {} times the expected noise",
        sentence(&readings(first.quantity, cable.as_deref())),
        ratio(first.rms_over_sd)
    );
    let line = ui.add(Label::new(text).wrap().sense(Sense::click()));
    let names = group.iter().map(|index| found[*index].variable.name());
    let names: Vec<String> = names.map(str::to_owned).collect();
    let together = match names.len() {
        0 | 1 => "",
        _ => ", which vary together here",
    };
    ui.muted(&format!("Against {}{together}", list(&names)));
    let tip = format!(
        "By chance alone: {}, corrected for all tests. Click for the plot.",
        p_value(first.p_value)
    );
    if line.on_hover_text(tip).clicked() {
        let shown = ViewCommand::ShowDependence(first.quantity, first.cable, first.variable);
        panel.outbox.send(shown);
    }
}
