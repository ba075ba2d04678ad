//! The panel of phase 2.

use egui::{Key, Role};
use tautline_workbench::model::command::{FileCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};

use crate::support::settle;
use tautline_validation::support::phase_tables::elongation_table;

use crate::tables::Bench;

fn modeling() -> Bench {
    let mut bench = Bench::new();
    let go = ViewCommand::Go(Screen::Phase(Phase::Modeling));
    bench.harness.state_mut().state.outbox.send(go);
    settle(&mut bench.harness);
    bench
}

#[test]
fn elongation_is_imported_assessed_applied_and_undone() {
    let mut bench = modeling();
    assert!(bench.shows("the model has a constant stiffness of 40000 N"));
    let path = bench.write("elongation.csv", &elongation_table());
    bench.import("elongation.csv", &path);
    assert!(bench.shows("A surface of degree 2 fits all 64 points"));
    assert!(bench.shows("1000 to 2750"), "where it is valid");
    assert!(bench.shows("2, 6, 0.00"), "the degree with its error");
    bench.press("Apply surface");
    let cable = &bench.session().robot.cables[7].cable;
    assert_eq!(cable.elongation_surface.as_ref().map(|s| s.degree), Some(2));
    assert!(bench.shows("8 cables have a measured surface of degree 2"));
    assert_eq!(bench.next_undo(), Some("apply measured elongation"));
    bench.undo();
    assert!(
        bench.session().robot.cables[7]
            .cable
            .elongation_surface
            .is_none()
    );
}

#[test]
fn a_wrong_elongation_names_its_place() {
    let mut bench = modeling();
    let path = bench.write(
        "elongation.csv",
        "length_m,tension_n,elongation_m\n1,10,2.5\n",
    );
    bench.import("elongation.csv", &path);
    let said = bench.said();
    assert!(
        said.contains("elongation.csv, line 2, column \"elongation_m\": found \"2.5\""),
        "{said}"
    );
}

#[test]
fn a_table_of_any_kind_finds_its_place() {
    let mut bench = Bench::new();
    let path = bench.write("something.csv", &elongation_table());
    let state = &mut bench.harness.state_mut().state;
    state.outbox.send(FileCommand::Open(path));
    bench.harness.step();
    settle(&mut bench.harness);
    assert_eq!(bench.session().phases.elongation.len(), 64);
    assert!(bench.shows("A surface of degree 2"), "the panel shows it");
}

#[test]
fn a_pulley_is_edited_and_undone() {
    let mut bench = modeling();
    bench.open("Pulleys");
    assert!(bench.shows("Picture of the pulley of cable-1"));
    bench.type_into(Role::TextInput, "Pulley radius", "1");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    let radius = bench.session().robot.cables[0].pulley.radius_m;
    assert!((radius - 0.018).abs() > 1e-9, "{radius}");
    assert_eq!(bench.next_undo(), Some("change pulley radius of cable-1"));
    bench.undo();
    let radius = bench.session().robot.cables[0].pulley.radius_m;
    assert!((radius - 0.018).abs() < 1e-15);
}

#[test]
fn wrong_numbers_say_what_is_expected() {
    let mut bench = modeling();
    bench.open("Pulleys");
    bench.type_into(Role::TextInput, "Pulley radius", "x");
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
    let said = bench.said();
    assert!(said.contains("Pulley radius: found"), "{said}");
    assert!(said.contains("expected a number"), "{said}");
    assert_eq!(bench.next_undo(), None);
}

#[test]
fn the_lengths_of_all_cables_are_shown_in_numbers() {
    let mut bench = modeling();
    bench.open("Cable lengths");
    assert!(bench.shows("cable-8: free span "));
    assert!(bench.shows("no tension was measured here"));
}
