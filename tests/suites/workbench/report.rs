//! The report, saved from the menu.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use tautline_core::effect::EffectSetting;
use tautline_workbench::model::command::{
    Answer, FileCommand, IdentificationCommand, ReportCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::phase::{Phase, Screen};
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

/// The details of a certificate are typed once: the session keeps them, the preferences keep the instruments, and the digital
/// certificate contains them.
#[test]
fn a_certificate_is_filled_in_by_hand_and_its_instruments_are_kept_for_the_next_session() {
    let measured = Measured::mini(25, &[]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    press(&mut harness, "File");
    press(&mut harness, "Save digital certificate (DCC)…");
    harness.get_by_label_contains("Not stated yet: Number of the certificate");
    for (field, text) in [
        ("Number", "2026-017"),
        ("Laboratory", "Robot Works"),
        ("Country", "GB"),
        ("Measured from", "2026-11-26"),
        ("Company", "Owner Ltd"),
        ("Operator", "A. Smith"),
    ] {
        type_into(&mut harness, Role::TextInput, field, text);
    }
    let model = &mut harness.state_mut().state.model;
    let draft = model.dialogs.report.as_mut().expect("a dialog");
    draft.details.temperature_c = Some(21.0);
    press(&mut harness, "Add an instrument");
    type_into(&mut harness, Role::TextInput, "Name", "Laser DX-1");
    type_into(&mut harness, Role::TextInput, "Due on", "2020-01-31");
    let path = measured.beside("mini.xml");
    let typed = path.display().to_string();
    type_into(&mut harness, Role::TextInput, "Path of the file", &typed);
    press(&mut harness, "Save report");
    let written = std::fs::read_to_string(&path).expect("the certificate");
    for part in [
        "2026-017",
        "Laser DX-1: its calibration was due on 2020-01-31",
    ] {
        assert!(written.contains(part), "no {part}");
    }
    let kept = document(&harness).session().settings.certificate.clone();
    assert_eq!(
        (kept.number.as_str(), kept.instruments.len()),
        ("2026-017", 1)
    );
    // Another session chooses among the instruments; until then, the overdue one is reported before measuring.
    give(&mut harness, FileCommand::Open(measured.beside("mini")));
    give(&mut harness, FileCommand::Answer(Answer::Discard));
    let measuring = Screen::Phase(Phase::Measuring);
    give(&mut harness, ViewCommand::Go(measuring));
    harness.get_by_label_contains("Laser DX-1: its calibration was due on 2020-01-31");
    give(&mut harness, ReportCommand::AskSave(ReportFormat::Html));
    let draft = harness.state().state.model.dialogs.report.as_ref();
    let draft = draft.expect("a dialog");
    assert_eq!(draft.details.laboratory, "Robot Works");
    assert!(draft.details.number.is_empty() && !draft.instruments[0].is_used);
}
