//! The model doctor.

use egui_kittest::kittest::Queryable;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::{Session, Timestamp, read_session};
use tautline_workbench::model::command::{Command, IdentificationCommand};
use tautline_workbench::model::phase::Phase;
use tautline_workbench::shell::AppState;

use crate::demo::Bench;
use crate::measured::{Measured, document, give, press};
use crate::support::settle;

/// The button that asks.
const ASK: &str = "Diagnose model";

fn effects(state: &AppState) -> Vec<String> {
    let document = state.model.open.as_ref().expect("a session");
    let effects = &document.session().settings.identification.effects;
    effects
        .iter()
        .map(|setting| setting.effect.clone())
        .collect()
}

#[test]
fn clean_data_have_no_cards() {
    // One of a hundred clean datasets has a finding; that of this seed has none.
    let measured = Measured::mini(25, &[]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    press(&mut harness, ASK);
    harness.get_by_label("The model explains the readings of 26 poses.");
    assert!(harness.query_by_label_contains("Add to model").is_none());
    harness.get_by_label("Diagnosis finished: nothing was found.");
    harness.get_by_label_contains("No finding does not mean no fault");
    press(&mut harness, "Not detectable with these poses");
    harness.get_by_label_contains("These poses cannot reveal");
    let record = document(&harness)
        .session()
        .results()
        .last()
        .expect("a result");
    assert_eq!(record.format(), Some("tautline-diagnosis"));
}

#[test]
fn a_cause_is_named_added_removed_and_undone() {
    let measured = Measured::mini(40, &[("winch_scale", "cable-3", &[("scale", 0.02)])]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    harness.get_by_label("The model does not explain the data.");
    press(&mut harness, ASK);
    harness.get_by_label("1. Winch scale (cable-3)");
    harness.get_by_label_contains("Size: ");
    harness.get_by_label_contains("95 % interval: ");
    let found = &document(&harness)
        .diagnosis()
        .expect("a diagnosis")
        .diagnosis
        .findings[0];
    let size = &found.parameters[0];
    let sd = size.sd.expect("a standard deviation");
    // Outside of five standard deviations once in a million times.
    assert!((size.value - 0.02).abs() < 5.0 * sd, "{size:?}");
    harness.get_by_label_contains("Held-out poses:");
    harness.get_by_label_contains("Evidence of finding 1: ");
    press(&mut harness, "Add to model: Winch scale (cable-3)");
    assert_eq!(effects(&harness.state().state), ["winch_scale"]);
    harness.get_by_label("The model explains the data.");
    harness.get_by_label_contains("Last change: add Winch scale (cable-3) to the model");
    let fit = document(&harness).fit().expect("a fit");
    let explained = &document(&harness)
        .diagnosis()
        .expect("a diagnosis")
        .diagnosis;
    // The same problem, solved in the same way.
    let difference = (fit.solution.chi2 - explained.extended_solution.chi2).abs();
    assert!(difference < 0.1, "{difference}");
    // The diagnosis stays until its findings are in.
    harness.get_by_label("1. Winch scale (cable-3)");
    harness.get_by_label("In the model");
    press(&mut harness, "Remove Winch scale (cable-3) from model");
    assert!(document(&harness).diagnosis_is_current());
    assert!(effects(&harness.state().state).is_empty());
    press(
        &mut harness,
        "Undo: remove Winch scale (cable-3) from the model",
    );
    assert_eq!(effects(&harness.state().state), ["winch_scale"]);
    press(&mut harness, "Undo: add Winch scale (cable-3) to the model");
    assert!(effects(&harness.state().state).is_empty());
    assert!(
        document(&harness).diagnosis_is_current(),
        "the model is what was asked about"
    );
    press(&mut harness, "Redo: add Winch scale (cable-3) to the model");
    assert_eq!(effects(&harness.state().state), ["winch_scale"]);
    assert!(document(&harness).fit_is_current());
    harness.get_by_label("The model explains the data.");
    press(&mut harness, ASK);
    harness.get_by_label("The model explains the readings of 41 poses.");
    assert!(harness.query_by_label("1. Winch scale (cable-3)").is_none());
    press(&mut harness, "Undo: add Winch scale (cable-3) to the model");
    // Its diagnosis comes back.
    harness.get_by_label("1. Winch scale (cable-3)");
    assert!(document(&harness).is_model_diagnosed());
}

#[test]
fn causes_that_cannot_be_separated_share_a_card_with_poses_for_the_plan() {
    let slip: &[(&str, f64)] = &[("step", 0.02), ("pose", 25.0)];
    let measured = Measured::mini(25, &[("cable_slip", "cable-3", slip)]);
    let mut harness = measured.opened();
    press(&mut harness, "Model doctor");
    press(&mut harness, ASK);
    harness.get_by_label_contains("These data cannot distinguish the causes below");
    harness.get_by_label_contains("Separating pose 1:");
    press(&mut harness, "Add these poses to the plan");
    let plan = &document(&harness).session().plan;
    assert!(!plan.is_empty());
    assert_eq!(plan[0].label, 26, "the first label that is free");
    harness.get_by_label_contains("These poses are in the plan");
    assert!(
        document(&harness).diagnosis_is_current(),
        "a plan changes no result"
    );
    let added = plan.len();
    press(
        &mut harness,
        &format!("Undo: add {added} poses to the plan"),
    );
    assert!(document(&harness).session().plan.is_empty());
    let chosen = harness.get_all_by_label_contains("Add to model:").next();
    chosen.expect("an alternative").click_accesskit();
    harness.step();
    settle(&mut harness);
    assert_eq!(effects(&harness.state().state).len(), 1);
    assert!(document(&harness).fit_is_current());
}

#[test]
fn a_diagnosis_that_is_cancelled_finds_nothing() {
    let measured = Measured::mini(25, &[]);
    let mut harness = measured.opened();
    let state = &mut harness.state_mut().state;
    state.outbox.send(IdentificationCommand::Diagnose);
    state.outbox.send(IdentificationCommand::Stop);
    settle(&mut harness);
    settle(&mut harness);
    assert!(document(&harness).diagnosis().is_none());
    give(&mut harness, IdentificationCommand::Diagnose);
    assert!(document(&harness).diagnosis().is_some());
}

#[test]
fn an_error_without_a_name_gets_a_pattern_that_extends_the_model_and_can_be_undone() {
    let measured = Measured::unnamed();
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    press(&mut harness, ASK);
    press(&mut harness, "What does it look like?");
    harness.get_by_label_contains("None of them is a cause");
    let extend = "Extend the model by position_z * wrap (cable-3)";
    press(&mut harness, extend);
    let pattern = "pattern_paid_position_z_wrap";
    assert_eq!(effects(&harness.state().state), [pattern]);
    harness.get_by_label("The model explains the data.");
    give(&mut harness, Command::Undo);
    assert!(effects(&harness.state().state).is_empty());
    let robot = &document(&harness).session().robot;
    assert!(robot.hypotheses.is_empty());
}

#[test]
fn mistakes_are_corrected_in_a_copy_and_the_session_keeps_what_was_recorded() {
    let robot = presets::find("mini").expect("a preset").robot;
    let run = simulate(&robot, &SimulationOptions::new(25, 6)).expect("a run");
    let mut session = Session::new("MINI", robot, Timestamp::from_unix_seconds(0));
    session.measurements = run.dataset.measurements;
    let right = session.measurements.clone();
    for row in 0..right.len() {
        let turns = -right.revolutions.get(row, 4);
        session.measurements.revolutions.set(row, 4, turns);
    }
    let recorded = session.measurements.clone();
    let mut bench = Bench::of_session(&session);
    bench.go(Phase::Identification);
    bench.press(&format!("Next: {ASK}"));
    bench.settle("a diagnosis");
    bench.harness.get_by_label_contains("its sign is reversed");
    bench.press("Next: Correct a copy of the session");
    bench.wait("the copy", |state| {
        let open = state.model.open.as_ref();
        open.is_some_and(|open| open.session().name == "MINI, corrected")
    });
    // A sign turned twice is exactly what it was.
    assert_eq!(bench.session().measurements.revolutions, right.revolutions);
    let file = bench.folder.path().join("session.json");
    let kept = read_session(&file).expect("the file").value;
    assert_eq!(kept.measurements.revolutions, recorded.revolutions);
    bench.go(Phase::Identification);
    bench.press("Next: Identify the pulleys");
    bench.settle("an identification");
    let open = bench.state().model.open.as_ref();
    let fit = open.and_then(|open| open.current_fit()).expect("a fit");
    // Sound readings would fit worse once in a million times.
    assert!(fit.solution.p_value().is_some_and(|p| p > 1e-6));
}
