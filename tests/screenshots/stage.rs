//! A workbench to take pictures of.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use image::RgbImage;
use tautline_session::Folders;
use tautline_workbench::app::command::Command;
use tautline_workbench::app::{App, Options, State};

use crate::harness::{GlowTestRenderer, PATIENCE, give, press, settle};

/// Size of a window (points, and pixels as well).
pub const LARGE: [f32; 2] = [1440.0, 900.0];
/// Size of a small notebook's window.
pub const SMALL: [f32; 2] = [1280.0, 800.0];
/// Seed of the demonstration: always the same fault.
const DEMO_SEED: u64 = 3;
/// How much faster than real the simulated robot moves.
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

    /// Gives a command and waits until all is done.
    pub fn give(&mut self, command: impl Into<Command>) {
        give(&mut self.harness, command);
    }

    /// Presses what has this name and waits until all is done.
    pub fn press(&mut self, name: &str) {
        press(&mut self.harness, name);
    }

    /// Presses the first that has a name beginning like this, and waits until all is done.
    pub fn press_first(&mut self, beginning: &str) {
        let found = self.harness.get_all_by_label_contains(beginning).next();
        found.expect("one at least").click_accesskit();
        self.harness.step();
        settle(&mut self.harness);
    }

    /// Scrolls to the first that has a name beginning like this.
    pub fn show(&mut self, beginning: &str) {
        let found = self.harness.get_all_by_label_contains(beginning).next();
        found.expect("one at least").scroll_to_me();
        settle(&mut self.harness);
    }

    /// Connects and arms the simulated robot.
    pub fn connect_and_arm(&mut self) -> Result<()> {
        self.press("Connect the simulated robot");
        self.wait("a connection", |state| state.link.is_connected())?;
        self.press("Arm");
        self.wait("arming", |state| state.link.is_armed())
    }

    /// Lets the workbench run until its state is as wanted.
    pub fn wait(&mut self, what: &str, reached: impl Fn(&State) -> bool) -> Result<()> {
        let start = Instant::now();
        while !reached(&self.harness.state().state) {
            if start.elapsed() > 4 * PATIENCE {
                let last = self.harness.state().state.messages.last();
                bail!("{what} does not come; the last message is {last:?}");
            }
            // The thread of the controller needs the processor more than the pictures do.
            std::thread::sleep(Duration::from_millis(20));
            self.harness.step();
        }
        self.harness.run_ok();
        Ok(())
    }

    /// What one would see now.
    pub fn picture(&mut self) -> Result<RgbImage> {
        self.harness.run_ok();
        // What is drawn in three dimensions is known a frame later.
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
