//! The phase Adjustment on a simulated robot.

use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::accuracy::iso9283::{Target, pose_accuracy};
use tautline_core::effect;
use tautline_core::geometry::Pose;
use tautline_session::{CheckKind, CheckPose, Outcome, Stage, Verification};
use tautline_validation::support::harness::give_parameters;
use tautline_workbench::model::command::{
    Answer, Export, FileCommand, IdentificationCommand, RobotCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::link::LinkRequest;
use tautline_workbench::model::phase::Phase;

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
    assert!(name.ends_with(", %"), "{name}");
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
    bench.press("Go to measuring");
    assert_eq!(bench.measure(25), 26);
    bench.go(Phase::Adjustment);
    bench.harness.get_by_label_contains("not identified yet");
    verify(&mut bench, "Measure before", 1);
    // What the doctor would name: without it the pulleys alone would have to explain the fault.
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
    bench
        .harness
        .get_by_label_contains("Improved: pose accuracy, mean");

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
    let differences = bench.state().model.differences();
    for change in &written.changes {
        let mut lines = differences.iter();
        let line = lines.find(|line| line.name == change.name);
        let recorded = line
            .and_then(|line| line.controller)
            .expect("it is recorded");
        assert!((recorded - change.before).abs() < 1e-9, "{}", change.name);
    }
}
