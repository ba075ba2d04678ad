//! A robot from nothing: a template, then its numbers.

use egui::{Key, Role};
use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::FileCommand;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workflow::templates::Template;

use crate::support::{settle, workbench};
use crate::tables::Bench;
use tautline_validation::harness::{give, press};

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

    typed(&mut bench, "Gear ratio", "15");
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
    assert_eq!(bench.next_undo(), Some("change gear ratio"));
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
