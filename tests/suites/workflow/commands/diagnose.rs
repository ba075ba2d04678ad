//! diagnose.

use serde_json::Value;
use tautline_validation::support::bad_input_cases::write_good_dataset;

use super::program::{Answer, Folder, assert_number, assert_valid, number, tautline};

fn simulate(folder: &Folder, poses: u32, more: &[&str]) -> String {
    let dataset = folder.join("data");
    let poses = poses.to_string();
    let mut arguments = vec!["simulate", "--robot", "mini", "--poses", &poses];
    arguments.extend(["--seed", "7", "--out", &dataset]);
    arguments.extend(more);
    tautline(&arguments).succeeded();
    dataset
}

fn diagnose(dataset: &str, more: &[&str]) -> Answer {
    let arguments = [&["diagnose", dataset], more].concat();
    tautline(&arguments).succeeded()
}

/// Returns whether a value is of the type that the file format requires.
type OfType = fn(&Value) -> bool;

/// Asserts that every key exists and has its type.
fn assert_keys(value: &Value, keys: &[(&str, OfType)]) {
    for (pointer, of_type) in keys {
        let found = value.pointer(pointer);
        let found = found.unwrap_or_else(|| panic!("no {pointer} in {value}"));
        assert!(of_type(found), "{pointer} is {found}");
    }
}

fn assert_contract(diagnosis: &Value) {
    assert_valid(diagnosis);
    assert_eq!(diagnosis["format"], "tautline-diagnosis");
    assert_eq!(diagnosis["version"], 1);
    let keys: [(&str, OfType); 8] = [
        ("/adequate", Value::is_boolean),
        ("/global_test/chi2", Value::is_number),
        ("/global_test/dof", Value::is_number),
        ("/global_test/p_value", Value::is_number),
        ("/discrepancy", Value::is_array),
        ("/findings", Value::is_array),
        ("/model", Value::is_object),
        ("/model/effects", Value::is_array),
    ];
    assert_keys(diagnosis, &keys);
    for found in diagnosis["discrepancy"].as_array().expect("a list") {
        let keys: [(&str, OfType); 5] = [
            ("/reading", Value::is_string),
            ("/target", |v| v.is_string() || v.is_null()),
            ("/rms_over_sd", Value::is_number),
            ("/depends_on", Value::is_string),
            ("/p_value", Value::is_number),
        ];
        assert_keys(found, &keys);
    }
}

fn assert_finding(finding: &Value) {
    let keys: [(&str, OfType); 15] = [
        ("/verdict", Value::is_string),
        ("/probability", Value::is_number),
        ("/effect", Value::is_string),
        ("/targets", Value::is_array),
        ("/cause", Value::is_string),
        ("/alternatives", Value::is_array),
        ("/parameters/0/name", Value::is_string),
        ("/parameters/0/value", Value::is_number),
        ("/parameters/0/unit", Value::is_string),
        ("/parameters/0/sd", |v| v.is_number() || v.is_null()),
        ("/evidence/delta_chi2", Value::is_number),
        ("/evidence/p_value", Value::is_number),
        ("/gain/holdout_before", Value::is_number),
        ("/gain/holdout_after", Value::is_number),
        ("/gain/poses_held_out", Value::is_u64),
    ];
    assert_keys(finding, &keys);
    assert_eq!(finding["gain"]["unit"], "rms over sd");
    let runner_up = &finding["evidence"]["runner_up"];
    if !runner_up.is_null() {
        let keys: [(&str, OfType); 3] = [
            ("/effect", Value::is_string),
            ("/targets", Value::is_array),
            ("/delta_chi2", Value::is_number),
        ];
        assert_keys(runner_up, &keys);
    }
}

#[test]
fn a_hidden_winch_scale_is_named() {
    let folder = Folder::new();
    let hidden = ["--effect", "winch_scale:cable-3:scale=0.01"];
    let dataset = simulate(&folder, 40, &hidden);
    let (json, model) = (folder.join("diagnosis.json"), folder.join("model.json"));
    let answer = diagnose(&dataset, &["--json", &json, "--model-out", &model]);
    let first = answer.stdout.lines().next();
    assert!(first.is_some_and(|line| line.contains("does NOT explain the readings")));
    assert!(answer.stdout.contains("\n1. Winch scale (cable-3)"));
    assert!(answer.stdout.contains("Improvement: "));
    assert_eq!(answer.stderr, "");

    let diagnosis = folder.json("diagnosis.json");
    assert_contract(&diagnosis);
    assert_eq!(diagnosis["adequate"], false);
    let finding = &diagnosis["findings"][0];
    assert_finding(finding);
    assert_eq!(finding["effect"], "winch_scale");
    assert_eq!(finding["targets"], serde_json::json!(["cable-3"]));
    assert_eq!(finding["parameters"][0]["name"], "scale");
    let sd = number(finding, "/parameters/0/sd");
    assert_number(finding, "/parameters/0/value", 0.01, 5.0 * sd);
    assert!(number(finding, "/gain/holdout_after") < number(finding, "/gain/holdout_before"));

    assert_valid(&folder.json("model.json"));
    assert_eq!(
        folder.json("model.json")["effects"],
        diagnosis["model"]["effects"]
    );
    let arguments = ["evaluate", &dataset, "--model", &model, "--json", "-"];
    let evaluation = tautline(&arguments).succeeded().json();
    assert!(number(&evaluation, "/p_value") > 1e-4);
}

/// A model explains the data with which it was found as well as it did then, also where its effects depend on where
/// the platform is.
#[test]
fn a_diagnosed_model_evaluates_to_the_same_result() {
    let hidden = [
        "winch_scale:cable-3:scale=0.02",
        "pulley_friction:mu=0.06",
        "frame_compliance:compliance=0.00003",
        "cable_stiffness:cable-2:change=0.5",
    ];
    // Of the geometry: `diagnose` counts them, `evaluate` does not. They are those of the first effect, which depends on no
    // pose; the geometry of all runs is the same.
    let mut priors = None;
    for effect in hidden {
        let folder = Folder::new();
        let dataset = simulate(&folder, 60, &["--effect", effect]);
        let model = folder.join("model.json");
        let diagnosis = diagnose(&dataset, &["--json", "-", "--model-out", &model]).json();
        let findings = diagnosis["findings"].as_array().expect("a list");
        assert!(!findings.is_empty(), "{effect}");
        let arguments = ["evaluate", &dataset, "--model", &model, "--json", "-"];
        let evaluation = tautline(&arguments).succeeded().json();
        let found = number(&diagnosis, "/extended/global_test/chi2");
        let again = number(&evaluation, "/chi2");
        println!("{effect}: found {found}, evaluated {again}");
        let priors = *priors.get_or_insert(found - again);
        assert!(
            priors > 0.0 && again <= found - priors + 1.0,
            "{effect}: {found} {again}"
        );
    }
}

#[test]
fn clean_data_have_no_findings() {
    let folder = Folder::new();
    let dataset = simulate(&folder, 25, &[]);
    let diagnosis = diagnose(&dataset, &["--json", "-"]).json();
    assert_contract(&diagnosis);
    assert_eq!(diagnosis["adequate"], true);
    assert_eq!(diagnosis["findings"], serde_json::json!([]));
    let text = diagnose(&dataset, &[]).stdout;
    assert!(text.starts_with("mini: the model explains the readings of 26 poses.\n"));
    let explained = diagnose(&dataset, &["--explain"]).stdout;
    assert!(explained.starts_with(text.trim_end()));
    assert!(explained.contains("Tests of the original model"));
}

#[test]
fn what_the_data_cannot_separate_is_listed() {
    let folder = Folder::new();
    // At the last pose, a slip of the cable and a wrong reading are the same.
    let hidden = ["--effect", "cable_slip:cable-3:step=0.02,pose=25"];
    let dataset = simulate(&folder, 25, &hidden);
    let json = folder.join("diagnosis.json");
    let text = diagnose(&dataset, &["--json", &json]).stdout;
    assert!(text.contains("These data cannot tell it from: "), "{text}");
    assert!(text.contains("What decides between them: "), "{text}");
    let diagnosis = folder.json("diagnosis.json");
    assert_contract(&diagnosis);
    let finding = &diagnosis["findings"][0];
    assert_finding(finding);
    assert_eq!(finding["verdict"], "ambiguous");
    let alternatives = finding["alternatives"].as_array().expect("a list");
    let mut named: Vec<_> = alternatives.iter().map(|other| &other["effect"]).collect();
    named.push(&finding["effect"]);
    for effect in ["cable_slip", "encoder_outlier"] {
        assert!(
            named.iter().any(|name| *name == effect),
            "no {effect} in {named:?}"
        );
    }
}

#[test]
fn a_diagnosis_ends_at_its_time_limit_and_says_so() {
    let folder = Folder::new();
    let hidden = ["--effect", "winch_scale:cable-3:scale=0.02"];
    let dataset = simulate(&folder, 25, &hidden);
    let text = diagnose(&dataset, &["--time-limit", "0.001"]).stdout;
    let expected = "The diagnosis ended at its time limit of 0.001 s: causes are possible ones only, and faults may be missing.";
    assert!(text.contains(expected), "{text}");
    let diagnosis = diagnose(&dataset, &["--time-limit=0.001", "--json", "-"]).json();
    assert_eq!(diagnosis["complete"], false);
}

/// The sample session of a winch that pays out too much, with the effects that were added to its model.
fn session(folder: &Folder, effects: &Value, poses: bool) -> String {
    let sample = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../sessions/mini-winch-scale/session.json"
    );
    let text = std::fs::read_to_string(sample).expect("the sample session");
    let mut session: Value = serde_json::from_str(&text).expect("JSON");
    session["settings"]["identification"]["effects"] = effects.clone();
    if !poses {
        session["measurements"] = serde_json::json!({});
    }
    folder.write("session.json", &session.to_string())
}

#[test]
fn a_session_is_diagnosed_with_the_effects_of_its_model() {
    let folder = Folder::new();
    let as_measured = session(&folder, &serde_json::json!([]), true);
    let found = diagnose(&as_measured, &["--json", "-"]).json();
    assert_eq!(found["findings"][0]["effect"], "winch_scale");
    let scale = serde_json::json!([{"effect": "winch_scale", "targets": ["cable-3"]}]);
    let extended = session(&folder, &scale, true);
    let text = diagnose(&extended, &[]).stdout;
    assert!(
        text.contains("the model explains the readings of 41 poses."),
        "{text}"
    );
    let empty = session(&folder, &scale, false);
    let reasons = ["session.json", "there are no measured poses"];
    tautline(&["diagnose", &empty]).refused(&reasons);
    let table = folder.write("winch.csv", "cable,revolutions,length_m\ncable-1,1,0.1\n");
    tautline(&["diagnose", &table]).refused(&["winch.csv"]);
}

#[test]
fn the_level_is_a_probability() {
    let folder = Folder::new();
    let data = folder.join("data");
    write_good_dataset(data.as_ref()).expect("written");
    for alpha in ["0", "0.5", "-1", "NaN"] {
        let argument = format!("--alpha={alpha}");
        let parts = ["--alpha", alpha, "above 0 and below 0.5"];
        tautline(&["diagnose", &data, &argument]).refused(&parts);
    }
    for limit in ["0", "-1", "NaN"] {
        let argument = format!("--time-limit={limit}");
        let parts = ["--time-limit", limit, "seconds above 0"];
        tautline(&["diagnose", &data, &argument]).refused(&parts);
    }
    let answer = tautline(&["diagnose", &folder.join("nowhere")]);
    answer.refused(&["nowhere: not found, expected a session file or a dataset folder"]);
}
