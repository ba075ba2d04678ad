//! The report, saved from the menu.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use tautline_core::effect::EffectSetting;
use tautline_workbench::model::command::{
    Answer, FileCommand, IdentificationCommand, ReportCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::shell::App;
use tautline_workflow::report::ReportFormat;

use crate::measured::{Measured, document, give, press};
use crate::support::type_into;

#[test]
fn both_entries_of_the_menu_save_at_a_typed_path() {
    let measured = Measured::mini(12, &[]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    for (format, start) in [("HTML", "<!DOCTYPE html>"), ("PDF", "%PDF-")] {
        press(&mut harness, "File");
        press(&mut harness, &format!("Save report as {format}…"));
        let path = measured.beside(&format!("own.{}", format.to_lowercase()));
        // The end of the name follows from the format.
        let typed = path.with_extension("").display().to_string();
        type_into(&mut harness, Role::TextInput, "Path of the file", &typed);
        press(&mut harness, "Save report");
        let bytes = std::fs::read(&path).expect("the report");
        let shown = String::from_utf8_lossy(&bytes[..start.len()]).to_lowercase();
        assert_eq!(shown, start.to_lowercase());
        assert!(harness.query_by_label("Save report").is_none(), "closed");
    }
}

#[test]
fn a_tolerance_belongs_to_its_session() {
    let measured = Measured::mini(12, &[]);
    let mut harness = measured.opened();
    let asked = |harness: &mut Harness<'_, App>| {
        give(harness, ReportCommand::AskSave(ReportFormat::Html));
        let report = harness.state().state.model.dialogs.report.as_ref();
        report.expect("a dialog").choice.tolerance_m
    };
    assert_eq!(asked(&mut harness), None);
    let model = &mut harness.state_mut().state.model;
    let report = model.dialogs.report.as_mut().expect("a dialog");
    report.choice.tolerance_m = Some(2e-3);
    let path = measured.beside("with.html");
    give(&mut harness, ReportCommand::Save(path));
    assert_eq!(asked(&mut harness), Some(2e-3));
    give(&mut harness, ReportCommand::Cancel);
    let session = document(&harness).session();
    assert_eq!(session.settings.tolerance_m, Some(2e-3));
    // The same folder of preferences, another session.
    give(&mut harness, FileCommand::Open(measured.beside("mini")));
    give(&mut harness, FileCommand::Answer(Answer::Discard));
    assert_eq!(asked(&mut harness), None);
}

/// A fault is found, added to the model and identified: the report leads with that model, and the dialog offers a diagnosis
/// of it.
#[test]
fn the_dialog_brings_up_to_date_what_the_report_would_say_of_an_earlier_model() {
    let measured = Measured::mini(25, &[("winch_scale", "cable-3", &[("scale", 0.02)])]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    let scale = EffectSetting {
        effect: "winch_scale".into(),
        targets: vec!["cable-3".into()],
        parameters: [("scale".into(), 0.0)].into(),
    };
    give(&mut harness, Edit::AddEffects(vec![scale], "add it".into()));
    give(&mut harness, ReportCommand::AskSave(ReportFormat::Html));
    let earlier = "The last diagnosis is of an earlier model or earlier data.";
    harness.get_by_label(earlier);
    let path = measured.beside("earlier.html");
    give(&mut harness, ReportCommand::Save(path.clone()));
    let html = std::fs::read_to_string(path).expect("the report");
    assert!(html.contains("the model explains the readings of 26 poses."));
    assert!(!html.contains("NOT explain"));
    assert!(html.contains("Found by the diagnosis of "));

    give(&mut harness, ReportCommand::AskSave(ReportFormat::Html));
    press(&mut harness, "Diagnose now");
    assert!(harness.query_by_label(earlier).is_none(), "up to date");
    harness.get_by_label("Save report");
}
