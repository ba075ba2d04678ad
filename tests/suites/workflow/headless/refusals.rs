//! Refusals of the commands with a robot, each in one sentence.

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use tautline_validation::support::program::program;

use super::{beside, killed, plan, session};
use crate::commands::program::{Folder, assert_valid, tautline};

#[test]
fn bad_input_is_named_and_writes_nothing() {
    let folder = Folder::new();
    let new = folder.join("new.json");
    let known = folder.join("known.json");
    let plan = plan(&folder, 6);
    let begun = [
        "measure",
        &known,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
        "--plan",
        &plan,
    ];
    tautline(&begun);
    let labels = session(&known).measurements.labels;
    assert_eq!(labels.len(), 7);
    let text = std::fs::read_to_string(&plan).expect("a plan");
    let bad = folder.write("bad.csv", &text.replacen("\n2,", "\n2,x", 1));
    let recording = folder.join("recording");
    tautline(&[
        "simulate", "--robot", "planar", "--poses", "25", "--out", &recording,
    ])
    .succeeded();
    let other = format!("replay:{recording}");
    let missing = format!("replay:{}", folder.join("nowhere"));
    let sim = ["--controller", "sim", "--arm"];
    let with = |words: &[&str], more: &[&str]| tautline(&[words, more].concat());

    with(
        &["measure", &new, "--controller", "simulated", "--arm"],
        &[],
    )
    .refused(&[
        "--controller",
        "\"simulated\"",
        "expected sim, replay:DIR, ads:",
    ]);
    with(&["measure", &new], &sim).refused(&[&new, "not found", "--robot"]);
    with(
        &["measure", &new, "--robot", "mini", "--controller", "sim"],
        &[],
    )
    .refused(&["--arm"]);
    with(&["measure", &new, "--robot", "mini", "--plan", &bad], &sim)
        .refused(&["bad.csv, line 4, column \"x_m\"", "expected a number"]);
    with(
        &["measure", &new, "--robot", "mini", "--stop-at", "0"],
        &sim,
    )
    .refused(&["--stop-at"]);
    with(&["measure", &new, "--controller", &missing, "--arm"], &[])
        .refused(&["nowhere", "not found"]);
    with(
        &[
            "measure",
            &new,
            "--controller",
            "ads:robot/1.2.3.4.5",
            "--arm",
        ],
        &[],
    )
    .refused(&["--controller", "Net ID"]);
    with(&["measure", &known, "--controller", &other, "--arm"], &[])
        .refused(&["a recording of the robot \"planar\"", "\"mini\""]);
    with(&["measure", &known, "--robot", "hall"], &sim).refused(&["\"mini\"", "\"hall\""]);
    with(&["adjust", &new], &sim).refused(&[&new, "not found"]);
    with(&["adjust", &known, "--controller", "sim"], &[]).refused(&["--arm"]);
    with(&["adjust", &known, "--roll-back"], &sim).refused(&["nothing to roll back"]);
    with(&["verify", &known, "--controller", "sim"], &[]).refused(&["--arm"]);
    with(&["verify", &known, "--cycles", "1"], &sim).refused(&["--cycles"]);
    with(&["verify", &known, "--check", &plan], &[]).refused(&["plan.csv"]);
    let without = folder.join("without.json");
    let real = ["measure", &without, "--controller", &other, "--arm"];
    with(&real, &[]).succeeded();
    with(&["measure", &without], &sim).refused(&[&without, "no simulated robot"]);

    assert_eq!(session(&known).measurements.labels, labels);
    assert_eq!(beside(&new), Vec::<std::path::PathBuf>::new());
    assert_eq!(beside(&known), Vec::<std::path::PathBuf>::new());
    assert!(!std::path::Path::new(&new).exists());
}

#[test]
fn a_session_is_locked_while_a_command_works_on_it() {
    let folder = Folder::new();
    let file = folder.join("mini.json");
    let plan = plan(&folder, 6);
    let arguments = [
        "measure",
        &file,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--plan",
        &plan,
        "--arm",
    ];
    // In real time a run takes long enough to be met.
    let mut first = Command::new(program())
        .args(arguments)
        .args(["--speed", "1"])
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    while !std::path::Path::new(&file).exists() {
        assert!(
            first.try_wait().expect("a state").is_none(),
            "it ends early"
        );
        sleep(Duration::from_millis(2));
    }
    let second = tautline(&arguments);
    assert_eq!(second.code, Some(1));
    assert!(
        second
            .stderr
            .contains("another program is using this session"),
        "{}",
        second.stderr
    );
    first.kill().expect("it runs");
    first.wait().expect("it ends");
    tautline(&arguments);
    assert_eq!(session(&file).measurements.len(), 7);
}

/// An interrupted adjustment keeps everything from moving until it is settled.
#[test]
fn the_robot_does_not_move_with_partly_written_values() {
    let folder = Folder::new();
    let file = folder.join("mini.json");
    tautline(&[
        "measure",
        &file,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
    ])
    .succeeded();
    let adjust = ["adjust", &file, "--controller", "sim", "--arm"];
    let controller = format!("{file}.controller");
    for _ in 0..20 {
        killed(&adjust, |_| std::path::Path::new(&controller).exists());
        let last = session(&file)
            .adjustments()
            .last()
            .map(|last| last.outcome.clone());
        if last == Some(tautline_session::Outcome::Begun) {
            let sim = ["--controller", "sim", "--arm"];
            let refused = &[
                "an adjustment of the controller was interrupted",
                "tautline adjust",
            ];
            tautline(&[&["verify", &file], sim.as_slice()].concat()).refused(refused);
            tautline(&[&["measure", &file], sim.as_slice()].concat()).refused(refused);
            let dry = tautline(&["adjust", &file, "--controller", "sim", "--dry-run"]);
            assert!(dry.succeeded().stdout.contains("was interrupted"));
            assert_eq!(tautline(&adjust).code, Some(4));
            tautline(&[&["verify", &file], sim.as_slice()].concat()).succeeded();
            return;
        }
        tautline(&[adjust.as_slice(), &["--roll-back"]].concat());
    }
    panic!("no kill of 20 came before the end of writing");
}

#[test]
fn typed_readings_need_a_terminal() {
    let folder = Folder::new();
    let file = folder.join("mini.json");
    let plan = plan(&folder, 6);
    let recording = folder.join("recording");
    tautline(&[
        "simulate", "--robot", "mini", "--poses", "25", "--out", &recording,
    ])
    .succeeded();
    let sim = ["--controller", "sim", "--robot", "mini", "--arm"];
    let measure = [&["measure", &file, "--plan", &plan], sim.as_slice()].concat();
    // Without an operator the robot does not move.
    tautline(&[&measure, ["--laser", "manual"].as_slice()].concat()).refused(&[
        "not moved",
        "laser distances have to be typed",
        "terminal",
    ]);
    assert!(!std::path::Path::new(&file).exists());
    // An operator who types once: the measured pose is kept.
    let mut child = Command::new(program())
        .args(&measure)
        .args(["--laser", "manual"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut input = child.stdin.take().expect("a pipe");
    std::io::Write::write_all(&mut input, b"-\n").expect("it reads");
    drop(input);
    let answer = child.wait_with_output().expect("it ends");
    let told = String::from_utf8(answer.stderr).expect("text");
    assert_eq!(answer.status.code(), Some(2), "{told}");
    let last = told.lines().last().expect("a sentence");
    assert!(
        last.contains("No laser distance was typed for pose") && last.contains("continues"),
        "{told}"
    );
    let replay = format!("replay:{recording}");
    let real = folder.join("real.json");
    tautline(&["measure", &real, "--controller", &replay, "--arm"]).succeeded();
    tautline(&["verify", &real, "--controller", &replay, "--arm"]).refused(&[
        "not moved",
        "have to be typed",
        "terminal",
    ]);
}

#[test]
fn symbols_are_printed_and_need_a_controller_with_symbols() {
    let folder = Folder::new();
    let symbols = folder.join("symbols.json");
    let printed = tautline(&["symbols", "mini"]).succeeded().json();
    assert_valid(&printed);
    tautline(&["symbols", "mini", "--out", &symbols]).succeeded();
    assert_eq!(folder.json("symbols.json"), printed);
    let file = folder.join("mini.json");
    let with = |symbols: &str, controller: &str| {
        let words = ["measure", &file, "--robot", "mini", "--arm", "--symbols"];
        tautline(&[words.as_slice(), &[symbols, "--controller", controller]].concat())
    };
    with(&symbols, "sim").refused(&["--symbols", "controller sim", "expected ads:"]);
    let text = printed.to_string();
    let wrong = folder.write("wrong.json", &text.replace("\"GVL_Tautline.moving\"", "7"));
    let ads = "ads:127.0.0.1:1/1.2.3.4.5.6";
    with(&wrong, ads).refused(&["wrong.json", "/state/moving", "expected"]);
    let wrong = folder.write("wrong.json", &text.replace("GVL_Tautline.moving", "a b"));
    with(&wrong, ads).refused(&["wrong.json", "/state/moving", "the name of a symbol"]);
    with(&folder.join("none.json"), ads).refused(&["none.json", "not found"]);
    assert!(!std::path::Path::new(&file).exists());
}
