//! The audit trail: it contains motions and written values, and a later change of the file is reported.

use serde_json::{Value, json};

use super::session;
use crate::commands::program::{Answer, Folder, assert_valid, tautline};

/// A session that was measured and adjusted.
fn adjusted(folder: &Folder) -> String {
    let file = folder.join("s.json");
    let sim = ["--controller", "sim", "--arm"];
    let measure = ["measure", &file, "--robot", "mini", "--poses", "12"];
    tautline(&[measure.as_slice(), &sim].concat()).succeeded();
    tautline(&[&["adjust", &file], sim.as_slice()].concat()).succeeded();
    file
}

fn audit(file: &str, more: &[&str]) -> Answer {
    tautline(&[&["audit", file], more].concat())
}

/// Restores the values from before the adjustment.
fn rolled_back(file: &str) -> Answer {
    let words = ["--controller", "sim", "--arm", "--roll-back"];
    tautline(&[&["adjust", file], &words[..]].concat()).succeeded()
}

/// The file with a change by hand.
fn changed(folder: &Folder, file: &str, change: impl FnOnce(&mut Value)) -> String {
    let text = std::fs::read_to_string(file).expect("a session");
    let mut json: Value = serde_json::from_str(&text).expect("JSON");
    change(&mut json);
    folder.write("changed.json", &json.to_string())
}

#[test]
fn what_moved_and_what_was_written_is_in_the_trail() {
    let folder = Folder::new();
    let file = adjusted(&folder);
    let document = audit(&file, &["--json", "-"]).succeeded().json();
    assert_valid(&document);
    assert_eq!(document["verdict"], "intact");
    assert_eq!(document["faults"], json!([]));
    assert_eq!(document["uncovered_poses"], json!([]));
    assert_eq!(document["imported_poses"], json!([]));
    let entries = document["entries"].as_array().expect("entries");
    let what: Vec<&str> = entries.iter().filter_map(|e| e["what"].as_str()).collect();
    assert!(
        what.iter()
            .any(|what| what.contains("12 poses and the home pose")),
        "{what:?}"
    );
    let values = session(&file).adjustments()[0].changes.len();
    let written = format!("adjustment 1 ({values} values)");
    // Once when it is begun, and once with its outcome.
    let times = what.iter().filter(|what| what.contains(&written)).count();
    assert_eq!(times, 2, "{what:?}");
    let confirmed = session(&file).adjustments()[0].read_back.clone();
    assert_eq!(confirmed.len(), values);
    let program = format!("Tautline {}", env!("CARGO_PKG_VERSION"));
    assert!(
        entries
            .iter()
            .all(|entry| entry["program"] == program.as_str())
    );
    let text = audit(&file, &[]).succeeded().stdout;
    let hash = document["last_hash"].as_str().expect("a hash");
    assert!(
        text.contains(&format!("nothing was changed; last hash {hash}")),
        "{text}"
    );
    // A report prints the hash, and the trail can be asked for it.
    let report = folder.join("r.html");
    tautline(&["report", &file, "--out", &report]).succeeded();
    let report = std::fs::read_to_string(&report).expect("a report");
    assert!(report.contains(hash));
    audit(&file, &["--contains", hash]).succeeded();
    let lost = audit(&file, &["--contains", &"0".repeat(64)]);
    assert_eq!(lost.code, Some(1), "{}", lost.stderr);
    let mistyped = audit(&file, &["--contains", "12ab"]);
    assert_eq!(mistyped.code, Some(2), "{}", mistyped.stderr);
    assert!(mistyped.stderr.contains("expected 64 hexadecimal digits"));
}

#[test]
fn a_change_by_hand_is_said_and_stays_said() {
    type Change = fn(&mut Value);
    let folder = Folder::new();
    let file = adjusted(&folder);
    let cases: [(Change, &str); 4] = [
        (
            |json| {
                let cell = &mut json["measurements"]["columns"]["rev_3"][5];
                *cell = json!(cell.as_f64().expect("a number") + 1e-3);
            },
            "the readings of pose 5 are not as recorded",
        ),
        (
            |json| json["adjustments"][0]["operator"] = json!("Eve"),
            "adjustment 1 is not as recorded",
        ),
        (
            |json| json["log"][1]["text"] = json!("Nothing happened."),
            "step 2 of the log is not as recorded",
        ),
        (
            |json| json["trail"]["entries"][0]["operator"] = json!("Eve"),
            "entry 1 does not have its hash",
        ),
    ];
    for (change, said) in cases {
        let path = changed(&folder, &file, change);
        let answer = audit(&path, &["--json", "-"]);
        assert_eq!(answer.code, Some(1), "{}", answer.stderr);
        assert!(answer.stderr.contains("the audit trail is broken: 1 fault"));
        let document: Value = serde_json::from_str(&answer.stdout).expect("JSON");
        assert_valid(&document);
        assert_eq!(document["verdict"], "broken");
        let text = document["faults"][0]["text"].as_str().expect("a sentence");
        assert!(text.starts_with(said), "{text}");
        assert!(audit(&path, &[]).stdout.contains(said));
    }
    // A command that opens the session reports it, too, and saving again does not repair the trail.
    let path = changed(&folder, &file, |json| {
        json["log"][1]["text"] = json!("Nothing.");
    });
    let back = rolled_back(&path);
    let said = "the audit trail is broken: step 2 of the log is not as recorded";
    assert!(back.stderr.contains(said), "{}", back.stderr);
    assert_eq!(audit(&path, &[]).code, Some(1));
    let report = folder.join("r.html");
    tautline(&["report", &path, "--out", &report]).succeeded();
    let report = std::fs::read_to_string(&report).expect("a report");
    assert!(report.contains("broken (1 fault)"));
}

#[test]
fn a_session_without_a_trail_opens_as_before() {
    let folder = Folder::new();
    let file = adjusted(&folder);
    let path = changed(&folder, &file, |json| {
        json.as_object_mut().expect("a session").remove("trail");
    });
    let none = audit(&path, &["--json", "-"]);
    assert_eq!(none.code, Some(1), "{}", none.stderr);
    assert!(
        none.stderr.contains("has no audit trail"),
        "{}",
        none.stderr
    );
    let document: Value = serde_json::from_str(&none.stdout).expect("JSON");
    assert_eq!(document["verdict"], "none");
    rolled_back(&path);
    let document = audit(&path, &["--json", "-"]).succeeded().json();
    let found: Vec<&Value> = document["entries"]
        .as_array()
        .expect("entries")
        .iter()
        .map(|entry| &entry["found"])
        .collect();
    assert_eq!((found[0], found[1]), (&json!(true), &json!(false)));
    let poses = |key: &str| document[key].as_array().map(Vec::len);
    assert_eq!(
        (poses("uncovered_poses"), poses("imported_poses")),
        (Some(0), Some(13))
    );
    let covers = document["covers"].as_str().expect("a sentence");
    assert!(audit(&path, &[]).stdout.contains(covers));
}

#[test]
fn every_command_that_opens_a_session_tells_a_broken_trail() {
    let folder = Folder::new();
    let file = adjusted(&folder);
    let path = changed(&folder, &file, |json| json["robot"]["name"] = json!("mine"));
    let said = "the audit trail is broken: the robot description is not as recorded";
    let record = folder.join("record");
    std::fs::create_dir(&record).expect("a folder");
    for name in ["1.json", "2.json"] {
        std::fs::copy(&path, format!("{record}/{name}")).expect("a copy");
    }
    let report = folder.join("r.html");
    let data = ["report", &path, "--out", &report, "--sections", "data"];
    for words in [
        &["compare", &path, &file][..],
        &["diagnose", &path, "--time-limit", "1"],
        &["formulas", &path],
        &["history", &record],
        &data,
    ] {
        let answer = tautline(words);
        assert!(answer.stderr.contains(said), "{words:?}: {}", answer.stderr);
    }
}

#[test]
fn an_older_copy_is_found_by_a_hash_that_it_lacks() {
    let folder = Folder::new();
    let file = folder.join("s.json");
    let sim = ["--controller", "sim", "--arm"];
    let measure = ["measure", &file, "--robot", "mini", "--poses", "8"];
    tautline(&[&measure[..], &sim].concat()).succeeded();
    let older = std::fs::read(&file).expect("a session");
    tautline(&[&["adjust", &file], &sim[..]].concat());
    let document = audit(&file, &["--json", "-"]).succeeded().json();
    let hash = document["last_hash"].as_str().expect("a hash");
    std::fs::write(&file, older).expect("put back");
    audit(&file, &[]).succeeded();
    let found = audit(&file, &["--contains", hash]);
    assert_eq!(found.code, Some(1), "{}", found.stderr);
    assert!(
        found.stdout.contains("no entry has the hash"),
        "{}",
        found.stdout
    );
}
