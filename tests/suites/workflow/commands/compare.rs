//! compare: runs of one robot, of a robot with a moved pulley, and of others.

use serde_json::Value;
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{PhaseData, write_dataset};

use super::program::{Folder, assert_number, assert_valid, tautline};

/// Writes a run of a true robot that is described by the drawing.
pub(super) fn write_run(folder: &Folder, name: &str, truth: &Robot, seed: u64) -> String {
    let preset = presets::find("mini").expect("a preset");
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(25, seed)
    };
    let mut dataset = simulate(truth, &options).expect("a run").dataset;
    dataset.robot = preset.robot;
    let path = folder.join(name);
    write_dataset(path.as_ref(), &dataset, &PhaseData::default()).expect("written");
    path
}

fn moved(document: &Value) -> Vec<&str> {
    let pulleys = document["pulleys"].as_array().expect("pulleys");
    let moved = pulleys.iter().filter(|pulley| pulley["moved"] == true);
    moved
        .filter_map(|pulley| pulley["cable"].as_str())
        .collect()
}

#[test]
fn a_moved_pulley_is_distinguished_from_noise() {
    let folder = Folder::new();
    let robot = presets::find("mini").expect("a preset").robot;
    let mut changed = robot.clone();
    changed.cables[4].pulley.entry_point_m[1] -= 0.01;
    let before = write_run(&folder, "before", &robot, 1);
    let again = write_run(&folder, "again", &robot, 2);
    let after = write_run(&folder, "after", &changed, 4);

    let same = tautline(&["compare", &before, &again, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&same);
    assert_eq!(same["format"], "tautline-comparison");
    assert_eq!(
        (&same["different"], moved(&same).len()),
        (&Value::Bool(false), 0)
    );

    let other = tautline(&["compare", &before, &after, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&other);
    assert_eq!(moved(&other), ["cable-5"]);
    assert_number(&other, "/pulleys/4/relative/vector_m/1", -0.01, 0.005);
    let readable = tautline(&["compare", &before, &after]).succeeded().stdout;
    assert!(
        readable.contains("1 pulley has moved: cable-5."),
        "{readable}"
    );
    assert!(readable.contains("noise"), "{readable}");
}

#[test]
fn runs_of_different_robots_are_refused() {
    let folder = Folder::new();
    let [mini, planar] = ["mini", "planar"].map(|robot| {
        let out = folder.join(robot);
        tautline(&["simulate", "--robot", robot, "--out", &out]).succeeded();
        out
    });
    tautline(&["compare", &mini, &planar]).refused(&["cables"]);
    tautline(&["compare", &mini, &folder.join("nothing")]).refused(&["nothing"]);
    tautline(&["compare", &mini, &mini, "--level", "2"]).refused(&["--level", "found 2"]);
}

#[test]
fn a_comparison_has_a_report_of_its_own() {
    let folder = Folder::new();
    let robot = presets::find("mini").expect("a preset").robot;
    let (first, second) = (
        write_run(&folder, "one", &robot, 1),
        write_run(&folder, "two", &robot, 2),
    );
    for name in ["compared.html", "compared.pdf"] {
        let out = folder.join(name);
        tautline(&["compare", &first, &second, "--report", &out]).succeeded();
        let bytes = std::fs::read(&out).expect("the report");
        assert!(bytes.len() > 10_000, "{name}");
    }
    let text = std::fs::read_to_string(folder.join("compared.html")).expect("text");
    assert!(text.contains("No pulley has moved") && text.contains("Compared by"));
    let wrong = ["compare", &first, &second, "--report", "compared.txt"];
    tautline(&wrong).refused(&["compared.txt", ".html"]);
}
