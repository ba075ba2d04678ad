//! Which sensor: sliders, and an answer at once.

use egui::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_workbench::model::command::ViewCommand;
use tautline_workbench::model::phase::Screen;

use crate::measured::{give, press};
use crate::support::{settle, workbench};

#[test]
fn the_answer_follows_the_sliders() {
    let mut harness = workbench();
    give(&mut harness, ViewCommand::Go(Screen::WhichSensor));
    settle(&mut harness);
    let answer = |harness: &egui_kittest::Harness<'_, tautline_workbench::shell::App>| {
        let said = harness.get_by_label_contains("the platform is off by");
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
    press(&mut harness, "Copy as study file");
    press(&mut harness, "Back");
    assert_eq!(harness.state().state.model.screen, Screen::Start);
}
