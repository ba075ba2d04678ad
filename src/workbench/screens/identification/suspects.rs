//! Suspicious readings and excluded poses.

use egui::Ui;
use tautline_core::estimation::Observation;

use super::Panel;
use crate::model::Selection;
use crate::model::command::ViewCommand;
use crate::model::edit::Edit;
use crate::theme;
use crate::widgets::UiExt;
use tautline_workflow::identification::Identification;
use tautline_workflow::wording::count;

/// Largest number of listed suspect poses.
const SHOWN: usize = 5;

pub fn show(ui: &mut Ui, panel: &mut Panel<'_>, fit: &Identification) {
    let poses = &fit.suspects;
    if !poses.is_empty() {
        ui.section("Suspicious readings");
        ui.muted("These readings do not fit the model. A single one may be an outlier; many on one cable point to a missing effect.");
    }
    for pose in poses.iter().take(SHOWN) {
        suspect(ui, panel, fit, pose);
    }
    if poses.len() > SHOWN {
        ui.muted(&format!("and {} more", count(poses.len() - SHOWN, "pose")));
    }
    excluded(ui, panel);
}

fn suspect(ui: &mut Ui, panel: &mut Panel<'_>, fit: &Identification, readings: &[Observation]) {
    let label = fit.dataset.measurements.labels[readings[0].row];
    let more = match readings.len() {
        1 => String::new(),
        several => format!(", and {} more", several - 1),
    };
    let text = format!("Pose {label}, {}{more}", fit.suspect_line(&readings[0]));
    let selected = panel.model.selection.pose == Some(label);
    let colour = if selected {
        theme::of(ui).accent
    } else {
        theme::of(ui).text
    };
    let words = egui::Label::new(egui::RichText::new(text).color(colour)).wrap();
    if ui
        .add(words.sense(egui::Sense::click()))
        .on_hover_text("Select this pose")
        .clicked()
    {
        panel
            .outbox
            .send(ViewCommand::Select(Selection::pose(label)));
    }
    let is_home = fit
        .solution
        .poses
        .first()
        .is_some_and(|(row, _)| *row == readings[0].row)
        && fit.dataset.measurements.home_row() == Some(readings[0].row);
    if is_home {
        ui.muted("The home pose cannot be excluded: revolutions are counted from it.");
    } else if ui.button(format!("Exclude pose {label}")).clicked() {
        panel.outbox.send(Edit::Exclude(label));
    }
}

fn excluded(ui: &mut Ui, panel: &mut Panel<'_>) {
    let excluded = panel.open.session().excluded();
    if excluded.is_empty() {
        return;
    }
    ui.section("Excluded poses");
    ui.horizontal_wrapped(|ui| {
        for label in excluded {
            let button = ui.button(format!("Include pose {label}"));
            if button.clicked() {
                panel.outbox.send(Edit::Include(*label));
            }
        }
    });
}
