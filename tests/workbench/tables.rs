//! Tables of phases 1 and 2 with known values, and what tests of both phases do.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use serde_json::{Value, json};
use tautline_workbench::app::App;
use tautline_workbench::app::commands::FileCommand;

use crate::support::{settle, workbench};

/// Cable per revolution of a winch (m); the robot of the drawing has 0.12568 m.
pub fn per_revolution(cable: usize) -> f64 {
    0.125 + 1e-4 * cable as f64
}

/// Pairs whose residuals sum to zero and are orthogonal to the revolutions, so that the largest residual is
/// their amplitude: 0.02 mm, and 0.3 mm for `failing`.
pub fn winch_table(failing: Option<usize>) -> String {
    let mut text = "cable,rev,length_m\n".to_owned();
    for cable in 1..=8 {
        let amplitude = if failing == Some(cable) { 3e-4 } else { 2e-5 };
        for (rev, sign) in [(-3.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (3.0, 1.0)] {
            let length = per_revolution(cable) * rev + 0.5 + amplitude * sign;
            writeln!(text, "cable-{cable},{rev},{length}").expect("written");
        }
    }
    text
}

/// Gain 2.02 and bias 1.5 N on two cables, readings 0.2 N off.
pub fn force_table() -> String {
    let mut text = "cable,reading_n,load_n\n".to_owned();
    for (load, sign) in [(10.0, 1.0), (30.0, -1.0), (50.0, -1.0), (70.0, 1.0)] {
        let reading = 2.02 * load + 1.5 + 0.2 * sign;
        writeln!(text, "1,{reading},{load}\ncable-2,{reading},{load}").expect("written");
    }
    text
}

/// Three sensors look up, two and one sideways; the reference lies 0.3 m below the base frame.
pub fn home_platform() -> Value {
    let sensor = |origin: [f64; 3], direction: [f64; 3], plane: usize| json!({"origin_m": origin, "direction": direction, "plane": plane, "sd_m": 2e-4});
    let (up, x, y) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    json!({
        "base_from_reference": {"position_m": [0, 0, -0.3], "orientation_wxyz": [1, 0, 0, 0]},
        "sensors": [
            sensor([0.05, 0.04, 0.05], up, 0), sensor([-0.05, 0.04, 0.05], up, 0),
            sensor([0.0, -0.06, 0.05], up, 0), sensor([-0.2, 0.05, 0.3], x, 1),
            sensor([-0.2, -0.05, 0.3], x, 1), sensor([0.01, -0.2, 0.3], y, 2)],
        "planes": [
            {"normal": [0, 0, -1], "offset_m": 0.06}, {"normal": [-1, 0, 0], "offset_m": 0.07},
            {"normal": [0, -1, 0], "offset_m": 0.08}]})
}

/// The platform stands at (1, 2, 3) mm in the base frame; in two repeats it is 0.1 mm above and below.
pub fn home_table() -> String {
    let mut text = "sensor,reading\n".to_owned();
    for up in [1e-4, -1e-4] {
        let bottom = 0.003 + 0.3 - 0.06 - 0.05 + up;
        let sides = [0.001 - 0.07 + 0.2, 0.002 - 0.08 + 0.2];
        let distances = [bottom, bottom, bottom, sides[0], sides[0], sides[1]];
        for (k, distance) in distances.iter().enumerate() {
            writeln!(text, "{},{distance}", k + 1).expect("written");
        }
    }
    text
}

/// `length tension / 4e4 N`, so of degree 2; errors of 5 micrometres without a pattern.
pub fn elongation_table() -> String {
    let mut text = "length_m,tension_n,elongation_m\n".to_owned();
    let mut state = 1_u32;
    for step in 0..8 {
        for tension in (10..=80).step_by(10) {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let error = 1e-5 * (f64::from(state) / f64::from(u32::MAX) - 0.5);
            let length = 1.0 + 0.25 * f64::from(step);
            let elongation = length * f64::from(tension) / 4e4 + error;
            writeln!(text, "{length},{tension},{elongation}").expect("written");
        }
    }
    text
}

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
        assert!(harness.state().state.document.is_some(), "the robot opens");
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
        self.harness.get_by_role_and_label(role, name).focus();
        self.harness.run_ok();
        self.harness
            .get_by_role_and_label(role, name)
            .type_text(text);
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

    /// Whether something of this name, or with it in its name, is shown.
    pub fn shows(&self, text: &str) -> bool {
        self.harness
            .query_all_by_label_contains(text)
            .next()
            .is_some()
    }

    /// What the status bar says last.
    pub fn said(&self) -> &str {
        let messages = &self.harness.state().state.messages;
        messages.last().map_or("", |message| message.text.as_str())
    }

    /// The open session.
    pub fn session(&self) -> &tautline_session::Session {
        let document = self.harness.state().state.document.as_ref();
        document.expect("a session is open").session()
    }

    /// Name of what undo would undo.
    pub fn next_undo(&self) -> Option<&str> {
        let document = self.harness.state().state.document.as_ref();
        document.expect("a session is open").history().next_undo()
    }

    /// Undoes.
    pub fn undo(&mut self) {
        let state = &mut self.harness.state_mut().state;
        state
            .outbox
            .send(tautline_workbench::app::command::Command::Undo);
        settle(&mut self.harness);
    }
}
