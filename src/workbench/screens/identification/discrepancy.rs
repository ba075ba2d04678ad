//! Dependences of residuals on variables.

use egui::Ui;
use tautline_core::diagnosis::Discrepancy;

use super::Panel;
use crate::model::command::ViewCommand;
use crate::theme;
use crate::views::plots::small;
use crate::widgets::{muted, section};
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::diagnosis::dependences::groups;
use tautline_workflow::wording::{list, p_value, ratio, readings, sentence};

/// Height of a plot (points).
pub const HEIGHT: f32 = 190.0;

/// Draws the list, readings by readings; the chosen one with its plot.
pub fn show(ui: &mut Ui, panel: &mut Panel<'_>, diagnosed: &Diagnosed) {
    let found = &diagnosed.diagnosis.discrepancies;
    if found.is_empty() {
        return;
    }
    section(
        ui,
        "Where the residuals of the present model depend on something",
    );
    for group in groups(found) {
        let Some(first) = group.first().copied() else {
            continue;
        };
        let open = panel.memory.open.filter(|open| group.contains(open));
        if line(ui, diagnosed, found, &group, open.is_some()) {
            panel.memory.open = open.is_none().then_some(first);
            let one = &found[first];
            let shown = ViewCommand::ShowDependence(one.quantity, one.cable, one.variable);
            panel.outbox.send(shown);
        }
        if let Some(open) = open {
            plot(ui, panel, found, (&group, open));
        }
    }
}

/// One dependence: reading, excess, variable. Returns whether it was clicked.
fn line(
    ui: &mut Ui,
    diagnosed: &Diagnosed,
    found: &[Discrepancy],
    group: &[usize],
    is_open: bool,
) -> bool {
    let Some(first) = group.first().map(|index| &found[*index]) else {
        return false;
    };
    let palette = theme::of(ui);
    let cable = diagnosed.cable(first.cable);
    let text = format!(
        "{}: {} times the expected noise",
        sentence(&readings(first.quantity, cable.as_deref())),
        ratio(first.rms_over_sd)
    );
    let colour = if is_open {
        palette.accent
    } else {
        palette.text
    };
    let label = egui::Label::new(egui::RichText::new(text).color(colour)).wrap();
    let line = ui.add(label.sense(egui::Sense::click()));
    muted(ui, &along(found, group));
    let tip = format!(
        "By chance alone: {}, corrected for all tests. Click for the plot.",
        p_value(first.p_value)
    );
    line.on_hover_text(tip).clicked()
}

/// Along what, in words.
fn along(found: &[Discrepancy], group: &[usize]) -> String {
    let names: Vec<String> = group
        .iter()
        .map(|index| found[*index].variable.name().to_owned())
        .collect();
    match names.len() {
        0 | 1 => format!("Against {}", list(&names)),
        _ => format!("Against {}, which vary together here", list(&names)),
    }
}

/// The plot along one of the variables, and which.
fn plot(
    ui: &mut Ui,
    panel: &mut Panel<'_>,
    found: &[Discrepancy],
    (group, open): (&[usize], usize),
) {
    if group.len() > 1 {
        ui.horizontal_wrapped(|ui| {
            for index in group {
                let name = sentence(found[*index].variable.name());
                ui.selectable_value(&mut panel.memory.open, Some(*index), name);
            }
        });
    }
    let plots = panel.open.plotted_diagnosis();
    let Some(figure) = plots.and_then(|plots| plots.dependences.get(&open)) else {
        return;
    };
    let name = format!("Residuals against {}", found[open].variable.name());
    let clicked = small::show(ui, &name, figure, HEIGHT, panel.selection);
    if let Some(selection) = clicked {
        panel.outbox.send(ViewCommand::Select(selection));
    }
}
