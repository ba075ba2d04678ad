//! The simulated robot of a workbench: waiting for it, and preparing it.

use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use tautline_workbench::shell::{App, AppState};

use super::{PATIENCE, press};

/// Lets the workbench run until its state meets a condition.
///
/// # Panics
/// If that does not happen.
pub fn wait(harness: &mut Harness<'_, App>, what: &str, reached: impl Fn(&AppState) -> bool) {
    let start = Instant::now();
    while !reached(&harness.state().state) {
        assert!(
            start.elapsed() < PATIENCE,
            "{what} does not come; the last message is {:?}; the screen says {:?}",
            harness.state().state.model.messages.last(),
            words(harness)
        );
        // The thread of the controller needs the processor more than the pictures do.
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    harness.step();
}

/// Connects and arms by the buttons.
///
/// # Panics
/// If there are none, or the controller does not answer.
pub fn connect_and_arm(harness: &mut Harness<'_, App>) {
    press(harness, "Connect the simulated robot");
    wait(harness, "a connection", |state| {
        state.model.link.is_connected()
    });
    arm(harness);
}

/// Gives the controller parameters for the effects of the model, so that they can be written.
///
/// # Panics
/// If it has them already, or does not answer.
pub fn give_parameters(harness: &mut Harness<'_, App>) {
    press(harness, "Add these parameters to the simulated controller");
    wait(harness, "a controller that corrects effects", |state| {
        let mut held = state.model.link.parameters.iter();
        held.any(|p| p.name.starts_with("effect.")) && state.model.link.is_armed()
    });
}

fn arm(harness: &mut Harness<'_, App>) {
    press(harness, "Arm");
    wait(harness, "arming", |state| state.model.link.is_armed());
}

/// All texts on the screen.
#[must_use]
pub fn words(harness: &Harness<'_, App>) -> Vec<String> {
    let nodes = harness.root().children_recursive();
    nodes
        .filter_map(|node| node.accesskit_node().value())
        .collect()
}
