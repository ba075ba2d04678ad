//! Form for the certificate: statements besides the results, instruments of the workshop, missing entries.

use egui::{ComboBox, Ui};
use tautline_core::robot::Robot;
use tautline_session::{CalibratedInstrument, CertificateDetails, DecisionRule};
use tautline_workflow::report::missing_details;
use tautline_workflow::report::tolerance::rule_name;
use tautline_workflow::wording::list;

use crate::model::command::{ReportDraft, WorkshopInstrument};
use crate::theme::GRID;
use crate::widgets::{self, Entered, Number, UiExt, checkbox, number, text_row};

/// Width of a text field (points).
const FIELD: f32 = 290.0;
/// Example of a date.
const DATE: &str = "2026-11-28";

/// Draws the fields of the certificate in the report dialog.
pub fn form(ui: &mut Ui, draft: &mut ReportDraft, robot: &Robot) {
    ui.section("Certificate");
    widgets::form("certificate").show(ui, |ui| {
        let details = &mut draft.details;
        for (name, text, hint) in [
            ("Number", &mut details.number, "None: a report"),
            ("Laboratory", &mut details.laboratory, "Name and address"),
            ("Country", &mut details.country, "Two letters, such as DE"),
            ("Measured at", &mut details.place, "Place"),
            ("Measured from", &mut details.measured_from, DATE),
            ("Measured to", &mut details.measured_to, DATE),
            (
                "Maker of the robot",
                &mut details.manufacturer,
                "Not stated",
            ),
            (
                "Operation",
                &mut details.operation,
                "Load, speed, time of warming up",
            ),
        ] {
            text_row(ui, name, text, hint, FIELD);
        }
        conditions(ui, details);
        let label = ui.label("Decision rule");
        let rule = ComboBox::from_id_salt("decision rule")
            .width(FIELD)
            .selected_text(rule_name(details.decision_rule))
            .show_ui(ui, |ui| {
                for rule in DecisionRule::ALL {
                    ui.selectable_value(&mut details.decision_rule, rule, rule_name(rule));
                }
            });
        rule.response.labelled_by(label.id);
        ui.end_row();
    });
    instruments(ui, &mut draft.instruments);
    let missing = missing_details(&draft.chosen_details(), robot);
    if !missing.is_empty() {
        ui.add_space(GRID);
        ui.muted(&format!("Not stated yet: {}.", list(&missing)));
    }
}

/// Temperature, its uncertainty and the expansion of the frame.
fn conditions(ui: &mut Ui, details: &mut CertificateDetails) {
    let mut optional = |name: &str, unit: &str, factor: f64, value: &mut Option<f64>| {
        ui.label(name);
        let shown = Number::of(name, value.map(|si| factor * si), 1, unit, 90.0);
        let field = shown.optional(true);
        match ui.horizontal(|ui| number(ui, &field)).inner {
            Some(Entered::Nothing) => *value = None,
            Some(Entered::Value(entered)) => *value = Some(entered / factor),
            Some(Entered::Wrong(_)) | None => {}
        }
        ui.end_row();
    };
    optional("Temperature", "°C", 1.0, &mut details.temperature_c);
    optional("Its uncertainty", "K", 1.0, &mut details.temperature_sd_k);
    optional("Expansion", "µm/(m K)", 1e6, &mut details.expansion_per_k);
}

/// Instruments of the workshop, with a check mark for those used.
fn instruments(ui: &mut Ui, instruments: &mut Vec<WorkshopInstrument>) {
    ui.section("Instruments used");
    if instruments.is_empty() {
        ui.muted("None is entered yet. They are kept for all sessions.");
    }
    let mut removed = None;
    for (index, one) in instruments.iter_mut().enumerate() {
        let title = match one.instrument.name.trim() {
            "" => format!("Instrument {}", index + 1),
            name => name.to_owned(),
        };
        ui.push_id(index, |ui| {
            ui.horizontal(|ui| {
                checkbox(ui, &mut one.is_used, &title);
                let edit = if one.is_edited { "Done" } else { "Edit" };
                if ui.button(edit).clicked() {
                    one.is_edited = !one.is_edited;
                }
                if one.is_edited && ui.button("Remove").clicked() {
                    removed = Some(index);
                }
            });
            if one.is_edited {
                details_of(ui, &mut one.instrument);
            }
        });
    }
    if let Some(index) = removed {
        instruments.remove(index);
    }
    if ui.button("Add an instrument").clicked() {
        instruments.push(WorkshopInstrument {
            instrument: CalibratedInstrument::default(),
            is_used: true,
            is_edited: true,
        });
    }
}

fn details_of(ui: &mut Ui, instrument: &mut CalibratedInstrument) {
    widgets::form("instrument").show(ui, |ui| {
        for (name, text, hint) in [
            ("Name", &mut instrument.name, "Maker and type"),
            ("Serial number", &mut instrument.serial_number, ""),
            ("Certificate", &mut instrument.certificate, "Its number"),
            ("Calibrated on", &mut instrument.calibrated_on, DATE),
            ("Due on", &mut instrument.due_on, DATE),
            (
                "Traceable to",
                &mut instrument.traceable_to,
                "Laboratory or national institute",
            ),
        ] {
            text_row(ui, name, text, hint, FIELD);
        }
    });
}
