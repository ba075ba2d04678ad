//! Actions of the tests of phases 1 and 2.

use std::path::{Path, PathBuf};

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use serde_json::Value;
use tautline_workbench::model::command::FileCommand;
use tautline_workbench::shell::App;

use crate::support::{settle, type_into, workbench};

/// A workbench with the robot MINI, and a folder for tables.
pub struct Bench {
    /// The workbench.
    pub harness: Harness<'static, App>,
    folder: tempfile::TempDir,
}

impl Bench {
    /// The robot, changed by `change`, with nothing measured.
    pub fn with_robot(change: impl FnOnce(&mut Value)) -> Self {
        let folder = tempfile::tempdir().expect("folder");
        let robot = tautline_core::robot::presets::find("mini").expect("preset");
        let path = folder.path().join("robot.json");
        tautline_session::write_robot(&path, &robot.robot).expect("written");
        let text = std::fs::read_to_string(&path).expect("read");
        let mut value: Value = serde_json::from_str(&text).expect("JSON");
        change(&mut value);
        std::fs::write(&path, value.to_string()).expect("written");
        let mut harness = workbench();
        let state = &mut harness.state_mut().state;
        state.outbox.send(FileCommand::Open(path));
        harness.step();
        settle(&mut harness);
        assert!(
            harness.state().state.model.open.is_some(),
            "the robot opens"
        );
        Self { harness, folder }
    }

    /// The robot of the drawing.
    pub fn new() -> Self {
        Self::with_robot(|_| {})
    }

    /// Writes a table.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    }

    /// Types into the field of this name.
    pub fn type_into(&mut self, role: Role, name: &str, text: &str) {
        type_into(&mut self.harness, role, name, text);
        self.harness.run_ok();
    }

    /// Presses the button of this name.
    pub fn press(&mut self, name: &str) {
        self.harness
            .get_by_role_and_label(Role::Button, name)
            .scroll_to_me();
        self.harness.run_ok();
        self.harness
            .get_by_role_and_label(Role::Button, name)
            .click();
        settle(&mut self.harness);
    }

    /// Opens a part of a phase.
    pub fn open(&mut self, part: &str) {
        self.harness.get_by_role_and_label(Role::Tab, part).click();
        settle(&mut self.harness);
    }

    /// Imports a table by its typed path.
    pub fn import(&mut self, table: &str, path: &Path) {
        let path = path.to_str().expect("UTF-8");
        self.type_into(Role::TextInput, &format!("Path of {table}"), path);
        self.press("Import");
    }

    /// Whether an element whose name contains this text is shown.
    pub fn shows(&self, text: &str) -> bool {
        self.harness
            .query_all_by_label_contains(text)
            .next()
            .is_some()
    }

    /// The last message of the status bar.
    pub fn said(&self) -> &str {
        let messages = &self.harness.state().state.model.messages;
        messages.last().map_or("", |message| message.text.as_str())
    }

    /// The open session.
    pub fn session(&self) -> &tautline_session::Session {
        let document = self.harness.state().state.model.open.as_ref();
        document.expect("a session is open").session()
    }

    /// Name of the edit that undo would revert.
    pub fn next_undo(&self) -> Option<&str> {
        let document = self.harness.state().state.model.open.as_ref();
        document.expect("a session is open").history().next_undo()
    }

    /// Undoes.
    pub fn undo(&mut self) {
        let state = &mut self.harness.state_mut().state;
        state
            .outbox
            .send(tautline_workbench::model::command::Command::Undo);
        settle(&mut self.harness);
    }
}
