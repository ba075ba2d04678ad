//! Tolerances of the parts: exact, typical, stated.

use egui::{Key, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::robot::{PartTolerances, StatedTolerances};
use tautline_session::read_session;
use tautline_validation::support::harness::{give, press};
use tautline_workbench::model::command::{FileCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workflow::templates::Template;

use crate::support::settle;
use crate::tables::Bench;

/// Opens the page of a bench's robot.
fn opened(mut bench: Bench) -> Bench {
    give(
        &mut bench.harness,
        ViewCommand::Go(Screen::Phase(Phase::Modeling)),
    );
    bench.open("Tolerances");
    bench
}

/// A new robot of a template.
fn of_template() -> Bench {
    let mut bench = Bench::new();
    give(&mut bench.harness, FileCommand::New(Template::Spatial));
    press(&mut bench.harness, "Do not save");
    opened(bench)
}

/// Enters a number; a blank makes a field empty.
fn enter(bench: &mut Bench, field: &str, text: &str) {
    bench.type_into(Role::TextInput, field, text);
    bench.harness.key_press(Key::Enter);
    settle(&mut bench.harness);
}

fn choose(bench: &mut Bench, choice: &str) {
    let found = bench
        .harness
        .get_by_role_and_label(Role::RadioButton, choice);
    found.click_accesskit();
    bench.harness.step();
    settle(&mut bench.harness);
}

fn tolerances(bench: &Bench) -> Option<&PartTolerances> {
    bench.session().robot.tolerances.as_ref()
}

fn stated(bench: &Bench) -> &StatedTolerances {
    match tolerances(bench) {
        Some(PartTolerances::Stated(stated)) => stated,
        other => panic!("{other:?}"),
    }
}

fn is_unsaved(bench: &Bench) -> bool {
    let open = bench.harness.state().state.model.open.as_ref();
    open.expect("a session").is_unsaved()
}

/// The number in a field.
fn field(bench: &Bench, name: &str) -> Option<String> {
    let node = bench.harness.get_by_role_and_label(Role::TextInput, name);
    node.accesskit_node().value()
}

#[test]
fn a_robot_of_a_template_has_typical_tolerances_with_their_sources() {
    let bench = of_template();
    assert!(bench.shows("typical of a small machine"));
    assert!(bench.shows("Winch scale, %"));
    assert!(bench.shows("IT7 of ISO 286-1"));
    assert!(bench.shows("at 25 poses of its workspace"));
    assert!(bench.shows("No reading of this robot depends on: "));
    let fields = bench.harness.query_all_by_role(Role::TextInput);
    let names = fields.filter_map(|node| node.accesskit_node().label());
    assert!(!names.into_iter().any(|name| name.starts_with("Tolerance")));
}

#[test]
fn stated_tolerances_begin_with_the_typical_ones_and_are_saved_and_undone() {
    let mut bench = of_template();
    choose(&mut bench, "Stated");
    assert_eq!(bench.next_undo(), Some("state tolerances"));
    assert_eq!(stated(&bench).others("winch_scale"), Some(2e-4));
    assert_eq!(
        field(&bench, "Tolerance of winch scale").as_deref(),
        Some("0.02")
    );
    // In percent.
    enter(&mut bench, "Tolerance of winch scale", "0,05");
    assert!((stated(&bench).sd_of("winch_scale", Some("cable-3")) - 5e-4).abs() < 1e-12);
    assert_eq!(bench.next_undo(), Some("change tolerance of winch scale"));
    enter(&mut bench, "Tolerance of drum out of round", " ");
    assert_eq!(stated(&bench).others("drum_eccentricity"), None);
    enter(&mut bench, "Factor of all stated tolerances", "1.5");
    assert!(is_unsaved(&bench));

    let path = bench.write("session.json", "");
    give(&mut bench.harness, FileCommand::SaveAs(path.clone()));
    settle(&mut bench.harness);
    assert!(!is_unsaved(&bench));
    let kept = stated(&bench).clone();
    let saved = read_session(&path).expect("a session").value;
    assert_eq!(
        saved.robot.tolerances,
        Some(PartTolerances::Stated(kept.clone()))
    );
    give(&mut bench.harness, FileCommand::Close);
    give(&mut bench.harness, FileCommand::Open(path));
    let mut bench = opened(bench);
    assert_eq!(*stated(&bench), kept);
    assert_eq!(
        field(&bench, "Tolerance of winch scale").as_deref(),
        Some("0.05")
    );

    choose(&mut bench, "Exact");
    assert_eq!(tolerances(&bench), None);
    assert!(bench.shows("takes all parts as exact"));
    bench.undo();
    assert_eq!(*stated(&bench), kept);
}

#[test]
fn a_wrong_tolerance_says_what_is_expected() {
    let mut bench = of_template();
    choose(&mut bench, "Stated");
    let before = stated(&bench).clone();
    enter(&mut bench, "Tolerance of winch scale", "-1");
    let said = bench.said();
    assert_eq!(
        said,
        "Tolerance of winch scale: found -1 %, expected 0 or more."
    );
    bench.harness.key_press(Key::Escape);
    settle(&mut bench.harness);
    enter(&mut bench, "Tolerance of winch scale", "about 2");
    let said = bench.said();
    assert!(
        said.contains("found \"about 2\", expected a number"),
        "{said}"
    );
    assert_eq!(*stated(&bench), before);
}

#[test]
fn cables_that_the_file_names_are_shown_edited_and_kept() {
    let bench = Bench::with_robot(|robot| {
        robot["tolerances"] = serde_json::json!({
            "factor": 2.0,
            "winch_scale": {"cable-3": 1e-3, "default": 2e-4},
            "winch_scale_common": 1e-4,
            "tracker_frame": 1e-3
        });
    });
    let mut bench = opened(bench);
    assert!(bench.shows("of cable-3"));
    assert!(bench.shows("kept as it is: frame of the external instrument"));
    enter(&mut bench, "Tolerance of winch scale", "0.03");
    enter(&mut bench, "Tolerance of winch scale, cable-3", "0.2");
    let now = stated(&bench);
    assert_eq!(now.factor, 2.0);
    assert_eq!(now.others("winch_scale_common"), Some(1e-4));
    assert_eq!(now.others("tracker_frame"), Some(1e-3));
    let close = |sd: f64, expected: f64| (sd / expected - 1.0).abs() < 1e-9;
    assert!(close(now.sd_of("winch_scale", Some("cable-1")), 3e-4));
    assert!(close(now.sd_of("winch_scale", Some("cable-3")), 2e-3));
    enter(&mut bench, "Tolerance of winch scale, cable-3", " ");
    assert!(close(
        stated(&bench).sd_of("winch_scale", Some("cable-3")),
        3e-4
    ));
    assert!(!bench.shows("of cable-3"));
}

#[test]
fn readings_of_a_measured_robot_say_what_tolerances_are_worth() {
    let mut bench = Bench::new();
    let path = std::path::PathBuf::from("sessions/clean-mini/session.json");
    give(&mut bench.harness, FileCommand::Open(path));
    press(&mut bench.harness, "Do not save");
    let bench = opened(bench);
    assert!(bench.shows("at 41 measured poses"));
}
