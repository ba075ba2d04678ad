//! The window and the commands on the same session file: neither overwrites changes of the other.

use std::path::{Path, PathBuf};

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use tautline_core::estimation::Termination;
use tautline_core::robot::presets;
use tautline_core::simulation::simulate;
use tautline_session::{
    MeasuredPose, Phase, PlannedPose, RecoveryWriter, Session, Timestamp, read_session,
    write_session,
};
use tautline_validation::support::program::{Answer, tautline};
use tautline_validation::tables::simulated::preset_options;
use tautline_workbench::model::command::{
    Command, FileCommand, IdentificationCommand, RobotCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::phase::{Phase as Step, Screen};
use tautline_workflow::session_file::FileLock;

use crate::demo::Bench;

fn session(poses: usize) -> Session {
    let preset = presets::find("mini").expect("a preset");
    let mut session = Session::new(
        "mini",
        preset.robot.clone(),
        Timestamp::from_unix_seconds(0),
    );
    let simulated = simulate(&preset.robot, &preset_options(&preset, poses, 3));
    session.measurements = simulated.expect("simulated").dataset.measurements;
    session
}

fn path(bench: &Bench) -> PathBuf {
    bench.folder.path().join("session.json")
}

fn saved(bench: &Bench) -> Session {
    read_session(&path(bench)).expect("a session").value
}

fn unsaved(bench: &Bench) -> PathBuf {
    bench.folder.path().join("session.json.unsaved")
}

fn rename(bench: &mut Bench, name: &str) {
    bench.give(Edit::Rename(name.to_owned()));
    bench.harness.step();
}

fn save(bench: &mut Bench) {
    bench.give(FileCommand::Save);
    bench.settle("saving");
    bench.harness.step();
}

/// Lets a question find its size and be drawn.
fn question(bench: &mut Bench) {
    bench.harness.run_ok();
}

fn told(bench: &Bench, part: &str) -> usize {
    let all = bench.state().model.messages.all().iter();
    all.filter(|message| message.text.contains(part)).count()
}

/// A command that needs the session file for itself, and then asks for a controller that the session has not.
fn command(bench: &Bench) -> Answer {
    let file = path(bench);
    tautline(&[
        "adjust",
        file.to_str().expect("text"),
        "--controller",
        "sim",
    ])
}

/// Changes the file as a command would.
fn changed_by_a_command(path: &Path) {
    let mut session = read_session(path).expect("a session").value;
    session.name = "as the command wrote it".into();
    write_session(path, &session).expect("written");
}

#[test]
fn commands_wait_while_the_window_has_unsaved_changes() {
    let mut bench = Bench::of_session(&session(3));
    bench.harness.step();
    assert_eq!(command(&bench).code, Some(2), "no simulated robot");
    rename(&mut bench, "renamed");
    assert!(unsaved(&bench).exists());
    let refused = command(&bench);
    assert_eq!(refused.code, Some(1));
    assert!(
        refused
            .stderr
            .contains("another program is using this session"),
        "{}",
        refused.stderr
    );
    save(&mut bench);
    assert!(!unsaved(&bench).exists());
    assert_eq!(saved(&bench).name, "renamed");
    assert_eq!(command(&bench).code, Some(2));
    // Saved again, once more by the same window.
    rename(&mut bench, "again");
    save(&mut bench);
    assert_eq!(saved(&bench).name, "again");
    // A session whose changes are discarded does not lock out others.
    rename(&mut bench, "for nothing");
    bench.give(FileCommand::Close);
    question(&mut bench);
    bench.press("Do not save");
    bench.harness.step();
    assert!(!unsaved(&bench).exists());
}

#[test]
fn the_window_does_not_write_over_what_a_command_wrote() {
    let mut bench = Bench::of_session(&session(3));
    bench.harness.step();
    changed_by_a_command(&path(&bench));
    rename(&mut bench, "renamed");
    assert_eq!(told(&bench, "another program has changed this session"), 1);
    save(&mut bench);
    assert_eq!(told(&bench, "another program has changed this session"), 2);
    assert_eq!(saved(&bench).name, "as the command wrote it");
    let other = bench.folder.path().join("other.json");
    bench.press("Save as…");
    bench.wait("the dialog", |state| state.model.tasks.running().is_empty());
    bench.harness.step();
    bench.harness.get_by_label("Save the session as");
    bench.give(FileCommand::SaveAs(other.clone()));
    bench.settle("saving");
    assert_eq!(
        read_session(&other).expect("a session").value.name,
        "renamed"
    );
    assert_eq!(saved(&bench).name, "as the command wrote it");
}

#[test]
fn a_running_command_is_shown_and_blocks_saving() {
    let mut bench = Bench::new(None);
    write_session(&path(&bench), &session(3)).expect("written");
    let held = FileLock::acquire(&path(&bench)).expect("held");
    let file = path(&bench);
    bench.give(FileCommand::Open(file));
    bench.wait("the session", |state| state.model.open.is_some());
    let busy = "another program is using this session";
    assert_eq!(told(&bench, busy), 1, "when it is opened");
    rename(&mut bench, "renamed");
    assert_eq!(told(&bench, busy), 2, "at the first change");
    rename(&mut bench, "renamed again");
    assert_eq!(told(&bench, busy), 2);
    save(&mut bench);
    assert_eq!(told(&bench, busy), 3, "when it is to be saved");
    assert_eq!(saved(&bench).name, "mini");
    drop(held);
    save(&mut bench);
    assert_eq!(saved(&bench).name, "renamed again");
    assert!(!unsaved(&bench).exists());
}

/// Opens the session of another window.
fn open_too(bench: &mut Bench, file: &Path, answer: &str) {
    bench.give(FileCommand::Open(file.to_owned()));
    bench.settle("a question");
    question(bench);
    let asked = "Open in another window since ";
    bench.harness.get_by_label_contains(asked);
    bench.press(answer);
    bench.wait("the session", |state| state.model.open.is_some());
    bench.settle("the session");
}

#[test]
fn a_session_that_is_open_in_another_window_is_looked_at_or_taken_over() {
    let mut first = Bench::of_session(&session(3));
    let file = path(&first);
    first.harness.step();
    let folder = first.folder.path().to_owned();
    let mut second = Bench::new_in(&folder);
    let refused = "Open in another window since ";
    open_too(&mut second, &file, "Look only");
    for (k, command) in [
        Edit::Rename("second".into()).into(),
        RobotCommand::Connect.into(),
    ]
    .into_iter()
    .enumerate()
    {
        let command: Command = command;
        second.give(command);
        assert_eq!(told(&second, refused), k + 1);
    }
    assert_eq!(
        (
            second.session().name.as_str(),
            second.state().model.link.connecting
        ),
        ("mini", false)
    );
    rename(&mut first, "first");
    save(&mut first);
    assert_eq!(read_session(&file).expect("a session").value.name, "first");
    open_too(&mut second, &file, "Take over");
    assert_eq!(second.session().name, "first");
    rename(&mut second, "second");
    save(&mut second);
    assert_eq!(read_session(&file).expect("a session").value.name, "second");
    first.harness.step();
    assert_eq!(told(&first, refused), 1, "it is told");
    rename(&mut first, "first again");
    assert_eq!(
        (first.session().name.as_str(), told(&first, refused)),
        ("first", 2)
    );
    // The file of a closed session is unlocked.
    second.give(FileCommand::Close);
    second.harness.step();
    first.give(FileCommand::Open(file));
    first.wait("the session", |state| {
        state
            .model
            .open
            .as_ref()
            .is_some_and(|open| open.session().name == "second")
    });
    rename(&mut first, "first again");
    assert_eq!(first.session().name, "first again");
}

#[test]
fn saving_seals_the_audit_trail_and_opening_says_what_is_wrong_in_it() {
    let mut bench = Bench::new(None);
    write_session(&path(&bench), &session(3)).expect("written");
    bench.give(FileCommand::Open(path(&bench)));
    bench.wait("the session", |state| state.model.open.is_some());
    let model = &mut bench.harness.state_mut().state.model;
    model.change_preferences(|preferences| preferences.operator = "Ada".into());
    let log = |bench: &mut Bench, text: &str| {
        let open = bench.harness.state_mut().state.model.open.as_mut();
        open.expect("a session").log(Phase::Session, text);
        save(bench);
    };
    log(&mut bench, "Looked at.");
    log(&mut bench, "Looked at again.");
    let kept = saved(&bench);
    assert_eq!(kept.audit(), []);
    let operators = kept.trail().entries().iter().map(|entry| &entry.operator);
    assert_eq!(operators.collect::<Vec<_>>(), ["Ada", "Ada"]);
    assert_eq!(bench.session(), &kept);
    let open = bench.state().model.open.as_ref();
    assert!(open.is_some_and(|open| !open.is_unsaved()));
    // Changes by another program are reported when the session is opened.
    let text = std::fs::read_to_string(path(&bench)).expect("a session");
    let other = bench.folder.path().join("other.json");
    std::fs::write(&other, text.replace("Looked at.", "Nothing.")).expect("written");
    bench.give(FileCommand::Open(other));
    bench.wait("the other session", |state| {
        let open = state.model.open.as_ref();
        open.is_some_and(|open| open.session().log()[0].text == "Nothing.")
    });
    let said = "The audit trail is broken: step 1 of the log is not as recorded by Ada";
    assert_eq!(told(&bench, said), 1);
}

#[test]
fn measurements_of_a_killed_command_are_recovered() {
    let mut bench = Bench::new(None);
    let whole = session(3);
    let mut begun = whole.clone();
    begun.measurements = whole.measurements.select(&[0, 1]);
    write_session(&path(&bench), &begun).expect("written");
    std::fs::create_dir(unsaved(&bench)).expect("a folder");
    let file = path(&bench);
    let mut keeper = RecoveryWriter::create(&unsaved(&bench), Some(&file), &begun).expect("kept");
    let m = &whole.measurements;
    let pose = MeasuredPose::from(m.select(&[2]));
    keeper.append_pose(&pose).expect("kept");
    drop(keeper);
    bench.give(FileCommand::Open(file));
    bench.wait("the session", |state| state.model.open.is_some());
    assert_eq!(bench.session().measurements.labels, m.labels[..3]);
    assert_eq!(told(&bench, "1 pose that a program had measured"), 1);
    assert!(!unsaved(&bench).exists());
    assert_eq!(saved(&bench).measurements.labels, m.labels[..3]);
    assert!(
        saved(&bench)
            .log()
            .iter()
            .any(|entry| entry.phase == Phase::Poses)
    );
}

#[test]
fn a_recovered_run_goes_on_where_it_was_interrupted() {
    for (planned, expected) in [(5, Step::Measuring), (3, Step::Identification)] {
        let mut interrupted = session(3);
        let planned = (0..=planned).map(|label| PlannedPose {
            label,
            position_m: [0.0; 3],
            orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        });
        interrupted.plan = planned.collect();
        let folder = tempfile::tempdir().expect("a folder");
        let place = Bench::folders(&folder).recovery();
        std::fs::create_dir_all(&place).expect("a folder");
        let left = RecoveryWriter::create(&place, None, &interrupted);
        drop(left.expect("kept"));
        let mut bench = Bench::started_in(folder, None);
        bench.wait("what is left", |state| {
            !state.model.unsaved_sessions.is_empty()
        });
        // The first next step is the recovery of the session.
        bench
            .harness
            .key_press_modifiers(Modifiers::COMMAND, Key::Enter);
        bench.wait("the session", |state| state.model.open.is_some());
        assert_eq!(bench.session().measurements.len(), 4);
        assert_eq!(bench.state().model.screen, Screen::Phase(expected));
    }
}

#[test]
fn writing_values_that_did_not_converge_needs_confirmation() {
    let mut bench = Bench::of_session(&session(12));
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    bench.give(RobotCommand::Connect);
    bench.wait("a connection", |state| state.model.link.is_connected());
    let doubts = |bench: &Bench| {
        let writing = bench.state().model.dialogs.writing.as_ref();
        writing.map(|draft| draft.doubts.len())
    };
    bench.give(RobotCommand::Write);
    assert_eq!(doubts(&bench), Some(0), "only the name is asked for");
    question(&mut bench);
    bench.press("Cancel");
    let document = bench.harness.state_mut().state.model.open.as_mut();
    let document = document.expect("a session");
    let mut fit = document.fit().expect("a fit").as_ref().clone();
    fit.solution.termination = Termination::IterationLimit;
    let inputs = document.inputs();
    document.set_fit(fit, inputs);
    bench.give(RobotCommand::Write);
    assert!(doubts(&bench) > Some(0));
    question(&mut bench);
    bench.press("Do not write");
    assert_eq!(doubts(&bench), None);
    bench.give(RobotCommand::Write);
    bench.name_operator("Ada");
    question(&mut bench);
    bench.press("Write anyway");
    assert_eq!(doubts(&bench), None);
}
