//! The workbench without a window, driven by accessible names: for tests and screenshots.

mod renderer;
mod robot;

use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use tautline_workbench::model::command::Command;
use tautline_workbench::shell::App;

pub use renderer::GlowTestRenderer;
pub use robot::{connect_and_arm, give_parameters, wait, words};

/// Time limit of a task.
const PATIENCE: Duration = Duration::from_secs(600);

/// Lets the workbench run until no task is running and nothing changes any more.
///
/// # Panics
/// If a task does not end.
pub fn settle(harness: &mut Harness<'_, App>) {
    let start = Instant::now();
    // Long tasks need the processor more than the pictures do.
    let mut pause = Duration::from_millis(2);
    loop {
        harness.step();
        if harness.state().state.model.tasks.running().is_empty() {
            break;
        }
        assert!(start.elapsed() < PATIENCE, "a task does not end");
        std::thread::sleep(pause);
        pause = (2 * pause).min(Duration::from_millis(200));
    }
    harness.run_ok();
}

/// Gives a command and waits until all tasks have ended.
pub fn give(harness: &mut Harness<'_, App>, command: impl Into<Command>) {
    harness.state_mut().state.outbox.send(command);
    settle(harness);
}

/// Presses the element with this name, even if it is scrolled away, and waits until all tasks have ended.
pub fn press(harness: &mut Harness<'_, App>, name: &str) {
    harness.get_by_label(name).click_accesskit();
    harness.step();
    settle(harness);
}
