//! The panel of phase 4: the geometry.

use egui_kittest::kittest::Queryable;
use tautline_session::Method;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{FileCommand, IDENTIFYING, IdentificationCommand};
use tautline_workbench::model::edit::Edit;

use crate::measured::{Measured, document, give, press};
use crate::support::{settle, workbench};

#[test]
fn identifying_says_whether_the_model_explains_the_data() {
    let measured = Measured::mini(20, &[]);
    let mut harness = measured.opened();
    assert!(document(&harness).fit().is_none());
    press(&mut harness, "Identify");
    harness.get_by_label("The model explains the data.");
    assert!(document(&harness).fit_is_current());
    let fit = document(&harness).fit().expect("a fit");
    assert!(fit.solution.converged());
    let record = &document(&harness).session().results()[0];
    assert_eq!(record.format(), Some("tautline-identification"));
    assert_eq!(record.basis, Some(document(&harness).session().basis()));
}

#[test]
fn a_row_selects_its_cable_and_shows_the_coordinates() {
    let measured = Measured::mini(12, &[]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    assert!(harness.query_by_label_contains("Cable 3 x:").is_none());
    harness
        .get_by_label_contains("Cable 3: moved")
        .click_accesskit();
    settle(&mut harness);
    assert_eq!(harness.state().state.model.selection, Selection::cable(2));
    harness.get_by_label_contains("Cable 3 x:");
    assert!(harness.query_by_label_contains("Cable 4 x:").is_none());
    press(&mut harness, "Show axes");
    harness.get_by_label_contains("Cable 4 z:");
}

#[test]
fn the_published_method_is_shown_beside_the_joint_one() {
    let measured = Measured::mini(15, &[]);
    let mut harness = measured.opened();
    press(&mut harness, "Published");
    press(&mut harness, "Identify");
    harness.get_by_label_contains("The published method leaves residuals of");
    let record = &document(&harness).session().results()[0];
    assert_eq!(record.document.value()["method"], "published");
    let settings = &document(&harness).session().settings;
    assert_eq!(settings.identification.method, Method::Published);
}

#[test]
fn a_suspicious_pose_is_excluded_and_included_again() {
    let outlier: &[(&str, f64)] = &[("error", 0.03), ("pose", 7.0)];
    let measured = Measured::mini(20, &[("encoder_outlier", "cable-2", outlier)]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    harness.get_by_label("The model does not explain the data.");
    press(&mut harness, "Exclude pose 7");
    harness.get_by_label("The model explains the data.");
    harness.get_by_label_contains("Last change: exclude pose 7");
    assert!(document(&harness).session().excluded().contains(&7));
    press(&mut harness, "Include pose 7");
    harness.get_by_label("The model does not explain the data.");
    press(&mut harness, "Undo: include pose 7");
    harness.get_by_label("The model explains the data.");
}

#[test]
fn an_identification_that_is_cancelled_changes_nothing() {
    let measured = Measured::mini(20, &[]);
    let mut harness = measured.opened();
    let state = &mut harness.state_mut().state;
    state.outbox.send(IdentificationCommand::Identify);
    state.outbox.send(IdentificationCommand::Stop);
    settle(&mut harness);
    settle(&mut harness);
    assert!(document(&harness).fit().is_none());
    let last = harness
        .state()
        .state
        .model
        .messages
        .last()
        .map(|m| m.text.clone());
    assert_eq!(
        last.as_deref(),
        Some("Identification was stopped; nothing has changed.")
    );
}

#[test]
fn a_session_that_was_identified_shows_it_again() {
    let measured = Measured::mini(12, &[]);
    let path = measured.beside("session.json");
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    give(&mut harness, FileCommand::SaveAs(path.clone()));
    let mut again = workbench();
    give(&mut again, FileCommand::Open(path.clone()));
    settle(&mut again);
    assert!(document(&again).fit_is_current());
    assert_eq!(
        document(&again).session().results().len(),
        1,
        "no second result"
    );
    give(&mut again, Edit::Exclude(5));
    give(&mut again, Edit::SetMethod(Method::Simple));
    assert!(!document(&again).fit_is_current());
    give(&mut again, FileCommand::SaveAs(path.clone()));
    let mut third = workbench();
    give(&mut third, FileCommand::Open(path));
    settle(&mut third);
    assert!(document(&third).fit().is_none());
    third.get_by_label("The result in this session belongs to other data: identify again.");
    assert!(!third.state().state.model.tasks.runs(IDENTIFYING));
}

#[test]
fn a_session_without_poses_says_how_to_get_them() {
    let measured = Measured::mini(2, &[]);
    let mut harness = workbench();
    give(
        &mut harness,
        FileCommand::Open(measured.beside("mini/robot.json")),
    );
    let panel = tautline_workbench::model::phase::Screen::Phase(
        tautline_workbench::model::phase::Phase::Identification,
    );
    give(
        &mut harness,
        tautline_workbench::model::command::ViewCommand::Go(panel),
    );
    harness.get_by_label_contains("Pulley positions and a diagnosis of the model appear here");
}

#[test]
fn readings_are_checked_before_identification() {
    let measured = Measured::mini(20, &[]);
    let mut harness = measured.opened();
    harness.get_by_label_contains("Readings complete: 20 poses");
    harness.get_by_label_contains("Readings plausible: Changes of length");
    press(&mut harness, "Check geometry and faults");
    harness.get_by_label_contains("Geometry determined: The readings determine all");
    harness.get_by_label_contains("Faults visible: At typical size these poses show");
    press(&mut harness, "Show faults");
    harness.get_by_label_contains("Winch scale. Winch scale of cable-");
    press(&mut harness, "Hide faults");
    assert!(
        harness
            .query_by_label_contains("Winch scale. Winch scale of cable-")
            .is_none()
    );
}
