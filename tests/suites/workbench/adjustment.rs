//! The phase Adjustment on a simulated robot.

use std::path::Path;

use egui::{Event, Key, Modifiers, Role, pos2};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::accuracy::iso9283::{Target, pose_accuracy};
use tautline_core::effect::{self, EffectSetting};
use tautline_core::geometry::Pose;
use tautline_session::{CheckKind, CheckPose, Outcome, Stage, Verification};
use tautline_validation::support::harness::give_parameters;
use tautline_workbench::model::command::{
    Answer, Command, Export, FileCommand, IdentificationCommand, RobotCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::link::LinkRequest;
use tautline_workbench::model::phase::Phase;
use tautline_workbench::model::phase_status;

use crate::demo::Bench;

/// Mean distance from the commanded poses (m), by its definition.
fn mean_error_m(run: &Verification) -> f64 {
    let pose = |pose: &CheckPose| {
        Pose::from_parts(
            pose.position_m,
            pose.orientation_wxyz.expect("it is measured"),
        )
    };
    let poses = run.rows.iter().filter(|row| row.kind == CheckKind::Pose);
    let mut targets: Vec<(String, Target)> = Vec::new();
    for row in poses {
        let attained = pose(&row.attained);
        match targets.iter_mut().find(|(name, _)| *name == row.target) {
            Some((_, target)) => target.attained.push(attained),
            None => targets.push((
                row.target.clone(),
                Target {
                    commanded: pose(&row.commanded),
                    attained: vec![attained],
                },
            )),
        }
    }
    let targets: Vec<Target> = targets.into_iter().map(|(_, target)| target).collect();
    pose_accuracy(&targets).expect("figures").mean_accuracy_m
}

fn verify(bench: &mut Bench, button: &str, runs: usize) {
    bench.press(button);
    bench.wait("a verification", |state| {
        let document = state.model.open.as_ref().expect("a session");
        document.session().verifications().len() == runs
    });
}

/// The row of the fault has its title, its cable and a unit, and nothing of it is cut.
fn effect_is_readable(bench: &Bench) {
    let fault = &bench.session().settings.identification.effects[0];
    let title = effect::find(&fault.effect).expect("an effect").title();
    let row = format!("{title}, {}, ", fault.targets[0]);
    let row = bench.harness.get_by_label_contains(&row);
    let name = row.accesskit_node().label().expect("a name");
    assert!(name.contains(", %"), "{name}");
    let window = bench.harness.ctx.content_rect();
    assert!(window.contains_rect(row.rect()), "{:?}", row.rect());
}

#[test]
fn writing_identified_values_improves_the_accuracy() {
    let mut bench = Bench::demo(3);
    bench.go(Phase::Adjustment);
    bench
        .harness
        .get_by_label_contains("no poses are measured yet");
    bench.press("Next: Go to measuring");
    assert_eq!(bench.measure(25), 26);
    bench.go(Phase::Adjustment);
    bench.harness.get_by_label_contains("not identified yet");
    verify(&mut bench, "Measure before", 1);
    // The effect that a diagnosis would name; without it the pulleys alone would have to explain the fault.
    let simulator = bench.session().simulator.clone().expect("a demonstration");
    let fault = simulator.truth.effects[0].clone();
    bench.give(Edit::AddEffects(vec![fault], "add the fault".into()));
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    give_parameters(&mut bench.harness);
    effect_is_readable(&bench);
    bench.write_values();
    let written = bench
        .session()
        .adjustments()
        .last()
        .expect("a record")
        .clone();
    assert_eq!(written.outcome, Outcome::Written);
    assert!(written.changes.len() >= 24, "{}", written.changes.len());
    let held = &bench.state().model.link.parameters;
    for change in &written.changes {
        let now = held
            .iter()
            .find(|p| p.name == change.name)
            .expect("it is there");
        assert!((now.value - change.after).abs() < 1e-9, "{}", change.name);
    }
    bench
        .harness
        .get_by_label_contains("The controller holds the identified values");
    let document = bench.state().model.open.as_ref().expect("a session");
    assert!(document.fit_is_current(), "writing changes no data");
    verify(&mut bench, "Measure after", 2);
    let runs = bench.session().verifications();
    assert_eq!(
        (runs[0].stage, runs[1].stage),
        (Stage::Before, Stage::After)
    );
    let [before, after] = [mean_error_m(&runs[0]), mean_error_m(&runs[1])];
    assert!(after < 0.7 * before, "{before} m before, {after} m after");
    bench.harness.get_by_label_contains(" before, ");

    for (export, name) in [
        (Export::Differences, "a.csv"),
        (Export::StructuredText, "a.st"),
    ] {
        let path = bench.folder.path().join(name);
        bench.give(RobotCommand::Export(export, path.clone()));
        bench.settle("a file");
        let text = std::fs::read_to_string(path).expect("written");
        assert!(text.contains("entry_point"), "{text}");
    }
    bench.press("Reveal the hidden fault");
    bench.harness.get_by_label_contains("Hidden: ");
    bench.press("Roll back");
    bench.wait("the old values", |state| !state.model.link.writing);
    let last = bench.session().adjustments().last().expect("a record");
    assert_eq!(last.outcome, Outcome::RolledBack);
    let held = &bench.state().model.link.parameters;
    for change in &written.changes {
        let now = held
            .iter()
            .find(|p| p.name == change.name)
            .expect("it is there");
        assert!((now.value - change.before).abs() < 1e-9, "{}", change.name);
    }
    // Without a connection the table has the values that the session recorded.
    bench.give(LinkRequest::Disconnect);
    bench.give(FileCommand::Answer(Answer::Discard));
    bench.wait("no controller", |state| !state.model.link.is_connected());
    let review = bench.state().model.review();
    for change in &written.changes {
        let mut lines = review.lines.iter();
        let line = lines.find(|line| line.name == change.name);
        let recorded = line
            .and_then(|line| line.controller)
            .expect("it is recorded");
        assert!((recorded - change.before).abs() < 1e-9, "{}", change.name);
    }
}

/// The sample with a winch that pays out too much, in phase 5, and its cause.
fn sample() -> (Bench, EffectSetting) {
    let session = "../sessions/mini-winch-scale/session.json";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(session);
    let session = tautline_session::read_session(&path)
        .expect("a session")
        .value;
    let mut bench = Bench::of_session(&session);
    bench.give(IdentificationCommand::Stop);
    bench.go(Phase::Adjustment);
    let simulator = session.simulator.expect("a simulated robot");
    (bench, simulator.truth.effects[0].clone())
}

fn connect(bench: &mut Bench) {
    bench.give(RobotCommand::ConnectAndArm);
    bench.wait("arming", |state| state.model.link.is_armed());
    bench.harness.run_ok();
}

fn identify_with(bench: &mut Bench, cause: EffectSetting) {
    bench.give(Edit::AddEffects(vec![cause], "add the winch".into()));
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    bench.go(Phase::Adjustment);
    bench.harness.run_ok();
}

/// The sample with the cause in the model, and an armed controller that can correct it.
fn winch_scale() -> Bench {
    let (mut bench, cause) = sample();
    identify_with(&mut bench, cause);
    connect(&mut bench);
    bench
}

fn controller_values(bench: &Bench) -> Vec<(String, f64)> {
    let held = bench.state().model.link.parameters.iter();
    held.map(|held| (held.name.clone(), held.value)).collect()
}

#[test]
fn what_is_written_is_the_list_that_was_shown() {
    let mut bench = winch_scale();
    let before = controller_values(&bench);
    bench.press("Write to the controller");
    bench.harness.run_ok();
    let shown = bench
        .state()
        .model
        .dialogs
        .writing
        .clone()
        .expect("a question");
    let scale = "Winch scale, cable-3";
    let lines = bench.harness.query_all_by_label_contains(scale).count();
    assert!(
        shown.doubts.is_empty() && lines > 1,
        "{:?}, {lines}",
        shown.doubts
    );
    // Undo is not for the screen behind the question.
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::Z);
    bench.harness.step();
    bench.settle("nothing");
    assert_eq!(bench.session().settings.identification.effects.len(), 1);
    // Something else that changes the model meanwhile.
    bench.give(Command::Undo);
    bench.settle("an identification without the winch");
    bench.name_operator("Ada");
    bench.harness.key_press(Key::Enter);
    bench.harness.step();
    bench.harness.step();
    bench
        .harness
        .get_by_label_contains("Nothing was written: model, session or controller changed");
    assert!(!bench.state().model.link.writing && bench.session().adjustments().is_empty());
    assert_eq!(controller_values(&bench), before);
    bench.give(Command::Redo);
    bench.settle("an identification with the winch");
    bench.press("Write to the controller");
    bench.harness.run_ok();
    // The name is still there, and Enter confirms.
    bench.harness.key_press(Key::Enter);
    bench.wait("the values", |state| {
        let open = state.model.open.as_ref().expect("a session");
        let last = open.session().adjustments().last();
        last.is_some_and(|last| last.outcome != Outcome::Begun)
    });
    let written = bench.session().adjustments()[0].clone();
    let named = |name: &str, value: f64| (name.to_owned(), value);
    let changes = written
        .changes
        .iter()
        .map(|change| named(&change.name, change.after));
    let list = shown.review.values_to_write();
    assert_eq!(changes.collect::<Vec<_>>(), list);
    assert_eq!(
        (written.operator.as_str(), written.outcome),
        ("Ada", Outcome::Written)
    );
}

#[test]
fn a_name_is_kept_when_the_question_is_left() {
    let mut bench = winch_scale();
    bench.press("Write to the controller");
    bench.harness.run_ok();
    bench.harness.event(Event::Text("Ada".to_owned()));
    bench.harness.run_ok();
    bench.harness.drag_at(pos2(4.0, 1200.0));
    bench.harness.drop_at(pos2(4.0, 1200.0));
    bench.harness.run_ok();
    assert!(bench.state().model.dialogs.writing.is_none());
    assert!(bench.session().adjustments().is_empty());
    bench.press("Write to the controller");
    bench.harness.run_ok();
    let field = bench
        .harness
        .get_by_role_and_label(Role::TextInput, "Operator");
    assert_eq!(field.accesskit_node().value().as_deref(), Some("Ada"));
}

#[test]
fn an_effect_taken_out_of_the_model_is_taken_out_of_the_controller() {
    let mut bench = winch_scale();
    bench.write_values();
    let name = "effect.winch_scale.cable-3.scale";
    let held = |bench: &Bench| {
        let mut values = controller_values(bench).into_iter();
        values
            .find(|(held, _)| held == name)
            .expect("a parameter")
            .1
    };
    assert!((held(&bench) - 0.02).abs() < 2e-3, "{}", held(&bench));
    let status = |bench: &Bench| {
        let model = &bench.state().model;
        let open = model.open.as_ref().expect("a session");
        phase_status::of(model, open, Phase::Adjustment).line
    };
    assert_eq!(status(&bench), "written, not verified");
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::Z);
    bench.harness.step();
    bench.settle("an identification without the winch");
    bench.harness.run_ok();
    bench.harness.get_by_label_contains("none: 0");
    let holds = "The controller holds the identified values";
    assert!(bench.harness.query_by_label_contains(holds).is_none());
    assert!(
        status(&bench).ends_with(" values not written"),
        "{}",
        status(&bench)
    );
    // The session has the values without the controller, too.
    let path = bench.folder.path().join("written.json");
    bench.give(FileCommand::SaveAs(path.clone()));
    bench.settle("a file");
    bench.give(FileCommand::Open(path));
    bench.settle("a question");
    bench.give(FileCommand::Answer(Answer::Discard));
    bench.wait("the end", |state| !state.model.link.is_connected());
    bench.settle("an identification");
    let review = bench.state().model.review();
    let line = review
        .changes()
        .find(|line| line.name == name)
        .expect("a line");
    assert_eq!((line.in_model, line.identified), (false, Some(0.0)));
    bench.go(Phase::Adjustment);
    connect(&mut bench);
    bench.press("Write to the controller");
    bench.name_operator("Ada");
    // Enter is not an answer to a warning.
    bench.harness.key_press(Key::Enter);
    bench.harness.run_ok();
    assert!(bench.state().model.dialogs.writing.is_some());
    bench.press("Write anyway");
    bench.wait("the values", |state| !state.model.link.writing);
    assert_eq!(held(&bench), 0.0);
}

#[test]
fn values_are_adapted_to_a_controller_without_the_parameter() {
    let (mut bench, cause) = sample();
    connect(&mut bench);
    identify_with(&mut bench, cause);
    let drum = |bench: &Bench| {
        let mut values = controller_values(bench).into_iter();
        let name = "cable-3.winch.drum_diameter_m";
        let drum = values.find(|(held, _)| held == name);
        drum.expect("a parameter").1
    };
    let nominal = drum(&bench);
    let text = "This controller cannot hold Winch scale (cable-3) of 2";
    bench.harness.get_by_label_contains(text);
    bench.press("Write to the controller");
    bench.harness.run_ok();
    let draft = bench.state().model.dialogs.writing.clone();
    let draft = draft.expect("a question");
    assert!(draft.doubts.is_empty(), "{:?}", draft.doubts);
    assert_eq!(bench.harness.query_all_by_label_contains(text).count(), 2);
    bench.name_operator("Ada");
    bench.press("Write");
    bench.wait("the values", |state| !state.model.link.writing);
    let scale = drum(&bench) / nominal - 1.0;
    assert!((scale.abs() - 0.02).abs() < 2e-3, "{scale}");
    for (name, value) in draft.review.values_to_write() {
        assert!(
            controller_values(&bench).contains(&(name.clone(), value)),
            "{name}"
        );
    }
    bench.harness.run_ok();
    assert_eq!(bench.state().model.review().changes().count(), 0);
    let holds = "The controller holds the identified values";
    bench.harness.get_by_label_contains(holds);
}
