//! Stop: one button at one place with a key of its own, above every dialog, and the screen afterwards; the live scope
//! before.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use egui::{Key, KeyboardShortcut, Modifiers, Rect, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{
    Command, FileCommand, HypothesisCommand, IdentificationCommand, Opening, Origin, ReportCommand,
    RobotCommand, Setup, ViewCommand, WriteDraft,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::link::RunStep;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::AppState;
use tautline_workbench::shell::menu::items;
use tautline_workbench::views::robot_3d::scene::ShownPose;
use tautline_workflow::report::ReportFormat;

use crate::demo::Bench;
use crate::support::type_into;

/// A few frames: while the robot moves there is always another one.
fn step(bench: &mut Bench) {
    for _ in 0..3 {
        bench.harness.step();
    }
}

/// Rectangle of the button, and whether it is enabled.
fn button(bench: &mut Bench) -> (Rect, bool) {
    step(bench);
    let node = bench.harness.get_by_label("Stop the robot");
    (node.rect(), !node.accesskit_node().is_disabled())
}

fn shown(bench: &mut Bench) -> ShownPose {
    step(bench);
    let scene = bench.state().views.robot_3d.scene();
    scene.expect("it is drawn").shown
}

/// A run on its way to a pose.
fn moving(bench: &mut Bench) {
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Speed(5.0));
    bench.give(RobotCommand::Plan(5));
    bench.settle("a plan");
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("a pose on the way", |state| {
        let run = state.model.link.run.as_ref();
        let is_second = run.is_some_and(|run| run.current == Some(2));
        is_second && state.model.link.live().doing == RunStep::Moving
    });
}

fn ended(state: &AppState) -> bool {
    !state.model.link.is_measuring()
}

#[test]
fn stop_has_one_place_and_a_key_and_shows_where_the_robot_is() {
    let mut bench = Bench::demo(3);
    let (place, enabled) = button(&mut bench);
    assert!(!enabled, "nothing can move");
    moving(&mut bench);
    // Slower than real, so that it is on its way until it is stopped.
    bench.give(RobotCommand::Speed(0.05));
    for phase in Phase::ALL {
        bench.go(phase);
        assert_eq!(button(&mut bench), (place, true), "{phase:?}");
    }
    // The key works while something is typed.
    bench.give(ViewCommand::Palette(true));
    bench.harness.key_press_modifiers(Modifiers::NONE, Key::F12);
    bench.harness.step();
    bench.wait("the end", ended);
    bench.give(ViewCommand::Palette(false));
    assert_eq!(shown(&mut bench), ShownPose::Stopped);
    let live = bench.state().model.live_platform.clone().expect("a place");
    assert!(live.is_stopped && !live.trail.is_empty());
    let plan = &bench.session().plan;
    let away = plan
        .iter()
        .map(|pose| (pose.pose().position - live.pose.position).norm());
    assert!(
        away.fold(f64::INFINITY, f64::min) > 1e-4,
        "it is between poses"
    );
    // A pose that is chosen is shown; a new run shows the robot again.
    bench.give(ViewCommand::Select(Selection::pose(0)));
    assert_ne!(shown(&mut bench), ShownPose::Stopped);
    bench.go(Phase::Measuring);
    bench.press("Continue measuring");
    bench.wait("the robot", |state| state.model.live_platform.is_some());
    assert_eq!(shown(&mut bench), ShownPose::Live);
    bench.press("Stop the robot");
    bench.wait("the end", ended);
    assert_eq!(shown(&mut bench), ShownPose::Stopped);
}

/// A dialog of the program.
struct Dialog {
    /// Its name in the source.
    name: &'static str,
    open: fn(&mut Bench),
    /// Something that it shows.
    shows: &'static str,
    /// A text field.
    field: Option<&'static str>,
}

const DIALOGS: [Dialog; 9] = [
    Dialog {
        name: "behind the file chooser",
        open: |bench| {
            let options = &mut bench.harness.state_mut().state.model.options;
            options.no_desktop_dialogs = true;
            bench.give(FileCommand::AskOpen);
            bench.settle("the window");
        },
        shows: "Show Hidden",
        field: None,
    },
    Dialog {
        name: "command palette",
        open: |bench| bench.give(ViewCommand::Palette(true)),
        shows: "No matching commands",
        field: Some("Command"),
    },
    Dialog {
        name: "save",
        open: |bench| bench.give(FileCommand::AskSaveAs),
        shows: "Save the session as",
        field: Some("Path of the file"),
    },
    Dialog {
        name: "save report",
        open: |bench| bench.give(ReportCommand::AskSave(ReportFormat::Html)),
        shows: "Save the report as HTML",
        field: Some("Title"),
    },
    Dialog {
        name: "leaving",
        open: |bench| bench.give(FileCommand::Close),
        shows: "Save the changes?",
        field: None,
    },
    Dialog {
        name: "elsewhere",
        open: |bench| {
            let opening = Opening {
                session: bench.session().clone(),
                path: None,
                origin: Origin::Complete,
            };
            let dialogs = &mut bench.harness.state_mut().state.model.dialogs;
            dialogs.elsewhere = Some((Box::new(opening), "10:49".to_owned()));
        },
        shows: "Open in another window since 10:49",
        field: None,
    },
    Dialog {
        name: "unsaved hypothesis",
        open: |bench| {
            bench.give(HypothesisCommand::Show);
            bench.give(HypothesisCommand::SetText("id = 1".to_owned()));
            bench.give(HypothesisCommand::New);
        },
        shows: "Save the hypothesis?",
        field: None,
    },
    Dialog {
        name: "write values",
        open: |bench| {
            let writing = &mut bench.harness.state_mut().state.model.dialogs.writing;
            *writing = Some(WriteDraft::default());
        },
        shows: "Write these values?",
        field: Some("Operator"),
    },
    Dialog {
        name: "connect",
        open: |bench| bench.give(RobotCommand::Setup(Setup::Open)),
        shows: "Connect to a controller",
        field: None,
    },
];

#[test]
fn a_click_on_stop_reaches_the_robot_through_every_dialog_and_leaves_it_open() {
    let mut bench = Bench::demo(3);
    moving(&mut bench);
    bench.give(RobotCommand::Speed(0.05));
    for dialog in &DIALOGS {
        let name = dialog.name;
        bench.wait("motion", |state| {
            state.model.link.live().doing == RunStep::Moving
        });
        (dialog.open)(&mut bench);
        step(&mut bench);
        let typed = "no such thing";
        if let Some(field) = dialog.field {
            type_into(&mut bench.harness, Role::TextInput, field, typed);
        }
        bench.harness.get_by_label("Stop the robot").click();
        step(&mut bench);
        bench.wait(name, ended);
        assert!(
            bench.harness.query_by_label(dialog.shows).is_some(),
            "{name}"
        );
        if let Some(field) = dialog.field {
            let field = bench.harness.get_by_role_and_label(Role::TextInput, field);
            let value = field.accesskit_node().value().unwrap_or_default();
            assert!(value.contains(typed), "{name}: {value:?}");
        }
        bench.harness.key_press(Key::Escape);
        step(&mut bench);
        assert!(
            bench.harness.query_by_label(dialog.shows).is_none(),
            "{name}"
        );
        // The dialog about a hypothesis belongs to another screen.
        bench.give(ViewCommand::Go(Screen::Phase(Phase::Measuring)));
        step(&mut bench);
        bench.press("Continue measuring");
    }
}

/// The state that keys could change behind a dialog.
fn behind(state: &AppState) -> String {
    let model = &state.model;
    let open = model.open.as_ref().expect("a session");
    let dialogs = &model.dialogs;
    let session = (open.id(), open.revision(), &open.session().name);
    let work = (model.tasks.running().len(), model.link.connecting);
    let view = (
        model.screen,
        &model.selection,
        model.maximised,
        model.inspected,
    );
    let windows = (dialogs.log, dialogs.manual, dialogs.about);
    let others = (
        model.context.zoom_factor(),
        model.messages.all().len(),
        &model.preferences,
    );
    format!("{:?}", (session, work, view, windows, others))
}

#[test]
fn nothing_but_stop_acts_behind_a_dialog() {
    let mut bench = Bench::demo(3);
    let name = bench.session().name.clone();
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Plan(5));
    bench.settle("a plan");
    for name in ["one", "two"] {
        bench.give(Edit::Rename(name.to_owned()));
    }
    bench.give(Command::Undo);
    bench.give(ViewCommand::Select(Selection::pose(1).with_cable(2)));
    bench.connect_and_arm();
    let shortcuts: Vec<_> = items(bench.state())
        .iter()
        .filter_map(|item| item.shortcut)
        .collect();
    assert!(shortcuts.len() > 25, "{}", shortcuts.len());
    let plain = [
        Key::F,
        Key::Delete,
        Key::Home,
        Key::End,
        Key::Space,
        Key::Num1,
    ];
    let plain = plain.map(|key| KeyboardShortcut::new(Modifiers::NONE, key));
    for dialog in &DIALOGS {
        (dialog.open)(&mut bench);
        let dialogs = &mut bench.harness.state_mut().state.model.dialogs;
        // Set rather than typed, so that undo does not apply to the field.
        if let Some(text) = &mut dialogs.palette {
            "no such thing".clone_into(text);
        }
        step(&mut bench);
        let before = behind(bench.state());
        for keys in shortcuts.iter().chain(&plain) {
            if keys.logical_key == Key::F12 {
                continue;
            }
            bench
                .harness
                .key_press_modifiers(keys.modifiers, keys.logical_key);
            step(&mut bench);
            let shown = bench.harness.query_all_by_label(dialog.shows).count();
            assert_eq!(
                (shown, behind(bench.state())),
                (1, before.clone()),
                "{} {keys:?}",
                dialog.name
            );
        }
        bench.harness.key_press(Key::Escape);
        step(&mut bench);
        bench.give(ViewCommand::Go(Screen::Phase(Phase::Measuring)));
    }
    assert!(bench.state().model.link.is_armed());
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::Z);
    step(&mut bench);
    assert_eq!(bench.session().name, name, "without a dialog they act");
}

/// All files below a folder.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let files = entries.flat_map(|entry| match entry.path() {
        path if path.is_dir() => sources(&path),
        path => {
            let text = fs::read_to_string(&path).unwrap_or_default();
            vec![(path.display().to_string(), text)]
        }
    });
    files.collect()
}

#[test]
fn every_dialog_is_drawn_in_one_place_and_has_a_test_of_stop() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src/workbench");
    let mut names = BTreeSet::new();
    for (file, text) in sources(&root) {
        assert!(
            !text.contains("Modal::") || file.ends_with("modal.rs"),
            "{file}"
        );
        let calls = text.split("modal(ui, \"").skip(1);
        let calls = calls.chain(text.split("backdrop(ui, \"").skip(1));
        names.extend(calls.filter_map(|call| Some(call.split_once('"')?.0.to_owned())));
    }
    let tested = DIALOGS.iter().map(|dialog| dialog.name.to_owned());
    assert_eq!(names, tested.collect());
}

#[test]
fn the_scope_comes_with_a_run_and_goes_with_its_result() {
    let mut bench = Bench::demo(3);
    let has = |bench: &Bench, name: &str| bench.harness.query_by_label(name).is_some();
    moving(&mut bench);
    step(&mut bench);
    for name in ["Tensions", "Speed", "Laser", "Revolutions"] {
        let name = format!("Live: {name}");
        assert!(has(&bench, &name), "{name}");
    }
    let readings = |bench: &Bench| {
        let link = &bench.state().model.link;
        link.scope(|scope| scope.readings()).expect("it records")
    };
    let before = readings(&bench);
    bench.wait("readings", |state| {
        let now = state.model.link.scope(|scope| scope.readings());
        now.is_some_and(|now| now > before + 20)
    });
    bench.give(RobotCommand::Speed(60.0));
    bench.wait("all poses", ended);
    assert!(
        has(&bench, "Live: Tensions"),
        "it stays until there is a result"
    );
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    bench.harness.run_ok();
    assert!(!has(&bench, "Live: Tensions"));
    assert!(has(&bench, "Plot: Residuals"), "what was there before");
}
