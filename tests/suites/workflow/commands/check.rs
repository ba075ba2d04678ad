//! check: its statements about a dataset before identification, and its exit code.

use super::program::{Folder, assert_valid, tautline};

fn simulated(folder: &Folder) -> String {
    let out = folder.join("run");
    tautline(&[
        "simulate", "--robot", "planar", "--poses", "15", "--seed", "3", "--out", &out,
    ])
    .succeeded();
    out
}

/// Changes the rows of poses.csv, given its header.
fn change_poses(run: &str, change: impl FnOnce(&[String], &mut Vec<Vec<String>>)) {
    let path = format!("{run}/poses.csv");
    let text = std::fs::read_to_string(&path).expect("a file");
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    let mut lines: Vec<Vec<String>> = text.lines().map(cells).collect();
    let head = lines.remove(0);
    change(&head, &mut lines);
    lines.insert(0, head);
    let text: Vec<String> = lines.iter().map(|cells| cells.join(",")).collect();
    std::fs::write(&path, text.join("\n") + "\n").expect("written");
}

#[test]
fn a_good_dataset_is_ready() {
    let folder = Folder::new();
    let run = simulated(&folder);
    // The evaluation that takes seconds is made on request only.
    let quick = tautline(&["check", &run, "--json", "-"]).succeeded().json();
    assert_valid(&quick);
    assert_eq!(quick["ready"], true);
    assert!(quick["isolability"].is_null());
    assert_eq!(quick["checks"][3]["outcome"], "not_evaluated");
    let answer = tautline(&["check", &run, "--explain", "--json", "-"])
        .succeeded()
        .json();
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
fn poses_that_hide_most_faults_leave_the_dataset_ready() {
    let folder = Folder::new();
    let run = folder.join("run");
    tautline(&["simulate", "--robot", "mini", "--out", &run]).succeeded();
    let text = tautline(&["check", &run, "--explain"]).succeeded().stdout;
    assert!(
        text.contains("Faults visible: notice. At typical size these poses show"),
        "{text}"
    );
    let answer = tautline(&["check", &run, "--explain", "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&answer);
    assert_eq!(answer["ready"], true);
    assert_eq!(answer["checks"][3]["outcome"], "notice");
}

#[test]
fn a_reversed_encoder_fails_with_its_own_exit_code() {
    let folder = Folder::new();
    let run = simulated(&folder);
    change_poses(&run, |head, rows| {
        let column = head.iter().position(|name| name.starts_with("rev_"));
        let column = column.expect("revolutions");
        for row in rows {
            let value: f64 = row[column].parse().expect("a number");
            row[column] = (-value).to_string();
        }
    });
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

/// A change of poses.csv, given its header.
type Change = fn(&[String], &mut Vec<Vec<String>>);

/// Sets the cells of one column, or of all that begin with `column`.
fn set(head: &[String], row: &mut [String], column: &str, text: &str) {
    for (name, cell) in head.iter().zip(row) {
        if name.starts_with(column) {
            text.clone_into(cell);
        }
    }
}

#[test]
fn readings_that_determine_nothing_are_refused_where_they_are() {
    let cases: [(&str, Change, &str); 4] = [
        (
            "no lengths",
            |head, rows| rows.iter_mut().for_each(|row| set(head, row, "rev_", "")),
            "line 3, column \"rev_1\": found no number from here to the last row of rev_4, so no row has a length, \
             expected revolutions",
        ),
        (
            "two rows",
            |_, rows| rows.truncate(2),
            "line 3, column \"pose\": found 2 rows in all, which cannot determine the robot, expected at least 3",
        ),
        (
            "home alone",
            |_, rows| rows.truncate(1),
            "line 2, column \"pose\": found 1 row in all, which cannot determine the robot, expected at least 3",
        ),
        (
            "home not at zero",
            |head, rows| set(head, &mut rows[0], "rev_3", "3.5"),
            "line 2, column \"rev_3\": found 3.5 revolutions of cable-3 at home, expected 0",
        ),
    ];
    for (name, change, expected) in cases {
        let folder = Folder::new();
        let run = simulated(&folder);
        change_poses(&run, change);
        let expected = format!("{run}/poses.csv, {expected}");
        for method in ["joint", "simple", "published"] {
            tautline(&["identify", &run, "--method", method]).refused(&[&expected]);
        }
        let values = folder.join("values.csv");
        tautline(&["export", &run, "--table", "values", "--out", &values]).refused(&[&expected]);
        let answer = tautline(&["check", &run]);
        assert_eq!(answer.code, Some(5), "{name}: {}", answer.stdout);
        assert!(
            answer.stdout.contains(&expected),
            "{name}: {}",
            answer.stdout
        );
        // Commands that use other readings only report it.
        let poses = folder.join("poses.csv");
        let answer = tautline(&["export", &run, "--out", &poses]).succeeded();
        assert!(
            answer.stderr.contains(&expected),
            "{name}: {}",
            answer.stderr
        );
    }
}

#[test]
fn a_negative_tension_is_said_and_fails_the_check_but_may_be_an_error_of_its_sensor() {
    let folder = Folder::new();
    let run = simulated(&folder);
    change_poses(&run, |head, rows| {
        set(head, &mut rows[3], "force_2_n", "-400");
    });
    let expected = format!(
        "{run}/poses.csv, line 5, column \"force_2_n\": found -400 N, a negative tension of cable-2, expected a positive one"
    );
    let answer = tautline(&["identify", &run]).succeeded();
    assert!(answer.stderr.contains(&expected), "{}", answer.stderr);
    let answer = tautline(&["check", &run]);
    assert_eq!(answer.code, Some(5), "{}", answer.stdout);
    assert!(answer.stdout.contains(&expected), "{}", answer.stdout);
}
