//! Which sensor: sliders, and an answer at once; a study for the rest.

use std::time::{Duration, Instant};

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_workbench::model::command::{SIMULATING, ViewCommand};
use tautline_workbench::model::phase::Screen;
use tautline_workbench::shell::App;

use crate::measured::{give, press};
use crate::support::{settle, type_into, workbench};

#[test]
fn the_answer_follows_the_sliders() {
    let mut harness = workbench();
    give(&mut harness, ViewCommand::Go(Screen::WhichSensor));
    settle(&mut harness);
    let answer = |harness: &Harness<'_, App>| {
        let said = harness.get_by_label_contains("the position error of the platform is");
        said.accesskit_node().value().expect("a text")
    };
    let before = answer(&harness);
    assert!(
        before.starts_with("With 25 poses and a laser of 0.3 mm (1 sd)"),
        "{before}"
    );
    harness.get_by_label("Position error over the laser");
    harness.get_by_label("Position error over the number of poses");
    // Without a laser the error is larger, and there is nothing to draw over it.
    harness
        .get_by_role_and_label(Role::CheckBox, "Laser")
        .click();
    settle(&mut harness);
    assert!(answer(&harness).starts_with("With 25 poses and no laser"));
    assert!(
        harness
            .query_by_label("Position error over the laser")
            .is_none()
    );
    press(&mut harness, "Back");
    assert_eq!(harness.state().state.model.screen, Screen::Start);
}

/// Waits for the study that is being simulated.
fn simulated(harness: &mut Harness<'_, App>) {
    let began = Instant::now();
    while harness.state().state.model.tasks.runs(SIMULATING) {
        assert!(began.elapsed() < Duration::from_secs(120), "no end");
        harness.step();
    }
    settle(harness);
}

#[test]
fn a_question_becomes_a_study_that_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("study");
    let mut harness = workbench();
    give(&mut harness, ViewCommand::Go(Screen::WhichSensor));
    settle(&mut harness);
    let (name, text) = ("Folder of the study", folder.display().to_string());
    type_into(&mut harness, Role::TextInput, name, &text);
    harness.get_by_label("Simulate").click();
    harness.step();
    harness.step();
    harness.get_by_label("Cancel: Simulating").click();
    simulated(&mut harness);
    let said = |harness: &Harness<'_, App>| {
        let last = harness.state().state.model.messages.last();
        last.map(|message| message.text.clone()).unwrap_or_default()
    };
    assert!(
        said(&harness).starts_with("cancelled"),
        "{}",
        said(&harness)
    );
    // The file of the study exists and has the values of the sliders.
    let text = std::fs::read_to_string(folder.join("study.toml")).unwrap();
    assert!(text.contains("poses = [12, 25, 100]"), "{text}");
}
