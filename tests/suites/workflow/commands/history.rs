//! history: one robot over several sessions, with a pulley that moved between two of them.

use serde_json::{Value, json};
use tautline_core::robot::presets;

use super::compare::write_run;
use super::program::{Folder, assert_number, assert_valid, tautline};

fn set_date(run: &str, date: &Value) {
    let path = format!("{run}/robot.json");
    let text = std::fs::read_to_string(&path).expect("a robot");
    let mut robot: Value = serde_json::from_str(&text).expect("JSON");
    robot["measured_at"] = date.clone();
    std::fs::write(&path, robot.to_string()).expect("written");
}

/// Five sessions: names in another order than dates, and a pulley that moved between the third and the fourth.
fn record(folder: &Folder, dates: [Option<&str>; 5]) -> String {
    let robot = presets::find("mini").expect("a preset").robot;
    let mut moved = robot.clone();
    moved.cables[4].pulley.entry_point_m[1] -= 0.01;
    let names = ["e", "d", "c", "b", "a"];
    for (k, (name, date)) in names.into_iter().zip(dates).enumerate() {
        let truth = if k < 3 { &robot } else { &moved };
        let run = write_run(folder, &format!("life/{name}"), truth, 10 + k as u64);
        if let Some(date) = date {
            set_date(&run, &json!(date));
        }
    }
    folder.join("life")
}

const DATES: [Option<&str>; 5] = [
    Some("2026-01-05T08:00:00Z"),
    Some("2026-02-05T08:00:00+01:00"),
    Some("2026-03-05T08:00:00Z"),
    Some("2026-04-05T08:00:00.25Z"),
    Some("2026-05-05T08:00:00Z"),
];

#[test]
fn a_pulley_that_moved_is_named_and_dated() {
    let folder = Folder::new();
    let life = record(&folder, DATES);
    let found = tautline(&["history", &life, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&found);
    assert_eq!(found["format"], "tautline-history");
    let paths = found["sessions"].as_array().expect("sessions");
    let paths: Vec<_> = paths.iter().filter_map(|s| s["path"].as_str()).collect();
    assert_eq!(paths, ["e", "d", "c", "b", "a"]);
    assert_eq!(found["sessions"][1]["time"], "2026-02-05T07:00:00Z");
    let changes = found["changes"].as_array().expect("changes");
    let certain: Vec<_> = changes
        .iter()
        .filter(|c| c["probability"].as_f64() > Some(0.95))
        .collect();
    assert_eq!(certain.len(), 1, "{changes:?}");
    assert_eq!(certain[0]["targets"], json!(["cable-5"]));
    assert_eq!(certain[0]["between"], json!([2, 3]));
    assert_eq!(certain[0]["effect"], Value::Null);
    assert_number(certain[0], "/displacement_m/1", -0.01, 0.005);
    assert_number(
        &found,
        "/next_calibration/probability_out_of_tolerance",
        0.05,
        1e-12,
    );

    let readable = tautline(&["history", &life]).succeeded().stdout;
    for sentence in [
        "5 sessions of mini",
        "Between c and b the pulley of cable-5 moved by ",
        "Calibrate again by 2026-",
    ] {
        assert!(readable.contains(sentence), "{sentence}: {readable}");
    }
}

#[test]
fn the_position_of_the_platform_has_a_tolerance_and_a_report_the_date() {
    let folder = Folder::new();
    let life = record(&folder, DATES);
    let args = ["history", &life, "--tolerance-position", "0.8"];
    let found = tautline(&[&args[..], &["--json", "-"]].concat())
        .succeeded()
        .json();
    assert_valid(&found);
    let next = &found["next_calibration"];
    assert_eq!(next["tolerance_of"], "position");
    assert_number(next, "/tolerance_m", 8e-4, 1e-12);
    assert_eq!(next["volume_m"], Value::Null);
    let date = |value: &Value| value.as_str().map(str::to_owned);
    let time = date(&next["time"]).expect("a date");
    // Dates of one form are in the order of time.
    assert!(date(&next["interval"][0]).is_some_and(|from| from <= time));
    assert!(date(&next["interval"][1]).is_none_or(|to| to >= time));
    let readable = tautline(&args).succeeded().stdout;
    for part in [
        "the position error of the platform is more than",
        "in the workspace (root mean square)",
    ] {
        assert!(readable.contains(part), "{part}: {readable}");
    }
    let within = [
        &args[..],
        &["--volume", "-0.1,0.1,-0.1,0.1,-0.1,0.1", "--json", "-"],
    ]
    .concat();
    let within = tautline(&within).succeeded().json();
    let volume = json!([[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]]);
    assert_eq!(within["next_calibration"]["volume_m"], volume);

    let html = folder.join("last.html");
    let report = |session: &str, more: &[&str]| {
        let session = format!("{life}/{session}");
        let args = [&["report", &session, "--out", &html, "--replace"], more].concat();
        tautline(&args).succeeded();
        std::fs::read_to_string(&html).expect("the report")
    };
    let of_record = ["--record", &life, "--tolerance-position", "0.8"];
    let text = report("a", &of_record);
    assert!(
        text.contains(&format!("Calibrate again by {}", &time[..10])),
        "{text}"
    );
    let text = report("b", &of_record);
    assert!(text.contains("follows the last session of the record, which is 2026-05-05"));
    assert!(report("a", &[]).contains("none was given, so there is no date"));
}

#[test]
fn a_tolerance_is_a_positive_number_of_one_thing() {
    let folder = Folder::new();
    let life = record(&folder, DATES);
    let session = format!("{life}/a");
    let html = folder.join("last.html");
    for (args, parts) in [
        (
            vec!["history", &life, "--tolerance-position", "-1"],
            ["--tolerance-position", "found -1"],
        ),
        (
            vec![
                "history",
                &life,
                "--tolerance-position",
                "1",
                "--volume",
                "1,0,0,1,0,1",
            ],
            ["--volume", "found \"1,0,0,1,0,1\""],
        ),
        (
            vec![
                "report",
                &session,
                "--out",
                &html,
                "--tolerance-position",
                "1",
            ],
            ["--tolerance-position", "only with --record"],
        ),
    ] {
        tautline(&args).refused(&parts);
    }
    let elsewhere = write_run(
        &folder,
        "other",
        &presets::find("mini").expect("a preset").robot,
        9,
    );
    tautline(&["report", &elsewhere, "--out", &html, "--record", &life])
        .refused(&["--record", "other among the sessions"]);
}

#[test]
fn without_dates_the_order_is_that_of_the_names() {
    let folder = Folder::new();
    let mut dates = DATES;
    dates[1] = None;
    let life = record(&folder, dates);
    std::fs::write(folder.join("life/notes.txt"), "cable 5 was changed").expect("written");
    let found = tautline(&["history", &life, "--json", "-"]).succeeded();
    for notice in [
        "notes.txt: neither a session nor a dataset folder",
        "no date when the poses were read: d",
    ] {
        assert!(found.stderr.contains(notice), "{notice}: {}", found.stderr);
    }
    let found = found.json();
    assert_eq!(found["sessions"][0]["path"], "a");
    assert_eq!(found["next_calibration"], Value::Null);
    assert_eq!(found["drift"], json!([]));
}

#[test]
fn what_has_no_common_history_is_refused() {
    let folder = Folder::new();
    let life = record(&folder, DATES);
    set_date(&folder.join("life/c"), &json!("in March"));
    tautline(&["history", &life]).refused(&[
        "robot.json",
        "/measured_at",
        "found \"in March\"",
        "RFC 3339",
    ]);
    set_date(&folder.join("life/c"), &Value::Null);
    let out = folder.join("life/other");
    tautline(&["simulate", "--robot", "planar", "--out", &out]).succeeded();
    tautline(&["history", &life]).refused(&["is of another robot", "life"]);
    let lone = folder.join("lone");
    std::fs::create_dir(&lone).expect("a folder");
    tautline(&["history", &lone])
        .refused(&["lone", "the number of sessions is 0, expected at least 2"]);
    tautline(&["history", &folder.join("nothing")]).refused(&["nothing"]);
    tautline(&["history", &life, "--tolerance", "0"]).refused(&["--tolerance", "found 0"]);
}

#[test]
fn events_and_serial_numbers_of_a_record_are_read_and_a_report_and_a_table_are_written() {
    let folder = Folder::new();
    let life = record(&folder, DATES);
    let events = folder.join("life/events.csv");
    std::fs::write(&events, "time,event\n2026-03-20,crash at the north wall\n").expect("written");
    let [report, table] = ["year.html", "year.csv"].map(|name| folder.join(name));
    let told = tautline(&["history", &life, "--report", &report, "--csv", &table])
        .succeeded()
        .stdout;
    let expected =
        "Between c and b (crash at the north wall on 2026-03-20) the pulley of cable-5 moved by ";
    assert!(told.contains(expected), "{told}");
    let report = std::fs::read_to_string(&report).expect("a report");
    for text in [
        "History of mini",
        "crash at the north wall",
        "Pulley of cable-5 (mm) over time",
    ] {
        assert!(report.contains(text), "{text}");
    }
    let table = std::fs::read_to_string(&table).expect("a table");
    assert_eq!(table.lines().count(), 1 + 5 * 8);

    std::fs::write(&events, "time,event\nMarch,crash\n").expect("written");
    tautline(&["history", &life])
        .refused(&["events.csv, line 2, column \"time\"", "found \"March\""]);
    std::fs::remove_file(&events).expect("removed");
    for (run, number) in [("e", "T-17"), ("c", "T-18")] {
        let path = folder.join(&format!("life/{run}/robot.json"));
        let text = std::fs::read_to_string(&path).expect("a robot");
        let mut robot: Value = serde_json::from_str(&text).expect("JSON");
        robot["serial_number"] = json!(number);
        std::fs::write(&path, robot.to_string()).expect("written");
    }
    tautline(&["history", &life]).refused(&["is of another robot", "serial_number: found"]);
}
