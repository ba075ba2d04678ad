//! formulas: an error that no cause explains, the pattern that it looks like, and the model extended by it.

use serde_json::{Value, json};
use tautline_validation::tables::formulas::UNNAMED;

use super::program::{Folder, assert_number, assert_valid, tautline};

#[test]
fn an_unexplained_error_gets_a_pattern_which_as_a_hypothesis_explains_it() {
    let folder = Folder::new();
    let [hidden, bad, out] = ["hidden.toml", "bad", "pattern.toml"].map(|name| folder.join(name));
    std::fs::write(&hidden, UNNAMED).expect("written");
    let effect = "oval_groove:cable-3:size=0.02";
    tautline(&[
        "simulate",
        "--robot",
        "mini",
        "--poses",
        "40",
        "--seed",
        "4",
        "--hypothesis",
        &hidden,
        "--effect",
        effect,
        "-o",
        &bad,
    ])
    .succeeded();
    let found = tautline(&[
        "formulas",
        &bad,
        "--time-limit",
        "600",
        "-o",
        &out,
        "--json",
        "-",
    ])
    .succeeded()
    .json();
    assert_valid(&found);
    assert_eq!(found["format"], "tautline-formulas");
    let first = &found["patterns"][0];
    assert_eq!(first["expression"], "position_z * wrap");
    assert_eq!(first["targets"], json!(["cable-3"]));
    assert!(first["probability"].as_f64() > Some(0.9), "{first}");
    assert_number(first, "/parameters/0/value", 0.02, 0.002);
    let [before, after] = ["/gain/holdout_before", "/gain/holdout_after"].map(|place| {
        first
            .pointer(place)
            .and_then(Value::as_f64)
            .expect("a number")
    });
    assert!(after < 1.3 && before > 3.0, "{before} to {after}");
    let readable = tautline(&["formulas", &bad]).succeeded().stdout;
    assert!(readable.contains("None of them is a cause"), "{readable}");

    let diagnosed = tautline(&["diagnose", &bad, "--hypothesis", &out, "--json", "-"])
        .succeeded()
        .json();
    assert_eq!(diagnosed["findings"][0]["effect"], first["effect"]);
    assert_eq!(diagnosed["extended"]["adequate"], true);
}

#[test]
fn where_everything_is_explained_there_are_no_patterns() {
    let folder = Folder::new();
    let good = folder.join("good");
    tautline(&["simulate", "--robot", "mini", "--poses", "25", "-o", &good]).succeeded();
    let told = tautline(&["formulas", &good]).succeeded().stdout;
    assert!(told.starts_with("Nothing is unexplained"), "{told}");
    let found = tautline(&["formulas", &good, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&found);
    assert_eq!(found["patterns"], json!([]));
    tautline(&["formulas", &folder.join("nothing")]).refused(&["nothing"]);
}
