//! Effects of the user as text: the page, the files beside a dataset, model files and sessions, and what is refused.

use serde_json::Value;
use tautline_core::effect::every_effect;
use tautline_validation::generators::hypotheses;

use super::program::{Folder, assert_valid, tautline};

/// The hypothesis files of the page, in a folder.
fn page_files(folder: &Folder) {
    let page = std::fs::read_to_string(hypotheses::page()).expect("the page");
    let files = hypotheses::files(&page);
    assert_eq!(files.len(), 2);
    for (name, content) in files {
        folder.write(&name, &content);
    }
}

/// A dataset with crosstalk of cable 3.
fn dataset(folder: &Folder) -> String {
    page_files(folder);
    let (file, out) = (folder.join("crosstalk.toml"), folder.join("bad"));
    let effect = "encoder_crosstalk:cable-3:share=0.01";
    let arguments = [
        "simulate", "--robot", "mini", "--poses", "40", "--seed", "4",
    ];
    let more = ["--hypothesis", &file, "--effect", effect, "-o", &out];
    tautline(&[&arguments[..], &more].concat()).succeeded();
    out
}

#[test]
fn the_page_is_as_the_program_answers() {
    let text = std::fs::read_to_string(hypotheses::page()).expect("the page");
    assert_eq!(
        hypotheses::with_outputs(&text).expect("outputs"),
        text,
        "validation hypotheses writes the page"
    );
}

#[test]
fn a_hypothesis_beside_a_dataset_is_named_and_models_carry_it() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let without = tautline(&["diagnose", &data, "--json", "-", "--time-limit", "600"])
        .succeeded()
        .json();
    let effects = |document: &Value| -> Vec<String> {
        let findings = document["findings"].as_array().expect("findings");
        let names = findings.iter().filter_map(|f| f["effect"].as_str());
        names.map(str::to_owned).collect()
    };
    assert!(!effects(&without).contains(&"encoder_crosstalk".to_owned()));

    std::fs::create_dir(folder.path().join("bad/effects")).expect("a folder");
    let text = std::fs::read_to_string(folder.join("crosstalk.toml")).expect("a file");
    folder.write("bad/effects/crosstalk.toml", &text);
    let model = folder.join("model.json");
    let arguments = [
        "diagnose",
        &data,
        "--json",
        "-",
        "--time-limit",
        "600",
        "--model-out",
        &model,
    ];
    let found = tautline(&arguments).succeeded().json();
    assert_eq!(effects(&found), ["encoder_crosstalk"]);
    assert_eq!(
        found["findings"][0]["targets"],
        serde_json::json!(["cable-3"])
    );
    assert_valid(&found);

    let written = folder.json("model.json");
    assert_valid(&written);
    assert_eq!(written["hypotheses"], serde_json::json!([text]));
    assert_eq!(written["effects"][0]["effect"], "encoder_crosstalk");
    // The model opens where the file of the hypothesis is not.
    let elsewhere = Folder::new();
    let copy = elsewhere.write("model.json", &written.to_string());
    tautline(&["evaluate", &data, "--model", &copy]).succeeded();
}

#[test]
fn identification_and_plans_take_it() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let file = folder.join("crosstalk.toml");
    let effect = "encoder_crosstalk:cable-3";
    let arguments = ["identify", &data, "--hypothesis", &file, "--effect", effect];
    let model = folder.join("identified.json");
    tautline(&[&arguments[..], &["--model-out", &model]].concat()).succeeded();
    let share = folder.json("identified.json")["effects"][0]["parameters"]["share"].as_f64();
    assert!((share.expect("a number") - 0.01).abs() < 3e-3);

    let plan = [
        "plan",
        "mini",
        "--poses",
        "12",
        "--candidates",
        "300",
        "--explain",
    ];
    let planned = tautline(&[&plan[..], &["--hypothesis", &file]].concat()).succeeded();
    assert!(
        planned
            .stdout
            .contains("Crosstalk between neighbouring encoders")
    );
}

#[test]
fn the_catalogue_can_be_written_and_read_again() {
    let folder = Folder::new();
    for effect in every_effect() {
        let answer = tautline(&["effects", "--as-text", effect.id()]);
        if answer.code != Some(0) {
            answer.refused(&[effect.id(), "cannot be written as text: it "]);
            continue;
        }
        let file = folder.write(&format!("{}.toml", effect.id()), &answer.stdout);
        let list = tautline(&["effects", "--hypothesis", &file])
            .succeeded()
            .stdout;
        assert!(list.contains(&format!("my_{}", effect.id())), "{list}");
    }
}

#[test]
fn mistakes_are_named_with_file_line_and_column() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let text = std::fs::read_to_string(folder.join("crosstalk.toml")).expect("a file");
    let file = folder.write("wrong.toml", &text.replace("paid_of(next)", "tension"));
    let diagnose = ["diagnose", &data, "--hypothesis", &file];
    tautline(&diagnose).refused(&[&file, "line 13, column 16: found N, expected"]);
    let missing = folder.join("missing.toml");
    tautline(&["plan", "mini", "--hypothesis", &missing]).refused(&[&missing, "not found"]);
    // Two texts with one id.
    let right = folder.join("crosstalk.toml");
    let other = folder.write("other.toml", &text.replace("0.01]", "0.02]"));
    let both = [
        "check",
        &data,
        "--hypothesis",
        &right,
        "--hypothesis",
        &other,
    ];
    tautline(&both).refused(&[&other, "\"encoder_crosstalk\" with another text"]);
}
