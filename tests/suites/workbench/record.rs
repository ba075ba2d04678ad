//! The record of a robot.

use std::path::{Path, PathBuf};

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_validation::generators::sessions;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{FileCommand, RecordCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workflow::history::Tolerance;

use crate::measured::{give, press};
use crate::support::{settle, type_into, workbench};

/// The sample record.
fn year() -> PathBuf {
    sessions::folder().join("year-of-mini")
}

/// A row of the table of sessions.
fn row(harness: &Harness<'_, App>, session: &str) -> String {
    let start = format!("{session},");
    let found = harness.get_by_label_contains(&start);
    found.accesskit_node().label().unwrap_or_default()
}

#[test]
fn a_folder_that_is_typed_shows_what_changed_and_two_rows_are_compared() {
    let mut harness = workbench();
    settle(&mut harness);
    press(&mut harness, "Record of a robot");
    harness.get_by_label_contains("Choose a folder with the sessions of one robot");
    let text = year().display().to_string();
    type_into(&mut harness, Role::TextInput, "Folder of the record", &text);
    press(&mut harness, "Open");
    harness.get_by_label("7 sessions of mini");
    harness.get_by_label_contains("Between 2026-04 and 2026-06 the pulley of cable-3 moved by 13");
    harness.get_by_label_contains("(cable-6 replaced on 2026-09-03) the winch scale (cable-6)");
    for cable in 1..=8 {
        harness.get_by_label(&format!("Course: Pulley of cable-{cable} (mm)"));
    }
    assert!(
        row(&harness, "2026-06").contains("13."),
        "{}",
        row(&harness, "2026-06")
    );
    for session in ["2026-08", "2026-04"] {
        let row = row(&harness, session);
        press(&mut harness, &row);
    }
    assert!(row(&harness, "2026-04 (A)").contains("2026-04-02"));
    press(&mut harness, "Check B against A");
    harness.get_by_label("Health check: 2026-08 against 2026-04");
    harness.get_by_label_contains("pulley of cable-3 by 1");
    press(&mut harness, "Compare A and B");
    assert_eq!(harness.state().state.model.screen, Screen::Compare);
    harness.get_by_label("1 pulley has moved: cable-3. The rest agrees within the noise.");
}

#[test]
fn the_path_of_the_selected_pulley_is_drawn_over_the_sessions() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, FileCommand::Open(year()));
    harness.get_by_label("Select a pulley to see its path over the sessions.");
    give(&mut harness, ViewCommand::Select(Selection::cable(2)));
    harness.get_by_label_contains("Path of cable-3: 13.");
    // A row shows its session, as the slider does; it moved between the two.
    for (session, path) in [("2026-04", "0.0 mm"), ("2026-06", "13.")] {
        let row = row(&harness, session);
        press(&mut harness, &row);
        harness.get_by_label_contains(&format!("Path of cable-3: {path}"));
    }
}

#[test]
fn a_folder_of_sessions_is_opened_as_a_record_and_the_tolerance_moves_the_date() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, FileCommand::Open(year()));
    assert_eq!(harness.state().state.model.screen, Screen::Record);
    harness.get_by_label_contains("Calibrate again by ");
    give(
        &mut harness,
        RecordCommand::SetTolerance(Tolerance::Pulley(5e-3)),
    );
    harness.get_by_label_contains("The pulleys are known to ");
    harness.get_by_label_contains("(95 %), which is not enough for a tolerance of 5 mm");
    let of_pulleys = Tolerance::Pulley(0.02);
    give(&mut harness, RecordCommand::SetTolerance(of_pulleys));
    harness.get_by_label_contains("is more than 20 mm from its value in the last session");
    press(&mut harness, "platform position");
    harness.get_by_label_contains("of the platform");
}

#[test]
fn a_folder_that_is_no_record_is_said_in_one_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, RecordCommand::Open(folder.path().to_owned()));
    let sentence = format!(
        "{}: the number of sessions is 0, expected at least 2.",
        folder.path().display()
    );
    assert_ne!(harness.query_all_by_label(&sentence).count(), 0);
    give(
        &mut harness,
        RecordCommand::Open(Path::new("/no/such").to_owned()),
    );
    assert_ne!(harness.query_all_by_label_contains("/no/such: ").count(), 0);
}

#[test]
fn a_health_check_of_the_last_session_is_planned_as_a_session_of_its_own() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, FileCommand::Open(year()));
    press(&mut harness, "Plan a health check");
    let model = &harness.state().state.model;
    let open = model.open.as_ref().expect("a session");
    assert_eq!(open.session().name, "MINI, 2026-11, health check");
    // The home pose and eight others.
    assert_eq!(open.session().plan.len(), 9);
    assert!(open.session().measurements.is_empty());
    assert_eq!(model.screen, Screen::Phase(Phase::Measuring));
}
