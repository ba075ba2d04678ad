//! The start screen.

use egui::{Key, Role};
use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::ViewCommand;
use tautline_workbench::model::messages::Severity;
use tautline_workbench::model::phase::Screen;

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
