//! The start screen.

use egui::{Key, Role};
use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::ViewCommand;
use tautline_workbench::model::messages::Severity;
use tautline_workbench::model::phase::Screen;
use tautline_workflow::samples;

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
fn sample_sessions_stand_below_their_heading() {
    let mut harness = workbench();
    settle(&mut harness);
    let heading = harness.get_by_label("Sample sessions").rect().min.x;
    let samples = samples::find(&samples::places());
    assert!(samples.len() > 3);
    for sample in samples {
        let title = harness.get_by_label(&sample.title).rect().min.x;
        assert!((title - heading).abs() < 1.0, "{}: {title}", sample.title);
        let shows = harness.get_all_by_label(&sample.shows);
        let column: Vec<f32> = shows.map(|shows| shows.rect().min.x).collect();
        assert!(
            column.iter().all(|x| (x - column[0]).abs() < 1.0),
            "{column:?}"
        );
    }
}
