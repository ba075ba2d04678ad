//! check: what it says of a dataset before identification, and its exit code.

use super::program::{Folder, assert_valid, tautline};

fn simulated(folder: &Folder) -> String {
    let out = folder.join("run");
    tautline(&[
        "simulate", "--robot", "planar", "--poses", "15", "--seed", "3", "--out", &out,
    ])
    .succeeded();
    out
}

#[test]
fn a_good_dataset_is_ready() {
    let folder = Folder::new();
    let run = simulated(&folder);
    let answer = tautline(&["check", &run, "--json", "-"]).succeeded().json();
    assert_valid(&answer);
    assert_eq!(answer["format"], "tautline-readiness");
    assert_eq!(answer["ready"], true);
    let checks = answer["checks"].as_array().expect("checks");
    assert_eq!(checks.len(), 4);
    let faults = answer["isolability"]["faults"]
        .as_array()
        .expect("faults")
        .len();
    assert_eq!(
        answer["isolability"]["confusion"].as_array().map(Vec::len),
        Some(faults)
    );
    let text = tautline(&["check", &run, "--explain"]).succeeded().stdout;
    for part in [
        "Readings complete: pass. ",
        "Geometry determined: pass. ",
        "could be confused with",
        "Winch scale of cable-1",
    ] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
}

#[test]
fn a_reversed_encoder_fails_with_its_own_exit_code() {
    let folder = Folder::new();
    let run = simulated(&folder);
    let path = format!("{run}/poses.csv");
    let text = std::fs::read_to_string(&path).expect("a file");
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = head
        .iter()
        .position(|name| name.starts_with("rev_"))
        .expect("revolutions");
    let mut changed = vec![head.join(",")];
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let value: f64 = cells[column].parse().expect("a number");
        cells[column] = (-value).to_string();
        changed.push(cells.join(","));
    }
    std::fs::write(&path, changed.join("\n") + "\n").expect("written");
    let answer = tautline(&["check", &run]);
    assert_eq!(answer.code, Some(5), "{}", answer.stdout);
    assert!(
        answer.stdout.contains(
            "Readings plausible: FAIL. The length of cable-1 changes with the wrong sign."
        ),
        "{}",
        answer.stdout
    );
    assert!(
        answer.stderr.contains("correct what it names"),
        "{}",
        answer.stdout
    );
}
