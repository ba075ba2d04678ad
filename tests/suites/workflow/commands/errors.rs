//! Exit codes and messages.

#[cfg(target_os = "linux")]
use std::process::Command;
#[cfg(unix)]
use std::process::Stdio;

use tautline_validation::support::bad_input_cases::{bad_inputs, write_good_dataset};
#[cfg(target_os = "linux")]
use tautline_validation::support::program::program;
#[cfg(unix)]
use tautline_validation::support::program::start;

use super::program::{Folder, tautline};

/// Cases of the table that go through the program, too; all of them go through the reader.
const REPRESENTATIVE: [&str; 11] = [
    "no folder",
    "no robot.json",
    "robot.json a folder",
    "truncated JSON",
    "robot.json not UTF-8",
    "a number out of range",
    "no poses.csv",
    "header only",
    "a cell not UTF-8",
    "surface of degree 9",
    "winch: unknown cable",
];

#[test]
fn bad_input_ends_with_code_2_and_one_sentence() {
    let folder = Folder::new();
    let cases = bad_inputs();
    for name in REPRESENTATIVE {
        let case = cases.iter().find(|case| case.name == name);
        let case = case.unwrap_or_else(|| panic!("no case {name:?}"));
        let dataset = folder.join(&name.replace([' ', ':'], "-"));
        case.write(dataset.as_ref()).expect(name);
        let answer = tautline(&["identify", &dataset]);
        answer.refused(case.expected);
        answer.refused(&[&dataset]);
    }
}

#[test]
fn unknown_names_are_reported() {
    let folder = Folder::new();
    let data = folder.join("data");
    write_good_dataset(data.as_ref()).expect("written");
    for (arguments, parts) in [
        (["identify", &data, "--effects", "winch_scal"], "winch_scal"),
        (
            ["identify", &data, "--effects", "winch_scale:cable-9"],
            "cable-9",
        ),
        (["simulate", "--robot", "maxi", "--out=x"], "\"maxi\""),
        (
            ["evaluate", &data, "--model", "no-model.json"],
            "no-model.json: not found",
        ),
    ] {
        tautline(&arguments).refused(&[parts]);
    }
    let out = folder.join("out");
    for (effect, part) in [
        ("winch_scal:cable-1", "winch_scal"),
        ("winch_scale:cable-9:scale=0.01", "cable-9"),
        ("winch_scale:cable-1:scale=x", "scale=x"),
        ("winch_scale:cable-1:size=1", "size"),
        (
            "cable_slip:cable-3:step=0.01,pose=99",
            "no pose labelled 99",
        ),
    ] {
        let arguments = ["simulate", "--robot", "mini", "--effect", effect];
        tautline(&[&arguments[..], &["--out", &out]].concat()).refused(&["--effect", part]);
    }
    for command in ["identify", "precalibrate"] {
        let answer = tautline(&[command, &folder.join("nowhere")]);
        answer.refused(&["nowhere: not found, expected a session file or a dataset folder"]);
    }
}

#[test]
fn a_measured_elongation_is_not_extrapolated() {
    let folder = Folder::new();
    let data = folder.join("data");
    let arguments = ["simulate", "--robot", "mini", "--poses", "12", "--out"];
    tautline(&[&arguments[..], &[&data]].concat()).succeeded();
    // Measured up to 1 N: below all tensions.
    let mut robot = folder.json("data/robot.json");
    robot["cables"][1]["cable"]["elongation_surface"] = serde_json::json!({
        "degree": 1, "length_center_m": 1.4, "length_scale_m": 1.2,
        "tension_center_n": 0.5, "tension_scale_n": 0.5,
        "coefficients": [0.0, 0.0, 1e-5], "residual_sd_m": 1e-6
    });
    let model = folder.write("model.json", &robot.to_string());
    let parts = [
        "pose 0, cable-2: the tension",
        "outside the measured range",
        "and 12 more",
    ];
    tautline(&["evaluate", &data, "--model", &model]).refused(&parts);
    folder.write("data/robot.json", &robot.to_string());
    tautline(&["identify", &data]).refused(&parts);
}

#[test]
fn a_wrong_command_line_ends_with_code_2() {
    for (arguments, part) in [
        (vec!["identify", "data", "--method", "guess"], "guess"),
        (vec!["calibrate"], "calibrate"),
        (vec!["identify"], "DATASET"),
    ] {
        let answer = tautline(&arguments);
        assert_eq!((answer.code, answer.stdout.as_str()), (Some(2), ""));
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
    let help = tautline(&["--help"]).succeeded();
    assert!(help.stdout.contains("identify") && help.stderr.is_empty());
}

#[test]
fn other_failures_end_with_code_1() {
    let folder = Folder::new();
    let data = folder.join("data");
    let arguments = ["simulate", "--robot", "planar", "--poses", "6", "--out"];
    tautline(&[&arguments[..], &[&data]].concat()).succeeded();
    let nowhere = folder.join("nowhere/result.json");
    for option in ["--json", "--model-out"] {
        let answer = tautline(&["identify", &data, option, &nowhere]);
        assert_eq!(answer.code, Some(1), "{}", answer.stderr);
        assert_eq!(answer.stderr.lines().count(), 1, "{}", answer.stderr);
        assert!(answer.stderr.contains("cannot be written"));
        assert_eq!(said_by_the_system(&answer.stderr), 1, "{}", answer.stderr);
    }
}

/// Number of error texts of the operating system in a message.
fn said_by_the_system(message: &str) -> usize {
    message.matches("os error").count()
}

#[cfg(unix)]
#[test]
fn what_the_system_says_is_said_once() {
    let folder = Folder::new();
    // Reading a file under this name fails, whoever asks.
    let looped = folder.join("loop");
    std::os::unix::fs::symlink(&looped, &looped).expect("a link");
    let session = format!("{looped}/s.json");
    for arguments in [
        vec!["identify", &looped],
        vec!["report", &looped, "--out", "r.html"],
        vec!["accuracy", &looped],
        vec!["compare", &looped, &looped],
        vec!["import", &looped, "--out", "d"],
        vec!["study", "plan", &looped, "--out", "d"],
        vec!["study", "merge", &session],
        vec!["simulate", "--robot", &looped, "--out", "d"],
        vec!["simulate", "--robot", "mini", "--out", &session],
    ] {
        let answer = tautline(&arguments);
        let said = &answer.stderr;
        assert!(answer.code.is_some_and(|code| code != 0), "{arguments:?}");
        assert_eq!(said.lines().count(), 1, "{arguments:?}: {said}");
        assert!(said_by_the_system(said) <= 1, "{said}");
        assert!(said.contains(&looped), "{said}");
    }
}

/// Commands that print on standard output: text, JSON, help.
#[cfg(unix)]
fn talkative(data: &str) -> [Vec<&str>; 5] {
    [
        vec!["effects"],
        vec!["identify", data],
        vec!["identify", data, "--json", "-"],
        vec!["symbols", "mini", "--out", "-"],
        vec!["identify", "--help"],
    ]
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_an_error() {
    let folder = Folder::new();
    let data = folder.join("data");
    write_good_dataset(data.as_ref()).expect("written");
    for words in talkative(&data) {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let answer = Command::new(program())
            .args(&words)
            .stdin(Stdio::null())
            .stdout(full.expect("a full device"))
            .output()
            .expect("it starts");
        let told = String::from_utf8(answer.stderr).expect("UTF-8");
        assert_eq!(answer.status.code(), Some(1), "{words:?}: {told}");
        let last = told.lines().last().expect("a sentence");
        assert!(
            last.starts_with("standard output: cannot be written ("),
            "{words:?}: {told}"
        );
    }
}

#[cfg(unix)]
#[test]
fn a_reader_that_stops_reading_is_no_error() {
    let folder = Folder::new();
    let data = folder.join("data");
    write_good_dataset(data.as_ref()).expect("written");
    for words in talkative(&data) {
        let mut child = start(&words, Stdio::null());
        drop(child.stdout.take());
        let answer = child.wait_with_output().expect("it ends");
        let told = String::from_utf8(answer.stderr).expect("UTF-8");
        assert_eq!(answer.status.code(), Some(0), "{words:?}: {told}");
    }
}
