//! Files of other programs: dropped, mapped, cut, identified, undone, and the next one.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{DroppedFile, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_import::{Cutting, read_recipe};
use tautline_workbench::model::command::{
    Command, FileCommand, IdentificationCommand, RecordingCommand,
};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::model::{Model, importing::OpenImport};

use crate::support::{settle, workbench};
use crate::tables::Bench;
use tautline_validation::support::harness::{give, press};

/// A file that is dropped on the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_file(bench: &mut Bench, path: &Path) {
    let file = Arc::new(Dropped(path.to_owned()));
    bench.harness.input_mut().dropped_files.push(file);
    bench.harness.step();
    settle(&mut bench.harness);
}

/// A file of the worked examples.
pub fn example(name: &str) -> String {
    let path = tautline_validation::generators::your_data::folder();
    std::fs::read_to_string(path.join(name)).expect("an example")
}

/// The recording of the examples with names and units that do not identify the winches.
fn silent_scope() -> String {
    let text = example("scope.csv").replace("Unit\trev", "Unit\t");
    (1..=8).fold(text, |text, k| {
        text.replace(&format!("GVL.Winch{k}.ActPos"), &format!("Slot[{k}]"))
    })
}

fn model(bench: &Bench) -> &Model {
    &bench.harness.state().state.model
}

fn import(bench: &Bench) -> &OpenImport {
    model(bench).importing.open.as_ref().expect("an import")
}

/// Use of a channel of the first series.
fn used<'b>(bench: &'b Bench, channel: &str) -> Option<&'b str> {
    let uses = &import(bench).uses;
    uses.get(&(0, channel.to_owned())).map(String::as_str)
}

fn poses(bench: &Bench) -> usize {
    let cut = import(bench).cut.as_ref().expect("a cut");
    cut.result
        .as_ref()
        .map_or(0, |done| done.measurements.len())
}

/// Chooses an entry in a list, which is named by its title and present entry.
fn choose(bench: &mut Bench, list: &str, entry: &str) {
    bench
        .harness
        .get_by_role_and_label(Role::ComboBox, list)
        .click_accesskit();
    bench.harness.run_ok();
    bench.harness.get_by_label(entry).click_accesskit();
    bench.harness.step();
    settle(&mut bench.harness);
}

#[test]
fn a_foreign_file_is_dropped_mapped_by_pattern_cut_and_identified() {
    let mut bench = Bench::new();
    let first = bench.write("monday.csv", &silent_scope());
    drop_file(&mut bench, &first);
    assert_eq!(model(&bench).screen, Screen::Import);
    assert!(bench.shows("TwinCAT Scope CSV, 390 rows, 17 channels"));
    assert_eq!(used(&bench, "GVL.Winch3.Force"), Some("force_3_n"));
    assert_eq!(used(&bench, "Slot[3]"), None);

    // One choice for the channels of all cables.
    press(&mut bench.harness, "Slot[3], not used");
    assert!(bench.shows("All 8 channels Slot[{i}]"));
    choose(&mut bench, "Quantity: Not used", "Winch revolutions");
    assert_eq!(used(&bench, "Slot[3]"), Some("rev_3"));
    assert_eq!(used(&bench, "Slot[8]"), Some("rev_8"));
    press(&mut bench.harness, "Rests are poses");
    assert_eq!(
        import(&bench).cut.as_ref().map(|cut| cut.poses().len()),
        Some(10)
    );
    press(&mut bench.harness, "The first pose is the home pose");
    assert_eq!(poses(&bench), 10);
    assert!(bench.shows("No mistake was found in the readings."));

    // Steps of the recipe are undone one by one, and done again.
    bench.undo();
    assert!(!import(&bench).draft.recipe().first_pose_is_home);
    bench.undo();
    // A recording with this rate counts as motion until the user chooses its standstills as poses.
    assert_eq!(import(&bench).draft.recipe().cutting, Cutting::Motion);
    bench.undo();
    assert_eq!(used(&bench, "Slot[3]"), None);
    for _ in 0..3 {
        give(&mut bench.harness, Command::Redo);
    }
    assert_eq!(poses(&bench), 10);

    // The recipe as a file is that of the command.
    let recipe = bench.write("recipe.json", "");
    bench.type_into(
        Role::TextInput,
        "Path of the recipe",
        recipe.to_str().expect("UTF-8"),
    );
    press(&mut bench.harness, "Save recipe");
    let saved = read_recipe(&recipe).expect("a recipe").value;
    assert_eq!(saved, *import(&bench).draft.recipe());

    press(&mut bench.harness, "Import 10 poses");
    assert_eq!(bench.session().measurements.len(), 10);
    assert_eq!(model(&bench).screen, Screen::Phase(Phase::Identification));
    give(&mut bench.harness, IdentificationCommand::Identify);
    let fit = |bench: &Bench| {
        model(bench)
            .open
            .as_ref()
            .is_some_and(|open| open.fit().is_some())
    };
    assert!(fit(&bench), "{}", bench.said());

    // An import is undone as a whole: it is still in its file.
    assert_eq!(bench.next_undo(), Some("import monday.csv"));
    bench.undo();
    assert!(bench.session().measurements.is_empty());
    give(&mut bench.harness, Command::Redo);
    assert_eq!(bench.session().measurements.len(), 10);

    // The next file needs nothing but the recipe that the session has kept.
    let second = bench.write("tuesday.csv", &silent_scope());
    drop_file(&mut bench, &second);
    assert_eq!(used(&bench, "Slot[3]"), Some("rev_3"));
    assert_eq!(poses(&bench), 10);
    assert!(bench.shows("The recipe of the last import fits this file"));
    assert!(bench.shows("Import 10 poses as a new session"));
}

/// A table with columns multiplied.
fn scaled(text: &str, separator: char, columns: &[usize], factor: f64) -> String {
    let lines = text.lines().map(|line| {
        let numbers: Result<Vec<f64>, _> = line.split(separator).map(str::parse).collect();
        let Ok(mut numbers) = numbers else {
            return line.to_owned();
        };
        columns.iter().for_each(|column| numbers[*column] *= factor);
        let cells: Vec<String> = numbers.iter().map(f64::to_string).collect();
        cells.join(&separator.to_string())
    });
    lines.fold(String::new(), |text, line| text + &line + "\n")
}

/// Imports a file with a mistake as it is, is sent back by the check of phase 4, imports it again, and undoes that.
fn is_sent_back(text: &str, sentence: &str, corrected: &str) {
    let mut bench = Bench::new();
    let file = bench.write("log.csv", text);
    give(&mut bench.harness, RecordingCommand::Read(file));
    if import(&bench).draft.recipe().cutting == Cutting::Motion {
        press(&mut bench.harness, "Slot[3], not used");
        choose(&mut bench, "Quantity: Not used", "Winch revolutions");
        press(&mut bench.harness, "Rests are poses");
        press(&mut bench.harness, "The first pose is the home pose");
    }
    give(&mut bench.harness, RecordingCommand::Finish);
    assert_eq!(model(&bench).screen, Screen::Phase(Phase::Identification));
    let wrong = bench.session().measurements.clone();
    assert!(bench.shows(sentence), "{sentence}: {}", bench.said());
    press(&mut bench.harness, "Back to import");
    assert_eq!(model(&bench).screen, Screen::Import);
    assert_eq!(import(&bench).draft.next_undo(), Some(corrected));
    assert!(bench.shows("No mistake was found in the readings."));

    // The correction can be undone in the recipe, and the import in the session.
    bench.undo();
    assert!(!bench.shows("No mistake was found in the readings."));
    give(&mut bench.harness, Command::Redo);
    give(&mut bench.harness, RecordingCommand::Finish);
    assert!(!bench.shows(sentence));
    assert!(!bench.shows("Back to import"));
    let right = bench.session().measurements.clone();
    assert_ne!(right, wrong);
    assert_eq!(bench.next_undo(), Some("import log.csv again"));
    bench.undo();
    assert_eq!(bench.session().measurements, wrong);
    assert!(bench.shows(sentence));

    // The recipe is corrected already: going back again does not reverse the sign once more.
    press(&mut bench.harness, "Back to import");
    assert!(bench.shows("No mistake was found in the readings."));
    give(&mut bench.harness, RecordingCommand::Finish);
    assert_eq!(bench.session().measurements, right);
}

#[test]
fn a_reversed_winch_is_sent_back_to_import_and_corrected() {
    let sentence = "The length of cable-3 changes with the wrong sign.";
    let table = scaled(&example("log.csv"), ',', &[3], -1.0);
    is_sent_back(&table, sentence, "correct rev_3");
    // Without commanded poses the other cables tell it.
    let scope = scaled(&silent_scope(), '\t', &[5], -1.0);
    is_sent_back(&scope, sentence, "correct rev_3");
}

#[test]
fn a_wrong_unit_is_sent_back_to_import_and_corrected() {
    let winches: Vec<usize> = (1..=8).collect();
    let names: Vec<String> = (1..=8).map(|k| format!("rev_{k}")).collect();
    let radians = scaled(&example("log.csv"), ',', &winches, std::f64::consts::TAU);
    is_sent_back(
        &radians,
        "6.2832 times too large for these poses: radians",
        &format!("correct {}", names.join(", ")),
    );
    // Metres that were taken for millimetres and divided again.
    let laser = scaled(&example("log.csv"), ',', &[17], 1e-3);
    is_sent_back(
        &laser,
        "Laser_m: 1000.0000 times too small",
        "correct laser_m",
    );
}

#[test]
fn a_recipe_is_used_from_its_file() {
    let mut bench = Bench::new();
    let file = bench.write("log.csv", &silent_scope());
    let recipe = bench.write(
        "recipe.json",
        r#"{"format": "tautline-import-recipe", "version": 1,
            "channels": [{"channel": "Slot[{i}]", "quantity": "rev_{i}"}],
            "cutting": {"by": "rest"}}"#,
    );
    drop_file(&mut bench, &file);
    drop_file(&mut bench, &recipe);
    assert_eq!(used(&bench, "Slot[5]"), Some("rev_5"));
    assert_eq!(used(&bench, "GVL.Winch5.Force"), None);
    assert_eq!(import(&bench).draft.next_undo(), Some("use recipe.json"));
    bench.undo();
    assert_eq!(used(&bench, "GVL.Winch5.Force"), Some("force_5_n"));
}

#[test]
fn mistakes_are_corrected_by_one_click_each() {
    let mut bench = Bench::new();
    let file = bench.write("log.csv", &example("mistakes.csv"));
    give(&mut bench.harness, RecordingCommand::Read(file));
    assert!(bench.shows("rev_3 falls where it should rise"));
    press(&mut bench.harness, "Correct rev_5, rev_6");
    press(&mut bench.harness, "Correct rev_3");
    assert!(bench.shows("No mistake was found in the readings."));
    assert_eq!(used(&bench, "rev_5"), Some("rev_6"));
    assert_eq!(import(&bench).draft.next_undo(), Some("correct rev_3"));
    bench.undo();
    assert!(bench.shows("rev_3 falls where it should rise"));
}

#[test]
fn another_robot_than_the_measured_one_is_not_called_right() {
    // Every pulley is somewhere else.
    let mut bench = Bench::with_robot(|robot| {
        for (k, cable) in robot["cables"]
            .as_array_mut()
            .expect("cables")
            .iter_mut()
            .enumerate()
        {
            let place = &mut cable["pulley"]["entry_point_m"];
            let coordinate = place[k % 3].as_f64().expect("a number");
            place[k % 3] = (-0.3 * coordinate).into();
        }
    });
    let file = bench.write("log.csv", &example("log.csv"));
    give(&mut bench.harness, RecordingCommand::Read(file));
    assert!(!bench.shows("No mistake was found in the readings."));
    assert!(bench.shows("rev_1 … rev_8: winch revolutions"));
    assert!(bench.shows("force_1_n … force_8_n: cable force"));
    press(&mut bench.harness, "force_1_n, force_1_n");
    assert!(bench.shows("in N, as the file states"));
}

#[test]
fn a_channel_is_mapped_by_hand() {
    let mut bench = Bench::new();
    let file = bench.write("log.csv", &example("table.csv"));
    drop_file(&mut bench, &file);
    press(&mut bench.harness, "Winde2 Winkel, rev_2");
    press(&mut bench.harness, "Only this channel");
    press(&mut bench.harness, "Reversed");
    let recipe = import(&bench).draft.recipe();
    let entry = |channel: &str| recipe.entry_of("log", channel, 8).expect("used");
    assert!(entry("Winde2 Winkel").reversed);
    assert!(!entry("Winde1 Winkel").reversed);
    assert!(bench.shows("Correct rev_2"));
    choose(&mut bench, "Quantity: Winch revolutions", "Not used");
    assert_eq!(used(&bench, "Winde2 Winkel"), None);
    assert_eq!(used(&bench, "Winde3 Winkel"), Some("rev_3"));
}

#[test]
fn files_wait_for_a_robot() {
    let mut harness = workbench();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.csv");
    std::fs::write(&path, example("scope.csv")).expect("written");
    give(&mut harness, FileCommand::Open(path));
    assert!(
        harness
            .query_by_label("Which robot was measured?")
            .is_some()
    );
    let mini = tautline_core::robot::presets::find("mini").expect("a preset");
    press(&mut harness, &mini.robot.name);
    let model = &harness.state().state.model;
    assert_eq!(model.screen, Screen::Import);
    let import = model.importing.open.as_ref().expect("an import");
    let cut = import.cut.as_ref().expect("a cut");
    let imported = cut.result.as_ref().expect("poses");
    assert_eq!(imported.measurements.len(), 10);
    let plot = harness.get_by_label("Plot: GVL.Winch1.ActPos over time");
    assert!(plot.accesskit_node().role() == Role::Image);
}
