//! check --against and plan --check-against: is a robot as it was at its calibration?

use serde_json::{Value, json};
use tautline_core::effect::Hypothesis;
use tautline_core::measurement::Dataset;
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{PhaseData, Session, Timestamp, write_dataset, write_session};

use super::program::{Folder, assert_number, assert_valid, tautline};

/// The readings of a true robot at some poses.
fn readings(truth: &Robot, (poses, seed): (usize, u64)) -> Dataset {
    let preset = presets::find("mini").expect("a preset");
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    };
    simulate(truth, &options).expect("a run").dataset
}

/// Writes a run of a true robot with some poses, described by the drawing.
fn run(folder: &Folder, name: &str, truth: &Robot, poses_and_seed: (usize, u64)) -> String {
    let mut dataset = readings(truth, poses_and_seed);
    dataset.robot = mini();
    let path = folder.join(name);
    write_dataset(path.as_ref(), &dataset, &PhaseData::default()).expect("written");
    path
}

fn mini() -> Robot {
    presets::find("mini").expect("a preset").robot
}

fn edit(run: &str, change: impl FnOnce(&mut Value)) {
    let path = format!("{run}/robot.json");
    let text = std::fs::read_to_string(&path).expect("a robot");
    let mut robot: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut robot);
    std::fs::write(&path, robot.to_string()).expect("written");
}

#[test]
fn an_unchanged_robot_is_as_it_was_and_a_moved_pulley_and_a_drum_are_told_apart() {
    let folder = Folder::new();
    let robot = mini();
    let mut moved = robot.clone();
    moved.cables[0].pulley.entry_point_m[0] += 0.015;
    let mut wound = robot.clone();
    wound.effects = serde_json::from_value(json!([
        { "effect": "winch_scale", "targets": ["cable-3"], "parameters": { "scale": 0.01 } }
    ]))
    .expect("an effect");
    let before = run(&folder, "before", &robot, (40, 1));
    edit(&before, |robot| {
        robot["measured_at"] = json!("2026-03-12T09:00:00Z");
    });
    let same = run(&folder, "same", &robot, (12, 2));
    let moved = run(&folder, "moved", &moved, (12, 3));
    let wound = run(&folder, "wound", &wound, (12, 4));

    let found = tautline(&["check", &same, "--against", &before, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&found);
    assert_eq!(found["format"], "tautline-check");
    assert_eq!(
        (&found["verdict"], &found["ready"]),
        (&json!("unchanged"), &json!(true))
    );
    assert_eq!(found["detectable"].as_array().map(Vec::len), Some(8));
    let readable = tautline(&["check", &same, "--against", &before])
        .succeeded()
        .stdout;
    assert!(
        readable.starts_with("As on 2026-03-12: no change is visible."),
        "{readable}"
    );
    assert!(
        readable.contains("would be found with 95 % probability"),
        "{readable}"
    );

    let found = tautline(&["check", &moved, "--against", &before, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&found);
    assert_eq!(found["verdict"], "changed");
    assert_eq!(found["changes"][0]["targets"], json!(["cable-1"]));
    assert_eq!(found["changes"][0]["effect"], Value::Null);
    assert_number(&found, "/changes/0/displacement_m/0", 0.015, 0.005);

    let readable = tautline(&["check", &wound, "--against", &before])
        .succeeded()
        .stdout;
    assert!(
        readable.starts_with("Something changed: winch scale (cable-3) by "),
        "{readable}"
    );
}

/// A fault that no effect of the catalogue describes.
const CROSSTALK: &str = include_str!("../../fuzz/seeds/hypothesis/crosstalk.toml");

#[test]
fn a_hypothesis_of_the_calibration_need_not_be_in_the_description_of_today() {
    let folder = Folder::new();
    let mut truth = mini();
    let hypothesis = Hypothesis::parse(CROSSTALK).expect("a hypothesis");
    truth.add_hypothesis(&hypothesis).expect("room for it");
    let described = truth.clone();
    truth.effects = serde_json::from_value(json!([
        { "effect": "encoder_crosstalk", "targets": ["cable-3"], "parameters": { "share": 0.01 } }
    ]))
    .expect("an effect");
    let mut session = Session::new("before", described, Timestamp::from_unix_seconds(0));
    session.measurements = readings(&truth, (40, 1)).measurements;
    session.settings.identification.effects = truth.effects.clone();
    let before = folder.join("before.json");
    write_session(before.as_ref(), &session).expect("written");
    let today = run(&folder, "today", &truth, (12, 2));

    let found = tautline(&["check", &today, "--against", &before, "--json", "-"])
        .succeeded()
        .json();
    assert_eq!(found["verdict"], "unchanged");
}

#[test]
fn another_machine_is_refused_and_spoilt_readings_are_said_before_anything_is_compared() {
    let folder = Folder::new();
    let robot = mini();
    let before = run(&folder, "before", &robot, (25, 1));
    let today = run(&folder, "today", &robot, (8, 2));
    edit(&before, |robot| robot["serial_number"] = json!("T-17"));
    edit(&today, |robot| robot["serial_number"] = json!("T-18"));
    tautline(&["check", &today, "--against", &before])
        .refused(&["today", "serial_number: found \"T-18\", expected \"T-17\""]);
    edit(&today, |robot| robot["serial_number"] = json!(" "));
    tautline(&["check", &today, "--against", &before]).refused(&["/serial_number"]);
    let empty = folder.join("nothing");
    tautline(&["check", &before, "--against", &empty]).refused(&["nothing"]);
}

#[test]
fn the_poses_of_a_check_are_planned_with_what_they_find() {
    let folder = Folder::new();
    let before = run(&folder, "before", &mini(), (40, 1));
    let table = folder.join("check.csv");
    let plan = tautline(&[
        "plan",
        "--check-against",
        &before,
        "--detect",
        "8mm",
        "-o",
        &table,
        "--json",
        "-",
    ])
    .succeeded()
    .json();
    assert_valid(&plan);
    assert_eq!(plan["poses"].as_array().map(Vec::len), Some(8));
    let detection = plan["detection"].as_array().expect("pulleys");
    assert_eq!(detection.len(), 8);
    for pulley in detection {
        let (found_m, probability) = (&pulley["move_m"], &pulley["probability"]);
        let is_larger = found_m.as_f64().expect("a move") > 0.008;
        let is_found = probability.as_f64().expect("a probability") >= 0.95;
        // Both are from the same random moves; only the edge is rounded.
        assert!(
            is_larger != is_found || found_m.as_f64() < Some(0.0082),
            "{pulley}"
        );
    }
    let lines = std::fs::read_to_string(&table).expect("a plan");
    assert_eq!(lines.lines().count(), 9);
    tautline(&["plan", "--check-against", &before, "--detect", "2"])
        .refused(&["--detect", "expected a length such as 2mm, or faults"]);
    tautline(&["plan", "mini", "--detect", "2mm"])
        .refused(&["--detect: expected only with --check-against"]);
}
