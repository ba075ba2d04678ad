//! Dialogs that save files, and the window that chooses them where the desktop has no dialog.

use std::fs;
use std::path::Path;

use egui::{Key, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_session::SymbolMapping;
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{
    Command, CompareCommand, Export, FileCommand, IdentificationCommand, ImportCommand,
    RecordingCommand, ReportCommand, RobotCommand, Setup,
};
use tautline_workbench::model::comparison::Side;
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::phase::Phase;
use tautline_workflow::precalibration::Table;
use tautline_workflow::report::ReportFormat;

use crate::demo::Bench;
use crate::support::type_into;

const FIELD: &str = "Path of the file";

/// Types a path into the dialog, presses the button and waits for the file.
fn save(bench: &mut Bench, path: &str, button: &str) {
    bench.harness.run_ok();
    type_into(&mut bench.harness, Role::TextInput, FIELD, path);
    bench.press(button);
    bench.settle("a file");
    bench.harness.run_ok();
}

fn is_open(bench: &Bench) -> bool {
    let field = bench
        .harness
        .query_by_role_and_label(Role::TextInput, FIELD);
    field.is_some()
}

/// Whether the open dialog states why a file was not written.
fn says(bench: &Bench, path: &Path) -> bool {
    let text = format!("{}: cannot be written", path.display());
    let mut found = bench.harness.query_all_by_label_contains(&text);
    let found = found.next().and_then(|node| node.accesskit_node().value());
    found.is_some_and(|text| !text.contains(".tautline-"))
}

#[test]
fn a_dialog_stays_open_with_the_reason_until_its_file_is_written() {
    let mut bench = Bench::demo(3);
    bench.go(Phase::Measuring);
    bench.give(RobotCommand::Plan(5));
    bench.settle("a plan");
    let mapping = SymbolMapping::default_for(&bench.session().robot);
    let setup = Setup::AskExport(Box::new(mapping));
    let dialogs: [(Command, &str, &str); 4] = [
        (
            RobotCommand::AskExport(Export::Plan).into(),
            "p.csv",
            "Save",
        ),
        (RobotCommand::Setup(setup).into(), "s.json", "Save"),
        (
            ReportCommand::AskSave(ReportFormat::Html).into(),
            "r.html",
            "Save report",
        ),
        (FileCommand::AskSaveAs.into(), "d.json", "Save"),
    ];
    for (open, name, button) in dialogs {
        bench.give(open);
        // A relative path is shown as the absolute one.
        let nowhere = Path::new("no such folder").join(name);
        save(&mut bench, &nowhere.display().to_string(), button);
        let whole = std::env::current_dir().expect("a folder").join(nowhere);
        assert!(is_open(&bench), "{name}");
        assert!(says(&bench, &whole), "{name}");
        assert!(bench.harness.query_by_label("Dismiss").is_none(), "once");
        let path = bench.folder.path().join(name);
        save(&mut bench, &path.display().to_string(), button);
        assert!(path.is_file() && !is_open(&bench), "{name}");
    }
}

#[test]
fn a_plot_is_saved_by_one_dialog_that_has_the_focus() {
    let mut bench = Bench::demo(3);
    bench.measure(5);
    bench.give(IdentificationCommand::Identify);
    bench.settle("an identification");
    for (format, ending) in [("Table (CSV)", "csv"), ("Picture (PNG)", "png")] {
        for key in [Key::Escape, Key::Enter] {
            bench.press("Save plot");
            bench.press(format);
            bench.harness.run_ok();
            let field = bench.harness.get_by_role_and_label(Role::TextInput, FIELD);
            assert!(field.is_focused(), "{format}");
            let suggested = field.accesskit_node().value().unwrap_or_default();
            assert!(suggested.ends_with(&format!("residuals.{ending}")));
            let path = bench.folder.path().join(format!("plot.{ending}"));
            let name = path.display().to_string();
            type_into(&mut bench.harness, Role::TextInput, FIELD, &name);
            bench.harness.key_press(key);
            bench.harness.step();
            bench.settle("a file");
            let words = words(&bench.harness);
            assert!(!is_open(&bench), "{format}, {key:?}: {words:?}");
            assert_eq!(path.is_file(), key == Key::Enter);
        }
    }
}

#[test]
fn the_question_about_unsaved_changes_stays_while_they_cannot_be_saved() {
    let mut bench = Bench::demo(3);
    let folder = bench.folder.path().join("medium");
    fs::create_dir(&folder).expect("a folder");
    bench.give(FileCommand::SaveAs(folder.join("session.json")));
    bench.settle("a file");
    bench.give(Edit::Rename("Another name".into()));
    fs::remove_dir_all(&folder).expect("it is taken out");
    bench.give(FileCommand::Close);
    bench.harness.run_ok();
    bench.press("Save");
    bench.settle("an answer");
    bench.harness.run_ok();
    bench.harness.get_by_label("Save the changes?");
    assert!(says(&bench, &folder.join("session.json")));
    assert!(bench.state().model.open.is_some());
    fs::create_dir(&folder).expect("it is back");
    bench.press("Save");
    bench.wait("the start screen", |state| state.model.open.is_none());
    assert!(folder.join("session.json").is_file());
}

/// A session of a file, on a desktop without dialogs.
fn without_desktop() -> Bench {
    let mut bench = Bench::demo(3);
    let path = bench.folder.path().join("session.json");
    bench.give(FileCommand::SaveAs(path));
    bench.settle("a file");
    let options = &mut bench.harness.state_mut().state.model.options;
    options.no_desktop_dialogs = true;
    bench
}

fn chooses(bench: &mut Bench) -> bool {
    bench.settle("the window");
    bench.harness.run_ok();
    bench.harness.query_by_label("Show Hidden").is_some()
}

#[test]
fn a_session_is_opened_without_dialogs_of_the_desktop() {
    let mut bench = without_desktop();
    let id = |bench: &Bench| bench.state().model.open.as_ref().map(|open| open.id());
    let before = id(&bench);
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, Key::O);
    bench.harness.step();
    assert!(chooses(&mut bench));
    bench.press("🗋 session.json");
    bench.press("Choose");
    bench.settle("the session");
    assert!(!chooses(&mut bench));
    assert!(id(&bench) != before, "it was opened again");
}

#[test]
fn every_file_is_chosen_without_dialogs_of_the_desktop() {
    let mut bench = without_desktop();
    let asks: [Command; 6] = [
        RecordingCommand::Ask.into(),
        RecordingCommand::AskRecipe.into(),
        CompareCommand::Ask(Side::A).into(),
        ImportCommand::Ask(Table::Winch).into(),
        RobotCommand::Setup(Setup::AskImport).into(),
        RobotCommand::Setup(Setup::PickRecording).into(),
    ];
    for ask in asks {
        let what = format!("{ask:?}");
        bench.give(ask);
        assert!(chooses(&mut bench), "{what}");
        bench.harness.key_press(Key::Escape);
        assert!(!chooses(&mut bench), "{what}");
    }
    let saves: [Command; 2] = [
        FileCommand::AskSaveAs.into(),
        ReportCommand::AskSave(ReportFormat::Pdf).into(),
    ];
    for open in saves {
        bench.give(open);
        bench.harness.run_ok();
        bench.press("Browse…");
        assert!(chooses(&mut bench) && !is_open(&bench), "one at a time");
        bench.press("Choose");
        assert!(!chooses(&mut bench) && is_open(&bench));
        let field = bench.harness.get_by_role_and_label(Role::TextInput, FIELD);
        let path = field.accesskit_node().value().unwrap_or_default();
        assert!(Path::new(&path).starts_with(bench.folder.path()), "{path}");
        bench.press("Cancel");
    }
    // No other code opens a dialog of the desktop.
    let commands = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src/workbench/commands");
    for entry in fs::read_dir(commands).expect("a folder").flatten() {
        let text = fs::read_to_string(entry.path()).unwrap_or_default();
        assert!(!text.contains("rfd::") || entry.file_name() == "file_dialog.rs");
    }
}
