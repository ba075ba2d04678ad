//! study: plan, run in pieces, merge, report; refusals; the same result despite interruptions of its processes.

mod harm;
mod hyperqueue;

use std::fs;
use std::path::Path;
use std::time::Duration;

use tautline_session::read_versioned_toml;
use tautline_study::StudyFile;
use tautline_validation::support::program::{Folder, start, tautline};

/// Two cells, 240 calibrations.
const STUDY: &str = r#"
format = "tautline-study"
version = 1
name = "two lasers"
seed = 7

[design]
robots = ["mini"]
lasers = ["class-0.3mm", "class-3mm"]
poses = [8]
choice = ["random"]

[simulation]
calibrations = 120
share = 1.0
chunk = 60
"#;

/// A folder with a study that is planned.
struct Study {
    folder: Folder,
    path: String,
}

impl Study {
    fn planned() -> Self {
        let folder = Folder::new();
        let file = folder.write("two.toml", STUDY);
        let plan = tautline(&["study", "plan", &file]).succeeded();
        assert!(
            plan.stdout.contains("240 calibrations in 4 chunks"),
            "{}",
            plan.stdout
        );
        let path = folder.join("two");
        Self { folder, path }
    }

    /// Another folder with the same plan and no chunk.
    fn copy(&self, name: &str) -> String {
        let path = self.folder.join(name);
        fs::create_dir(&path).expect("a folder");
        fs::copy(
            Path::new(&self.path).join("plan.json"),
            Path::new(&path).join("plan.json"),
        )
        .expect("copied");
        path
    }
}

fn merged(folder: &str) -> Vec<u8> {
    tautline(&["study", "merge", folder]).succeeded();
    fs::read(Path::new(folder).join("result.json")).expect("a result")
}

fn run_part(folder: &str, part: &str) {
    tautline(&["study", "run", folder, "--chunk", part]).succeeded();
}

#[test]
fn the_result_is_the_same_however_it_was_cut() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path, "--threads", "2"]).succeeded();
    let whole = merged(&study.path);
    for (name, of) in [("one", 1), ("seven", 7), ("backwards", 5)] {
        let folder = study.copy(name);
        for number in (1..=of).rev() {
            run_part(&folder, &format!("{number}/{of}"));
        }
        assert!(merged(&folder) == whole, "{name}");
    }
    // Existing chunks are not repeated.
    let again = tautline(&["study", "run", &study.path]).succeeded();
    assert!(
        again.stdout.contains("0 chunks done, 4 existed"),
        "{}",
        again.stdout
    );
    for end in ["html", "pdf"] {
        let out = study.folder.join(&format!("report.{end}"));
        tautline(&["study", "report", &study.path, "--out", &out]).succeeded();
        assert!(fs::metadata(out).expect("written").len() > 5_000);
    }
}

/// Simulated position errors are as the covariance expects. 120 calibrations: the relative standard error of a root mean
/// square is about 5 %; off by 35 % with a probability below 1e-6.
#[test]
fn simulation_agrees_with_theory() {
    let study = Study::planned();
    tautline(&["study", "run", &study.path]).succeeded();
    merged(&study.path);
    let text = fs::read_to_string(Path::new(&study.path).join("result.json")).expect("a result");
    let result: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for cell in result["cells"].as_array().expect("cells") {
        let simulated = &cell["simulated"];
        let ratio = simulated["over_expected"][0].as_f64().expect("a ratio");
        assert!((0.65..1.35).contains(&ratio), "{ratio}");
        assert_eq!(simulated["calibrations"], 120);
        assert_eq!(simulated["not_converged"], 0);
    }
}

#[test]
fn what_does_not_belong_together_is_not_merged() {
    let study = Study::planned();
    let path = |name: &str| Path::new(&study.path).join(name);
    let refused = |parts: &[&str]| tautline(&["study", "merge", &study.path]).refused(parts);
    refused(&["found no chunk"]);
    run_part(&study.path, "1/3");
    refused(&["found 1 of 3 chunks; number 2 is missing"]);
    run_part(&study.path, "2/3");
    run_part(&study.path, "3/3");
    let whole = merged(&study.path);
    run_part(&study.path, "1/2");
    refused(&["a division into 2 and of one into 3"]);
    fs::remove_file(path("chunk-1-of-2.parquet")).expect("removed");
    // A chunk of another study, with other noise.
    let other = study
        .folder
        .write("other.toml", &STUDY.replace("seed = 7", "seed = 8"));
    tautline(&["study", "plan", &other]).succeeded();
    let elsewhere = study.folder.join("other");
    run_part(&elsewhere, "2/3");
    let kept = fs::read(path("chunk-2-of-3.parquet")).expect("there");
    fs::copy(
        Path::new(&elsewhere).join("chunk-2-of-3.parquet"),
        path("chunk-2-of-3.parquet"),
    )
    .expect("copied");
    refused(&["chunk-2-of-3.parquet", "found a chunk of the study"]);
    tautline(&["study", "run", &study.path, "--chunk", "2/3"])
        .refused(&["found a chunk of the study"]);
    // A chunk under the name of another.
    fs::copy(path("chunk-1-of-3.parquet"), path("chunk-2-of-3.parquet")).expect("copied");
    refused(&[
        "chunk-2-of-3.parquet",
        "found a chunk of number 1 of 3, expected 2 of 3",
    ]);
    // A damaged chunk, and one that is cut off.
    let mut damaged = kept.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(path("chunk-2-of-3.parquet"), &damaged).expect("written");
    refused(&["chunk-2-of-3.parquet", "damaged"]);
    fs::write(path("chunk-2-of-3.parquet"), &kept[..middle]).expect("written");
    refused(&["chunk-2-of-3.parquet", "damaged"]);
    fs::write(path("chunk-2-of-3.parquet"), &kept).expect("written");
    assert!(merged(&study.path) == whole);
    tautline(&["study", "plan", &other, "--out", &study.path])
        .refused(&["plan.json", "belongs to another study"]);
}

#[test]
fn strange_cuts_are_refused() {
    let study = Study::planned();
    for part in [
        "0/3",
        "4/3",
        "1/0",
        "x",
        "1/3/5",
        "-1/3",
        "1.5/3",
        "1/99999999999999999999",
    ] {
        tautline(&["study", "run", &study.path, "--chunk", part])
            .refused(&["--chunk: found", part]);
    }
    tautline(&["study", "run", &study.path, "--chunk", "1/241"])
        .refused(&["at most 240, the number of calibrations"]);
    let nowhere = study.folder.join("nowhere");
    tautline(&["study", "run", &nowhere]).refused(&["plan.json: not found"]);
    tautline(&["study", "report", &study.path, "--out", "a.txt"])
        .refused(&["a.txt", ".html or .pdf"]);
    tautline(&["study", "report", &study.path, "--out", "a.pdf"])
        .refused(&["result.json: not found"]);
}

/// A run that is interrupted keeps its finished chunks and goes on where it was.
#[test]
fn an_interrupted_run_goes_on() {
    let study = Study::planned();
    let large = study.folder.write(
        "large.toml",
        &STUDY
            .replace("calibrations = 120", "calibrations = 100000")
            .replace("chunk = 60", "chunk = 50"),
    );
    tautline(&["study", "plan", &large]).succeeded();
    let folder = study.folder.join("large");
    let mut child = start(
        &["study", "run", &folder, "--threads", "1"],
        std::process::Stdio::null(),
    );
    let chunks = || fs::read_dir(&folder).expect("a folder").count();
    for _ in 0..600 {
        if chunks() > 3 {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let id = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(id, rustix::process::Signal::INT).expect("sent");
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(1));
    let kept = chunks();
    assert!(kept > 3);
    for entry in fs::read_dir(&folder).expect("a folder").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        assert!(name == "plan.json" || name.starts_with("chunk-"), "{name}");
    }
}

/// The examples of the documentation are valid.
#[test]
fn the_examples_are_valid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/studies");
    let mut seen = 0;
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        if entry.path().extension().is_some_and(|end| end == "toml") {
            let read = read_versioned_toml::<StudyFile>(&entry.path()).expect("valid");
            assert!(read.notices.is_empty(), "{:?}", read.notices);
            seen += 1;
        }
    }
    assert!(seen >= 4);
}
