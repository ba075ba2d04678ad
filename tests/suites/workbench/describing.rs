//! A robot from nothing: a template, then its numbers.

use egui::{Event, Key, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::robot::PartTolerances;
use tautline_workbench::model::command::{FileCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workflow::templates::Template;

use crate::support::{settle, workbench};
use crate::tables::Bench;
use tautline_validation::support::harness::{give, press};

/// A new robot, its description open.
fn new(template: Template) -> Bench {
    let mut bench = Bench::new();
    give(&mut bench.harness, FileCommand::New(template));
    // The session before it was not saved.
    press(&mut bench.harness, "Do not save");
    assert!(bench.shows("Every number is checked as it is typed"));
    bench
}

fn typed(bench: &mut Bench, field: &str, text: &str) {
    bench.type_into(Role::TextInput, field, text);
}

#[test]
fn a_template_opens_with_its_description() {
    let mut harness = workbench();
    for template in Template::ALL {
        give(&mut harness, FileCommand::New(template));
        if harness.query_by_label("Do not save").is_some() {
            press(&mut harness, "Do not save");
        }
        let model = &harness.state().state.model;
        let session = model.open.as_ref().expect("a session").session();
        assert_eq!(session.robot, template.robot(template.usual_size_m()));
        assert_eq!(model.screen, Screen::Phase(Phase::Modeling));
        let field = "Every number is checked as it is typed";
        assert!(harness.query_all_by_label_contains(field).next().is_some());
    }
}

#[test]
fn numbers_are_checked_as_they_are_typed() {
    let mut bench = new(Template::Spatial);
    let before = bench.session().robot.clone();
    typed(&mut bench, "Mass", "-");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    assert_eq!(bench.session().robot, before, "a mass below 0 is none");
    let said = bench.said().to_owned();
    assert!(said.contains("Mass: "), "{said}");
    bench.harness.key_press(Key::Escape);
    settle(&mut bench.harness);

    typed(&mut bench, "Gear ratio of all cables", "15");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    let ratios: Vec<f64> = bench
        .session()
        .robot
        .cables
        .iter()
        .map(|c| c.winch.gear_ratio)
        .collect();
    assert!(ratios.iter().all(|ratio| *ratio == 15.0), "{ratios:?}");
    assert_eq!(bench.next_undo(), Some("change gear ratio of all cables"));
    bench.undo();
    assert_eq!(bench.session().robot, before);
}

#[test]
fn cables_and_instruments_come_and_go() {
    let mut bench = new(Template::Planar);
    let before = bench.session().robot.clone();
    press(&mut bench.harness, "Add a cable");
    assert_eq!(bench.session().robot.cable_count(), 5);
    bench.undo();
    press(&mut bench.harness, "Inclinometer");
    assert!(bench.session().robot.inclinometer.is_some());
    press(&mut bench.harness, "Force sensors");
    assert!(bench.session().robot.cables[0].force_sensor.is_none());
    bench.undo();
    bench.undo();
    assert_eq!(bench.session().robot, before);
}

/// Puts a block of cells from the clipboard at a cell.
fn paste(bench: &mut Bench, cell: &str, block: &str) {
    let cell = bench.harness.get_by_role_and_label(Role::TextInput, cell);
    cell.focus();
    bench.harness.step();
    bench.harness.step();
    bench.harness.event(Event::Paste(block.to_owned()));
    bench.harness.step();
    settle(&mut bench.harness);
}

#[test]
fn a_block_of_a_spreadsheet_is_pasted_and_undone_in_one_step() {
    let mut bench = new(Template::Planar);
    let before = bench.session().robot.clone();
    paste(
        &mut bench,
        "Pulley x of cable-2",
        "-1360,5\t12,25\r\n1.5e3\t-7\r\n",
    );
    let cables = &bench.session().robot.cables;
    let xy = |k: usize| [0, 1].map(|axis| cables[k].pulley.entry_point_m[axis]);
    let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
    assert!(close(xy(1), [-1.3605, 0.01225]), "{:?}", xy(1));
    assert!(close(xy(2), [1.5, -0.007]), "{:?}", xy(2));
    assert_eq!(bench.next_undo(), Some("paste 4 cells"));
    bench.undo();
    assert_eq!(bench.session().robot, before);

    paste(&mut bench, "Pulley x of cable-2", "1;2\n3;abc");
    assert_eq!(bench.session().robot, before, "nothing of it was taken");
    let said = bench.said();
    assert!(
        said.contains("row 2, column 2 (Pulley y of cable-3): found \"abc\""),
        "{said}"
    );
}

#[test]
fn an_empty_table_says_what_is_missing_until_it_is_a_robot() {
    let mut bench = Bench::new();
    let full = bench.session().robot.clone();
    give(&mut bench.harness, ViewCommand::Go(Screen::NewRobot));
    for missing in ["Pulley x of all cables", "Anchor z of all cables"] {
        assert!(bench.shows(missing), "{missing}");
    }
    let button = bench
        .harness
        .get_by_role_and_label(Role::Button, "Use this robot");
    assert!(button.accesskit_node().is_disabled());
    let geometry: Vec<String> = full
        .cables
        .iter()
        .map(|cable| {
            let [x, y, z] = cable.pulley.entry_point_m.map(|m| m * 1e3);
            let [a, b, c] = cable.platform_anchor_m.map(|m| m * 1e3);
            let [i, k, l] = cable.pulley.swivel_axis;
            let radius = cable.pulley.radius_m * 1e3;
            format!("{x}\t{y}\t{z}\t{a}\t{b}\t{c}\t{i}\t{k}\t{l}\t{radius}")
        })
        .collect();
    paste(&mut bench, "Pulley x of cable-1", &geometry.join("\n"));
    assert!(!bench.shows("Pulley x of all cables"));
    typed(&mut bench, "Drum diameter of cable-3", "40");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    assert!(bench.shows("Drum diameter of cable-1, cable-2"));
    typed(&mut bench, "Drum diameter of all cables", "40");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    typed(&mut bench, "Length noise of all cables", "0,05");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    assert!(!bench.shows("Still missing"));
    press(&mut bench.harness, "Use this robot");
    if bench.harness.query_by_label("Do not save").is_some() {
        press(&mut bench.harness, "Do not save");
    }
    let made = &bench.session().robot;
    assert_eq!(made.cable_count(), 8);
    // A real robot is never taken as exact by accident.
    assert_eq!(made.tolerances, Some(PartTolerances::typical()));
    for (made, given) in made.cables.iter().zip(&full.cables) {
        for axis in 0..3 {
            let [a, b] = [made, given].map(|cable| cable.pulley.entry_point_m[axis]);
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
    let model = &bench.harness.state().state.model;
    assert_eq!(model.screen, Screen::Phase(Phase::Modeling));
}
