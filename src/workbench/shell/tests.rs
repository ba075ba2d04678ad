//! Recovery after a panic, and the menu items.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_core::robot::presets;
use tautline_session::{Folders, Session, find_unsaved_sessions};

use super::*;
use crate::model::OpenSession;
use crate::model::command::{Command, HypothesisCommand, Outcome, RobotCommand};
use crate::model::edit::Edit;
use crate::model::phase::{Phase, Screen};

/// Application whose frames panic on request.
struct Trapped {
    app: App,
    is_set: bool,
}

impl eframe::App for Trapped {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        self.app.logic(ctx, frame);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let is_set = std::mem::take(&mut self.is_set);
        self.app.frame(ui, |ui, state| {
            frame::show(ui, state);
            ui.horizontal(|_| assert!(!is_set, "the cable tore"));
        });
    }
}

fn workbench(folder: &std::path::Path) -> Harness<'static, Trapped> {
    let options = Options {
        folders: Some(Folders::below(folder)),
        ..Options::default()
    };
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1280.0, 800.0))
        .with_max_steps(60)
        .build_eframe(|creation| Trapped {
            app: App::new(creation, options),
            is_set: false,
        });
    let robot = presets::find("mini").expect("a preset").robot;
    let state = &mut harness.state_mut().app.state;
    let session = Session::new("MINI", robot, tautline_workflow::clock::now());
    state.model.open = Some(OpenSession::new(session, None));
    state.model.screen = Screen::Phase(Phase::Measuring);
    harness.run_ok();
    harness
}

fn rename(harness: &mut Harness<'_, Trapped>, name: &str) {
    let outbox = &mut harness.state_mut().app.state.outbox;
    outbox.send(Command::Edit(Edit::Rename(name.into())));
    harness.run_ok();
}

#[test]
fn lines_of_menus_keep_their_places() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = workbench(folder.path());
    let titles = |harness: &Harness<'_, Trapped>| -> Vec<String> {
        let lines = menu::items(&harness.state().app.state).into_iter();
        // Undo and the next step have variable titles.
        let fixed = lines.map(|line| line.title.split(':').next().unwrap_or_default().to_owned());
        fixed
            .map(|title| title.replace("Next step", "Next"))
            .collect()
    };
    let of_session = titles(&harness);
    rename(&mut harness, "renamed");
    let outbox = &mut harness.state_mut().app.state.outbox;
    outbox.send(HypothesisCommand::Show);
    harness.run_ok();
    assert!(harness.state().app.state.model.hypothesis.draft.is_some());
    let with_hypothesis = titles(&harness);
    let same = of_session.iter().zip(&with_hypothesis);
    let moved: Vec<_> = same.filter(|(a, b)| a != b).collect();
    assert!(
        moved.is_empty() && of_session.len() == with_hypothesis.len(),
        "{moved:?}"
    );
}

#[test]
fn a_panic_in_a_frame_is_told_and_costs_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = workbench(folder.path());
    rename(&mut harness, "before");
    harness.state_mut().is_set = true;
    harness.run_ok();
    let place = Folders::below(folder.path()).recovery();
    harness.get_by_label("Internal error");
    harness.get_by_label(&place.display().to_string());
    harness.get_by_label_contains("the cable tore");

    harness.get_by_label("Continue").click();
    harness.run_ok();
    let shown = harness.query_by_label("Internal error");
    assert!(shown.is_none(), "it goes on");
    rename(&mut harness, "after");
    let open = harness.state().app.state.model.open.as_ref();
    assert_eq!(open.expect("a session").session().name, "after");

    harness.state_mut().is_set = true;
    harness.run_ok();
    harness.get_by_label("Quit");
    harness.state_mut().app.state.model.autosave.flush();
    let left = find_unsaved_sessions(&place).expect("readable");
    let names: Vec<&str> = left.iter().map(|left| left.name.as_str()).collect();
    assert_eq!(names, ["after"], "the session is offered at the next start");
}

fn robot(
    harness: &mut Harness<'_, Trapped>,
    command: RobotCommand,
    reached: fn(&AppState) -> bool,
) {
    harness.state_mut().app.state.outbox.send(command);
    for _ in 0..6000 {
        harness.step();
        if reached(&harness.state().app.state) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    panic!("the robot does not answer");
}

#[test]
fn stop_works_during_an_internal_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = workbench(folder.path());
    robot(&mut harness, RobotCommand::Connect, |state| {
        state.model.link.is_connected()
    });
    robot(&mut harness, RobotCommand::Arm, |state| {
        state.model.link.is_armed()
    });
    harness.state_mut().is_set = true;
    harness.run_ok();
    let presses: [fn(&mut Harness<'_, Trapped>); 2] = [
        |harness| harness.get_by_label("Stop the robot").click(),
        |harness| harness.key_press(egui::Key::F12),
    ];
    for press in presses {
        harness.get_by_label("Internal error");
        harness.state_mut().app.state.model.link.is_stopped = false;
        press(&mut harness);
        harness.run_ok();
        assert!(harness.state().app.state.model.link.is_stopped);
    }
}

#[test]
fn a_panic_in_a_task_is_told_and_costs_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = workbench(folder.path());
    rename(&mut harness, "before");
    let state = &mut harness.state_mut().app.state;
    state
        .model
        .tasks
        .start("Testing", |_| -> Outcome { panic!("the cable tore") });
    for _ in 0..6000 {
        harness.step();
        if harness.state().app.state.model.tasks.running().is_empty() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    harness.run_ok();
    harness.get_by_label_contains("the cable tore");
    harness.get_by_label_contains(
        &Folders::below(folder.path())
            .recovery()
            .display()
            .to_string(),
    );
    harness.get_by_label("Continue").click_accesskit();
    harness.run_ok();
    harness
        .get_by_label_contains("Testing failed with an internal error; the session is unchanged.");
    let state = &harness.state().app.state;
    assert!(
        state.model.caught_panic.is_none(),
        "the window is there again"
    );
    assert!(
        state
            .model
            .open
            .as_ref()
            .is_some_and(OpenSession::is_unsaved)
    );
    rename(&mut harness, "after");
    harness.state_mut().app.state.model.autosave.flush();
    let left = find_unsaved_sessions(&Folders::below(folder.path()).recovery()).expect("readable");
    assert_eq!(left.len(), 1);
    assert_eq!(left[0].name, "after");
}
