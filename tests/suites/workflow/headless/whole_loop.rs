//! Measure, verify, adjust, verify: as a user does it, with the program.

use std::path::Path;

use serde_json::{Value, json};
use tautline_session::{NamedValue, Outcome, Stage, write_session};

use super::{beside, plan, session};
use crate::commands::program::{Folder, assert_valid, number, tautline};

/// Largest AP of the test poses and AT of the circle (mm), before and after.
fn figures(verification: &Value) -> [[f64; 2]; 2] {
    ["before", "after"].map(|stage| {
        let ap = number(verification, &format!("/{stage}/poses/largest_accuracy_m"));
        let at = number(verification, &format!("/{stage}/paths/0/accuracy_m"));
        assert_eq!(verification[stage]["paths"][0]["target"], "Circle");
        [1e3 * ap, 1e3 * at]
    })
}

#[test]
fn the_loop_improves_the_accuracy_of_the_robot() {
    let folder = Folder::new();
    let file = folder.join("mini.json");
    let sim = ["--controller", "sim", "--arm", "--json", "-"];
    let run = |words: &[&str]| {
        let answer = tautline(&[words, &[&file], &sim].concat()).succeeded();
        answer.json()
    };
    let measured = run(&["measure", "--robot", "mini", "--poses", "25"]);
    assert_valid(&measured);
    assert_eq!(
        (&measured["end"], &measured["enough"]),
        (&"finished".into(), &true.into())
    );
    assert_eq!(measured["measured"].as_array().map(Vec::len), Some(26));
    assert_eq!(beside(&file), Vec::<std::path::PathBuf>::new());
    assert_eq!(run(&["measure"])["measured_now"], Value::Array(Vec::new()));

    let before = run(&["verify"]);
    assert_valid(&before);
    assert_eq!(before["stage"], "before");
    let foreseen = run(&["adjust", "--dry-run"]);
    assert_eq!(foreseen["outcome"], "not_written");
    assert!(session(&file).adjustments().is_empty());
    let adjusted = run(&["adjust"]);
    assert_valid(&adjusted);
    assert_eq!(
        (&adjusted["outcome"], &adjusted["holds"]),
        (&"written".into(), &"new".into())
    );
    assert_eq!(adjusted["differences"], foreseen["differences"]);
    let check = folder.join("check.csv");
    let after = run(&["verify", "--out", &check]);
    let [[ap, at], [ap_after, at_after]] = figures(&after);
    println!("joint: AP {ap:.3} -> {ap_after:.3} mm, AT of the circle {at:.3} -> {at_after:.3} mm");
    assert!(ap_after < 0.5 * ap && at_after < 0.5 * at);

    let kept = session(&file);
    let stages: Vec<Stage> = kept.verifications().iter().map(|run| run.stage).collect();
    assert_eq!(stages, [Stage::Before, Stage::After]);
    assert_eq!(kept.adjustments()[0].outcome, Outcome::Written);
    assert!(!kept.adjustments()[0].changes.is_empty());
    // Poses measured elsewhere are accepted like those measured here.
    let again = tautline(&["verify", &file, "--check", &check, "--json", "-"]);
    assert_eq!(again.succeeded().json()["after"], after["after"]);

    let back = run(&["adjust", "--roll-back"]);
    assert_eq!(back["outcome"], "rolled_back");
    let names = kept.adjustments()[0].changes.iter();
    let rolled = session(&file);
    for change in names {
        let held = rolled
            .controller
            .iter()
            .find(|held| held.name == change.name);
        assert_eq!(held.map(|held| held.value), Some(change.before));
    }
    // A correction that the model lacks is set to neutral together with the written values.
    let name = "effect.winch_scale.cable-3.scale";
    let mut corrected = rolled;
    corrected.controller.push(NamedValue {
        name: name.to_owned(),
        value: 0.0201,
    });
    write_session(Path::new(&file), &corrected).expect("written");
    let adjusted = run(&["adjust"]);
    let lines = adjusted["differences"].as_array().expect("lines");
    let line = lines
        .iter()
        .find(|line| line["name"] == name)
        .expect("a line");
    let expected = json!([0.0201, 0.0, false, true]);
    let keys = ["controller", "identified", "in_model", "changes"];
    assert_eq!(json!(keys.map(|key| &line[key])), expected);
    assert_eq!(session(&file).controller_values()[name], 0.0);
    assert_eq!(run(&["adjust"])["outcome"], "nothing_to_write");
}

#[test]
fn results_of_the_published_method_are_written() {
    let folder = Folder::new();
    let file = folder.join("mini.json");
    let sim = ["--controller", "sim", "--arm", "--json", "-"];
    let run = |words: &[&str]| {
        tautline(&[words, &[&file], &sim].concat())
            .succeeded()
            .json()
    };
    run(&["measure", "--robot", "mini"]);
    run(&["verify"]);
    // It ends at its limit of steps here, so its values are written only if allowed.
    let refused = tautline(&[&["adjust", "--method", "published", &file], &sim[..]].concat());
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(1), ""));
    let told = &refused.stderr;
    assert!(
        told.contains("60 steps")
            && told.contains("nothing was written")
            && told.contains("--allow-unconverged"),
        "{told}"
    );
    assert!(session(&file).adjustments().is_empty());
    let adjusted = run(&["adjust", "--method", "published", "--allow-unconverged"]);
    assert_eq!(
        (&adjusted["outcome"], &adjusted["method"]),
        (&"written".into(), &"published".into())
    );
    let [[ap, at], [ap_after, at_after]] = figures(&run(&["verify"]));
    // The method takes cables as rigid and home as known, so its gain depends on the robot and is not checked.
    println!(
        "published: AP {ap:.3} -> {ap_after:.3} mm, AT of the circle {at:.3} -> {at_after:.3} mm"
    );
    assert!(
        [ap_after, at_after]
            .iter()
            .all(|mm| mm.is_finite() && *mm < 20.0)
    );
}

#[test]
fn a_replayed_recording_keeps_its_hidden_effect() {
    let folder = Folder::new();
    let recording = folder.join("recording");
    tautline(&[
        "simulate", "--robot", "mini", "--poses", "12", "--out", &recording,
    ])
    .succeeded();
    let file = folder.join("replayed.json");
    let controller = format!("replay:{recording}");
    let robot = ["--controller", &controller, "--arm", "--json", "-"];
    let measured = tautline(&[&["measure", &file], robot.as_slice()].concat()).succeeded();
    assert_eq!(
        measured.json()["measured"].as_array().map(Vec::len),
        Some(13)
    );
    let recorded = tautline_session::read_dataset(recording.as_ref()).expect("a dataset");
    let m = session(&file).measurements;
    assert_eq!(m.revolutions, recorded.dataset.measurements.revolutions);
    assert_eq!(m.laser_m, recorded.dataset.measurements.laser_m);
    // A recording cannot be written to: this is reported and recorded.
    let answer = tautline(&[&["adjust", &file], robot.as_slice()].concat());
    assert_eq!(answer.code, Some(1));
    assert!(answer.stderr.contains("a recording"), "{}", answer.stderr);
    let last = session(&file)
        .adjustments()
        .last()
        .map(|last| last.outcome.clone());
    assert!(matches!(last, Some(Outcome::Failed(_))), "{last:?}");

    let faulty = folder.join("faulty.json");
    let plan = plan(&folder, 6);
    let effect = [
        "--effect",
        "winch_scale:cable-3:scale=0.02",
        "--plan",
        &plan,
    ];
    let new = [
        "measure",
        &faulty,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
    ];
    tautline(&[new.as_slice(), &effect].concat());
    let truth = session(&faulty).simulator.expect("a simulated robot").truth;
    assert_eq!(truth.effects[0].effect, "winch_scale");
}

#[test]
fn a_run_ends_when_it_is_good_enough() {
    let folder = Folder::new();
    let file = folder.join("mini.json");
    let new = [
        "measure",
        &file,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
    ];
    let answer = tautline(&[new.as_slice(), &["--stop-at", "3", "--json", "-"]].concat());
    let measured = answer.succeeded().json();
    assert_eq!(measured["end"], "good_enough");
    assert!(number(&measured, "/largest_sd_m") <= 3e-3);
    let poses = measured["measured"].as_array().map_or(0, Vec::len);
    assert!((7..26).contains(&poses), "{poses}");
}

#[test]
fn a_pose_that_cannot_be_measured_is_skipped_and_reported() {
    let folder = Folder::new();
    let table = plan(&folder, 10);
    let text = std::fs::read_to_string(&table).expect("a plan");
    let far = folder.write("far.csv", &format!("{text}99,0.45,0,0,1,0,0,0\n"));
    let file = folder.join("mini.json");
    let sim = [
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
        "--json",
        "-",
    ];
    let answer = tautline(&[&["measure", &file, "--plan", &far], sim.as_slice()].concat());
    let measured = answer.json();
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert_eq!(measured["skipped"][0]["pose"], 99);
    assert_eq!(measured["missing"], serde_json::json!([99]));
    assert!(answer.stderr.contains("retrying") && answer.stderr.contains("skipped"));
    // A few poses do not determine the robot.
    let few: Vec<&str> = text.lines().take(4).collect();
    let few = folder.write("few.csv", &few.join("\n"));
    let file = folder.join("few.json");
    let answer = tautline(&[&["measure", &file, "--plan", &few], sim.as_slice()].concat());
    assert_eq!(
        (answer.code, &answer.json()["enough"]),
        (Some(1), &false.into())
    );
    assert!(
        answer.stderr.contains("not enough to identify"),
        "{}",
        answer.stderr
    );
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_its_poses_and_continues() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    use rustix::process::{Pid, Signal, kill_process};

    let folder = Folder::new();
    let table = plan(&folder, 8);
    let file = folder.join("mini.json");
    let words = [
        "measure",
        &file,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--arm",
    ];
    let words = [words.as_slice(), &["--plan", &table]].concat();
    // Slowly enough that the interrupt comes before the end.
    let mut child = Command::new(tautline_validation::support::program::program())
        .args(&words)
        .args(["--speed", "5"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let first = lines.next().expect("a line").expect("text");
    assert!(first.starts_with("pose 0 is on disk"), "{first}");
    let id = Pid::from_child(&child);
    kill_process(id, Signal::INT).expect("the program runs");
    let told: Vec<String> = lines.map(|line| line.expect("text")).collect();
    assert_eq!(child.wait().expect("it ends").code(), Some(1));
    let last = told.last().expect("a sentence");
    assert!(
        last.contains("Stopped by the operator") && last.contains("continues"),
        "{last}"
    );
    let poses = session(&file).measurements.len();
    assert!((1..9).contains(&poses), "{poses}");
    tautline(&words);
    assert_eq!(session(&file).measurements.len(), 9);
}
