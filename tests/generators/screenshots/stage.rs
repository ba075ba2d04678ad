//! A workbench to take pictures of.

use anyhow::Result;
use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use image::RgbImage;
use tautline_session::Folders;
use tautline_workbench::model::Options;
use tautline_workbench::model::command::{Command, RobotCommand};
use tautline_workbench::shell::{App, AppState};

use crate::support::harness::{
    GlowTestRenderer, connect_and_arm, give, give_parameters, press, settle, wait,
};

/// Size of a window (points, and pixels as well).
pub const LARGE: [f32; 2] = [1440.0, 900.0];
/// Size of a small notebook's window.
pub const SMALL: [f32; 2] = [1280.0, 800.0];
/// Seed of the demonstration: always the same fault.
const DEMO_SEED: u64 = 3;
/// Speed of the simulated robot as a multiple of real time.
const ROBOT_SPEED: f64 = 60.0;

/// A workbench with files in a folder that lives as long as this.
pub struct Stage {
    harness: Harness<'static, App>,
    renderer: GlowTestRenderer,
    _folder: tempfile::TempDir,
}

impl Stage {
    /// A workbench as it starts for the first time.
    pub fn new(size: [f32; 2]) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let options = Options {
            folders: Some(Folders::below(folder.path())),
            demo_seed: Some(DEMO_SEED),
            robot_speed: Some(ROBOT_SPEED),
            ..Options::default()
        };
        let renderer = GlowTestRenderer::new()?;
        let mut harness = Harness::builder()
            .with_size(egui::Vec2::from(size))
            .with_max_steps(60)
            .renderer(renderer.clone())
            .build_eframe(|creation| App::new(creation, options));
        settle(&mut harness);
        Ok(Self {
            harness,
            renderer,
            _folder: folder,
        })
    }

    /// Gives a command and waits until all tasks have ended.
    pub fn give(&mut self, command: impl Into<Command>) {
        give(&mut self.harness, command);
    }

    /// Waits until nothing changes any more, also where the end of a task begins another one.
    pub fn settle(&mut self) {
        settle(&mut self.harness);
        settle(&mut self.harness);
    }

    /// The state of the program.
    pub fn state(&self) -> &AppState {
        &self.harness.state().state
    }

    /// Presses the element with this name and waits until all tasks have ended.
    pub fn press(&mut self, name: &str) {
        press(&mut self.harness, name);
    }

    /// Presses the first element whose name begins like this, and waits until all tasks have ended.
    pub fn press_first(&mut self, beginning: &str) {
        let found = self.harness.get_all_by_label_contains(beginning).next();
        found.expect("one at least").click_accesskit();
        self.harness.step();
        settle(&mut self.harness);
    }

    /// Presses the last enabled element with this name, and waits until all tasks have ended.
    pub fn press_named(&mut self, name: &str) {
        let mut found: Vec<_> = self.harness.query_all_by_label(name).collect();
        found.retain(|node| node.accesskit_node().role() != Role::Label);
        let last = found.pop();
        last.unwrap_or_else(|| panic!("no {name:?}"))
            .click_accesskit();
        self.harness.step();
        settle(&mut self.harness);
    }

    /// Shows a plot, if necessary from the menu of plots whose tabs have no room.
    pub fn press_tab(&mut self, title: &str) {
        if self
            .harness
            .query_by_role_and_label(Role::Button, title)
            .is_none()
        {
            self.press("More plots");
        }
        self.press_named(title);
    }

    /// Presses keys and waits until all tasks have ended.
    pub fn key(&mut self, modifiers: egui::Modifiers, key: egui::Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.step();
        settle(&mut self.harness);
    }

    /// Resizes the window (pixels), at a scale.
    pub fn resize(&mut self, size: [f32; 2], scale: f32) {
        self.harness.set_pixels_per_point(scale);
        // The scale changes with the next frame, and the size with it.
        self.harness.step();
        self.harness.set_size(egui::Vec2::from(size) / scale);
        settle(&mut self.harness);
    }

    /// Scrolls to the first element whose name begins like this; returns whether there is one.
    pub fn shows(&mut self, beginning: &str) -> bool {
        let found = self.harness.query_all_by_label_contains(beginning).next();
        let is_there = found.map(|found| found.scroll_to_me()).is_some();
        settle(&mut self.harness);
        is_there
    }

    /// Scrolls to the first element whose name begins like this.
    pub fn show(&mut self, beginning: &str) {
        let found = self.harness.get_all_by_label_contains(beginning).next();
        found.expect("one at least").scroll_to_me();
        settle(&mut self.harness);
    }

    /// Connects and arms the simulated robot.
    pub fn connect_and_arm(&mut self) {
        connect_and_arm(&mut self.harness);
    }

    /// Gives the simulated robot parameters for the effects of the model, and arms it again.
    pub fn give_parameters(&mut self) {
        give_parameters(&mut self.harness);
    }

    /// Writes the shown values under the name of an operator.
    pub fn confirm_write(&mut self, operator: &str) {
        let dialogs = &mut self.harness.state_mut().state.model.dialogs;
        if let Some(draft) = &mut dialogs.writing {
            operator.clone_into(&mut draft.operator);
        }
        self.give(RobotCommand::ConfirmWrite(true));
        self.wait("the values", |state| !state.model.link.writing);
    }

    /// Lets the workbench run until its state meets a condition.
    pub fn wait(&mut self, what: &str, reached: impl Fn(&AppState) -> bool) {
        wait(&mut self.harness, what, reached);
    }

    /// Picture of the present window.
    pub fn picture(&mut self) -> Result<RgbImage> {
        self.harness.run_ok();
        // The 3D view is complete one frame later.
        self.renderer.picture(&self.harness)?;
        self.harness.step();
        let picture = self.renderer.picture(&self.harness)?;
        Ok(image::DynamicImage::ImageRgba8(picture).into_rgb8())
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.harness.state_mut().state.views.destroy();
    }
}
