//! The start screen.

use egui::{Key, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::{Session, Timestamp, write_session};
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{CompareCommand, FileCommand, RecordCommand, ViewCommand};
use tautline_workbench::model::messages::Severity;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workflow::samples;

use crate::demo::Bench;
use crate::measured::give;
use crate::support::{settle, type_into, workbench};

#[test]
fn a_path_that_does_not_exist_is_named() {
    let mut harness = workbench();
    settle(&mut harness);
    type_into(&mut harness, Role::TextInput, "Path", "nowhere.json");
    harness.get_by_label("Open").click();
    // The click arrives within several frames.
    harness.run_ok();
    settle(&mut harness);
    let shown = harness.get_by_label_contains("nowhere.json");
    assert!(shown.rect().is_positive(), "the status bar tells it");
    let last = harness.state().state.model.messages.last();
    assert!(last.is_some_and(|message| message.severity == Severity::Error));
    assert!(harness.state().state.model.open.is_none());
}

#[test]
fn arrow_keys_choose_in_the_command_palette() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, ViewCommand::Palette(true));
    // The demonstration, opening a file, importing one.
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::ArrowUp);
    harness.run_ok();
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(harness.state().state.model.screen, Screen::Import);
    assert!(harness.state().state.model.dialogs.palette.is_none());
}

#[test]
fn the_palette_has_commands_that_cannot_be_given_now_and_does_not_give_them() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, ViewCommand::Palette(true));
    type_into(&mut harness, Role::TextInput, "Command", "diagnosemodel");
    harness.run_ok();
    let line = harness.get_by_label_contains("Diagnose model");
    assert!(line.accesskit_node().is_disabled());
    harness.key_press(Key::Enter);
    settle(&mut harness);
    let model = &harness.state().state.model;
    assert!(model.dialogs.palette.is_some() && model.tasks.running().is_empty());
}

#[test]
fn back_leads_to_where_one_came_from_and_messages_stay_there() {
    let mut bench = Bench::demo(3);
    bench.settle("the demonstration");
    bench.go(Phase::Modeling);
    bench.give(ViewCommand::Go(Screen::Gallery));
    bench.settle("the gallery");
    bench.give(RecordCommand::Show);
    bench.give(CompareCommand::Show);
    bench.settle("all screens");
    for screen in [
        Screen::Record,
        Screen::Gallery,
        Screen::Phase(Phase::Modeling),
    ] {
        bench.press("Back");
        assert_eq!(bench.state().model.screen, screen);
    }
    let state = &mut bench.harness.state_mut().state;
    state.model.messages.info("Something was done.");
    bench.harness.step();
    bench.harness.get_by_label("Something was done.");
    bench.give(CompareCommand::Show);
    bench.harness.step();
    assert!(
        bench
            .harness
            .query_by_label("Something was done.")
            .is_none()
    );
    bench.harness.get_by_label("Ready");
}

#[test]
fn the_first_step_is_that_of_the_keys() {
    let mut harness = workbench();
    settle(&mut harness);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::Enter);
    settle(&mut harness);
    let open = harness.state().state.model.open.as_ref();
    assert_eq!(open.expect("a session").session().name, "Demo robot");
}

#[test]
fn sample_sessions_stand_below_their_heading() {
    let mut harness = workbench();
    settle(&mut harness);
    let heading = harness.get_by_label("Sample sessions").rect().min.x;
    let samples = samples::find(&samples::places());
    assert!(samples.len() > 3);
    let mut column = Vec::new();
    for sample in samples {
        column.push(harness.get_by_label(&sample.title).rect().min.x);
        // Several samples may show the same.
        let shows = harness.get_all_by_label_contains(&sample.shows);
        column.extend(shows.map(|shows| shows.rect().min.x));
    }
    // Beside the pictures, which stand below the heading.
    assert!(
        column.iter().all(|x| (x - column[0]).abs() < 1.0),
        "{column:?}"
    );
    assert!(
        column[0] > heading && column[0] < heading + 60.0,
        "{heading}"
    );
}

#[test]
fn sessions_of_one_robot_are_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = presets::find("mini").expect("a preset").robot;
    let mut harness = workbench();
    for (day, name) in ["one.json", "two.json", "three.json"].iter().enumerate() {
        let time = Timestamp::from_unix_seconds(1_532_336_700 + 86_400 * day as i64);
        let mut session = Session::new("MINI", robot.clone(), time);
        let data = simulate(&robot, &SimulationOptions::new(3, 1)).expect("measurements");
        session.measurements = data.dataset.measurements;
        let path = folder.path().join(name);
        write_session(&path, &session).expect("written");
        give(&mut harness, FileCommand::Open(path));
        give(&mut harness, FileCommand::Close);
    }
    let said = words(&harness);
    let facts = ["one.json", "two.json", "three.json"].map(|name| {
        let mut lines = said.iter();
        let line = lines.find(|line| line.ends_with(&format!(", mini, {name}")));
        let line = line.unwrap_or_else(|| panic!("no {name} in {said:?}"));
        line.split(", ").next().map(str::to_owned)
    });
    assert!(facts[0] != facts[1] && facts[1] != facts[2], "{facts:?}");
    assert!(
        facts[0]
            .iter()
            .all(|date| date.starts_with("measured 2018-07-"))
    );
}
